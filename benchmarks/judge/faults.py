"""Promises of an answer that are not kept."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Violation:
    """A promise that is not kept: its `kind`, what it is `about`, the measured `amount`, the `allowed` one (SI), and
    when, s (None: not at one time)."""

    kind: str
    about: str
    amount: float
    allowed: float
    time_s: float | None = None


def beyond(kind: str, about: str, amount: float, allowed: float, time_s: float | None = None) -> list[Violation]:
    """One fault, unless the amount is at most the allowed one. NaN is a fault."""
    return [] if amount <= allowed else [Violation(kind, about, float(amount), float(allowed), time_s)]
