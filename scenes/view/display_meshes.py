"""Meshes for the eye: so few triangles that a page is small and quick, and vertices on a grid of 16 bits."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assur.planner.tracks.triangles import Mesh
from assur.scenes.schema import view as document
from assur.scenes.view.packing import words

MOST_TRIANGLES = 3_000
"""Triangles of one mesh ..."""
MOST_OF_ALL = 24_000
"""... and of all meshes: 150 kB of a page."""
FINEST = 512
"""Cells of the grid along the longest side at which a reduction begins; each further one has fewer."""
COARSER = 0.8
LEVELS = (1 << 16) - 1
PLACES = np.array([1 << 42, 1 << 21, 1])
"""Makes one number of three, each of which has 21 bits: vertices of a mesh, or cells along an axis."""


@dataclass(frozen=True, eq=False)
class Display:
    """A mesh that is drawn in place of `triangles`; its vertices were moved by `off_m` at most, m, before rounding."""

    mesh: Mesh
    triangles: int
    off_m: float


def displays(meshes: tuple[Mesh, ...]) -> list[Display]:
    """The meshes as they are drawn: large ones are reduced, and if all together are too many, all that are large."""
    total = sum(min(len(mesh.faces), MOST_TRIANGLES) for mesh in meshes)
    most = MOST_TRIANGLES if total <= MOST_OF_ALL else max(64, int(MOST_TRIANGLES * MOST_OF_ALL / total))
    return [reduced(mesh, most) for mesh in meshes]


def reduced(mesh: Mesh, most: int) -> Display:
    """A mesh of `most` triangles at most: its vertices are joined cell by cell of a grid, as fine as that allows.

    A vertex is moved to the mean of those in its cell, so by less than the diagonal of a cell. What becomes thinner
    than a cell may look torn: it is for the eye alone.
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


def _turned(faces: np.ndarray[tuple[int, ...], np.dtype[np.int64]]) -> np.ndarray[tuple[int, ...], np.dtype[np.int64]]:
    """Faces with their least vertex first, so that the same one is found twice."""
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
