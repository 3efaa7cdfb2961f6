"""The motion of joints in a file of any format: its clock, its tracks, its joints' names."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from decimal import Decimal

import numpy as np

from assur.planner.arrays import FloatArray
from assur.scenes.bounds import FAR_M, LONG_S, STRONG, TURNS_RAD
from assur.scenes.faults import DocumentError

POSITION, VELOCITY, ACCELERATION = range(3)
STATES = ("positions", "velocities", "accelerations")
"""States of a joint by the order of their derivative, as ROS calls them."""
TIME = -1
"""In place of the order of a state: the time."""
Where = Callable[[int, int, int], tuple[str, int | None]]
"""(row, order of the state or `TIME`, joint) → what an error calls the place of this number, and its line."""


@dataclass(frozen=True, eq=False)
class Track:
    """A joint: its name in the file, its SI unit (None: rad or m, the file does not say), and its positions, velocities
    and accelerations (K,) in SI, None for those that the file does not have."""

    name: str
    unit: str | None
    states: tuple[FloatArray | None, FloatArray | None, FloatArray | None]


@dataclass(frozen=True, eq=False)
class Motion:
    """Times (K,), s, and joints. `relative`: the times count from the first row, whose time of day is in the file.

    `named`: what an error calls the names of the joints, and their line. `notes`: sentences about parts of the file
    that were not read, or not read as they are written.
    """

    time: FloatArray
    tracks: tuple[Track, ...]
    where: Where
    named: tuple[str, int | None]
    relative: bool = False
    notes: tuple[str, ...] = field(default=())


def largest(unit: str | None, order: int) -> float:
    """The largest amount of a state, SI: of positions in `unit` (None: rad or m), and of their derivatives."""
    if order != POSITION:
        return STRONG
    return FAR_M if unit == "m" else TURNS_RAD


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


SEPARATORS = "/_.-:"


def matched(given: list[str], known: Collection[str]) -> tuple[list[str], str] | None:
    """The robot's joint for each of the names `given`, all different, and the one prefix that all of them have before
    it ("": none). None: they are no such names, or in more than one way."""
    if len(set(given)) < len(given) or not given:
        return None
    if all(name in known for name in given):
        return given, ""
    found = [prefix for prefix in _prefixes(given[0], known) if _all_have(prefix, given, known)]
    if len(found) != 1:
        return None
    return [name.removeprefix(found[0]) for name in given], found[0]


def _prefixes(name: str, known: Collection[str]) -> list[str]:
    ends = [joint for joint in known if len(name) > len(joint) and name.endswith(joint)]
    return [name[: -len(joint)] for joint in ends if name[-len(joint) - 1] in SEPARATORS]


def _all_have(prefix: str, given: list[str], known: Collection[str]) -> bool:
    return all(name.startswith(prefix) and name.removeprefix(prefix) in known for name in given)


def listed(names: Collection[str]) -> str:
    """Names as an error repeats them."""
    return ", ".join(names) or "none"
