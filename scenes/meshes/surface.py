"""A closed surface: the requirements on a mesh before anything is planned around it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.errors import InputError
from assur.scenes.bounds import FAR_M, LARGEST_MESH_M, MAX_FACES, MIN_FACES, SMALLEST_MESH_M
from assur.scenes.meshes.parts import Parts, at_once

SMALLEST_VOLUME_M3 = 1e-12
"""Volume from which on a mesh counts as a solid, m³: a cube of a tenth of a millimetre."""

INSIDE_OUT = "faces that point inwards"
"""The fault of a surface that is closed and turned inside out."""


@dataclass(frozen=True, eq=False)
class Surface:
    """Vertices (m, 3) in metres, no two alike, and triangles (f, 3), outward; closed, and sane in size."""

    vertices: FloatArray
    faces: IntArray

    @property
    def corners(self) -> FloatArray:
        """(f, 3, 3) metres."""
        return self.vertices[self.faces]


def closed_surface(corners: FloatArray, unit_m: float) -> Surface:
    """The surface of triangles with `corners` (f, 3, 3) in units of `unit_m` metres.

    Vertices are the same where their coordinates are equal, and nowhere else: nothing is welded or repaired. Closed
    means that every edge is run through as often one way as the other, which is what a winding number needs.
    Raises `InputError` naming mesh.data or mesh.unit. Not checked: that the surface does not cross itself.
    """
    return at_once(surface_in_parts(corners, unit_m))


def surface_in_parts(corners: FloatArray, unit_m: float) -> Parts[Surface]:
    """`closed_surface`, which may be interrupted between two parts of the work, and continued."""
    if not MIN_FACES <= len(corners) <= MAX_FACES:
        raise InputError("mesh.data", f"{len(corners)} triangles", f"{MIN_FACES} to {MAX_FACES} triangles")
    if not np.all(np.isfinite(corners)):
        raise InputError("mesh.data", "a vertex that is not finite", "finite vertices")
    scaled = corners.reshape(-1, 3) * unit_m + 0.0
    yield
    vertices, faces = _once(scaled)
    yield
    extent = float(np.ptp(vertices, axis=0).max())
    if not SMALLEST_MESH_M <= extent <= LARGEST_MESH_M:
        raise InputError(
            "mesh.unit", f"{extent:.4g} m large", f"a size from {SMALLEST_MESH_M:g} to {LARGEST_MESH_M:g} m"
        )
    if not float(np.abs(vertices).max()) <= FAR_M:
        raise InputError("mesh.unit", f"up to {np.abs(vertices).max():.4g} m away", f"coordinates up to {FAR_M:g} m")
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    there, back = (np.sort(edges[:, i] * len(vertices) + edges[:, 1 - i]) for i in (0, 1))
    if not np.array_equal(there, back):
        odd = len(np.setxor1d(there, back)) // 2
        raise InputError("mesh.data", f"{max(odd, 1)} open edges", "a closed surface (watertight, faces turned alike)")
    yield
    volume = volume_of(vertices[faces])
    if volume <= -SMALLEST_VOLUME_M3:
        raise InputError(
            "mesh.data", INSIDE_OUT, "faces that point outwards: flip them in the program that wrote the mesh"
        )
    if not volume >= SMALLEST_VOLUME_M3:
        raise InputError("mesh.data", f"a volume of {volume:g} m³", "a solid: a volume of 1e-12 m³ or more")
    vertices.flags.writeable = False
    faces.flags.writeable = False
    return Surface(vertices, faces)


def _once(points: FloatArray) -> tuple[FloatArray, IntArray]:
    """Points (m, 3), each once, in the order of x, y, z; and which of them each of `points` (3 f, 3) is, as triangles
    (f, 3). As `np.unique` gives them, in a quarter of its time."""
    order = np.lexsort(points.T[::-1])
    ordered = points[order]
    new = np.concatenate([[True], (ordered[1:] != ordered[:-1]).any(1)])
    which = np.empty(len(points), dtype=np.int64)
    which[order] = np.cumsum(new) - 1
    return ordered[new], which.reshape(-1, 3)


def volume_of(corners: FloatArray) -> float:
    """Volume (m³) that triangles (f, 3, 3) enclose, by the divergence theorem about their middle."""
    moved = corners - corners.reshape(-1, 3).mean(0)
    return float(np.einsum("fi,fi->", moved[:, 0], np.cross(moved[:, 1], moved[:, 2])) / 6)
