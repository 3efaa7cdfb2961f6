"""The cubic spline through poses."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose

WHOLE_TURN_RAD = 1e-12
"""By how much the yaw of a period may miss whole turns, rad: rounding of an angle written in degrees."""


def whole_turns(poses: Sequence[Pose]) -> float:
    """By how much the yaw goes on from the first pose to the last, rad: exact whole turns.

    Raises `InputError` unless the last pose is the first again.
    """
    first, last = poses[0], poses[-1]
    field, allowed = f"keyframes.points[{len(poses) - 1}]", "that of the first point, for the sequence repeats"
    if (last.x, last.y, last.z) != (first.x, first.y, first.z):
        raise InputError(f"{field}.at", last.position.tolist(), allowed)
    turn = math.tau * round((last.yaw - first.yaw) / math.tau)
    if not abs(last.yaw - first.yaw - turn) <= WHOLE_TURN_RAD:
        raise InputError(f"{field}.yaw", last.yaw, f"{allowed}, but for whole turns")
    return turn


def spline(knots: FloatArray, values: FloatArray, ends: str, turn: float) -> FloatArray:
    """Coefficients (K-1, 4, 4), powers of the time since a knot by coordinates, of the C² cubic spline through `values`
    (K, 4). One that repeats has a yaw that goes on by `turn` in a period: a line and what is periodic; a cubic spline
    reproduces lines."""
    # imported here: most scenes have no keyframes, and the web process loads every law
    from scipy.interpolate import CubicSpline

    around, rate = values.copy(), 0.0
    if ends == "periodic":
        rate = turn / knots[-1]
        around[:, 3] -= rate * knots
        around[-1] = around[0]
    pieces: FloatArray = np.ascontiguousarray(CubicSpline(knots, around, bc_type=ends).c[::-1].transpose(1, 0, 2))
    pieces[:, 0], pieces[:, 1, 3] = values[:-1], pieces[:, 1, 3] + rate
    return pieces
