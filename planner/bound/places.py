"""All joint positions of an arm at a place: its inverse in every working mode, at every full turn.

Near a singularity a joint may be anywhere while the tool is at its place up to rounding: it is not known there (NaN).
"""

from __future__ import annotations

import math
from itertools import product

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Motion, Pose
from assur.planner.frames.tilted import TiltedMotion
from assur.planner.robots.codes import Code
from assur.planner.robots.robot import Robot

LEAST_MARGIN = 1e-3
"""An arm with a smaller singularity margin has no known angles: 1 µm at its end moves them by 0.001 rad."""
MOST = 64
"""Joint positions at one place, at most: with more, none is known of it."""


class Unplaced(Exception):
    """Nothing is known of the joint positions at a place: there are too many, or none."""


def places(
    robot: Robot, modes: tuple[int, ...], x: float, y: float, z: float, yaw: float, pitch: float, roll: float
) -> FloatArray:
    """Joint positions (N, n) within the joints' ranges that put the flange there, in any of the working modes; NaN in
    what an angle that is not given (NaN) leaves open. Raises `Unplaced` where there are none or more than `MOST`."""
    given = [0.0 if math.isnan(angle) else angle for angle in (yaw, pitch, roll)]
    flange, tilts = Motion.still(Pose(x, y, z, given[0])), "pitch" in robot.coordinates
    if tilts:
        flange = TiltedMotion.of(flange, np.array(given[1:]))
    found: list[tuple[float, ...]] = []
    for mode in modes:
        if tilts and math.isnan(pitch):
            # whatever the pitch, the hand is in the vertical plane of the arm; behind the base in the last two modes
            turn = math.atan2(y - robot.base.y, x - robot.base.x) - robot.base.yaw + (math.pi if mode >= 2 else 0.0)
            q = [turn, math.nan, math.nan, math.nan, roll]
        else:
            inverse = robot.inverse(flange, mode, 0)
            if inverse.code in (Code.OUT_OF_REACH, Code.INDETERMINATE):
                continue
            known = inverse.margin >= LEAST_MARGIN
            q = np.where((robot.revolute == 0.0) | known, inverse.q, np.nan).tolist()
            if math.isnan(roll) if tilts else math.isnan(yaw) and robot.turns_load:
                q[-1] = math.nan
        choices = [turned(robot, k, at) for k, at in enumerate(q)]
        # counted before they are made: joints with 64 turns each have a thousand million positions together
        if len(found) + math.prod(map(len, choices)) > MOST:
            raise Unplaced
        found += product(*choices)
    if not found:
        raise Unplaced
    return np.array(found)


def modes_asked(robot: Robot, elbow: str, q: FloatArray) -> tuple[int, ...]:
    """Numbers of the working modes in which an arm that starts at q (n,) may meet its points."""
    if elbow == "keep" and robot.dyads == 1:
        return (int(robot.mode_of(q)),)
    return tuple(range(len(robot.modes))) if elbow in ("auto", "keep") else (robot.modes.index(elbow),)


def turned(robot: Robot, joint: int, at: float, off: float = 0.0) -> list[float]:
    """Positions of a joint, whole turns from `at`, that are within its range or at most `off` beyond it; NaN stays as
    it is."""
    low, high = (float(edge[joint]) for edge in robot.limits.within)
    slack = 1e-9 * (high - low) + off
    if math.isnan(at):
        return [at]
    if robot.joints[joint].kind != "revolute":
        return [at] if low - slack <= at <= high + slack else []
    first, last = math.ceil((low - slack - at) / math.tau), math.floor((high + slack - at) / math.tau)
    return [at + turn * math.tau for turn in range(first, last + 1)]
