"""Whether two solids stay apart over an interval of time (equations C1, C3, C4 in docs/guarantees.md).

For points x of the one and y of the other f(t) = n·(y - x) leaves its chord downwards by at most M h²/8 with M >= f''.
Terms of a support function that do not change as a solid turns (a ball; the disc of a solid of revolution that stands
upright on an upright carrier) are the same at all times, so M is wanted for the points that are left: the corners of
a box, vertices, a disc that lies. With c, d the centres and r_x, r_y the distances of those points from them,

    M = max n·(d'' - c'') + |n| (r_x |R_x''| + r_y |R_y''|)                                                   (C7)

where |R''| is the length of the second derivatives of the axes' coordinates; on an upright carrier one axis, its
horizontal coordinates and the horizontal part of n are enough. An interval that this does not do for is halved, with
all that is open in it: what moves is computed once for all pairs.

Of a pair the normal of its row must prove the distance required, and some normal the clearance which the answer claims:
that of the shortest way between both at the middle of the interval, a hint that need not be exact.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.jets import F1, F2, F3, TABLES, VECTOR
from assur.planner.checker.motion import DEGREE, KIND, LINKS, POLYNOMIAL, SINCE, UNTIL, Tables, carry
from assur.planner.checker.solids import BALL, Vector, farthest, moving
from assur.planner.checker.uncertainty import ANY, DOUBT, Doubt, apart, displaced, sway
from assur.planner.compiled import kernel

(
    ROW, ONE, ONE_ON, OTHER, OTHER_ON, PIECES, OTHERS, NORMAL, NEED, PHASE, BODY_ONE, BODY_OTHER, FAR_ONE, FAR_OTHER,
    FROM, TO, PROVE, CLAIM, HINT, ITEM,
) = (0, 1, 2, 3, 4, 5, 6, 7, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 23)  # fmt: skip
"""Columns of a pair that is open: row of the certificate (-1: none); solid and carrier of both (-1: the origin of the
world); how many pieces stand before each in the table, if it is the box of a body (0: it is no box, or of one piece);
normal; the distance required where all is known (C5); number of the phase, of both bodies, and how far they reach from
the axes of their carriers, m; between which times the second is ahead of the clock, s; whether the row, and whether the
claim, is still to be proved; a normal that was good for the claim; how many columns."""
CLAIMED, PUT_CLAIMED, REACHED, MISSED, WHEN, PAIR_ONE, PAIR_OTHER, WORK, WRONG, STATE = range(10)
"""Numbers of a proof: the clearance claimed of the arm and what it bears, and that of parts that were put down (-inf:
none); what is against one of them: a smaller distance that is reached (inf: none; NaN: it could not be shown not to),
what was claimed there, when, and of which solids; how much was evaluated; rows that mean or prove nothing; how many."""
SLACK_M = 1e-9
"""Taken off each gap, m, for its rounding: some twenty terms of a few metres, each rounded to 1e-15 m."""
HALVINGS, FINER, DEEPEST = 10, 3, 24
"""How often an interval may be halved for a row: most need none or one, a wide interval of a five-bar up to six; how
often that of a row of one body alone is: what will be required of it is not known yet; and for the claim."""
MOST = 4_000_000
"""Pairs in parts of intervals in one check, after which all is refused: some seconds."""
NEAR_M, STEPS = 1e-6, 32
"""A distance at an instant is known well enough to this, m; and steps after which its search ends in any case."""
FLAT_M = 1e-9
"""A tetrahedron that is less high than this, m, counts as flat."""
BOX_M = 1e-4
"""Boxes that come as near as what is claimed and this, m, are opened: one whose distance at an end of an interval is
exactly what is claimed could be neither proved there nor refuted."""
SHORTEST_S = 1e-4
"""A shift that is shorter than this is not halved, s."""
OPEN, HOLDS, FAILS, BOXES = range(4)
OVER, BEGIN, END, MIDDLE, SWAYED, AHEAD, CORNERS, PLACES = 0, 1, 2, 3, 4, 5, 6, 10
"""For what the jets of all carriers are kept: an interval, its ends (the one that is behind may change places with the
one before), the middle; the links with joints that lag; and of what is ahead of the clock, all that it does over an
interval, and where it is at both ends of the interval, first for the least and then for the greatest shift; how
many."""
F4 = "float64[:, :, :, ::1]"
"""Jets (PLACES, carriers + MOST_LINKS, JETS, 6)."""


Work = tuple[FloatArray, FloatArray, FloatArray, FloatArray]
"""Jets; for which time they are known (PLACES, carriers, 3): begin, end, and whether they are; room for items that are
open (.., ITEM), and for intervals (.., 5)."""
WORK_ROOM = f"Tuple(({F4}, {F3}, {F2}, {F2}))"


@kernel(f"{VECTOR}({F1}, int64)")
def vector(row: FloatArray, at: int) -> Vector:
    """Three numbers of a row."""
    return row[at], row[at + 1], row[at + 2]


@kernel(f"boolean(int64, int64, float64, float64, {TABLES}, {F4}, {F3})")
def carried(place: int, c: int, t0: float, t1: float, tables: Tables, jets: FloatArray, known: FloatArray) -> bool:
    """`carry`, which is not done again for the same interval, nor for what stands still. The links of the arm are known
    together; the origin (-1) always is."""
    if c < 0:
        return True
    count, stands = int(tables[0][0, LINKS]), False
    k = 0 if c < count else c
    now = known[place, k]
    if c >= count:
        frame = tables[2][c - count]
        stands = frame[KIND] == POLYNOMIAL and frame[DEGREE] == 0.0 and frame[SINCE] <= t0 and t1 <= frame[UNTIL]
    if not (now[0] == t0 and now[1] == t1) and not (stands and now[2] > 0.0):
        now[2] = 1.0 if carry(k, t0, t1, tables, jets[place]) else 0.0
        now[0], now[1] = t0, t1
    return bool(now[2] > 0.0)


@kernel(f"float64({TABLES}, {F3}, int64, int64, {VECTOR})")
def support(tables: Tables, jets: FloatArray, solid: int, c: int, n: Vector) -> float:
    """max of n·x over a solid on carrier c at the instant of the jets."""
    x = farthest(tables[4][solid], jets, c, tables[5], n, 1.0)
    return n[0] * x[0] + n[1] * x[1] + n[2] * x[2]


@kernel(f"float64({TABLES}, {F3}, {F1}, {VECTOR})")
def gap(tables: Tables, jets: FloatArray, item: FloatArray, n: Vector) -> float:
    """The support gap (C1) of a pair at the instant of the jets."""
    found = -support(tables, jets, int(item[ONE]), int(item[ONE_ON]), n)
    if item[OTHER] >= 0.0:
        found -= support(tables, jets, int(item[OTHER]), int(item[OTHER_ON]), (-n[0], -n[1], -n[2]))
    return found


@kernel(f"UniTuple(float64, 2)({TABLES}, {F4}, {F1}, float64, {VECTOR})")
def least(tables: Tables, jets: FloatArray, item: FloatArray, h: float, n: Vector) -> tuple[float, float]:
    """The least gap of a pair at the ends of an interval of length h, and by how much it falls below over it (C3)."""
    a = moving(tables[4][int(item[ONE])], jets[OVER], int(item[ONE_ON]), 2, n)
    bend = a[2] - a[0]
    if item[OTHER] >= 0.0:
        b = moving(tables[4][int(item[OTHER])], jets[OVER], int(item[OTHER_ON]), 2, n)
        bend += b[1] + b[2]
    ends = min(gap(tables, jets[BEGIN], item, n), gap(tables, jets[END], item, n))
    return ends - SLACK_M, max(bend, 0.0) * h * h / 8.0


@kernel(f"UniTuple(float64, 2)({TABLES}, {F4}, {F1}, int64, float64, {VECTOR})")
def least_ahead(
    tables: Tables, jets: FloatArray, item: FloatArray, begin: int, h: float, n: Vector
) -> tuple[float, float]:
    """The same of a pair whose second is ahead of the clock: the least gap at both ends of the interval and of the
    shift, and by how much it falls below in between (C8). `begin`: for which place the first is known at its begin."""
    one, other, on, beside = int(item[ONE]), int(item[OTHER]), int(item[ONE_ON]), int(item[OTHER_ON])
    a = moving(tables[4][one], jets[OVER], on, 2, n)
    b = moving(tables[4][other], jets[AHEAD], beside, 2, n)
    ends, back = math.inf, (-n[0], -n[1], -n[2])
    for corner in range(4):
        x = support(tables, jets[begin if corner % 2 == 0 else BEGIN + END - begin], one, on, n)
        y = support(tables, jets[CORNERS + corner], other, beside, back)
        ends = min(ends, -x - y)
    d = item[TO] - item[FROM]
    sag = max(a[2] - a[0] + b[1] + b[2], 0.0) * h * h / 8.0 + max(b[1] + b[2], 0.0) * d * d / 8.0
    return ends - SLACK_M, sag


@kernel(f"float64({TABLES}, {DOUBT}, {F4}, {F1}, float64, float64, {VECTOR})", allocates=True)
def required_of(
    tables: Tables, doubt: Doubt, jets: FloatArray, item: FloatArray, t0: float, t1: float, n: Vector
) -> float:
    """The distance that the row of a pair must prove along n over [t0, t1], with what is not known (C5); of a row of
    one body alone, how far that may be displaced."""
    if doubt[4][ANY] == 0.0 or item[NEED] == -math.inf:
        return float(item[NEED])
    p, found = int(item[PHASE]), item[NEED]
    on, beside = int(item[ONE_ON]), int(item[OTHER_ON])
    found += displaced(tables, doubt, p, int(item[ONE]), on, t0, t1, jets[SWAYED], n)
    if item[OTHER] >= 0.0:
        found += displaced(tables, doubt, p, int(item[OTHER]), beside, t0, t1, jets[SWAYED], n)
        found += apart(
            doubt, tables, p, int(item[BODY_ONE]), on, int(item[BODY_OTHER]), beside, item[FAR_ONE], item[FAR_OTHER],
            t1, n,
        )  # fmt: skip
    return float(found)


@kernel(f"int64({F2}, int64)", allocates=True)
def nearest_face(points: FloatArray, many: int) -> int:
    """Of a point, or of the segment or triangle of it and one or two others of `points` (5, 3), that comes nearest to
    the origin: its corners are moved to the front, and the place of the origin on it into row 4; how many corners.

    The points are rows 0 to `many` - 1, and the last one is a corner in any case.
    """
    last = many - 1
    x, y, z = points[last, 0], points[last, 1], points[last, 2]
    best, one, other = x * x + y * y + z * z, -1, -1
    points[4, 0], points[4, 1], points[4, 2] = x, y, z
    for i in range(last):
        ax, ay, az = points[i, 0] - x, points[i, 1] - y, points[i, 2] - z
        size = ax * ax + ay * ay + az * az
        t = -(x * ax + y * ay + z * az) / size if size > 0.0 else 0.0
        px, py, pz = x + t * ax, y + t * ay, z + t * az
        if 0.0 < t <= 1.0 and px * px + py * py + pz * pz < best:
            best, one, other = px * px + py * py + pz * pz, i, -1
            points[4, 0], points[4, 1], points[4, 2] = px, py, pz
        for j in range(i):
            bx, by, bz = points[j, 0] - x, points[j, 1] - y, points[j, 2] - z
            cx, cy, cz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
            size = cx * cx + cy * cy + cz * cz
            if not size > 0.0:
                continue
            t = (cx * x + cy * y + cz * z) / size
            px, py, pz = t * cx, t * cy, t * cz
            ux, uy, uz = px - x, py - y, pz - z
            r = ((uy * bz - uz * by) * cx + (uz * bx - ux * bz) * cy + (ux * by - uy * bx) * cz) / size
            s = ((ay * uz - az * uy) * cx + (az * ux - ax * uz) * cy + (ax * uy - ay * ux) * cz) / size
            if r >= 0.0 and s >= 0.0 and r + s <= 1.0 and px * px + py * py + pz * pz < best:
                best, one, other = px * px + py * py + pz * pz, i, j
                points[4, 0], points[4, 1], points[4, 2] = px, py, pz
    kept = 0
    for i in range(last):
        if i in (one, other):
            points[kept] = points[i]
            kept += 1
    points[kept] = points[last]
    return kept + 1


@kernel(f"boolean({F2})")
def encloses(points: FloatArray) -> bool:
    """Whether the origin is in the tetrahedron of rows 0 to 3 of `points`: on the inner side of each face, or on it. A
    tetrahedron that is flat but for rounding holds nothing."""
    for k in range(4):
        a, b, c = (k + 1) % 4, (k + 2) % 4, (k + 3) % 4
        ux, uy, uz = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1], points[b, 2] - points[a, 2]
        vx, vy, vz = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1], points[c, 2] - points[a, 2]
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        inner = (
            nx * (points[k, 0] - points[a, 0]) + ny * (points[k, 1] - points[a, 1]) + nz * (points[k, 2] - points[a, 2])
        )
        own = -(nx * points[a, 0] + ny * points[a, 1] + nz * points[a, 2])
        if not (own * inner >= 0.0 and inner * inner > FLAT_M**2 * (nx * nx + ny * ny + nz * nz)):
            return False
    return True


@kernel(f"UniTuple(float64, 2)({TABLES}, {F3}, {F1}, float64)", allocates=True)
def distance(tables: Tables, jets: FloatArray, item: FloatArray, claimed: float) -> tuple[float, float]:
    """Of a pair at the instant of the jets, from below and from above; the normal goes into HINT of the item.

    The origin's way to the differences of their points, step by step to the one that is farthest against it. It ends as
    soon as the lower value exceeds what is claimed by most of what it can, or the upper one falls short of it.
    """
    one, other, on, beside = int(item[ONE]), int(item[OTHER]), int(item[ONE_ON]), int(item[OTHER_ON])
    balls, points = tables[4][one, BALL] + tables[4][other, BALL], np.empty((5, 3))
    n, many, low, high = vector(item, HINT), 0, -math.inf, math.inf
    for _ in range(STEPS):
        a = farthest(tables[4][one], jets, on, tables[5], n, 0.0)
        b = farthest(tables[4][other], jets, beside, tables[5], (-n[0], -n[1], -n[2]), 0.0)
        apart = n[0] * (b[0] - a[0]) + n[1] * (b[1] - a[1]) + n[2] * (b[2] - a[2]) - balls
        if apart > low:
            low, item[HINT], item[HINT + 1], item[HINT + 2] = apart, n[0], n[1], n[2]
        if not (high - low > NEAR_M and high >= claimed and low - claimed < 0.75 * (high - claimed)):
            break
        for k in range(3):
            points[many, k] = b[k] - a[k]
        if many == 3 and encloses(points):
            high = 0.0  # they overlap
            break
        many = nearest_face(points, many + 1)
        size = math.sqrt(points[4, 0] ** 2 + points[4, 1] ** 2 + points[4, 2] ** 2)
        if not (size > 0.0 and size - balls < high):
            high = min(high, max(size - balls, 0.0))
            break
        high = size - balls
        n = (points[4, 0] / size, points[4, 1] / size, points[4, 2] / size)
    return low, high


@kernel(f"float64({TABLES}, {F1}, {F1})")
def claimed_of(tables: Tables, item: FloatArray, state: FloatArray) -> float:
    """The clearance that is claimed of a pair of which the arm bears one, or none (one is a part that was put down)."""
    links = tables[0][0, LINKS]
    return float(state[PUT_CLAIMED if item[ONE_ON] >= links and item[OTHER_ON] >= links else CLAIMED])


@kernel(f"int64({TABLES}, {F4}, {F1}, float64, float64, {F1})")
def claim_of(tables: Tables, jets: FloatArray, item: FloatArray, h: float, t: float, state: FloatArray) -> int:
    """Whether a pair is proved to keep the clearance claimed over an interval, with t in its middle: HOLDS, or is OPEN,
    or FAILS at t, which goes into the state. Of BOXES that come too near the pieces are to be looked at."""
    claimed = claimed_of(tables, item, state)
    low, sag = least(tables, jets, item, h, vector(item, HINT))
    if low - sag >= claimed:
        return HOLDS
    high = distance(tables, jets[MIDDLE], item, claimed)[1]
    if (item[PIECES] > 0.0 or item[OTHERS] > 0.0) and high < claimed + BOX_M:
        return BOXES
    if high < claimed:
        state[REACHED], state[MISSED], state[WHEN] = high, claimed, t
        state[PAIR_ONE], state[PAIR_OTHER] = item[ONE], item[OTHER]
        return FAILS
    low, sag = least(tables, jets, item, h, vector(item, HINT))
    return HOLDS if low - sag >= claimed else OPEN


@kernel(f"int64({F2}, int64, int64)", allocates=True)
def opened(items: FloatArray, i: int, at: int) -> int:
    """Puts the pairs of pieces of a pair of boxes, number i, behind row `at` - 1; how many, or -1: no room for them."""
    ones, others = max(1, int(items[i, PIECES])), max(1, int(items[i, OTHERS]))
    if at + ones * others > len(items):
        return -1
    for j in range(ones):
        for k in range(others):
            item = items[at + j * others + k]
            item[:] = items[i]
            item[ONE] += j - items[i, PIECES]
            item[OTHER] += k - items[i, OTHERS]
            item[ROW], item[PIECES], item[OTHERS], item[PROVE] = -1.0, 0.0, 0.0, 0.0
    return ones * others


@kernel(f"boolean(int64, {F1}, float64, float64, {TABLES}, {F4}, {F3})")
def carried_ahead(
    c: int, item: FloatArray, t0: float, t1: float, tables: Tables, jets: FloatArray, known: FloatArray
) -> bool:
    """`carried` for a frame that is ahead of the clock, over an interval and at its ends."""
    ok = c >= int(tables[0][0, LINKS]) and carried(AHEAD, c, t0 + item[FROM], t1 + item[TO], tables, jets, known)
    for corner in range(4):
        t = (t0 if corner % 2 == 0 else t1) + (item[FROM] if corner < 2 else item[TO])
        ok = ok and carried(CORNERS + corner, c, t, t, tables, jets, known)
    return ok


@kernel(f"boolean(float64, float64, int64, {TABLES}, {DOUBT}, {WORK_ROOM}, {F1}, {F1})", allocates=True)
def descend(
    t0: float, t1: float, many: int, tables: Tables, doubt: Doubt, work: Work, spared: FloatArray, state: FloatArray
) -> bool:
    """By how much, m, rows prove more than is required over [t0, t1], into `spared` where that is less than what is
    there (less than 0, or NaN: they do not); and whether pairs keep the clearance claimed, into `state`.

    What is open are the first `many` items. Of a row of one body alone, what it proves is the distance. False: no room
    for the items.
    """
    jets, known, items, stack = work
    stack[0, 0], stack[0, 1], stack[0, 2], stack[0, 3], stack[0, 4], top = t0, t1, 0.0, many, 0.0, 1
    while top > 0:
        top -= 1
        t0, t1, depth = stack[top, 0], stack[top, 1], stack[top, 4]
        first, end, left = int(stack[top, 2]), int(stack[top, 2] + stack[top, 3]), 0
        h, middle, begin = t1 - t0, (t0 + t1) / 2.0, BEGIN
        if known[BEGIN, 0, 0] != t0 and (known[END, 0, 0] == t0 or known[BEGIN, 0, 0] == t1):
            begin = END  # what was the end of another interval is the begin of this one, or the other way round
        for i in range(first, end):
            item, row = items[i], int(items[i, ROW])
            pair, prove = item[OTHER] >= 0.0, item[PROVE] > 0.0
            prove = prove and (spared[row] >= 0.0 or (not pair and spared[row] > -math.inf))
            claim = item[CLAIM] > 0.0 and state[REACHED] == math.inf
            if not (prove or claim):
                continue
            state[WORK] += 1.0
            ok, low, sag = state[WORK] <= MOST, -math.inf, 0.0
            for c in (int(item[ONE_ON]), int(item[OTHER_ON])):
                ok = ok and carried(OVER, c, t0, t1, tables, jets, known)
                ok = ok and carried(begin, c, t0, t0, tables, jets, known)
                ok = ok and carried(BEGIN + END - begin, c, t1, t1, tables, jets, known)
            if ok and row >= 0:
                low, sag = least(tables, jets, item, h, vector(item, NORMAL))
                claim = claim and not low - sag >= claimed_of(tables, item, state)
            ahead = pair and (item[FROM] != 0.0 or item[TO] != 0.0)
            if prove:
                if ok and ahead:
                    ok = carried_ahead(int(item[OTHER_ON]), item, t0, t1, tables, jets, known)
                    if ok:
                        low, sag = least_ahead(tables, jets, item, begin, h, vector(item, NORMAL))
                need = item[NEED]
                if ok and doubt[4][ANY] > 0.0:
                    if not (known[SWAYED, 0, 0] == t0 and known[SWAYED, 0, 1] == t1):
                        known[SWAYED, 0, 2] = 1.0 if sway(tables, doubt, t0, t1, jets[SWAYED]) else 0.0
                        known[SWAYED, 0, 0], known[SWAYED, 0, 1] = t0, t1
                    ok = known[SWAYED, 0, 2] > 0.0
                    need = required_of(tables, doubt, jets, item, t0, t1, vector(item, NORMAL))
                taken, bound = low - need, low - need - sag
                if not (ok and bound > -math.inf):
                    bound = -math.inf  # a closed chain may be known to assemble over halves of what is too wide
                done = bound >= 0.0 or (ok and taken < 0.0) if pair else bound > -math.inf and depth >= FINER
                if done or depth >= HALVINGS:
                    spared[row], prove = min(spared[row], bound), False
            said = OPEN
            if claim and not prove:
                for c in (int(item[ONE_ON]), int(item[OTHER_ON])):
                    ok = ok and carried(MIDDLE, c, middle, middle, tables, jets, known)
                if ok:
                    said = claim_of(tables, jets, item, h, middle, state)
                claim = said in (OPEN, BOXES)
                if claim and depth >= DEEPEST:
                    state[REACHED], state[WHEN] = math.nan, t0
                    state[PAIR_ONE], state[PAIR_OTHER], claim = item[ONE], item[OTHER], False
            if not (prove or claim):
                continue
            more = 2 if prove and ahead and item[TO] - item[FROM] > SHORTEST_S else 1
            if said == BOXES:
                more = opened(items, i, end + left)
            elif end + left + more > len(items):
                more = -1
            else:
                for k in range(more):
                    half, middle_s = items[end + left + k], 0.5 * (item[FROM] + item[TO])
                    half[:] = item
                    half[PROVE], half[CLAIM] = (1.0 if prove else 0.0), (1.0 if claim and k == 0 else 0.0)
                    if more == 2:
                        half[FROM], half[TO] = (item[FROM], middle_s) if k == 0 else (middle_s, item[TO])
            if more < 0:
                return False
            left += more
        if left > 0:
            for k, (a, b) in enumerate(((middle, t1), (t0, middle))):
                stack[top + k, 0], stack[top + k, 1], stack[top + k, 2] = a, b, end
                stack[top + k, 3], stack[top + k, 4] = left, depth + 1.0
            top += 2
    return True
