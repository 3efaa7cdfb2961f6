"""Few convex hulls that contain a whole solid, what its surface encloses included: how an arm's links are brought in.

`assur.scenes.meshes.cover` covers a surface tightly, with up to 64 hulls, and leaves what is enclosed to the winding
number. A link of an arm needs fewer hulls, and none that is hollow. Space is cut into cells as there; a cell's hull
is that of the triangles' parts in it and of those corners of the cell that are enclosed (M2 of docs/meshes.md). Where
the cuts are is judged with fewer triangles; what is covered is every triangle of the mesh.
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import KDTree

from assur.planner.arrays import FloatArray
from assur.planner.geometry.containment import winding_number
from assur.planner.geometry.shapes import Hull
from assur.scenes.meshes.clip import SAME_M, clip
from assur.scenes.meshes.cover import convex_groups
from assur.scenes.meshes.excess import doubled_area
from assur.scenes.meshes.hull import hull_of, rough_hull, simpler, volume_of_hull
from assur.scenes.meshes.surface import Surface

SHARES = (0.5, 0.25, 0.75)
"""Places of the cuts that are tried, as shares of a cell's extent."""
MOST_LEVELS = 2
"""Levels with much surface that are tried as well, along each axis."""
MANY = 2_000
"""From this many triangles on fewer are judged."""
GRID_SHARE = 0.25
"""Cells of the grid in which vertices become one, where it is judged, as a share of the tolerance."""
INWARDS = 1e-6
"""Share of the way from a corner of a cell to its middle: the point that is evaluated for the corner."""
SURELY = 0.95
"""Winding number above which a corner is enclosed, and not on the surface."""
SPOTS = 4_000
"""Points on a hull, or on the triangles of a cell, by which it is judged, at most."""
SIMPLER_SHARE = 0.2
"""Share of the tolerance by which a hull may grow to have fewer corners."""


@dataclass(frozen=True, eq=False)
class SolidCover:
    """Hulls (m) that contain a solid, and how far points of them are from it at most, as it was found, m."""

    hulls: tuple[Hull, ...]
    excess_m: float


def solid_cover(surface: Surface, further: FloatArray, tight_m: float, most: int) -> SolidCover:
    """Up to `most` hulls that contain every point of the surface, every point that it encloses, and the triangles
    `further` (k, 3, 3), m. Deterministic.

    No point of the hulls is further than `tight_m` from the solid, as far as samples show, if `most` are enough.
    """
    triangles = np.concatenate([surface.corners, further])
    judge = _Judge(surface, triangles, tight_m)
    ends = surface.vertices.min(0), surface.vertices.max(0)
    root = _Cell(_Box(*ends), judge.coarse, judge)
    cells = [root]
    done: list[_Cell] = []
    while cells and len(cells) + len(done) < most:
        worst = heapq.heappop(cells)
        if worst.excess > tight_m and worst.cut():
            for half in worst.halves:
                heapq.heappush(cells, half)
        else:
            done.append(worst)
    points = [some for some in root.parted(triangles, judge) if len(some)]
    hulls = [hull_of(some) for some in points]
    joined = [
        hulls[group[0]] if len(group) == 1 else hull_of(np.concatenate([points[i] for i in group]))
        for group in convex_groups(hulls)
    ]
    found = [simpler(hull, SIMPLER_SHARE * tight_m) for hull in joined]
    return SolidCover(tuple(hull for hull, _ in found), max(judge.excess(hull) for hull, _ in found))


@dataclass(frozen=True, eq=False)
class _Box:
    low: FloatArray
    high: FloatArray

    def halves(self, axis: int, at: float) -> tuple[_Box, _Box]:
        high, low = self.high.copy(), self.low.copy()
        high[axis] = low[axis] = at
        return _Box(self.low, high), _Box(low, self.high)


class _Judge:
    """The solid, by which hulls are judged."""

    def __init__(self, surface: Surface, triangles: FloatArray, tight: float) -> None:
        self.surface = surface.vertices, surface.faces
        self.tight = tight
        self.coarse = _coarse(triangles, GRID_SHARE * tight) if len(triangles) > MANY else triangles
        self.spots, self.normals = _samples(triangles, 16 * SPOTS)
        self.tree = KDTree(self.spots)
        self._known: dict[bytes, FloatArray] = {}

    def excess(self, hull: Hull) -> float:
        """How far points of a hull's surface are from the solid at most, by samples, m. Behind the nearest triangle a
        point counts as inside."""
        spots = _samples(hull.vertices[hull.faces], SPOTS)[0]
        far, nearest = self.tree.query(spots, k=3)
        ways = spots[:, None] - self.spots[nearest]
        before = np.einsum("skx,skx->s", ways, self.normals[nearest]) > 0.0
        return float(far[before, 0].max()) if before.any() else 0.0

    def corners_inside(self, box: _Box) -> FloatArray:
        """Corners (k, 3) of a box that are enclosed, and those on the surface near which the box is.

        A corner on the surface is a point of the triangles in the box, unless these touch the box there only and it is
        enclosed inwards from the corner.
        """
        x, y, z = np.stack([box.low, box.high], axis=1)
        every = np.array([[a, b, c] for a in x for b in y for c in z])
        key = every.tobytes()
        if key not in self._known:
            inwards = every + INWARDS * ((box.low + box.high) / 2 - every)
            round_, round_inwards = np.abs(winding_number(self.surface, np.concatenate([every, inwards]))).reshape(2, 8)
            self._known[key] = every[(round_ > SURELY) | (round_inwards > 0.5)]
        return self._known[key]


class _Cell:
    """A cell, with the coarse triangles in it; those that reach furthest out of the solid come first."""

    def __init__(self, box: _Box, coarse: FloatArray, judge: _Judge) -> None:
        self.box, self.coarse, self.judge = box, coarse, judge
        self.halves: tuple[_Cell, ...] = ()
        self.place = (0, 0.0)

    @cached_property
    def excess(self) -> float:
        return self.judge.excess(rough_hull(self._points()))

    def __lt__(self, other: _Cell) -> bool:
        return (self.excess, len(self.coarse), *self.box.low) > (other.excess, len(other.coarse), *other.box.low)

    def _points(self) -> FloatArray:
        return np.concatenate([self.coarse.reshape(-1, 3), self.judge.corners_inside(self.box)])

    def cut(self) -> bool:
        """Cuts the cell where the volume of the hulls falls most; False where nothing is gained."""
        best: tuple[float, tuple[int, float], tuple[FloatArray, FloatArray]] | None = None
        for axis in range(3):
            low, high = self.coarse[:, :, axis].min(), self.coarse[:, :, axis].max()
            if not high - low > self.judge.tight:
                continue
            for at in (*(float(low + share * (high - low)) for share in SHARES), *_levels(self.coarse, axis)):
                parts = clip(self.coarse, axis, at)
                if not (len(parts[0]) and len(parts[1])):
                    continue
                volume = sum(volume_of_hull(part.reshape(-1, 3)) for part in parts)
                if best is None or volume < best[0]:
                    best = volume, (axis, at), parts
        if best is None:
            return False
        _, self.place, parts = best
        boxes = self.box.halves(*self.place)
        self.halves = tuple(_Cell(box, part, self.judge) for box, part in zip(boxes, parts, strict=True))
        return True

    def parted(self, triangles: FloatArray, judge: _Judge) -> list[FloatArray]:
        """The points (k, 3) of the hull of each cell below this one: cut triangles (k, 3, 3), and enclosed corners."""
        if not self.halves:
            return [np.concatenate([triangles.reshape(-1, 3), judge.corners_inside(self.box)])]
        parts = clip(triangles, *self.place)
        return [found for half, part in zip(self.halves, parts, strict=True) for found in half.parted(part, judge)]


def _levels(triangles: FloatArray, axis: int) -> list[float]:
    """Where most of the surface is square to an axis, but for the ends."""
    heights = triangles[:, :, axis]
    square = np.ptp(heights, axis=1) <= SAME_M
    at, which = np.unique(heights[square, 0], return_inverse=True)
    area = np.bincount(which, weights=doubled_area(triangles[square]), minlength=len(at))
    inner = np.flatnonzero((at > heights.min() + SAME_M) & (at < heights.max() - SAME_M))
    return [float(at[i]) for i in inner[np.argsort(-area[inner], kind="stable")][:MOST_LEVELS]]


def _coarse(triangles: FloatArray, grid: float) -> FloatArray:
    """Triangles with one vertex, the first, in place of all in a cell of a grid; each once, and none that is flat."""
    vertices, which = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    _, first, cell = np.unique(np.floor(vertices / grid), axis=0, return_index=True, return_inverse=True)
    faces = cell[which].reshape(-1, 3)
    solid = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    faces = faces[solid]
    _, once = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)
    found: FloatArray = vertices[first][faces[np.sort(once)]]
    return found if len(found) else triangles


def _samples(triangles: FloatArray, most: int) -> tuple[FloatArray, FloatArray]:
    """Points (k, 3) spread evenly over triangles (f, 3, 3): all corners, and more the larger a triangle is; and the
    normal of each one's triangle, of any length."""
    e1, e2 = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    normals = np.cross(e1, e2)
    area = np.sqrt((normals * normals).sum(1))
    normals /= np.maximum(area, 1e-30)[:, None]
    count = np.floor(most * area / max(float(area.sum()), 1e-30)).astype(int)
    which = np.repeat(np.arange(len(triangles)), count)
    turn = np.arange(len(which))
    # a sequence that fills the unit square evenly (Roberts), folded into the triangle
    u, v = (0.5 + 0.7548776662466927 * turn) % 1.0, (0.5 + 0.5698402909980532 * turn) % 1.0
    over = u + v > 1.0
    u, v = np.where(over, 1.0 - u, u), np.where(over, 1.0 - v, v)
    spread = triangles[which, 0] + u[:, None] * e1[which] + v[:, None] * e2[which]
    spots: FloatArray = np.concatenate([triangles.reshape(-1, 3), spread])
    return spots, np.concatenate([np.repeat(normals, 3, axis=0), normals[which]])
