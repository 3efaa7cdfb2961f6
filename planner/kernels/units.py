"""The units of bodies as rows: their shapes, once a scene, and where they are, for each state of attachments.

A unit is a convex piece of a body, or the box around all pieces of a body that is not one primitive. `own` (U,
OWN_COLUMNS) keeps where a unit is in its body.
"""

from __future__ import annotations

import math

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.claim import columns as c
from assur.planner.compiled import kernel
from assur.planner.kernels.solids import (
    BALL,
    BODY,
    CARRIER,
    CENTRE,
    COVER,
    CUBE,
    DISC,
    HALF,
    NUMBERS,
    OPENED,
    PIECE,
    PIECES,
    RADIUS,
    REACH,
    ROTATION,
    ROW,
    TABLE,
    VERTEX,
    VERTICES,
)

AT, AXES, OFFSET = 0, 3, 12
"""Columns of `own`: the unit's centre in its body, its axes, row by row, and where the centre is in the axes of its
shape: of a hull, whose own origin may be anywhere, the middle of the box around it."""
OWN_COLUMNS = 15
GROWN_M = 2e-9
"""By so much a bounding box is longer than what it holds, m: a nanometre at each end, far above rounding."""
ON_AXIS = 1e-12
"""m, or off the vertical: a solid of revolution nearer than this to its carrier's axis is on it; a few roundings."""


@kernel(f"void({TABLE}, int64, {TABLE}, int64, int64, {TABLE})")
def write_hull(corners: FloatArray, first: int, rows: FloatArray, u: int, count: int, own: FloatArray) -> None:
    """Unit u is the hull of `count` > 0 rows of `corners`, which are moved to the middle of the box around them."""
    radius = 0.0
    for k in range(3):
        low = high = corners[first, k]
        for v in range(first + 1, first + count):
            low, high = min(low, corners[v, k]), max(high, corners[v, k])
        own[u, OFFSET + k], rows[u, HALF + k] = (low + high) / 2.0, (high - low) / 2.0
    for v in range(first, first + count):
        square = 0.0
        for k in range(3):
            corners[v, k] -= own[u, OFFSET + k]
            square += corners[v, k] * corners[v, k]
        radius = max(radius, math.sqrt(square))
    rows[u, RADIUS], rows[u, VERTEX], rows[u, VERTICES] = radius, first, count


@kernel(f"float64({TABLE}, {TABLE}, int64, {TABLE}, int64, int64, float64)")
def farthest_along(
    rows: FloatArray, vertices: FloatArray, u: int, own: FloatArray, first: int, axis: int, sign: float
) -> float:
    """How far unit u goes from its centre along an axis, or against it (`sign` −1), with the axes that stand in `own`
    from column `first` on (S1)."""
    a, b, c = own[u, first + 3 * axis], own[u, first + 3 * axis + 1], own[u, first + 3 * axis + 2]
    count = int(rows[u, VERTICES])
    if count == 0:
        found = rows[u, HALF] * abs(a) + rows[u, HALF + 1] * abs(b) + rows[u, HALF + 2] * abs(c)
        return float(found + rows[u, DISC] * math.hypot(a, b) + rows[u, BALL])
    best, vertex = -math.inf, int(rows[u, VERTEX])
    for v in range(vertex, vertex + count):
        best = max(best, sign * (a * vertices[v, 0] + b * vertices[v, 1] + c * vertices[v, 2]))
    return best


@kernel(f"int64({NUMBERS}, {TABLE}, {CUBE}, {TABLE}, {NUMBERS}, {NUMBERS}, {TABLE}, {TABLE}, {TABLE}, {NUMBERS})")
def write_units(
    count: IntArray,
    position: FloatArray,
    rotation: FloatArray,
    core: FloatArray,
    hull: IntArray,
    begins: IntArray,
    vertices: FloatArray,
    rows: FloatArray,
    own: FloatArray,
    roots: IntArray,
) -> int:
    """Fills what does not depend on where bodies are: `rows`, `own`, and `roots` (B,), the first unit of each body.

    Pieces (S,), `count[b]` of body b, in order: `position` (S, 3), `rotation` (S, 3, 3), `core` (S, 5) half edges, disc
    and ball; number of the `hull` or -1, whose rows of `vertices` begin at `begins` (H + 1,). Returns how many units
    there are.
    """
    u, piece = 0, 0
    for b in range(len(count)):
        roots[b], boxed = u, count[b] > 1 or hull[piece] >= 0
        cover = u
        if boxed:
            u += 1
        for k in range(count[b]):
            rows[u, BODY], rows[u, PIECE] = b, k
            for i in range(3):
                own[u, AT + i] = position[piece, i]
                for j in range(3):
                    own[u, AXES + 3 * i + j] = rotation[piece, i, j]
            h = hull[piece]
            if h >= 0:
                write_hull(vertices, begins[h], rows, u, begins[h + 1] - begins[h], own)
                for i in range(3):
                    for j in range(3):
                        own[u, AT + i] += rotation[piece, i, j] * own[u, OFFSET + j]
            else:
                for i in range(5):
                    rows[u, HALF + i] = core[piece, i]
                across = math.hypot(core[piece, 0], core[piece, 1]) + core[piece, 3]
                rows[u, RADIUS] = math.hypot(across, core[piece, 2]) + core[piece, 4]
            u, piece = u + 1, piece + 1
        if not boxed:
            continue
        rows[cover, BODY], rows[cover, PIECE], rows[cover, OPENED], rows[cover, PIECES] = b, COVER, cover + 1, count[b]
        square = 0.0
        for i in range(3):
            low, high = math.inf, -math.inf
            for k in range(cover + 1, u):
                low = min(low, own[k, AT + i] - farthest_along(rows, vertices, k, own, AXES, i, -1.0))
                high = max(high, own[k, AT + i] + farthest_along(rows, vertices, k, own, AXES, i, 1.0))
            own[cover, AT + i], own[cover, AXES + 4 * i] = (low + high) / 2.0, 1.0
            rows[cover, HALF + i] = (high - low + GROWN_M) / 2.0
            square += rows[cover, HALF + i] * rows[cover, HALF + i]
        rows[cover, RADIUS] = math.sqrt(square)
    return u


@kernel(f"float64({TABLE}, {TABLE}, int64)")
def reach_of(rows: FloatArray, vertices: FloatArray, u: int) -> float:
    """A bound, m, of the horizontal distance of unit u's points from the z axis of the frame that carries it (S2).

    A solid of revolution about that very axis looks the same however the frame turns, so it counts as one that does not
    turn: 0.
    """
    x, y = rows[u, CENTRE], rows[u, CENTRE + 1]
    hx, hy, hz = rows[u, HALF], rows[u, HALF + 1], rows[u, HALF + 2]
    upright = max(abs(rows[u, ROTATION + 2]), abs(rows[u, ROTATION + 5])) <= ON_AXIS
    many, first, reach = int(rows[u, VERTICES]), int(rows[u, VERTEX]), 0.0
    thin = many == 0 and hx == 0.0 and hy == 0.0 and (upright or (hz == 0.0 and rows[u, DISC] == 0.0))
    if thin and math.hypot(x, y) <= ON_AXIS:
        return 0.0
    for k in range(many if many > 0 else 8):
        if many > 0:
            a, b, c = vertices[first + k, 0], vertices[first + k, 1], vertices[first + k, 2]
        else:
            a, b, c = hx if k & 1 else -hx, hy if k & 2 else -hy, hz if k & 4 else -hz
        r = ROTATION
        px = x + rows[u, r] * a + rows[u, r + 1] * b + rows[u, r + 2] * c
        py = y + rows[u, r + 3] * a + rows[u, r + 4] * b + rows[u, r + 5] * c
        reach = max(reach, math.hypot(px, py))
    return float(reach + rows[u, DISC] + rows[u, BALL])


@kernel(f"void({TABLE}, {TABLE}, int64, int64, {ROW}, {ROW}, {TABLE}, {TABLE})")
def seat_unit(
    own: FloatArray,
    vertices: FloatArray,
    u: int,
    carrier: int,
    pose: FloatArray,
    at: FloatArray,
    rows: FloatArray,
    boxes: FloatArray,
) -> None:
    """Puts unit u of a body where its `pose` (4,), x, y, z, yaw, in a carrier is, which is `at` (4,) for ever: NaN
    where it moves."""
    co, si = math.cos(pose[3]), math.sin(pose[3])
    rows[u, CARRIER] = carrier
    rows[u, CENTRE] = pose[0] + co * own[u, AT] - si * own[u, AT + 1]
    rows[u, CENTRE + 1] = pose[1] + si * own[u, AT] + co * own[u, AT + 1]
    rows[u, CENTRE + 2] = pose[2] + own[u, AT + 2]
    for j in range(3):
        a, b = own[u, AXES + j], own[u, AXES + 3 + j]
        rows[u, ROTATION + j], rows[u, ROTATION + 3 + j] = co * a - si * b, si * a + co * b
        rows[u, ROTATION + 6 + j] = own[u, AXES + 6 + j]
    rows[u, REACH] = reach_of(rows, vertices, u)
    co, si = math.cos(at[3]), math.sin(at[3])
    for axis in range(3):
        # rows of the axes in the world: those of the carrier's x and y are turned
        one, other, up = (co, -si, 0.0) if axis == 0 else ((si, co, 0.0) if axis == 1 else (0.0, 0.0, 1.0))
        middle = at[axis] + one * rows[u, CENTRE] + other * rows[u, CENTRE + 1] + up * rows[u, CENTRE + 2]
        size, square = rows[u, BALL], 0.0
        for j in range(3):
            along = one * rows[u, ROTATION + j] + other * rows[u, ROTATION + 3 + j] + up * rows[u, ROTATION + 6 + j]
            size += abs(along) * rows[u, HALF + j]
            square += along * along if j < 2 else 0.0
        size += rows[u, DISC] * math.sqrt(square)
        boxes[u, axis], boxes[u, 3 + axis] = middle - size, middle + size


@kernel(f"void({TABLE}, {TABLE}, {NUMBERS}, {TABLE}, {NUMBERS}, int64, {TABLE}, {TABLE}, {TABLE})")
def seat_bodies(
    own: FloatArray,
    vertices: FloatArray,
    roots: IntArray,
    seats: FloatArray,
    chosen: IntArray,
    links: int,
    places: FloatArray,
    rows: FloatArray,
    boxes: FloatArray,
) -> None:
    """Puts the units of the `chosen` bodies on their seats (B, c.SEAT).

    `links`: how many carriers are links; `places` (K, 4): the poses of carriers that stand still, NaN for the others;
    `boxes` (U, 6): what stands still, in the world.
    """
    for number in range(len(chosen)):
        b = chosen[number]
        seat = seats[b]
        carrier = int(seat[c.SEAT_LINK]) if seat[c.SEAT_LINK] >= 0.0 else links + int(seat[c.SEAT_FRAME])
        end = roots[b + 1] if b + 1 < len(roots) else len(rows)
        for u in range(roots[b], end):
            seat_unit(own, vertices, u, carrier, seat[c.SEAT_POSE :], places[carrier], rows, boxes)
