"""Phases against a second derivation: a small simulation of the shop, event by event."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import Body, Piece, Primitive, box, cylinder
from assur.planner.laws import Frame, conveyor, fixed, linear, turntable
from assur.planner.model.outcome import Arrival, Leg, LegKind
from assur.planner.model.phases import AT_START, Phase, pair, phases, resting_on, yaw_offsets
from assur.planner.model.scene import Execution, Follow, Move, Options, Pick, Place, Scene, Step, Target, WorldBody
from tests.planner.checker.hand_made import TOOL, arm, solid, start_at

FRAMES = {
    "world": Frame("world", fixed(Pose())),
    "belt": Frame("belt", conveyor(Pose(0.1, 0.3, 0.05, 0.4), 0.2)),
    "dial": Frame("dial", turntable(Pose(0.25, -0.1, 0.02, -0.3), 0.5)),
}
BELTS = ("belt",)
"""Frames whose way an encoder counts."""
PARTS = ("red", "blue")
SHIFTS = Execution(belt_correction=True)
BODIES = (
    WorldBody(solid("table", box(2.0, 2.0, 0.1)), "world", Pose(z=-0.05)),
    WorldBody(solid("bed", box(1.0, 0.2, 0.04)), "belt", Pose(z=-0.02)),
    WorldBody(solid("plate", cylinder(0.1, 0.02)), "dial", Pose(z=0.03)),
    WorldBody(solid("red", box(0.04, 0.03, 0.02)), "belt", Pose(-0.2, 0.01, 0.01, 0.3), yaw_symmetry=2),
    WorldBody(solid("blue", cylinder(0.02, 0.04)), "world", Pose(0.2, 0.2, 0.02), yaw_symmetry=0),
)


Matrix = FloatArray


def scene(task: tuple[Step, ...], **options: object) -> Scene:
    robot = arm()
    start = start_at(robot, TOOL.tcp, Pose(0.3, 0.0, 0.2))
    return Scene(robot, TOOL, start, FRAMES, BODIES, task, Options(**options), SHIFTS)  # type: ignore[arg-type]


small = st.floats(-0.1, 0.1)
angles = st.sampled_from([0.0, math.pi / 2, -2.0]) | st.floats(-3, 3)
poses = st.builds(Pose, small, small, small, angles)
frames = st.sampled_from(sorted(FRAMES))
heights = st.sampled_from([0.0, 0.03])
contacts = st.sampled_from([None, (), ("table",), ("plate", "table")])


@st.composite
def tasks(draw: st.DrawFn) -> tuple[Step, ...]:
    """Moves, follows, picks and places, in an order that can be done; parts change their places many times."""
    found: list[Step] = []
    holds: str | None = None
    for i in range(draw(st.integers(1, 6))):
        kind = draw(st.sampled_from(["move", "follow", "handle", "handle"]))
        target = Target(draw(frames), draw(poses), draw(st.booleans()))
        if kind == "move":
            found.append(Move(f"step {i}", target))
        elif kind == "follow":
            found.append(Follow(f"step {i}", target, 0.1))
        elif holds is None:
            holds = draw(st.sampled_from(PARTS))
            ways = draw(heights), 0.1, draw(heights)
            found.append(Pick(f"step {i}", holds, draw(poses), *ways, contact_with=draw(contacts)))
        else:
            target = replace(target, yaw_free=False)
            ways = draw(heights), 0.1, draw(heights)
            found.append(Place(f"step {i}", holds, target, *ways, contact_with=draw(contacts)))
            holds = None
    return tuple(found)


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


def matrix(pose: Pose) -> Matrix:
    c, s = math.cos(pose.yaw), math.sin(pose.yaw)
    return np.array([[c, -s, 0, pose.x], [s, c, 0, pose.y], [0, 0, 1, pose.z], [0, 0, 0, 1]])


@dataclass
class Shop:
    """What lies where, what the gripper holds and how, and what may touch, with 4 × 4 matrices."""

    scene: Scene
    lies: dict[str, tuple[str, Matrix]] = field(default_factory=dict)
    holds: str | None = None
    grip: Matrix | None = None

    def __post_init__(self) -> None:
        self.lies = {body.name: (body.frame, matrix(body.pose)) for body in self.scene.bodies}

    def bottom_and_top(self, name: str) -> tuple[float, float]:
        """In the world, at the start, where the body lies now; all shapes here are symmetric boxes and cylinders."""
        frame, at = self.lies[name]
        level = float(self.scene.frames[frame].law.motion(np.array(0.0)).p[2]) + at[2, 3]
        shape = self.scene.index[name].body.pieces[0].shape
        half = shape.half[2]  # type: ignore[union-attr]
        return level - half, level + half

    def under(self, step: Pick | Place) -> set[str]:
        if step.contact_with is not None:
            return set(step.contact_with)
        if isinstance(step, Place):
            laid = Shop(self.scene, dict(self.lies))
            laid.lies = {**self.lies, step.part: (step.to.frame, matrix(step.to.pose))}
            return laid.found_under(step.part)
        return self.found_under(step.part)

    def found_under(self, part: str) -> set[str]:
        bottom = self.bottom_and_top(part)[0]
        (centre, wide), found = self.circle(part), set()
        for name in self.lies:
            other, its = self.circle(name)
            level = abs(self.bottom_and_top(name)[1] - bottom) <= 1e-4
            if name != part and level and np.linalg.norm(other - centre) <= wide + its:
                found.add(name)
        return found

    def circle(self, name: str) -> tuple[FloatArray, float]:
        """Seen from above: the centre of a body and the radius of the circle that holds it, at time 0."""
        frame, at = self.lies[name]
        motion = self.scene.frames[frame].law.motion(np.array(0.0))
        x, y, z = motion.p.tolist()
        world = matrix(Pose(x, y, z, float(motion.yaw))) @ at
        shape = self.scene.index[name].body.pieces[0].shape
        assert isinstance(shape, Primitive)
        return world[:2, 3], math.hypot(*shape.half[:2]) + shape.disc + shape.ball


@dataclass(frozen=True)
class Wanted:
    """What a phase must be."""

    span: tuple[float, float]
    holds: str | None
    grip: Matrix | None
    moved: dict[str, tuple[str, Matrix]]
    touching: set[tuple[str, str]]
    frame: str | None


def simulated(scene: Scene, legs: tuple[Leg, ...], turns: dict[int, float]) -> list[Wanted]:
    shop = Shop(scene)
    start = dict(shop.lies)
    cups = [body.name for body in scene.tool.bodies]
    found: list[Wanted] = []

    def note(span: tuple[float, float], touching: set[tuple[str, str]], frame: str | None) -> None:
        moved = {
            name: (on, at)
            for name, (on, at) in shop.lies.items()
            if on != start[name][0] or not np.array_equal(at, start[name][1])
        }
        found.append(Wanted(span, shop.holds, shop.grip, moved, touching, frame))

    for leg in legs:
        step = scene.task[leg.step]
        touching: set[tuple[str, str]] = set()
        frame = None
        if leg.kind in (LegKind.APPROACH, LegKind.FOLLOW, LegKind.DEPART):
            if isinstance(step, Pick | Place):
                frame = step.to.frame if isinstance(step, Place) else shop.lies[step.part][0]
                in_hand = shop.holds is not None
                touching = {pair(step.part, name) for name in (shop.under(step) if in_hand else cups)}
            else:
                frame = step.target.frame
        note((leg.t0, leg.t1), touching, frame)
        if leg.kind is LegKind.FOLLOW and isinstance(step, Pick):
            shop.holds = step.part
            tool_in_part = matrix(Pose(yaw=turns.get(leg.step, 0.0))) @ matrix(step.grasp)
            shop.grip = matrix(scene.tool.tcp) @ np.linalg.inv(tool_in_part)
        if leg.kind is LegKind.FOLLOW and isinstance(step, Place):
            shop.lies[step.part] = (step.to.frame, matrix(step.to.pose))
            shop.holds = shop.grip = None
    if scene.options.end == "rest" and scene.options.stay_safe_s > 0:
        note((legs[-1].t1, legs[-1].t1 + scene.options.stay_safe_s), set(), None)
    return found


def same(phase: Phase, wanted: Wanted, around: tuple[str | None, ...]) -> None:
    assert (phase.t0, phase.t1) == wanted.span
    assert (None if phase.attached.held is None else phase.attached.held.part) == wanted.holds
    if phase.attached.held is not None:
        assert wanted.grip is not None
        assert np.allclose(matrix(phase.attached.held.in_flange), wanted.grip, atol=1e-12)
    assert {name for name, _, _ in phase.attached.placed} == set(wanted.moved)
    for name, frame, pose in phase.attached.placed:
        on, at = wanted.moved[name]
        assert frame == on
        assert np.allclose(matrix(pose), at, atol=1e-12)
    assert phase.contacts == wanted.touching
    assert phase.tracked == wanted.frame
    assert set(phase.corrected) == ({frame for frame in around if frame in BELTS} if wanted.frame is None else set())


@given(tasks(), st.booleans(), st.booleans(), st.sampled_from([0.0, 0.5]), st.sampled_from(["rest", "moving"]), angles)
def test_phases_are_what_happens_in_the_shop(
    task: tuple[Step, ...], waits: bool, rest: bool, stay: float, end: str, turn: float
) -> None:
    cell = scene(task, stay_safe_s=stay, end=end)
    legs = legs_of(task, waits, rest)
    turns = {i: turn * (i + 1) for i, step in enumerate(task) if isinstance(step, Pick)}
    arrivals = tuple(Arrival(i, step.name, 0.0, 0.0, Pose(), True, turns.get(i, 0.0)) for i, step in enumerate(task))
    found, wanted = phases(cell, legs, arrivals), simulated(cell, legs, turns)
    assert len(found) == len(wanted)
    followed = [each.frame for each in wanted]
    for i, (phase, each) in enumerate(zip(found, wanted, strict=True)):
        earlier, later = [f for f in followed[:i] if f], [f for f in followed[i:] if f]
        same(phase, each, (*earlier[-1:], *later[:1]))
        assert phase.near == (phase.kind in (LegKind.APPROACH, LegKind.FOLLOW, LegKind.DEPART))
    assert all(a.t1 == b.t0 for a, b in pairwise(found))


@given(poses, poses, angles, frames)
def test_a_part_that_is_put_down_comes_to_lie_where_it_was_asked(
    grasp: Pose, to: Pose, turn: float, frame: str
) -> None:
    pick = Pick("take", "red", grasp, 0.0, 0.1, 0.0)
    place = Place("put", "red", Target(frame, to), 0.0, 0.1, 0.0)
    cell = scene((pick, place))
    attached = AT_START.after(cell, pick, turn)
    assert attached.held is not None
    in_flange = attached.held.in_flange
    on, flange = attached.flange(cell, place)
    assert on == frame
    assert np.allclose(matrix(flange) @ matrix(in_flange), matrix(to), atol=1e-12)
    # ... and at the pick the gripper is where the part then is in it.
    on, flange = AT_START.flange(cell, pick, turn)
    assert on == "belt"
    lies = matrix(cell.index["red"].pose)
    assert np.allclose(matrix(flange) @ matrix(in_flange), lies, atol=1e-12)
    tool = matrix(flange) @ matrix(cell.tool.tcp)
    assert np.allclose(tool, lies @ matrix(Pose(yaw=turn)) @ matrix(grasp), atol=1e-12)


def test_what_is_not_held_cannot_be_placed() -> None:
    pick, place = Pick("take", "red", Pose(), 0.0, 0.1, 0.0), Place("put", "red", Target("dial", Pose()), 0.0, 0.1, 0.0)
    cell = scene((pick, place))
    taken = AT_START.after(cell, pick)
    assert taken.held is not None
    for attached in (AT_START, replace(taken, held=replace(taken.held, part="blue"))):
        with pytest.raises(InputError, match="earlier pick"):
            attached.flange(cell, place)


def test_a_part_that_is_put_back_sits_as_at_the_start() -> None:
    pick, away = Pick("take", "red", Pose(), 0.0, 0.1, 0.0), Place("put", "red", Target("dial", Pose()), 0.0, 0.1, 0.0)
    cell = scene((pick, away))
    seat = AT_START.pose_of(cell, "red")
    moved = AT_START.after(cell, pick).after(cell, away)
    assert (moved.held, moved.placed) == (None, (("red", "dial", Pose()),))
    assert moved.pose_of(cell, "red") == ("dial", Pose())
    back = replace(away, to=Target(*seat))
    assert moved.after(cell, replace(pick, name="again")).after(cell, back) == AT_START


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
