"""A closed surface covered, by construction, with convex hulls: the union of the hulls contains every triangle.

The space around the mesh is cut by planes across the axes; each cell's hull is that of the triangles' parts inside the
cell, so whatever the cuts, every point of every triangle is in the hull of a cell (M1). A convex mesh is one hull, the
solid itself. Otherwise the cell whose hull reaches furthest out of the solid is cut where the volume of the hulls falls
most, until all are tight or there are enough pieces. Where they are enough and not tight, the cover is larger than the
solid: an arm may be kept out of a hollow that it could enter, never let through a wall.

What is enclosed and touched by no hull is not covered: `assur.planner.geometry.containment` answers for it, from the
same triangles.
"""

from __future__ import annotations

import heapq
import math
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.geometry.shapes import Piece
from assur.scenes.meshes.clip import SAME_M, clip
from assur.scenes.meshes.excess import doubled_area, excess
from assur.scenes.meshes.hull import hull_of, rough_hull, volume_of_hull
from assur.scenes.meshes.merge import convex_groups
from assur.scenes.meshes.surface import SMALLEST_VOLUME_M3, Surface, volume_of

MAX_PIECES = 64
"""Hulls of one cover; more would cost the planner more than they show it."""
TIGHT_SHARE = 0.01
"""A hull is tight if it reaches out of the solid by no more than this share of the mesh's largest extent,"""
TIGHT_M = 2e-4
"""or by no more than this, m."""
CONVEX_SHARE = 1e-6
"""Share of the hull's volume by which a convex mesh's own may fall short, from rounding in the file (float32)."""
LEVELS = 5
"""Cuts that are tried along each axis, besides through the middle."""
MANY = 600
"""From this many triangles on, only cuts through the middle are tried: the better cuts come in the smaller cells."""
ENOUGH = 400
"""Triangles from whose corners the volume of a hull is estimated, to compare cuts."""
DIRECTIONS = np.array([[x, y, z] for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if x or y or z])
"""Directions in which the outermost corners are always among them."""
GOLDEN = (math.sqrt(5) - 1) / 2
LEAST_SHARE = 1e-3
"""A cut keeps this share of the cell's extent from its ends."""
FINALISTS = 3
"""Cuts, besides those through the middle, whose parts are judged."""
SAME_SHARE = 1e-4
"""Cuts whose hulls differ by less than this share of the cell's hull do equally well."""


@dataclass(frozen=True, eq=False)
class Cover:
    """Convex pieces in the mesh's own frame, m; the surface, unless the one piece is the solid itself; and how far the
    pieces were found to reach out of the solid, m."""

    pieces: tuple[Piece, ...]
    surface: tuple[FloatArray, IntArray] | None
    excess_m: float


def cover(surface: Surface) -> Cover:
    """The cover of a surface. Deterministic."""
    solid = volume_of(surface.corners)
    if volume_of_hull(surface.vertices) - solid <= CONVEX_SHARE * solid:
        return Cover((Piece(hull_of(surface.vertices)),), None, 0.0)
    tight = max(TIGHT_M, TIGHT_SHARE * float(np.ptp(surface.vertices, axis=0).max()))
    cells = [_Cell(surface.corners)]
    done: list[_Cell] = []
    while cells and len(cells) + len(done) < MAX_PIECES:
        worst = heapq.heappop(cells)
        halves = _halves(worst.triangles) if worst.excess > tight else None
        if halves is None:
            done.append(worst)
        else:
            for half in halves:
                heapq.heappush(cells, half)
    found = sorted(done + cells, key=lambda cell: tuple(cell.triangles.reshape(-1, 3).mean(0)))
    worst_m = max(cell.excess for cell in found)
    points = [cell.triangles.reshape(-1, 3) for cell in found]
    hulls = [hull_of(some) for some in points]
    groups = convex_groups(hulls)
    # A group's hull is made of the points themselves, so that rounding does not add up from hull to hull.
    joined = (hulls[g[0]] if len(g) == 1 else hull_of(np.concatenate([points[i] for i in g])) for g in groups)
    return Cover(tuple(Piece(hull) for hull in joined), (surface.vertices, surface.faces), worst_m)


class _Cell:
    """Triangles of a cell, in order of how far their hull reaches out of the solid."""

    def __init__(self, triangles: FloatArray) -> None:
        self.triangles = triangles
        self.excess = excess(rough_hull(_some(triangles)), triangles)

    def __lt__(self, other: _Cell) -> bool:
        return (self.excess, len(self.triangles)) > (other.excess, len(other.triangles))


@dataclass(frozen=True, slots=True)
class _Cut:
    """A cell cut in two: the hulls' volumes (m³), the surface in the cut (m²), the cell's extent across it (m)."""

    parts: tuple[FloatArray, FloatArray]
    volumes: tuple[float, float]
    area: float
    extent: float

    def rank(self, whole: float) -> tuple[int, float, float]:
        return round(sum(self.volumes) / whole / SAME_SHARE), -self.area, -self.extent


def _halves(triangles: FloatArray) -> tuple[_Cell, _Cell] | None:
    """The cell cut in two where the hulls' volumes fall most; None where no cut leaves something on both sides.

    Of cuts that do equally well (the first ones through a hollow box all do), the one along most surface; then the
    one across the longest extent. Of the best of them and the cuts through the middle, the one that leaves least
    volume times excess: it looks one step further.
    """
    cuts: list[_Cut] = []
    middles: list[_Cut] = []
    for axis in range(3):
        extent = float(np.ptp(triangles[:, :, axis]))
        for i, (at, area) in enumerate(_levels(triangles, axis)):
            parts = clip(triangles, axis, at)
            if len(parts[0]) and len(parts[1]):
                volumes = (volume_of_hull(_some(parts[0])), volume_of_hull(_some(parts[1])))
                (middles if i == 0 else cuts).append(_Cut(parts, volumes, area, extent))
    whole = max(volume_of_hull(_some(triangles)), SMALLEST_VOLUME_M3)
    cuts = sorted(cuts, key=lambda cut: cut.rank(whole))[:FINALISTS] + middles
    best: tuple[tuple[float, ...], tuple[_Cell, _Cell]] | None = None
    for cut in cuts:
        cells = (_Cell(cut.parts[0]), _Cell(cut.parts[1]))
        left = sum(volume * cell.excess for volume, cell in zip(cut.volumes, cells, strict=True))
        rank = (float(f"{left / whole:.3g}"), *cut.rank(whole))
        if best is None or rank < best[0]:
            best = (rank, cells)
    return None if best is None else best[1]


def _some(triangles: FloatArray) -> FloatArray:
    """Corners of the triangles, or enough of them to compare hulls: the outermost ones, and some that are spread.

    They are picked in steps of the golden section, for a mesh is often a grid, and a regular step would pick a line.
    """
    if len(triangles) <= ENOUGH:
        return triangles.reshape(-1, 3)
    points = triangles[:, 0]
    outermost = np.argmax(points @ DIRECTIONS.T, axis=0)
    spread = (np.arange(ENOUGH) * GOLDEN % 1.0 * len(points)).astype(int)
    some: FloatArray = points[np.concatenate([outermost, spread])]
    return some


def _levels(triangles: FloatArray, axis: int) -> list[tuple[float, float]]:
    """Places for a cut across an axis, each with the surface that lies in it (m²): the middle first, then levels with
    most surface in them, then levels of corners."""
    heights = triangles[:, :, axis]
    low, high = float(heights.min()), float(heights.max())
    margin = max(LEAST_SHARE * (high - low), SAME_M)
    middle = (low + high) / 2
    if not low + margin < middle < high - margin:
        return []
    if len(triangles) >= MANY:
        return [(middle, 0.0)]
    across = np.where(np.ptp(heights, axis=1) <= SAME_M, doubled_area(triangles) / 2, 0.0)
    levels, first, which = np.unique(np.round(heights[:, 0] / SAME_M), return_index=True, return_inverse=True)
    area = np.bincount(which, weights=across, minlength=len(levels))
    at = heights[first, 0]
    flat = [int(i) for i in np.argsort(-area, kind="stable") if low + margin < at[i] < high - margin and area[i] > 0]
    corners = np.unique(heights)
    corners = corners[(corners > low + margin) & (corners < high - margin)]
    few = corners[np.linspace(0, len(corners) - 1, min(LEVELS, len(corners))).astype(int)]
    return [(middle, 0.0)] + [(float(at[i]), float(area[i])) for i in flat[:LEVELS]] + [(float(x), 0.0) for x in few]
