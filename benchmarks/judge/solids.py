"""Solids and how far they are apart, exactly, at many instants at a time.

Frames turn about the vertical alone. An upright box, an upright cylinder, a capsule along an axis and a sphere are a
flat core (a rectangle rounded by a radius) times an interval of heights, enlarged by a ball. Of two such products the
gap is that of the flat cores and that of the heights put together: their hypotenuse where both are apart, else the
larger of both, which is then minus the depth of the overlap; the balls are subtracted. A cylinder that lies, a tilted
body and a mesh are replaced by the box which holds them, and, where the box comes too near, by `coal`, a mesh triangle
by triangle: each of them is convex, so the depth of an overlap is known, too.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import coal
import numpy as np
import trimesh
from numpy.typing import NDArray

from benchmarks.judge.poses import Document, Floats, Poses, about, si

ASSETS = Path(__file__).resolve().parents[2] / "scenes" / "assets"
UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "in": 0.0254}


@dataclass(frozen=True, eq=False)
class Solid:
    """Half sizes of the flat core and of the heights, the radius that rounds the flat core, and the ball, m.

    `triangles` (K, 3, 3): of a mesh, whose box this is; `lying`: axis (0 or 1), radius and half length of a cylinder
    that lies; `tilted`: a solid and the rotation (3, 3) by which it is turned in the body's frame, in this box.
    `offset` (3,): where the middle of the core is in the body's frame.
    """

    half_x: float
    half_y: float
    half_z: float
    round_m: float = 0.0
    ball: float = 0.0
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    triangles: Floats | None = None
    lying: tuple[int, float, float] | None = None
    tilted: tuple[Solid, Floats] | None = None

    @property
    def exact(self) -> bool:
        """Whether the core with its ball is the solid itself."""
        return self.triangles is None and self.lying is None and self.tilted is None

    @property
    def radius(self) -> float:
        """Of the upright cylinder about the middle that holds it, m."""
        return float(np.hypot(self.half_x, self.half_y)) + self.round_m + self.ball

    @property
    def height(self) -> float:
        """Half of how high it is, m."""
        return self.half_z + self.ball


def solid_of(shape: Document) -> Solid:
    """The solid of a shape in a request or a robot's file. Raises `ValueError` for a kind that is not known."""
    ((kind, given),) = shape.items()
    axis = "xyz".index(given.get("axis", "z"))
    if kind == "box":
        x, y, z = si(given, "size") / 2.0
        return Solid(float(x), float(y), float(z))
    if kind == "sphere":
        return Solid(0.0, 0.0, 0.0, ball=float(si(given, "radius")))
    if kind == "capsule":
        half = [0.0, 0.0, 0.0]
        half[axis] = float(si(given, "length")) / 2.0
        return Solid(half[0], half[1], half[2], ball=float(si(given, "radius")))
    if kind == "cylinder":
        r, h = float(si(given, "radius")), float(si(given, "height")) / 2.0
        if axis == 2:
            return Solid(0.0, 0.0, h, round_m=r)
        return Solid(*((h, r, r) if axis == 0 else (r, h, r)), lying=(axis, r, h))
    if kind == "mesh" and "asset" in given:
        mesh: Any = trimesh.load_mesh(ASSETS / f"{given['asset']}.stl")
        return _of_triangles(np.asarray(mesh.triangles, dtype=np.float64) * UNITS[given["unit"]])
    raise ValueError(f"a shape that the judge does not know: {kind}")


def _of_triangles(triangles: Floats) -> Solid:
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    half, middle = (high - low) / 2.0, (high + low) / 2.0
    x, y, z = half.tolist()
    return Solid(x, y, z, offset=tuple(middle.tolist()), triangles=triangles)


def tilted(solid: Solid, pitch: float, roll: float) -> Solid:
    """The solid, upright so far, turned by the roll about x and then by the pitch about y of the body's frame."""
    turn = about(1, pitch) @ about(0, roll)
    if solid.triangles is not None:
        return _of_triangles(solid.triangles @ turn.T)
    if solid.lying is not None or solid.round_m:
        axis, r, h = (2, solid.round_m, solid.half_z) if solid.lying is None else solid.lying
        half = h * np.abs(turn[:, axis]) + r * np.sqrt(np.maximum(1.0 - turn[:, axis] ** 2, 0.0))
    else:
        half = np.abs(turn) @ np.array([solid.half_x, solid.half_y, solid.half_z]) + solid.ball
    x, y, z = half.tolist()
    return Solid(x, y, z, tilted=(solid, turn))


def apart_at_least(a: Solid, at: Poses, b: Solid, beside: Poses) -> Floats:
    """A lower bound (...) of the gap, by the upright cylinders that hold both."""
    return apart(a, middle(a, at), b, middle(b, beside))


def apart(a: Solid, one: Floats, b: Solid, other: Floats) -> Floats:
    """The same of solids whose middles are at `one` and `other` (..., 3)."""
    delta = other - one
    flat = np.hypot(delta[..., 0], delta[..., 1]) - a.radius - b.radius
    return np.asarray(np.maximum(flat, np.abs(delta[..., 2]) - a.height - b.height))


def gaps(a: Solid, at: Poses, b: Solid, beside: Poses, enough: float) -> Floats:
    """The gaps (N,) of two solids at poses (N,), m: positive apart, negative as deep as they overlap. Of meshes and
    lying cylinders a gap may be a lower bound where it is `enough`."""
    found = _core_gap(a, at, b, beside)
    if a.exact and b.exact:
        return found
    for i in np.flatnonzero(found < enough):
        found[i] = _by_coal(a, at[i], b, beside[i], enough)
    return found


def _by_coal(a: Solid, at: Poses, b: Solid, beside: Poses, enough: float) -> float:
    """The gap of two solids at single poses, m, or any lower bound of it that is `enough`. At most one of the solids is
    a mesh."""
    if a.triangles is not None and b.triangles is not None:
        raise ValueError("two meshes are not measured against each other")
    if b.triangles is not None:
        a, at, b, beside = b, beside, a, at
    other, there = shape_of(b), beside
    if a.triangles is None:
        return Gap(shape_of(a), other).at(at, there)
    world, at_b, half = at.points(a.triangles), middle(b, beside), [b.radius, b.radius, b.height]
    least = np.maximum(at_b - half - world.max(axis=1), world.min(axis=1) - at_b - half).max(axis=1)
    found = [Gap(_triangle(corners), other).at(UNMOVED, there) for corners in world[least < enough]]
    return float(min(found)) if found else float(least.min())


def _triangle(corners: Floats) -> Shape:
    """A triangle (3, 3) as a convex solid of no thickness."""
    points, sides = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    for corner in corners:
        points.append(corner)
    for order in ((0, 1, 2), (0, 2, 1)):
        sides.append(coal.Triangle(*order))
    return Shape(coal.Convex(points, sides), np.inf)


UNMOVED = Poses.of()


@dataclass(frozen=True, eq=False)
class Shape:
    """A solid as `coal` has it: `geometry`, which is at `inner` in the body's frame; `radius`: of a ball about `inner`
    that holds it, m; `mesh`: whether it is a surface, so that bodies inside it are not seen."""

    geometry: Any
    radius: float
    inner: Poses = UNMOVED
    mesh: bool = False


def shape_of(solid: Solid) -> Shape:
    """The shape of a solid."""
    if solid.triangles is not None:
        model = coal.BVHModelOBBRSS()
        model.beginModel(len(solid.triangles), 3 * len(solid.triangles))
        for a, b, c in solid.triangles:
            model.addTriangle(a, b, c)
        model.endModel()
        return Shape(model, float(np.linalg.norm(solid.triangles, axis=-1).max()), mesh=True)
    if solid.tilted is not None:
        upright = shape_of(solid.tilted[0])
        return replace(upright, inner=Poses(solid.tilted[1], np.zeros(3)).then(upright.inner))
    half = solid.half_x, solid.half_y, solid.half_z
    radius, axis = float(np.hypot(solid.radius, solid.height)), int(np.argmax(half))
    if solid.lying is not None:
        axis, r, length = solid.lying
        return Shape(coal.Cylinder(r, 2.0 * length), radius, LYING[axis])
    if solid.round_m:
        return Shape(coal.Cylinder(solid.round_m, 2.0 * solid.half_z), radius)
    if solid.ball:
        geometry = coal.Capsule(solid.ball, 2.0 * half[axis]) if any(half) else coal.Sphere(solid.ball)
        return Shape(geometry, radius, LYING[axis])
    return Shape(coal.Box(*(2.0 * each for each in half)), radius)


LYING = (Poses.turned(1, np.pi / 2.0), Poses.turned(0, -np.pi / 2.0), UNMOVED)
"""By which turns what lies along z is turned to lie along x, y or z."""


class Gap:
    """The distance of two shapes, m: less than 0 where convex ones overlap, by the least way that would part them; 0
    where a surface is crossed."""

    def __init__(self, first: Shape, second: Shape) -> None:
        self._one, self._other = first, second
        self._distance = coal.ComputeDistance(first.geometry, second.geometry)
        self._request, self._result = coal.DistanceRequest(), coal.DistanceResult()
        self._request.enable_signed_distance = not (first.mesh or second.mesh)

    def at(self, a: Poses, b: Poses) -> float:
        """With both bodies at single places, as `among`."""
        return float(self.among(a[None], b[None], np.zeros(1, dtype=int))[0])

    def among(self, a: Poses, b: Poses, at: NDArray[np.int_]) -> Floats:
        """At some (K,) of N places of both bodies, (K,) m. Raises `ValueError` where these are not finite: `coal` would
        be silent."""
        one, other = a[at].then(self._one.inner), b[at].then(self._other.inner)
        if not (np.isfinite(one.p).all() and np.isfinite(other.p).all()):
            raise ValueError("a place that is not finite")
        found, place = np.empty(len(at)), coal.Transform3s
        for k in range(len(at)):
            self._result.clear()
            first, second = place(one.r[k], one.p[k]), place(other.r[k], other.p[k])
            found[k] = self._distance(first, second, self._request, self._result)
        return found


def middle(solid: Solid, at: Poses) -> Floats:
    """Where the middle of the core is (..., 3), with the solid at poses (...)."""
    return at.points(solid.offset) if any(solid.offset) else at.p


def _core_gap(a: Solid, at: Poses, b: Solid, beside: Poses) -> Floats:
    delta = middle(b, beside) - middle(a, at)
    c, s = at.r[..., 0, 0], at.r[..., 1, 0]
    # the middle of b in the axes of a, and the other way round
    x, y = c * delta[..., 0] + s * delta[..., 1], c * delta[..., 1] - s * delta[..., 0]
    flat = _rectangles(a.half_x, a.half_y, b.half_x, b.half_y, x, y, beside.yaw - at.yaw) - a.round_m - b.round_m
    high = np.abs(delta[..., 2]) - a.half_z - b.half_z
    both = np.hypot(np.maximum(flat, 0.0), np.maximum(high, 0.0))
    return np.asarray(np.where(both > 0.0, both, np.maximum(flat, high)) - a.ball - b.ball)


def _point(x: Floats, y: Floats, half_x: float, half_y: float) -> Floats:
    """Signed distance of points from a rectangle about the origin."""
    dx, dy = np.abs(x) - half_x, np.abs(y) - half_y
    outside = np.hypot(np.maximum(dx, 0.0), np.maximum(dy, 0.0))
    return np.asarray(np.where(outside > 0.0, outside, np.maximum(dx, dy)))


def _rectangles(ax: float, ay: float, bx: float, by: float, x: Floats, y: Floats, turn: Floats) -> Floats:
    """Signed distance of a rectangle about the origin from one whose middle is at x, y and which is turned."""
    if bx == by == 0.0:
        return _point(x, y, ax, ay)
    c, s = np.cos(turn), np.sin(turn)
    # the origin as the second rectangle sees it
    u, v = -(c * x + s * y), s * x - c * y
    if ax == ay == 0.0:
        return _point(u, v, bx, by)
    ac, as_ = np.abs(c), np.abs(s)
    overlap = np.maximum(np.abs(x) - ax - bx * ac - by * as_, np.abs(y) - ay - bx * as_ - by * ac)
    overlap = np.maximum(overlap, np.abs(u) - bx - ax * ac - ay * as_)
    overlap = np.maximum(overlap, np.abs(v) - by - ax * as_ - ay * ac)
    distance = np.full(np.shape(overlap), np.inf)
    for i in (-1.0, 1.0):
        for j in (-1.0, 1.0):
            corner = _point(x + i * bx * c - j * by * s, y + i * bx * s + j * by * c, ax, ay)
            distance = np.minimum(distance, corner)
            distance = np.minimum(distance, _point(u + i * ax * c + j * ay * s, v - i * ax * s + j * ay * c, bx, by))
    return np.asarray(np.where(overlap > 0.0, distance, overlap))
