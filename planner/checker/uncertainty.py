"""How much nearer two bodies may come, along a normal, than they are planned (equations U1 to U3).

A robot's body is displaced by lagging joints and by the correction for a belt; a body of the surroundings by the error
of its frame and by its own; a part in the gripper by how it was gripped. What a correction shifts together does not
part: of each frame's error along its line a body has a share, and the greatest difference of two shares counts.

The joints are displaced by δ, |δ_j| at most the lag: a point goes along the way from q to q + δ with the velocity that
rates δ give it, so its displacement is within the bounds of that velocity over all of q ± lag (U2).
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.jets import F1, F2, F3, TABLES, VECTOR
from assur.planner.checker.motion import AXIS_COUNT, FAMILY, FIRST_KNOT, LAST_KNOT, LINKS, NUMBERS, SCARA, Tables, links
from assur.planner.checker.solids import ARM_FLAT, CENTRE, Vector, moving
from assur.planner.checker.spline import joints
from assur.planner.compiled import kernel

AMOUNT, GROWTH, LINE, ALONG, LATERAL, UPRIGHT, YAW, FIRST, LAST, FRAME_COLUMNS = 0, 1, 2, 3, 6, 7, 8, 9, 10, 11
"""Columns of a frame: its error along its line, m, and by how much it grows, m/s; 1 if it has a line, else it counts in
every horizontal direction; the line's direction (3); across it and along the vertical, m; about its origin, rad;
between which times it may be ahead of its law, s; how many."""
FLAT, HEIGHT, BODY_COLUMNS = 0, 1, 2
"""Columns of a body in a phase: how far it may be off its pose, m, horizontally and along the vertical."""
SINCE, LATE, ANY, FIRST_TOOL, CLOCK = 0, 1, 2, 3, 4
"""Since when errors grow, s; how late the robot may start; 1 if there is anything that is not known; the number of the
first link that a correction shifts as a whole; how many."""
F3C = "float64[:, :, ::1]"
DOUBT = f"Tuple(({F2}, {F3C}, {F3C}, {F1}, {F1}))"
Doubt = tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]
"""Frames (F, FRAME_COLUMNS), bodies (P, B, BODY_COLUMNS), shares of the tool in each frame's error, at least and at
most (P, F, 2), lag of joints (n,), and CLOCK numbers."""


@kernel(f"float64({F1}, float64)")
def lasting(clock: FloatArray, t1: float) -> float:
    """For how long errors have grown at t1, s, if the robot is as late as it may be."""
    return float(max(t1 + clock[LATE] - clock[SINCE], 0.0))


@kernel(f"float64({DOUBT}, int64, float64)")
def shifted(doubt: Doubt, p: int, lasts: float) -> float:
    """How far, m, a correction may shift the tool in phase p."""
    frames, _, shares, _, _ = doubt
    found = 0.0
    for f in range(len(frames)):
        most = max(abs(shares[p, f, 0]), abs(shares[p, f, 1]))
        found += most * (frames[f, AMOUNT] + frames[f, GROWTH] * lasts)
    return found


@kernel(f"UniTuple(float64, 2)({F1}, float64, float64, float64)")
def turned_by(arm: FloatArray, low: float, high: float, shift: float) -> tuple[float, float]:
    """By how much both links of a SCARA may turn where its tool axis is shifted by `shift`, m, while its second joint
    is between `low` and `high`; infinite where it may be stretched or folded (U3)."""
    l1, l2 = arm[NUMBERS], arm[NUMBERS + 1]
    if not high >= low:
        return math.inf, math.inf
    # the cosine is monotone between multiples of π
    least, most = min(math.cos(low), math.cos(high)), max(math.cos(low), math.cos(high))
    for k in range(math.ceil(low / math.pi), math.floor(high / math.pi) + 1):
        if k % 2 == 0:
            most = 1.0
        else:
            least = -1.0
    near = math.sqrt(max(l1 * l1 + l2 * l2 + 2.0 * l1 * l2 * least, 0.0)) - shift
    far = math.sqrt(l1 * l1 + l2 * l2 + 2.0 * l1 * l2 * most) + shift
    if not (near > abs(l1 - l2) and far < l1 + l2):
        return math.inf, math.inf
    sine = math.inf
    for radius in (near, far):
        cosine = (radius * radius - l1 * l1 - l2 * l2) / (2.0 * l1 * l2)
        sine = min(sine, 1.0 - cosine * cosine)
    if not sine > 0.0:
        return math.inf, math.inf
    sine = math.sqrt(sine)
    return shift / (l1 * sine), shift / (l2 * sine)


@kernel(f"boolean({TABLES}, {DOUBT}, float64, float64, {F3})", allocates=True)
def sway(tables: Tables, doubt: Doubt, t0: float, t1: float, jets: FloatArray) -> bool:
    """Jets of the links whose velocities bound their displacement by lagging joints over [t0, t1]; False: not known."""
    row, lag = tables[0][0], doubt[3]
    q, n = np.zeros((8, 6)), int(row[AXIS_COUNT])
    joints(tables[1], int(row[FIRST_KNOT]), int(row[LAST_KNOT]), n, t0, t1, q)
    for j in range(n):
        q[j, 0], q[j, 1] = q[j, 0] - lag[j], q[j, 1] + lag[j]
        q[j, 2], q[j, 3], q[j, 4], q[j, 5] = -lag[j], lag[j], 0.0, 0.0
    return links(row, q, jets, 0)


@kernel(f"float64({TABLES}, {DOUBT}, int64, int64, int64, float64, float64, {F3}, {VECTOR})", allocates=True)
def displaced(
    tables: Tables, doubt: Doubt, p: int, solid: int, c: int, t0: float, t1: float, jets: FloatArray, n: Vector
) -> float:
    """By how much, m, points of a solid on carrier c may be displaced along n over [t0, t1] in phase p by lag, and, of
    an arm, by a correction. `jets`: as `sway` has them. Infinite: not known."""
    row, clock = tables[0][0], doubt[4]
    if c < 0 or c >= int(row[LINKS]):
        return 0.0
    s, flat, lag = tables[4][solid], math.sqrt(n[0] * n[0] + n[1] * n[1]), doubt[3]
    far = math.hypot(s[CENTRE], s[CENTRE + 1]) + s[ARM_FLAT]
    if int(row[FAMILY]) == SCARA:
        # arms and turns one by one: nothing of it depends on where the joints are
        both, level = lag[0] + lag[1], 0.0
        if c == 1:
            level = far * lag[0]
        elif c == 2:
            level = row[NUMBERS] * lag[0] + far * both
        elif c > 2:
            level = row[NUMBERS] * lag[0] + row[NUMBERS + 1] * both
            level += far * (both + (lag[3] if int(row[AXIS_COUNT]) > 3 else 0.0)) if c == 4 else 0.0
        lifted = c > 2 or (c > 0 and row[NUMBERS + 2] > 0.0)
        found = flat * level + (abs(n[2]) * lag[2] if lifted else 0.0)
    else:
        v = moving(s, jets, c, 1, n)
        found = max(abs(v[0]), abs(v[1])) + v[2]
    shift = shifted(doubt, p, lasting(clock, t1))
    if shift > 0.0 and 0 < c < int(clock[FIRST_TOOL]):
        q, count = np.zeros((8, 6)), int(row[AXIS_COUNT])
        joints(tables[1], int(row[FIRST_KNOT]), int(row[LAST_KNOT]), count, t0, t1, q)
        first, second = turned_by(row, q[1, 0] - doubt[3][1], q[1, 1] + doubt[3][1], shift)
        found += flat * (far * first if c == 1 else row[NUMBERS] * first + far * second)
    return found if found >= 0.0 else math.inf


@kernel(f"float64({DOUBT}, {TABLES}, int64, int64, int64, int64, int64, float64, float64, float64, {VECTOR})")
def apart(
    doubt: Doubt, tables: Tables, p: int, a: int, on: int, b: int, beside: int, far_a: float, far_b: float, t1: float,
    n: Vector,
) -> float:  # fmt: skip
    """By how much, m, bodies a and b on two carriers may be displaced against each other along n until t1 in phase p,
    but for what links are displaced by. `far_a`, `far_b`: how far they reach from the axes of their carriers, m."""
    frames, bodies, shares, _, clock = doubt
    count, lasts = int(tables[0][0, LINKS]), lasting(clock, t1)
    flat, found = math.sqrt(n[0] * n[0] + n[1] * n[1]), 0.0
    for f in range(len(frames)):
        low_a, high_a, low_b, high_b = 0.0, 0.0, 0.0, 0.0
        if on == count + f:
            low_a = high_a = 1.0
        elif on < count and on >= int(clock[FIRST_TOOL]):
            low_a, high_a = shares[p, f, 0], shares[p, f, 1]
        if beside == count + f:
            low_b = high_b = 1.0
        elif beside < count and beside >= int(clock[FIRST_TOOL]):
            low_b, high_b = shares[p, f, 0], shares[p, f, 1]
        if on < count and beside < count and on >= int(clock[FIRST_TOOL]) and beside >= int(clock[FIRST_TOOL]):
            continue  # both are shifted by the same
        share = max(abs(high_b - low_a), abs(high_a - low_b))
        amount = share * (frames[f, AMOUNT] + frames[f, GROWTH] * lasts)
        if frames[f, LINE] > 0.0:
            along = n[0] * frames[f, ALONG] + n[1] * frames[f, ALONG + 1] + n[2] * frames[f, ALONG + 2]
            found += amount * abs(along)
        else:
            found += amount * flat
    for side in range(2):
        body, c, far = (a, on, far_a) if side == 0 else (b, beside, far_b)
        found += bodies[p, body, FLAT] * flat + bodies[p, body, HEIGHT] * abs(n[2])
        if c >= count:
            frame = frames[c - count]
            level = math.hypot(frame[ALONG], frame[ALONG + 1])
            if frame[LINE] > 0.0 and level > 0.0:
                found += frame[LATERAL] * abs(n[1] * frame[ALONG] - n[0] * frame[ALONG + 1]) / level
            else:
                found += frame[LATERAL] * flat
            found += frame[UPRIGHT] * abs(n[2]) + frame[YAW] * far * flat
    return found
