"""Another way to the distance of two convex solids: least squares over points of both, by SLSQP. No support functions.

A solid is a core (a box, a disc times a segment, a point, a segment, or mixtures of vertices) grown by a ball. What is
found is the distance of two points that belong to the solids, so it is never below the true distance.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from hypothesis import strategies as st
from scipy.optimize import minimize

from assur.planner.arrays import FloatArray
from assur.planner.geometry.shapes import Hull, Piece, Primitive, box, capsule, cylinder, radius, sphere
from tests.planner.cells import block, rotation

KINDS = ("box", "sphere", "cylinder", "capsule", "hull")


@dataclass
class _Core:
    """Points x = centre + axes (base + jacobian u) with bounds and constraints on u."""

    piece: Piece
    size: int
    bounds: list[tuple[float, float]]

    def point(self, u: FloatArray) -> FloatArray:
        shape = self.piece.shape
        if isinstance(shape, Hull):
            local = shape.vertices.T @ u
        elif shape.kind == "cylinder":
            local = np.array([shape.disc * u[0], shape.disc * u[1], shape.half[2] * u[2]])
        else:
            local = np.array(shape.half) * u
        return self.piece.position + self.piece.rotation @ local

    def jacobian(self) -> FloatArray:
        shape = self.piece.shape
        if isinstance(shape, Hull):
            return self.piece.rotation @ shape.vertices.T
        scale = (shape.disc, shape.disc, shape.half[2]) if shape.kind == "cylinder" else shape.half
        return self.piece.rotation @ np.diag(scale)


def _core(piece: Piece) -> _Core:
    if isinstance(piece.shape, Hull):
        return _Core(piece, len(piece.shape.vertices), [(0.0, 1.0)] * len(piece.shape.vertices))
    return _Core(piece, 3, [(-1.0, 1.0)] * 3)


def _ball(piece: Piece) -> float:
    return piece.shape.ball if isinstance(piece.shape, Primitive) else 0.0


def distance(a: Piece, b: Piece) -> float:
    """Distance of the solids, m, from above; 0 or less where their cores are nearer than their balls."""
    cores = _core(a), _core(b)
    k = cores[0].size
    ja, jb = cores[0].jacobian(), cores[1].jacobian()
    both = np.concatenate([ja, -jb], axis=1)
    base = a.position - b.position

    def cost(u: FloatArray) -> float:
        d = base + both @ u
        return float(d @ d)

    def slope(u: FloatArray) -> FloatArray:
        found: FloatArray = 2 * both.T @ (base + both @ u)
        return found

    constraints: list[dict[str, Any]] = []
    start = np.zeros(k + cores[1].size)
    for core, first in ((cores[0], 0), (cores[1], k)):
        shape, part = core.piece.shape, slice(first, first + core.size)
        if isinstance(shape, Hull):
            start[part] = 1.0 / core.size
            grad = np.zeros(len(start))
            grad[part] = 1.0
            constraints.append({"type": "eq", "fun": lambda u, p=part: u[p].sum() - 1.0, "jac": lambda _, g=grad: g})
        elif shape.kind == "cylinder":

            def rim(u: FloatArray, i: int = first) -> float:
                return float(1.0 - u[i] ** 2 - u[i + 1] ** 2)

            def rim_slope(u: FloatArray, i: int = first, n: int = len(start)) -> FloatArray:
                g = np.zeros(n)
                g[i], g[i + 1] = -2 * u[i], -2 * u[i + 1]
                return g

            constraints.append({"type": "ineq", "fun": rim, "jac": rim_slope})
    scale = max(1e-6, cost(start))
    found = minimize(
        lambda u: cost(u) / scale,
        start,
        jac=lambda u: slope(u) / scale,
        bounds=[*cores[0].bounds, *cores[1].bounds],
        constraints=constraints,
        method="SLSQP",
        options={"maxiter": 300, "ftol": 1e-15},
    )
    u = np.clip(found.x, [low for low, _ in (*cores[0].bounds, *cores[1].bounds)], 1.0)
    for core, first in ((cores[0], 0), (cores[1], k)):
        part = slice(first, first + core.size)
        if isinstance(core.piece.shape, Hull):
            u[part] /= u[part].sum()
        elif core.piece.shape.kind == "cylinder":
            u[first : first + 2] /= max(1.0, float(np.hypot(u[first], u[first + 1])))
    gap = np.linalg.norm(cores[0].point(u[:k]) - cores[1].point(u[k:]))
    return float(gap) - _ball(a) - _ball(b)


def inside(piece: Piece, rng: np.random.Generator, count: int = 1) -> FloatArray:
    """Points (count, 3) of a solid, in the frame it is placed in."""
    shape = piece.shape
    if isinstance(shape, Hull):
        weights = rng.dirichlet(np.full(len(shape.vertices), 0.5), count)
        local = weights @ shape.vertices
    else:
        local = rng.uniform(-1, 1, (count, 3)) * np.array(shape.half)
        for radius, axes in ((shape.disc, 2), (shape.ball, 3)):
            n = rng.normal(size=(count, axes))
            n *= radius * rng.random((count, 1)) ** (1 / axes) / np.linalg.norm(n, axis=1, keepdims=True)
            local[:, :axes] += n
    found: FloatArray = piece.position + local @ piece.rotation.T
    return found


def shape_of(kind: str, sizes: tuple[float, float, float], seed: int = 0) -> Primitive | Hull:
    """A solid of that kind; hulls are offset from their origin."""
    x, y, z = sizes
    if kind == "box":
        return box(x, y, z)
    if kind == "sphere":
        return sphere(x / 2)
    if kind == "cylinder":
        return cylinder(x / 2, z)
    if kind == "capsule":
        return capsule(x / 2, z)
    if seed % 2:
        return block(x, y, z, (0.3 * x, -y, 0.2))
    from scipy.spatial import ConvexHull

    points = np.random.default_rng(seed).normal(size=(12, 3)) * np.array(sizes) / 3 + np.array([0.05, -0.1, 0.02])
    found = ConvexHull(points)
    used = np.unique(found.simplices)
    number = {int(old): new for new, old in enumerate(used)}
    vertices = points[used]
    faces = np.array([[number[int(i)] for i in face] for face in found.simplices])
    corner = vertices[faces]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    inward = (normal * (corner[:, 0] - vertices.mean(0))).sum(-1) < 0
    faces[inward] = faces[inward][:, ::-1]
    return Hull(vertices, faces)


GRID = st.sampled_from([0.02, 0.05, 0.1, 0.2])
SIZES = st.tuples(GRID, GRID, GRID)
UPRIGHT = [np.eye(3), np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]), np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])]


@st.composite
def grid_aligned(draw: st.DrawFn) -> Piece:
    """A solid on a grid of 50 mm, its axes those of the world."""
    shape = shape_of(draw(st.sampled_from(KINDS)), draw(SIZES), 1)
    step = st.integers(-4, 4).map(lambda k: 0.05 * k)
    return Piece(shape, np.array(draw(st.tuples(step, step, step))), draw(st.sampled_from(UPRIGHT)))


@st.composite
def anywhere(draw: st.DrawFn) -> Piece:
    """A solid at any pose."""
    seed = draw(st.integers(0, 10**6))
    rng = np.random.default_rng(seed)
    shape = shape_of(draw(st.sampled_from(KINDS)), draw(SIZES), seed)
    return Piece(shape, rng.uniform(-0.25, 0.25, 3), rotation(rng))


@st.composite
def pairs(draw: st.DrawFn) -> tuple[Piece, Piece]:
    """Two solids: on a grid, anywhere, near each other (moved until 1 mm or 1 µm is left), or touching."""
    how = draw(st.sampled_from(["grid", "grid", "anywhere", "near", "mixed"]))
    a = draw(grid_aligned() if how in ("grid", "mixed") else anywhere())
    b = draw(grid_aligned() if how == "grid" else anywhere())
    if how == "near":
        b = nearer(a, b, draw(st.sampled_from([1e-3, 1e-5])))
    return a, b


def nearer(a: Piece, b: Piece, left: float) -> Piece:
    """b, moved towards a until about `left` metres are left (where they are apart at all)."""
    for _ in range(12):
        gap = distance(a, b)
        if gap <= left:
            break
        way = a.position - b.position
        size = float(np.linalg.norm(way))
        if size < 1e-9:
            break
        b = Piece(b.shape, b.position + way / size * min(gap - left, size), b.rotation)
    return b


def reach(piece: Piece, position: FloatArray, rotation: FloatArray) -> float:
    """How far, m, a piece's points are from the z axis of the frame in which its body is at this pose."""
    return radius(Piece(piece.shape, position + rotation @ piece.position, rotation @ piece.rotation))
