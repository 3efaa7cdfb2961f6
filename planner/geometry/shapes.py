"""Convex solids by their support functions σ(n) = max over the solid of n·x.

Every primitive is the Minkowski sum of a box, a disc across the local z axis and a ball, so one closed form serves
all of them (equation S1):

    σ(n) = hx |nx| + hy |ny| + hz |nz| + rd √(nx² + ny²) + rb |n|

box: h; sphere: rb; capsule along z: hz, rb; cylinder along z: hz, rd. A convex hull is its vertices.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from operator import le
from typing import TYPE_CHECKING

import numpy as np

from assur.planner.arrays import FloatArray, IntArray, frozen
from assur.planner.errors import InputError

if TYPE_CHECKING:
    from assur.planner.geometry.surface import Spread

SMALLEST_M = 1e-5
"""No solid is thinner than this: below it a unit was probably mistaken."""
LARGEST_M = 50.0
"""No solid is larger than this: above it a unit was probably mistaken."""
LENGTH = f"a length from {SMALLEST_M} to {LARGEST_M} m"


def _sizes(names: tuple[str, ...], values: tuple[float, ...]) -> list[float]:
    sizes = []
    for name, value in zip(names, values, strict=True):
        try:
            size = float(value)
        except (TypeError, ValueError, OverflowError) as error:
            raise InputError(name, value, LENGTH) from error
        if not SMALLEST_M <= size <= LARGEST_M:
            raise InputError(name, value, LENGTH)
        sizes.append(size)
    return sizes


TERMS = {"box": "11100", "sphere": "00001", "cylinder": "00110", "capsule": "00101"}
"""Which of hx, hy, hz, rd, rb a kind has (1); the others are zero."""
LONGEST = {kind: tuple(LARGEST_M if has == "1" else 0.0 for has in terms) for kind, terms in TERMS.items()}
"""The largest value of each term."""
SHORTEST = {kind: tuple(SMALLEST_M / 2 if has == "1" else 0.0 for has in terms) for kind, terms in TERMS.items()}
"""The smallest value of each term."""


@dataclass(frozen=True)
class Primitive:
    """A box, sphere, cylinder or capsule centred at its origin; cylinder and capsule along z. Metres.

    The functions `box`, `sphere`, `cylinder`, `capsule` make one of its sizes. Raises `InputError` for another kind,
    for a term that the kind has and that is not a positive length, and for one that it has not and that is not zero.
    """

    kind: str
    half: tuple[float, float, float]
    disc: float
    ball: float

    def __post_init__(self) -> None:
        if self.kind not in TERMS:
            raise InputError("primitive.kind", self.kind, f"one of {sorted(TERMS)}")
        terms = (*self.half, self.disc, self.ball)
        if len(terms) != 5:
            raise InputError(f"{self.kind}.half", self.half, "three lengths")
        if not (all(map(le, SHORTEST[self.kind], terms)) and all(map(le, terms, LONGEST[self.kind]))):
            raise InputError(self.kind, terms, f"lengths where {TERMS[self.kind]} has a 1, and else zero")


def box(size_x: float, size_y: float, size_z: float) -> Primitive:
    """A box by its full edge lengths, m."""
    x, y, z = _sizes(("box.size[0]", "box.size[1]", "box.size[2]"), (size_x, size_y, size_z))
    return Primitive("box", (x / 2, y / 2, z / 2), 0.0, 0.0)


def sphere(radius: float) -> Primitive:
    """A ball by its radius, m."""
    return Primitive("sphere", (0.0, 0.0, 0.0), 0.0, *_sizes(("sphere.radius",), (radius,)))


def cylinder(radius: float, height: float) -> Primitive:
    """A cylinder along z by its radius and full height, m."""
    h, r = _sizes(("cylinder.height", "cylinder.radius"), (height, radius))
    return Primitive("cylinder", (0.0, 0.0, h / 2), r, 0.0)


def capsule(radius: float, length: float) -> Primitive:
    """A capsule along z by its radius and the distance between the centres of its caps, m."""
    h, r = _sizes(("capsule.length", "capsule.radius"), (length, radius))
    return Primitive("capsule", (0.0, 0.0, h / 2), 0.0, r)


@dataclass(frozen=True, eq=False)
class Hull:
    """A convex polyhedron: `vertices` (m, 3) in metres, `faces` (f, 3) indices, outward by the right-hand rule."""

    vertices: FloatArray
    faces: IntArray

    def __post_init__(self) -> None:
        vertices = frozen(self.vertices, (None, 3), "hull.vertices")
        numbers = frozen(self.faces, (None, None), "hull.faces")
        if not (numbers == np.round(numbers)).all():
            raise InputError("hull.faces", self.faces, "whole numbers")
        faces = numbers.astype(np.int64)
        if len(vertices) < 4:
            raise InputError("hull.vertices", len(vertices), "at least 4 vertices")
        if faces.ndim != 2 or faces.shape[1:] != (3,) or len(faces) < 4:
            raise InputError("hull.faces", faces.shape, "at least 4 triangles")
        if not (faces.min() >= 0 and faces.max() < len(vertices)):
            raise InputError(
                "hull.faces", (int(faces.min()), int(faces.max())), f"indices from 0 to {len(vertices) - 1}"
            )
        if not float(np.ptp(vertices, axis=0).max()) <= LARGEST_M:
            raise InputError("hull.vertices", float(np.ptp(vertices, axis=0).max()), f"an extent up to {LARGEST_M} m")
        faces.flags.writeable = False
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "faces", faces)


AXES = {
    "x": frozen([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]], (3, 3), "axes.x"),
    "y": frozen([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]], (3, 3), "axes.y"),
    "z": frozen(np.eye(3), (3, 3), "axes.z"),
}
"""Rotations that lay a solid's local z axis along a body axis."""
ORIGIN = frozen(np.zeros(3), (3,), "origin")


@dataclass(frozen=True, eq=False)
class Piece:
    """A convex solid fixed in a body: `position` (3,) m, `rotation` (3, 3) with the solid's axes as its columns."""

    shape: Primitive | Hull
    position: FloatArray = field(default_factory=lambda: ORIGIN)
    rotation: FloatArray = field(default_factory=lambda: AXES["z"])

    def __post_init__(self) -> None:
        if self.position is not ORIGIN:
            object.__setattr__(self, "position", frozen(self.position, (3,), "piece.position"))
        if self.rotation is AXES["z"] or self.rotation is AXES["x"] or self.rotation is AXES["y"]:
            return  # read-only and a rotation: most solids have one of these
        rotation = frozen(self.rotation, (3, 3), "piece.rotation")
        if not (np.abs(rotation.T @ rotation - np.eye(3)).max() <= 1e-9 and np.linalg.det(rotation) > 0):
            raise InputError("piece.rotation", rotation.tolist(), "an orthonormal, right-handed matrix")
        object.__setattr__(self, "rotation", rotation)

    @cached_property
    def row(self) -> tuple[float, ...]:
        """Its row of the table of `pieces`: the bodies of one mesh share their pieces."""
        shape = self.shape
        support = (0.0,) * 5 if isinstance(shape, Hull) else (*shape.half, shape.disc, shape.ball)
        return (*self.position.tolist(), *self.rotation.ravel().tolist(), *support)


@dataclass(frozen=True, eq=False)
class Body:
    """A named solid: the union of convex pieces, in the body's own frame.

    `surface`: of a body whose pieces cover its surface but do not fill it, the closed triangles, outward: vertices
    (m, 3) in metres and faces (f, 3); `assur.planner.geometry.containment` finds what they enclose. None: solid pieces.
    """

    name: str
    pieces: tuple[Piece, ...]
    surface: tuple[FloatArray, IntArray] | None = None

    def __post_init__(self) -> None:
        if not self.pieces:
            raise InputError(f"body {self.name}", self.pieces, "at least one convex piece")
        if self.surface is not None:
            vertices, faces = self.surface
            if not (vertices.ndim == 2 and vertices.shape[1:] == (3,) and faces.ndim == 2 and faces.shape[1:] == (3,)):
                raise InputError(f"body {self.name}", (vertices.shape, faces.shape), "a surface of (m, 3) and (f, 3)")
            if vertices.flags.writeable or faces.flags.writeable:
                raise InputError(f"body {self.name}", "writable arrays", "a surface of read-only arrays")

    @cached_property
    def spread(self) -> Spread:
        """How its volume is spread, for a mass of uniform density."""
        from assur.planner.geometry.surface import spread

        return spread(self)

    @property
    def cut_surface(self) -> tuple[tuple[FloatArray, IntArray], ...]:
        """For each piece: corners (V, 3), m, and the triangles (T, 3) of them, into which the surface is cut so that
        each is in one piece. Without a surface: nothing."""
        from assur.planner.geometry.surface import cut_of

        return () if self.surface is None else cut_of(self.pieces, self.surface)

    @cached_property
    def radius(self) -> float:
        """Horizontal distance, m, of its points from its own origin at most."""
        return max(radius(piece) for piece in self.pieces)

    @cached_property
    def heights(self) -> tuple[float, float]:
        """Its lowest and its highest z, m."""
        up: FloatArray = np.array([0.0, 0.0, 1.0])
        return -max(support(piece, -up) for piece in self.pieces), max(support(piece, up) for piece in self.pieces)


def support(piece: Piece, n: FloatArray) -> float:
    """σ(n) of a piece in its body's frame, m: max of n·x over the piece (S1)."""
    local = piece.rotation.T @ n
    offset = float(n @ piece.position)
    if isinstance(piece.shape, Hull):
        return offset + float((piece.shape.vertices @ local).max())
    shape = piece.shape
    reach = float(np.abs(local) @ np.array(shape.half))
    return offset + reach + shape.disc * float(np.hypot(local[0], local[1])) + shape.ball * float(np.linalg.norm(n))


def corners(shape: Primitive | Hull) -> FloatArray:
    """Points (m, 3) whose hull, grown by `disc` across z and by `ball`, is the solid."""
    if isinstance(shape, Hull):
        return shape.vertices
    signs = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
    vertices: FloatArray = signs * np.array(shape.half)
    return vertices


def radius(piece: Piece) -> float:
    """Horizontal distance, m, of the piece's points from the origin of its body's frame at most (S2)."""
    if isinstance(piece.shape, Hull):
        points = piece.position + piece.shape.vertices @ piece.rotation.T
        return float(np.hypot(points[:, 0], points[:, 1]).max())
    (a, b, c), (d, e, f), _ = piece.rotation.tolist()
    x, y, _ = piece.position.tolist()
    hx, hy, hz = piece.shape.half
    farthest = 0.0
    for s, t in ((hy, hz), (hy, -hz), (-hy, hz), (-hy, -hz)):
        u, v = a * hx + b * s + c * t, d * hx + e * s + f * t
        farthest = max(farthest, math.hypot(x + u, y + v), math.hypot(x - u, y - v))
    return farthest + piece.shape.disc + piece.shape.ball


# All convex pieces of a cell's bodies as flat arrays: the raw shapes, read once, for callers that compute with many.


@dataclass(frozen=True, eq=False)
class Pieces:
    """Pieces (S,) of bodies (B,), those of body b being `first[b]` and the `count[b] - 1` behind it.

    `position` (S, 3) m and `rotation` (S, 3, 3) in the body's axes; `half` (S, 3), `disc`, `ball` (S,) the terms of
    their support function (S1), zero for a hull, which is number `hull` (S,) of `hulls`; -1: a primitive. The first
    five are columns of `table` (S, 17).
    """

    table: FloatArray
    first: IntArray
    count: IntArray
    position: FloatArray
    rotation: FloatArray
    half: FloatArray
    disc: FloatArray
    ball: FloatArray
    hull: IntArray
    shapes: tuple[Primitive | Hull, ...]
    hulls: tuple[Hull, ...]


def pieces(bodies: Sequence[Body], before: Pieces | None = None) -> Pieces:
    """The table of some bodies, in order, behind those that are in the table `before`; its arrays are read-only."""
    every = [piece for body in bodies for piece in body.pieces]
    hull, numbers = list[int](), list[float]()
    hulls, shapes = ([], ()) if before is None else ([*before.hulls], before.shapes)
    for piece in every:
        numbers += piece.row
        if isinstance(piece.shape, Hull):
            hull.append(len(hulls))
            hulls.append(piece.shape)
        else:
            hull.append(-1)
    table, count = np.array(numbers).reshape(-1, 17), np.array([len(body.pieces) for body in bodies], dtype=np.int64)
    number = np.array(hull, dtype=np.int64)
    if before is not None:
        table, count = np.concatenate([before.table, table]), np.concatenate([before.count, count])
        number = np.concatenate([before.hull, number])
    arrays = table, count, count.cumsum() - count, number
    for array in arrays:
        array.setflags(write=False)
    return Pieces(
        table=table,
        first=arrays[2],
        count=count,
        position=table[:, :3],
        rotation=table[:, 3:12].reshape(-1, 3, 3),
        half=table[:, 12:15],
        disc=table[:, 15],
        ball=table[:, 16],
        hull=arrays[3],
        shapes=(*shapes, *[piece.shape for piece in every]),
        hulls=tuple(hulls),
    )
