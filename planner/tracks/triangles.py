"""Shapes as triangles, for the eye: what is proved is proved of the shapes themselves."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.geometry.shapes import Body, Hull, Piece, Primitive

SAG_M = 2e-4
"""How far the sides of what is round may be inside of it, m, ..."""
FEWEST, MOST = 12, 40
"""... as far as so many sides to a full turn are enough."""


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles: `vertices` (m, 3) in metres, in the body's own frame, and `faces` (f, 3), outward."""

    vertices: FloatArray
    faces: IntArray

    @property
    def reach(self) -> float:
        """The greatest distance of a point from the origin of the body's frame, m."""
        return float(np.linalg.norm(self.vertices, axis=1).max())


def mesh_of(body: Body) -> Mesh:
    """The triangles of a body: of its surface where it has one, else of all its pieces."""
    if body.surface is not None:
        return Mesh(*body.surface)
    return joined([_piece(piece) for piece in body.pieces])


def joined(meshes: list[Mesh]) -> Mesh:
    """All triangles of some meshes in one."""
    begins = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    faces = [mesh.faces + begin for mesh, begin in zip(meshes, begins, strict=False)]
    return Mesh(np.concatenate([mesh.vertices for mesh in meshes]), np.concatenate(faces))


def _piece(piece: Piece) -> Mesh:
    shape = piece.shape
    mesh = Mesh(shape.vertices, shape.faces) if isinstance(shape, Hull) else _primitive(shape)
    return Mesh(piece.position + mesh.vertices @ piece.rotation.T, mesh.faces)


def _primitive(shape: Primitive) -> Mesh:
    hx, hy, hz = shape.half
    if shape.kind == "box":
        return _turned_profile([(1.0, -hz), (1.0, hz)], 4, (hx, hy))
    radius = max(shape.disc, shape.ball)
    # a chord of n sides is inside by r (1 - cos π/n)
    sides = 4 * math.ceil(min(MOST, max(FEWEST, math.pi * math.sqrt(radius / (2.0 * SAG_M)))) / 4)
    if shape.kind == "cylinder":
        return _turned_profile([(radius, -hz), (radius, hz)], sides)
    arc = [math.pi / 2 * k / (sides // 4) for k in range(1, sides // 4)]
    lower = [(radius * math.sin(a), -hz - radius * math.cos(a)) for a in arc]
    upper = [(r, -z) for r, z in reversed(lower)]
    waist = [(radius, -hz), (radius, hz)] if hz > 0.0 else [(radius, 0.0)]
    return _turned_profile([*lower, *waist, *upper], sides, poles=(-hz - radius, hz + radius))


def _turned_profile(
    profile: list[tuple[float, float]],
    sides: int,
    square: tuple[float, float] | None = None,
    poles: tuple[float, float] | None = None,
) -> Mesh:
    """The solid that a profile of (radius, z), upwards, makes as it is turned about z. `square`: corners of a box in
    place of a circle. `poles`: heights of its ends; else they are flat."""
    if square is not None:
        around = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * square
    else:
        angle = 2.0 * np.pi * np.arange(sides) / sides
        around = np.stack([np.cos(angle), np.sin(angle)], -1)
    rings = [np.column_stack([radius * around, np.full(sides, z)]) for radius, z in profile]
    low, high = poles or (profile[0][1], profile[-1][1])
    vertices = np.concatenate([*rings, [[0.0, 0.0, low], [0.0, 0.0, high]]])
    ones = np.arange(sides)
    nexts = (ones + 1) % sides
    faces = []
    for k in range(len(profile) - 1):
        a, b = k * sides, (k + 1) * sides
        faces += [np.stack([a + ones, a + nexts, b + nexts], -1), np.stack([a + ones, b + nexts, b + ones], -1)]
    last, bottom = (len(profile) - 1) * sides, len(vertices) - 2
    faces.append(np.stack([nexts, ones, np.full(sides, bottom)], -1))
    faces.append(np.stack([last + ones, last + nexts, np.full(sides, bottom + 1)], -1))
    return Mesh(vertices, np.concatenate(faces))
