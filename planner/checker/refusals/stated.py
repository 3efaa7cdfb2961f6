"""Whether a refusal states what was shown: the checker makes the refusal itself, and compares all that both state."""

from __future__ import annotations

import math
from dataclasses import fields
from typing import NamedTuple

from assur.planner.model.refusal import Facts, Refusal

SAME = 1e-9
"""Two numbers that differ by no more than this share of them, or this, are the same: sums of a few terms."""
OPTIONAL = frozenset({"mode", "from_axis_m", "heights_m", "pitch_rad", "path_m", "path_part", "path_at_m"})
"""Facts that a refusal may leave out (None)."""
ANGLES = frozenset({"yaw_rad"})
"""Facts whose full turns do not count."""


class Shown(NamedTuple):
    """A refusal that is right, and by how much the numbers of one that states it may differ (as `same` has it)."""

    refusal: Refusal
    within: float = SAME


class NotShownError(Exception):
    """A refusal is not shown to be right; the message says what is missing."""


def same(one: float | None, other: float | None, by: float = SAME) -> bool:
    """Whether two numbers are the same up to rounding; none is the same as none."""
    if one is None or other is None:
        return one is other
    return one == other or (math.isfinite(other) and abs(one - other) <= by * max(1.0, abs(other)))


def states(given: Refusal, shown: Shown) -> bool:
    """Whether a given refusal states what is shown. It may leave out its interval and the facts in `OPTIONAL`."""
    true, by = shown
    if (given.stage, given.reason, given.step, given.subject) != (true.stage, true.reason, true.step, true.subject):
        return False
    one, other = given.amount, true.amount
    if one is None or other is None:
        alike = one is other
    else:
        alike = one.unit == other.unit and same(one.value, other.value, by)
    alike = alike and (given.interval is None or _is_alike(given.interval, true.interval, by))
    return alike and _are_alike(given.facts, true.facts, by)


def _are_alike(given: Facts, true: Facts, by: float) -> bool:
    if type(given) is not type(true):
        return False
    for each in fields(given):
        one, other = getattr(given, each.name), getattr(true, each.name)
        if one is None and each.name in OPTIONAL:
            continue
        if each.name in ANGLES:
            one, other = math.remainder(one - other, math.tau), 0.0
        if not _is_alike(one, other, by):
            return False
    return True


def _is_alike(one: object, other: object, by: float) -> bool:
    """Whether two values of a fact are the same, number by number."""
    if isinstance(one, tuple) and isinstance(other, tuple):
        return len(one) == len(other) and all(_is_alike(a, b, by) for a, b in zip(one, other, strict=True))
    if isinstance(one, float | int) and isinstance(other, float | int) and not isinstance(one, bool):
        return same(one, other, by)
    return one == other
