"""Inverse kinematics on the command line and over HTTP: the same answer as in Python, and errors at their fields."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path
from typing import Any

import httpx
import pytest

from assur.api.cli import cell_reading
from assur.api.cli.border import BAD_INPUT, RIGHT, WRONG
from assur.api.workers.jobs import FIRST_PLAN
from assur.scenes import ik, kernels, load
from tests.api.test_command_line import run as any_command

POSE = ("--at-mm", "350", "0", "120", "--yaw-deg", "90")
QUESTION = {"at_mm": [350, 0, 120], "yaw_deg": 90}
RV_M1 = ("--robot", "mitsubishi-rv-m1", "--at-mm", "300", "0", "300", "--pitch-deg", "-80", "--roll-deg", "0")


def run(*arguments: str) -> tuple[int, str, str]:
    return any_command("ik", *arguments)


def test_a_pose_in_a_frame_at_a_time_is_told_as_in_python() -> None:
    code, output, errors = run("demo", *POSE[:4], "--yaw-deg", "90", "--frame", "belt", "--at-s", "0.5", "--json")
    assert (code, errors) == (WRONG, "")  # 350 mm beside the belt
    assert json.loads(output) == ik(load("demo"), pose={**QUESTION, "frame": "belt"}, at_s=0.5)
    code, output, _ = run("demo", *POSE, "--json")
    assert code == RIGHT
    assert json.loads(output) == ik(load("demo"), pose=QUESTION)


def test_negative_coordinates_are_no_options() -> None:
    code, output, _ = run("demo", "--at-mm", "-300", "-100", "120", "--yaw-deg", "-90", "--at-s", "-0.5", "--json")
    assert code == RIGHT
    answer = json.loads(output)
    assert answer["tool"]["world"]["at_m"] == pytest.approx([-0.3, -0.1, 0.12])
    assert answer["tool"]["world"]["yaw_rad"] == pytest.approx(-math.pi / 2)
    assert answer["at_s"] == -0.5


def test_joints_give_the_pose_of_the_tool_and_back() -> None:
    joints = "j1_deg=17, j2_deg=68, j3_mm=250, j4_deg=-40"
    code, output, _ = run("demo", "--joints", joints, "--json")
    assert code == RIGHT
    answer = json.loads(output)
    x, y, z = (str(1e3 * x) for x in answer["tool"]["world"]["at_m"])
    yaw = str(math.degrees(answer["tool"]["world"]["yaw_rad"]))
    back = json.loads(run("demo", "--at-mm", x, y, z, "--yaw-deg", yaw, "--json")[1])
    degrees = [
        (each["mode"], each["turn"], round(math.degrees(each["joints"]["j4_rad"]), 6)) for each in back["solutions"]
    ]
    assert ("right", 0, -40.0) in degrees


def test_people_read_joints_margins_collisions_and_what_other_modes_lack() -> None:
    code, output, _ = run("demo", *POSE)
    assert code == RIGHT
    lines = output.splitlines()
    assert lines[0] == "mitsubishi-rh-6frh5520 at 0.000 s"
    (head,) = (line for line in lines if line.startswith("mode"))
    assert re.split(r"\s{2,}", head)[1:] == ["turn", "j1 deg", "j2 deg", "j3 mm", "j4 deg", "singularity", "to edge mm"]
    assert [line.split()[:3] for line in lines if line.startswith(("left", "right"))] == [
        ["left", "-1", "at"],
        ["left", "0", "at"],
        ["right", "0", "at"],
    ]
    assert {line.split()[0] for line in lines if line.endswith("  90.00")} >= {"world", "belt"}
    assert "no collision at rest" in lines
    code, output, _ = run(*RV_M1)
    assert code == RIGHT
    assert "pitch deg  roll deg" in output
    assert "yaw deg" not in output
    assert "down: j3 would be at 90.2991 deg, 90.3 deg beyond its range of -110 to 0 deg and j4 " in output
    assert "collisions are not looked for without a request" in output
    assert "parallel" in run("five-bar", "--at-mm", "300", "0", "120", "--yaw-deg", "0")[1]


def test_a_collision_is_told_with_its_bodies(tmp_path: Path) -> None:
    post = {"name": "post", "shape": {"box": {"size_m": [0.05, 0.05, 0.3]}}, "pose": {"at_m": [0.3, 0.25, 0.15]}}
    file = tmp_path / "cell.json"
    file.write_text(json.dumps({**FIRST_PLAN, "bodies": [post]}))
    code, output, _ = run(str(file), "--at-mm", "300", "250", "200", "--yaw-deg", "0")
    assert code == RIGHT
    assert "left, turn 0: cup would hit post" in output
    assert "no collision at rest" not in output


def test_a_pose_out_of_reach_ends_with_one_and_says_by_how_much() -> None:
    code, output, _ = run("--robot", "oviedo-scara", "--at-mm", "900", "0", "80")
    assert code == WRONG
    lacks = [line for line in output.splitlines() if line.endswith(" mm out of reach")]
    assert [line.split(":")[0] for line in lacks] == ["left", "right"]
    assert "no collision" not in output


def test_another_robot_has_the_tool_point_and_the_base_of_the_file(tmp_path: Path) -> None:
    file = tmp_path / "cell.json"
    robot = {**FIRST_PLAN["robot"], "base": {"at_m": [1, 2, 3], "yaw_deg": 90}}
    robot["tool"] = {"tcp_m": [0.01, 0, -0.1], "bodies": robot["tool"]["bodies"]}
    file.write_text(json.dumps({**FIRST_PLAN, "robot": robot}))
    named = ("--robot", "fanuc-sr-3ia", "--joints", "j1_deg=0,j2_deg=0,j3_mm=0,j4_deg=0", "--json")
    answer = json.loads(run(str(file), *named)[1])
    # its links are 200 mm long, its flange is 250 mm high at zero
    assert answer["tool"] == {"world": {"at_m": pytest.approx([1, 2.41, 3.15]), "yaw_rad": pytest.approx(math.pi / 2)}}
    assert "collisions" not in answer["solutions"][0]
    alone = json.loads(run(*named)[1])
    assert alone["tool"]["world"]["at_m"] == pytest.approx([0.4, 0.0, 0.25])


def test_a_robots_file_may_be_named(tmp_path: Path) -> None:
    from assur.scenes.catalogue import FOLDER

    file = tmp_path / "my.yaml"
    file.write_text((FOLDER / "oviedo-scara.yaml").read_text())
    given = ("--at-mm", "300", "0", "80", "--json")
    assert json.loads(run("--robot", str(file), *given)[1]) == json.loads(run("--robot", "oviedo-scara", *given)[1])


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((), "--at-mm: it is missing; allowed: a position of the tool point, or --joints; one of both must be given"),
        (("demo",), "--at-mm: it is missing"),
        (POSE, "request: it is missing; allowed: a request, or a robot"),
        (("nowhere.yaml", *POSE), 'FILE: got "nowhere.yaml"'),
        (("--robot", "nothing", *POSE), 'ROBOT: got "nothing"'),
        (("demo", *POSE, "--joints", "j1_deg=1"), "joints: got"),
        (("demo", *POSE[:4]), "--yaw-deg: it is missing; allowed: a number, which must be given: the joints are found"),
        (
            ("demo", *POSE, "--frame", "blet"),
            '--frame: got "blet"; allowed: one of belt, dial, gate, world; did',
        ),
        (("demo", "--at-mm", "nan", "0", "0", "--yaw-deg", "0"), "pose.at_mm[0]: got"),
        (("demo", *POSE, "--at-s", "nan"), "at_s: got"),
        (("demo", "--joints", "j1_deg"), '--joints: got "j1_deg"; allowed: joints with their units'),
        (("demo", "--joints", ""), '--joints: got ""'),
        (("demo", "--joints", "j1_deg=1,j1_deg=2"), '--joints: got "j1_deg=2"; allowed: j1_deg once'),
        (("demo", "--joints", "j1_deg=1,j1_rad=2"), "joints.j1_deg: got 1.0; allowed: j1_deg or j1_rad, not both"),
        (
            ("demo", "--joints", "j1_deg=1"),
            "--joints: it is missing; allowed: all joints, j2_rad (or j2_deg) among them",
        ),
    ],
)
def test_bad_input_ends_with_two_and_a_line_for_each_fault(arguments: tuple[str, ...], said: str) -> None:
    code, output, errors = run(*arguments)
    assert (code, output) == (BAD_INPUT, "")
    first, *more = errors.splitlines()
    assert first.startswith(f"assur: {said}")
    assert all(line.startswith("assur: joints.") for line in more)  # each fault of the joints has a line of its own


def test_wrong_usage_is_refused() -> None:
    assert run("demo", "--at-mm", "1", "2")[0] == BAD_INPUT
    assert run("demo", "--at-mm", "1", "2", "x")[0] == BAD_INPUT


def test_a_start_at_a_pose_says_before_it_is_read_that_kernels_are_compiled(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(kernels, "is_compiled", lambda: False)
    cell_reading.announce_compilation.cache_clear()
    file = tmp_path / "cell.json"
    for start, lines in (({"tool": {"at_m": [9, 0, 0.2], "yaw_deg": 0}}, 1), ({"joints": {}}, 4)):
        file.write_text(json.dumps({**FIRST_PLAN, "start": start}))
        code, _, errors = any_command("plan", str(file))
        assert code == BAD_INPUT
        assert sum("compiling" not in line for line in errors.splitlines()) == lines
        assert errors.startswith("assur: compiling the planner's kernels once") == (lines == 1)
    cell_reading.announce_compilation.cache_clear()


def asked(client: httpx.Client, body: Any) -> httpx.Response:
    return client.post("/v1/ik", json=body)


def test_over_http_the_answer_is_that_of_python(client: httpx.Client, small: dict[str, Any]) -> None:
    pose = {"at_mm": [350, 0, 200], "yaw_deg": 90}
    answer = asked(client, {"request": small, "pose": pose, "at_s": 0.25})
    assert answer.status_code == 200
    assert answer.json() == ik(small, pose=pose, at_s=0.25)
    assert answer.json()["status"] == "reached"
    joints = answer.json()["solutions"][0]["joints"]
    assert asked(client, {"request": small, "joints": joints}).json() == ik(small, joints=joints)
    far = asked(client, {"request": small, "pose": {"at_mm": [900, 0, 200], "yaw_deg": 0}})
    assert (far.status_code, far.json()["status"]) == (200, "not_reached")


def test_the_example_in_the_description_is_answered(client: httpx.Client) -> None:
    described = client.get("/openapi.json").json()
    (example,) = described["paths"]["/v1/ik"]["post"]["requestBody"]["content"]["application/json"]["examples"].values()
    assert asked(client, example["value"]).json()["status"] == "reached"
    question = described["components"]["schemas"]["IkQuestion"]
    assert set(question["properties"]) == {"request", "robot", "pose", "joints", "at_s", "at_ms"}


def test_what_is_no_json_and_what_is_too_large_is_refused_as_in_a_plan(client: httpx.Client) -> None:
    headers = {"content-type": "application/json"}
    for content, status in ((b'{"pose": NaN}', 400), (b"{", 400), (b" " * (1 << 20) + b"{}", 413)):
        assert client.post("/v1/ik", content=content, headers=headers).status_code == status
    assert client.get("/v1/ik").status_code == 405
