"""Where the tool is, how fast it moves, how hard it accelerates, where its axes point, and along which way it goes.

Between two times an error e leaves its chord by at most max |ë| h²/8 (N9). What that does not decide is halved. Jets of
this module hold the rounding of their carriers in their radii.
"""

from __future__ import annotations

import math

from assur.planner.arrays import FloatArray
from assur.planner.checker.claim import tables as tb
from assur.planner.checker.claim.chain import slot_of, write_seen
from assur.planner.checker.claim.solids import Jet, constant, jet, minus, plus, product, put, times, widened
from assur.planner.checker.claim.tables import F1, F3, JET, f8, i8
from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from assur.planner.compiled import kernel, types

POINTS, RATES, AXES, GUIDES, CORRECTED, SUMS, DISTANCES, ERRORS = range(8)
"""Tables whose rows are claims: `points`, `rates`, `axes`, `guides`, `phases` (with corrections), `sums`, `distances`,
`errors`. All begin with the begin and the end of their time, but the last two."""


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, i8, i8, types.boolean, F1, f8, f8), inline=True)
def see(
    k: Claim, g: tb.Geometry, s: tb.Scratch, i: int, on: int, is_point: bool, own: FloatArray, t0: float, t1: float
) -> bool:
    """Writes to row i of `s.vectors` the jets over [t0, t1] of a point or of a vector of a carrier in the world, with
    its rounding. `own` begins with its coordinates on the carrier. False: not known."""
    slot = slot_of(k, g, s, on, t0, t1)
    if slot >= 0:
        write_seen(s.jets[slot], s.vectors[i], g.rounds[on], on, is_point, own)
    return slot >= 0


@kernel(types.void(tb.SCRATCH, i8, i8))
def subtract(s: tb.Scratch, i: int, j: int) -> None:
    """Makes vector i the way from vector j to it."""
    for axis in range(3):
        put(s.vectors, i, axis, minus(jet(s.vectors, i, axis), jet(s.vectors, j, axis)))


@kernel(JET(F3, i8, i8))
def jet_dot(vectors: FloatArray, i: int, j: int) -> Jet:
    """The scalar product of two vectors of jets, with its rounding."""
    total, x, y, z = constant(0.0), 0.0, 0.0, 0.0
    for m in range(3):
        a, b = jet(vectors, i, m), jet(vectors, j, m)
        total = plus(total, times(a, b))
        p, q, r = abs(a[0]) + a[1], abs(a[2]) + a[3], abs(a[4]) + a[5]
        u, v, w = abs(b[0]) + b[1], abs(b[2]) + b[3], abs(b[4]) + b[5]
        x, y, z = x + p * u, y + p * v + q * u, z + p * w + 2.0 * q * v + r * u
    return widened(total, 16.0 * tb.ULP * x, 16.0 * tb.ULP * y, 16.0 * tb.ULP * z)


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, f8, f8), inline=True)
def see_point(k: Claim, g: tb.Geometry, s: tb.Scratch, own: FloatArray, t0: float, t1: float) -> bool:
    """The way of the tool from its point, as vector 0, and the difference of both x axes, as vector 2."""
    on, target_on = int(own[c.POINT_LINK]), int(g.on[int(own[c.POINT_FRAME]), 0])
    for side in range(2):
        pose, carrier = (own[c.POINT_TOOL :], on) if side == 0 else (own[c.POINT_TARGET :], target_on)
        s.way[0], s.way[1], s.way[2] = math.cos(pose[3]), math.sin(pose[3]), 0.0
        if not see(k, g, s, side, carrier, True, pose, t0, t1):
            return False
        if not see(k, g, s, 2 + side, carrier, False, s.way, t0, t1):
            return False
    subtract(s, 0, 1)
    subtract(s, 2, 3)
    s.vectors[0, 2, 0] -= own[c.POINT_MIDDLE] if own[c.POINT_HEIGHT] >= 0.0 else 0.0
    return True


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, f8, f8))
def see_guide(k: Claim, g: tb.Geometry, s: tb.Scratch, own: FloatArray, t0: float, t1: float) -> bool:
    """The way of the tool from its place between a point of one frame and a point of another, as vector 0."""
    lasts, share, rate, middle = own[c.GUIDE_T1] - own[c.GUIDE_T0], own[c.GUIDE_SHARE], 0.0, 0.5 * (t0 + t1)
    one_on, other_on = int(g.on[int(own[c.GUIDE_FRAME]), 0]), int(g.on[int(own[c.GUIDE_FRAME + 1]), 0])
    if lasts > 0.0:
        rate = (own[c.GUIDE_SHARE + 1] - share) / lasts
    elif share != own[c.GUIDE_SHARE + 1]:
        return False
    if not see(k, g, s, 0, int(own[c.GUIDE_LINK]), True, own[c.GUIDE_TOOL :], t0, t1):
        return False
    if not see(k, g, s, 1, one_on, True, own[c.GUIDE_FROM :], t0, t1):
        return False
    if not see(k, g, s, 2, other_on, True, own[c.GUIDE_TO :], t0, t1):
        return False
    subtract(s, 2, 1)
    subtract(s, 0, 1)
    # of an interval the middle is rounded, too
    radius = abs(rate) * (0.5 * (t1 - t0) + (tb.ULP * abs(t1) if t1 > t0 else 0.0)) + 8.0 * tb.ULP
    gone = (share + rate * (middle - own[c.GUIDE_T0]), radius, rate, 0.0, 0.0, 0.0)
    for axis in range(3):
        put(s.vectors, 0, axis, minus(jet(s.vectors, 0, axis), times(gone, jet(s.vectors, 2, axis))))
    return True


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, f8, f8))
def see_axis(k: Claim, g: tb.Geometry, s: tb.Scratch, own: FloatArray, t0: float, t1: float) -> bool:
    """The scalar product of an axis or a way and a direction, as the first coordinate of vector 0."""
    other, is_place = int(own[c.AXIS_OTHER]), own[c.AXIS_PLACE] > 0.0
    if not see(k, g, s, 0, int(own[c.AXIS_LINK]), is_place, own[c.AXIS_ON :], t0, t1):
        return False
    s.way[:] = 0.0
    if other >= 0 and is_place:
        if not see(k, g, s, 1, other, True, s.way, t0, t1):
            return False
        subtract(s, 0, 1)
    for m in range(3 if other < 0 else 0):
        put(s.vectors, 2, m, constant(own[c.AXIS_DIRECTION + m]))
    if other >= 0 and not see(k, g, s, 2, other, False, own[c.AXIS_DIRECTION :], t0, t1):
        return False
    total = jet_dot(s.vectors, 0, 2)
    s.vectors[0] = 0.0
    put(s.vectors, 0, 0, total)
    return True


@kernel(types.void(tb.SCRATCH, types.boolean, i8, F1))
def write_sizes(s: tb.Scratch, flat: bool, order: int, sizes: FloatArray) -> None:
    """Writes how long the derivatives of an order are at most: of vector 0 (`flat`: horizontally), of its height, and
    of vector 2."""
    sizes[0], sizes[2] = 0.0, 0.0
    for axis in range(3):
        one, other = s.vectors[0, axis], s.vectors[2, axis]
        sizes[1] = abs(one[2 * order]) + one[2 * order + 1]
        sizes[0] += sizes[1] ** 2 if axis < 2 or not flat else 0.0
        sizes[2] += (abs(other[2 * order]) + other[2 * order + 1]) ** 2
    sizes[0], sizes[2] = math.sqrt(sizes[0]), math.sqrt(sizes[2])


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, F1))
def moves_with_point(k: Claim, g: tb.Geometry, s: tb.Scratch, own: FloatArray, sizes: FloatArray) -> bool:
    """Whether the rates of the tool are those of its point as the time of a point begins."""
    if max(own[c.POINT_RATE], own[c.POINT_RATE + 1]) < 0.0:
        return True
    if not see_point(k, g, s, own, own[c.POINT_T0], own[c.POINT_T0]):
        return False
    write_sizes(s, False, 1, sizes)
    for n in range(2):
        if own[c.POINT_RATE + n] >= 0.0 and not sizes[2 * n] + tb.SLACK <= own[c.POINT_RATE + n]:
            return False
    return True


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, i8, F1, f8, f8, F1, F1))
def is_near_chord(
    k: Claim,
    g: tb.Geometry,
    s: tb.Scratch,
    kind: int,
    own: FloatArray,
    t0: float,
    t1: float,
    sizes: FloatArray,
    state: FloatArray,
) -> bool:
    """Whether the tool is at its point or its guide, or a scalar product within its bounds, over [t0, t1] (N9).

    `sizes`: room for six numbers. Writes by how much a distance is larger than is claimed to `state`."""
    flat, h, bows = kind == POINTS and own[c.POINT_HEIGHT] >= 0.0, t1 - t0, sizes[3:]
    bows[:3], state[tb.AMOUNT] = 0.0 if kind == AXES else tb.SLACK, math.nan
    most = 0.5 * (own[c.AXIS_HIGH] - own[c.AXIS_LOW]) if kind == AXES else 0.0
    if kind != AXES:
        most = own[c.GUIDE_MOST if kind == GUIDES else c.POINT_POSITION]
    for end in range(3 if h > 0.0 else 1):
        a, b, known = t0 if end < 2 else t1, t1 if end != 1 else t0, False
        if kind == POINTS:
            known = see_point(k, g, s, own, a, b)
        elif kind == GUIDES:
            known = see_guide(k, g, s, own, a, b)
        else:
            known = see_axis(k, g, s, own, a, b)
        if not known:
            return False
        if end == 0 and h > 0.0:
            write_sizes(s, flat, 2, sizes)
            for n in range(3):
                bows[n] += sizes[n] * h * h / 8.0
            # then both ends need not be computed; a bow that is within the slack leaves the amount to them
            if not bows[0] <= most + 2.0 * tb.SLACK:
                return False
            continue
        write_sizes(s, flat, 0, sizes)
        if kind == AXES:
            value, off = s.vectors[0, 0, 0], s.vectors[0, 0, 1] + bows[0]
            if not own[c.AXIS_LOW] <= value - off <= value + off <= own[c.AXIS_HIGH]:
                return False
            continue
        if not sizes[0] + bows[0] <= most:
            state[tb.AMOUNT] = sizes[0] + bows[0] - most
            return False
        if flat and not sizes[1] + bows[1] <= own[c.POINT_HEIGHT]:
            return False
        if kind == POINTS and own[c.POINT_YAW] >= 0.0 and not sizes[2] + bows[2] <= own[c.POINT_YAW]:
            return False
    return True


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, i8, F1, i8, f8, f8))
def see_from(k: Claim, g: tb.Geometry, s: tb.Scratch, on: int, tool: FloatArray, f: int, t0: float, t1: float) -> bool:
    """A point of a link as frame f has it (-1: the world), as vector 0."""
    if not see(k, g, s, 0, on, True, tool, t0, t1):
        return False
    if f < 0:
        return True
    frame_on = int(g.on[f, 0])
    s.way[:] = 0.0
    if not see(k, g, s, 1, frame_on, True, s.way, t0, t1):
        return False
    subtract(s, 0, 1)
    for axis in range(3):
        s.way[:] = 0.0
        s.way[axis] = 1.0
        if not see(k, g, s, 2, frame_on, False, s.way, t0, t1):
            return False
        put(s.vectors, 3, axis, jet_dot(s.vectors, 0, 2))
    for axis in range(3):
        put(s.vectors, 0, axis, jet(s.vectors, 3, axis))
    return True


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, f8, f8))
def rate_within(k: Claim, g: tb.Geometry, s: tb.Scratch, own: FloatArray, t0: float, t1: float) -> bool:
    """Whether a point of a link is no faster or slower (order 1), or accelerates no harder or less (order 2), than is
    claimed over [t0, t1]. The square of a speed w leaves the mean of both ends by at most max |w · dw/dt| h (N12)."""
    on, f, order, tool = int(own[c.RATE_LINK]), int(own[c.RATE_FRAME]), int(own[c.RATE_ORDER]), own[c.RATE_POINT :]
    ends, middle, radius = 2 if order == 1 and t1 > t0 else 1, 0.0, 0.0
    if ends == 2:
        if not see_from(k, g, s, on, tool, f, t0, t1):
            return False
        for axis in range(3):
            u = jet(s.vectors, 0, axis)
            slope = product((u[2], u[3]), (u[4], u[5]))
            middle, radius = middle + slope[0], radius + slope[1]
    bow, low, high = (abs(middle) + radius) * (t1 - t0), 0.0, 0.0
    for end in range(ends):
        a, b = (t0, t1) if ends == 1 else (t0, t0) if end == 0 else (t1, t1)
        if not see_from(k, g, s, on, tool, f, a, b):
            return False
        for axis in range(3):
            size, off = abs(s.vectors[0, axis, 2 * order]), s.vectors[0, axis, 2 * order + 1]
            low, high = low + max(size - off, 0.0) ** 2, high + (size + off) ** 2
    low, high = math.sqrt(max(low / ends - bow, 0.0)), math.sqrt(high / ends + bow)
    if not high * (1.0 + 64.0 * tb.ULP) + tb.SLACK <= own[c.RATE_MOST]:
        return False
    return bool(own[c.RATE_LEAST] == 0.0 or own[c.RATE_LEAST] <= low * (1.0 - 64.0 * tb.ULP) - tb.SLACK)
