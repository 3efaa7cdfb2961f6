"""Support-function gaps between convex units, in one batch, and directions along which they are likely to be apart.

For any unit normal n, gap(n) = n·(c_B - c_A) - σ_A(n) - σ_B(-n) is a lower bound of the distance of A and B
(equation C1 in docs/guarantees.md), so a bad direction costs efficiency and never safety.

Batches are (r, ...) to whoever looks, but lie in memory with r innermost: products of many small matrices are then sums
over long rows, several times faster than one small product after the other.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.collision.arrangement import COVER, Carriers, Solids
from assur.planner.collision.footprints import outlines

ROUNDS = 3
"""Alternating projections between two cores before their direction is taken as a normal. They converge quickly except
for nearly parallel faces, where the face normals of `face_normals` are exact."""


COMMON_M = 1e-12
"""Points of two solids nearer than this, m, are one point: a few roundings."""
FEW = 64
"""Pairs for which bounds at all times are as cheap as bounds over all times together."""


@dataclass(frozen=True, slots=True)
class Placed:
    """Units `unit` (r,) of a `Solids` at world centres (r, 3) with world axes (r, 3, 3), columns."""

    solids: Solids
    unit: IntArray
    centre: FloatArray
    axes: FloatArray

    def rows(self, key: BoolArray | IntArray | slice) -> Placed:
        """Some of the rows."""
        axes = self.axes.transpose(1, 2, 0)[..., key].transpose(2, 0, 1)
        return Placed(self.solids, self.unit[key], self.centre.T[:, key].T, axes)


def _laid(x: FloatArray) -> FloatArray:
    """The same array (r, N) or (r, N, M) with its first axis innermost in memory."""
    if x.ndim == 2:
        return np.ascontiguousarray(x.T).T
    return np.ascontiguousarray(x.transpose(1, 2, 0)).transpose(2, 0, 1)


def place(solids: Solids, where: Carriers, row: IntArray, unit: IntArray) -> Placed:
    """Units `unit` (r,) at the times number `row` (r,) of `where`."""
    carrier = solids.carrier[unit]
    rotation = _laid(where.rotation[row, carrier])
    centre = np.einsum("rij,rj->ri", rotation, _laid(solids.centre[unit]))
    centre += where.position[row, carrier]
    return Placed(solids, unit, centre, np.einsum("rij,rjk->rik", rotation, _laid(solids.rotation[unit])))


def support(placed: Placed, n: FloatArray) -> FloatArray:
    """max over the unit of n·(x - centre), (r, N), for directions n (r, N, 3)."""
    solids, unit = placed.solids, placed.unit
    local = np.einsum("rni,rij->rnj", n, placed.axes)
    sigma: FloatArray = np.einsum("rnj,rj->rn", np.abs(local), _laid(solids.half[unit]))
    disc = solids.disc[unit]
    if disc.any():
        sigma += disc[:, None] * np.sqrt(local[..., 0] ** 2 + local[..., 1] ** 2)
    sigma += solids.ball[unit][:, None]
    if solids.hulls:
        hull = solids.hull[unit]
        for k in np.unique(hull[hull >= 0]):
            rows = hull == k
            sigma[rows] = (local[rows] @ solids.hulls[k].vertices.T).max(-1)
    return sigma


def gaps(a: Placed, b: Placed, n: FloatArray) -> FloatArray:
    """Gap (r, N) along unit normals n (r, N, 3) that point from a to b."""
    n = _laid(n)
    between: FloatArray = np.einsum("rni,ri->rn", n, b.centre - a.centre)
    found: FloatArray = between - support(a, n) - support(b, -n)
    return found


def _nearest(placed: Placed, half: FloatArray, disc: FloatArray | None, x: FloatArray) -> FloatArray:
    """The point of each unit's core (its box and disc, without the ball) nearest to x (r, 3)."""
    y = np.einsum("ri,rij->rj", x - placed.centre, placed.axes)
    inside = np.minimum(np.maximum(y, -half), half)
    if disc is not None:
        out = y[:, :2] - inside[:, :2]
        length = np.sqrt(out[:, 0] ** 2 + out[:, 1] ** 2)
        inside[:, :2] += out * np.minimum(1.0, disc / np.maximum(length, 1e-300))[:, None]
    found: FloatArray = np.einsum("rij,rj->ri", placed.axes, inside)
    found += placed.centre
    return found


def _core(placed: Placed) -> tuple[FloatArray, FloatArray | None]:
    """Half sizes (r, 3) of the boxes of the cores and radii (r,) of their discs, None where all are 0."""
    disc = placed.solids.disc[placed.unit]
    return _laid(placed.solids.half[placed.unit]), disc if disc.any() else None


def _line(a: Placed, b: Placed) -> tuple[FloatArray, FloatArray]:
    """From a point of each core of a to one of b, (r, 3), and its length (r,): about the shortest there is."""
    on_b, of_a, of_b = b.centre, _core(a), _core(b)
    for _ in range(ROUNDS):
        on_a = _nearest(a, *of_a, on_b)
        on_b = _nearest(b, *of_b, on_a)
    line = on_b - on_a
    return line, np.sqrt(np.einsum("ri,ri->r", line, line))


def meet(a: Placed, b: Placed) -> BoolArray:
    """Whether a point is found that both units have in common (r,); False says nothing.

    True only of solids: not of boxes about several pieces, nor of hulls, whose cores are but boxes about them.
    """
    solid = [(x.solids.piece[x.unit] != COVER) & (x.solids.hull[x.unit] < 0) for x in (a, b)]
    touching = _line(a, b)[1] <= a.solids.ball[a.unit] + b.solids.ball[b.unit] + COMMON_M
    return np.asarray(solid[0] & solid[1] & touching)


def centre_normals(a: Placed, b: Placed) -> FloatArray:
    """(r, 2, 3): the vertical, and the line between the nearest points of the cores by alternating projection.

    Where the cores meet, the second is the vertical again: its gap is then negative, as it must be.
    """
    n = np.zeros((2, 3, len(a.unit))).transpose(2, 0, 1)
    n[:, 0, 2] = np.where(b.centre[:, 2] >= a.centre[:, 2], 1.0, -1.0)
    line, length = _line(a, b)
    apart = length > 1e-9
    n[:, 1] = np.where(apart[:, None], line / np.where(apart, length, 1.0)[:, None], n[:, 0])
    return n


def face_normals(a: Placed, b: Placed) -> FloatArray:
    """(r, 6, 3): the axes of both units, each towards b. For upright prisms they decide whether the two overlap."""
    n = np.concatenate([np.swapaxes(a.axes, 1, 2), np.swapaxes(b.axes, 1, 2)], axis=1)
    towards = np.einsum("rni,ri->rn", n, b.centre - a.centre)
    return n * np.where(towards >= 0, 1.0, -1.0)[:, :, None]


def rough_gaps(solids: Solids, where: Carriers, a: IntArray, b: IntArray) -> FloatArray:
    """Lower bounds (T, P) of the distances of unit pairs (P,) at all times: vertical order, or outlines from above, the
    first as an oblong with round corners, the second as a circle.

    Cheap enough for many pairs at all times; NaN where a carrier is not known.
    """
    at = np.zeros(len(solids.body), dtype=np.int64)
    at[a] = at[b] = 1
    units = np.flatnonzero(at)
    at[units] = np.arange(len(units))
    ia, ib = at[a], at[b]
    seen = outlines(solids, where, units)
    found = np.abs(seen.z[:, ib] - seen.z[:, ia])
    found -= seen.tall[..., ia] + seen.tall[..., ib]
    x, y = seen.x[:, ib] - seen.x[:, ia], seen.y[:, ib] - seen.y[:, ia]
    c, s = seen.c[:, ia], seen.s[:, ia]
    along = np.maximum(np.abs(c * x + s * y) - seen.oblong[ia, 0], 0.0)
    across = np.maximum(np.abs(c * y - s * x) - seen.oblong[ia, 1], 0.0)
    flat = np.sqrt(along * along + across * across) - (seen.round[ia] + seen.wide[ib])
    return np.asarray(np.maximum(found, flat))


def swept_gaps(solids: Solids, where: Carriers, a: IntArray, b: IntArray) -> FloatArray:
    """Lower bounds (P,) of the distances of unit pairs (P,) over all times together: boxes about all places of a unit.

    What does not move is looked at once. Most bodies of a large cell are ruled out by this alone; for no more than
    `FEW` pairs it does not pay, and they get −inf. NaN where a carrier is not known at some time.
    """
    if len(a) <= FEW:
        return np.full(len(a), -np.inf)
    low, high = np.full((2, len(solids.body), 3), np.nan)
    asked = np.zeros(len(solids.body), dtype=bool)
    asked[a] = asked[b] = True
    position, rotation = where.position, where.rotation
    moves = (position != position[0]).any((0, 2)) | (rotation != rotation[0]).any((0, 2, 3))
    for moving in (False, True):
        mine = np.flatnonzero(asked & (moves[solids.carrier] == moving))
        if len(mine):
            times = slice(None) if moving else slice(1)
            seen = outlines(solids, Carriers(position[times], rotation[times]), mine)
            for axis, (place, size) in enumerate(((seen.x, seen.wide), (seen.y, seen.wide), (seen.z, seen.tall))):
                low[mine, axis], high[mine, axis] = (place - size).min(0), (place + size).max(0)
    found: FloatArray = np.maximum(low[b] - high[a], low[a] - high[b]).max(1)
    return found


def likely_gaps(one: Placed, other: Placed) -> FloatArray:
    """The largest gap (r,) over the likely normals; face normals only where the first ones fail; -inf for NaN."""
    gap = gaps(one, other, centre_normals(one, other)).max(1)
    left = ~(gap > 0)
    if left.any():
        faces = gaps(one.rows(left), other.rows(left), face_normals(one.rows(left), other.rows(left))).max(1)
        gap[left] = np.maximum(gap[left], faces)
    found: FloatArray = np.where(np.isnan(gap), -np.inf, gap)
    return found
