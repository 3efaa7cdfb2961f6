"""Answers that are kept and given again to the same request. Off unless `ASSUR_RESULTS_MIB` gives them room.

Kept is what the same request would get again: a plan or a refusal that no clock had a say in, of this build.
"""

from __future__ import annotations

import time
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from assur.api.documents import digest_of
from assur.api.telemetry.meters import Meters
from assur.api.workers import cell_jobs, jobs

BESIDE_BYTES = 1024
"""Counted for each answer beside its body."""


@dataclass(frozen=True, slots=True)
class Kept:
    """An answer, and the reading of the monotonic clock when it was made, s."""

    answer: jobs.Answer
    made: float


class Results:
    """The latest answers, up to a number of bytes in all; the least recently used goes first."""

    def __init__(self, most_bytes: int, build: str, meters: Meters) -> None:
        self._most, self._build, self._meters = most_bytes, build, meters
        self._kept: OrderedDict[str, Kept] = OrderedDict()
        self.bytes = 0
        """Bytes of all answers that are kept."""
        meters.gauge("assur_results_bytes", "Memory of the answers that are kept.", lambda: self.bytes)

    def find(self, job: Callable[..., Any], arguments: tuple[Any, ...]) -> tuple[jobs.Answer, int] | None:
        """The answer to the same order, and its age, s; None where there is none, or for orders that are not plans."""
        if not self._wanted(job):
            return None
        kept = self._kept.get(key := self._key(job, arguments))
        self._meters.results.labels("miss" if kept is None else "hit").inc()
        if kept is None:
            return None
        self._kept.move_to_end(key)
        return kept.answer, int(time.monotonic() - kept.made)

    def keep(self, job: Callable[..., Any], arguments: tuple[Any, ...], answer: jobs.Answer) -> None:
        """Keeps an answer, if the same request would get it again and there is room."""
        size = len(answer.body) + BESIDE_BYTES
        if not (self._wanted(job) and answer.repeatable and size <= self._most):
            return
        key = self._key(job, arguments)
        if key in self._kept:
            return
        self._kept[key] = Kept(answer, time.monotonic())
        self.bytes += size
        while self.bytes > self._most:
            _, oldest = self._kept.popitem(last=False)
            self.bytes -= len(oldest.answer.body) + BESIDE_BYTES

    def _wanted(self, job: Callable[..., Any]) -> bool:
        return self._most > 0 and job in (jobs.plan, jobs.plan_shipped, cell_jobs.plan_task)

    def _key(self, job: Callable[..., Any], arguments: tuple[Any, ...]) -> str:
        """The digest of all that the answer depends on: the build, the kind of work, the body and its parameters."""
        return digest_of(
            self._build, job.__name__, *(each if isinstance(each, bytes) else str(each) for each in arguments)
        )
