"""Arches in a claim: each goes up and then down, and as high as its step requires.

Rows are sums that have one joint: the lift. Its rate is no less than stated on the way up, and no more on the way down.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

import numpy as np

from assur.planner.claim import columns as c
from assur.planner.claim.extremes import largest
from assur.planner.model.outcome import LegKind, Plan
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory

Row = tuple[float, ...]
SLOW_M_S = 1e-6
"""So fast the lift may go the wrong way wherever its rate is 0, m/s: it moves by less than what counts."""
SAMPLES = 128
"""Parts of a piece of the motion at whose ends the rate of the lift is evaluated."""
ONLY = tuple(map(tuple, np.eye(c.MOST_JOINTS).tolist()))
"""For each joint the shares of a sum that has this joint alone."""
NEAR = 1e-8
"""A joint is stated to be so near its value, rad or m: ten times what the claim checker keeps for rounding."""
BACK_M = 2e-5
"""A way that goes back by no more in total is stated in one row, m; else the pieces that go back have their own."""


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
            if t0 < t1:
                found += [_one_way(share, sign, *each) for each in _rates(path, lift, sign, t0, t1)]
    return found


def _one_way(share: Sequence[float], sign: float, t0: float, t1: float, least: float) -> Row:
    """The row of an interval in which the lift goes up (sign 1) or down (-1), but for `least`, m/s."""
    return (t0, t1, 1, *share, *((least, c.GREATEST) if sign > 0.0 else (-c.GREATEST, -least)))


def _top(path: Trajectory, lift: int, t0: float, t1: float) -> float:
    """When the lift is highest in an interval, s."""
    return float(largest(path, 0, t0, t1, np.positive)[0][lift])


def _rates(path: Trajectory, lift: int, sign: float, t0: float, t1: float) -> list[tuple[float, float, float]]:
    """Intervals that cover [t0, t1], and the least rate of the lift, times `sign`, in each: one for all pieces, or
    pieces that go back apart from those that do not."""
    edges = np.unique(np.concatenate([[t0], path.time[(path.time > t0) & (path.time < t1)], [t1]]))
    t = edges[:-1, None] + np.diff(edges)[:, None] * np.linspace(0.0, 1.0, SAMPLES + 1)
    t[:, -1] = edges[1:]
    rim = 1e-6 * np.diff(edges)[:, None]
    inside = np.clip(t, edges[:-1, None] + rim, edges[1:, None] - rim)
    rate = sign * path.evaluate(t.ravel(), 1)[:, lift].reshape(t.shape)
    jerk = path.evaluate(inside.ravel(), 3)[:, lift].reshape(t.shape)  # at its end a piece has the jerk of the next one
    slow = min(SLOW_M_S, 0.5 * BACK_M / (t1 - t0))  # so little in total, however long it lasts
    # between two samples a rate leaves its chord by no more than its second derivative lets it
    least = rate.min(1) - 0.13 * np.abs(jerk).max(1) * (np.diff(edges) / SAMPLES) ** 2 - slow
    if float(-least.min()) * (t1 - t0) <= BACK_M:
        return [(t0, t1, float(least.min()))]
    found = []
    for _, group in groupby(zip(edges.tolist(), edges[1:].tolist(), least.tolist(), strict=False), key=_goes_back):
        own = list(group)
        found.append((own[0][0], own[-1][1], min(each[2] for each in own)))
    return found


def _goes_back(piece: tuple[float, float, float]) -> bool:
    """Whether the least rate of a piece is negative."""
    return piece[2] < -2.0 * SLOW_M_S
