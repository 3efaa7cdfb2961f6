"""Where carriers are: jets of the links of an arm, of a frame, and of both as they are kept.

A carrier has 12 jets: the three coordinates of its place, then the three columns of its rotation. The angles of a link
are sums of joints in the world, so no rotation is multiplied by another. Nothing here depends on the kind of arm.
"""

from __future__ import annotations

import math

from assur.planner.arrays import FloatArray
from assur.planner.checker.claim import tables as tb
from assur.planner.checker.claim.motion import joints_over, over, piece_begun_at
from assur.planner.checker.claim.solids import (
    Jet,
    between,
    constant,
    inverse,
    jet,
    joined,
    length,
    minus,
    plus,
    put,
    root,
    scaled,
    times,
    turned,
)
from assur.planner.checker.claim.tables import F1, F2, F3, JET, f8, i8
from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from assur.planner.compiled import kernel, types


@kernel(JET(F3, i8, i8, F1, types.boolean))
def vector(jets: FloatArray, on: int, axis: int, own: FloatArray, is_point: bool) -> Jet:
    """A coordinate in the world of a vector, or of a point, of a carrier, whose coordinates `own` begins with."""
    total = jet(jets, on, axis) if is_point else constant(0.0)
    for m in range(3):
        if own[m] != 0.0:
            total = plus(total, scaled(own[m], jet(jets, on, 3 + 3 * m + axis)))
    return total


@kernel(types.void(F3, F2, F1, i8, types.boolean, F1))
def write_seen(
    jets: FloatArray, result: FloatArray, rounds: FloatArray, on: int, is_point: bool, own: FloatArray
) -> None:
    """Writes the jets of a point or of a vector of a carrier, (3, 6), with its rounding."""
    size = length(own, 0, 3)
    for axis in range(3):
        seen, value = result[axis], vector(jets, on, axis, own, is_point)
        seen[0], seen[1], seen[2], seen[3], seen[4], seen[5] = value
        for order in range(3):
            off = size * rounds[2 * order + tb.ROUND_TURN]
            off += rounds[2 * order + tb.ROUND_PLACE] if is_point else 0.0
            seen[2 * order + 1] += off


@kernel(types.void(tb.CLAIM, i8, tb.SCRATCH), inline=True)
def turn(k: Claim, arm: int, s: tb.Scratch) -> None:
    """Cosine and sine of all angles of an arm."""
    first, n = int(k.arms[arm, c.ARM_ANGLE]), int(k.arms[arm, c.ARM_JOINTS])
    for i in range(first, first + int(k.arms[arm, c.ARM_ANGLES])):
        total = constant(k.angles[i, c.ANGLE_CONSTANT])
        for j in range(n):
            share = k.angles[i, c.ANGLE_SHARE + j]
            if share != 0.0:
                q = s.joints[j]
                total = plus(total, scaled(share, (q[0], q[1], q[2], q[3], q[4], q[5])))
        cosine, sine = turned(total)
        put(s.turns, i, 0, cosine)
        put(s.turns, i, 1, sine)


@kernel(types.boolean(tb.CLAIM, i8, F3, tb.SCRATCH))
def close_loop(k: Claim, loop: int, jets: FloatArray, s: tb.Scratch) -> bool:
    """Cosine and sine of the yaws of both couplers of a loop (N7), in `s.four`. False: it may come apart.

    With d from the first crank's origin to the second one's, l and r their lengths, u and v their directions,
    the vector between their ends has |s|² = |d|² + l² + r² + 2 d·(r v - l u) - 2 l r cos(angle between both). If the
    origins of the cranks do not move, each joint then occurs as seldom as possible; a sum of squares is wider."""
    own = k.loops[loop]
    one, other, third = int(own[c.LOOP_CRANK]), int(own[c.LOOP_CRANK + 1]), int(own[c.LOOP_BETWEEN])
    left, right = own[c.LOOP_LENGTH], own[c.LOOP_LENGTH + 1]
    a, b = own[c.LOOP_COUPLER], own[c.LOOP_COUPLER + 1]
    dx, dy = minus(jet(jets, other, 0), jet(jets, one, 0)), minus(jet(jets, other, 1), jet(jets, one, 1))
    vx = minus(scaled(right, jet(jets, other, 3)), scaled(left, jet(jets, one, 3)))
    vy = minus(scaled(right, jet(jets, other, 4)), scaled(left, jet(jets, one, 4)))
    size = plus(plus(times(dx, dx), times(dy, dy)), scaled(2.0, plus(times(dx, vx), times(dy, vy))))
    size = plus(size, constant(left * left + right * right))
    size = plus(size, scaled(-2.0 * left * right, jet(s.turns, third, 0)))
    fold = scaled(0.5 / (a * b), plus(size, constant(-a * a - b * b)))
    margin = plus(constant(1.0), scaled(-1.0, times(fold, fold)))
    if not (margin[0] - margin[1] >= own[c.LOOP_LEAST] ** 2 + tb.SLACK and size[0] - size[1] > tb.SLACK):
        return False
    ratio, sx, sy = inverse(size), plus(dx, vx), plus(dy, vy)
    along = plus(constant(0.5), scaled(0.5 * (a * a - b * b), ratio))
    across = scaled(own[c.LOOP_SIDE] * a * b, times(root(margin), ratio))
    ex, ey = minus(times(along, sx), times(across, sy)), plus(times(along, sy), times(across, sx))
    put(s.four, 0, 0, scaled(1.0 / a, ex))
    put(s.four, 0, 1, scaled(1.0 / a, ey))
    put(s.four, 1, 0, scaled(1.0 / b, minus(ex, sx)))
    put(s.four, 1, 1, scaled(1.0 / b, minus(ey, sy)))
    return True


@kernel(types.void(F3, i8, JET, JET))
def upright_rotation(jets: FloatArray, on: int, cosine: Jet, sine: Jet) -> None:
    """The rotation of a carrier that turns about the vertical only. What is constant of it was written before."""
    put(jets, on, 3, cosine)
    put(jets, on, 4, sine)
    put(jets, on, 6, scaled(-1.0, sine))
    put(jets, on, 7, cosine)


@kernel(types.void(F3, i8, JET, JET, JET, JET, JET, JET))
def tilted(jets: FloatArray, on: int, cosine: Jet, sine: Jet, cp: Jet, sp: Jet, cr: Jet, sr: Jet) -> None:
    """The rotation Rz(yaw) Ry(-pitch) Rx(roll), from cosines and sines."""
    ux, uy = scaled(-1.0, times(sp, cosine)), scaled(-1.0, times(sp, sine))
    put(jets, on, 3, times(cp, cosine))
    put(jets, on, 4, times(cp, sine))
    put(jets, on, 5, sp)
    put(jets, on, 6, minus(times(sr, ux), times(cr, sine)))
    put(jets, on, 7, plus(times(sr, uy), times(cr, cosine)))
    put(jets, on, 8, times(sr, cp))
    put(jets, on, 9, plus(times(cr, ux), times(sr, sine)))
    put(jets, on, 10, minus(times(cr, uy), times(sr, cosine)))
    put(jets, on, 11, times(cr, cp))


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, i8, F3, tb.SCRATCH), inline=True)
def chain(k: Claim, g: tb.Geometry, arm: int, jets: FloatArray, s: tb.Scratch) -> bool:
    """Jets of all links of an arm, from those of its joints in `s.joints`. False: its loop may come apart."""
    turn(k, arm, s)
    first, closed = int(k.arms[arm, c.ARM_LINK]), False
    for i in range(first, first + int(k.arms[arm, c.ARM_LINKS])):
        link = k.links[i]
        parent, slide, yaw = int(link[c.LINK_PARENT]), int(link[c.LINK_SLIDE]), int(link[c.LINK_YAW])
        offset = link[c.LINK_OFFSET :]
        for axis in range(3):
            put(jets, i, axis, constant(offset[axis]) if parent < 0 else vector(jets, parent, axis, offset, True))
        for column in range(3 if slide >= 0 else 0):
            share, q = link[c.LINK_AXIS + column], s.joints[slide]
            if share == 0.0:
                continue
            out = scaled(share, (q[0], q[1], q[2], q[3], q[4], q[5]))
            # the vertical of an upright parent is that of the world
            plain = parent < 0 or (column == 2 and g.carriers[parent, tb.CARRIER_UPRIGHT] > 0.0)
            for axis in range(3):
                if not plain:
                    along = jet(jets, parent, 3 + 3 * column + axis)
                    put(jets, i, axis, plus(jet(jets, i, axis), times(out, along)))
                elif axis == column:
                    put(jets, i, axis, plus(jet(jets, i, axis), out))
        cosine, sine = jet(s.turns, yaw, 0), jet(s.turns, yaw, 1)
        if link[c.LINK_COUPLER] >= 0.0:
            if not closed and not close_loop(k, int(k.arms[arm, c.ARM_LOOP]), jets, s):
                return False
            closed = True
            u, v = jet(s.four, int(link[c.LINK_COUPLER]), 0), jet(s.four, int(link[c.LINK_COUPLER]), 1)
            cosine, sine = minus(times(cosine, u), times(sine, v)), plus(times(sine, u), times(cosine, v))
        if g.carriers[i, tb.CARRIER_UPRIGHT] > 0.0:
            upright_rotation(jets, i, cosine, sine)
            continue
        p, r = int(link[c.LINK_PITCH]), int(link[c.LINK_ROLL])
        turns = s.turns
        tilted(jets, i, cosine, sine, jet(turns, p, 0), jet(turns, p, 1), jet(turns, r, 0), jet(turns, r, 1))
    return True


@kernel(i8(tb.CLAIM, tb.GEOMETRY, i8, i8, f8, f8, F3, tb.SCRATCH), inline=True)
def frame_over(k: Claim, g: tb.Geometry, f: int, on: int, t0: float, t1: float, jets: FloatArray, s: tb.Scratch) -> int:
    """Jets of a frame with a law over [t0, t1] (N6), with its sines. Returns KNOWN; NOT_GIVEN; or TOO_WIDE, where
    this is longer than a period."""
    frame, own, period = k.frames[f], s.four, k.frames[f, c.FRAME_PERIOD]
    first, many = int(frame[c.FRAME_PIECE]), int(frame[c.FRAME_PIECES])
    if many + frame[c.FRAME_WAVES] > 0.0 and not (g.times[0, 0] <= t0 <= t1 <= g.times[0, 1]):
        return tb.NOT_GIVEN
    for axis in range(4):
        put(own, axis // 2, axis % 2, constant(frame[c.FRAME_POSE + axis]))
    if many > 0:
        last, begin, end, gone, low, high = first + many - 1, g.laws[first, 0], g.laws[first + many - 1, 1], 0.0, t0, t1
        if period > 0.0 and t0 >= begin:
            if t1 - t0 > period:
                return tb.TOO_WIDE
            gone, end = float(math.floor((t0 - begin) / period)), begin + period
            low = min(max(t0 - gone * period, begin), end)
            high = max(low, t1 - gone * period)
        if not (begin <= low <= high and (high <= end or period > 0.0)):
            return tb.NOT_GIVEN
        for part in range(2 if high > end else 1):
            a, b = (low, min(high, end)) if part == 0 else (begin, min(high - period, end))
            i = piece_begun_at(g.laws, first, last, a)
            for axis in range(4):
                added = over(g.laws, i, tb.CURVE_POWER + tb.LAW_POWERS * axis, a, max(a, b), s.work)
                added = plus(added, constant((gone + part) * frame[c.FRAME_STEP + axis]))
                put(own, axis // 2, axis % 2, added if part == 0 else joined(jet(own, axis // 2, axis % 2), added))
    for i in range(int(frame[c.FRAME_WAVE]), int(frame[c.FRAME_WAVE] + frame[c.FRAME_WAVES])):
        wave, u = k.waves[i], between(t0, t1)
        rate, axis = wave[c.WAVE_RATE], int(wave[c.WAVE_COORDINATE])
        angle = (rate * u[0] + wave[c.WAVE_PHASE], abs(rate) * u[1], rate, 0.0, 0.0, 0.0)
        added = scaled(wave[c.WAVE_AMPLITUDE], turned(angle)[1])
        put(own, axis // 2, axis % 2, plus(jet(own, axis // 2, axis % 2), added))
    for axis in range(3):
        put(jets, on, axis, jet(own, axis // 2, axis % 2))
    cosine, sine = turned(jet(own, 1, 1))
    upright_rotation(jets, on, cosine, sine)
    return tb.KNOWN


@kernel(i8(F2, F3, i8, f8, f8))
def kept_slot(carriers: FloatArray, known: FloatArray, on: int, t0: float, t1: float) -> int:
    """What `slot_of` returns if that was computed before, else -1 - NOT_KEPT. What never moves is always in slot 0."""
    own, lasts = carriers[on], t1 > t0
    if own[tb.CARRIER_FIXED] > 0.0:
        return 0
    key, begin, many = int(own[tb.CARRIER_FIRST]), tb.INSTANTS if lasts else 0, tb.INTERVALS if lasts else tb.INSTANTS
    for slot in range(begin, begin + many):
        if known[slot, key, 0] == t0 and known[slot, key, 1] == t1:
            return slot if known[slot, key, 2] == tb.KNOWN else int(-1 - known[slot, key, 2])
    return -1 - tb.NOT_KEPT


@kernel(i8(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, i8, f8, f8))
def new_slot(k: Claim, g: tb.Geometry, s: tb.Scratch, on: int, t0: float, t1: float) -> int:
    """What `slot_of` returns, computed now. All links of an arm are computed together."""
    arm, key, lasts = int(g.carriers[on, tb.CARRIER_ARM]), int(g.carriers[on, tb.CARRIER_FIRST]), t1 > t0
    slot, state = int(s.next_slot[key, int(lasts)]) + (tb.INSTANTS if lasts else 0), tb.NOT_GIVEN
    s.next_slot[key, int(lasts)] = (s.next_slot[key, int(lasts)] + 1.0) % (tb.INTERVALS if lasts else tb.INSTANTS)
    if arm < 0:
        state = frame_over(k, g, int(g.carriers[on, tb.CARRIER_FRAME]), on, t0, t1, s.jets[slot], s)
    elif joints_over(g, arm, int(k.arms[arm, c.ARM_JOINTS]), t0, t1, s):
        state = tb.KNOWN if chain(k, g, arm, s.jets[slot], s) else tb.TOO_WIDE
    s.known[slot, key, 0], s.known[slot, key, 1], s.known[slot, key, 2] = t0, t1, state
    return slot if state == tb.KNOWN else -1 - state


@kernel(i8(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, i8, f8, f8), inline=True)
def slot_of(k: Claim, g: tb.Geometry, s: tb.Scratch, on: int, t0: float, t1: float) -> int:
    """The slot of `s.jets` that has a carrier over [t0, t1], computed now or before. Less than 0: it is not known, and
    the value is -1 - NOT_GIVEN or -1 - TOO_WIDE."""
    slot = kept_slot(g.carriers, s.known, on, t0, t1)
    return new_slot(k, g, s, on, t0, t1) if slot == -1 - tb.NOT_KEPT else slot
