"""Which request something belongs to: its id, its place in a trace, and the facts that are reported of it.

The form of `traceparent` is that of W3C Trace Context, level 1. Of the header that a caller sent only what is valid is
taken, and that is hexadecimal digits.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextvars import ContextVar
from dataclasses import dataclass, field
from os import urandom
from typing import Any

PARENT = re.compile(r"([0-9a-f]{2})-([0-9a-f]{32})-([0-9a-f]{16})-([0-9a-f]{2})(-.*)?")
SAMPLED = 0x01
"""The flag that is passed on: the caller records this trace."""


@dataclass(slots=True)
class Trace:
    """One request. `identity`: its X-Request-Id; `traceparent`: of the span that the service is; `facts`: what its log
    line says; `queued_s`: how long it waited for a worker, s; `stages`: what the worker did, s by stage."""

    identity: str
    traceparent: str
    facts: dict[str, Any] = field(default_factory=dict)
    queued_s: float | None = None
    stages: dict[str, float] = field(default_factory=dict)

    def answered(self, outcome: str, reason: str, stages: dict[str, float]) -> None:
        """A worker has answered: in a word, why there is no plan (or nothing), and what its time went into, s."""
        self.facts["outcome"] = outcome
        if reason:
            self.facts["reason"] = reason
        self.stages = stages

    def replayed(self, kept: str, age_s: int | None = None) -> None:
        """The answer was made before: kept as a `result`, so long ago, s, or for its `key`."""
        self.facts["kept"] = kept
        if age_s is not None:
            self.facts["age_s"] = age_s

    def kept_headers(self) -> dict[str, str]:
        """What the headers of an answer that was made before say of it."""
        match self.facts.get("kept"):
            case "result":
                return {"x-cache": "hit", "age": str(self.facts["age_s"])}
            case "key":
                return {"idempotent-replayed": "true"}
            case _:
                return {}

    def carried(self) -> dict[str, str]:
        """What a worker writes with each line of its log about this request."""
        return {"request": self.identity, "traceparent": self.traceparent}

    def log_facts(self) -> dict[str, Any]:
        """The facts of the log line, with times in ms."""
        times: dict[str, Any] = {}
        if self.queued_s is not None:
            times["queue_ms"] = _ms(self.queued_s)
        if self.stages:
            times["stages_ms"] = {stage: _ms(seconds) for stage, seconds in self.stages.items()}
        return {**self.facts, **times}

    def server_timing(self) -> str:
        """The times as the header `Server-Timing` has them, in ms; empty where no worker was needed."""
        stages = {} if self.queued_s is None else {"queue": self.queued_s}
        each = [f"{stage};dur={round(1e3 * seconds, 1)}" for stage, seconds in {**stages, **self.stages}.items()]
        return ", ".join(each)


def _ms(seconds: float) -> float:
    return round(1e3 * seconds, 1)


CURRENT: ContextVar[Trace | None] = ContextVar("assur_trace", default=None)
"""The request that is being answered. A task begins with that of the task that made it."""


def current() -> Trace:
    """The request that is being answered; outside of one, a new one that nobody reads."""
    return CURRENT.get() or Trace("", "")


def new_traceparent(given: Sequence[str]) -> str:
    """The `traceparent` of a new span: in the trace that the headers `given` name, if there is one and it is valid;
    else in a trace of its own."""
    trace, flags = urandom(16).hex(), 0
    found = PARENT.fullmatch(given[0].strip()) if len(given) == 1 else None
    if found is not None and _valid(*found.groups()):
        trace, flags = found[2], int(found[4], 16) & SAMPLED
    return f"00-{trace}-{urandom(8).hex()}-{flags:02x}"


def _valid(version: str, trace: str, span: str, _: str, more: str | None) -> bool:
    """Whether a header of this form is one: zeros are no id, version ff is none, and version 00 has four parts."""
    return version != "ff" and int(trace, 16) != 0 and int(span, 16) != 0 and not (version == "00" and more)
