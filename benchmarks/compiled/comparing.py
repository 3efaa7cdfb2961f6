"""Whether a compiled function says what the original says, call by call, on the data of real requests."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, fields, is_dataclass
from statistics import median
from typing import Any

import numpy as np

from benchmarks.compiled.replacements import Replacement

ALIKE = 1e-12
"""Differences up to this, relative above 1, are rounding; above it they are told."""
WRONG = 1e-9
"""Above this the two are not the same function, and nothing is timed: the certificate keeps 1e-9 m for rounding."""


class Differs(Exception):
    """A compiled function does not say what the original says."""


def difference(one: Any, other: Any) -> float:
    """The largest difference of two answers, relative where numbers are above 1; inf: they are of another form."""
    if one is other:
        return 0.0
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        return _of_arrays(one, other)
    if isinstance(one, bool | np.bool_ | str) or one is None or other is None:
        return 0.0 if one == other else np.inf
    if isinstance(one, int | float | np.number) and isinstance(other, int | float | np.number):
        return _of_arrays(np.array(float(one)), np.array(float(other)))
    if isinstance(one, tuple | list) and isinstance(other, tuple | list):
        pairs = list(zip(one, other, strict=False))
        return max((difference(a, b) for a, b in pairs), default=0.0) if len(one) == len(other) else np.inf
    if isinstance(one, dict) and isinstance(other, dict):
        return max((difference(one[k], other[k]) for k in one), default=0.0) if set(one) == set(other) else np.inf
    if is_dataclass(one) and type(one) is type(other):
        return max((difference(getattr(one, f.name), getattr(other, f.name)) for f in fields(one)), default=0.0)
    return 0.0 if one == other else np.inf


def _of_arrays(one: Any, other: Any) -> float:
    if one.shape != other.shape:
        return np.inf
    if one.dtype.kind != "f" or other.dtype.kind != "f":
        return 0.0 if np.array_equal(one, other) else np.inf
    with np.errstate(all="ignore"):
        off = np.abs(one - other) / np.maximum(1.0, np.abs(one))
    same = (one == other) | (np.isnan(one) & np.isnan(other))
    off = np.where(same, 0.0, np.where(np.isnan(off), np.inf, off))
    return float(off.max(initial=0.0))


@dataclass
class Compared:
    """Calls of a function, and the largest difference of its answers."""

    calls: int = 0
    worst: float = 0.0


@dataclass
class Beside:
    """Lets the original answer, and the compiled function beside it."""

    found: dict[str, Compared] = field(default_factory=dict)

    def __call__(self, replacement: Replacement) -> Callable[..., Any]:
        original, compiled = replacement.original, replacement.compiled
        told = self.found.setdefault(replacement.name, Compared())

        def both(*arguments: Any, **named: Any) -> Any:
            answer = original(*arguments, **named)
            off = difference(answer, compiled(*arguments, **named))
            if replacement.numbers is not None:
                mine = replacement.numbers[0](*arguments, **named)
                if mine is not None:
                    off = max(off, difference(replacement.numbers[1](*arguments, **named), mine))
            told.calls += 1
            told.worst = max(told.worst, off)
            if not off <= WRONG:
                raise Differs(f"{replacement.name}: the compiled function is off by {off:.3g}")
            return answer

        return both


@dataclass
class Timed:
    """Repeats each call of one function, original and compiled in turn; their times, s, summed over the calls."""

    repeats: int
    calls: int = 0
    before_s: float = 0.0
    after_s: float = 0.0

    def __call__(self, replacement: Replacement) -> Callable[..., Any]:
        original, compiled = replacement.original, replacement.compiled

        def both(*arguments: Any, **named: Any) -> Any:
            answer = original(*arguments, **named)
            times: tuple[list[float], list[float]] = ([], [])
            for _ in range(self.repeats):
                for taken, function in zip(times, (original, compiled), strict=True):
                    began = time.process_time()
                    function(*arguments, **named)
                    taken.append(time.process_time() - began)
            self.calls += 1
            self.before_s += median(times[0])
            self.after_s += median(times[1])
            return answer

        return both
