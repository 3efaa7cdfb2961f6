"""Numbers of an answer: what a plan depends on is finite, what only informs may be missing; and what counts as rest."""

from __future__ import annotations

import math
from typing import Any

from assur.planner.errors import FaultError

RESTING = 1e-9
"""A joint's velocity in rad/s or m/s up to which it is at rest, and a time in s up to which a knot is that of an
arrival: rounding of what is written down."""


def at_rest(trajectory: dict[str, Any], time_s: float) -> bool:
    """Whether all joints of a trajectory, a part of an answer, stand at the knots of a time, s."""
    knots = zip(trajectory["time_s"], trajectory["velocity"], strict=True)
    there = (rates for time, rates in knots if abs(time - time_s) <= RESTING)
    return any(all(abs(rate) <= RESTING for rate in rates) for rates in there)


def number(value: float) -> float:
    """A number that a plan depends on. Raises `FaultError` if it is none."""
    if not math.isfinite(value):
        raise FaultError("an answer holds a number that is not finite")
    return float(value)


def optional(value: float | None) -> float | None:
    """A number that only informs: null where there is none."""
    return float(value) if value is not None and math.isfinite(value) else None


def interval(value: tuple[float, float] | None) -> list[float | None] | None:
    """Two ends, or null."""
    return None if value is None else [optional(x) for x in value]
