"""Numbers of changes, rounded to whole units."""

from __future__ import annotations

import math

SHOWN_M = 1e-4
"""Lengths are proposed in whole tenths of a millimetre."""
WHOLE = 1e-3
"""Windows are proposed in whole milliseconds, and in whole millimetres of belt."""
ROUNDING = 1e-9
"""Ends of windows that differ by no more, s or m, are the same."""


def up(value: float, unit: float) -> float:
    """The next whole number of units; a millionth of one is rounding."""
    return math.ceil(value / unit - 1e-6) * unit


def down(value: float, unit: float) -> float:
    return math.floor(value / unit + 1e-6) * unit
