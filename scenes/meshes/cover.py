"""A closed surface covered, by construction, with convex hulls: the union of the hulls contains every triangle.

The space around the mesh is cut by planes across the axes; each cell's hull is that of the triangles' parts inside the
cell, so whatever the cuts, every point of every triangle is in the hull of a cell (C7). A convex mesh is one hull, the
solid itself. Otherwise the cell whose hull reaches furthest out of the solid is cut where the volume of the hulls falls
most, until all are tight or there are enough pieces. Where pieces are enough and not tight, the cover is larger than the
solid: an arm may be kept out of a hollow that it could enter, never let through a wall.

What is enclosed and touched by no hull is not covered: `planner.containment` answers for it, from the same triangles.
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass

import numpy as np

from planner.arrays import FloatArray, IntArray
from planner.errors import FaultError
from planner.shapes import Hull, Piece
from scenes.meshes.clip import clip
from scenes.meshes.excess import doubled_area, excess
from scenes.meshes.hull import hull_of, volume_of_hull
from scenes.meshes.surface import SMALLEST_VOLUME_M3, Surface, volume_of

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
MANY = 3_000
"""From this many triangles on, only cuts through the middle are tried: the better cuts come in the smaller cells."""
LEAST_SHARE = 1e-3
"""A cut keeps this share of the cell's extent from its ends."""
SAME_SHARE = 1e-4
"""Cuts whose hulls differ by less than this share of the cell's hull do equally well."""
SAME_M = 1e-7
"""Levels closer than this are one, m: rounding in a file's float32."""


@dataclass(frozen=True, eq=False)
class Cover:
    """Convex pieces in the mesh's own frame, m; the surface, unless the one piece is the solid itself; and how far the
    pieces were found to reach out of the solid, m."""

    pieces: tuple[Piece, ...]
    surface: tuple[FloatArray, IntArray] | None
    excess_m: float


def cover(surface: Surface) -> Cover:
    """The cover of a surface. Deterministic."""
    whole = hull_of(surface.vertices)
    solid = volume_of(surface.corners)
    bulge = volume_of_hull(surface.vertices) - solid
    if bulge <= CONVEX_SHARE * solid:
        return Cover((Piece(whole),), None, 0.0)
    tight = max(TIGHT_M, TIGHT_SHARE * float(np.ptp(surface.vertices, axis=0).max()))
    cells = [_Cell(surface.corners, whole)]
    heapq.heapify(cells)
    done: list[_Cell] = []
    while cells and len(cells) + len(done) < MAX_PIECES:
        worst = heapq.heappop(cells)
        halves = _halves(worst.triangles) if worst.excess > tight else None
        if halves is None:
            done.append(worst)
        else:
            for part in halves:
                heapq.heappush(cells, _Cell(part, hull_of(part.reshape(-1, 3))))
    found = sorted(done + cells, key=lambda cell: tuple(cell.triangles.reshape(-1, 3).mean(0)))
    if not found:
        raise FaultError("a cover without pieces")
    worst_m = max(cell.excess for cell in found)
    return Cover(tuple(Piece(cell.hull) for cell in found), (surface.vertices, surface.faces), worst_m)


class _Cell:
    """Triangles of a cell and their hull, in order of how far that reaches out of the solid."""

    def __init__(self, triangles: FloatArray, hull: Hull) -> None:
        self.triangles, self.hull = triangles, hull
        self.excess = excess(hull, triangles) if len(triangles) < MANY else np.inf

    def __lt__(self, other: _Cell) -> bool:
        return (self.excess, len(self.triangles)) > (other.excess, len(other.triangles))


def _halves(triangles: FloatArray) -> tuple[FloatArray, FloatArray] | None:
    """The cell cut in two where the hulls' volumes fall most; None where no cut leaves something on both sides.

    Of cuts that do equally well (the first ones through a hollow box all do), the one along most surface; then the
    one across the longest extent.
    """
    whole = max(volume_of_hull(triangles.reshape(-1, 3)), SMALLEST_VOLUME_M3)
    best: tuple[tuple[int, float, float], tuple[FloatArray, FloatArray]] | None = None
    for axis in range(3):
        extent = float(np.ptp(triangles[:, :, axis]))
        for at, area in _cuts(triangles, axis):
            below, above = clip(triangles, axis, at)
            if not (len(below) and len(above)):
                continue
            volume = volume_of_hull(below.reshape(-1, 3)) + volume_of_hull(above.reshape(-1, 3))
            rank = (round(volume / whole / SAME_SHARE), -area, -extent)
            if best is None or rank < best[0]:
                best = (rank, (below, above))
    return None if best is None else best[1]


def _cuts(triangles: FloatArray, axis: int) -> list[tuple[float, float]]:
    """Places for a cut across an axis, each with the surface that lies in it (m²): the middle, levels with most
    surface in them, levels of corners."""
    heights = triangles[:, :, axis]
    low, high = float(heights.min()), float(heights.max())
    margin = max(LEAST_SHARE * (high - low), SAME_M)
    middle = (low + high) / 2
    if not low + margin < middle < high - margin:
        return []
    if len(triangles) >= MANY:
        return [(middle, 0.0)]
    across = np.where(np.ptp(heights, axis=1) < SAME_M, doubled_area(triangles) / 2, 0.0)
    levels, which = np.unique(np.round(heights[:, 0] / SAME_M), return_inverse=True)
    area = np.bincount(which, weights=across, minlength=len(levels))
    levels = levels * SAME_M
    inner = (levels > low + margin) & (levels < high - margin)
    flat = [int(i) for i in np.argsort(-area, kind="stable") if inner[i] and area[i] > 0][:LEVELS]
    corners = np.unique(np.round(heights / SAME_M)) * SAME_M
    corners = corners[(corners > low + margin) & (corners < high - margin)]
    few = corners[np.linspace(0, len(corners) - 1, min(LEVELS, len(corners))).astype(int)]
    return [(float(levels[i]), float(area[i])) for i in flat] + [(middle, 0.0)] + [(float(x), 0.0) for x in few]
