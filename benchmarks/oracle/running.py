"""Runs campaigns of the oracle in turn, for a time or a count."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from benchmarks.oracle import plans, refusals
from benchmarks.oracle.plans import Tally
from benchmarks.soak import campaign as shifts

CAMPAIGNS: dict[str, Callable[[int | None, int, Path | None], Iterator[Mapping[str, Tally]]]] = {
    "shifts": shifts.campaign,
    "plans": plans.campaign,
    "refusals": refusals.campaign,
}


@dataclass(eq=False)
class RunningCampaign:
    """One campaign: its tallies by kind, and whether it has reached its count."""

    name: str
    seed: int
    found: Mapping[str, Tally] = field(default_factory=dict)
    over: bool = False

    @property
    def done(self) -> int:
        """Number of evaluated answers."""
        return sum(each.evaluated for each in self.found.values())

    @property
    def total(self) -> Tally:
        """Of all kinds together."""
        total = shifts.Tally() if self.name == "shifts" else Tally()
        for each in self.found.values():
            total.merged(each)
        return total

    def steps(self, count: int | None, out: Path | None) -> Iterator[None]:
        """After each cell, or request, once."""
        for found in CAMPAIGNS[self.name](count, self.seed, out):
            self.found = found
            yield


def run(
    going: list[RunningCampaign],
    out: Path | None,
    count: int | None = None,
    seconds: float | None = None,
    after_each: Callable[[], None] = lambda: None,
) -> None:
    """Goes on with the campaigns in turn, a cell each, until each has evaluated `count` answers, or the time is over.
    `after_each` is called after each cell. Each campaign makes the same cells, however many others there are."""
    began = time.monotonic()
    steps = {each.name: each.steps(count, out) for each in going}
    while not all(each.over for each in going):
        for each in going:
            if seconds is not None and time.monotonic() - began > seconds:
                return
            if not each.over:
                each.over = next(steps[each.name], END) is END
                after_each()


END = object()
"""In place of a step: there is none left."""
