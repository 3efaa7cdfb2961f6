"""`assur robots import` and `assur robots show`: from a description to a plan that is checked."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from assur.api.cli.border import BAD_INPUT, RIGHT, WRONG
from tests.api.test_command_line import run
from tests.scenes.meshes.solids import SOLIDS, binary_stl
from tests.scenes.urdf.made import FAMILIES, FORE_AT, Files, J, box, cellarm, mesh, urdf

CYLINDER = '<origin xyz="0 0 {}"/><geometry><cylinder radius="{}" length="{}"/></geometry>'
SCARA = urdf(
    J("revolute", (0, 0, 0.2), shape=mesh("arm.stl", "0.0009 0.0009 0.0005", (0.16, 0, 0.05))),
    J("revolute", (0.3, 0, 0), (0, 0, 0.4), (0, 0, -1), shape=box(0.3, 0.08, 0.05, (0.1, 0, 0.12))),
    J("prismatic", (0.25, 0, 0), (0, 0, 0.1), (0, 0, -1), ends=(0.0, 0.15)),
    J("revolute", ends=(-6.0, 6.0), shape=CYLINDER.format(0.12, 0.01, 0.24)),
    base=CYLINDER.format(0.1, 0.06, 0.19),
)
CELL = """
about: Pick and place with an imported arm.
request:
  schema: assur/1
  robot:
    file: made.yaml
    tool:
      tcp_mm: [0, 0, -80]
      bodies: [{name: cup, shape: {cylinder: {radius_mm: 8, height_mm: 80}}, at_mm: [0, 0, -40]}]
  start: {joints: {j1_deg: 0, j2_deg: -60, j3_mm: 20, j4_deg: 0}}
  bodies:
    - {name: table, shape: {box: {size_mm: [300, 600, 20]}}, pose: {at_mm: [400, 0, -60]}}
    - {name: part, shape: {box: {size_mm: [30, 30, 20]}}, pose: {at_mm: [380, -120, -39.5]}}
  task:
    - pick: {part: part, grasp_mm: [0, 0, 10], dwell_ms: 50, approach: {mm: 20}, depart: {mm: 20}}
    - place:
        part: part
        to: {at_mm: [380, 120, -39.5], yaw_deg: 0}
        dwell_ms: 50
        approach: {mm: 20}
        depart: {mm: 20}
  options: {stop: first, max_candidates: 200, budget_s: 20}
expect: {status: planned}
"""


def imported(files: Files, *options: str) -> tuple[int, str, str]:
    """The import of a URDF with its file of limits, to made.yaml in its folder."""
    out = ("--out", str(files.folder / "made.yaml"))
    return run("robots", "import", str(files.urdf), "--joint-limits", str(files.limits), *out, *options)


@pytest.fixture
def files(tmp_path: Path) -> Files:
    (tmp_path / "arm.stl").write_bytes(binary_stl(SOLIDS["star"]))
    return Files(tmp_path).write(SCARA, 4)


def test_a_pick_and_place_with_an_imported_robot_is_planned_and_checked(files: Files) -> None:
    out = files.folder / "made.yaml"
    code, output, errors = imported(files)
    assert (code, errors) == (RIGHT, "")
    assert "made: SCARA, axis order rrpr, from link l0 to link l4" in output
    assert "flange at 1000 random states" in output
    assert f"written: {out}" in "".join(output.split("\n"))
    assert sorted(path.suffix for path in (files.folder / "made-solids").iterdir())[0] == ".obj"
    cell = files.folder / "cell.yaml"
    cell.write_text(CELL)
    plan = files.folder / "plan.json"
    code, output, errors = run("plan", str(cell), "--out", str(plan))
    assert (code, errors) == (RIGHT, ""), output
    assert "plan checked" in output
    code, output, _ = run("check", str(cell), str(plan))
    assert (code, output.splitlines()[0][:10]) == (RIGHT, "plan right")
    assert run("robots", str(out))[0] == RIGHT


def test_an_elbow_arm_with_zeros_of_its_own_is_planned_and_checked(tmp_path: Path) -> None:
    files = Files(tmp_path).write(FAMILIES["elbow arm, straight up at its zeros"][2], 3)
    assert imported(files)[::2] == (RIGHT, "")
    request = {
        "schema": "assur/1",
        "robot": {"file": "made.yaml", "tool": {"tcp_mm": [0, 0, 0]}},
        "start": {"joints": {"j1_deg": 10, "j2_deg": 40, "j3_deg": -60}},
        "task": [{"move": {"to": {"at_mm": [150, 250, 400]}}}],
        "options": {"stop": "first", "max_candidates": 100, "budget_s": 20, "elbow": "auto"},
    }
    cell = tmp_path / "cell.yaml"
    cell.write_text(json.dumps({"about": "A move.", "request": request}))
    code, output, errors = run("plan", str(cell))
    assert code == RIGHT, (output, errors)
    assert "plan checked" in output


def test_what_is_missing_is_told_line_by_line_and_nothing_is_written(files: Files) -> None:
    out = files.folder / "made.yaml"
    code, output, errors = run("robots", "import", str(files.urdf), "--out", str(out))
    assert (code, output) == (BAD_INPUT, "")
    assert len(errors.splitlines()) == 5
    assert errors.splitlines()[0] == (
        "assur: made.urdf: joint a_joint_1: no limit.acceleration in the URDF; "
        "give it in --joint-limits as joint_limits.a_joint_1.max_acceleration (rad/s2)"
    )
    assert errors.splitlines()[-1] == "assur: nothing was written"
    assert not out.exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("nowhere.urdf",), "No such file"),
        (("{urdf}", "--package", "a"), "NAME=FOLDER"),
        (("{urdf}", "--hold", "a_joint_1=x"), "a number in rad or m"),
        (("{urdf}", "--out", "/nowhere/a.yaml"), "a file in a folder that exists"),
    ],
)
def test_options_that_are_not_right_are_refused(arguments: tuple[str, ...], words: str, files: Files) -> None:
    code, _, errors = run("robots", "import", *(word.format(urdf=files.urdf) for word in arguments))
    assert code == BAD_INPUT
    assert words in errors


@pytest.mark.parametrize(
    ("robot", "ending"), [("mitsubishi-rv-m1", "png"), ("fanuc-sr-3ia", "svg"), ("mitsubishi-rp-5ah", "png")]
)
def test_a_robot_is_drawn(robot: str, ending: str, tmp_path: Path) -> None:
    out = tmp_path / f"robot.{ending}"
    assert run("robots", "show", robot, "--out", str(out))[0] == RIGHT
    assert out.read_bytes()[:5] in (b"\x89PNG\r", b"<?xml")
    assert out.stat().st_size > 20_000
    assert run("robots", "show", robot, "--out", str(tmp_path / "a.pdf"))[0] == BAD_INPUT


POST = """
about: An arm that begins next to a post.
request:
  schema: assur/1
  robot: {file: made.yaml, tool: {tcp_mm: [0, 0, 0]}}
  start: {joints: {shoulder_deg: 0, elbow_deg: 0, lift_mm: 50, wrist_deg: 0}}
  bodies:
    - {name: post, shape: {cylinder: {radius_mm: 10, height_mm: 500}}, pose: {at_mm: [400, 130, 250]}}
  task:
    - move: {to: {at_mm: [480, -80, 150]}}
  options: {stop: first, max_candidates: 100, budget_s: 10, explain_budget_s: 0}
"""
TURN = 'quat_xyzw="0 0 0.70710678118654757 0.70710678118654757"'


def test_a_solid_that_is_turned_by_a_quaternion_is_where_the_plan_needs_it(tmp_path: Path) -> None:
    # turned by 90 deg about the vertical, the box of the fore arm reaches the post
    (tmp_path / "cell.yaml").write_text(POST)
    refused = {}
    for turn, version in ((TURN, "1.1"), ('rpy="0 0 1.5707963267948966"', "1.0")):
        files = cellarm(tmp_path, (FORE_AT, f"{FORE_AT} {turn}"), version=version)
        assert imported(files)[0] == RIGHT
        code, output, errors = run("plan", str(tmp_path / "cell.yaml"))
        assert (code, errors) == (WRONG, "")
        assert "START_IN_COLLISION (proved: no plan exists)" in output
        assert "fore would hit post: they would overlap by up to 30 mm" in output
        refused[turn] = output
    assert len(set(refused.values())) == 1
    files = cellarm(tmp_path)
    assert imported(files)[0] == RIGHT
    assert run("plan", str(tmp_path / "cell.yaml"))[0] == RIGHT


def test_a_warning_and_what_no_plan_depends_on_are_printed(tmp_path: Path) -> None:
    files = cellarm(tmp_path, ('lower="-2.5" upper="2.5" velocity="9"', 'lower="-145" upper="145" velocity="9"'))
    code, output, errors = imported(files)
    assert (code, errors) == (RIGHT, "")
    said = " ".join(output.split())
    assert "warning: joint elbow: its range is -145 to 145 rad, 46.2 turns; if these are deg, it is -2.53073" in said
    assert "no plan depends on what else the URDF has: limit.effort (4, first in line 10)" in said
    report = json.loads(imported(files, "--json")[1])
    assert [len(report["warnings"]), report["unused"]] == [1, ["limit.effort (4, first in line 10)"]]


XACRO = """<robot name="made" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:arg name="reach" default="0.3"/><xacro:property name="arm" value="$(arg reach)"/>
<xacro:macro name="joint" params="n x kind">
  <link name="l${n}"/>
  <joint name="a_joint_${n}" type="${kind}"><parent link="l${n-1}"/><child link="l${n}"/><origin xyz="${x} 0 0"/>
  <axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="2" effort="1"/></joint>
</xacro:macro>
<link name="l0"/>
<xacro:joint n="1" x="0" kind="revolute"/><xacro:joint n="2" x="${arm}" kind="revolute"/>
<xacro:joint n="3" x="${arm / 2}" kind="prismatic"/>
</robot>"""


def test_a_xacro_file_is_expanded_with_its_arguments(tmp_path: Path) -> None:
    files = Files(tmp_path).write("", 3)
    file, out = tmp_path / "made.urdf.xacro", tmp_path / "made.yaml"
    file.write_text(XACRO)
    given = (str(file), "--joint-limits", str(files.limits), "--out", str(out))
    code, _, errors = run("robots", "import", *given, "--arg", "reach=0.4")
    assert (code, errors) == (RIGHT, "")
    assert "l1_m: {value: 0.4," in out.read_text()
    assert "l2_m: {value: 0.2," in out.read_text()
    file.write_text(XACRO.replace("${arm}", "${leg}"))
    code, _, errors = run("robots", "import", *given)
    assert code == BAD_INPUT
    assert "xacro does not expand it" in errors


def test_without_its_library_a_xacro_file_is_refused_with_what_to_install(tmp_path: Path) -> None:
    (tmp_path / "made.xacro").write_text(XACRO)
    program = (
        "import importlib.util as u, sys; found = u.find_spec; "
        "u.find_spec = lambda name, *rest: None if name == 'xacrodoc' else found(name, *rest); "
        "from assur.api.command_line import app; app(['robots', 'import', sys.argv[1]])"
    )
    command = [sys.executable, "-c", program, str(tmp_path / "made.xacro")]
    result = subprocess.run(command, capture_output=True, text=True, check=False, cwd=Path(__file__).parents[2] / "src")
    assert result.returncode == BAD_INPUT
    assert "install assur with the extra `xacro`" in result.stderr
