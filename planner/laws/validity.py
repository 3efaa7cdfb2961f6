"""Where a law may be known, and what its numbers may be."""

from __future__ import annotations

import math

from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose

ALWAYS = (-math.inf, math.inf)
"""The validity of a law that is known for all times."""
FURTHEST_S = 1e6
"""No law is known further than this from time zero, s (11 days): a float there still resolves 0.2 ns. Seconds since
1970 would not do: they resolve 0.2 µs only, too coarse for knots that are 10 µs apart."""
LARGEST = 1e6
"""Largest magnitude, in SI units, of a length, speed, acceleration or angle of a law: above it a unit was mistaken."""
SHORTEST_S = 1e-3
"""Shortest period, move or step between keyframes, s: below it a unit was mistaken."""

RANGES = {
    "at_time": (-FURTHEST_S, FURTHEST_S),
    "start": (-FURTHEST_S, FURTHEST_S),
    "dwell_s": (0.0, FURTHEST_S),
    "move_s": (SHORTEST_S, FURTHEST_S),
    "period": (SHORTEST_S, FURTHEST_S),
}
"""Least and greatest number, where it is not `LARGEST` to either side."""


def float_in(value: float, field: str, least: float = -LARGEST, most: float = LARGEST) -> float:
    """`value` as a float from `least` to `most`. Raises `InputError` naming `field` (for NaN and non-numbers too)."""
    try:
        result = float(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(field, value, f"a number from {least:g} to {most:g}") from error
    if not least <= result <= most:
        raise InputError(field, value, f"a number from {least:g} to {most:g}")
    return result


def placed(pose: Pose, field: str) -> Pose:
    """`pose`, each coordinate a number of allowed size. Raises `InputError` naming the coordinate."""
    return Pose(*[float_in(getattr(pose, name), f"{field}.{name}") for name in ("x", "y", "z", "yaw")])


def interval(valid: tuple[float, float], field: str) -> tuple[float, float]:
    """`valid` as two floats, the first below the second; either may be infinite. Raises `InputError`."""
    wanted = "two times, the first below the second"
    try:
        first, last = map(float, valid)
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(field, valid, wanted) from error
    if not (first < last and first < FURTHEST_S and last > -FURTHEST_S):
        raise InputError(field, valid, wanted)
    return first, last
