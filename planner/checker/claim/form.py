"""Whether the tables of a claim fit together, so that every index exists and every number is one that is allowed.

NaN is within no bounds. Nothing else of the checker reads a table before this.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.claim import tables as tb
from assur.planner.checker.claim.solids import length
from assur.planner.checker.claim.tables import F2, f8, i8
from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from assur.planner.compiled import kernel, types

BOUND_TABLE, BOUND_FIRST, BOUND_COLUMNS, BOUND_LOW, BOUND_HIGH, BOUND_OF, BOUND = range(7)
"""A row of `bounds`: table, first column, how many (-1: all that follow), least and greatest number, and what kind."""
NUMBER, OWN_LINK, WHOLE, ORDER = -1, -2, -3, -4
"""Kinds of `BOUND_OF`: any number; the index of a link of arm 0; a whole number below BOUND_HIGH; the column BOUND_LOW
holds no less than the column BOUND_FIRST. Else the number of the table whose rows are counted."""
RANGES = (
    ("phases", c.PHASE_T0, c.PHASE_T1),
    ("limits", c.LIMIT_T0, c.LIMIT_T1),
    ("points", c.POINT_T0, c.POINT_T1),
    ("rates", c.RATE_T0, c.RATE_T1),
    ("rates", c.RATE_LEAST, c.RATE_MOST),
    ("axes", c.AXIS_T0, c.AXIS_T1),
    ("axes", c.AXIS_LOW, c.AXIS_HIGH),
    ("sums", c.SUM_T0, c.SUM_T1),
    ("sums", c.SUM_LOW, c.SUM_HIGH),
    ("guides", c.GUIDE_T0, c.GUIDE_T1),
    ("gap_rows", c.ROW_T0, c.ROW_T1),
    ("gap_rows", c.ROW_S0, c.ROW_S1),
    ("rows", c.ROW_T0, c.ROW_T1),
    ("rows", c.ROW_S0, c.ROW_S1),
    ("frames", c.FRAME_SHIFT, c.FRAME_SHIFT + 1),
)
"""Table, first and second column of ranges. If the second number is less, nothing is in the range, and nothing would be
claimed."""
FITS, COUNTS, CHAINS, SEATS, PIECES, SURFACES = -1, -2, -3, -4, -5, -6
"""What `misfit` returns in place of a row of `bounds`."""
MISFITS = {
    COUNTS: "rows of one table do not share out those of another, or tables have wrong sizes",
    CHAINS: "a link, an angle or a loop refers to what is not before it in its own arm",
    SEATS: "a seat, a frame or the pieces of a law do not fit together",
    PIECES: "a row or a disc does not fit its piece",
    SURFACES: "a triangle is not of its body, or has corners that are not of its piece",
}


WIDTHS = tuple(c.WIDTHS.get(name, -1) for name in Claim._fields)
"""Columns of each table of a claim; -1: other tables determine it."""
FLOAT = np.dtype(np.float64)


def bounds() -> FloatArray:
    """`columns.BOUNDS` and `RANGES` as a table, for `misfit`."""
    names = list(Claim._fields)
    table = np.zeros((len(c.BOUNDS) + len(RANGES), BOUND))
    for row, (name, first, columns, low, high) in zip(table, c.BOUNDS, strict=False):
        row[:BOUND_HIGH] = names.index(name), first, columns, low
        if not isinstance(high, str):
            row[BOUND_HIGH:] = high, NUMBER
        elif high in c.RANGES:
            row[BOUND_HIGH:] = c.RANGES[high], WHOLE
        else:
            row[BOUND_HIGH:] = 0.0, OWN_LINK if high == "own links" else names.index(high)
    for row, (name, first, second) in zip(table[len(c.BOUNDS) :], RANGES, strict=True):
        row[:] = names.index(name), first, 1, second, 0.0, ORDER
    return table


def bound_name(row: int) -> str:
    """Which columns row `row` of `bounds` is about."""
    if row < len(c.BOUNDS):
        name, first, columns, _, _ = c.BOUNDS[row]
        return f"{name}, columns {first} to {'the last' if columns < 0 else first + columns - 1}"
    name, first, second = RANGES[row - len(c.BOUNDS)]
    return f"{name}, columns {first} and {second}, which are a range"


def wrong_table(claim: Claim) -> str:
    """The first table that is no aligned, writeable, C-ordered (rows, columns) of float64 with the right number of
    columns; "": none."""
    tables: tuple[object, ...] = claim
    for name, width, table in zip(Claim._fields, WIDTHS, tables, strict=True):
        if not (isinstance(table, np.ndarray) and table.dtype == FLOAT and table.ndim == 2 and table.flags.carray):
            return name
        if width >= 0 and table.shape[1] != width:
            return name
    return ""


@kernel(types.boolean(f8, f8, f8))
def is_index(x: float, low: float, count: float) -> bool:
    """Whether a number is a whole one from `low` to `count` - 1."""
    return low <= x < count and x == math.floor(x)


@kernel(i8(tb.CLAIM, F2))
def first_row_broken(k: Claim, table: FloatArray) -> int:
    """The first row of `bounds` that the claim does not keep; FITS: it keeps all."""
    for i in range(len(table)):
        own = table[i]
        rows, first, columns = k[int(own[BOUND_TABLE])], int(own[BOUND_FIRST]), int(own[BOUND_COLUMNS])
        low, high, of = own[BOUND_LOW], own[BOUND_HIGH], int(own[BOUND_OF])
        if of >= 0:
            high = float(len(k[of]))
        elif of == OWN_LINK:
            high = k.arms[0, c.ARM_LINKS]
        for r in range(len(rows)):
            if of == ORDER:
                if not rows[r, first] <= rows[r, int(low)]:
                    return i
                continue
            for m in range(first, rows.shape[1] if columns < 0 else first + columns):
                if of == NUMBER:
                    if not low <= rows[r, m] <= high:
                        return i
                elif not is_index(rows[r, m], low, high):
                    return i
    return FITS


@kernel(types.boolean(F2, i8, i8, F2, i8))
def shared_out(table: FloatArray, first: int, count: int, other: FloatArray, least: int) -> bool:
    """Whether the rows of one table share out those of another, in their order, at least `least` for each."""
    reached = 0
    for i in range(len(table)):
        if not (table[i, first] == reached and is_index(table[i, count], least, len(other) + 1)):
            return False
        reached += int(table[i, count])
    return reached == len(other)


@kernel(types.boolean(tb.CLAIM))
def counts_fit(k: Claim) -> bool:
    """Whether tables have the sizes that other tables need."""
    bodies, frames, phases = len(k.bodies), len(k.frames), len(k.phases)
    fit = bool(len(k.arms) > 0 and len(k.required) == 1) and phases > 0
    fit = fit and k.seated.shape == (phases, bodies) and k.off.shape == (phases, 2 * bodies)
    fit = fit and k.shares.shape == (phases, 2 * frames) and k.supports.shape == (len(k.put_down), bodies)
    fit = fit and k.rules.shape[1] == c.RULE_SIDE + 2 * bodies
    fit = fit and shared_out(k.arms, c.ARM_LINK, c.ARM_LINKS, k.links, 1)
    fit = fit and shared_out(k.arms, c.ARM_KNOT, c.ARM_KNOTS, k.knots, 2)
    fit = fit and shared_out(k.arms, c.ARM_ANGLE, c.ARM_ANGLES, k.angles, 1)
    fit = fit and shared_out(k.bodies, c.BODY_PIECE, c.BODY_PIECES, k.pieces, 1)
    fit = fit and shared_out(k.bodies, c.BODY_TRIANGLE, c.BODY_TRIANGLES, k.triangles, 0)
    fit = fit and shared_out(k.pieces, c.PIECE_VERTEX, c.PIECE_VERTICES, k.vertices, 0)
    fit = fit and shared_out(k.frames, c.FRAME_PIECE, c.FRAME_PIECES, k.laws, 0)
    fit = fit and shared_out(k.frames, c.FRAME_WAVE, c.FRAME_WAVES, k.waves, 0)
    return bool(fit and k.self_pairs.shape[0] == k.self_pairs.shape[1] == k.arms[0, c.ARM_LINKS])


@kernel(types.boolean(tb.CLAIM, i8))
def loop_fits(k: Claim, a: int) -> bool:
    """Whether the loop of an arm has two upright cranks of that arm, and the angle between them."""
    arm, own = k.arms[a], k.loops[int(k.arms[a, c.ARM_LOOP])]
    first, angle = arm[c.ARM_LINK], arm[c.ARM_ANGLE]
    for side in range(2):
        crank = own[c.LOOP_CRANK + side]
        if not (is_index(crank, first, first + arm[c.ARM_LINKS]) and own[c.LOOP_COUPLER + side] > 0.0):
            return False
        if k.links[int(crank), c.LINK_PITCH] >= 0.0 or k.links[int(crank), c.LINK_COUPLER] >= 0.0:
            return False
    if own[c.LOOP_SIDE] ** 2 != 1.0 or not is_index(own[c.LOOP_BETWEEN], angle, angle + arm[c.ARM_ANGLES]):
        return False
    one = int(k.links[int(own[c.LOOP_CRANK]), c.LINK_YAW])
    other = int(k.links[int(own[c.LOOP_CRANK + 1]), c.LINK_YAW])
    for column in range(c.ANGLE):
        if k.angles[int(own[c.LOOP_BETWEEN]), column] != k.angles[other, column] - k.angles[one, column]:
            return False
    return True


@kernel(types.boolean(tb.CLAIM))
def chains_fit(k: Claim) -> bool:
    """Whether links refer to earlier links, joints, angles and couplers of their own arm."""
    for a in range(len(k.arms)):
        arm, far, joints = k.arms[a], 0.0, int(k.arms[a, c.ARM_JOINTS])
        first, angle, loop = int(arm[c.ARM_LINK]), int(arm[c.ARM_ANGLE]), int(arm[c.ARM_LOOP])
        for i in range(first, first + int(arm[c.ARM_LINKS])):
            link = k.links[i]
            far += abs(link[c.LINK_OFFSET]) + abs(link[c.LINK_OFFSET + 1]) + abs(link[c.LINK_OFFSET + 2])
            fits = is_index(link[c.LINK_PARENT], -1, i) and (link[c.LINK_PARENT] < 0.0 or link[c.LINK_PARENT] >= first)
            fits = fits and is_index(link[c.LINK_SLIDE], -1, joints) and (link[c.LINK_COUPLER] == -1.0 or loop >= 0)
            for column in (c.LINK_YAW, c.LINK_PITCH, c.LINK_ROLL):
                none = column != c.LINK_YAW and link[c.LINK_PITCH] == -1.0 and link[c.LINK_ROLL] == -1.0
                fits = fits and (none or is_index(link[column], angle, angle + int(arm[c.ARM_ANGLES])))
            if loop >= 0 and link[c.LINK_COUPLER] >= 0.0:
                fits = fits and k.loops[loop, c.LOOP_CRANK] < i and k.loops[loop, c.LOOP_CRANK + 1] < i
            if not fits:
                return False
        for i in range(int(arm[c.ARM_ANGLE]), int(arm[c.ARM_ANGLE] + arm[c.ARM_ANGLES])):
            for j in range(joints, c.MOST_JOINTS):
                if k.angles[i, c.ANGLE_SHARE + j] != 0.0:
                    return False
        if not far < c.FARTHEST_M or (loop >= 0 and not loop_fits(k, a)):
            return False
    return True


@kernel(types.boolean(tb.CLAIM))
def seats_fit(k: Claim) -> bool:
    """Whether each body has one seat in each phase, on a link or on a frame, and no share of a frame is empty; and
    whether frames are upright links of other arms, or have laws whose pieces follow each other."""
    links, frames = int(k.arms[0, c.ARM_LINKS]), len(k.frames)
    for i in range(len(k.seats)):
        if (k.seats[i, c.SEAT_LINK] >= 0.0) == (k.seats[i, c.SEAT_FRAME] >= 0.0):
            return False
    for p in range(len(k.phases)):
        for body in range(len(k.bodies)):
            if k.seats[int(k.seated[p, body]), c.SEAT_BODY] != body:
                return False
        for f in range(frames):
            if not k.shares[p, f] <= k.shares[p, frames + f]:
                return False
    for f in range(frames):
        frame = k.frames[f]
        on, law, arm = int(frame[c.FRAME_LINK]), int(frame[c.FRAME_PIECE]), int(frame[c.FRAME_ARM])
        if arm >= 0:
            first = int(k.arms[arm, c.ARM_LINK])
            # a frame on a link of the robot itself would have two motions
            if on < links or not first <= on < first + int(k.arms[arm, c.ARM_LINKS]):
                return False
            if k.links[on, c.LINK_PITCH] >= 0.0 or frame[c.FRAME_PIECES] + frame[c.FRAME_WAVES] > 0.0:
                return False
        final, period = law + int(frame[c.FRAME_PIECES]) - 1, frame[c.FRAME_PERIOD]
        if period > 0.0 and (final < law or k.laws[final, c.LAW_BEGIN] >= k.laws[law, c.LAW_BEGIN] + period):
            return False
        if period > 0.0 and not k.laws[law, c.LAW_BEGIN] + period <= k.laws[final, c.LAW_END]:
            return False
        for i in range(law, final + 1):
            if not k.laws[i, c.LAW_BEGIN] < k.laws[i, c.LAW_END]:
                return False
            if i > law and k.laws[i, c.LAW_BEGIN] != k.laws[i - 1, c.LAW_END]:
                return False
    return True


@kernel(types.boolean(tb.CLAIM))
def pieces_fit(k: Claim) -> bool:
    """Whether rows name pieces of their bodies, and discs have an axis."""
    tables = (
        (k.rows, c.ROW_BODY, c.ROW_PIECE, -1.0),
        (k.gap_rows, c.ROW_BODY, c.ROW_PIECE, -1.0),
        (k.distances, c.DISTANCE_BODY, c.DISTANCE_PIECE, 0.0),
    )
    for table, first, piece, least in tables:
        for i in range(2 * len(table)):
            row, side = table[i // 2], i % 2
            body = int(row[first + side])
            if not is_index(row[piece + side], least, k.bodies[body, c.BODY_PIECES] if body >= 0 else 0.0):
                return False
    for row in k.rows:
        if row[c.ROW_BODY + 1] < 0.0 and (row[c.ROW_S0] != 0.0 or row[c.ROW_S1] != 0.0):
            return False
    for i in range(len(k.pieces)):
        if k.pieces[i, c.PIECE_DISC] > 0.0 and not length(k.pieces[i], c.PIECE_AXIS, c.PIECE_DISC) > 1e-6:
            return False
    return True


@kernel(types.boolean(tb.CLAIM))
def triangles_fit(k: Claim) -> bool:
    """Whether each triangle is of a piece of its body, and its corners are vertices of that piece: then the piece holds
    it, without rounding."""
    for b in range(len(k.bodies)):
        body = k.bodies[b]
        for i in range(int(body[c.BODY_TRIANGLE]), int(body[c.BODY_TRIANGLE] + body[c.BODY_TRIANGLES])):
            number = k.triangles[i, c.TRIANGLE_PIECE]
            if not body[c.BODY_PIECE] <= number < body[c.BODY_PIECE] + body[c.BODY_PIECES]:
                return False
            piece = k.pieces[int(number)]
            for corner in range(c.TRIANGLE_VERTEX, c.TRIANGLE_VERTEX + 3):
                vertex = k.triangles[i, corner] - piece[c.PIECE_VERTEX]
                if not 0.0 <= vertex < piece[c.PIECE_VERTICES]:
                    return False
    return True


@kernel(i8(tb.CLAIM, F2))
def misfit(k: Claim, table: FloatArray) -> int:
    """FITS, or what does not fit: a row of `table` (`bounds`), or a key of MISFITS."""
    if not counts_fit(k):
        return COUNTS
    row = first_row_broken(k, table)
    if row != FITS:
        return row
    if not chains_fit(k):
        return CHAINS
    if not seats_fit(k):
        return SEATS
    if not pieces_fit(k):
        return PIECES
    return FITS if triangles_fit(k) else SURFACES
