"""Where the carriers of a scene are, links first, then frames, and bounds of the motion of what they carry.

With o the origin of a carrier and R its rotation, a point p that it carries is at o + R p, so that

    n·x'' = n·o'' + (n R'') p,   |n·x'' - middle| ≤ radius                                                  (K43)

for middles and radii of the coordinates of o'' and R'' over an interval; the same holds for the first derivative.
"""

from __future__ import annotations

import math

from assur.planner.arrays import FloatArray
from assur.planner.compiled import kernel
from assur.planner.kernels.jets import BALL, CUBE, Ball, sweep_links
from assur.planner.kernels.laws import place_frame, sweep_frame
from assur.planner.kernels.links import LINKS, place_links
from assur.planner.kernels.solids import CARRIER, CENTRE, DISC, HALF, NORMAL, ROTATION, ROW, TABLE, Normal

CARRIED = f"Tuple(({ROW}, {TABLE}, {TABLE}))"
"""Type of `robot`, `laws` and `side`, all that moves the carriers, in the signatures of kernels."""
Carried = tuple[FloatArray, FloatArray, FloatArray]
"""The same in Python."""
ON_AXIS = 1e-12
"""A disc whose axis is off that of its carrier by no more counts as one about that axis (no unit)."""


@kernel(f"void({CARRIED}, {ROW}, float64, {TABLE})", entry=True)
def place_carriers(carried: Carried, q: FloatArray, t: float, placed: FloatArray) -> None:
    """Fills `placed` (L + F, 12) for joints `q` (n,) and time t: position, m, and rotation matrix, row by row.

    NaN for a frame whose law is not known at t, and for links that do not assemble.
    """
    robot, laws, side = carried
    place_links(robot, q, placed)
    links = int(robot[LINKS])
    for f in range(len(laws)):
        place_frame(laws[f], side, t, placed, links + f)


@kernel(f"void({CARRIED}, float64, float64, {TABLE}, {CUBE}, {CUBE})")
def sweep_carriers(
    carried: Carried, t0: float, t1: float, joints: FloatArray, turns: FloatArray, jets: FloatArray
) -> None:
    """Fills `jets` (L + F, JETS, JET_COLUMNS) for the closed interval [t0, t1], from those of the joints over it.

    `turns` (A, 2, JET_COLUMNS) is room to work in.
    """
    robot, laws, side = carried
    sweep_links(robot, joints, turns, jets)
    links = int(robot[LINKS])
    for f in range(len(laws)):
        sweep_frame(laws[f], side, t0, t1, jets, links + f)


@kernel(f"{BALL}({TABLE}, {CUBE}, int64, int64, {NORMAL})")
def derivative(bodies: FloatArray, jets: FloatArray, i: int, order: int, normal: Normal) -> Ball:
    """What the derivative of that order (1 or 2) of n·x may be over an interval, for all points x of unit i (K43).

    A hull counts as the box around it. What keeps its shape adds nothing: a ball, and a disc about the axis of its
    carrier while that axis keeps its direction. The radius is infinite where nothing is known.
    """
    at, o, r = jets[int(bodies[i, CARRIER])], 2 * order, 2 * order + 1
    nx, ny, nz = normal
    ax, ay, az = abs(nx), abs(ny), abs(nz)
    u, v, w = (
        nx * at[3, o] + ny * at[4, o] + nz * at[5, o],
        nx * at[6, o] + ny * at[7, o] + nz * at[8, o],
        nx * at[9, o] + ny * at[10, o] + nz * at[11, o],
    )
    ru, rv, rw = (
        ax * at[3, r] + ay * at[4, r] + az * at[5, r],
        ax * at[6, r] + ay * at[7, r] + az * at[8, r],
        ax * at[9, r] + ay * at[10, r] + az * at[11, r],
    )
    x, y, z = bodies[i, CENTRE], bodies[i, CENTRE + 1], bodies[i, CENTRE + 2]
    middle = nx * at[0, o] + ny * at[1, o] + nz * at[2, o] + u * x + v * y + w * z
    radius = ax * at[0, r] + ay * at[1, r] + az * at[2, r] + ru * abs(x) + rv * abs(y) + rw * abs(z)
    for j in range(3):
        half = bodies[i, HALF + j]
        if half > 0.0:
            a, b, c = bodies[i, ROTATION + j], bodies[i, ROTATION + 3 + j], bodies[i, ROTATION + 6 + j]
            radius += half * (abs(u * a + v * b + w * c) + ru * abs(a) + rv * abs(b) + rw * abs(c))
    if bodies[i, DISC] > 0.0:
        level = max(abs(bodies[i, ROTATION + 2]), abs(bodies[i, ROTATION + 5])) <= ON_AXIS
        turns = abs(at[9, o]) + at[9, r] + abs(at[10, o]) + at[10, r] + abs(at[11, o]) + at[11, r]
        if not (level and turns == 0.0):
            p, q, s = abs(u) + ru, abs(v) + rv, abs(w) + rw
            radius += bodies[i, DISC] * math.sqrt(p * p + q * q + s * s)
    if not (at[0, 1] < math.inf and radius < math.inf and abs(middle) < math.inf):
        return 0.0, math.inf
    return middle, radius
