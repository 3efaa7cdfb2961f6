"""Whether the tool keeps to what is asked over the whole of an interval, and a closed chain to its assembly mode.

A quantity between two instants a and b, h apart, leaves its chord by at most M h²/8 with M >= its second derivative
(equation V2); a jet over the interval bounds M, or the quantity itself (V3). Intervals are halved until that decides;
what is not decided is refused.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.jets import F1, F2, F3, JET, Jet, plus, scaled
from assur.planner.checker.motion import (
    AXIS_COUNT,
    FAMILY,
    FIRST_KNOT,
    FIVE_AXIS,
    FIVE_BAR,
    JETS,
    LAST_KNOT,
    MOST_LINKS,
    SCARA,
    carry,
    elbows,
    jet_of,
)
from assur.planner.checker.spline import joints
from assur.planner.compiled import kernel

TRACK, CARRY, STRAIGHT, ALONG, ASSEMBLED = range(5)
"""What is asked of the tool: it stays with its control point, or on the vertical over it; it does not accelerate harder
than a held part allows; pitch and roll go the way between two; a point of a frame stays within a window; the chain
stays assembled."""
FRAME, POINT, TCP, FOLLOWS, HEIGHT, TURNS, PITCH, ROLL, NUMBERS = 0, 1, 5, 9, 10, 11, 12, 13, 16
"""Columns of what is asked: carrier of the frame; pose in it that the tool takes (x, y, z, yaw); tool point in the
flange; whether the height counts; how high it may be; whether the yaw counts; pitch and roll. CARRY: HEIGHT is the
limit. STRAIGHT: from (PITCH, ROLL) by the two numbers behind them. ALONG: the point is in FRAME, the tcp's x, y, z the
direction, FOLLOWS and HEIGHT the window's ends, all against the origin of the world."""
GLUE_M, GLUE_RAD, STRAIGHT_RAD, MEET_M, CARRY_SHARE = 1e-5, 1e-4, 1e-4, 1e-6, 1e-6
"""m, rad, rad, m and relative: what the tool may be off while it tracks (the promise of tracking legs; 0.1 mrad moves
the rim of a part of 200 mm by 10 µm), along a straight leg, and of a window (half of what who measures may find); and
what anyone may find over the limit of acceleration, an estimate of a grip."""
SHORTEST_S = 1e-9
"""Intervals are halved no further, s."""
MOST = 400_000
"""Intervals after which the search ends undecided, which is a refusal."""


@kernel(f"UniTuple({JET}, 5)({F3}, int64, float64, float64, float64, float64)")
def point(jets: FloatArray, c: int, x: float, y: float, z: float, yaw: float) -> tuple[Jet, Jet, Jet, Jet, Jet]:
    """Position, and cosine and sine of the heading, of a frame at a pose in a carrier. (On a carrier that tilts the
    pose is none, and the heading is that of its level axis.)"""
    px = plus(jet_of(jets[c], 0), plus(scaled(x, jet_of(jets[c], 3)), scaled(y, jet_of(jets[c], 6))))
    py = plus(jet_of(jets[c], 1), plus(scaled(x, jet_of(jets[c], 4)), scaled(y, jet_of(jets[c], 7))))
    pz = plus(jet_of(jets[c], 2), scaled(z, jet_of(jets[c], 11)))
    cosine, sine = jet_of(jets[c], 3), jet_of(jets[c], 4)
    a, b = math.cos(yaw), math.sin(yaw)
    return px, py, pz, plus(scaled(a, cosine), scaled(-b, sine)), plus(scaled(b, cosine), scaled(a, sine))


@kernel("float64(float64)")
def wrapped(angle: float) -> float:
    """The angle less full turns, in [-π, π]."""
    return float(angle - 2.0 * math.pi * np.round(angle / (2.0 * math.pi)))


@kernel(f"float64({JET})")
def most(jet: Jet) -> float:
    """Greatest size of the second derivative."""
    return max(abs(jet[4]), abs(jet[5]))


@kernel(f"void(int64, {F1}, float64, int64, {F2}, {F2}, {F2}, {F2}, {F3}, {F2}, {F1}, {F1})")
def taken(
    kind: int,
    asked: FloatArray,
    t: float,
    count: int,
    arms: FloatArray,
    knots: FloatArray,
    frames: FloatArray,
    pieces: FloatArray,
    jets: FloatArray,
    q: FloatArray,
    now: FloatArray,
    found: FloatArray,
) -> None:
    """By how much each quantity exceeds what is allowed at time t, into `found` (5,) where it is more than is there."""
    arm, flange, on = arms[0], count - 1, int(asked[FRAME])
    work = np.empty((4, 6))
    joints(knots, int(arm[FIRST_KNOT]), int(arm[LAST_KNOT]), int(arm[AXIS_COUNT]), t, t, work, q)
    for k in range(5):
        now[k] = -np.inf
    if kind == ASSEMBLED:
        now[0] = asked[HEIGHT] - math.sqrt(max(elbows(arm, q)[3][0], 0.0))
    elif kind == STRAIGHT:
        pitch, roll = q[1, 0] + q[2, 0] + q[3, 0], q[4, 0]
        way, turn = asked[ROLL + 1], asked[ROLL + 2]
        # from the middle of the way, which is no longer than half a turn: no turn is in doubt
        ahead, aside = wrapped(pitch - asked[PITCH] - 0.5 * way), wrapped(roll - asked[ROLL] - 0.5 * turn)
        length = way * way + turn * turn
        share = min(max((ahead * way + aside * turn) / length, -0.5), 0.5) if length > 0.0 else 0.0
        now[0] = math.sqrt((ahead - share * way) ** 2 + (aside - share * turn) ** 2) - STRAIGHT_RAD
    elif kind == CARRY:
        carry(0, count, t, t, arms, knots, frames, pieces, jets)
        x, y, z, _, _ = point(jets, flange, asked[TCP], asked[TCP + 1], asked[TCP + 2], asked[TCP + 3])
        now[0] = math.sqrt(x[4] ** 2 + y[4] ** 2 + z[4] ** 2) - asked[HEIGHT] * (1.0 + CARRY_SHARE)
    elif not carry(on, count, t, t, arms, knots, frames, pieces, jets):
        now[0] = np.inf
    else:
        x, y, z, c, s = point(jets, on, asked[POINT], asked[POINT + 1], asked[POINT + 2], asked[POINT + 3])
        if kind == ALONG:
            way = x[0] * asked[TCP] + y[0] * asked[TCP + 1] + z[0] * asked[TCP + 2]
            now[0], now[1] = asked[FOLLOWS] - way - MEET_M, way - asked[HEIGHT] - MEET_M
        else:
            carry(0, count, t, t, arms, knots, frames, pieces, jets)
            u, v, w, e, f = point(jets, flange, asked[TCP], asked[TCP + 1], asked[TCP + 2], asked[TCP + 3])
            a, b, h = u[0] - x[0], v[0] - y[0], w[0] - z[0]
            now[0] = math.sqrt(a * a + b * b + asked[FOLLOWS] * h * h) - GLUE_M
            now[1], now[2] = -h - GLUE_M, h - asked[HEIGHT] - GLUE_M
            if asked[TURNS] > 0.0:
                now[3] = math.sqrt((e[0] - c[0]) ** 2 + (f[0] - s[0]) ** 2) - GLUE_RAD
            if int(arm[FAMILY]) == FIVE_AXIS:
                pitch = abs(wrapped(q[1, 0] + q[2, 0] + q[3, 0] - asked[PITCH]))
                roll = abs(wrapped(q[4, 0] - asked[ROLL]))
                now[4] = (pitch if pitch > roll or pitch != pitch else roll) - GLUE_RAD
    for k in range(5):
        if not now[k] <= found[k]:
            found[k] = now[k]


@kernel(f"void(int64, {F1}, float64, float64, int64, {F2}, {F2}, {F2}, {F2}, {F3}, {F2}, {F1}, {F1})")
def bounded(
    kind: int,
    asked: FloatArray,
    t0: float,
    t1: float,
    count: int,
    arms: FloatArray,
    knots: FloatArray,
    frames: FloatArray,
    pieces: FloatArray,
    jets: FloatArray,
    q: FloatArray,
    ends: FloatArray,
    found: FloatArray,
) -> None:
    """Bounds of what `taken` says over [t0, t1], from what it says of the ends, into `found` (5,)."""
    arm, flange, on, bend = arms[0], count - 1, int(asked[FRAME]), (t1 - t0) * (t1 - t0) / 8.0
    work = np.empty((4, 6))
    joints(knots, int(arm[FIRST_KNOT]), int(arm[LAST_KNOT]), int(arm[AXIS_COUNT]), t0, t1, work, q)
    for k in range(5):
        found[k] = ends[k]
    if kind == ASSEMBLED:
        found[0] = asked[HEIGHT] - math.sqrt(max(elbows(arm, q)[3][0], 0.0))
    elif kind == STRAIGHT:
        pitch = most(plus(plus(jet_of(q, 1), jet_of(q, 2)), jet_of(q, 3)))
        found[0] += bend * math.sqrt(pitch**2 + most(jet_of(q, 4)) ** 2)
    elif kind == CARRY:
        carry(0, count, t0, t1, arms, knots, frames, pieces, jets)
        x, y, z, _, _ = point(jets, flange, asked[TCP], asked[TCP + 1], asked[TCP + 2], asked[TCP + 3])
        found[0] = math.sqrt(most(x) ** 2 + most(y) ** 2 + most(z) ** 2) - asked[HEIGHT] * (1.0 + CARRY_SHARE)
    elif not carry(on, count, t0, t1, arms, knots, frames, pieces, jets):
        found[0] = np.inf
    else:
        x, y, z, c, s = point(jets, on, asked[POINT], asked[POINT + 1], asked[POINT + 2], asked[POINT + 3])
        if kind == ALONG:
            way = plus(plus(scaled(asked[TCP], x), scaled(asked[TCP + 1], y)), scaled(asked[TCP + 2], z))
            found[0] += bend * most(way)
            found[1] += bend * most(way)
        else:
            carry(0, count, t0, t1, arms, knots, frames, pieces, jets)
            u, v, w, e, f = point(jets, flange, asked[TCP], asked[TCP + 1], asked[TCP + 2], asked[TCP + 3])
            a, b = most(plus(u, scaled(-1.0, x))), most(plus(v, scaled(-1.0, y)))
            h = most(plus(w, scaled(-1.0, z)))
            found[0] += bend * math.sqrt(a * a + b * b + asked[FOLLOWS] * h * h)
            found[1] += bend * h
            found[2] += bend * h
            found[3] += bend * (most(plus(e, scaled(-1.0, c))) + most(plus(f, scaled(-1.0, s))))
            if int(arm[FAMILY]) == FIVE_AXIS:
                pitch = most(plus(plus(jet_of(q, 1), jet_of(q, 2)), jet_of(q, 3)))
                found[4] += bend * max(pitch, most(jet_of(q, 4)))


@kernel(f"void(int64, {F1}, float64, float64, int64, {F2}, {F2}, {F2}, {F2}, {F1})")
def keeps(
    kind: int,
    asked: FloatArray,
    t0: float,
    t1: float,
    count: int,
    arms: FloatArray,
    knots: FloatArray,
    frames: FloatArray,
    pieces: FloatArray,
    found: FloatArray,
) -> None:
    """Whether nothing that is asked is exceeded over [t0, t1]; `count`: links of the arm. `found` (4,) has 0 if so, 1
    if it is and 2 if that could not be decided; then which quantity, by how much, and when."""
    jets, q = np.zeros((count + len(frames) + MOST_LINKS, JETS, 6)), np.zeros((8, 6))
    stack, ends, bound, now = np.empty((64, 2)), np.empty(5), np.empty(5), np.empty(5)
    stack[0, 0], stack[0, 1], top = t0, t1, 1
    found[0] = 0.0
    for work in range(MOST + 1):
        if top == 0:
            return
        top -= 1
        a, b = stack[top, 0], stack[top, 1]
        for k in range(5):
            ends[k] = -np.inf
        taken(kind, asked, a, count, arms, knots, frames, pieces, jets, q, now, ends)
        taken(kind, asked, b, count, arms, knots, frames, pieces, jets, q, now, ends)
        bounded(kind, asked, a, b, count, arms, knots, frames, pieces, jets, q, ends, bound)
        exceeds, kept = -1, True
        for k in range(5):
            if exceeds < 0 and not ends[k] <= 0.0:
                exceeds = k
            kept = kept and bound[k] <= 0.0
        if exceeds >= 0:
            found[0], found[1], found[2], found[3] = 1.0, exceeds, ends[exceeds], a
            return
        if kept:
            continue
        if b - a <= SHORTEST_S or work == MOST:
            found[0], found[1], found[2], found[3] = 2.0, np.argmax(bound), bound.max(), a
            return
        middle = (a + b) / 2.0
        stack[top, 0], stack[top, 1], stack[top + 1, 0], stack[top + 1, 1] = middle, b, a, middle
        top += 2
    found[0], found[3] = 2.0, t0


@kernel(f"boolean(int64, {F1}, float64, int64, {F2}, {F2}, {F2}, {F2}, {F1})")
def state(
    c: int,
    pose: FloatArray,
    t: float,
    count: int,
    arms: FloatArray,
    knots: FloatArray,
    frames: FloatArray,
    pieces: FloatArray,
    found: FloatArray,
) -> bool:
    """Of a frame at `pose` (4,) in carrier c at time t, into `found` (8,): position, yaw, and their rates. False: not
    known. On a link that tilts the yaw is the heading of the arm."""
    jets = np.zeros((count + len(frames) + MOST_LINKS, JETS, 6))
    if not carry(c, count, t, t, arms, knots, frames, pieces, jets):
        return False
    x, y, z, cosine, sine = point(jets, c, pose[0], pose[1], pose[2], pose[3])
    family = int(arms[0, FAMILY])
    if c < count and family != SCARA and family != FIVE_BAR:
        _, _, _, cosine, sine = point(jets, 1, 0.0, 0.0, 0.0, pose[3])
    for k, jet in enumerate((x, y, z)):
        found[k], found[4 + k] = jet[0], jet[2]
    found[3] = math.atan2(sine[0], cosine[0])
    found[7] = cosine[0] * sine[2] - sine[0] * cosine[2]
    return True
