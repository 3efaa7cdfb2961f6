"""A five-bar from its two sides: the inverse by two dyads.

The tool axis at p, in base axes: the dyad of a side runs from its crank axis A over the elbow to p, so d = p − A. With
u', w' of the left side and u'', w'' of the right one the couplers are u = w' and −w = w'', hence

    θ1 = ∠u'    θ5 = ∠u''    D = w'' × w'    θ4 = yaw − ψ − ∠w'                                           (K35)

and the rates of the cranks are those of the dyads (K4 to K6).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.assur.codes import Code
from assur.planner.assur.rrr import RRR
from assur.planner.frames.motion import Motion, Pose
from assur.planner.robots.loop import Loop
from assur.planner.robots.planar import principal
from assur.planner.robots.protocol import Inverse

FLAT_M = 1e-9
"""How far from its height, m (and m/s, m/s²), the flange of an arm without a quill may be asked to be: rounding."""
WORST = np.array([0, 5, 2, 3, 4, 1], dtype=np.int64)
"""By code, which of two is told: out of reach before indeterminate before stretched and folded."""


@dataclass(frozen=True)
class Sides:
    """The two arms: their crank axes ±`separation`/2 along y, and the `dyads` of crank and coupler, left and right."""

    separation: float
    dyads: tuple[RRR, RRR]


def merged(
    base: Pose,
    axes: int,
    loop: Loop,
    sides: Sides,
    sigma: tuple[int, int],
    flange: Motion,
    order: int,
    least: float,
) -> Inverse:
    """The inverse of a five-bar (K35): see `FiveBar.inverse`."""
    path = (flange.p, flange.v, flange.a, flange.j)[: order + 1]
    turn = (flange.yaw, flange.yaw_d, flange.yaw_dd, flange.yaw_ddd)[: order + 1]
    c, s = np.cos(base.yaw), np.sin(base.yaw)
    x, y = path[0][..., 0] - base.x, path[0][..., 1] - base.y
    given = [(c * x + s * y, c * y - s * x)]
    given += [(c * v[..., 0] + s * v[..., 1], c * v[..., 1] - s * v[..., 0]) for v in path[1:]]
    half = sides.separation / 2
    left, right = (
        dyad.solve(mode, (given[0][0], given[0][1] + shift), *given[1:])
        for dyad, mode, shift in zip(sides.dyads, sigma, (-half, half), strict=True)
    )
    code = np.where(WORST[left.code] >= WORST[right.code], left.code, right.code)
    parallel = loop.signed(right.w[0] * left.w[1] - right.w[1] * left.w[0])
    margin = np.minimum(left.margin, right.margin)
    coupler = np.arctan2(left.w[1], left.w[0])
    joints = np.empty((order + 1, *code.shape, axes))
    joints[0, ..., 0] = principal(np.arctan2(left.u[1], left.u[0]))
    joints[0, ..., 1] = principal(np.arctan2(right.u[1], right.u[0]))
    for k in range(order):
        joints[k + 1, ..., 0], joints[k + 1, ..., 1] = left.rates[k][0], right.rates[k][0]
    watched = [each[..., 2] for each in path]
    if axes > 2:
        for k, each in enumerate(watched):
            joints[k, ..., 2] = each - base.z if k == 0 else each
    if axes == 4:
        joints[0, ..., 3] = principal(turn[0] - base.yaw - coupler)
        for k in range(order):
            joints[k + 1, ..., 3] = turn[k + 1] - left.rates[k][1]
        watched += turn
    unknown = np.isnan(sum((each * 0.0 for each in watched), np.zeros(code.shape)))  # 0 · NaN and 0 · inf are NaN
    if axes == 2:
        heights = [path[0][..., 2] - base.z, *(each[..., 2] for each in path[1:])]
        unknown = unknown | ~np.stack([np.abs(each) <= FLAT_M for each in heights]).all(0)
    code = np.where(unknown, Code.OUT_OF_REACH, code).astype(np.int64)
    nowhere = (code == Code.OUT_OF_REACH) | (code == Code.INDETERMINATE)
    joints[1:, code != Code.ASSEMBLED] = np.nan
    code = np.where(~nowhere & ~(parallel >= least), Code.PARALLEL, code).astype(np.int64)
    joints[0, nowhere] = np.nan
    margin, parallel = (np.where(nowhere, np.nan, each) for each in (margin, parallel))
    q, qd, qdd, qddd = [*joints, *(np.full_like(joints[0], np.nan) for _ in range(3 - order))]
    return Inverse(q, qd, qdd, qddd, code, margin, parallel)
