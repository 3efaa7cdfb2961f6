"""A mesh is hollow to the rows; what begins inside one is found all the same."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from assur.planner.checked import check
from assur.planner.checker import Code
from assur.planner.geometry.shapes import Body, Piece, box, sphere
from assur.planner.laws import Pose
from assur.planner.model.outcome import Plan
from assur.planner.model.scene import Scene, WorldBody
from tests.planner.checker.hand_made import belt_case, crossing, crossing_case, proved, solid

CORNERS = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
QUADS = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
FACES = np.array([triangle for a, b, c, d in QUADS for triangle in ((a, b, c), (a, c, d))])


def shell(name: str, half: float, *, hollow: bool = True) -> Body:
    """A closed box as a mesh is covered: thin slabs on its faces, and the surface."""
    slabs = []
    for axis in range(3):
        for side in (-1.0, 1.0):
            size = [2 * half] * 3
            size[axis] = 1e-3
            at = np.zeros(3)
            at[axis] = side * half
            slabs.append(Piece(box(*size), at))
    vertices, faces = CORNERS * half, FACES.astype(np.int64)
    vertices.flags.writeable = faces.flags.writeable = False
    return Body(name, tuple(slabs), (vertices, faces) if hollow else None)


def found(scene: Scene, plan: Plan) -> list[str]:
    """What is not shown to be outside, in a plan with rows made for this scene."""
    findings = check(scene, proved(scene, plan.trajectory, plan.legs, plan.arrivals)).findings
    assert {finding.code for finding in findings} <= {Code.CONTAINMENT}
    return [finding.what for finding in findings]


def test_an_arm_in_a_closed_room_is_inside_its_walls() -> None:
    """The rows keep it off all six walls; the room is solid, and only the surface says so."""
    _, plan = crossing_case()
    room = shell("room", 1.5)
    scene = crossing(bodies=(WorldBody(room),))
    inside = proved(scene, plan.trajectory, plan.legs, plan.arrivals)
    verdict = check(scene, inside)
    assert {finding.code for finding in verdict.findings} == {Code.CONTAINMENT}
    assert {finding.what for finding in verdict.findings} == {
        f"{name} begins inside room" for name in ("column", "upper arm", "forearm", "quill", "cup")
    }
    open_room = crossing(bodies=(WorldBody(shell("room", 1.5, hollow=False)),))
    assert check(open_room, proved(open_room, plan.trajectory, plan.legs, plan.arrivals)).findings == ()


@pytest.mark.parametrize(("x", "wanted"), [(0.3, ["cup begins inside block"]), (0.5, [])])
def test_a_tool_in_a_block_is_found_and_beside_it_is_not(x: float, wanted: list[str]) -> None:
    _, plan = crossing_case()
    scene = crossing(bodies=(WorldBody(shell("block", 0.06), "world", Pose(x, -0.1, 0.08, 0.3)),))
    assert found(scene, plan) == wanted


def test_a_small_body_inside_a_hollow_tool_is_found() -> None:
    _, plan = crossing_case()
    pebble = WorldBody(solid("pebble", sphere(1e-3)), "world", Pose(0.3, -0.1, 0.1))
    scene = crossing(bodies=(pebble,))
    bell = Body("bell", shell("bell", 0.02).pieces, shell("bell", 0.02).surface)
    for height, wanted in ((-0.03, ["pebble begins inside bell"]), (0.2, [])):
        up = np.array([0.0, 0.0, height])
        moved = Body("bell", tuple(Piece(p.shape, p.position + up) for p in bell.pieces), _moved(bell, height))
        assert found(replace(scene, tool=replace(scene.tool, bodies=(moved,))), plan) == wanted


def _moved(body: Body, height: float) -> tuple[np.ndarray, np.ndarray]:
    assert body.surface is not None
    vertices = body.surface[0] + np.array([0.0, 0.0, height])
    vertices.flags.writeable = False
    return vertices, body.surface[1]


def test_a_part_is_asked_from_when_it_becomes_the_robots() -> None:
    """Nobody asks a part on the belt against another body of the cell; once it is picked, everybody does."""
    scene, plan = belt_case()
    hood = WorldBody(shell("hood", 0.05), "belt", Pose(-0.1, 0.0, 0.06))
    covered = replace(scene, bodies=(*scene.bodies, hood))
    whats = found(covered, plan)
    assert "part begins inside hood" in whats
    names = ("hood",)
    task = (replace(scene.task[0], contact_with=names), *scene.task[1:])  # type: ignore[arg-type]
    # In contact with it the part may leave; when the contact ends it is outside.
    late = found(replace(covered, task=task), plan)
    assert "part begins inside hood" in late
    assert whats.count("part begins inside hood") == late.count("part begins inside hood") == 1
