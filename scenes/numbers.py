"""Numbers of an answer: what a plan depends on is finite, what only informs may be missing."""

from __future__ import annotations

import math

from assur.planner.errors import FaultError


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
