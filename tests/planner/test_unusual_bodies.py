"""Warnings: what is probably not meant is told, with the number, and what is usual is not."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from assur.planner.collision.proof import Prover
from assur.planner.feasibility.hits import AtStart
from assur.planner.feasibility.input_warnings import FLOAT_M, MOUNT_M, unusual_bodies
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import Body, box, cylinder
from assur.planner.model.input_warning import InputWarning, Odd
from assur.planner.model.scene import Holding, Pick, Scene, Tool
from assur.planner.pipeline import plan
from assur.planner.report.notes import warned
from tests.planner.cells import PART, Around, cell, go, mesh_box, solid, stands, table_to_table


def odd(scene: Scene) -> tuple[InputWarning, ...]:
    return unusual_bodies(scene, AtStart(scene, Prover(scene)))


def lifted(by: float, **changes: Any) -> Scene:
    """The part of `table_to_table`, `by` above the table."""
    scene = table_to_table(**changes)
    bodies = [replace(b, pose=replace(b.pose, z=b.pose.z + by)) if b.name == "part" else b for b in scene.bodies]
    return replace(scene, bodies=tuple(bodies))


@pytest.mark.parametrize("by", [0.0002, 0.003, 0.0099])
def test_a_part_that_floats_is_told_with_its_height_above_what_is_below_it(by: float) -> None:
    (warning,) = odd(lifted(by))
    assert (warning.kind, warning.bodies) == (Odd.PART_FLOATS, ("part", "left-table"))
    assert warning.amount_m == pytest.approx(by, abs=1e-6)
    assert warned(warning).startswith(f"part is {1e3 * by:.3g} mm above left-table")


@pytest.mark.parametrize("by", [0.0, 0.00005, -0.00005, FLOAT_M + 0.001, 0.1])
def test_a_part_that_rests_or_is_held_up_by_nothing_that_is_in_the_model_is_not(by: float) -> None:
    assert odd(lifted(by)) == ()


def test_a_part_whose_supports_are_named_and_one_in_the_gripper_are_not() -> None:
    scene = lifted(0.003)
    assert isinstance(scene.task[0], Pick)
    named = replace(scene.task[0], contact_with=("left-table",))
    assert odd(replace(scene, task=(named, *scene.task[1:]))) == ()
    start = replace(scene.start, holding=Holding("part", Pose(z=0.01)))
    assert odd(replace(scene, start=start, task=scene.task[1:])) == ()


def test_what_is_beside_a_part_and_lower_is_not_below_it() -> None:
    """Circles about both overlap, the bodies do not: 1 mm of air between the part's side and the block's."""
    block = stands("block", box(0.1, 0.1, 0.03), 0.25 + 0.03 + 0.05 + 0.001, 0.30, 0.042)
    scene = lifted(0.02)
    part = replace(scene.bodies[2], pose=replace(scene.bodies[2].pose, yaw=0.0))
    assert odd(replace(scene, bodies=(*scene.bodies[:2], part, block))) == ()
    under = replace(block, pose=replace(block.pose, x=block.pose.x - 0.002))
    (warning,) = odd(replace(scene, bodies=(*scene.bodies[:2], part, under)))
    assert warning.bodies == ("part", "block")
    assert warning.amount_m == pytest.approx(0.06 - 0.057, abs=1e-6)


def test_a_part_above_the_floor_of_a_hollow_mesh_floats_though_it_is_below_the_rim() -> None:
    """A hollow box, 40 mm high; its floor is 2 mm thick."""
    tray = Around(mesh_box("tray", 0.2, 0.2, 0.04), "world", Pose(0.25, 0.30, 0.02))
    bodies = lifted(0.0).bodies

    def at_height(z: float) -> tuple[InputWarning, ...]:
        part = replace(bodies[2], pose=Pose(0.25, 0.30, z))
        scene = table_to_table(shape=PART)
        return odd(replace(scene, bodies=(tray, bodies[1], part)))

    (warning,) = at_height(0.002 + 0.004 + 0.01)
    assert (warning.kind, warning.bodies) == (Odd.PART_FLOATS, ("part", "tray"))
    assert warning.amount_m == pytest.approx(0.004, abs=2e-4)
    assert at_height(0.002 + 0.01 + 0.00002) == ()


def with_tool(*bodies: Body, **more: Any) -> Scene:
    return cell(go(0.35, -0.2), tool=Tool(Pose(z=-0.06), bodies), **more)


def test_a_tool_that_reaches_into_the_link_it_is_mounted_on_is_told_beyond_what_a_mount_does() -> None:
    """The quill ends at the flange; the tool's upper end is so far above it."""
    for overlap, wrong in ((0.0, False), (MOUNT_M - 0.001, False), (MOUNT_M + 0.001, True), (0.1, True)):
        tool = solid("cup", cylinder(0.015, 0.1), 0.0, 0.0, overlap - 0.05)
        found = odd(with_tool(tool))
        assert [each.kind for each in found] == [Odd.TOOL_IN_ARM] * wrong, overlap
        if wrong:
            assert found[0].bodies == ("cup", "quill")
            assert "overlaps quill of the arm by more than 30 mm" in warned(found[0])


def test_a_tool_in_a_link_from_which_nothing_keeps_it_apart_is_told() -> None:
    """A camera 300 mm beside the flange, as high as link 2: inside it where the elbow is, beside it where not."""
    scene = with_tool()
    link = next(each for each in scene.robot.bodies if scene.robot.links[each.link] == "link2")
    prover = Prover(scene)
    flange, arm = (prover.carriers(scene.start.q, 0.0)[scene.robot.links.index(name)] for name in ("flange", "link2"))
    local = flange[3:].reshape(3, 3).T @ (arm[:3] - flange[:3])
    height = float(local[2]) + sum(link.body.heights) / 2
    assert scene.robot.self_pairs == ()
    for beside, wrong in ((0.0, True), (1.0, False)):
        camera = solid("camera", box(0.03, 0.03, 0.03), float(local[0]), float(local[1]) + beside, height)
        told = odd(with_tool(camera))
        assert [each.bodies for each in told] == [("camera", link.body.name)] * wrong
        if wrong:
            assert told[0].amount_m == 0.0


def test_warnings_refuse_nothing_and_are_in_both_answers() -> None:
    told = plan(with_tool(solid("cup", cylinder(0.015, 0.1), 0.0, 0.0, 0.0)))
    assert [each.kind for each in told.warnings] == [Odd.TOOL_IN_ARM]
    refused = plan(replace(lifted(0.003), task=(*lifted(0.003).task[:1], go(2.0, 0.0))))
    assert [each.kind for each in refused.warnings] == [Odd.PART_FLOATS]
    assert type(told).__name__ == "Planned"
    assert type(refused).__name__ == "NotPlanned"
    assert np.isfinite([each.amount_m for each in (*told.warnings, *refused.warnings)]).all()
