"""Phases: what a part that is put down rests on, the turns that look the same, and what cannot be placed."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import strategies as st

from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import Body, Piece, box, cylinder
from assur.planner.laws import Frame, conveyor, fixed, linear, turntable
from assur.planner.model.attachments import AT_START
from assur.planner.model.outcome import Leg, LegKind
from assur.planner.model.phases import phases, resting_on, yaw_offsets
from assur.planner.model.scene import Execution, Follow, Move, Options, Pick, Place, Scene, Step, Target, WorldBody
from tests.planner.checker.hand_made import TOOL, arm, solid, start_at

FRAMES = {
    "world": Frame("world", fixed(Pose())),
    "belt": Frame("belt", conveyor(Pose(0.1, 0.3, 0.05, 0.4), 0.2)),
    "dial": Frame("dial", turntable(Pose(0.25, -0.1, 0.02, -0.3), 0.5)),
}
SHIFTS = Execution(belt_correction=True)
BODIES = (
    WorldBody(solid("table", box(2.0, 2.0, 0.1)), "world", Pose(z=-0.05)),
    WorldBody(solid("bed", box(1.0, 0.2, 0.04)), "belt", Pose(z=-0.02)),
    WorldBody(solid("plate", cylinder(0.1, 0.02)), "dial", Pose(z=0.03)),
    WorldBody(solid("red", box(0.04, 0.03, 0.02)), "belt", Pose(-0.2, 0.01, 0.01, 0.3), yaw_symmetry=2),
    WorldBody(solid("blue", cylinder(0.02, 0.04)), "world", Pose(0.2, 0.2, 0.02), yaw_symmetry=0),
)


def scene(task: tuple[Step, ...], **options: object) -> Scene:
    robot = arm()
    start = start_at(robot, TOOL.tcp, Pose(0.3, 0.0, 0.2))
    return Scene(robot, TOOL, start, FRAMES, BODIES, task, Options(**options), SHIFTS)  # type: ignore[arg-type]


small = st.floats(-0.1, 0.1)
frames = st.sampled_from(sorted(FRAMES))
contacts = st.sampled_from([None, (), ("table",), ("plate", "table")])


def legs_of(task: tuple[Step, ...], waits: bool, rest: bool) -> tuple[Leg, ...]:
    found: list[Leg] = []

    def add(kind: LegKind, step: int) -> None:
        found.append(Leg(kind, step, 0.1 * len(found), 0.1 * (len(found) + 1)))

    for i, step in enumerate(task):
        if waits:
            add(LegKind.WAIT, i)
        add(LegKind.MOVE, i)
        if isinstance(step, Move):
            continue
        if isinstance(step, Pick | Place) and step.approach_m > 0:
            add(LegKind.APPROACH, i)
        add(LegKind.FOLLOW, i)
        if isinstance(step, Pick | Place) and step.depart_m > 0:
            add(LegKind.DEPART, i)
    if rest:
        add(LegKind.MOVE, len(task) - 1)
    return tuple(found)


def test_what_is_not_held_cannot_be_placed() -> None:
    pick, place = Pick("take", "red", Pose(), 0.0, 0.1, 0.0), Place("put", "red", Target("dial", Pose()), 0.0, 0.1, 0.0)
    cell = scene((pick, place))
    taken = AT_START.after(cell, pick)
    assert taken.held is not None
    for attached in (AT_START, replace(taken, held=replace(taken.held, part="blue"))):
        with pytest.raises(InputError, match="earlier pick"):
            attached.flange(cell, place)


def test_a_symmetric_part_leaves_the_turns_that_look_the_same() -> None:
    target = Target("world", Pose())
    red = Pick("a", "red", Pose(), 0.0, 0.1, 0.0)
    blue = replace(red, part="blue")
    cell = scene((red,))
    assert yaw_offsets(cell, red) == pytest.approx((0.0, math.pi))
    assert yaw_offsets(cell, blue) is None
    assert yaw_offsets(cell, Move("m", target)) == (0.0,)
    assert yaw_offsets(cell, Move("m", replace(target, yaw_free=True))) is None
    assert yaw_offsets(cell, Follow("f", replace(target, yaw_free=True), 0.1)) is None
    assert yaw_offsets(cell, Place("p", "red", replace(target, yaw_free=True), 0.0, 0.1, 0.0)) == (0.0,)


def test_a_part_rests_on_what_ends_where_it_begins() -> None:
    cell = scene((Move("m", Target("world", Pose())),))
    assert resting_on(cell, "red", "belt", Pose(z=0.01), None) == {"bed"}
    assert resting_on(cell, "red", "belt", Pose(z=0.0102), None) == frozenset()
    assert resting_on(cell, "red", "dial", Pose(z=0.05), None) == {"plate"}
    assert resting_on(cell, "red", "world", Pose(z=0.01), None) == {"table"}
    assert resting_on(cell, "red", "world", Pose(z=0.01), ("plate",)) == {"plate"}


def test_a_part_may_be_put_on_one_that_was_put_before() -> None:
    """Stacking: the blue part lies on the dial by then, no longer on the table."""
    task = (
        Pick("take blue", "blue", Pose(), 0.0, 0.1, 0.0),
        Place("put blue", "blue", Target("dial", Pose(z=0.06)), 0.0, 0.1, 0.0),
        Pick("take red", "red", Pose(), 0.0, 0.1, 0.0),
        Place("put red", "red", Target("dial", Pose(z=0.09)), 0.0, 0.1, 0.0),
    )
    cell = scene(task)
    found = phases(cell, legs_of(task, False, False), ())
    by_step = {phase.step: phase for phase in found if phase.kind is LegKind.FOLLOW}
    assert by_step[1].contacts == {("blue", "plate")}
    assert by_step[3].contacts == {("blue", "red")}


def test_only_the_first_piece_does_not_decide_how_high_a_body_is() -> None:
    steps = Body("steps", (Piece(box(0.1, 0.1, 0.1)), Piece(box(0.1, 0.1, 0.3), np.array([0.1, 0.0, 0.1]))))
    cell = scene((Move("m", Target("world", Pose())),))
    cell = replace(cell, bodies=(*cell.bodies, WorldBody(steps, "world", Pose(0.5, 0.5, 0.05))))
    assert resting_on(cell, "red", "world", Pose(0.5, 0.5, 0.31), None) == {"steps"}
    assert resting_on(cell, "red", "world", Pose(0.5, 0.5, 0.11), None) == frozenset()


def test_what_is_level_but_elsewhere_or_at_another_time_does_not_bear_a_part() -> None:
    """A plate on a lift beside the part, level with its bottom at the start only, is an obstacle like any other."""
    plate = WorldBody(solid("lifted", box(0.1, 0.1, 0.02)), "lift", Pose(z=-0.01))
    cell = scene((Move("m", Target("world", Pose())),))
    frames = {**cell.frames, "lift": Frame("lift", linear(Pose(0.06, 0.0, 0.5), (0.0, 0.0, 0.1)))}
    cell = replace(cell, frames=frames, bodies=(*cell.bodies, plate))
    assert resting_on(cell, "red", "world", Pose(z=0.51), None) == {"lifted"}
    assert resting_on(cell, "red", "world", Pose(z=0.51), None, time=0.3) == frozenset()
    assert resting_on(cell, "red", "world", Pose(0.4, 0.0, 0.51), None) == frozenset()
