"""Whether the tool keeps to what is asked over the whole of an interval, and a closed chain to its assembly mode.

A quantity between two instants a and b, h apart, leaves its chord by at most M h²/8 with M >= its second derivative
(equation V2); a jet over the interval bounds M, or the quantity itself (V3). Intervals are halved until that decides;
what is not decided is refused.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.jets import F1, F2, F3, JET, TABLES, Jet, plus, product, scaled, squared_rate, times
from assur.planner.checker.motion import (
    AXIS_COUNT,
    FAMILY,
    FIRST_KNOT,
    FIVE_AXIS,
    FIVE_BAR,
    LAST_KNOT,
    LINKS,
    SCARA,
    Tables,
    all_jets,
    carry,
    elbows,
    jet_of,
)
from assur.planner.checker.spline import joints
from assur.planner.compiled import kernel

TRACK, CARRY, STRAIGHT, ALONG, ASSEMBLED, YAW = range(6)
"""What is asked of the tool: it stays with its control point, or on the vertical over it; it does not accelerate harder
than a held part allows; pitch and roll go the way between two; a point of a frame stays within a window; the chain
stays assembled; its yaw is in no forbidden range."""
FRAME, POINT, TCP, FOLLOWS, HEIGHT, TURNS, PITCH, ROLL, NUMBERS = 0, 1, 5, 9, 10, 11, 12, 13, 16
"""Columns of what is asked: carrier of the frame; pose in it that the tool takes (x, y, z, yaw); tool point in the
flange; whether the height counts; how high it may be; whether the yaw counts; pitch and roll. CARRY: HEIGHT is the
limit. STRAIGHT: from (PITCH, ROLL) by the two numbers behind them. YAW: PITCH and ROLL are the cosine and the sine of
the middle of the range, HEIGHT is the cosine of half its width (V7). ALONG: the point is in FRAME, the tcp's x, y, z
the direction, FOLLOWS and HEIGHT the window's ends, all against the origin of the world."""
PITCHES, ROLLS = 5, 6
"""Rows of pitch and roll among the quantities looked at."""
TRACKED_M, TRACKED_RAD, STRAIGHT_RAD, MEET_M, CARRY_SHARE = 1e-5, 1e-4, 1e-4, 1e-6, 1e-6
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


@kernel(f"void({F2}, int64, {JET})")
def write(e: FloatArray, k: int, jet: Jet) -> None:
    """Puts a jet into row k."""
    for i in range(6):
        e[k, i] = jet[i]


@kernel(f"boolean(int64, {F1}, float64, float64, {TABLES}, {F3}, {F2}, {F2})")
def quantities(
    kind: int,
    asked: FloatArray,
    t0: float,
    t1: float,
    tables: Tables,
    jets: FloatArray,
    q: FloatArray,
    e: FloatArray,
) -> bool:
    """Jets of what is looked at over [t0, t1] into the rows of e: x, y, z, cosine and sine of the heading of the tool
    less those of its control point (CARRY, YAW: of the tool alone; YAW: the cosine of the angle to the middle of the
    range, ALONG: the way, ASSEMBLED: the squared margin, as x), and pitch and roll of a hand. False: not known."""
    arm, on = tables[0][0], int(asked[FRAME])
    joints(tables[1], int(arm[FIRST_KNOT]), int(arm[LAST_KNOT]), int(arm[AXIS_COUNT]), t0, t1, q)
    if kind == ASSEMBLED:
        write(e, 0, elbows(arm, q)[3])
        return True
    if int(arm[FAMILY]) == FIVE_AXIS:
        write(e, PITCHES, plus(plus(jet_of(q, 1), jet_of(q, 2)), jet_of(q, 3)))
        write(e, ROLLS, jet_of(q, 4))
    if kind == STRAIGHT:
        return True
    alone = kind in (CARRY, YAW)
    if not alone and not carry(on, t0, t1, tables, jets):
        return False
    goal = point(jets, on, asked[POINT], asked[POINT + 1], asked[POINT + 2], asked[POINT + 3])
    if kind == ALONG:
        x, y, z = scaled(asked[TCP], goal[0]), scaled(asked[TCP + 1], goal[1]), scaled(asked[TCP + 2], goal[2])
        write(e, 0, plus(plus(x, y), z))
        return True
    if not carry(0, t0, t1, tables, jets):
        return False
    tool = point(jets, int(arm[LINKS]) - 1, asked[TCP], asked[TCP + 1], asked[TCP + 2], asked[TCP + 3])
    for k in range(5):
        write(e, k, plus(tool[k], scaled(0.0 if alone else -1.0, goal[k])))
    if kind == YAW:
        write(e, 0, plus(scaled(asked[PITCH], tool[3]), scaled(asked[ROLL], tool[4])))
    return True


@kernel(f"void(int64, {F1}, boolean, {F2}, {F1})", allocates=True)
def taken(kind: int, asked: FloatArray, hand: bool, e: FloatArray, found: FloatArray) -> None:
    """By how much quantities of an instant exceed what is allowed, into `found` (5,) where it is more than is there."""
    now = np.full(5, -np.inf)
    if kind == ASSEMBLED:
        now[0] = asked[HEIGHT] - math.sqrt(max(e[0, 0], 0.0))
    elif kind == STRAIGHT:
        way, turn = asked[ROLL + 1], asked[ROLL + 2]
        # from the middle of the way, which is no longer than half a turn: no turn is in doubt
        x = wrapped(e[PITCHES, 0] - asked[PITCH] - 0.5 * way)
        y = wrapped(e[ROLLS, 0] - asked[ROLL] - 0.5 * turn)
        length = way * way + turn * turn
        share = min(max((x * way + y * turn) / length, -0.5), 0.5) if length > 0.0 else 0.0
        now[0] = math.sqrt((x - share * way) ** 2 + (y - share * turn) ** 2) - STRAIGHT_RAD
    elif kind == CARRY:
        now[0] = math.sqrt(e[0, 4] ** 2 + e[1, 4] ** 2 + e[2, 4] ** 2) - asked[HEIGHT] * (1.0 + CARRY_SHARE)
    elif kind == YAW:
        now[0] = e[0, 0] - asked[HEIGHT]
    elif kind == ALONG:
        now[0], now[1] = asked[FOLLOWS] - e[0, 0] - MEET_M, e[0, 0] - asked[HEIGHT] - MEET_M
    else:
        now[0] = math.sqrt(e[0, 0] ** 2 + e[1, 0] ** 2 + asked[FOLLOWS] * e[2, 0] ** 2) - TRACKED_M
        now[1], now[2] = -e[2, 0] - TRACKED_M, e[2, 0] - asked[HEIGHT] - TRACKED_M
        if asked[TURNS] > 0.0:
            now[3] = math.sqrt(e[3, 0] ** 2 + e[4, 0] ** 2) - TRACKED_RAD
        if hand:
            pitch, roll = abs(wrapped(e[PITCHES, 0] - asked[PITCH])), abs(wrapped(e[ROLLS, 0] - asked[ROLL]))
            now[4] = (roll if pitch <= roll else pitch) - TRACKED_RAD
    for k in range(5):
        if not now[k] <= found[k]:
            found[k] = now[k]


@kernel(f"void(int64, {F1}, {F2}, float64, {F1})", allocates=True)
def bounded(kind: int, asked: FloatArray, e: FloatArray, h: float, found: FloatArray) -> None:
    """What ends of an interval of length h exceed, in `found` (5,), becomes a bound for all of it, from its jets."""
    bend, most = h * h / 8.0, np.empty(7)
    for k in range(7):
        most[k] = max(abs(e[k, 4]), abs(e[k, 5]))
    if kind == ASSEMBLED:
        found[0] = asked[HEIGHT] - math.sqrt(max(e[0, 0], 0.0))
    elif kind == STRAIGHT:
        found[0] += bend * math.sqrt(most[PITCHES] ** 2 + most[ROLLS] ** 2)
    elif kind == CARRY:
        found[0] = math.sqrt(most[0] ** 2 + most[1] ** 2 + most[2] ** 2) - asked[HEIGHT] * (1.0 + CARRY_SHARE)
    elif kind == YAW:
        found[0] += bend * most[0]
    else:
        high = most[0] if kind == ALONG else most[2]
        across = most[0] ** 2 if kind == ALONG else most[0] ** 2 + most[1] ** 2 + asked[FOLLOWS] * most[2] ** 2
        found[0] += bend * math.sqrt(across)
        found[1] += bend * high
        found[2] += bend * high
        found[3] += bend * (most[3] + most[4])
        found[4] += bend * max(most[PITCHES], most[ROLLS])


@kernel(f"void(int64, {F1}, float64, float64, {TABLES}, {F1})", allocates=True)
def keeps(
    kind: int,
    asked: FloatArray,
    t0: float,
    t1: float,
    tables: Tables,
    found: FloatArray,
) -> None:
    """Whether nothing that is asked is exceeded over [t0, t1]. `found` (4,) has 0 if so, 1
    if it is and 2 if that could not be decided; then which quantity, by how much, and when."""
    jets, q, e = all_jets(tables), np.zeros((8, 6)), np.zeros((7, 6))
    stack, ends, bound = np.empty((64, 2)), np.empty(5), np.empty(5)
    hand = int(tables[0][0, FAMILY]) == FIVE_AXIS
    stack[0, 0], stack[0, 1], top = t0, t1, 1
    found[0] = 0.0
    for work in range(MOST + 1):
        if top == 0:
            return
        top -= 1
        a, b = stack[top, 0], stack[top, 1]
        ends[:] = -np.inf
        when = a
        for t in (a, b):
            if ends.max() <= 0.0:
                when = t  # nothing is exceeded before
            if quantities(kind, asked, t, t, tables, jets, q, e):
                taken(kind, asked, hand, e, ends)
            else:
                ends[0] = np.inf
        bound[:] = ends
        if quantities(kind, asked, a, b, tables, jets, q, e):
            bounded(kind, asked, e, b - a, bound)
        else:
            bound[0] = np.inf
        exceeds, kept = -1, True
        for k in range(5):
            if exceeds < 0 and not ends[k] <= 0.0:
                exceeds = k
            kept = kept and bound[k] <= 0.0
        if exceeds >= 0:
            found[0], found[1], found[2], found[3] = 1.0, exceeds, ends[exceeds], when
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


@kernel(f"Tuple(({JET}, {JET}, {JET}, {JET}, {JET}))({F3}, int64, int64, {F1})")
def seen_from(jets: FloatArray, link: int, frame: int, tcp: FloatArray) -> tuple[Jet, Jet, Jet, Jet, Jet]:
    """Position, and cosine and sine of the heading, of a pose `tcp` in a link as they are in a frame."""
    x, y, z, cosine, sine = point(jets, link, tcp[0], tcp[1], tcp[2], tcp[3])
    px, py, pz, c, s = point(jets, frame, 0.0, 0.0, 0.0, 0.0)
    dx, dy, dz = plus(x, scaled(-1.0, px)), plus(y, scaled(-1.0, py)), plus(z, scaled(-1.0, pz))
    return (
        plus(times(c, dx), times(s, dy)),
        plus(times(c, dy), scaled(-1.0, times(s, dx))),
        dz,
        plus(times(c, cosine), times(s, sine)),
        plus(times(c, sine), scaled(-1.0, times(s, cosine))),
    )


PLACE, RATE, BEND, PULL, HEADING, SPIN, HAND, TILTS, RELATIVE = 0, 3, 6, 7, 8, 10, 11, 13, 14
"""Columns of what `relative` finds: place and velocity of the tool point in a frame at the begin of an interval; bounds
over it of its acceleration, and of the rate of its speed; cosine and sine of the heading there, and a bound of the rate
at which they turn; pitch and roll, and a bound of their rates; how many columns."""


@kernel(f"void({F2}, int64, {F1}, {TABLES}, {F2})", allocates=True)
def relative(spans: FloatArray, on: int, tcp: FloatArray, tables: Tables, found: FloatArray) -> None:
    """How the tool point `tcp` (4,) in the flange moves in the frame of carrier `on` over intervals (N, 2), into
    `found` (N, RELATIVE). NaN where it is not known."""
    jets, q, arm = all_jets(tables), np.zeros((8, 6)), tables[0][0]
    link, hand = int(arm[LINKS]) - 1, int(arm[FAMILY]) == FIVE_AXIS
    found[:] = np.nan
    for i in range(len(spans)):
        a, b, own = spans[i, 0], spans[i, 1], found[i]
        if not (carry(on, a, a, tables, jets) and carry(0, a, a, tables, jets)):
            continue
        x, y, z, cosine, sine = seen_from(jets, link, on, tcp)
        for k, jet in enumerate((x, y, z)):
            own[PLACE + k], own[RATE + k] = jet[0], jet[2]
        own[HEADING], own[HEADING + 1] = cosine[0], sine[0]
        joints(tables[1], int(arm[FIRST_KNOT]), int(arm[LAST_KNOT]), int(arm[AXIS_COUNT]), a, b, q)
        own[HAND], own[HAND + 1], own[TILTS] = 0.0, 0.0, 0.0
        if hand:
            joints(tables[1], int(arm[FIRST_KNOT]), int(arm[LAST_KNOT]), int(arm[AXIS_COUNT]), a, a, q)
            own[HAND], own[HAND + 1] = q[1, 0] + q[2, 0] + q[3, 0], q[4, 0]
            joints(tables[1], int(arm[FIRST_KNOT]), int(arm[LAST_KNOT]), int(arm[AXIS_COUNT]), a, b, q)
            tilt = plus(plus(jet_of(q, 1), jet_of(q, 2)), jet_of(q, 3))
            own[TILTS] = max(abs(tilt[2]), abs(tilt[3]), abs(q[4, 2]), abs(q[4, 3]))
        if not (carry(on, a, b, tables, jets) and carry(0, a, b, tables, jets)):
            continue
        x, y, z, cosine, sine = seen_from(jets, link, on, tcp)
        bend, least, low, high = 0.0, 0.0, 0.0, 0.0
        for jet in (x, y, z):
            bend += max(abs(jet[4]), abs(jet[5])) ** 2
            least += squared_rate(jet)[0]
            power = product(jet[2], jet[3], jet[4], jet[5])
            low, high = low + power[0], high + power[1]
        own[BEND] = math.sqrt(bend)
        # d|v|/dt = v·a/|v|; a bound by |a| alone where the speed may vanish
        own[PULL] = own[BEND]
        if least > 0.0:
            own[PULL] = min(own[BEND], max(abs(low), abs(high)) / math.sqrt(least))
        own[SPIN] = max(abs(cosine[2]), abs(cosine[3])) + max(abs(sine[2]), abs(sine[3]))


@kernel(f"void({F2}, {TABLES}, {F2})", allocates=True)
def states(where: FloatArray, tables: Tables, found: FloatArray) -> None:
    """Of frames at poses in carriers at times, `where` (N, 6): carrier, x, y, z, yaw, time, into `found` (N, 13):
    position, yaw, their rates; pitch and roll of the hand of an arm with five axes (H2), their rates; and the speed of
    the fastest joint. NaN where it is not known. On a link that tilts the yaw is the heading of the arm."""
    jets, q = all_jets(tables), np.zeros((8, 6))
    arm = tables[0][0]
    for i in range(len(where)):
        c, t, own = int(where[i, 0]), where[i, 5], found[i]
        own[:] = np.nan
        joints(tables[1], int(arm[FIRST_KNOT]), int(arm[LAST_KNOT]), int(arm[AXIS_COUNT]), t, t, q)
        for k in range(2):
            own[8 + 2 * k], own[9 + 2 * k] = q[1, 2 * k] + q[2, 2 * k] + q[3, 2 * k], q[4, 2 * k]
        own[12] = np.abs(q[: int(arm[AXIS_COUNT]), 2]).max()
        if not carry(c, t, t, tables, jets):
            continue
        x, y, z, cosine, sine = point(jets, c, where[i, 1], where[i, 2], where[i, 3], where[i, 4])
        if c < int(arm[LINKS]) and int(arm[FAMILY]) != SCARA and int(arm[FAMILY]) != FIVE_BAR:
            _, _, _, cosine, sine = point(jets, 1, 0.0, 0.0, 0.0, where[i, 4])
        for k, jet in enumerate((x, y, z)):
            own[k], own[4 + k] = jet[0], jet[2]
        own[3] = math.atan2(sine[0], cosine[0])
        own[7] = cosine[0] * sine[2] - sine[0] * cosine[2]
