"""Arches in a claim: each goes up and then down, and as high as its step requires.

Rows are sums that have one joint: the lift. Its rate is no less than stated on the way up, and no more on the way down.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.claim import columns as c
from assur.planner.model.outcome import LegKind, Plan
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory

# What writers of rows need of a motion: parts of it in which no acceleration jumps, and where a joint is largest.

BESIDE = 1e-9
"""Share of a piece of the motion by which instants are before its end, where accelerations or jerks jump."""
SHARES = np.linspace(0.0, 1.0, 17)
"""Instants at which a joint is evaluated, as shares of an interval."""
PIECES, ROUNDS = 4, 5
"""Pieces of the motion that go on to the next round, those in which a joint is largest; and rounds, each between the
neighbours of the instant at which it is."""


def between_jumps(path: Trajectory, t0: float, t1: float) -> list[tuple[float, float]]:
    """[t0, t1] in parts within which no acceleration jumps."""
    inside = path.edges[(path.edges > t0) & (path.edges < t1)].tolist() if path.jumps else []
    return list(pairwise([t0, *inside, t1]))


def largest(
    path: Trajectory, order: int, t0: float, t1: float, size: Callable[[FloatArray], FloatArray] = np.abs
) -> tuple[FloatArray, FloatArray]:
    """When (n,), within [t0, t1], a derivative of each joint has the largest `size`, and its value there (n,).

    Instants are before the end of their piece where that derivative may jump there: at a knot the piece that begins
    counts. Zeros where the interval reaches into no piece.
    """
    begins, steps = path.edges[:-1], path.steps
    rim = BESIDE if order > 1 else 0.0
    low, high = (np.clip((t - begins) / steps, 0.0, 1.0 - rim) * steps for t in (t0, t1))
    own, n = np.flatnonzero(low < high), path.n
    if not len(own):
        return np.full(n, t0), np.zeros(n)
    powers = np.array([math.perm(i, order) for i in range(6)], dtype=float)[order:]
    factors = (path.coefficients[own][:, :, order:] * powers).reshape(-1, len(powers))  # a row: one joint in one piece
    begin, end, first, last = (np.repeat(each[own], n) for each in (begins, path.edges[1:], low, high))
    for _ in range(ROUNDS):
        tau = first[:, None] + (last - first)[:, None] * SHARES
        value = np.zeros_like(tau)
        for factor in factors.T[::-1]:
            value = value * tau + factor[:, None]
        sizes, row = size(value), np.arange(len(tau))
        best = sizes.argmax(1)
        go_on = np.argsort(sizes[row, best].reshape(-1, n), axis=0)[-PIECES:] * n + np.arange(n)
        row, best = (each[go_on.ravel()] for each in (row, best))
        first, last = (tau[row, each] for each in (np.maximum(best - 1, 0), np.minimum(best + 1, len(SHARES) - 1)))
        t, value, begin, end, factors = tau[row, best], value[row, best], begin[row], end[row], factors[row]
    when = begin + t
    if order > 1:  # late on the clock the rim of a short piece is less than rounding
        when = np.minimum(when, np.nextafter(end, -np.inf))
    return np.clip(when[-n:], t0, t1), value[-n:]


Row = tuple[float, ...]
SLOW_M_S = 1e-6
"""So fast the lift may go the wrong way wherever its rate is 0, m/s: it moves by less than what counts."""
SAMPLES, RIM = 128, 1e-6
"""Parts of a piece of the motion at whose ends the rate of the lift is evaluated; and the share of a piece by which its
jerk is evaluated within it."""
ONLY = tuple(map(tuple, np.eye(c.MOST_JOINTS).tolist()))
"""For each joint the shares of a sum that has this joint alone."""
NEAR = 1e-8
"""A joint is stated to be so near its value, rad or m: ten times what the claim checker keeps for rounding."""
SLOWLY_M = 2e-5
"""Twice the way that the lift may go back in total, m, however long it takes at `SLOW_M_S`."""
FINE_M, PARTS = 1e-6, 16
"""A piece of the motion for which more of a way back is stated, m, is divided into so many parts."""
BACK_M, BACK = 9e-5, 0.099
"""m, and share of the rise: an arch goes so far the wrong way in total. It is a little less than what is accepted."""


def arch_top(scene: Scene, plan: Plan, number: int) -> float:
    """When, s, the lift is highest on the arches of a step."""
    spans = [leg for leg in plan.legs if leg.step == number and leg.kind is LegKind.ARCH]
    return _top(plan.trajectory, scene.robot.lift or 0, spans[0].t0, spans[-1].t1)


def arches_of(scene: Scene, plan: Plan) -> list[Row]:
    """Rows of sums: of each arch the lift at its begin, its top and its end, and rates on the ways up and down."""
    lift, path, found = scene.robot.lift, plan.trajectory, list[Row]()
    for leg in plan.legs:
        if leg.kind is not LegKind.ARCH or lift is None:
            continue
        share = ONLY[lift]
        turn = _top(path, lift, leg.t0, leg.t1)
        heights = path.evaluate(np.array([leg.t0, turn, leg.t1]))[:, lift].tolist()
        found += [(t, t, 0, *share, z - NEAR, z + NEAR) for t, z in zip((leg.t0, turn, leg.t1), heights, strict=True)]
        for sign, t0, t1 in ((1.0, leg.t0, turn), (-1.0, turn, leg.t1)):
            for begin, end, least in _rates(path, lift, sign, t0, t1):
                bounds = (least, c.GREATEST) if sign > 0.0 else (-c.GREATEST, -least)
                found.append((begin, end, 1, *share, *bounds))
    return found


def goes_over(path: Trajectory, lift: int) -> bool:
    """Whether a joint goes up and then down over all of a motion, so that a claim can state that it is an arch."""
    turn = _top(path, lift, path.start, path.end)
    begin, top, end = path.evaluate(np.array([path.start, turn, path.end]))[:, lift].tolist()
    rates = [*_rates(path, lift, 1.0, path.start, turn), *_rates(path, lift, -1.0, turn, path.end)]
    back = sum(max(-least, 0.0) * (t1 - t0) for t0, t1, least in rates)
    return bool(back <= BACK_M + BACK * (top - max(begin, end)))


def _top(path: Trajectory, lift: int, t0: float, t1: float) -> float:
    """When the lift is highest in an interval, s."""
    return float(largest(path, 0, t0, t1, np.positive)[0][lift])


def _rates(path: Trajectory, lift: int, sign: float, t0: float, t1: float) -> list[tuple[float, float, float]]:
    """The pieces of the motion from t0 to t1, and the least rate of the lift, times `sign`, in each. Pieces in which it
    goes back are in parts: a whole one would be stated to go back all of the time."""
    if not t0 < t1:
        return []
    edges = np.unique(np.concatenate([[t0], path.time[(path.time > t0) & (path.time < t1)], [t1]]))
    slow = min(SLOW_M_S, 0.5 * SLOWLY_M / (t1 - t0))  # so little in total, however long it lasts
    least = _least_rates(path, lift, sign, edges) - slow
    goes_back = least * np.diff(edges) < -FINE_M
    if goes_back.any():
        begins, steps = edges[:-1][goes_back, None], np.diff(edges)[goes_back, None]
        edges = np.union1d(edges, begins + steps * np.arange(1, PARTS) / PARTS)
        least = _least_rates(path, lift, sign, edges) - slow
    return list(zip(edges.tolist(), edges[1:].tolist(), least.tolist(), strict=False))


def _least_rates(path: Trajectory, lift: int, sign: float, edges: FloatArray) -> FloatArray:
    """A lower bound of the rate of the lift, times `sign`, between one of the edges (K,) and the next, (K-1,)."""
    begins, steps = edges[:-1, None], np.diff(edges)[:, None]
    shares = np.linspace(0.0, 1.0, SAMPLES + 1)
    # at its end a piece has the jerk of the next one
    rates, jerks = (
        path.evaluate(np.minimum(begins + steps * u, edges[1:, None]).ravel(), order)[:, lift].reshape(-1, SAMPLES + 1)
        for order, u in ((1, shares), (3, np.clip(shares, RIM, 1.0 - RIM)))
    )
    # between two samples a rate leaves its chord by no more than its second derivative lets it
    bows = 0.13 * np.abs(jerks).max(1) * (steps[:, 0] / SAMPLES) ** 2
    return np.asarray((sign * rates).min(1) - bows)
