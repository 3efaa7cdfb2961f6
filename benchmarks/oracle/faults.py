"""What an answer promises and does not keep, as the oracle finds it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class BrokenPromise:
    """A promise that is not kept: its `kind`, what it is `about`, the `amount` that was found beside what is `allowed`
    (SI), and when, s (None: not at one time)."""

    kind: str
    about: str
    amount: float
    allowed: float
    time_s: float | None = None


def beyond(kind: str, about: str, amount: float, allowed: float, time_s: float | None = None) -> list[BrokenPromise]:
    """One fault, unless the amount is no more than what is allowed. What is no number is a fault."""
    return [] if amount <= allowed else [BrokenPromise(kind, about, float(amount), float(allowed), time_s)]
