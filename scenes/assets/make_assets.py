"""Makes the shipped meshes, always the same bytes: ``python -m assur.scenes.assets.make_assets [FOLDER]``.

All in millimetres, binary STL. The origin of each is the middle of its bounding box across, and half its height up, so
that a part of 20 mm height rests on a plane at z = 0 with its frame at z = 10.

bracket   an angle of 60 x 40 x 20 mm that lies on its side: arms of 60 and 40 mm, 12 mm wide
housing   a box of 120 x 90 x 70 mm with a cavity of 96 x 66 x 46 mm, closed all round
flange    a ring of 90 mm outside, 50 mm inside, 14 mm high
tray      an open box of 200 x 150 x 60 mm with walls and floor of 6 mm
"""

from __future__ import annotations

import struct
import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Corners = NDArray[np.float64]
"""Triangles (f, 3, 3), mm, outward by the right-hand rule."""

SIDES = 48
"""Sides of a circle."""


def prism(outline: list[tuple[float, float]], triangles: list[tuple[int, int, int]], height: float) -> Corners:
    """An outline (anticlockwise) with its triangulation, raised by `height` about z = 0."""
    flat = np.array(outline)
    low = np.column_stack([flat, np.full(len(flat), -height / 2)])
    high = low + np.array([0.0, 0.0, height])
    found = [high[list(t)] for t in triangles] + [low[list(t)[::-1]] for t in triangles]
    for i in range(len(flat)):
        j = (i + 1) % len(flat)
        found += [np.array([low[i], low[j], high[j]]), np.array([low[i], high[j], high[i]])]
    return np.array(found)


def box(size: tuple[float, float, float]) -> Corners:
    """A box about the origin."""
    x, y = size[0] / 2, size[1] / 2
    return prism([(-x, -y), (x, -y), (x, y), (-x, y)], [(0, 1, 2), (0, 2, 3)], size[2])


def bracket() -> Corners:
    """The angle."""
    outline = [(-30.0, -20.0), (30.0, -20.0), (30.0, -8.0), (-18.0, -8.0), (-18.0, 20.0), (-30.0, 20.0)]
    return prism(outline, [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)], 20.0)


def housing() -> Corners:
    """The box with a cavity: the inner surface looks inwards."""
    return np.concatenate([box((120.0, 90.0, 70.0)), box((96.0, 66.0, 46.0))[:, ::-1]])


def flange() -> Corners:
    """The ring."""
    angles = 2 * np.pi * np.arange(SIDES) / SIDES
    circle = np.round(np.column_stack([np.cos(angles), np.sin(angles)]), 12)
    up = np.array([0.0, 0.0, 7.0])
    outer = np.column_stack([45.0 * circle, np.zeros(SIDES)])
    inner = np.column_stack([25.0 * circle, np.zeros(SIDES)])
    found = []
    for i in range(SIDES):
        j = (i + 1) % SIDES
        o, p, q, r = outer[i], outer[j], inner[i], inner[j]
        for quad in (
            (o - up, p - up, p + up, o + up),
            (r - up, q - up, q + up, r + up),
            (q + up, o + up, p + up, r + up),
            (o - up, q - up, r - up, p - up),
        ):
            found += [np.array(quad)[[0, 1, 2]], np.array(quad)[[0, 2, 3]]]
    return np.array(found)


def tray() -> Corners:
    """The open box."""
    x, y, z, w = 100.0, 75.0, 30.0, 6.0
    outer = [(-x, -y), (x, -y), (x, y), (-x, y)]
    inner = [(-x + w, -y + w), (x - w, -y + w), (x - w, y - w), (-x + w, y - w)]
    floor = -z + w
    found = [box((2 * x, 2 * y, 2 * z))[[2, 3, 4, 5, 6, 7, 8, 9, 10, 11]]]
    for i in range(4):
        j = (i + 1) % 4
        a, b = np.array([*outer[i], z]), np.array([*outer[j], z])
        c, d = np.array([*inner[i], z]), np.array([*inner[j], z])
        down = np.array([0.0, 0.0, floor - z])
        found.append(np.array([[a, b, d], [a, d, c], [d, d + down, c], [d + down, c + down, c]]))
    ground = [np.array([*corner, floor]) for corner in inner]
    found.append(np.array([[ground[0], ground[1], ground[2]], [ground[0], ground[2], ground[3]]]))
    return np.concatenate(found)


ASSETS = {"bracket": bracket, "housing": housing, "flange": flange, "tray": tray}


def stl(corners: Corners) -> bytes:
    """Binary STL, little-endian, with unit normals."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    rows = np.zeros(len(corners), dtype=[("n", "<f4", 3), ("v", "<f4", (3, 3)), ("pad", "<u2")])
    rows["n"], rows["v"] = normals + 0.0, corners
    return b"assur asset, millimetres".ljust(80, b"\0") + struct.pack("<I", len(corners)) + rows.tobytes()


def main(folder: Path) -> None:
    """Write every asset below `folder`."""
    for name, make in ASSETS.items():
        (folder / f"{name}.stl").write_bytes(stl(make()))


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
