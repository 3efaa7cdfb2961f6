"""Changes knots on a grid so that the motion between them keeps its limits.

If the jerk of a plan jumps between two knots of a grid, the quintic through its states exceeds a limit that the plan
just reaches: the acceleration by 0.02 J h, with J the jerk and h the step, and the jerk by a factor of up to 1.75. If a
leg ends between two knots, the state there is no longer exactly that of the plan. Both are corrected: a linear
programme changes the states of some knots nearby, so that the control values of position, velocity, acceleration and
jerk keep their limits, and the states at given times are exactly those of the plan. It takes the smallest such change.
If no change suffices for the jerk, its excess is the smallest.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import coo_matrix, csr_matrix, hstack, identity, vstack

from assur.planner.arrays import BoolArray, FloatArray, IntArray

V, A, J = slice(0, 5), slice(5, 9), slice(9, 12)
"""Control values of velocity, acceleration and jerk of a piece (equation T2)."""
RESERVE = 1e-6
"""Share of a limit of a rate that is left free for rounding in the linear programme."""
ENDS = 1e-3
"""A position is held on pieces that are nearer to an end of its range than this share of it."""
SAME = 1e-10
"""rad or m, and per s: states that differ by less are the same; a controller resolves a thousandth of a millimetre."""
NONE = 1e-9
"""Share of the limit: a jerk beyond it by less than this is none."""


@dataclass(frozen=True)
class Effort:
    """How far and at what price states are changed for the jerk.

    `reaches`: knots on either side of a fault that may be changed, at first and at most. `excess`: what the jerk beyond
    its limit counts, as a share of it, beside the greatest change in units of what a jump of the jerk changes in a
    step.
    """

    reaches: tuple[int, int]
    excess: float


NEAR = Effort((4, 16), 20.0)
"""Small changes; the jerk may stay beyond its limit."""
WIDE = Effort((16, 256), 1e5)
"""Changes as large as the limit of the jerk needs."""


@dataclass(frozen=True)
class Requirements:
    """Of one joint: its range (2,), limits of velocity, acceleration and jerk on each piece (3, P), which knots may not
    be changed (K,), and the times with required position and velocity (T, 3)."""

    span: FloatArray
    limits: FloatArray
    fixed: BoolArray
    at: FloatArray


def control_values(h: FloatArray) -> FloatArray:
    """What the twelve control values of rates are of the states q, v, a at both ends of pieces of lengths h (P,):
    (P, 12, 6), columns q0 v0 a0 q1 v1 a1."""
    found = np.zeros((len(h), 12, 6))
    found[:, 0, 1] = found[:, 1, 1] = found[:, 3, 4] = found[:, 4, 4] = 1.0
    found[:, 1, 2], found[:, 3, 5] = h / 4.0, -h / 4.0
    found[:, 2] = np.stack([-5.0 / h, 0 * h - 2.0, -h / 4.0, 5.0 / h, 0 * h - 2.0, h / 4.0], 1)
    found[:, A] = 4.0 * np.diff(found[:, V], axis=1) / h[:, None, None]
    found[:, J] = 3.0 * np.diff(found[:, A], axis=1) / h[:, None, None]
    return found


def halves(degree: int) -> FloatArray:
    """Control values of both halves of a polynomial from its own, (2 (degree + 1), degree + 1)."""
    rows = np.eye(degree + 1)
    left, right = [rows[0]], [rows[-1]]
    while len(rows) > 1:
        rows = (rows[:-1] + rows[1:]) / 2.0
        left.append(rows[0])
        right.append(rows[-1])
    return np.array(left + right[::-1])


HALVES = {5: halves(4), 4: halves(3), 3: halves(2)}


def positions(h: float) -> FloatArray:
    """What the six control values of the position are of the states at both ends of a piece (equation T1), (6, 6)."""
    found = np.zeros((6, 6))
    found[:3, 0] = found[3:, 3] = 1.0
    found[1, 1], found[2, 1], found[2, 2] = h / 5.0, 2.0 * h / 5.0, h * h / 20.0
    found[4, 4], found[3, 4], found[3, 5] = -h / 5.0, -2.0 * h / 5.0, h * h / 20.0
    return found


def state_at(h: float, tau: float) -> FloatArray:
    """Position and velocity at `tau` in a piece of length h, of the states at its ends: (2, 6)."""
    rows = positions(h), control_values(np.array([h]))[0, V]
    return np.stack([_bernstein(len(row) - 1, tau / h) @ row for row in rows])


def _bernstein(degree: int, s: float) -> FloatArray:
    values = np.eye(degree + 1)
    while len(values) > 1:
        values = (1.0 - s) * values[:-1] + s * values[1:]
    return np.asarray(values[0])


def faults(time: FloatArray, states: FloatArray, required: Requirements) -> IntArray:
    """The pieces (F,) on which a joint with `states` (K, 3) may exceed a limit, or does not have a required state."""
    h, ends = np.diff(time), _ends(states)
    values = np.einsum("pij,pj->pi", control_values(h), ends)
    bad = np.zeros(len(h), dtype=np.bool_)
    for part, degree, limit in ((V, 4, required.limits[0]), (A, 3, required.limits[1]), (J, 2, required.limits[2])):
        bad |= ~(np.abs(_finer(values[:, part], degree)).max(1) <= (1.0 - RESERVE / 2.0) * limit)
    places = _finer(np.stack([positions(step) @ row for step, row in zip(h, ends, strict=True)]), 5)
    bad |= (places.min(1) < required.span[0]) | (places.max(1) > required.span[1])
    for t, q, v in required.at.tolist():
        p = _piece(time, t)
        off = state_at(float(h[p]), t - float(time[p])) @ ends[p] - (q, v)
        bad[p] |= bool(np.abs(off).max() > SAME)
    return np.flatnonzero(bad)


def _finer(values: FloatArray, degree: int) -> FloatArray:
    """Control values (P, C) of eight parts of polynomials, from their own."""
    cut = halves(degree)
    for _ in range(3):
        parts = [part @ cut.T for part in np.split(values, values.shape[1] // (degree + 1), 1)]
        values = np.concatenate(parts, 1)
    return values


def _ends(states: FloatArray) -> FloatArray:
    return np.concatenate([states[:-1], states[1:]], 1)


def _piece(time: FloatArray, t: float) -> int:
    return int(np.clip(np.searchsorted(time, t, side="right") - 1, 0, len(time) - 2))


def kept(time: FloatArray, states: FloatArray, required: Requirements, effort: Effort = NEAR) -> FloatArray | None:
    """The states (K, 3) of a joint, changed where `faults` are; None where no change was found that mends them. The
    jerk may be beyond its limit, where that cannot be helped with this effort."""
    bad, best, least = faults(time, states, required), None, np.inf
    if not len(bad):
        return states
    reach = np.full(len(bad), effort.reaches[0])
    while True:
        made, worst = states.copy(), 0.0
        for first, last in _windows(bad, reach, len(time)):
            excess = _mended(time, made, required, (first, last), effort.excess)
            worst = max(worst, excess)
            if excess > NONE:
                reach[(bad >= first) & (bad < last)] *= 2
        if worst < least:
            best, least = made, worst
        if least <= NONE or reach.max() > effort.reaches[1]:
            return best


def _windows(bad: IntArray, reach: IntArray, count: int) -> list[tuple[int, int]]:
    """First and last knot of windows about pieces, each so many knots wide to both sides; those that overlap are
    one."""
    found: list[tuple[int, int]] = []
    for piece, wide in zip(bad.tolist(), reach.tolist(), strict=True):
        first, last = max(0, piece - wide), min(count - 1, piece + 1 + wide)
        while found and first < found[-1][1]:
            first, last = min(first, found[-1][0]), max(last, found[-1][1])
            found.pop()
        found.append((first, last))
    return found


def _mended(
    time: FloatArray, states: FloatArray, required: Requirements, window: tuple[int, int], price: float
) -> float:
    """Changes the states between two knots, which stay as they are. The share of its limit by which the jerk is beyond
    it then; infinite: the other limits cannot be kept, and nothing was changed."""
    first, last = window
    free = np.array([k for k in range(first + 1, last) if not required.fixed[k]], dtype=np.int64)
    if not len(free):
        return np.inf
    h, base = np.diff(time[first : last + 1]), _ends(states[first : last + 1])
    limits, step = required.limits[:, first:last], float(h.max())
    unit = float(limits[2].max()) * np.array([step**3, step**2, step])
    place = np.full(last - first + 1, -1)
    place[free - first] = np.arange(len(free))
    many = 3 * len(free)
    rows = _Rows(place, unit, many + 2)
    near = ENDS * (required.span[1] - required.span[0])
    for p, matrix in enumerate(control_values(h)):
        for part, kind in ((V, 0), (A, 1), (J, 2)):
            cut = HALVES[part.stop - part.start] @ matrix[part]
            rows.within(cut, p, cut @ base[p], limits[kind, p], excess=kind == 2)
        own = positions(h[p])
        values = own @ base[p]
        if (values - required.span[0]).min() < near or (required.span[1] - values).min() < near:
            rows.add(own / unit[0], p, (required.span[1] - values) / unit[0])
            rows.add(-own / unit[0], p, (values - required.span[0]) / unit[0])
    equal = _Rows(place, unit, many + 2)
    for t, *goal in required.at[(required.at[:, 0] >= time[first]) & (required.at[:, 0] < time[last])].tolist():
        p = _piece(time, t) - first
        row = state_at(float(h[p]), t - float(time[first + p])) / unit[:2, None]
        equal.add(row, p, np.array(goal) / unit[:2] - row @ base[p])
    upper, below = rows.made()
    change = hstack([identity(many), coo_matrix((many, 1)), coo_matrix(-np.ones((many, 1)))])
    back = hstack([-identity(many), coo_matrix((many, 1)), coo_matrix(-np.ones((many, 1)))])
    cost = np.zeros(many + 2)
    cost[-2:] = price, 1.0
    found = linprog(
        cost, vstack([upper, change, back]), np.concatenate([below, np.zeros(2 * many)]), *equal.made(),
        [(None, None)] * many + [(0, None)] * 2, method="highs",
    )  # fmt: skip
    if found.status != 0:
        return np.inf
    states[free] += found.x[:-2].reshape(-1, 3) * unit
    return float(found.x[-2])


class _Rows:
    """Rows of a linear programme over the changes of the knots that are free, in units; behind them the excess of the
    jerk and the greatest change."""

    def __init__(self, place: IntArray, unit: FloatArray, columns: int) -> None:
        self.place, self.unit, self.columns = place, unit, columns
        self.rows: list[FloatArray] = []
        self.pieces: list[int] = []
        self.right: list[float] = []
        self.excess: list[bool] = []

    def add(self, rows: FloatArray, piece: int, right: FloatArray, *, excess: bool = False) -> None:
        """Rows (R, 6) over the states at the ends of a piece."""
        self.rows += list(rows)
        self.pieces += [piece] * len(rows)
        self.right += right.tolist()
        self.excess += [excess] * len(rows)

    def within(self, rows: FloatArray, piece: int, values: FloatArray, limit: float, *, excess: bool) -> None:
        """What is `values` now stays within a limit on both sides."""
        for side in (1.0, -1.0):
            self.add(side * rows / limit, piece, 1.0 - RESERVE - side * values / limit, excess=excess)

    def made(self) -> tuple[csr_matrix | None, FloatArray | None]:
        """The matrix and the right side; none without rows."""
        if not self.rows:
            return None, None
        values = np.array(self.rows).reshape(-1, 2, 3) * self.unit
        knot = np.array(self.pieces)[:, None] + np.array([0, 1])
        column = 3 * self.place[knot][:, :, None] + np.arange(3)
        line = np.broadcast_to(np.arange(len(values))[:, None, None], values.shape)
        there = np.broadcast_to((self.place[knot] >= 0)[:, :, None], values.shape)
        over = np.flatnonzero(self.excess)
        data = np.concatenate([values[there], -np.ones(len(over))])
        at = np.concatenate([line[there], over]), np.concatenate([column[there], np.full(len(over), self.columns - 2)])
        return csr_matrix((data, at), shape=(len(values), self.columns)), np.array(self.right)
