"""Where the carriers of a scene are, links first, then frames, and bounds of the motion of what they carry."""

from __future__ import annotations

import math

from assur.planner.arrays import FloatArray
from assur.planner.compiled import kernel
from assur.planner.kernels.laws import bound_frame, place_frame
from assur.planner.kernels.links import (
    ACCELERATION,
    LINKS,
    V_ANY,
    V_ANY_FAR,
    V_BOX,
    V_FAR,
    V_FLAT,
    V_REACH,
    V,
    bound_links,
    place_links,
)

LEAST_SQUARE = 1e-290
"""Squares below this are near the smallest numbers that there are (no unit)."""


@kernel("void(float64[::1], float64[:, ::1], float64[:, ::1], float64[::1], float64, float64[:, ::1])")
def place_carriers(
    robot: FloatArray, laws: FloatArray, pieces: FloatArray, q: FloatArray, t: float, placed: FloatArray
) -> None:
    """Fills `placed` (L + F, 12) for joints `q` (n,) and time t: position, m, and rotation matrix, row by row.

    NaN for a frame whose law is not known at t, and for links that do not assemble.
    """
    place_links(robot, q, placed)
    links = int(robot[LINKS])
    for f in range(len(laws)):
        place_frame(laws[f], pieces, t, placed, links + f)


@kernel(
    "void(float64[::1], float64[:, ::1], float64[:, ::1], float64, float64,"
    " float64[::1], float64[::1], float64[::1], float64[::1], float64[:, ::1])"
)
def carrier_bounds(
    robot: FloatArray,
    laws: FloatArray,
    pieces: FloatArray,
    t0: float,
    t1: float,
    lower: FloatArray,
    upper: FloatArray,
    rate: FloatArray,
    rate_d: FloatArray,
    bounds: FloatArray,
) -> None:
    """Fills `bounds` (L + F, BOUND_COLUMNS) for the closed interval [t0, t1].

    `lower, upper` (n,), `rate, rate_d` (m,): what `sweep_bounds` says of the joints over it.
    """
    bound_links(robot, lower, upper, rate, rate_d, bounds)
    links = int(robot[LINKS])
    for f in range(len(laws)):
        bound_frame(laws[f], pieces, t0, t1, bounds, links + f)


@kernel("float64(float64[:, ::1], int64, int64, float64, float64, float64, float64, float64, float64)")
def _along(
    bounds: FloatArray,
    k: int,
    o: int,
    reach: float,
    distance: float,
    nx: float,
    ny: float,
    nz: float,
    flat: float,
) -> float:
    """K43 from column o on; `flat` is |n_xy|."""
    known = abs(nx * bounds[k, o + V] + ny * bounds[k, o + V + 1] + nz * bounds[k, o + V + 2])
    box = o + V_BOX
    found = known + abs(nx) * bounds[k, box] + abs(ny) * bounds[k, box + 1] + abs(nz) * bounds[k, box + 2]
    found += bounds[k, o + V_ANY] + bounds[k, o + V_ANY_FAR] * distance
    # no horizontal motion counts along the vertical, and no turning on the axis, even if its bound is infinite
    if flat != 0.0:
        across = bounds[k, o + V_FLAT] + bounds[k, o + V_FAR] * distance
        if reach != 0.0:
            across += bounds[k, o + V_REACH] * reach
        found += flat * across
    return found if found >= 0.0 else math.inf


@kernel("UniTuple(float64, 2)(float64[:, ::1], int64, float64, float64, float64, float64, float64)")
def point_bound(
    bounds: FloatArray, k: int, reach: float, distance: float, nx: float, ny: float, nz: float
) -> tuple[float, float]:
    """Upper bounds of |n·ẋ| and |n·ẍ| over an interval along a unit vector n, for every point x of carrier k (K43).

    The points are within horizontal distance `reach` of the carrier's z axis and within `distance` of its origin, m.
    Infinite for what is not a number, and for a negative reach or distance.
    """
    if not (reach >= 0.0 and distance >= 0.0):
        return math.inf, math.inf
    square = nx * nx + ny * ny
    # the root of a square that is almost nothing has lost its digits
    flat = math.sqrt(square) if square > LEAST_SQUARE else math.hypot(nx, ny)
    speed = _along(bounds, k, 0, reach, distance, nx, ny, nz, flat)
    return speed, _along(bounds, k, ACCELERATION, reach, distance, nx, ny, nz, flat)
