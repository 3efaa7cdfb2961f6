"""The units of bodies as rows: their shapes, once a scene, and where they are, for each set of seats.

A unit is a convex piece of a body, or the box around all pieces of a body that is not one primitive. `own` (U, COLUMNS)
has them in the axes of their bodies: the carrier of such a row is the number of the body.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.claim import columns as c
from assur.planner.compiled import kernel
from assur.planner.kernels.links import POSE_COLUMNS, put_upright
from assur.planner.kernels.solids import (
    BODY,
    CARRIER,
    CENTRE,
    COVER,
    CUBE,
    HALF,
    NUMBERS,
    OPENED,
    PIECE,
    PIECES,
    RADIUS,
    ROTATION,
    TABLE,
    UNITS,
    VERTEX,
    VERTICES,
    Units,
    place,
    unit_support,
)

GROWN_M = 2e-9
"""By so much a bounding box is longer than what it holds, m: a nanometre at each end, far above rounding."""


@kernel(f"void({TABLE}, int64, {TABLE}, int64, int64, {TABLE})")
def write_hull(corners: FloatArray, first: int, rows: FloatArray, u: int, count: int, offset: FloatArray) -> None:
    """Unit u, whose axes and origin are known, is the hull of `count` > 0 rows of `corners`: they and its centre are
    moved to the middle of the box around them, which `offset` (U, 3) takes."""
    radius = 0.0
    for k in range(3):
        low = high = corners[first, k]
        for v in range(first + 1, first + count):
            low, high = min(low, corners[v, k]), max(high, corners[v, k])
        offset[u, k], rows[u, HALF + k] = (low + high) / 2.0, (high - low) / 2.0
    for v in range(first, first + count):
        square = 0.0
        for k in range(3):
            corners[v, k] -= offset[u, k]
            square += corners[v, k] * corners[v, k]
        radius = max(radius, math.sqrt(square))
    rows[u, RADIUS], rows[u, VERTEX], rows[u, VERTICES] = radius, first, count
    for i in range(3):
        for j in range(3):
            rows[u, CENTRE + i] += rows[u, ROTATION + 3 * i + j] * offset[u, j]


@kernel(f"void({UNITS}, int64, {TABLE}, int64)")
def write_box(units: Units, u: int, boxes: FloatArray, b: int) -> None:
    """Row b of `boxes` (..., 6) becomes the least and the greatest coordinates of unit u at the only instant."""
    centre = units[2][0, u]
    for axis in range(3):
        x, y, z = 1.0 if axis == 0 else 0.0, 1.0 if axis == 1 else 0.0, 1.0 if axis == 2 else 0.0
        boxes[b, axis] = centre[axis] - unit_support(units, 0, u, (-x, -y, -z))
        boxes[b, 3 + axis] = centre[axis] + unit_support(units, 0, u, (x, y, z))


@kernel(
    f"int64({NUMBERS}, {TABLE}, {CUBE}, {TABLE}, {NUMBERS}, {NUMBERS}, {TABLE}, {TABLE}, {TABLE}, {NUMBERS})",
    allocates=True,
)
def write_units(
    count: IntArray,
    position: FloatArray,
    rotation: FloatArray,
    core: FloatArray,
    hull: IntArray,
    begins: IntArray,
    vertices: FloatArray,
    own: FloatArray,
    offset: FloatArray,
    roots: IntArray,
) -> int:
    """Fills what does not depend on where bodies are: `own`, `offset` (U, 3), where the centre of a unit is in the axes
    of its shape, and `roots` (B,), the first unit of each body.

    Pieces (S,), `count[b]` of body b, in order: `position` (S, 3), `rotation` (S, 3, 3), `core` (S, 5) half edges, disc
    and ball; number of the `hull` or -1, whose rows of `vertices` begin at `begins` (H + 1,). Returns how many units
    there are.
    """
    u, piece, box = 0, 0, np.empty((1, 6))
    placed = np.empty((1, len(own), POSE_COLUMNS))
    for b in range(len(count)):
        cover, boxed = u, count[b] > 1 or hull[piece] >= 0
        roots[b], low, high = cover, np.full(3, math.inf), np.full(3, -math.inf)
        if boxed:
            u += 1
        for k in range(count[b]):
            own[u, CARRIER], own[u, BODY], own[u, PIECE] = b, b, k
            for i in range(3):
                own[u, CENTRE + i] = position[piece, i]
                for j in range(3):
                    own[u, ROTATION + 3 * i + j] = rotation[piece, i, j]
            h = hull[piece]
            if h >= 0:
                write_hull(vertices, begins[h], own, u, begins[h + 1] - begins[h], offset)
            else:
                for i in range(5):
                    own[u, HALF + i] = core[piece, i]
                across = math.hypot(core[piece, 0], core[piece, 1]) + core[piece, 3]
                own[u, RADIUS] = math.hypot(across, core[piece, 2]) + core[piece, 4]
            for i in range(POSE_COLUMNS):
                placed[0, u, i] = own[u, CENTRE + i]
            write_box((own, vertices, placed), u, box, 0)
            for i in range(3):
                low[i], high[i] = min(low[i], box[0, i]), max(high[i], box[0, 3 + i])
            u, piece = u + 1, piece + 1
        if not boxed:
            continue
        own[cover, CARRIER], own[cover, BODY], own[cover, PIECE] = b, b, COVER
        own[cover, OPENED], own[cover, PIECES], square = cover + 1, count[b], 0.0
        for i in range(3):
            own[cover, CENTRE + i], own[cover, ROTATION + 4 * i] = (low[i] + high[i]) / 2.0, 1.0
            own[cover, HALF + i] = (high[i] - low[i] + GROWN_M) / 2.0
            square += own[cover, HALF + i] * own[cover, HALF + i]
        own[cover, RADIUS] = math.sqrt(square)
    return u


@kernel(f"void({TABLE}, {TABLE}, {NUMBERS}, {TABLE}, {NUMBERS}, int64, {TABLE}, {TABLE}, {TABLE})", allocates=True)
def seat_bodies(
    own: FloatArray,
    vertices: FloatArray,
    roots: IntArray,
    seats: FloatArray,
    chosen: IntArray,
    links: int,
    carriers: FloatArray,
    rows: FloatArray,
    boxes: FloatArray,
) -> None:
    """Puts the units of the `chosen` bodies on their seats (B, c.SEAT), into `rows` (U, COLUMNS).

    `links`: how many carriers are links; `carriers` (K, 12): the places of those that stand still, NaN for the others;
    `boxes` (U, 6): what stands still, in the world.
    """
    seated, placed = np.empty((len(seats), POSE_COLUMNS)), np.empty((1, len(rows), POSE_COLUMNS))
    for number in range(len(chosen)):
        b = chosen[number]
        link, frame, pose = int(seats[b, c.SEAT_LINK]), int(seats[b, c.SEAT_FRAME]), seats[b, c.SEAT_POSE :]
        put_upright(seated, b, pose[0], pose[1], pose[2], math.cos(pose[3]), math.sin(pose[3]))
        for u in range(roots[b], roots[b + 1] if b + 1 < len(roots) else len(rows)):
            place(own, u, seated, placed, 0)
            for i in range(POSE_COLUMNS):
                rows[u, CENTRE + i] = placed[0, u, i]
            rows[u, CARRIER] = link if link >= 0 else links + frame
            place(rows, u, carriers, placed, 0)
            write_box((rows, vertices, placed), u, boxes, u)
