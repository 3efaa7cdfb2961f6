"""Times of files as seconds: of a clock that begins near 0, or of one that counts since 1970 or since a computer was
switched on. They are subtracted before they are rounded: a double has 0.2 µs left of a time of the calendar."""

from __future__ import annotations

from collections.abc import Sequence
from decimal import Decimal

import numpy as np

from assur.planner.arrays import FloatArray
from assur.scenes.bounds import LONG_S
from assur.scenes.faults import DocumentError

DIGITS = {"s": 0, "ms": 3, "us": 6, "ns": 9}
"""Unit of a time → how many digits it is below the second."""
SINCE_2000, UNTIL_2100 = Decimal(946_684_800), Decimal(4_102_444_800)
"""s since 1970."""
OWN_CLOCK = Decimal(LONG_S)


def unit_of_calendar(value: Decimal) -> str | None:
    """The unit in which a time is one of the years 2000 to 2100, since 1970; None: in none."""
    return next((u for u, digits in DIGITS.items() if SINCE_2000 <= value.scaleb(-digits) <= UNTIL_2100), None)


def seconds(values: list[Decimal], unit: str, where: Sequence[tuple[str, int | None]]) -> tuple[FloatArray, str | None]:
    """Times (K,) in s, and None; or, where they are beyond `LONG_S`, from the first one, and that one in s, as text.

    Raises `DocumentError` for the first time that no clock shows, or that is too far from the first.
    """
    times = [value.scaleb(-DIGITS[unit]) for value in values]
    first = times[0] if times and abs(times[0]) > OWN_CLOCK else None
    if first is not None and not -OWN_CLOCK <= first <= UNTIL_2100:
        meant = unit_of_calendar(values[0])
        hint = f"; in {meant} it would be a time of the calendar" if meant else ""
        allowed = f"from -{LONG_S:g} s to {LONG_S:g} s, or until 2100 in s since 1970 ({unit} is the unit here){hint}"
        raise DocumentError(where[0][0], f"{values[0]} {unit}", allowed, where[0][1])
    offset = Decimal(0) if first is None else first
    for k, time in enumerate(times):
        if not abs(time - offset) <= OWN_CLOCK:
            after = "" if first is None else " from the first time on"
            allowed = f"from -{LONG_S:g} to {LONG_S:g} s{after}"
            raise DocumentError(where[k][0], str(values[k])[:40], allowed, where[k][1])
    return np.array([float(time - offset) for time in times]), None if first is None else str(first)
