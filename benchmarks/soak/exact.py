"""The gap of two solids at one instant, of which one is a mesh or a cylinder that lies.

A mesh is its triangles. Along any unit vector n the gap of two convex solids is at least the support gap, so a vector
along which it is `enough` settles a pair. The vectors that are tried first are those among which the best one is, for
polytopes that overlap; then the Gilbert-Johnson-Keerthi algorithm finds the distance of what is apart, and a descent
from the best vectors the depth of what is not.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from benchmarks.soak.poses import Floats, turned

ROUNDS = 60
"""Of the search for the shortest way between two convex solids; about ten are usual."""
CONVERGED_M = 1e-9
SPREAD = 400
"""Directions, evenly over the sphere, from which the depth of an overlap is looked for beside those of the solids."""


@dataclass(frozen=True, eq=False)
class Placed:
    """A solid at one pose: position (3,), yaw, and what `solids.Solid` says of it."""

    p: Floats
    yaw: float
    offset: Floats
    half: Floats
    round_m: float
    ball: float
    triangles: Floats | None
    lying: tuple[int, float, float] | None

    def axes(self) -> Floats:
        """Its axes (3, 3) in the world, one a row."""
        return turned(np.full(3, self.yaw), np.eye(3))

    def middle(self) -> Floats:
        return np.asarray(self.p + turned(np.array(self.yaw), self.offset))

    def support(self, n: Floats, triangle: Floats | None = None) -> tuple[Floats, Floats]:
        """How far it reaches along vectors n (K, 3), (K,) m, and points (K, 3) that do; of a mesh one `triangle` (3, 3)
        in the world."""
        if triangle is not None:
            reach = n @ triangle.T
            best = np.argmax(reach, axis=1)
            return reach[np.arange(len(n)), best], triangle[best]
        axes = self.axes()
        local = n @ axes.T
        size = np.linalg.norm(n, axis=1)
        if self.lying is not None:
            axis, radius, half = self.lying
            point = local.copy()
            point[:, axis] = 0.0
            length = np.linalg.norm(point, axis=1)
            point *= (radius / np.where(length > 0.0, length, 1.0))[:, None]
            point[:, axis] = np.where(local[:, axis] >= 0.0, half, -half)
        else:
            point = np.where(local >= 0.0, self.half, -self.half)
            flat = np.hypot(local[:, 0], local[:, 1])
            point[:, :2] += local[:, :2] * (self.round_m / np.where(flat > 0.0, flat, 1.0))[:, None]
        world = self.middle() + point @ axes + n * (self.ball / np.where(size > 0.0, size, 1.0))[:, None]
        return np.einsum("ij,ij->i", world, n), world


def nearest_gap(a: Placed, b: Placed, enough: float) -> float:
    """The gap of two solids, of which one at most is a mesh, m; any lower bound of it that is `enough`."""
    if a.triangles is not None and b.triangles is not None:
        raise ValueError("two meshes: the simulation does not look at them against each other")
    if b.triangles is not None:
        a, b = b, a
    if a.triangles is None:
        return _gap(a, b, None, enough)
    world = a.p + turned(np.full(a.triangles.shape[:2], a.yaw), a.triangles)
    least = np.inf
    low, high = b.middle() - _bounds(b), b.middle() + _bounds(b)
    apart = np.maximum(low - world.max(axis=1), world.min(axis=1) - high).max(axis=1)
    for triangle in world[apart < enough]:
        least = min(least, _gap(a, b, triangle, enough))
    return float(min(least, apart[apart >= enough].min(initial=np.inf)))


def _bounds(solid: Placed) -> Floats:
    """Half sizes (3,) of the box in the axes of the world that holds a solid, m."""
    return solid.support(np.eye(3))[0] - solid.middle()


def _gap(a: Placed, b: Placed, triangle: Floats | None, enough: float) -> float:
    tried = _directions(a, b, triangle)
    found = _support_gaps(a, b, triangle, tried)
    if found.max() >= enough:
        return float(found.max())
    distance = _distance(a, b, triangle)
    if distance > CONVERGED_M:
        return distance
    more = _sphere(SPREAD)
    tried = np.concatenate([tried, more])
    found = np.concatenate([found, _support_gaps(a, b, triangle, more)])
    best = float(found.max())
    for k in np.argsort(-found)[:4]:
        best = max(best, _climbed(a, b, triangle, tried[k], float(found[k])))
        if best >= enough:
            break
    return min(best, 0.0)


def _support_gaps(a: Placed, b: Placed, triangle: Floats | None, n: Floats) -> Floats:
    return -a.support(n, triangle)[0] - b.support(-n)[0]


def _directions(a: Placed, b: Placed, triangle: Floats | None) -> Floats:
    """Unit vectors (K, 3) from a to b, both signs: axes, faces, crossed edges, and from points of a to the middle."""
    axes = [*b.axes()]
    middle = b.middle()
    if triangle is None:
        edges, points = [*a.axes()], [a.middle()]
        axes += edges
    else:
        edges = [triangle[1] - triangle[0], triangle[2] - triangle[1], triangle[0] - triangle[2]]
        points = [*triangle]
        axes.append(np.cross(edges[0], edges[1]))
    axes += [np.cross(edge, axis) for edge in edges for axis in b.axes()]
    for point in points:
        way = middle - point
        axes += [way, way * (1.0, 1.0, 0.0)]
    found = np.array(axes)
    length = np.linalg.norm(found, axis=1)
    found = found[length > 1e-12] / length[length > 1e-12, None]
    return np.concatenate([found, -found])


def _distance(a: Placed, b: Placed, triangle: Floats | None) -> float:
    """The distance of two convex solids, 0 where they overlap (Gilbert, Johnson, Keerthi 1988)."""
    n = np.array([[1.0, 0.0, 0.0]])
    simplex: list[Floats] = []
    nearest = np.full(3, np.inf)
    for _ in range(ROUNDS):
        corner = (a.support(n, triangle)[1] - b.support(-n)[1])[0]
        if simplex and float(nearest @ nearest - nearest @ corner) <= CONVERGED_M * float(np.linalg.norm(nearest)):
            break
        simplex.append(corner)
        nearest, simplex = _nearest_point(simplex)
        if float(nearest @ nearest) <= CONVERGED_M**2 or len(simplex) == 4:
            return 0.0
        n = -nearest[None, :]
    return float(np.linalg.norm(nearest))


def _nearest_point(simplex: list[Floats]) -> tuple[Floats, list[Floats]]:
    """The point of a simplex that is nearest to the origin, and the corners of the face on which it is."""
    best, kept = np.full(3, np.inf), simplex
    for count in range(1, len(simplex) + 1):
        for chosen in combinations(simplex, count):
            corners = np.array(chosen)
            edges = corners[1:] - corners[0]
            weights = np.linalg.lstsq(edges.T, -corners[0], rcond=None)[0] if count > 1 else np.zeros(0)
            if (weights < -1e-12).any() or weights.sum() > 1.0 + 1e-12:
                continue
            point = corners[0] + weights @ edges
            if point @ point < best @ best - 1e-24:
                best, kept = point, list(chosen)
    return best, kept


def _climbed(a: Placed, b: Placed, triangle: Floats | None, n: Floats, gap: float) -> float:
    """The largest support gap near a direction, by steps that are halved where they do not help."""
    step = 0.3
    while step > 1e-5:
        side = np.cross(n, np.eye(3)[int(np.argmin(np.abs(n)))])
        side /= np.linalg.norm(side)
        up = np.cross(n, side)
        angles = np.arange(8) * np.pi / 4.0
        tried = n + step * (np.cos(angles)[:, None] * side + np.sin(angles)[:, None] * up)
        tried /= np.linalg.norm(tried, axis=1)[:, None]
        found = _support_gaps(a, b, triangle, tried)
        if found.max() > gap:
            n, gap = tried[int(found.argmax())], float(found.max())
        else:
            step /= 2.0
    return gap


def _sphere(count: int) -> Floats:
    """Unit vectors (count, 3), evenly over the sphere (Fibonacci's lattice)."""
    k = np.arange(count) + 0.5
    z, angle = 1.0 - 2.0 * k / count, np.pi * (1.0 + 5.0**0.5) * k
    r = np.sqrt(1.0 - z * z)
    return np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=-1)
