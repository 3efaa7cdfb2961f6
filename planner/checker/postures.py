"""How near an arm is to a singular position, and in which working mode, over an interval: bounds from its joints.

Of each family the quantities whose sizes are the margin, and whose signs are the mode: sines of the angles at which
links meet (K10, K33), and of arms that tilt the share of the reach by which the flange is off the base axis (K25).
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker import motion
from assur.planner.checker.along import ASSEMBLED, HEIGHT
from assur.planner.checker.jets import product
from assur.planner.checker.motion import FAMILY, FIVE_BAR, NUMBERS, POLAR, SCARA
from assur.planner.checker.world import World

FINEST_S = 1e-9
"""Intervals are halved no further, s."""
MOST = 100_000
"""Intervals after which the search ends undecided."""
Range = tuple[float, float]


def margin_kept(world: World, least: float, t0: float, t1: float) -> tuple[float, float] | None:
    """None if the singularity margin is shown to be no less than `least` over [t0, t1]; else the margin at an instant
    at which it is less, or NaN where that could not be decided, and the time."""
    stack = [(t0, t1)]
    for _ in range(MOST):
        if not stack:
            return None
        a, b = stack.pop()
        if _least(world, world.joints(a, b)) >= least:
            continue
        middle = (a + b) / 2.0
        for t in (a, middle, b):
            there = _least(world, world.joints(t, t))
            if not there >= least:
                return there, t
        if not b - a > FINEST_S:
            return math.nan, a
        stack += [(middle, b), (a, middle)]
    return math.nan, stack[-1][0]


def parallel_kept(world: World, least: float, t0: float, t1: float) -> tuple[float, float] | None:
    """The same of the parallel margin of an arm with a loop."""
    if not least > 0.0:
        return None
    excess = world.keeps(ASSEMBLED, [(HEIGHT, least)], t0, t1)
    if excess is None:
        return None
    return (least - excess.amount if excess.decided else math.nan), excess.time


def mode_of(world: World, q: FloatArray) -> int:
    """The number of the working mode of a joint position (n,); -1 where it has none."""
    signs = [low for low, _ in _quantities(world, np.stack([q, q], axis=1))]
    if not all(math.isfinite(sign) for sign in signs):
        return -1
    family = int(world.tables[0][0, FAMILY])
    if family == SCARA:
        return int(signs[0] > 0.0)
    if family == FIVE_BAR:
        return 2 * int(signs[0] > 0.0) + int(signs[1] > 0.0)
    before = signs[1] >= 0.0
    if family == POLAR:
        return 0 if before else 1
    bent = signs[0] > 0.0
    return (1 if bent else 0) if before else (2 if bent else 3)


def _least(world: World, bounds: FloatArray) -> float:
    """The least margin for joints within bounds (n, 2 or more)."""
    return min(_size(low, high) for low, high in _quantities(world, bounds))


def _size(low: float, high: float) -> float:
    """The least size of a number between two; NaN of what is none."""
    if low <= 0.0 <= high:
        return 0.0
    return min(abs(low), abs(high)) if low <= high else math.nan


def _quantities(world: World, bounds: FloatArray) -> list[Range]:
    """Bounds of what the margin is made of."""
    row, rows = world.tables[0][0], bounds[:, :2].tolist()
    family, p = int(row[FAMILY]), row[NUMBERS:].tolist()
    if family == SCARA:
        return [_sine(*rows[1])]
    if family == FIVE_BAR:
        return _bends(world, bounds)
    if family == POLAR:
        longest = float(world.scene.robot.limits.upper[2])
        low, high = rows[2]
        out = product(low, high, *_cosine(*rows[1]))
        return [(low / longest, high / longest), (out[0] / longest, out[1] / longest)]
    lengths, low, high = p[1:3] if family == motion.ELBOW else p[1:4], 0.0, 0.0
    angle = [0.0, 0.0]
    for length, (first, last) in zip(lengths, rows[1:], strict=False):
        angle = [angle[0] + first, angle[1] + last]
        least, most = _cosine(*angle)
        low, high = low + length * least, high + length * most
    longest = sum(lengths)
    return [_sine(*rows[2]), (low / longest, high / longest)]


def _bends(world: World, bounds: FloatArray) -> list[Range]:
    """Bounds of the sines of the angles between crank and coupler of a five-bar, left and right."""
    jets, q = motion.all_jets(world.tables), np.zeros((8, 6))
    q[: len(bounds), :2] = bounds[:, :2]
    if not motion.links(world.tables[0][0], q, jets, 0):
        return [(math.nan, math.nan)]
    found = []
    for crank in (1, 3):
        (c, s), (u, v) = (jets[k, 3:5, :2].tolist() for k in (crank, crank + 1))
        one, other = product(*c, *v), product(*s, *u)
        found.append((one[0] - other[1], one[1] - other[0]))
    return found


def _cosine(low: float, high: float) -> Range:
    return _sine(low + math.pi / 2.0, high + math.pi / 2.0)


def _sine(low: float, high: float) -> Range:
    """Bounds of the sine of an angle between two."""
    if not low <= high:
        return math.nan, math.nan
    ends = (math.sin(low), math.sin(high))
    # the number of crests, at pi/2, and of troughs, at -pi/2, between the two
    crest = math.floor((high - math.pi / 2.0) / math.tau) > math.floor((low - math.pi / 2.0) / math.tau)
    trough = math.floor((high + math.pi / 2.0) / math.tau) > math.floor((low + math.pi / 2.0) / math.tau)
    return -1.0 if trough else min(ends), 1.0 if crest else max(ends)
