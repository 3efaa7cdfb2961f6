"""Where links and frames are at an instant, and bounds of their motion over an interval, as jets.

The checker's own kinematics of the five families and of all laws, each written once: over an instant it gives places
and rates, over an interval it bounds them. A *carrier* is a link of the arm or a frame of the cell: its row of jets has
its position and the columns of its rotation in the world. Closed chains use the law of cosines
between the elbows, the other arms the sums of angles of docs/kinematics.md (K9, K24, K25, H1, H2, K32).
"""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.jets import (
    F1,
    F2,
    F3,
    JET,
    TABLES,
    Jet,
    constant,
    inverse,
    plus,
    root,
    scaled,
    times,
    turned,
)
from assur.planner.checker.spline import cut, joints, widen
from assur.planner.compiled import kernel

JETS = 12
"""Rows of a carrier: x, y, z, then the columns of its rotation."""
SCARA, ELBOW, POLAR, FIVE_AXIS, FIVE_BAR = range(5)
FAMILY, AXIS_COUNT, FIRST_KNOT, LAST_KNOT, BASE, LINKS, NUMBERS, ARM = 0, 1, 2, 3, 4, 8, 9, 16
"""Columns of an arm: its family, number of joints, knots, pose of its base (x, y, z, yaw), number of links, and the
family's numbers: SCARA l1, l2, whether the lift carries the arms; ELBOW height, l1, l2; POLAR height; FIVE_AXIS height,
l1, l2, l3; FIVE_BAR separation, left and right crank, left and right coupler, sign of the assembly mode; how many."""
POLYNOMIAL, SWING, NEIGHBOUR = range(3)
KIND, SINCE, UNTIL, FIRST, COUNT, DEGREE, PERIOD, AGAIN, MEAN, AMPLITUDE, FRAME = 0, 1, 2, 3, 4, 5, 6, 7, 11, 12, 16
"""Columns of a frame: its kind, when its law is known, first row and number of its pieces, and their degree (0: it
stands still); after how many seconds the pieces come again (0: never), and from AGAIN on by how much x, y, z and yaw
have gone on then; how many columns. SWING: the angle of the sine is in place of the yaw of its pieces; the yaw is MEAN,
and to x, y, z and yaw the sine is added, times what is in the columns from AMPLITUDE on. NEIGHBOUR: FIRST is the row of
its arm, COUNT the number of its link, DEGREE none."""
MOST_DEGREE = 7
BEGIN, END, CONTROL, WIDTH, PIECE = 0, 1, 2, MOST_DEGREE + 1, 2 + 4 * (MOST_DEGREE + 1)
"""Columns of a piece of a law: [begin, end], and from CONTROL on WIDTH columns each for the control values of x, y, z
and yaw; how many columns."""
MOST_LINKS = 8
Tables = tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]
"""Arms (the own one first), curves of all trajectories, frames, and pieces of their laws; solids, and vertices of hulls
(`assur.planner.checker.solids`)."""


@kernel(f"{JET}({F2}, int64)")
def jet_of(rows: FloatArray, i: int) -> Jet:
    """The jet in a row."""
    return rows[i, 0], rows[i, 1], rows[i, 2], rows[i, 3], rows[i, 4], rows[i, 5]


@kernel(f"void({F3}, int64, int64, {JET})")
def put(jets: FloatArray, c: int, k: int, jet: Jet) -> None:
    """Writes one jet of a carrier."""
    for i in range(6):
        jets[c, k, i] = jet[i]


@kernel(f"void({F3}, int64, {JET}, {JET}, {JET}, {JET}, {JET})")
def upright(jets: FloatArray, c: int, x: Jet, y: Jet, z: Jet, cosine: Jet, sine: Jet) -> None:
    """A carrier at a place, turned about the vertical."""
    none = constant(0.0)
    for k, jet in enumerate((x, y, z, cosine, sine, none, scaled(-1.0, sine), cosine, none, none, none, constant(1.0))):
        put(jets, c, k, jet)


@kernel(f"void({F3}, int64, {JET}, {JET}, {JET}, {JET}, {JET}, {JET}, {JET}, {JET}, {JET})")
def tilted(
    jets: FloatArray, c: int, x: Jet, y: Jet, z: Jet, ca: Jet, sa: Jet, cp: Jet, sp: Jet, cr: Jet, sr: Jet
) -> None:
    """A carrier at a place: Rz(heading) Ry(-pitch) Rx(roll) (H1), by cosine and sine of the three."""
    up_x, up_y = scaled(-1.0, times(sp, ca)), scaled(-1.0, times(sp, sa))
    level_x = scaled(-1.0, sa)
    put(jets, c, 0, x)
    put(jets, c, 1, y)
    put(jets, c, 2, z)
    put(jets, c, 3, times(cp, ca))
    put(jets, c, 4, times(cp, sa))
    put(jets, c, 5, sp)
    put(jets, c, 6, plus(times(cr, level_x), times(sr, up_x)))
    put(jets, c, 7, plus(times(cr, ca), times(sr, up_y)))
    put(jets, c, 8, times(sr, cp))
    put(jets, c, 9, plus(times(cr, up_x), scaled(-1.0, times(sr, level_x))))
    put(jets, c, 10, plus(times(cr, up_y), scaled(-1.0, times(sr, ca))))
    put(jets, c, 11, times(cr, cp))


@kernel(f"Tuple(({JET}, {JET}, {JET}, {JET}))({F1}, {F2})")
def elbows(arm: FloatArray, q: FloatArray) -> tuple[Jet, Jet, Jet, Jet]:
    """Of a five-bar, in base axes: the vector s from the left elbow to the right one (K32), |s|² and the square of the
    parallel margin: with h the height of the tool axis over s, (h |s| / (b_L b_R))² = 1 - ((|s|² - b_L² - b_R²) /
    (2 b_L b_R))², the sine of the angle between the couplers."""
    p = arm[NUMBERS:]
    c1, s1 = turned(jet_of(q, 0))
    c5, s5 = turned(jet_of(q, 1))
    x = plus(scaled(p[2], c5), scaled(-p[1], c1))
    y = plus(plus(scaled(p[2], s5), scaled(-p[1], s1)), constant(-p[0]))
    # |s|² in which each joint occurs as little as may be (K37): bounds of a sum of squares would be much wider
    turn = turned(plus(jet_of(q, 1), scaled(-1.0, jet_of(q, 0))))[0]
    square = plus(scaled(2.0 * p[0] * p[1], s1), scaled(-2.0 * p[0] * p[2], s5))
    square = plus(plus(square, scaled(-2.0 * p[1] * p[2], turn)), constant(p[0] ** 2 + p[1] ** 2 + p[2] ** 2))
    fold = scaled(0.5 / (p[3] * p[4]), plus(square, constant(-(p[3] ** 2) - p[4] ** 2)))
    return x, y, square, plus(constant(1.0), scaled(-1.0, times(fold, fold)))


@kernel(f"boolean({F1}, {F2}, {F3}, int64)")
def five_bar(arm: FloatArray, q: FloatArray, jets: FloatArray, c: int) -> bool:
    """`links` of a five-bar behind its base."""
    p, z = arm[NUMBERS:], constant(arm[BASE + 2])
    x, y, square, margin = elbows(arm, q)
    if not (margin[0] > 0.0 and square[0] > 0.0):
        return False
    # the left coupler u = along s + across s⊥ with |u| = b_L, and s - u as long as b_R
    over = inverse(square)
    along = plus(constant(0.5), scaled(0.5 * (p[3] ** 2 - p[4] ** 2), over))
    across = scaled(p[5] * p[3] * p[4], times(root(margin), over))
    ux = plus(times(along, x), scaled(-1.0, times(across, y)))
    uy = plus(times(along, y), times(across, x))
    cb, sb = np.cos(arm[BASE + 3]), np.sin(arm[BASE + 3])
    tx, ty, ct, st = ux, uy, ux, uy
    for side in range(2):
        cq, sq = turned(jet_of(q, side))
        vx, vy = (ux, uy) if side == 0 else (plus(ux, scaled(-1.0, x)), plus(uy, scaled(-1.0, y)))
        crank, coupler, half = p[1 + side], p[3 + side], p[0] * (0.5 - side)
        ax, ay = constant(arm[BASE] - sb * half), constant(arm[BASE + 1] + cb * half)
        cw, sw = plus(scaled(cb, cq), scaled(-sb, sq)), plus(scaled(sb, cq), scaled(cb, sq))
        upright(jets, c + 1 + side, ax, ay, z, cw, sw)
        ax, ay = plus(ax, scaled(crank, cw)), plus(ay, scaled(crank, sw))
        cw, sw = plus(scaled(cb, vx), scaled(-sb, vy)), plus(scaled(sb, vx), scaled(cb, vy))
        upright(jets, c + 3 + side, ax, ay, z, scaled(1.0 / coupler, cw), scaled(1.0 / coupler, sw))
        if side == 0:
            tx, ty, ct, st = plus(ax, cw), plus(ay, sw), scaled(1.0 / coupler, cw), scaled(1.0 / coupler, sw)
    lift = plus(z, jet_of(q, 2)) if arm[AXIS_COUNT] > 2.0 else z
    upright(jets, c + 5, tx, ty, lift, constant(1.0), constant(0.0))
    if arm[AXIS_COUNT] > 3.0:
        cq, sq = turned(jet_of(q, 3))
        ct, st = plus(times(cq, ct), scaled(-1.0, times(sq, st))), plus(times(sq, ct), times(cq, st))
    upright(jets, c + 6, tx, ty, lift, ct, st)
    return True


@kernel(f"boolean({F1}, {F2}, {F3}, int64)")
def links(arm: FloatArray, q: FloatArray, jets: FloatArray, c: int) -> bool:
    """All links of an arm from the jets q of its joints, as carriers c, c + 1 ...; False: it does not assemble."""
    x, y, z = constant(arm[BASE]), constant(arm[BASE + 1]), constant(arm[BASE + 2])
    yaw, p, family = constant(arm[BASE + 3]), arm[NUMBERS:], int(arm[FAMILY])
    cb, sb = turned(yaw)
    upright(jets, c, x, y, z, cb, sb)
    if family == FIVE_BAR:
        return five_bar(arm, q, jets, c)
    ca, sa = turned(plus(yaw, jet_of(q, 0)))
    if family == SCARA:
        phi = plus(plus(yaw, jet_of(q, 0)), jet_of(q, 1))
        cf, sf = turned(phi)
        lift = plus(z, jet_of(q, 2))
        high = lift if p[2] > 0.0 else z
        upright(jets, c + 1, x, y, high, ca, sa)
        x, y = plus(x, scaled(p[0], ca)), plus(y, scaled(p[0], sa))
        upright(jets, c + 2, x, y, high, cf, sf)
        x, y = plus(x, scaled(p[1], cf)), plus(y, scaled(p[1], sf))
        upright(jets, c + 3, x, y, lift, constant(1.0), constant(0.0))
        if arm[AXIS_COUNT] > 3.0:
            cf, sf = turned(plus(phi, jet_of(q, 3)))
        upright(jets, c + 4, x, y, lift, cf, sf)
        return True
    z = plus(z, constant(p[0]))
    one, none, pitch = constant(1.0), constant(0.0), jet_of(q, 1)
    upright(jets, c + 1, x, y, z, ca, sa)
    cp, sp = turned(pitch)
    tilted(jets, c + 2, x, y, z, ca, sa, cp, sp, one, none)
    if family == POLAR:
        out = times(jet_of(q, 2), cp)
        x, y, z = plus(x, times(out, ca)), plus(y, times(out, sa)), plus(z, times(jet_of(q, 2), sp))
        tilted(jets, c + 3, x, y, z, ca, sa, cp, sp, one, none)
        tilted(jets, c + 4, x, y, z, ca, sa, cp, sp, one, none)
        return True
    out, high = scaled(p[1], cp), plus(z, scaled(p[1], sp))
    pitch = plus(pitch, jet_of(q, 2))
    cp, sp = turned(pitch)
    tilted(jets, c + 3, plus(x, times(out, ca)), plus(y, times(out, sa)), high, ca, sa, cp, sp, one, none)
    out, high = plus(out, scaled(p[2], cp)), plus(high, scaled(p[2], sp))
    if family == ELBOW:
        tilted(jets, c + 4, plus(x, times(out, ca)), plus(y, times(out, sa)), high, ca, sa, cp, sp, one, none)
        return True
    cp, sp = turned(plus(pitch, jet_of(q, 3)))
    tilted(jets, c + 4, plus(x, times(out, ca)), plus(y, times(out, sa)), high, ca, sa, cp, sp, one, none)
    out, high = plus(out, scaled(p[3], cp)), plus(high, scaled(p[3], sp))
    cr, sr = turned(jet_of(q, 4))
    tilted(jets, c + 5, plus(x, times(out, ca)), plus(y, times(out, sa)), high, ca, sa, cp, sp, cr, sr)
    return True


@kernel(f"void({F2}, {F2})")
def control(frames: FloatArray, pieces: FloatArray) -> None:
    """Control values of pieces in place of the coefficients a_m of the powers of the time since the begin of each:
    b_i = Σ_m C(i, m) / C(degree, m) a_m h^m."""
    for f in range(len(frames)):
        own = int(frames[f, KIND]) != NEIGHBOUR
        first, count, degree = int(frames[f, FIRST]), int(frames[f, COUNT]), int(frames[f, DEGREE]) if own else 0
        for i in range(first, first + count if own else first):
            h = pieces[i, END] - pieces[i, BEGIN]
            for k in range(4):
                b, share = pieces[i, CONTROL + k * WIDTH : CONTROL + (k + 1) * WIDTH], 1.0
                for m in range(1, degree + 1):
                    share *= h * m / (degree + 1 - m)
                    b[m] *= share
                for r in range(degree):
                    for m in range(degree, r, -1):
                        b[m] += b[m - 1]


@kernel(f"boolean({F1}, float64, float64, {F2}, {F3}, int64)", allocates=True)
def fixed_law(frame: FloatArray, t0: float, t1: float, pieces: FloatArray, jets: FloatArray, c: int) -> bool:
    """`carry` of a frame whose law is a formula."""
    found, work, rate, first = np.empty((4, 6)), np.empty(WIDTH), np.empty(WIDTH), int(frame[FIRST])
    degree, last, period, gone = int(frame[DEGREE]), first + int(frame[COUNT]) - 1, frame[PERIOD], 0.0
    for k in range(4):
        for order in range(3):
            found[k, 2 * order], found[k, 2 * order + 1] = np.inf, -np.inf
    if period > 0.0:
        gone = np.floor((t0 - pieces[first, BEGIN]) / period)
        t0, t1 = t0 - gone * period, t1 - gone * period
    elif not (pieces[first, BEGIN] <= t0 and t1 <= pieces[last, END]):
        return False
    i = first
    while i < last and not t0 < pieces[i, END]:
        i += 1
    while i <= last:
        h = pieces[i, END] - pieces[i, BEGIN]
        s0 = min(max((t0 - pieces[i, BEGIN]) / h, 0.0), 1.0)
        s1 = min(max((t1 - pieces[i, BEGIN]) / h, s0), 1.0)
        for k in range(4):
            for m in range(degree + 1):
                rate[m] = pieces[i, CONTROL + k * WIDTH + m]
            for order in range(3):
                left = max(degree - order, 0)
                for m in range(left + 1):
                    work[m] = rate[m] + (gone * frame[AGAIN + k] if order == 0 else 0.0)
                    rate[m] = left * (rate[m + 1] - rate[m]) / h if m < left else 0.0
                cut(work, left, s0, s1)
                widen(work, left, found, k, order)
        if t1 <= pieces[i, END]:
            break
        i += 1
        if i > last and period > 0.0:
            # behind a whole period those that follow go on evenly: the last but one and the last bound them all
            far = np.floor((t1 - pieces[first, BEGIN]) / period) - 1.0
            ahead = 1.0 if t0 >= pieces[first, BEGIN] else max(far, 1.0)
            i, gone, t0, t1 = first, gone + ahead, t0 - ahead * period, t1 - ahead * period
    x, y, z, yaw = jet_of(found, 0), jet_of(found, 1), jet_of(found, 2), jet_of(found, 3)
    if int(frame[KIND]) == SWING:
        wave = turned(yaw)[1]
        x, y = plus(x, scaled(frame[AMPLITUDE], wave)), plus(y, scaled(frame[AMPLITUDE + 1], wave))
        z = plus(z, scaled(frame[AMPLITUDE + 2], wave))
        yaw = plus(constant(frame[MEAN]), scaled(frame[AMPLITUDE + 3], wave))
    cosine, sine = turned(yaw)
    upright(jets, c, x, y, z, cosine, sine)
    return True


@kernel(f"{F3}({TABLES})", allocates=True)
def all_jets(tables: Tables) -> FloatArray:
    """Room for the jets of all carriers, and of the links of a neighbour's arm behind them."""
    return np.zeros((int(tables[0][0, LINKS]) + len(tables[2]) + MOST_LINKS, JETS, 6))


@kernel(f"boolean(int64, float64, float64, {TABLES}, {F3})", allocates=True)
def carry(c: int, t0: float, t1: float, tables: Tables, jets: FloatArray) -> bool:
    """Jets over [t0, t1] of carrier c: a link of the arm, and then of all of them, or a frame behind those.

    `jets`: as `all_jets` has them. False: not known, or not assembled, throughout.
    """
    arms, curves, frames, pieces, _, _ = tables
    q = np.empty((8, 6))
    arm, at, frame = 0, 0, c - int(arms[0, LINKS])
    if frame >= 0:
        if not (frames[frame, SINCE] <= t0 and t0 <= t1 and t1 <= frames[frame, UNTIL]):
            return False
        if int(frames[frame, KIND]) != NEIGHBOUR:
            return fixed_law(frames[frame], t0, t1, pieces, jets, c)
        arm, at = int(frames[frame, FIRST]), len(jets) - MOST_LINKS
    row = arms[arm]
    joints(curves, int(row[FIRST_KNOT]), int(row[LAST_KNOT]), int(row[AXIS_COUNT]), t0, t1, q)
    if not links(row, q, jets, at):
        return False
    if frame >= 0:
        jets[c] = jets[at + int(frames[frame, COUNT])]
    return True
