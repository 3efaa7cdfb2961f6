"""Bounds of how fast a point of a frame moves, over intervals of time, from the numbers of its law."""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.bound.guided import RATES
from assur.planner.kernels.columns import laws as c
from assur.planner.laws import Law
from assur.planner.laws.ramps import Change, ramped

STEP = 2.1876, 7.5133, 52.51
"""The greatest |x'|, |x''|, |x'''| of the step of an indexer (F3), in steps and moves: 35/16 of them at its middle,
84/(5 √5), and 52.5 at its middle, rounded up."""
EDGE_S = 1e-9
"""s. So near to a change of speed an interval counts as touching it: rounding of times."""


def known(law: Law) -> bool:
    """Whether `rates` knows the law."""
    return law.kind in ("conveyor", "fixed", "indexer", "keyframes", "linear", "oscillation", "swing", "turntable")


def climbs(law: Law) -> bool:
    """Whether the height of the frame may change."""
    if law.kind == "linear":
        return law.numbers.velocity[2] != 0.0
    if law.kind == "oscillation":
        return law.numbers.direction[2] != 0.0
    if law.kind == "turntable":
        return law.numbers.rise != 0.0
    if law.kind == "keyframes":
        return any(pose.z != law.numbers.poses[0].z for pose in law.numbers.poses)
    return law.kind not in ("conveyor", "fixed", "indexer", "swing")


def rates(law: Law, arm_m: float, begin: FloatArray, end: FloatArray) -> FloatArray:
    """Bounds (N, 9) as `assur.planner.bound.guided` has them, of a point `arm_m` metres from a frame's axis,
    over [begin, end] (N,), s: of the velocity, acceleration and jerk of the point in the plane, of its height, and of
    the frame's yaw. Infinite: not bounded."""
    plane, height, yaw = (np.zeros((3, len(begin))) for _ in range(3))
    of = law.numbers
    if law.kind == "linear":
        plane[0], height[0] = math.hypot(*of.velocity[:2]), abs(of.velocity[2])
    elif law.kind == "conveyor":
        plane = _ramps(of.speed, of.changes, of.at_time, begin, end)
    elif law.kind == "turntable":
        yaw = _ramps(of.rate, of.changes, of.at_time, begin, end)
        height[0] = abs(of.rise)
    elif law.kind in ("oscillation", "swing"):
        waves = np.array([abs(of.amplitude) * (math.tau / of.period) ** k for k in (1, 2, 3)])[:, None]
        if law.kind == "swing":
            yaw += waves
        else:
            length = math.hypot(*of.direction)
            plane += waves * math.hypot(*of.direction[:2]) / length
            height += waves * abs(of.direction[2]) / length
    elif law.kind == "indexer":
        steps = np.array([abs(of.step) * STEP[k] / of.move_s ** (k + 1) for k in range(3)])[:, None]
        if of.turns:
            yaw += steps
        else:
            plane += steps
    elif law.kind == "keyframes":
        of_all = _splines(law)
        plane += np.hypot(of_all[:, 0], of_all[:, 1])[:, None]
        height += of_all[:, 2, None]
        yaw += of_all[:, 3, None]
    elif law.kind != "fixed":
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
    ways = ramped(speed, changes, at_time, "law")
    ends = [*(since for since, *_ in ways[1:]), math.inf]
    for number, ((since, _, v, a, j), until) in enumerate(zip(ways, ends, strict=True)):
        low, high = np.maximum(begin, since - EDGE_S) if number else begin, np.minimum(end, until + EDGE_S)
        among = low <= high
        for t in (low - since, high - since):
            found[0] = np.where(among, np.maximum(found[0], np.abs(v + t * (a + t * (j / 2.0)))), found[0])
            found[1] = np.where(among, np.maximum(found[1], np.abs(a + t * j)), found[1])
        found[2] = np.where(among, np.maximum(found[2], abs(j)), found[2])
    for change in changes:
        if change.jerk == math.inf:
            # its acceleration jumps: at its begin, and at its end, which comes within this time
            over = change.time + 2.0 * _fastest(speed, changes) / change.acceleration
            found[2] = np.where((begin <= over + EDGE_S) & (end >= change.time - EDGE_S), math.inf, found[2])
    return found


def _fastest(speed: float, changes: tuple[Change, ...]) -> float:
    return max(abs(each) for each in (speed, *(change.speed for change in changes)))


def _splines(law: Law) -> FloatArray:
    """Bounds (3, 4) of the rates of x, y, z, yaw over all of a spline (F5): the velocity of a piece is a parabola."""
    pieces = law.side[: int(law.row[c.COUNT])]
    h, v = (pieces[:, c.PIECE_END] - pieces[:, c.PIECE_BEGIN])[:, None], pieces[:, c.RATE : c.CORNER]
    a, j = (pieces[:, c.POWER + k :: c.MOST_POWERS] for k in (0, 1))
    most_a = np.maximum(np.abs(a), np.abs(a + j * h))
    most_v = np.maximum(np.abs(v), np.abs(v + h * (a + j * h / 2.0))) + 0.125 * np.abs(j) * h * h
    return np.array([most_v.max(axis=0), most_a.max(axis=0), np.abs(j).max(axis=0)])
