"""What is enclosed by a closed surface: the winding number of its triangles about a point.

Hulls that cover a surface are hollow together: a body inside touches none of them. With the surface never crossed,
whatever is outside at the start stays outside, so one test of one point of each body decides it (docs/guarantees.md).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray

BLOCK = 1 << 18
"""Triangle-point pairs that are worked on at a time: about 40 MB."""
ENCLOSED = 0.05
"""Winding number from which on a point counts as enclosed. Off the surface it is a whole number to 1e-10, so any share
would do; a small one counts what is on a face (1/2), on an edge or at all but the sharpest corners as enclosed, too."""


def nothing() -> None:
    """What is called between blocks of work that nobody may end."""


def winding_number(
    surface: tuple[FloatArray, IntArray], points: FloatArray, between: Callable[[], None] = nothing
) -> FloatArray:
    """How often the surface goes round each point (N, 3): (N,); 1 inside, 0 outside, the solid angle over 4π.

    For a triangle seen from the point at a, b, c (van Oosterom and Strackee, 1983; equation S3 in docs/meshes.md):

        tan(Ω/2) = a·(b×c) / (|a||b||c| + (a·b)|c| + (b·c)|a| + (c·a)|b|)

    Arguments: `surface` = vertices (m, 3) in metres and faces (f, 3), closed, outward by the right-hand rule; `points`
    (N, 3) in metres, in the same frame. On the surface: the share of a small ball that is inside (a triangle in whose
    plane the point lies counts nothing). A point that is not finite: NaN. Not checked: that the surface is closed.
    `between` is called before each block of work; what it raises is raised here.
    """
    vertices, faces = surface
    total = np.zeros(len(points))
    step = max(1, BLOCK // max(1, len(points)))
    for first in range(0, len(faces), step):
        between()
        corners = vertices[faces[first : first + step]]
        # coordinates (triangles, N), one by one: several times as fast as rows of three
        a, b, c = ([corners[:, k, i, None] - points[:, i] for i in range(3)] for k in range(3))
        la, lb, lc = (np.sqrt(_dot(v, v)) for v in (a, b, c))
        cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]]
        volume = _dot(a, cross)
        rest = la * lb * lc + _dot(a, b) * lc + _dot(b, c) * la + _dot(c, a) * lb
        total += np.where(volume == 0.0, 0.0, np.arctan2(volume, rest)).sum(0)
    return total / (2 * np.pi)


def _dot(a: list[FloatArray], b: list[FloatArray]) -> FloatArray:
    return np.asarray(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


def inside(
    surface: tuple[FloatArray, IntArray], points: FloatArray, between: Callable[[], None] = nothing
) -> BoolArray:
    """Whether each point (N, 3) is enclosed by the surface, (N,); fail closed: a point that is not finite is inside.

    Points on a face or edge count as enclosed. Arguments as for `winding_number`.
    """
    with np.errstate(invalid="ignore"):
        outside: BoolArray = np.abs(winding_number(surface, points, between)) < ENCLOSED
    return ~outside
