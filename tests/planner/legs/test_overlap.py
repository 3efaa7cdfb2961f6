"""Moving ends of straight parts: parts of a fastest motion of the lift, from which it can stop within its range."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import box
from assur.planner.legs.control_point import MovingEnd, control_point
from assur.planner.legs.meeting import FARTHER, RANGE_M, entering, leaving, may_stop
from assur.planner.model.attachments import AT_START
from assur.planner.model.scene import Arch, Move, Pick, Place, Scene, Step, Target
from assur.planner.robots.robot import Robot
from assur.planner.timing import TimingRefusal
from assur.planner.trajectory import Trajectory
from tests.planner.cells import arm, cell, limits, stands
from tests.planner.timing.legs import time_joints

LIMITS = limits()
HEIGHT = 0.004
PICK = Pick("pick", "part", Pose(z=0.01), HEIGHT, 0.0, HEIGHT)
PLACE = Place("place", "part", Target("world", Pose(0.25, -0.2, 0.01)), HEIGHT, 0.0, HEIGHT)


def scene_of(*steps: Step, robot: Robot | None = None, carry: float | None = None, lift: float = 0.2) -> Scene:
    part = stands("part", box(0.03, 0.03, 0.02), 0.3, 0.1, 0.01, 0.0)
    found = cell(*steps, bodies=(part,), robot=arm() if robot is None else robot, q=(0.3, 1.2, lift, 0.0))
    return replace(found, carry_acceleration=carry)


def at(scene: Scene, step: int = 0) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Joints at the control point of the first step."""
    point = control_point(scene, step, AT_START, 0.0)
    return np.asarray(scene.robot.inverse(point.flange(np.array([0.0])), 0, 0).q[0])


def left(scene: Scene) -> MovingEnd | None:
    return leaving(scene, control_point(scene, 0, AT_START, 0.0), at(scene))


def entered(scene: Scene) -> MovingEnd | None:
    return entering(scene, control_point(scene, 0, AT_START, 0.0), at(scene))


def fastest(state: tuple[float, float, float], far: float) -> Trajectory:
    """The fastest motion of the lift to rest at `far`."""
    none, begin = np.zeros(1), [np.array([x]) for x in state]
    v, a, j = (np.array([rate[2]]) for rate in (LIMITS.velocity, LIMITS.acceleration, LIMITS.jerk))
    found = time_joints(begin[0], begin[1], begin[2], np.array([far]), none, none, v, a, j)
    assert not isinstance(found, TimingRefusal)
    return found


def test_a_straight_part_is_cut_from_a_fastest_motion_and_the_rest_of_it_stops_where_it_says() -> None:
    end = left(scene_of(PICK, PLACE))
    assert end is not None
    assert end.rate > 0.1
    h, v, a = (float(x[0, 0]) for x in end.profile.states(np.array([end.profile.duration])))
    assert (h, v, a) == (HEIGHT, end.rate, end.acceleration)
    assert end.far == pytest.approx(FARTHER * HEIGHT)
    whole = fastest((0.0, 0.0, 0.0), end.far)
    rest = fastest((h, v, a), end.far)
    assert end.profile.duration + rest.duration == pytest.approx(whole.duration, abs=1e-9)
    t = np.linspace(0, end.profile.duration, 200)
    heights = end.profile.states(t)[0][:, 0]
    assert (np.diff(heights) > 0).all()
    assert heights == pytest.approx(whole.states(t)[0][:, 0], abs=1e-10)


def test_an_approach_is_a_depart_backwards() -> None:
    up, down = left(scene_of(PICK, PLACE)), entered(scene_of(PICK, PLACE))
    assert up is not None
    assert down is not None
    assert (down.rate, down.acceleration, down.far) == (-up.rate, up.acceleration, up.far)
    t = np.linspace(0, up.profile.duration, 100)
    there, back = up.profile.states(t), down.profile.states(down.profile.duration - t)
    for one, other, sign in zip(there, back, (1, -1, 1), strict=True):
        assert one == pytest.approx(sign * other, abs=1e-9)


def test_a_motion_over_an_arch_stops_at_its_top() -> None:
    top = 0.09
    end = left(scene_of(PICK, replace(PLACE, arch=Arch(top))))
    assert end is not None
    assert end.far == pytest.approx(top - 0.02, abs=1e-9)


def test_a_held_part_slows_the_end_that_it_is_held_at() -> None:
    free, slow = left(scene_of(PICK, PLACE)), left(scene_of(PICK, PLACE, carry=4.0))
    assert free is not None
    assert slow is not None
    assert slow.rate < free.rate
    assert np.abs(slow.profile.qdd).max() <= 4.0
    # before the pick nothing is held
    assert entered(scene_of(PICK, PLACE, carry=4.0)) == entered(scene_of(PICK, PLACE))


def test_where_the_lift_has_no_room_there_is_no_moving_end() -> None:
    z = float(at(scene_of(PICK, PLACE))[2])
    ends = []
    for room in (1.1 * HEIGHT, 2 * HEIGHT):
        upper, lower = LIMITS.upper.copy(), LIMITS.lower.copy()
        upper[2], lower[2] = z + room + RANGE_M, z - 0.1
        cramped = replace(arm(), limits=replace(LIMITS, upper=upper, lower=lower))
        ends.append(left(scene_of(PICK, PLACE, robot=cramped, lift=z)))
    assert ends[0] is None
    assert ends[1] is not None
    assert ends[1].far == pytest.approx(2 * HEIGHT)


@pytest.mark.parametrize(
    ("steps", "why"),
    [
        ((replace(PICK, depart_stop=True), PLACE), "a stop is asked for"),
        ((replace(PICK, depart_m=0.0), PLACE), "there is no straight part"),
        ((PICK,), "the task ends"),
        ((PICK, Move("line", Target("world", Pose(0.3, 0.1, 0.2)), leg="cartesian"), PLACE), "a straight leg begins"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_the_tool_stops_where_it_has_to(steps: tuple[Step, ...], why: str) -> None:
    scene = scene_of(*steps)
    assert left(scene) is None, why
    assert not may_stop(scene, 0), why


def test_an_approach_with_a_stop_has_no_moving_end() -> None:
    assert entered(scene_of(replace(PICK, approach_stop=True), PLACE)) is None
    assert entered(scene_of(replace(PICK, approach_m=0.0), PLACE)) is None
