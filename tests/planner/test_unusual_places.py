"""Warnings about places: parts released in the air, tools beside their part, parts inside other bodies; and what is
usual is not told."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from assur.planner.collision.proof import Prover
from assur.planner.feasibility.hits import AtStart
from assur.planner.feasibility.input_warnings import DROP_M, GRIP_M, OVERLAP_M, unusual_places
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import box, cylinder
from assur.planner.laws import turntable
from assur.planner.model.input_warning import InputWarning, Odd
from assur.planner.model.scene import Pick, Place, Scene, Tool
from assur.planner.pipeline import plan
from assur.planner.report.notes import warned
from tests.planner.cells import BARE, Around, belt_and_dial, frame, mesh_box, solid, stands, table_to_table


def odd(scene: Scene) -> tuple[InputWarning, ...]:
    return unusual_places(scene, AtStart(scene, Prover(scene)))


def placed(by: float, **changes: Any) -> Scene:
    """`table_to_table`, with the part put down so far above the right table."""
    scene = table_to_table()
    pick, place = scene.task
    assert isinstance(place, Place)
    pose = place.to.pose
    there = replace(place.to, pose=replace(pose, z=pose.z + by))
    return replace(scene, task=(pick, replace(place, to=there, **changes)))


def gripped(beside: float, up: float = 0.0, **changes: Any) -> Scene:
    """`table_to_table`, with the tool point so far beside the part, or above it; the cup's radius is 15 mm."""
    scene = table_to_table(**changes)
    pick, place = scene.task
    assert isinstance(pick, Pick)
    grasp = replace(pick.grasp, x=pick.grasp.x + beside, z=pick.grasp.z + up)
    return replace(scene, task=(replace(pick, grasp=grasp), place))


def inside(depth: float) -> Scene:
    """`table_to_table`, with the part so deep in its table."""
    scene = table_to_table()
    bodies = [replace(b, pose=replace(b.pose, z=b.pose.z - depth)) if b.name == "part" else b for b in scene.bodies]
    return replace(scene, bodies=tuple(bodies))


@pytest.mark.parametrize("by", [DROP_M + 0.0005, 0.01, 0.1])
def test_a_part_released_in_the_air_is_told_with_its_height_above_what_is_below_it(by: float) -> None:
    (warning,) = odd(placed(by))
    assert (warning.kind, warning.bodies) == (Odd.RELEASED_IN_AIR, ("part", "right-table"))
    assert warning.amount_m == pytest.approx(by, abs=1e-9)
    assert warned(warning).startswith(f"part is released {1e3 * by:.3g} mm above right-table")


@pytest.mark.parametrize("by", [0.0, DROP_M - 0.0005, -0.00005])
def test_a_part_that_is_put_down_or_dropped_a_little_is_not(by: float) -> None:
    assert odd(placed(by)) == ()


def test_a_place_that_says_what_the_part_rests_on_and_one_above_nothing_at_all_are_not() -> None:
    assert odd(placed(0.05, contact_with=("right-table",))) == ()
    scene = placed(0.05)
    assert odd(replace(scene, bodies=tuple(body for body in scene.bodies if body.name != "right-table"))) == ()


def test_a_part_put_down_on_the_floor_of_a_hollow_mesh_or_on_another_part_is_not() -> None:
    """A hollow box 40 mm high with a floor of 2 mm, in place of the table; and one part on top of the other."""
    scene = table_to_table()
    tray = Around(mesh_box("right-table", 0.2, 0.2, 0.04), "world", Pose(0.35, -0.25, 0.02))
    inner = replace(placed(-0.04 + 0.002), bodies=(scene.bodies[0], tray, scene.bodies[2]))
    assert odd(inner) == ()
    high = replace(placed(-0.04 + 0.007), bodies=(scene.bodies[0], tray, scene.bodies[2]))
    assert odd(high) == ()  # nothing lies wholly below it, so no height is told
    pick, place = scene.task
    assert isinstance(pick, Pick)
    assert isinstance(place, Place)
    other = replace(scene.bodies[2], body=replace(scene.bodies[2].body, name="second"), pose=Pose(0.25, 0.22, 0.05))
    above = replace(place.to, pose=replace(place.to.pose, z=place.to.pose.z + 0.02))
    again = (replace(pick, name="pick-2", part="second"), replace(place, name="place-2", part="second", to=above))
    stacked = replace(scene, bodies=(*scene.bodies, other), task=(pick, place, *again))
    assert odd(stacked) == ()
    apart = replace(again[1], to=replace(above, pose=replace(above.pose, z=above.pose.z + 0.01)))
    (warning,) = odd(replace(stacked, task=(pick, place, again[0], apart)))
    assert warning.bodies == ("second", "part")
    assert warning.amount_m == pytest.approx(0.01, abs=1e-9)


def test_a_place_among_what_moves_is_not_looked_at() -> None:
    assert odd(belt_and_dial()) == ()
    scene = placed(0.05)
    dial = frame("dial", turntable(Pose(-0.5, 0.0, 0.0), 1.0))
    plate = Around(solid("plate", cylinder(0.05, 0.01)), "dial", Pose())
    assert odd(replace(scene, frames={**scene.frames, "dial": dial}, bodies=(*scene.bodies, plate))) == ()


@pytest.mark.parametrize(("beside", "up"), [(0.0, GRIP_M + 0.002), (0.03 + 0.015 + GRIP_M + 0.002, 0.0), (0.0, 0.2)])
def test_a_tool_that_grips_beside_its_part_is_told(beside: float, up: float) -> None:
    (warning,) = odd(gripped(beside, up))
    assert (warning.kind, warning.bodies) == (Odd.TOOL_OFF_PART, ("cup", "part"))
    assert warned(warning).startswith("no body of the tool touches part where it is picked")


@pytest.mark.parametrize(("beside", "up"), [(0.0, 0.0), (0.0, GRIP_M - 0.002), (0.0, -0.005), (0.03, 0.0)])
def test_a_tool_that_touches_its_part_or_is_near_it_is_not(beside: float, up: float) -> None:
    assert odd(gripped(beside, up)) == ()


def test_a_tool_without_bodies_is_not_and_one_whose_body_ends_above_its_point_is() -> None:
    assert odd(gripped(0.0, 0.2, tool=BARE)) == ()
    short = Tool(Pose(z=-0.06), (solid("cup", cylinder(0.015, 0.02), 0.0, 0.0, -0.01),))
    (warning,) = odd(gripped(0.0, tool=short))
    assert warning.kind is Odd.TOOL_OFF_PART


@pytest.mark.parametrize("depth", [OVERLAP_M + 0.0005, 0.01])
def test_a_part_inside_what_it_stands_on_is_told(depth: float) -> None:
    (warning,) = odd(inside(depth))
    assert (warning.kind, warning.bodies) == (Odd.BODIES_OVERLAP, ("left-table", "part"))
    assert warned(warning) == "left-table and part overlap by more than 1 mm where they are at the start"


@pytest.mark.parametrize("depth", [0.0, OVERLAP_M - 0.0002, -0.02])
def test_a_part_that_stands_on_something_is_not(depth: float) -> None:
    assert odd(inside(depth)) == ()


def test_fixtures_made_of_shapes_that_overlap_are_not() -> None:
    scene = table_to_table()
    post = stands("post", box(0.05, 0.05, 0.2), 0.35, -0.25, -0.07)
    assert odd(replace(scene, bodies=(*scene.bodies, post))) == ()


def test_the_warnings_are_in_answers_with_and_without_a_plan() -> None:
    told = plan(placed(0.01))
    assert [each.kind for each in told.warnings] == [Odd.RELEASED_IN_AIR]
