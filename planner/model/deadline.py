"""Until when a request may be worked on. Made when the request is read, and looked at between blocks of work.

Work that ends by a clock asks the deadline that is in force where it runs, so that no function hands it on:

    with Deadline(started, budget_s):
        ...
        if out_of_time(): ...  # what is sound already may be used as it is
        look()                 # or: there is nothing to use yet

A deadline never changes a result that is found before it passes.
"""

from __future__ import annotations

import math
import time
from contextvars import ContextVar, Token
from dataclasses import dataclass, field


class OutOfTimeError(Exception):
    """The deadline in force has passed. Whoever set it makes an answer of what is known by then."""


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


def look() -> None:
    """Raises `OutOfTimeError` if the deadline in force has passed."""
    if out_of_time():
        raise OutOfTimeError
