"""Numbers as people read them: mm, ms, degrees, with the digits that count."""

from __future__ import annotations

import math

SHOWN_AS = {
    "m": ("mm", 1e3),
    "mm": ("mm", 1.0),
    "s": ("ms", 1e3),
    "rad": ("deg", math.degrees(1.0)),
    "deg": ("deg", 1.0),
    "1": ("", 1.0),
    "rad/s": ("deg/s", math.degrees(1.0)),
    "rad/s²": ("deg/s²", math.degrees(1.0)),
    "rad/s³": ("deg/s³", math.degrees(1.0)),
    "m/s": ("mm/s", 1e3),
    "m/s²": ("mm/s²", 1e3),
    "m/s³": ("mm/s³", 1e3),
}
"""Units of a document, and what people read instead, with the factor."""
LEAST_SHOWN = 1e-3
"""Amounts below a thousandth of mm, ms or degree are shown as less than that."""

MOST_DIGITS = 12
"""No more digits than these tell two lengths apart: more are rounding."""


def amount(value: float | None, unit: str | None) -> str:
    """A length in mm, a time in ms or s, an angle in degrees, anything else as it is, with three digits that count, or
    four of a load; nothing for no number."""
    if value is None or not math.isfinite(value):
        return ""
    name, factor = ("s", 1.0) if unit == "s" and abs(value) >= 1.0 else SHOWN_AS.get(unit or "", (unit or "", 1.0))
    size = abs(value * factor)
    if 0.0 < size < LEAST_SHOWN and unit in SHOWN_AS and unit != "1":
        return f"less than {LEAST_SHOWN:g} {name}".rstrip()
    return f"{number(value * factor, 4 if name.startswith('kg') else 3)} {name}".rstrip()


def different_lengths(one: float, other: float) -> tuple[str, str]:
    """A length and the length that is required, m: with so many digits that they differ where they do."""
    shown = amount(one, "m"), amount(other, "m")
    for digits in range(4, MOST_DIGITS + 1):
        if shown[0] != shown[1]:
            break
        shown = f"{number(1e3 * one, digits)} mm", f"{number(1e3 * other, digits)} mm"
    return shown


def position(value: float, unit: str) -> str:
    """A position of a joint, or a yaw, in "rad" or "m", to a hundredth of a degree or millimetre."""
    name, factor = SHOWN_AS[unit]
    return f"{round(value * factor, 2) + 0.0:g} {name}"


def number(value: float, digits: int) -> str:
    """A number with so many digits that count and no power of ten; whole ones lose none: 359934 → 359,900 (4)."""
    rounded = float(f"{value:.{digits}g}") + 0.0  # no -0
    whole = f"{rounded:,.0f}"
    return whole if abs(rounded) >= 10 ** (digits - 1) else f"{rounded:.{digits}g}"
