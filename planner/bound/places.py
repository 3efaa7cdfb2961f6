"""All joint positions of an arm at a place: closed forms of the five families, every working mode and every turn.

docs/kinematics.md has the equations (K10, K23 to K25, K35, H2, H3). Near a singularity a joint may be anywhere while
the tool is at its place up to rounding: nothing is said of it there (NaN).
"""

from __future__ import annotations

import math
from itertools import product

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.kernels.links import (
    BASE_COS,
    BASE_SIN,
    BASE_X,
    BASE_YAW,
    BASE_Z,
    ELBOW,
    FIVE_AXIS,
    FIVE_BAR,
    HEIGHT,
    KIND,
    L1,
    L4,
    POLAR,
    SCARA,
)
from assur.planner.robots.robot import Robot

STRETCH_M = 1e-9
"""m. Rounding at the edge of what an arm reaches, and on its axis."""
LEAST_SINE = 1e-3
"""A dyad whose links are nearer to one line has no known angles: 1 µm at its end moves them by 0.001 rad."""
MOST = 64
"""Joint positions at one place, at most: with more, nothing is said of it."""


class Unplaced(Exception):
    """Nothing is known of the joint positions at a place: there are too many, or none."""


def places(
    robot: Robot, modes: tuple[int, ...], x: float, y: float, z: float, yaw: float, pitch: float, roll: float
) -> FloatArray:
    """Joint positions (N, n) within the joints' ranges that put the flange there, in any of the working modes; NaN in
    what an angle that is not given (NaN) leaves open. Raises `Unplaced` where there are none or more than `MOST`."""
    found: list[tuple[float, ...]] = []
    for mode in modes:
        q = _place(robot.row, mode, (x, y, z, yaw, pitch, roll))
        if q is None:
            continue
        choices = [turned(robot, k, q[k]) for k in range(len(robot.joints))]
        # counted before they are made: joints with 64 turns each have a thousand million positions together
        if len(found) + math.prod(map(len, choices)) > MOST:
            raise Unplaced
        found += product(*choices)
    if not found:
        raise Unplaced
    return np.array(found)


def modes_asked(robot: Robot, elbow: str, q: FloatArray) -> tuple[int, ...]:
    """Numbers of the working modes in which an arm that starts at q (n,) may meet its points."""
    every = tuple(range(len(robot.modes)))
    if elbow == "auto":
        return every
    if elbow != "keep":
        return (robot.modes.index(elbow),)
    if robot.row[KIND] == SCARA:
        return (int(math.sin(q[1]) > 0.0),)
    return every


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


def _dyad(l1: float, l2: float, x: float, y: float, sign: float) -> tuple[float, float] | None:
    """The angle of the first link and that of the second against it, NaN where it is near a singularity; None: out of
    reach."""
    far = math.hypot(x, y)
    if far > l1 + l2 + STRETCH_M or far < abs(l1 - l2) - STRETCH_M:
        return None
    c = (far * far - l1 * l1 - l2 * l2) / (2.0 * l1 * l2)
    if not 1.0 - c * c >= LEAST_SINE**2:
        return math.nan, math.nan
    bend = sign * math.acos(c)
    return math.atan2(y, x) - math.atan2(l2 * math.sin(bend), l1 + l2 * c), bend


def _place(row: FloatArray, mode: int, at: tuple[float, float, float, float, float, float]) -> list[float] | None:
    """The joints in a working mode; None: out of reach."""
    family, (l1, l2, l3, l4) = int(row[KIND]), row[L1 : L4 + 1].tolist()
    (bx, by, bz), turn, height = row[BASE_X : BASE_Z + 1].tolist(), float(row[BASE_YAW]), float(row[HEIGHT])
    x, y, z, yaw, pitch, roll = at[0] - bx, at[1] - by, *at[2:]
    if family == SCARA:
        both = _dyad(l1, l2, x, y, 1.0 if mode == 1 else -1.0)
        if both is None:
            return None
        return [both[0] - turn, both[1], z - bz, yaw - both[0] - both[1]]
    if family == FIVE_BAR:
        c, s = float(row[BASE_COS]), float(row[BASE_SIN])
        u, v, half = c * x + s * y, c * y - s * x, height / 2.0
        left = _dyad(l1, l2, u, v - half, 1.0 if mode // 2 == 1 else -1.0)
        right = _dyad(l3, l4, u, v + half, 1.0 if mode % 2 == 1 else -1.0)
        if left is None or right is None:
            return None
        return [left[0], right[0], z - bz, yaw - turn - left[0] - left[1]]
    back, far = (mode == 1 if family == POLAR else mode >= 2), math.hypot(x, y)
    base = math.atan2(y, x) + (math.pi if back else 0.0) - turn if far > STRETCH_M else math.nan
    out, high = -far if back else far, z - bz - height
    if family == POLAR:
        return [base, math.atan2(high, out), math.hypot(out, high)]
    if family == FIVE_AXIS:
        out, high = out - l3 * math.cos(pitch), high - l3 * math.sin(pitch)
        if math.isnan(pitch):
            return [base, math.nan, math.nan, math.nan, roll]
    elif family != ELBOW:
        return None
    both = _dyad(l1, l2, out, high, -1.0 if mode in (0, 3) else 1.0)
    if both is None:
        return None
    return [base, *both] + ([pitch - both[0] - both[1], roll] if family == FIVE_AXIS else [])
