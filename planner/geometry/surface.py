"""Closed surfaces: their volume, centre and inertia, and their pieces between planes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from weakref import WeakKeyDictionary

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.errors import FaultError, InputError
from assur.planner.geometry.shapes import Body, Hull, Piece, Primitive

IN_M = 2e-10
"""A point is in a piece if it is no farther out than this, m: twice what a cover may be off by rounding, and a fifth of
what the planner keeps of each gap."""
MOST_AT_ONCE = 4_000_000
"""Distances of points from planes that are computed at a time: 32 MB."""
Triangles = list[list[int]]
Surface = tuple[FloatArray, IntArray]
Cut = tuple[Surface, ...]
_KEPT: WeakKeyDictionary[Piece, tuple[Surface, Cut]] = WeakKeyDictionary()
"""Surfaces that are cut, by the first of the pieces that cover them: bodies of the same mesh share both."""


class _Pieces:
    """Hulls by their planes, in the body's axes."""

    def __init__(self, pieces: Sequence[Piece]) -> None:
        self.vertices, normals, offsets, self.first = list[FloatArray](), list[FloatArray](), list[FloatArray](), [0]
        for piece in pieces:
            if not isinstance(piece.shape, Hull):
                raise FaultError(f"a mesh is covered by a {piece.shape.kind}")
            vertices = piece.shape.vertices @ piece.rotation.T + piece.position
            a, b, c = (vertices[piece.shape.faces[:, k]] for k in range(3))
            normal = np.cross(b - a, c - a)
            size = np.linalg.norm(normal, axis=1)
            normal = normal[size > 0.0] / size[size > 0.0, None]
            self.vertices.append(vertices)
            normals.append(normal)
            offsets.append((vertices @ normal.T).max(0))
            self.first.append(self.first[-1] + len(normal))
        self.normal, self.offset = np.concatenate(normals), np.concatenate(offsets)

    def beyond(self, points: FloatArray) -> FloatArray:
        """How far each point (N, 3) is beyond each plane, (N, planes), m."""
        return np.asarray(points @ self.normal.T - self.offset)

    def out(self, points: FloatArray) -> FloatArray:
        """How far each point (N, 3) is out of each piece, (N, pieces), m; below 0: it is in it."""
        return np.asarray(np.maximum.reduceat(self.beyond(points), self.first[:-1], axis=1))


class _Cutting:
    """Polygons as numbers of points, which share the points of their edges."""

    def __init__(self, pieces: _Pieces, vertices: FloatArray) -> None:
        self.pieces, self.points, self.cuts = pieces, list(vertices), dict[tuple[int, int], int]()

    def whole(self, polygon: list[int]) -> list[int]:
        """A polygon with all points in which its edges were cut."""
        ends = zip(polygon, [*polygon[1:], polygon[0]], strict=True)
        return [point for a, b in ends for point in (a, *self._between(a, b))]

    def _between(self, a: int, b: int) -> list[int]:
        middle = self.cuts.get((min(a, b), max(a, b)))
        return [] if middle is None else [*self._between(a, middle), middle, *self._between(middle, b)]

    def shared(self, polygon: list[int]) -> list[tuple[list[int], int]]:
        """A polygon in parts, each with the number of the piece that it is in."""
        found, left = list[tuple[list[int], int]](), [polygon]
        while left:
            polygon = self.whole(left.pop())
            at = np.array([self.points[k] for k in polygon])
            out = self.pieces.out(at).max(0)
            best = int(out.argmin())
            if out[best] > IN_M:
                # by the piece that its middle is in; a part that is left over by rounding goes to the nearest piece
                near = int(self.pieces.out(at.mean(0)[None])[0].argmin())
                beyond = self.pieces.beyond(at)[:, self.pieces.first[near] : self.pieces.first[near + 1]]
                cut = beyond[:, int(beyond.max(0).argmax())]
                if cut.min() < -IN_M and cut.max() > IN_M:
                    left += self._halves(polygon, cut)
                    continue
            found.append((polygon, best))
        return found

    def _halves(self, polygon: list[int], beyond: FloatArray) -> list[list[int]]:
        """The parts of a convex polygon on both sides of a plane."""
        halves: tuple[list[int], list[int]] = [], []
        heights = np.where(np.abs(beyond) <= IN_M, 0.0, beyond).tolist()
        for k, (a, low) in enumerate(zip(polygon, heights, strict=True)):
            b, high = polygon[(k + 1) % len(polygon)], heights[(k + 1) % len(polygon)]
            for half, sign in zip(halves, (-1.0, 1.0), strict=True):
                half += [a] if low * sign >= 0.0 else []
            if low * high < 0.0:
                self.cuts[min(a, b), max(a, b)] = len(self.points)
                self.points.append(self.points[a] + low / (low - high) * (self.points[b] - self.points[a]))
                for half in halves:
                    half.append(len(self.points) - 1)
        return [half for half in halves if len(half) > 2]


def cut_of(pieces: Sequence[Piece], surface: Surface) -> Cut:
    """As `in_pieces`, which is called once for each surface: a large mesh takes a second."""
    found = _KEPT.get(pieces[0])
    if found is None or found[0] is not surface or len(found[1]) != len(pieces):
        found = _KEPT[pieces[0]] = surface, in_pieces(pieces, surface)
    return found[1]


def in_pieces(pieces: Sequence[Piece], surface: Surface) -> Cut:
    """For each piece: corners of triangles (V, 3), m, in the body's axes, and the triangles (T, 3) as numbers of three
    of them. All triangles together are the surface. A piece to which no triangle goes has its own vertices."""
    (vertices, faces), hulls = surface, _Pieces(pieces)
    step = max(1, MOST_AT_ONCE // len(hulls.offset))
    blocks = [hulls.out(vertices[k : k + step]) <= IN_M for k in range(0, len(vertices), step)]
    inside: BoolArray = np.concatenate(blocks)
    fits: BoolArray = inside[faces[:, 0]] & inside[faces[:, 1]] & inside[faces[:, 2]]
    owner = np.where(fits.any(1), fits.argmax(1), -1)
    cutting, parts = _Cutting(hulls, vertices), list[tuple[list[int], int]]()
    for face, piece in zip(faces.tolist(), owner.tolist(), strict=True):
        parts += [(face, piece)] if piece >= 0 else cutting.shared(face)
    found: list[Triangles] = [[] for _ in pieces]
    for polygon, piece in parts:
        first, *others = cutting.whole(polygon)
        found[piece] += [[first, a, b] for a, b in pairwise(others)]
    return tuple(_numbered(cutting.points, own, hulls.vertices[k]) for k, own in enumerate(found))


def _numbered(points: list[FloatArray], triangles: Triangles, hull: FloatArray) -> tuple[FloatArray, IntArray]:
    """The corners of triangles, and the triangles by numbers of these; the vertices of the hull if there are none."""
    numbers = {k: n for n, k in enumerate(dict.fromkeys(k for triangle in triangles for k in triangle))}
    corners = np.array([points[k] for k in numbers]) if numbers else hull
    chosen = np.array([[numbers[k] for k in triangle] for triangle in triangles], dtype=np.int64).reshape(-1, 3)
    return corners, chosen


@dataclass(frozen=True, slots=True)
class Spread:
    """How the volume of a body is spread, in the body's frame: `volume` m³, `centroid` (x, y, z) m, `square` m²: mean
    square of the horizontal distance from the vertical through the centroid."""

    volume: float
    centroid: tuple[float, float, float]
    square: float


def spread(body: Body) -> Spread:
    """The spread of a body: of the solid within its surface where it has one, else of its pieces, whose volumes add up
    where they overlap. Raises `InputError` for a surface that encloses no volume."""
    first = body.pieces[0]
    if body.surface is None and len(body.pieces) == 1 and isinstance(first.shape, Primitive):
        volume, (a, b, c) = _primitive(first.shape)
        (xx, xy, xz), (yx, yy, yz), _ = (first.rotation * first.rotation).tolist()
        x, y, z = first.position.tolist()
        return Spread(volume, (x, y, z), (xx + yx) * a + (xy + yy) * b + (xz + yz) * c)
    if body.surface is not None:
        parts = [_enclosed(*body.surface)]
    else:
        parts = [_of_piece(piece) for piece in body.pieces]
    volume = sum(part[0] for part in parts)
    if not (math.isfinite(volume) and all(part[0] > 0.0 for part in parts)):
        raise InputError(f"body {body.name}", volume, "a solid with a volume, its triangles outward")
    centroid = np.asarray(sum(part[0] * part[1] for part in parts) / volume)
    square = 0.0
    for each, middle, second in parts:
        off = middle - centroid
        square += each * float(second[0, 0] + second[1, 1] + off[0] ** 2 + off[1] ** 2)
    x, y, z = centroid.tolist()
    return Spread(volume, (x, y, z), square / volume)


def _of_piece(piece: Piece) -> tuple[float, FloatArray, FloatArray]:
    """Volume, centroid and second moments of a piece about its centroid, in its body's axes."""
    if isinstance(piece.shape, Hull):
        volume, middle, second = _enclosed(piece.shape.vertices, piece.shape.faces)
    else:
        volume, diagonal = _primitive(piece.shape)
        middle, second = np.zeros(3), np.diag(diagonal)
    turn = piece.rotation
    return volume, piece.position + turn @ middle, turn @ second @ turn.T


def _primitive(shape: Primitive) -> tuple[float, tuple[float, float, float]]:
    """Volume and second moments along its own axes of a solid that is centred: closed forms."""
    (x, y, h), disc, ball = shape.half, shape.disc, shape.ball
    match shape.kind:
        case "box":
            return 8.0 * x * y * h, (x * x / 3.0, y * y / 3.0, h * h / 3.0)
        case "cylinder":
            across = disc * disc / 4.0
            return 2.0 * math.pi * disc * disc * h, (across, across, h * h / 3.0)
        case "sphere":
            across = ball * ball / 5.0
            return 4.0 / 3.0 * math.pi * ball**3, (across, across, across)
    # a capsule: a cylinder between two half balls, whose centroids are 3/8 of the radius from their flat faces
    tube, caps = 2.0 * math.pi * ball * ball * h, 4.0 / 3.0 * math.pi * ball**3
    volume = tube + caps
    across = (tube * ball * ball / 4.0 + caps * ball * ball / 5.0) / volume
    up = (tube * h * h / 3.0 + caps * (h * h + 0.75 * h * ball + ball * ball / 5.0)) / volume
    return volume, (across, across, up)


_TETRAHEDRON = (np.ones((3, 3)) + np.eye(3)) / 20.0
"""Mean of the products of two coordinates over the tetrahedron of the origin and the three unit vectors, times what its
corners are scaled with."""


def _enclosed(vertices: FloatArray, faces: IntArray) -> tuple[float, FloatArray, FloatArray]:
    """Volume, centroid and second moments about it of what closed triangles enclose: tetrahedra from the mean corner
    to each triangle, counted negative where that looks inwards."""
    origin = vertices.mean(0)
    corners = vertices[faces] - origin
    volumes = np.linalg.det(corners) / 6.0
    volume = float(volumes.sum())
    if not volume > 0.0:
        return volume, origin, np.zeros((3, 3))
    middle = (volumes[:, None] * corners.sum(1)).sum(0) / (4.0 * volume)
    weighted = volumes[:, None, None] * (_TETRAHEDRON @ corners)
    products = np.tensordot(corners, weighted, axes=([0, 1], [0, 1])) / volume
    return volume, origin + middle, products - np.outer(middle, middle)
