"""Inverse kinematics of one pose: the joint vectors of every working mode, at all full turns, or what a mode lacks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Motion
from assur.planner.robots.codes import Code
from assur.planner.robots.robot import Robot
from assur.planner.robots.turns import beyond_range, equivalents, nearest_turns


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
