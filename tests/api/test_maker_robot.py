"""A maker's own robot, where its files are at hand: import, kinematics, covers, pick and place, report.

The files may not be copied into the project. `ASSUR_MAKER_ROBOTS` names the folder that has them: `rh-6crh6020` with
`melfa_description` and `moveit/config` below; without it tests/conftest.py leaves this module out. They
are in the maker's repository Mitsubishi-Electric-Asia/melfa_ros2_driver.
"""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest

from assur.api.cli.border import RIGHT
from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Pose
from assur.planner.geometry.containment import winding_number
from assur.planner.geometry.shapes import Piece
from assur.scenes.catalogue import RobotFile, load_robot
from assur.scenes.conventions import converted
from assur.scenes.meshes.load import triangles_of
from assur.scenes.urdf.solids import closed
from tests.api.test_command_line import run
from tests.scenes.urdf.made import flange_by_library
from tests.scenes.urdf.test_solids_of_links import outside

ROOT = Path(os.environ["ASSUR_MAKER_ROBOTS"]) / "rh-6crh6020"
URDF = ROOT / "melfa_description" / "urdf" / "rh6crh6020" / "rh6crh6020.urdf"
LIMITS, SRDF = (ROOT / "moveit" / "config" / name for name in ("joint_limits.yaml", "rh6crh6020.srdf"))
MESHES = ROOT / "melfa_description" / "meshes" / "rh6crh6020"
JOINTS = [f"rh6crh6020_joint_{i}" for i in range(1, 5)]
STATES = 1000
MOST_BYTES = 1_000_000
"""What a report may have."""

CELL = """
about: The imported robot picks a part from a running belt and places it on a table.
request:
  schema: assur/1
  robot:
    file: rh6.yaml
    tool:
      tcp_mm: [0, 0, -60]
      mass_kg: 0.5
      bodies: [{name: cup, shape: {cylinder: {radius_mm: 10, height_mm: 60}}, at_mm: [0, 0, -30]}]
    limits: {acceleration: 0.5}
  start: {tool: {at_mm: [400, 0, 60], yaw_deg: 0}, elbow: right}
  frames:
    belt: {conveyor: {at_mm: [0, 320, -60], speed_mm_s: 200}, uncertainty: {speed_mm_s: 2}}
  bodies:
    - {name: belt-bed, shape: {box: {size_mm: [1200, 200, 40]}}, pose: {at_mm: [0, 320, -81]}}
    - {name: table, shape: {box: {size_mm: [200, 200, 40]}}, pose: {at_mm: [420, -200, -81]}}
    - name: part
      shape: {box: {size_mm: [30, 30, 20]}}
      pose: {frame: belt, at_mm: [100, 0, 10], yaw_deg: 20}
      mass_kg: 0.3
  task:
    - pick:
        part: part
        grasp_mm: [0, 0, 10]
        window_mm: [100, 420]
        approach: {mm: 25}
        dwell_ms: 60
        depart: {mm: 30}
    - place:
        part: part
        to: {at_mm: [420, -200, -50.5], yaw_deg: 0}
        approach: {mm: 25}
        dwell_ms: 50
        depart: {mm: 25}
    - move: {to: {at_mm: [400, 0, 60]}}
  options: {seed: 1, stop: first, max_candidates: 200, budget_s: 60}
expect: {status: planned, matched: [pick-1]}
"""


@pytest.fixture(scope="module")
def imported(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The robot's file, imported by one command."""
    out = tmp_path_factory.mktemp("maker") / "rh6.yaml"
    given = ("--joint-limits", str(LIMITS), "--srdf", str(SRDF), "--out", str(out))
    code, output, errors = run("robots", "import", str(URDF), *given)
    assert (code, errors) == (RIGHT, "")
    assert "rh6crh6020: SCARA, axis order rrpr" in output
    return out


def states(robot: RobotFile) -> FloatArray:
    arm = robot.built()
    q: FloatArray = np.random.default_rng(11).uniform(arm.limits.lower, arm.limits.upper, (STATES, 4))
    return q


def test_the_flange_is_where_another_library_puts_it(imported: Path) -> None:
    robot = load_robot(imported)
    arm, q = robot.built(), states(robot)
    assert all((joint.sign, joint.zero) == (1, 0.0) for joint in arm.conventions)
    theirs = flange_by_library(URDF, "world", "rh6crh6020_default_tcp", JOINTS, q)
    positions, rotations = arm.robot(Pose(), arm.limits).placements(converted(q, arm.conventions))
    assert np.linalg.norm(theirs[:, :3, 3] - positions[:, -1], axis=1).max() <= 1e-6
    off = np.linalg.norm(theirs[:, :3, :3] - rotations[:, -1], axis=(1, 2)) / np.sqrt(8)
    assert 2 * np.arcsin(off).max() <= 1e-6


@pytest.mark.parametrize("link", ["base", "no1arm", "no2arm", "shaft"])
def test_a_mesh_is_in_the_bodies_of_its_link(link: str, imported: Path) -> None:
    robot = load_robot(imported)
    arm = robot.built()
    machine = arm.robot(Pose(), arm.limits)
    corners = triangles_of((MESHES / f"{link}.STL").read_bytes(), "stl")
    surface, _ = closed(link, corners)
    low, high, count = surface.vertices.min(0), surface.vertices.max(0), max(400, 8_000_000 // len(corners))
    spread = np.random.default_rng(1).uniform(low, high, (count, 3))
    enclosed = spread[np.abs(winding_number((surface.vertices, surface.faces), spread)) > 0.5]
    assert len(enclosed) > 20
    rng = np.random.default_rng(2)
    weights, some = rng.dirichlet([1.0, 1.0, 1.0], 3_000), corners[rng.integers(0, len(corners), 3_000)]
    on_faces = np.einsum("nk,nki->ni", weights, some)
    points = np.concatenate([np.unique(corners.reshape(-1, 3), axis=0), on_faces, enclosed])
    riders = [body for body in machine.bodies if body.body.name.split("-")[0] == link]
    assert riders
    q = states(robot)[:4]
    theirs = flange_by_library(URDF, "world", f"rh6crh6020_{link}", JOINTS, q)
    positions, rotations = machine.placements(converted(q, arm.conventions))
    for k in range(len(q)):
        pieces = []
        for rider in riders:
            turn, at = rotations[k, rider.link], positions[k, rider.link]
            pieces += [Piece(p.shape, at + turn @ p.position, turn @ p.rotation) for p in rider.body.pieces]
        assert outside(points @ theirs[k, :3, :3].T + theirs[k, :3, 3], pieces) <= 1e-9


def test_a_pick_from_a_belt_and_a_place_are_planned_checked_and_reported(imported: Path) -> None:
    cell, plan, page = (imported.parent / name for name in ("cell.yaml", "plan.json", "report.html"))
    cell.write_text(CELL)
    code, output, errors = run("plan", str(cell), "--out", str(plan))
    assert (code, errors) == (RIGHT, ""), output
    assert "plan checked" in output
    assert json.loads(plan.read_text())["plan"]["status"] == "planned"
    for given in ([str(plan)], [str(cell), str(plan)]):
        code, output, _ = run("check", *given)
        assert (code, output.splitlines()[0][:10]) == (RIGHT, "plan right")
    code, output, errors = run("report", str(plan), "--out", str(page))
    assert (code, errors) == (RIGHT, ""), output
    assert 50_000 < page.stat().st_size < MOST_BYTES
