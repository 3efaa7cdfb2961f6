"""Whether the rows of a certificate keep every pair that is required apart over the whole of every phase.

Times are compared as they are: a row may begin where another ends, and not an ulp later.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.checker.jets import F1, F2, F3, TABLES, VECTOR
from assur.planner.checker.motion import DEGREE, JETS, KIND, MOST_LINKS, POLYNOMIAL, SINCE, UNTIL, Tables
from assur.planner.checker.row_table import (
    NAME,
    OTHER_NAME,
    OTHER_PIECE,
    PIECE,
    S0,
    S1,
    T0,
    T1,
    N,
    hole,
)
from assur.planner.checker.separation import (
    BEGIN,
    BODY_ONE,
    BODY_OTHER,
    CLAIM,
    CLAIMED,
    DEEPEST,
    F4,
    FAR_ONE,
    FAR_OTHER,
    FROM,
    HINT,
    ITEM,
    NEED,
    NORMAL,
    ONE,
    ONE_ON,
    OTHER,
    OTHER_ON,
    OTHERS,
    PHASE,
    PIECES,
    PLACES,
    PROVE,
    REACHED,
    ROW,
    SLACK_M,
    TO,
    WORK_ROOM,
    WRONG,
    Work,
    carried,
    descend,
    support,
    vector,
)  # fmt: skip
from assur.planner.checker.solids import CARRIER, FIRST, I2, Vector
from assur.planner.checker.uncertainty import ANY, DOUBT, Doubt, apart
from assur.planner.compiled import kernel

UNIT_NORMAL = 1e-12
"""| |n| - 1 | of a normal at most: a normalised vector is off by 2e-16; in a cell of 50 m this is 0.05 nm of gap."""
UNKNOWN, OUTSIDE, JUDGED = range(3)
STATUS, SPARED, AWAY, VERDICT = range(4)
"""Columns of what is found of a row: UNKNOWN (it names what does not exist), OUTSIDE (of any phase) or JUDGED; what it
proves beyond what is required, m; by how much the length of its normal is not 1; how many columns."""
MANY, HOLE, HOLE_ONE, HOLE_OTHER, HOLES = range(5)
"""Columns of what is not covered in a phase: number of pairs; when the first hole begins and of which bodies it is."""
CONTACT, BEHIND, FAR, PUT_DOWN, REVERSED = 1, 2, 4, 8, 16
"""Marks of a pair in a phase: it may touch; a plane keeps it apart; and as far as is claimed; one was put down, and
must be kept clear of the other that passes by, though neither is the robot's; and the other one is the part."""
I1, I3 = "int64[::1]", "int64[:, :, ::1]"
CELL = f"Tuple(({I2}, {I2}, {I2}, {I1}, {I1}, {I2}, {F2}, {F2}, {F3}, {F1}, {F2}))"
"""`Cell` for the compiler."""
Cell = tuple[
    IntArray,
    IntArray,
    IntArray,
    IntArray,
    IntArray,
    IntArray,
    FloatArray,
    FloatArray,
    FloatArray,
    FloatArray,
    FloatArray,
]
"""Seats of bodies in each phase (P, B), seats (S, 3), self-pairs of links (L, L), pieces of bodies (B,), numbers of
bodies that are the robot's in any phase (B,) and those bodies behind each other (1, U); begin and end of phases (P, 2);
of phases (P, 3) whether `near` counts (1) or `travel` (0), whether the robot counts, and the gap of allowed contacts;
distances of those bodies from all, travel and near (2, U, B); how far seats reach from the axes of their carriers (S,);
and of carriers between which times they may be ahead of a robot that starts on time, and if it starts late, s, and
whether they move (C, 4)."""
NEAR, ROBOT, TOUCH = range(3)
EARLIEST, LATEST, LATEST_OF_ALL, MOVES = range(4)


@kernel(f"UniTuple(int64, 2)({I1}, int64, int64)")
def ordered(mine: IntArray, a: int, b: int) -> tuple[int, int]:
    """Two bodies, one of them the robot's in some phase, in the one order in which a pair of them is kept."""
    low, high = min(a, b), max(a, b)
    return (low, high) if mine[low] >= 0 else (high, low)


@kernel(f"boolean({CELL}, {I3}, int64, int64, int64)")
def required(cell: Cell, marks: IntArray, p: int, a: int, b: int) -> bool:
    """Whether two bodies must stay apart in phase p."""
    seat, seats, wanted, mine, kinds = cell[0], cell[1], cell[2], cell[4], cell[7]
    on, beside, links = seats[seat[p, a], CARRIER], seats[seat[p, b], CARRIER], len(wanted)
    if on >= links and beside >= links:
        first, second = ordered(mine, a, b)
        return bool(mine[first] >= 0 and marks[p, mine[first], second] & PUT_DOWN)
    if kinds[p, ROBOT] == 0.0:
        return False
    if on < links and beside < links:
        return bool(wanted[on, beside] > 0)
    return True


@kernel(f"int64({F2}, float64)")
def phase_of(spans: FloatArray, t: float) -> int:
    """The last phase that begins at t or before."""
    found = -1
    for p in range(len(spans)):
        if spans[p, 0] <= t:
            found = p
    return found


@kernel(f"void({CELL}, int64, int64, int64, {F1}, int64)")
def sit_down(cell: Cell, p: int, body: int, piece: int, item: FloatArray, side: int) -> None:
    """Where a piece of a body (-1: its box) is in phase p, as one side of an item."""
    seat, seats, count = cell[0], cell[1], cell[3]
    s, box = seat[p, body], piece < 0
    item[ONE + 2 * side] = seats[s, FIRST] + (count[body] if box else piece)
    item[ONE_ON + 2 * side] = seats[s, CARRIER]
    item[PIECES + side] = count[body] if box else 0.0


@kernel(f"boolean({CELL}, {I3}, {I1}, {F1}, {F1}, {F1})")
def resolve(
    cell: Cell, marks: IntArray, known: IntArray, row: FloatArray, item: FloatArray, verdict: FloatArray
) -> bool:
    """The pair of a row as an item of a proof (`separation.ITEM`), with what is required of it (C5); False: it names
    what does not exist or is not inside one phase."""
    seat, count, mine, spans, kinds, asked, reach = cell[0], cell[3], cell[4], cell[6], cell[7], cell[8], cell[9]
    alone = row[OTHER_NAME] == -1.0 and row[OTHER_PIECE] == -1.0
    bodies, verdict[STATUS] = (-1, -1), UNKNOWN
    for side in range(1 if alone else 2):
        name, piece = row[NAME + 2 * side], row[PIECE + 2 * side]
        body = known[int(name)] if 0.0 <= name < len(known) else -1
        if body < 0 or not -1.0 <= piece < count[body] or (alone and not piece < (1 if count[body] == 1 else 0)):
            return False
        bodies = (body, -1) if side == 0 else (bodies[0], body)
    if bodies[0] == bodies[1]:
        return False
    verdict[STATUS], p = OUTSIDE, -1
    for i in range(len(spans)):
        if spans[i, 0] <= row[T0]:
            p = i
    if not (p >= 0 and row[T0] <= row[T1] <= spans[p, 1]):
        return False
    verdict[STATUS] = JUDGED
    sit_down(cell, p, bodies[0], int(row[PIECE]), item, 0)
    item[OTHER], item[OTHER_ON], item[OTHERS] = -1.0, -1.0, 0.0
    item[PROVE], item[CLAIM], item[NEED], item[PHASE] = 1.0, 0.0, 0.0, p
    item[BODY_ONE], item[BODY_OTHER] = bodies[0], bodies[1]
    item[FAR_ONE], item[FAR_OTHER], item[FROM], item[TO] = reach[seat[p, bodies[0]]], 0.0, row[S0], row[S1]
    for k in range(3):
        item[NORMAL + k] = item[HINT + k] = row[N + k]
    if alone:
        return True
    sit_down(cell, p, bodies[1], int(row[OTHER_PIECE]), item, 1)
    item[FAR_OTHER] = reach[seat[p, bodies[1]]]
    a, b = ordered(mine, bodies[0], bodies[1])
    if not required(cell, marks, p, a, b):
        item[NEED] = -np.inf  # nobody asks for this pair: no distance is required of it
        return True
    if marks[p, mine[a], b] & CONTACT:
        item[NEED] = kinds[p, TOUCH]
        return True
    near = 1 if kinds[p, NEAR] > 0.0 or marks[p, mine[a], b] & PUT_DOWN else 0
    item[NEED], item[CLAIM] = asked[near, mine[a], b], (1.0 if row[S0] <= 0.0 <= row[S1] else 0.0)
    return True


@kernel(f"Tuple((int64, float64, float64))({CELL}, {I3}, int64, int64, int64)")
def window(cell: Cell, marks: IntArray, p: int, a: int, b: int) -> tuple[int, float, float]:
    """Which of two bodies (in the order of pairs) is looked at by the clock, and between which times, s, the other must
    be looked at ahead of it (C8)."""
    seat, seats, wanted, mine, ahead = cell[0], cell[1], cell[2], cell[4], cell[10]
    on, beside, links = seats[seat[p, a], CARRIER], seats[seat[p, b], CARRIER], len(wanted)
    if on < links and beside < links:
        return a, 0.0, 0.0
    if on < links or beside < links:
        mover = ahead[max(on, beside)]
        first = a if on < links else b
        return (first, mover[EARLIEST], mover[LATEST_OF_ALL]) if mover[MOVES] > 0.0 else (first, 0.0, 0.0)
    first, one, other = a, ahead[on], ahead[beside]
    if marks[p, mine[a], b] & REVERSED:
        first, one, other = b, other, one
    if other[MOVES] == 0.0:
        return first, 0.0, 0.0
    return first, other[EARLIEST] - one[LATEST], other[LATEST] - one[EARLIEST]


@kernel(f"boolean({F1})")
def good(verdict: FloatArray) -> bool:
    """Whether a row of two bodies proves what is required."""
    return bool(verdict[STATUS] == JUDGED and verdict[AWAY] <= UNIT_NORMAL and verdict[SPARED] >= 0.0)


@kernel(f"boolean({F1})")
def good_alone(verdict: FloatArray) -> bool:
    """Whether a row of one body alone proves anything."""
    return bool(verdict[STATUS] == JUDGED and verdict[AWAY] <= UNIT_NORMAL and verdict[SPARED] > -math.inf)


@kernel(f"void({CELL}, {I3}, int64, int64, {VECTOR}, float64, {TABLES}, {DOUBT}, {F4}, {F3}, float64)")
def put_behind(
    cell: Cell, marks: IntArray, p: int, one: int, n: Vector, stays: float, tables: Tables, doubt: Doubt,
    jets: FloatArray, known: FloatArray, claimed: float,
) -> None:  # fmt: skip
    """Marks the bodies that stand still throughout phase p, before the plane n·x = -stays that body `one` of the robot
    stays behind, at the distance required (C6)."""
    seat, seats, wanted, pieces, mine, _, spans, kinds, asked, reach, _ = cell
    count = len(wanted)
    for b in range(len(pieces)):
        c = seats[seat[p, b], CARRIER]
        if c < count:
            continue
        frame = tables[2][c - count]
        still = frame[KIND] == POLYNOMIAL and frame[DEGREE] == 0.0
        if not (still and frame[SINCE] <= spans[p, 0] and spans[p, 1] <= frame[UNTIL]):
            continue
        if not carried(BEGIN, c, spans[p, 0], spans[p, 0], tables, jets, known):
            continue
        whole = seats[seat[p, b], FIRST] + (0 if pieces[b] == 1 else pieces[b])
        beyond = stays - support(tables, jets[BEGIN], whole, c, (-n[0], -n[1], -n[2])) - SLACK_M
        first, second = ordered(mine, one, b)
        touches = marks[p, mine[first], second] & CONTACT
        least = kinds[p, TOUCH] if touches else asked[1 if kinds[p, NEAR] > 0.0 else 0, mine[first], second]
        if doubt[4][ANY] > 0.0:
            far_one, far_b = reach[seat[p, one]], reach[seat[p, b]]
            least += apart(doubt, tables, p, one, seats[seat[p, one], CARRIER], b, c, far_one, far_b, spans[p, 1], n)
        if beyond >= least:
            marks[p, mine[first], second] |= BEHIND | (FAR if beyond >= claimed or touches else 0)


@kernel(f"void({F2}, {I1}, {I1}, {CELL}, {I3}, {TABLES}, {DOUBT}, {F4}, {F3}, {F2}, float64)")
def _planes(
    rows: FloatArray, order: IntArray, numbers: IntArray, cell: Cell, marks: IntArray, tables: Tables, doubt: Doubt,
    jets: FloatArray, known: FloatArray, verdicts: FloatArray, claimed: float,
) -> None:  # fmt: skip
    """Rows of one phase, body of the robot and normal, to the bit, count together, each beginning where the one before
    ends; if they do not last the whole phase, they count for nothing."""
    seat, seats, wanted, spans = cell[0], cell[1], cell[2], cell[6]
    for i in range(len(order)):
        first = order[i]
        if rows[first, OTHER_NAME] >= 0.0 or not good_alone(verdicts[first]):
            continue
        p, body = phase_of(spans, rows[first, T0]), numbers[int(rows[first, NAME])]
        if rows[first, T0] != spans[p, 0] or seats[seat[p, body], CARRIER] >= len(wanted):
            continue
        stays, reached = verdicts[first, SPARED], rows[first, T1]
        for k in range(i + 1, len(order)):
            r = order[k]
            if rows[r, T0] > reached or reached == spans[p, 1]:
                break
            same = rows[r, T0] == reached and rows[r, OTHER_NAME] < 0.0 and rows[r, NAME] == rows[first, NAME]
            for axis in range(3):
                same = same and rows[r, N + axis] == rows[first, N + axis]
            if same and good_alone(verdicts[r]):
                stays, reached = min(stays, verdicts[r, SPARED]), rows[r, T1]
        if reached == spans[p, 1]:
            put_behind(cell, marks, p, body, vector(rows[first], N), stays, tables, doubt, jets, known, claimed)


@kernel(f"void({F2}, {I1}, {I1}, {CELL}, {I3}, {F2}, {I3}, {I2})")
def chained(
    rows: FloatArray, order: IntArray, numbers: IntArray, cell: Cell, marks: IntArray, verdicts: FloatArray,
    head: IntArray, chain: IntArray,
) -> None:  # fmt: skip
    """Chains the rows of each pair in each phase, in the order of their begins: `head` (P, U, B) has the first of them
    plus 1 and is 0 where there is none, so that what is not touched costs nothing; `chain` (M, 2) as of `hole`."""
    mine, spans = cell[4], cell[6]
    for i in range(len(order) - 1, -1, -1):
        r = order[i]
        if rows[r, OTHER_NAME] < 0.0 or not good(verdicts[r]):
            continue
        one, other = numbers[int(rows[r, NAME])], numbers[int(rows[r, OTHER_NAME])]
        p, pair = phase_of(spans, rows[r, T0]), ordered(mine, one, other)
        if mine[pair[0]] >= 0:
            clocked, early, late = window(cell, marks, p, pair[0], pair[1])
            if clocked != one and (early != 0.0 or late != 0.0):
                continue  # it says that the wrong one is ahead
            chain[r, 0], chain[r, 1] = head[p, mine[pair[0]], pair[1]] - 1, int(pair[0] != one)
            head[p, mine[pair[0]], pair[1]] = r + 1


@kernel(f"void({F2}, {CELL}, {I3}, int64, int64, {I3}, {I2}, {F1})", allocates=True)
def holes_of(
    rows: FloatArray, cell: Cell, marks: IntArray, p: int, u: int, head: IntArray, chain: IntArray, holes: FloatArray
) -> None:
    """What is not covered of the pairs of one body of the robot in one phase goes into `holes` (HOLES,)."""
    count, mine, robots, spans = cell[3], cell[4], cell[5], cell[6]
    a = robots[0, u]
    for b in range(len(count)):
        if b == a or marks[p, u, b] & BEHIND or ordered(mine, a, b)[0] != a:
            continue
        if not required(cell, marks, p, a, b):
            continue
        _, early, late = window(cell, marks, p, a, b)
        found = hole(rows, head[p, u, b] - 1, chain, count[a], count[b], spans[p, 0], spans[p, 1], early, late)
        if not math.isnan(found):
            holes[MANY] += 1.0
            if found < holes[HOLE]:
                holes[HOLE], holes[HOLE_ONE], holes[HOLE_OTHER] = found, a, b


@kernel(f"{WORK_ROOM}({CELL}, {TABLES}, int64)", allocates=True)
def _work(cell: Cell, tables: Tables, room: int) -> Work:
    """Where proofs are made, with room for so many items. All of it is set, so that it is the same each time."""
    carriers = len(cell[2]) + len(tables[2])
    return (
        np.zeros((PLACES, carriers + MOST_LINKS, JETS, 6)),
        np.full((PLACES, carriers, 3), np.nan),
        np.zeros((room, ITEM)),
        np.zeros((2 * DEEPEST + 4, 5)),
    )


@kernel(f"boolean({F2}, {I1}, {I1}, {CELL}, {I3}, {TABLES}, {DOUBT}, int64, {F2}, {F1}, {F1})", allocates=True)
def judge(
    rows: FloatArray, order: IntArray, numbers: IntArray, cell: Cell, marks: IntArray, tables: Tables, doubt: Doubt,
    room: int, verdicts: FloatArray, spared: FloatArray, state: FloatArray,
) -> bool:  # fmt: skip
    """Judges rows of a certificate (M, COLUMNS), those in `order`, which has all of an interval or none, by begin and
    end; their names have `numbers`. Of pairs that may not touch, it tries the clearance that is claimed in `state`.

    Fills `verdicts` (M, VERDICT) but for SPARED, which goes into `spared` (M,). `room`: for items of a proof; False: it
    was not enough.
    """
    work, many = _work(cell, tables, room), 0
    items = work[2]
    for i in range(len(order)):
        r, last = order[i], i + 1 == len(order)
        if many >= room:
            return False
        verdicts[r, AWAY] = abs(math.sqrt(rows[r, N] ** 2 + rows[r, N + 1] ** 2 + rows[r, N + 2] ** 2) - 1.0)
        if resolve(cell, marks, numbers, rows[r], items[many], verdicts[r]):
            items[many, ROW] = r
            many += 1
        # rows of one interval are looked at together
        if many > 0 and (last or rows[r, T0] != rows[order[i + 1], T0] or rows[r, T1] != rows[order[i + 1], T1]):
            if not descend(rows[r, T0], rows[r, T1], many, tables, doubt, work, spared, state):
                return False
            many = 0
    return True


@kernel(f"boolean({F2}, {I1}, {I1}, {CELL}, {I3}, {TABLES}, {DOUBT}, int64, {F2}, {F1}, {F1})", allocates=True)
def judge_planes(
    rows: FloatArray, order: IntArray, numbers: IntArray, cell: Cell, marks: IntArray, tables: Tables, doubt: Doubt,
    room: int, verdicts: FloatArray, spared: FloatArray, state: FloatArray,
) -> bool:  # fmt: skip
    """When all rows were judged: marks what is behind planes, and tries the clearance that is claimed of it. The rest
    as `judge`; `state` gets the number of wrong rows."""
    robots, spans, count, work = cell[5], cell[6], cell[3], _work(cell, tables, room)
    jets, known, items, _ = work
    for r in range(len(rows)):
        verdicts[r, SPARED] = spared[r]
        alone = rows[r, OTHER_NAME] < 0.0
        state[WRONG] += 0.0 if (good_alone(verdicts[r]) if alone else good(verdicts[r])) else 1.0
    _planes(rows, order, numbers, cell, marks, tables, doubt, jets, known, verdicts, state[CLAIMED])
    for p in range(len(spans)):
        many = 0
        for u in range(robots.shape[1] if state[REACHED] == math.inf and spans[p, 1] > spans[p, 0] else 0):
            for b in range(len(count)):
                if marks[p, u, b] & (BEHIND | FAR) == BEHIND:
                    if many >= room:
                        return False
                    for side, body in ((0, robots[0, u]), (1, b)):
                        sit_down(cell, p, body, -1, items[many], side)
                    items[many, ROW], items[many, PROVE], items[many, CLAIM] = -1.0, 0.0, 1.0
                    items[many, FROM], items[many, TO] = 0.0, 0.0
                    items[many, HINT], items[many, HINT + 1], items[many, HINT + 2] = 0.0, 0.0, 1.0
                    many += 1
        if many > 0 and not descend(spans[p, 0], spans[p, 1], many, tables, doubt, work, spared, state):
            return False
    return True
