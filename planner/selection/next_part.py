"""Which part is next: the one function that a cell names a rule for."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.selection import columns as c
from assur.planner.selection.columns import Times
from assur.planner.selection.cycles import cycle
from assur.planner.selection.look_ahead import MOST
from assur.planner.selection.names import RULES
from assur.planner.selection.rules import FREE, IDLE, MEETS, SCORE, score_parts

MOST_CHOICES = 3
"""How many parts are ranked."""
DEPTH, PRICE = 6, 0.8
"""Parts that the look-ahead takes in; the price of time while more parts are known, in parts for each mean cycle."""


@dataclass(frozen=True, slots=True)
class KnownPart:
    """A part that was seen: its lane, when it passes the lane's mark, s, and the place that it is for."""

    name: str
    lane: int
    passed_s: float
    place: int


@dataclass(frozen=True, slots=True)
class FreeArm:
    """The arm when it has put a part down: at which place, where on its grid, in which of the working modes, and the
    next free slot of each place."""

    place: int
    way: float
    mode: int
    slots: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Choice:
    """A part that may be taken next, for which place; when it is met at the earliest, and until when the arm may wait
    before it goes there; s."""

    part: str
    place: int
    meets_s: float
    waits_until_s: float


def next_part(
    now: float,
    arm: FreeArm,
    known: Sequence[KnownPart],
    times: Times,
    rule: str = "look-ahead",
    depth: int = DEPTH,
    price: float = PRICE,
) -> tuple[Choice, ...]:
    """The best `MOST_CHOICES` of the parts that are `known`, in the order in which they were seen, for an arm that is
    free at `now`, s, best first. The same arguments give the same answer. What can no longer be taken is left out.

    Raises `InputError` for a number that is not finite, for a lane, place or mode that the tables do not have, and as
    `scored`."""
    lanes, places, modes = times.there.shape[3], len(times.places), times.there.shape[2]
    _check("now", now)
    _check("arm.way", arm.way)
    _check("arm.place", arm.place, places)
    _check("arm.mode", arm.mode, modes)
    if len(arm.slots) != places:
        raise InputError("arm.slots", arm.slots, f"{places} numbers, one for each place")
    for part in known:
        _check(f"known.{part.name}.lane", part.lane, lanes)
        _check(f"known.{part.name}.place", part.place, places)
        _check(f"known.{part.name}.passed_s", part.passed_s)
    rows = np.array([(part.lane, part.passed_s, part.place) for part in known]).reshape(-1, c.PART)
    row = np.array([now, arm.place, arm.way, arm.mode, *arm.slots], dtype=np.float64)
    found = scored(times, row, rows, rule, depth, price)
    order = [i for i in np.argsort(found[:, SCORE], kind="stable").tolist() if np.isfinite(found[i, FREE])]
    return tuple(
        Choice(known[i].name, known[i].place, float(found[i, MEETS]), now + float(found[i, IDLE]))
        for i in order[:MOST_CHOICES]
    )


def _check(field: str, value: float, many: int | None = None) -> None:
    """Raises `InputError` unless a value is a finite number, or one of `many` numbers from 0."""
    if many is not None and value not in range(many):
        raise InputError(field, value, f"0 to {many - 1}")
    if not math.isfinite(value):
        raise InputError(field, value, "a finite number")


def scored(times: Times, arm: FloatArray, parts: FloatArray, rule: str, depth: int, price: float) -> FloatArray:
    """The table of `rules` (N, FOUND) for parts (N, PART) and an arm (ARM_SLOT + P,). Raises `InputError` for a rule
    that there is not, for a look-ahead of no part or of more than `MOST`, and for a price that is not a finite number
    from 0."""
    if rule not in RULES:
        raise InputError("selection.rule", rule, f"one of {', '.join(RULES)}")
    if not 1 <= depth <= MOST:
        raise InputError("selection.depth", depth, f"1 to {MOST} parts")
    if not 0.0 <= price < math.inf:
        raise InputError("selection.price", price, "a finite number from 0")
    found = np.empty((len(parts), SCORE + 1))
    score_parts(times, arm, parts, RULES.index(rule), depth, price / times.rides[0, c.NOMINAL], found)
    return found


def arm_after(times: Times, arm: FloatArray, part: FloatArray) -> FloatArray:
    """The arm (ARM_SLOT + P,) after the part (PART,) is put down, in the mode in which it is free first; its time is
    infinite if the part cannot be taken."""
    ends, tried = np.empty((times.there.shape[2], len(arm))), np.empty(len(arm))
    cycle(times, arm, part, ends, tried)
    first: FloatArray = ends[int(np.argmin(ends[:, c.ARM_TIME]))]
    return first
