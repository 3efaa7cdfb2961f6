"""Volume, centroid and second moments of solids of uniform density.

With V the volume, c the centroid and S = ∫ (x - c)(x - c)ᵀ dV / V, a mass m has the moment of inertia
m (S_xx + S_yy) about the vertical through c, and m (S_xx + S_yy + d²) about a vertical at the distance d (equation G1).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.errors import InputError
from assur.planner.geometry.shapes import Body, Hull, Piece, Primitive


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
