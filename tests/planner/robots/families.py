"""Robots of every family for the tests: those of the catalogue, and others with fewer axes, other lengths and bases."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Motion, Pose
from assur.planner.robots.facts import Limits
from assur.planner.robots.five_axis_arm import FiveAxisArm
from assur.planner.robots.robot import Robot
from assur.planner.robots.scara import Scara
from assur.planner.robots.tilting import ElbowArm, PolarArm
from assur.scenes.catalogue import arm_named, models
from tests.planner.robots.five_bars import five_bar

BASE, FAR = Pose(0.4, -0.7, 0.2, 2.5), Pose(-12.0, 30.0, -1.0, -9.0)
FREE_RAD = 4.0
"""Range of a revolute joint to either side: beyond π, so that a folded elbow is inside it."""
MARGIN = 0.05
"""Least singularity margin of a random state: what requests ask by default."""
STENCIL = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
"""Weights of the central first difference of order 8, over steps −4 … 4."""


def limits(lower: list[float], upper: list[float]) -> Limits:
    n = len(lower)
    return Limits(np.array(lower), np.array(upper), np.full(n, 7.0), np.full(n, 100.0), np.full(n, 5000.0))


def scara(axes: int = 4, base: Pose = BASE, l1: float = 0.325, l2: float = 0.225, *, arms_rise: bool = False) -> Scara:
    free = [FREE_RAD, FREE_RAD, 0.4, FREE_RAD]
    given = limits([-FREE_RAD, -FREE_RAD, 0.1, -FREE_RAD][:axes], free[:axes])
    return Scara(name="arm", l1=l1, l2=l2, axes=axes, limits=given, base=base, arms_rise=arms_rise)


def elbow(base: Pose = BASE, l1: float = 0.25, l2: float = 0.16) -> ElbowArm:
    free = [FREE_RAD] * 3
    return ElbowArm(name="elbow", height=0.3, l1=l1, l2=l2, limits=limits([-x for x in free], free), base=base)


def polar(base: Pose = BASE) -> PolarArm:
    given = limits([-FREE_RAD, -FREE_RAD, 0.2], [FREE_RAD, FREE_RAD, 0.6])
    return PolarArm(name="polar", height=0.4, limits=given, base=base)


def five_axis(base: Pose = BASE, l1: float = 0.25, l2: float = 0.16, l3: float = 0.072) -> FiveAxisArm:
    free = [FREE_RAD] * 5
    given = limits([-x for x in free], free)
    return FiveAxisArm(name="five", height=0.3, l1=l1, l2=l2, l3=l3, limits=given, base=base)


MADE: dict[str, Robot] = {
    "three-axis scara whose arms rise": scara(3, arms_rise=True),
    "far three-axis scara": scara(3, FAR),
    "scara whose arms rise": scara(arms_rise=True),
    "far scara": scara(base=FAR),
    "far elbow arm": elbow(FAR),
    "far polar arm": polar(FAR),
    "far five-axis arm": five_axis(FAR),
    "odd five-bar": five_bar("odd", base=BASE),
    "odd five-bar, back": five_bar("odd", base=BASE, assembly="back"),
    "even five-bar, back": five_bar("even", base=BASE, assembly="back"),
    "far five-bar with three axes": five_bar("odd", axes=3, base=FAR),
    "five-bar with two axes": five_bar("even", axes=2),
}
"""Robots that no catalogue has."""
NAMES = (*models(), *MADE)


@cache
def robot_named(name: str) -> Robot:
    """One of MADE, or the robot of a catalogue's entry at BASE, its revolute joints free to turn."""
    if name in MADE:
        return MADE[name]
    arm = arm_named(name)
    shipped = arm.robot(BASE, arm.limits)
    revolute = np.array([joint.kind == "revolute" for joint in shipped.joints])
    given = shipped.limits
    lower, upper = np.where(revolute, -FREE_RAD, given.lower), np.where(revolute, FREE_RAD, given.upper)
    return arm.robot(BASE, Limits(lower, upper, given.velocity, given.acceleration, given.jerk))


def far(robot: Robot) -> float:
    """How far away the base is, in metres or 1: what rounding in the world grows with."""
    return max(1.0, abs(robot.base.x), abs(robot.base.y))


def flange_of(robot: Robot) -> int:
    return robot.links.index("flange")


def random_q(robot: Robot, rng: np.random.Generator, size: int, mode: int | None = None) -> FloatArray:
    """States (size, n) with the margin, in one working mode if one is asked."""
    found = np.empty((0, len(robot.joints)))
    for _ in range(400):
        q = rng.uniform(robot.limits.lower, robot.limits.upper, (2 * size, len(robot.joints)))
        good = robot.within(q) & (robot.margin(q) >= MARGIN)
        found = np.concatenate([found, q[good if mode is None else good & (robot.mode_of(q) == mode)]])
        if len(found) >= size:
            return found[:size]
    raise AssertionError(f"{robot.name} is hardly ever in mode {mode}")


@cache
def _states(robot: Robot, seed: int, size: int, mode: int | None) -> FloatArray:
    found = random_q(robot, np.random.default_rng(seed), size, mode)
    found.setflags(write=False)
    return found


def random_motion(robot: Robot, seed: int, size: int, mode: int | None = None) -> tuple[FloatArray, ...]:
    """q, q̇, q̈, q⃛, each (size, n)."""
    known: Any = robot
    q, rng = _states(known, seed, size, mode), np.random.default_rng(seed)
    return q, *(scale * rng.normal(size=q.shape) for scale in (1.0, 10.0, 100.0))


def tilted(motion: Motion) -> Motion:
    assert motion.tilted
    return motion
