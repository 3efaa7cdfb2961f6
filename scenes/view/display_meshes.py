"""Meshes to draw: triangles of bodies, few enough for a small page, with vertices on a grid of 16 bits.

They are for the eye alone: proofs use the shapes themselves.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.geometry.shapes import Body, Hull, Primitive
from assur.scenes.schema import view as document
from assur.scenes.view.packing import words

SAG_M = 2e-4
"""Largest distance of the sides of a round shape from it, m, if that needs no more than ..."""
FEWEST_SIDES, MOST_SIDES = 12, 40
"""... this many sides for a full turn."""
MOST_TRIANGLES = 3_000
"""Triangles of one mesh ..."""
MOST_OF_ALL = 24_000
"""... and of all meshes: 150 kB of a page."""
FINEST = 512
"""Cells of the grid along the longest side at which a reduction begins; each further one has fewer."""
COARSER = 0.8
LEVELS = (1 << 16) - 1
PLACES = np.array([1 << 42, 1 << 21, 1])
"""Makes one number of three numbers of 21 bits: vertices of a mesh, or cells along an axis."""


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles: `vertices` (m, 3) in metres, in the frame of the body, and `faces` (f, 3), which face outwards."""

    vertices: FloatArray
    faces: IntArray

    @property
    def reach(self) -> float:
        """The greatest distance of a point from the origin of the body's frame, m."""
        return float(np.linalg.norm(self.vertices, axis=1).max())


@dataclass(frozen=True, eq=False)
class Display:
    """A mesh that is drawn in place of `triangles`; its vertices were moved by `off_m` at most, m, before rounding."""

    mesh: Mesh
    triangles: int
    off_m: float

    @property
    def reduced(self) -> bool:
        """Whether it has fewer triangles than the shape."""
        return self.triangles != len(self.mesh.faces)


def mesh_of(body: Body) -> Mesh:
    """The triangles of a body: of its surface where it has one, else of all its pieces."""
    if body.surface is not None:
        return Mesh(*body.surface)
    vertices, faces, count = list[FloatArray](), list[IntArray](), 0
    for piece in body.pieces:
        shape = piece.shape
        mesh = Mesh(shape.vertices, shape.faces) if isinstance(shape, Hull) else _primitive_mesh(shape)
        vertices.append(piece.position + mesh.vertices @ piece.rotation.T)
        faces.append(mesh.faces + count)
        count += len(mesh.vertices)
    return Mesh(np.concatenate(vertices), np.concatenate(faces))


def _primitive_mesh(shape: Primitive) -> Mesh:
    hx, hy, hz = shape.half
    if shape.kind == "box":
        corners = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * (hx, hy)
        return _profile_mesh([(1.0, -hz), (1.0, hz)], corners, (-hz, hz))
    radius = max(shape.disc, shape.ball)
    # a chord of n sides is inside by r (1 - cos π/n)
    enough = math.pi * math.sqrt(radius / (2.0 * SAG_M))
    sides = 4 * math.ceil(min(MOST_SIDES, max(FEWEST_SIDES, enough)) / 4)
    angle = 2.0 * np.pi * np.arange(sides) / sides
    circle = np.stack([np.cos(angle), np.sin(angle)], -1)
    if shape.kind == "cylinder":
        return _profile_mesh([(radius, -hz), (radius, hz)], circle, (-hz, hz))
    arc = [math.pi / 2 * k / (sides // 4) for k in range(1, sides // 4)]
    lower = [(radius * math.sin(a), -hz - radius * math.cos(a)) for a in arc]
    upper = [(r, -z) for r, z in reversed(lower)]
    waist = [(radius, -hz), (radius, hz)] if hz > 0.0 else [(radius, 0.0)]
    return _profile_mesh([*lower, *waist, *upper], circle, (-hz - radius, hz + radius))


def _profile_mesh(profile: list[tuple[float, float]], around: FloatArray, poles: tuple[float, float]) -> Mesh:
    """A solid of rings, closed at both ends: for each (scale, z) of the profile, upwards, the corners `around` (S, 2)
    times the scale at height z. `poles`: heights of the middles of both ends."""
    sides = len(around)
    rings = [np.column_stack([scale * around, np.full(sides, z)]) for scale, z in profile]
    low, high = poles
    vertices = np.concatenate([*rings, [[0.0, 0.0, low], [0.0, 0.0, high]]])
    ones = np.arange(sides)
    nexts = (ones + 1) % sides
    faces = []
    for a in range(0, (len(profile) - 1) * sides, sides):
        b = a + sides
        faces += [np.stack([a + ones, a + nexts, b + nexts], -1), np.stack([a + ones, b + nexts, b + ones], -1)]
    last, bottom = (len(profile) - 1) * sides, len(vertices) - 2
    faces.append(np.stack([nexts, ones, np.full(sides, bottom)], -1))
    faces.append(np.stack([last + ones, last + nexts, np.full(sides, bottom + 1)], -1))
    return Mesh(vertices, np.concatenate(faces))


def displays(meshes: tuple[Mesh, ...]) -> list[Display]:
    """The meshes as they are drawn: large ones are reduced, and if all together are too many, all that are large."""
    total = sum(min(len(mesh.faces), MOST_TRIANGLES) for mesh in meshes)
    most = MOST_TRIANGLES if total <= MOST_OF_ALL else max(64, int(MOST_TRIANGLES * MOST_OF_ALL / total))
    return [reduced(mesh, most) for mesh in meshes]


def reduced(mesh: Mesh, most: int) -> Display:
    """A mesh of at most `most` triangles: its vertices are joined cell by cell of a grid, which is as fine as that
    allows.

    A vertex is moved to the mean of those in its cell, so by less than the diagonal of a cell. What becomes thinner
    than a cell may look torn.
    """
    count = len(mesh.faces)
    if count <= most and len(mesh.vertices) <= LEVELS:
        return Display(mesh, count, 0.0)
    low, size = mesh.vertices.min(0), float(np.ptp(mesh.vertices, axis=0).max())
    cells: float = FINEST
    while True:
        keys = np.floor((mesh.vertices - low) / (size / cells)).astype(np.int64) @ PLACES
        _, number, many = np.unique(keys, return_inverse=True, return_counts=True)
        middle = np.stack([np.bincount(number, axis) for axis in mesh.vertices.T], -1) / many[:, None]
        faces = number[mesh.faces]
        kept = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
        _, once = np.unique(_turned(faces[kept]) @ PLACES, return_index=True)
        faces = faces[kept][once]
        if (len(faces) <= most and len(middle) <= LEVELS) or cells < 2.0:
            off = float(np.linalg.norm(middle[number] - mesh.vertices, axis=1).max())
            return Display(Mesh(middle, faces), count, off)
        cells *= COARSER


def _turned(faces: IntArray) -> IntArray:
    """Faces with their least vertex first, so that equal ones are recognised."""
    first = np.argmin(faces, axis=1)
    return np.take_along_axis(faces, (first[:, None] + np.arange(3)) % 3, axis=1)


def written(mesh: Mesh) -> document.ShownMesh:
    """A mesh with its vertices on a grid of 16 bits: each is off by half a step of it at most."""
    low, high = mesh.vertices.min(0), mesh.vertices.max(0)
    step = np.maximum((high - low) / LEVELS, math.ulp(1.0))
    return {
        "low_m": low.tolist(),
        "step_m": step.tolist(),
        "vertices": words(np.round((mesh.vertices - low) / step).astype(np.int64)),
        "faces": words(mesh.faces),
    }
