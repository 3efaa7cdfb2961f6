"""Full turns: every joint vector within limits that puts a robot where a given one does."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.frames.motion import Motion
from assur.planner.robots.facts import TURN, Code
from assur.planner.robots.robot import Robot

MOST_TURNS = 64
"""No joint of a robot turns more often between its stops (no unit): above it a unit was probably mistaken."""


def equivalents(robot: Robot, q: FloatArray, lower: FloatArray, upper: FloatArray) -> FloatArray:
    """All q + 2πk, k an integer per revolute joint, with lower <= q + 2πk <= upper: (M, n), ascending.

    The limits are arguments because a plan may keep to a narrower range than the robot's own. `q`, `lower`, `upper`
    are (n,), rad and m in the order of `robot.joints`. M is 0 when nothing fits, and when q is not finite.
    Prismatic joints are only held to their limits. Raises `InputError` when a range has more than 64 turns.
    """
    choices = []
    for joint, value, low, high in zip(robot.joints, q.tolist(), lower.tolist(), upper.tolist(), strict=True):
        if not math.isfinite(value):
            return np.empty((0, len(robot.joints)))
        if joint.kind == "revolute":
            if not high - low <= MOST_TURNS * TURN:
                raise InputError(f"limits of {joint.name}", [low, high], f"a range of up to {MOST_TURNS} turns")
            # One turn more on either side than the division says: the comparison below decides, without rounding.
            first, last = math.floor((low - value) / TURN), math.ceil((high - value) / TURN)
            turned = [value + k * TURN for k in range(first, last + 1)]
        else:
            turned = [value]
        choices.append([x for x in turned if low <= x <= high])
    return np.array(list(itertools.product(*choices)), dtype=np.float64).reshape(-1, len(choices))


def nearest_turns(robot: Robot, q: FloatArray) -> FloatArray:
    """q (..., n) with each revolute joint at the turn that is within the robot's range, or nearest to being so."""
    lower, upper = robot.limits.lower, robot.limits.upper
    turning = robot.revolute > 0.0
    # the first turn that is not below the range, and the last one that is
    first = np.where(turning, q + TURN * np.ceil((lower - q) / TURN), q)
    return np.where(turning & (lower - (first - TURN) < first - upper), first - TURN, first)


def beyond_range(robot: Robot, q: FloatArray) -> FloatArray:
    """By how much q (..., n) is beyond the robot's ranges, rad or m, revolute joints at the turn that is nearest to
    being within; 0 where a joint is within."""
    nearest = nearest_turns(robot, q)
    return np.asarray(np.maximum(np.maximum(robot.limits.lower - nearest, nearest - robot.limits.upper), 0.0))


# Inverse kinematics of one pose: the joint vectors of every working mode, at all full turns, or what a mode lacks.


@dataclass(frozen=True, eq=False)
class ModeSolutions:
    """What working mode number `mode` has for a pose of the flange.

    `found` (M, n): joint vectors within limits, ascending. Where there is none, `code` and these say why: `q` (n,),
    each joint at the turn that is nearest to its range, and `beyond` (n,), by how much it is outside (ASSEMBLED; both
    NaN where q is not defined); `short_m`, metres out of reach (OUT_OF_REACH); `parallel`, the parallel margin.
    """

    mode: int
    found: FloatArray
    code: Code
    q: FloatArray
    beyond: FloatArray
    short_m: float
    parallel: float


def solutions(robot: Robot, flange: Motion) -> tuple[ModeSolutions, ...]:
    """The solutions of each working mode for one pose of the flange, a motion of shape (), in the world.

    A stretched or folded arm, one over its base axis and one that is too near to a type 2 singularity are no solutions.
    Positions that are beyond the end of a range by rounding (`Limits.slack`) are given at the end.
    """
    return tuple(_of_mode(robot, flange, mode) for mode in range(len(robot.modes)))


def _of_mode(robot: Robot, flange: Motion, mode: int) -> ModeSolutions:
    inverse, limits = robot.inverse(flange, mode, 0), robot.limits
    code = Code(int(inverse.code))
    found = np.empty((0, len(robot.joints)))
    if code is Code.ASSEMBLED:
        low, high = limits.within
        found = np.minimum(np.maximum(equivalents(robot, inverse.q, low, high), limits.lower), limits.upper)
    return ModeSolutions(
        mode=mode,
        found=found,
        code=code,
        q=nearest_turns(robot, inverse.q),
        beyond=beyond_range(robot, inverse.q),
        short_m=_short(robot, flange, mode) if code is Code.OUT_OF_REACH else 0.0,
        parallel=1.0 if inverse.parallel is None else float(inverse.parallel),
    )


def _short(robot: Robot, flange: Motion, mode: int) -> float:
    """Metres by which a flange is out of reach: what is missing in the plane, and to the height of an arm that has but
    one."""
    aside = max(0.0, -float(robot.reach_margin(flange, mode)))
    upwards = 0.0 if "z" in robot.coordinates else float(flange.p[2]) - robot.base.z
    return float(np.hypot(aside, upwards))
