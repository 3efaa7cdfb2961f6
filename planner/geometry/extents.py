"""How far the points of solids are from the axis, and from the origin, of the frames that carry them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.geometry.shapes import Hull, Primitive

ON_AXIS = 1e-12
"""m, or off the vertical: a solid of revolution nearer than this to its carrier's axis is on it; a few roundings."""
_SIGNS = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])


def extents(shapes: Sequence[Primitive | Hull], centre: FloatArray, axes: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Bounds, m, of the horizontal distance of each solid's points from the z axis of the frame that carries it (U,)
    (equation S2), and of their distance from its origin (U,) (S4).

    `centre` (U, 3), `axes` (U, 3, 3): the solids in their frames. A solid of revolution about that very axis looks the
    same however the frame turns, so it counts as one that does not turn: 0. A ball looks the same however the frame
    turns and tilts, so for the second its points count as its centre does.
    """
    hulls = {k: shape.vertices for k, shape in enumerate(shapes) if isinstance(shape, Hull)}
    terms = [(0.0,) * 5 if isinstance(shape, Hull) else (*shape.half, shape.disc, shape.ball) for shape in shapes]
    core = np.array(terms).reshape(-1, 5)
    return extents_of(core[:, :3], core[:, 3], core[:, 4], hulls, centre, axes)


def extents_of(
    half: FloatArray,
    disc: FloatArray,
    ball: FloatArray,
    hulls: Mapping[int, FloatArray],
    centre: FloatArray,
    axes: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """`extents` of solids by the terms of their support function (S1), `half` (U, 3), `disc` and `ball` (U,), but for
    `hulls`: by their numbers, their vertices (m, 3)."""
    points = centre[:, None] + (_SIGNS * half[:, None]) @ axes.transpose(0, 2, 1)
    reach, distance = _farthest(points)
    reach, distance = reach + disc + ball, distance + disc + ball
    primitive = np.ones(len(half), dtype=bool)
    for k, vertices in hulls.items():
        reach[k], distance[k] = (x[0] for x in _farthest((centre[k] + vertices @ axes[k].T)[None]))
        primitive[k] = False
    core = (half == 0.0) & primitive[:, None]
    ball_like = core.all(1) & (disc == 0.0)
    upright = ball_like | (np.abs(axes[:, :2, 2]).max(1) <= ON_AXIS)
    on_axis = np.hypot(centre[:, 0], centre[:, 1]) <= ON_AXIS
    reach[core[:, :2].all(1) & upright & on_axis] = 0.0
    distance[ball_like] = np.sqrt((centre[ball_like] ** 2).sum(1))
    return reach, distance


def _farthest(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Greatest distance of points (U, m, 3) from the z axis and from the origin, each (U,)."""
    return np.hypot(points[..., 0], points[..., 1]).max(1), np.sqrt((points * points).sum(-1)).max(1)
