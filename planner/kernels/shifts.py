"""A pair whose second unit may be ahead of the clock: the first at t, the second at t + s, over intervals of both.

The robot may start late by s: then all else is further on by s while it moves. For points x, y of the two the distance
along n is f(t, s) = n·(y(t + s) − x(t)). Over t it bends by both accelerations at most, over s by the second alone, so
C2 and C3 bound it over t at both ends of s, and then over s (C8).
"""

from __future__ import annotations

from assur.planner.arrays import FloatArray
from assur.planner.compiled import kernel
from assur.planner.kernels.intervals import between, unit_bound
from assur.planner.kernels.laws import bound_frame, place_frame
from assur.planner.kernels.solids import CARRIER, CUBE, NORMAL, TABLE, gap, place

MOMENTS, MIDDLE = 5, 4
"""Instants at which a shifted pair is placed: t0 and t1 with the first shift, then with the last one; the middle."""
Shifted = tuple[FloatArray, FloatArray, FloatArray, FloatArray]
"""Carriers (MOMENTS, K, 12) and units (MOMENTS, U, 12), bounds of the frames' motion over all of it (K, BOUND_COLUMNS),
and what of each carrier is known, (K, 3): number of the interval and both shifts."""
SHIFTED = f"Tuple(({CUBE}, {CUBE}, {TABLE}, {TABLE}))"


@kernel(f"void({TABLE}, {TABLE}, {TABLE}, int64, int64, {CUBE}, int64, int64, float64[::1], {SHIFTED})")
def place_shifted(
    laws: FloatArray,
    side: FloatArray,
    bodies: FloatArray,
    links: int,
    number: int,
    placed: FloatArray,
    a: int,
    b: int,
    span: FloatArray,
    shifted: Shifted,
) -> None:
    """Places units a and b of one item: the first where `placed` (3, U, 12) has it, the second ahead of the clock.

    `span` (4,): begin and end of interval number `number`, and of the shift, s. The second is carried by a frame.
    """
    carriers, both, bounds, known = shifted
    k, t0, t1, s0, s1 = int(bodies[b, CARRIER]), span[0], span[1], span[2], span[3]
    if not (known[k, 0] == number and known[k, 1] == s0 and known[k, 2] == s1):
        known[k, 0], known[k, 1], known[k, 2] = number, s0, s1
        for m in range(MOMENTS):
            t, s = (t0 if m % 2 == 0 else t1), (s0 if m < 2 else s1)
            if m == MIDDLE:
                t, s = 0.5 * (t0 + t1), 0.5 * (s0 + s1)
            place_frame(laws[k - links], side, t + s, carriers[m], k)
        bound_frame(laws[k - links], side, t0 + s0, t1 + s1, bounds, k)
    for m in range(MOMENTS):
        place(bodies, b, carriers[m], both, m)
        moment = 1 if m == MIDDLE else 2 * (m % 2)
        for i in range(both.shape[2]):
            both[m, a, i] = placed[moment, a, i]


@kernel(f"UniTuple(float64, 3)({TABLE}, {TABLE}, {CUBE}, {TABLE}, {TABLE}, int64, int64, {NORMAL}, float64, float64)")
def least_shifted(
    bodies: FloatArray,
    vertices: FloatArray,
    both: FloatArray,
    bounds: FloatArray,
    ahead: FloatArray,
    a: int,
    b: int,
    nx: float,
    ny: float,
    nz: float,
    h: float,
    d: float,
) -> tuple[float, float, float]:
    """A lower bound of the gap along n over an interval of length h and a shift of length d (C8); and what is lost to
    both lengths at most."""
    speed_a, acceleration_a = unit_bound(bodies, bounds, a, nx, ny, nz)
    speed_b, acceleration_b = unit_bound(bodies, ahead, b, nx, ny, nz)
    speed, acceleration = speed_a + speed_b, acceleration_a + acceleration_b
    first = between(
        gap(bodies, vertices, both, 0, a, b, nx, ny, nz), gap(bodies, vertices, both, 1, a, b, nx, ny, nz),
        speed, acceleration, h,
    )  # fmt: skip
    last = between(
        gap(bodies, vertices, both, 2, a, b, nx, ny, nz), gap(bodies, vertices, both, 3, a, b, nx, ny, nz),
        speed, acceleration, h,
    )  # fmt: skip
    found = between(first, last, speed_b, acceleration_b, d)
    over_time = min(0.5 * speed * h, acceleration * h * h / 8.0)
    over_shift = min(0.5 * speed_b * d, acceleration_b * d * d / 8.0)
    return found, over_time, over_shift
