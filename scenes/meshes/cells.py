"""Cells of a covering: the surface inside each, how far its hull reaches out of the solid, and where it is best cut.

All of this is a judgement of quality: any cuts give hulls that contain the surface (`clip`, M1).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.scenes.meshes.clip import SAME_M, clip
from assur.scenes.meshes.excess import MOST_SLOPE, Rays, doubled_area, excess, rays_of
from assur.scenes.meshes.hull import distinct, thickened
from assur.scenes.meshes.surface import SMALLEST_VOLUME_M3

Place = tuple[int, float]
"""A plane: the axis that it is across, and where on it, m."""

LEVELS = 5
"""Levels with much surface that are tried along each axis, besides the middle; and as many levels of corners,"""
FEW = 40
"""in cells with fewer triangles than this: the better cuts come in the smaller cells. In these the parts are judged by
rays of their own."""
MANY = 600
"""From this many triangles on, only cuts through the middle are tried."""
ENOUGH = 200
"""Number of corners for the estimate of a hull's volume, to compare cuts."""
OF_A_HULL = 60
"""What a hull costs besides its points, in points."""
OF_A_HALF = 80
"""What judging a part by rays of its own costs, in points."""
DIRECTIONS = np.array([[x, y, z] for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if x or y or z])
"""Directions in which the outermost corners are always among them."""
GOLDEN = (math.sqrt(5) - 1) / 2
LEAST_SHARE = 1e-3
"""A cut keeps this share of the cell's extent from its ends."""
FINALISTS = 3
"""Cuts, besides those through the middle, whose parts are judged."""
SAME_SHARE = 1e-4
"""Cuts whose hulls differ by less than this share of the cell's hull do equally well."""


@dataclass(frozen=True, slots=True)
class _Hull:
    """Volume (m³) and planes (f, 4), n·x + d <= 0 inside, of the hull of some points."""

    volume: float
    planes: FloatArray

    @staticmethod
    def of(points: FloatArray) -> _Hull:
        try:
            found = ConvexHull(points)
        except (QhullError, ValueError):  # flat, or fewer than four points
            return _Hull(0.0, ConvexHull(thickened(points)).equations)
        return _Hull(float(found.volume), found.equations)


@dataclass(frozen=True, slots=True)
class _Cut:
    """A plane through a cell, the hulls on both sides, the surface in the plane (m²), the cell's extent across it."""

    place: Place
    hulls: tuple[_Hull, _Hull]
    area: float
    extent: float

    def rank(self, whole: float) -> tuple[int, float, float]:
        volume = self.hulls[0].volume + self.hulls[1].volume
        return round(volume / whole / SAME_SHARE), -self.area, -self.extent


class Cell:
    """Triangles of a cell (k, 3, 3), in order of how far their hull reaches out of the solid, `excess` in m, at most
    `tight` where that is tight. `number`: in the order of making."""

    def __init__(self, triangles: FloatArray, number: int, tight: float) -> None:
        self.triangles, self.number, self._tight = triangles, number, tight

    def parts(self) -> Iterator[None]:
        """Computes the properties by which cells are compared, in parts; the caller may stop between two parts and go
        on later. A property that is not computed by then is computed when it is read."""
        for part in ("mesh", "hull", "excess"):
            getattr(self, part)
            yield

    @property
    def excess(self) -> float:
        """How far its hull reaches out of the solid, m."""
        return self._reach[0]

    @cached_property
    def _reach(self) -> tuple[float, Rays | None]:
        return excess(self.hull.planes, rays_of(self.triangles), self.triangles, self._tight)

    @property
    def _rays(self) -> Rays | None:
        return self._reach[1]

    def __lt__(self, other: Cell) -> bool:
        return (self.excess, len(self.triangles)) > (other.excess, len(other.triangles))

    @cached_property
    def mesh(self) -> tuple[FloatArray, IntArray, IntArray]:
        """Vertices (m, 3), triangles (k, 3) and edges (e, 2), each once."""
        vertices, which = distinct(self.triangles.reshape(-1, 3))
        faces = which.reshape(-1, 3)
        ends = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
        keys = np.unique(ends.min(1) * len(vertices) + ends.max(1))
        return vertices, faces, np.stack([keys // len(vertices), keys % len(vertices)], 1)

    @cached_property
    def hull(self) -> _Hull:
        return _Hull.of(_some(self.mesh[0]))

    def best(self) -> tuple[Place | None, int]:
        """Where the volume of the hulls falls most (None: no cut leaves something on both sides), and the cost of the
        search in points of hulls.

        Of cuts that do equally well (the first ones through a hollow box all do), the one along most surface; then the
        one across the longest extent. Of the best of them and the cuts through the middle, the one that leaves least
        volume times excess: it looks one step further.
        """
        cuts: list[_Cut] = []
        middles: list[_Cut] = []
        made = len(self.triangles) // 2
        for axis in range(3):
            extent = float(np.ptp(self.mesh[0][:, axis]))
            for i, (at, area) in enumerate(self._levels(axis)):
                sides = self._sides(axis, at)
                if all(len(side) for side in sides):
                    some = [_some(side) for side in sides]
                    made += len(some[0]) + len(some[1]) + 2 * OF_A_HULL
                    cut = _Cut((axis, at), (_Hull.of(some[0]), _Hull.of(some[1])), area, extent)
                    (middles if i == 0 else cuts).append(cut)
        whole = max(self.hull.volume, SMALLEST_VOLUME_M3)
        finalists = sorted(cuts, key=lambda cut: cut.rank(whole))[:FINALISTS] + middles
        best = min(finalists, key=lambda cut: (self._left(cut, whole), *cut.rank(whole)), default=None)
        if len(self.triangles) < FEW:
            made += OF_A_HALF * 2 * len(finalists)
        return (None if best is None else best.place), made

    def halves(self, place: Place, first: int) -> tuple[Cell, Cell]:
        """The cells below and above a plane, numbers `first` and the next."""
        below, above = clip(self.triangles, *place)
        return Cell(below, first, self._tight), Cell(above, first + 1, self._tight)

    def _left(self, cut: _Cut, whole: float) -> float:
        """Volume times excess that a cut leaves, of this cell's volume, to three digits; by rays of this cell, where
        there are many triangles."""
        if len(self.triangles) < FEW:
            excesses = [half._out() for half in self.halves(cut.place, 0)]
        else:
            excesses = self._excesses(cut)
        left = sum(hull.volume * out for hull, out in zip(cut.hulls, excesses, strict=True))
        return float(f"{left / whole:.3g}")

    def _excesses(self, cut: _Cut) -> list[float]:
        """How far the hulls on both sides reach out of the solid, as a mean: the longest ray through the hole of a ring
        is as long in one half of it. By rays along the axes: a slanted one leaves a slab by the cut that made it."""
        rays = self._along
        if rays is None:
            return [0.0, 0.0]
        axis, at = cut.place
        over = rays.origins[:, axis] > at
        return [
            float(np.sqrt(np.mean(rays.of(side).leave(hull.planes) ** 2))) if side.any() else 0.0
            for hull, side in zip(cut.hulls, (~over, over), strict=True)
        ]

    def _out(self) -> float:
        return 0.0 if self._along is None else float(self._along.leave(self.hull.planes).max(initial=0.0))

    @cached_property
    def _along(self) -> Rays | None:
        return None if self._rays is None else self._rays.of(np.abs(self._rays.directions).max(1) >= MOST_SLOPE)

    def _sides(self, axis: int, at: float) -> tuple[FloatArray, FloatArray]:
        """Corners of the triangles' parts below and above a plane, as `clip` has them."""
        vertices, faces, edges = self.mesh
        heights = vertices[:, axis] - at
        heights = np.where(np.abs(heights) <= SAME_M, 0.0, heights)
        of_faces = heights[faces]
        low, high = of_faces.min(1) < 0, of_faces.max(1) > 0
        flat = ~(low | high)
        up = flat.copy()
        if flat.any():
            i, j = (axis + 1) % 3, (axis + 2) % 3
            a, b, c = (vertices[faces[flat, k]] for k in range(3))
            e1, e2 = b - a, c - a
            up[flat] = e1[:, i] * e2[:, j] - e1[:, j] * e2[:, i] >= 0
        ends = heights[edges]
        crossing = ends[:, 0] * ends[:, 1] < 0
        of, to = vertices[edges[crossing, 0]], vertices[edges[crossing, 1]]
        share = ends[crossing, 0] / (ends[crossing, 0] - ends[crossing, 1])
        met = of + share[:, None] * (to - of)

        def side(chosen: BoolArray, there: BoolArray) -> FloatArray:
            mine = np.zeros(len(vertices), dtype=bool)
            mine[faces[chosen]] = True
            found: FloatArray = np.concatenate([vertices[mine & there], met])
            return found

        return side(low | (flat & up), heights <= 0), side(high | (flat & ~up), heights >= 0)

    def _levels(self, axis: int) -> list[tuple[float, float]]:
        """Places for a cut across an axis, each with the surface that lies in it (m²): the middle first, then levels
        with most surface in them, then levels of corners."""
        vertices, faces, _ = self.mesh
        along = vertices[:, axis]
        low, high = float(along.min()), float(along.max())
        margin = max(LEAST_SHARE * (high - low), SAME_M)
        middle = (low + high) / 2
        if not low + margin < middle < high - margin:
            return []
        found = [(middle, 0.0)]
        if len(faces) >= MANY:
            return found
        heights = along[faces]
        flat = np.ptp(heights, axis=1) <= SAME_M
        if flat.any():
            levels, first, which = np.unique(
                np.round(heights[flat, 0] / SAME_M), return_index=True, return_inverse=True
            )
            area = np.bincount(which, weights=doubled_area(self.triangles[flat]) / 2, minlength=len(levels))
            at = heights[flat, 0][first]
            inner = [int(i) for i in np.argsort(-area, kind="stable") if low + margin < at[i] < high - margin]
            found += [(float(at[i]), float(area[i])) for i in inner[:LEVELS] if area[i] > 0]
        if len(faces) < FEW:
            known = {at for at, _ in found}
            corners = np.unique(along)
            corners = corners[(corners > low + margin) & (corners < high - margin)]
            few = corners[np.linspace(0, len(corners) - 1, min(LEVELS, len(corners))).astype(int)]
            found += [(float(x), 0.0) for x in few if x not in known]
        return found


def _some(points: FloatArray) -> FloatArray:
    """Points (k, 3), or enough of them to compare hulls: the outermost ones, and some that are spread.

    They are picked in steps of the golden section, for a mesh is often a grid, and a regular step would pick a line.
    """
    if len(points) <= ENOUGH:
        return points
    outermost = np.argmax(points @ DIRECTIONS.T, axis=0)
    spread = (np.arange(ENOUGH) * GOLDEN % 1.0 * len(points)).astype(int)
    some: FloatArray = points[np.unique(np.concatenate([outermost, spread]))]
    return some
