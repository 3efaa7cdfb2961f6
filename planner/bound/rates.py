"""Bounds of how fast a point of a frame moves, over intervals of time, from the numbers of its law."""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.bound.guided import RATES
from assur.planner.checker.laws import ramped
from assur.planner.frames import Conveyor, Fixed, Indexer, Keyframes, Law, Linear, Oscillation, Swing, Turntable
from assur.planner.frames.ramps import Change

STEP = 2.1876, 7.5133, 52.51
"""The greatest |x'|, |x''|, |x'''| of the step of an indexer (F3), in steps and moves: 35/16 of them at its middle,
84/(5 √5), and 52.5 at its middle, rounded up."""
EDGE_S = 1e-9
"""s. So near to a change of speed an interval counts as touching it: rounding of times."""


def known(law: Law) -> bool:
    """Whether `rates` knows the law."""
    return isinstance(law, Conveyor | Fixed | Indexer | Keyframes | Linear | Oscillation | Swing | Turntable)


def climbs(law: Law) -> bool:
    """Whether the height of the frame may change."""
    if isinstance(law, Linear):
        return law.velocity[2] != 0.0
    if isinstance(law, Oscillation):
        return law.direction[2] != 0.0
    if isinstance(law, Turntable):
        return law.rise != 0.0
    if isinstance(law, Keyframes):
        return any(pose.z != law.poses[0].z for pose in law.poses)
    return not isinstance(law, Conveyor | Fixed | Indexer | Swing)


def rates(law: Law, arm_m: float, begin: FloatArray, end: FloatArray) -> FloatArray:
    """Bounds (N, 9) as `assur.planner.bound.guided` has them, of a point `arm_m` metres from a frame's axis,
    over [begin, end] (N,), s: of the velocity, acceleration and jerk of the point in the plane, of its height, and of
    the frame's yaw. Infinite: not bounded."""
    plane, height, yaw = (np.zeros((3, len(begin))) for _ in range(3))
    if isinstance(law, Linear):
        plane[0], height[0] = math.hypot(*law.velocity[:2]), abs(law.velocity[2])
    elif isinstance(law, Conveyor):
        plane = _ramps(law.speed, law.changes, law.at_time, begin, end)
    elif isinstance(law, Turntable):
        yaw = _ramps(law.rate, law.changes, law.at_time, begin, end)
        height[0] = abs(law.rise)
    elif isinstance(law, Oscillation | Swing):
        waves = np.array([abs(law.amplitude) * (math.tau / law.period) ** k for k in (1, 2, 3)])[:, None]
        if isinstance(law, Swing):
            yaw += waves
        else:
            length = math.hypot(*law.direction)
            plane += waves * math.hypot(*law.direction[:2]) / length
            height += waves * abs(law.direction[2]) / length
    elif isinstance(law, Indexer):
        steps = np.array([abs(law.step) * STEP[k] / law.move_s ** (k + 1) for k in range(3)])[:, None]
        if law.kind == "turn":
            yaw += steps
        else:
            plane += steps
    elif isinstance(law, Keyframes):
        of_all = _splines(law)
        plane += np.hypot(of_all[:, 0], of_all[:, 1])[:, None]
        height += of_all[:, 2, None]
        yaw += of_all[:, 3, None]
    elif not isinstance(law, Fixed):
        return np.full((len(begin), RATES), math.inf)
    w, dw, ddw = yaw
    plane[0] += arm_m * w
    plane[1] += arm_m * (dw + w**2)
    plane[2] += arm_m * (ddw + 3.0 * w * dw + w**3)
    return np.ascontiguousarray(np.concatenate([plane, height, yaw]).T)


def _ramps(speed: float, changes: tuple[Change, ...], at_time: float, begin: FloatArray, end: FloatArray) -> FloatArray:
    """Bounds (3, N) of what has a speed that changes (R1). In each piece the acceleration has one sign, so that the
    speed is greatest at an end."""
    found = np.zeros((3, len(begin)))
    if not changes:
        found[0] = abs(speed)
        return found
    for since, until, powers in ramped(speed, changes, at_time, float(begin.min()), float(end.max())):
        low, high = np.maximum(begin, since - EDGE_S), np.minimum(end, until + EDGE_S)
        among = low <= high
        _, v, a, j = (*powers, 0.0, 0.0)[:4]
        for t in (low - since, high - since):
            found[0] = np.where(among, np.maximum(found[0], np.abs(v + t * (2.0 * a + 3.0 * t * j))), found[0])
            found[1] = np.where(among, np.maximum(found[1], np.abs(2.0 * a + 6.0 * t * j)), found[1])
        found[2] = np.where(among, np.maximum(found[2], abs(6.0 * j)), found[2])
    for change in changes:
        if change.jerk == math.inf:
            # its acceleration jumps: at its begin, and at its end, which comes within this time
            over = change.time + 2.0 * _fastest(speed, changes) / change.acceleration
            found[2] = np.where((begin <= over + EDGE_S) & (end >= change.time - EDGE_S), math.inf, found[2])
    return found


def _fastest(speed: float, changes: tuple[Change, ...]) -> float:
    return max(abs(each) for each in (speed, *(change.speed for change in changes)))


def _splines(law: Keyframes) -> FloatArray:
    """Bounds (3, 4) of the rates of x, y, z, yaw over all of a spline (F5): the velocity of a piece is a parabola."""
    h = np.diff(law.knots)[:, None]
    _, c1, c2, c3 = np.moveaxis(np.asarray(law.coefficients), -2, 0)
    most_a = np.maximum(np.abs(2.0 * c2), np.abs(2.0 * c2 + 6.0 * c3 * h))
    ends = np.maximum(np.abs(c1), np.abs(c1 + h * (2.0 * c2 + 3.0 * c3 * h)))
    most_v = ends + 0.75 * np.abs(c3) * h * h
    return np.array([most_v.max(axis=0), most_a.max(axis=0), np.abs(6.0 * c3).max(axis=0)])
