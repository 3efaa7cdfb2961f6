"""Closed surfaces for the tests of meshes, and what is known of them."""

from __future__ import annotations

import struct

import numpy as np

from assur.planner.arrays import FloatArray
from assur.scenes.assets.make_assets import bracket, flange, housing, prism, stl, tray
from assur.scenes.meshes.surface import Surface, closed_surface

MM = 1e-3


def surface(corners: FloatArray, turn: float = 0.0, tilt: float = 0.0, scale: float = MM) -> Surface:
    """The surface of triangles in mm, turned about z and then about x."""
    c, s = np.cos(turn), np.sin(turn)
    about_z = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    c, s = np.cos(tilt), np.sin(tilt)
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
    if turn or tilt:
        vertices, inverse = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
        corners = (vertices @ about_z.T @ about_x.T)[inverse].reshape(-1, 3, 3)
    return closed_surface(corners, scale)


def star(points: int, outer: float = 50.0, inner: float = 20.0, height: float = 30.0) -> FloatArray:
    """A star-shaped prism: as many concave edges as points, mm."""
    angles = np.pi * np.arange(2 * points) / points
    radii = np.where(np.arange(2 * points) % 2 == 0, outer, inner)
    ring = [(0.0, 0.0), *zip((radii * np.cos(angles)).tolist(), (radii * np.sin(angles)).tolist(), strict=True)]
    count = 2 * points
    fan = [(0, 1 + i, 1 + (i + 1) % count) for i in range(count)]
    walls = prism(ring, fan, height)
    # prism() closes the outline from the centre too; the walls that touch the centre are not part of a star.
    at_centre = (np.abs(walls[:, :, :2]).max(axis=2) < 1e-9).sum(1) >= 1
    upright = np.ptp(walls[:, :, 2], axis=1) > 0
    closing = np.array([[ring[count], ring[1]]])
    low = np.concatenate([closing[0], np.full((2, 1), -height / 2)], axis=1)
    high = low + np.array([0.0, 0.0, height])
    last = np.array([[low[0], low[1], high[1]], [low[0], high[1], high[0]]])
    return np.concatenate([walls[~(at_centre & upright)], last])


def torus(major: int = 24, minor: int = 12, radius: float = 100.0, tube: float = 30.0) -> FloatArray:
    """A torus about z, mm."""
    u = 2 * np.pi * np.arange(major) / major
    v = 2 * np.pi * np.arange(minor) / minor
    ring = radius + tube * np.cos(v)
    points = np.stack(
        [np.outer(np.cos(u), ring), np.outer(np.sin(u), ring), np.broadcast_to(tube * np.sin(v), (major, minor))], -1
    )
    i, j = (x.ravel() for x in np.indices((major, minor)))
    k, m = (i + 1) % major, (j + 1) % minor
    a, b, c, d = points[i, j], points[k, j], points[k, m], points[i, m]
    return np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])


SOLIDS = {
    "bracket": bracket(),
    "housing": housing(),
    "flange": flange(),
    "tray": tray(),
    "star": star(5),
    "torus": torus(),
}
"""Solids that are not convex, mm."""

CUBE = prism([(-50.0, -50.0), (50.0, -50.0), (50.0, 50.0), (-50.0, 50.0)], [(0, 1, 2), (0, 2, 3)], 100.0)
"""A cube of 100 mm."""


def on_triangles(corners: FloatArray, count: int, seed: int) -> FloatArray:
    """Points spread over triangles (f, 3, 3): all corners, all middles of edges, and `count` more at random."""
    rng = np.random.default_rng(seed)
    weights = rng.dirichlet([1.0, 1.0, 1.0], count)
    some = np.einsum("nk,nki->ni", weights, corners[rng.integers(0, len(corners), count)])
    middles = (corners + np.roll(corners, 1, axis=1)) / 2
    return np.concatenate([corners.reshape(-1, 3), middles.reshape(-1, 3), some])


def binary_stl(corners: FloatArray) -> bytes:
    """An STL file by a second way than that of the assets."""
    rows = (struct.pack("<12fH", 0.0, 0.0, 1.0, *triangle.ravel(), 0) for triangle in corners)
    return b"\0" * 80 + struct.pack("<I", len(corners)) + b"".join(rows)


__all__ = ["CUBE", "MM", "SOLIDS", "binary_stl", "on_triangles", "star", "stl", "surface", "torus"]
