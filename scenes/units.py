"""Units: each key of a document has its unit as a suffix, and is converted to SI.

`speed_mm_s: 250` and `speed_m_s: 0.25` are the same quantity. Dividing by 1000 (rather than multiplying by a rounded
0.001) makes both the same float, and so the same digest.
"""

from __future__ import annotations

import math
from functools import lru_cache

SI_UNITS = ("rad_s3", "rad_s2", "rad_s", "m_s3", "m_s2", "m_s", "rad", "m", "s")
"""SI units, longest first, so that `speed_m_s` is a speed and not a time."""
TWIN = {"rad": "deg", "m": "mm", "s": "ms"}
"""What the first part of an SI unit may be written as instead."""


def _twin_unit(unit: str) -> str:
    head, _, rest = unit.partition("_")
    return TWIN[head] + (f"_{rest}" if rest else "")


TWIN_UNITS = {_twin_unit(unit): unit for unit in SI_UNITS}
"""Unit as it may be written → SI unit."""


def unit_of(key: str, units: tuple[str, ...] | dict[str, str]) -> str | None:
    """The unit out of `units` that `key` bears as its suffix (or is), the longest first; None if it bears none."""
    for unit in units:
        if key.endswith(unit) and (len(key) == len(unit) or key[-len(unit) - 1] == "_"):
            return unit
    return None


@lru_cache(maxsize=4096)
def any_unit(key: str) -> str | None:
    """The unit, of SI or a twin, that `key` bears as its suffix; None if it bears none."""
    return unit_of(key, TWIN_UNITS) or unit_of(key, SI_UNITS)


@lru_cache(maxsize=4096)
def twin_of(key: str) -> str | None:
    """The other way to write an SI key: `at_m` → `at_mm`; None where the key bears no SI unit."""
    if si_key(key) is not None:
        return None
    unit = unit_of(key, SI_UNITS)
    return None if unit is None else key[: len(key) - len(unit)] + _twin_unit(unit)


@lru_cache(maxsize=4096)
def si_key(key: object) -> tuple[str, str] | None:
    """(SI key, unit as written) of a key in a twin unit: `at_mm` → (`at_m`, `mm`); None for any other key, and for what
    is no text."""
    if not isinstance(key, str):
        return None
    unit = unit_of(key, TWIN_UNITS)
    return None if unit is None else (key[: len(key) - len(unit)] + TWIN_UNITS[unit], unit)


def to_si(value: object, unit: str) -> object:
    """`value` in SI, numbers inside lists and mappings too. What is not a number is left for the model to refuse."""
    kind = type(value)
    if kind is float or kind is int:
        try:
            return math.radians(value) if unit.startswith("deg") else value / 1000  # type: ignore[arg-type, operator]
        except OverflowError:
            return value
    if kind is list:
        return [to_si(item, unit) for item in value]  # type: ignore[attr-defined]
    if kind is dict:
        return {key: to_si(item, unit) for key, item in value.items()}  # type: ignore[attr-defined]
    return value


def from_si(value: float, unit: str) -> float:
    """A number of SI in the twin unit `unit`."""
    return math.degrees(value) if unit.startswith("deg") else value * 1000
