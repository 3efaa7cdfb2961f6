"""Triangles (k, 3, 3) of closed surfaces, m, outward."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.scenes.assets.make_assets import box, prism

Point = tuple[float, float, float]


def moved(triangles: FloatArray, by: Point) -> FloatArray:
    """The same elsewhere."""
    return np.asarray(triangles + np.array(by))


def block(low: Point, high: Point) -> FloatArray:
    """A box between two corners."""
    (x, y, z), (u, v, w) = low, high
    return moved(box((u - x, v - y, w - z)), ((u + x) / 2, (v + y) / 2, (w + z) / 2))


def three_walls(half: float, wall: float, low: float, high: float) -> FloatArray:
    """A fence round the vertical axis, so far from it, open towards +y."""
    a, w = half, half - wall
    outline = [(-a, -a), (a, -a), (a, a), (w, a), (w, -w), (-w, -w), (-w, a), (-a, a)]
    cap = [(0, 1, 4), (0, 4, 5), (1, 2, 3), (1, 3, 4), (0, 5, 6), (0, 6, 7)]
    return moved(prism(outline, cap, high - low), (0.0, 0.0, (high + low) / 2))


def inwards(triangles: FloatArray) -> FloatArray:
    """The same surface, seen from its other side: that of a cavity."""
    return np.asarray(triangles[:, ::-1])


def together(*parts: FloatArray) -> FloatArray:
    """Several surfaces as one."""
    return np.concatenate(parts)


def open_below(triangles: FloatArray) -> FloatArray:
    """What is open towards +y is turned about x, so that it is open towards -z: a fence becomes a portal."""
    return np.asarray(triangles @ np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]))
