"""Until when a request may be worked on. Made when the request is read, and checked between blocks of work.

Work that ends by a clock asks the deadline that is in force where it runs, so that no function hands it on:

    with Deadline(started, budget_s):
        ...
        if out_of_time(): ...  # what is sound already may be used as it is
        raise_if_late()        # or: there is nothing to use yet

A deadline never changes a result that is found before it passes.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from contextvars import ContextVar, Token
from dataclasses import dataclass, field
from typing import Literal


class OutOfTimeError(Exception):
    """The deadline in force has passed. The function that set it answers with what is known by then."""


@dataclass(eq=False)
class Deadline:
    """In force inside its `with`, in place of the one before it. `started`: a reading of `time.perf_counter`, s, from
    which `budget_s` counts."""

    started: float
    budget_s: float
    _before: list[Token[float]] = field(default_factory=list, init=False, repr=False)

    @property
    def at(self) -> float:
        """The reading of `time.perf_counter` at which it passes, s."""
        return self.started + self.budget_s

    def __enter__(self) -> Deadline:
        self._before.append(_IN_FORCE.set(self.at))
        return self

    def __exit__(self, kind: object, error: object, trace: object) -> None:
        _IN_FORCE.reset(self._before.pop())


_IN_FORCE: ContextVar[float] = ContextVar("assur_deadline", default=math.inf)


def out_of_time() -> bool:
    """Whether the deadline in force has passed; never, if none is in force."""
    return time.perf_counter() >= _IN_FORCE.get()


def raise_if_late() -> None:
    """Raises `OutOfTimeError` if the deadline in force has passed."""
    if out_of_time():
        raise OutOfTimeError


# Where the time of a request went, by stage. Operators read it; no decision does.


class Stopwatch:
    """Seconds by stage, of a monotonic clock. It runs from when it is made."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        """Time of each stage so far, s, in the order in which the stages first ended."""
        self._last = time.perf_counter()

    def lap(self, stage: str) -> None:
        """Adds the time since the last call, or since it was made, to `stage`."""
        now = time.perf_counter()
        self.seconds[stage] = self.seconds.get(stage, 0.0) + now - self._last
        self._last = now


# How far the planning of a request has come, for a caller who watches it and may end it.


@dataclass(frozen=True, slots=True)
class Progress:
    """The search so far. `stage`: the search for a plan, or that for a change of the request that would help.

    `candidates` tried; `steps` of the task up to which some candidate came; `duration_s` of the best plan (None: there
    is none yet) and `lower_bound_s`, which no plan beats (None: not known yet).
    """

    stage: Literal["search", "relaxation"]
    elapsed_s: float
    candidates: int
    steps: int
    duration_s: float | None
    lower_bound_s: float | None


Watch = Callable[[Progress], None]
"""Is called now and then, from the thread that plans. What it raises ends the planning and is raised there."""
