"""What is enclosed by a closed surface: the winding number of its triangles about a point.

Hulls that cover a surface are hollow together: a body inside touches none of them. With the surface never crossed,
whatever is outside at the start stays outside, so one point of each body, asked once, settles it (docs/guarantees.md).
"""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray

BLOCK = 1 << 18
"""Triangle-point pairs that are worked on at a time: about 40 MB."""
ENCLOSED = 0.05
"""Winding number from which on a point counts as enclosed. Off the surface it is a whole number to 1e-10, so any share
would do; a small one counts what is on a face (1/2), on an edge or at all but the sharpest corners as enclosed, too."""


def winding_number(surface: tuple[FloatArray, IntArray], points: FloatArray) -> FloatArray:
    """How often the surface goes round each point (N, 3): (N,); 1 inside, 0 outside, the solid angle over 4π.

    For a triangle seen from the point at a, b, c (van Oosterom and Strackee, 1983; equation S3 in docs/meshes.md):

        tan(Ω/2) = a·(b×c) / (|a||b||c| + (a·b)|c| + (b·c)|a| + (c·a)|b|)

    Arguments: `surface` = vertices (m, 3) in metres and faces (f, 3), closed, outward by the right-hand rule; `points`
    (N, 3) in metres, in the same frame. On the surface: the share of a small ball that is inside (a triangle in whose
    plane the point lies counts nothing). A point that is not finite: NaN. Not checked: that the surface is closed.
    """
    vertices, faces = surface
    corners = vertices[faces]
    total = np.zeros(len(points))
    step = max(1, BLOCK // max(1, len(points)))
    for first in range(0, len(corners), step):
        a, b, c = (corners[first : first + step, k][:, None] - points for k in range(3))
        la, lb, lc = (np.sqrt((v * v).sum(-1)) for v in (a, b, c))
        volume = (a * np.cross(b, c)).sum(-1)
        rest = la * lb * lc + (a * b).sum(-1) * lc + (b * c).sum(-1) * la + (c * a).sum(-1) * lb
        total += np.where(volume == 0.0, 0.0, np.arctan2(volume, rest)).sum(0)
    return total / (2 * np.pi)


def inside(surface: tuple[FloatArray, IntArray], points: FloatArray) -> BoolArray:
    """Whether each point (N, 3) is enclosed by the surface, (N,); fail closed: a point that is not finite is inside.

    Points on a face or edge count as enclosed. Arguments as for `winding_number`.
    """
    with np.errstate(invalid="ignore"):
        outside: BoolArray = np.abs(winding_number(surface, points)) < ENCLOSED
    return ~outside
