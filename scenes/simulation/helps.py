"""What would help: changes of a cell, each tried with the times of the tables, and the best with proved motions."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from assur.planner.errors import FaultError, InputError
from assur.scenes.set_values import with_values
from assur.scenes.simulation.changes import Change, changes_of
from assur.scenes.simulation.simulate import Simulation, interval
from assur.scenes.simulation.table_run import table_rate

Document = dict[str, Any]
PROVED = 3
"""So many changes are tried with proved motions."""
WatchTrials = Callable[[str, float], None]
"""Is given what is tried, and the share of all trials with proved motions that is over."""


def nothing(what: str, share: float) -> None:
    """Watches nothing."""


@dataclass(eq=False)
class _Trial:
    """A change, the simulation of the changed cell, and its mean rate with table times, parts a minute."""

    change: Change
    changed: Simulation
    table_rate: float
    fault: str | None = None


class Helps:
    """Trials of the changes of a cell, against the complete runs of its simulation, with the same seeds. `run` makes
    them; those that are complete when it is interrupted stay."""

    def __init__(self, base: Simulation) -> None:
        self._base, self._table_rate, self._trials = base, 0.0, list[_Trial]()
        self._complete = False

    def run(self, watch: WatchTrials = nothing) -> None:
        """Tries each change that the cell can have with table times, and with proved motions the best `PROVED` of
        those that give more parts then."""
        self._table_rate = _mean_table_rate(self._base)
        best = dict[str, _Trial]()
        for change in changes_of(self._base.cell, self._base.given):
            watch(change.what, 0.0)
            try:
                changed = self._base.with_cell(with_values(self._base.given, change.values))
                trial = _Trial(change, changed, _mean_table_rate(changed))
            except InputError:
                continue  # no cell that can run: there is no such change
            if change.question not in best or trial.table_rate > best[change.question].table_rate:
                best[change.question] = trial
            self._trials = sorted(best.values(), key=lambda each: -each.table_rate)
        proved = [trial for trial in self._trials if trial.table_rate > self._table_rate][:PROVED]
        for k, trial in enumerate(proved):
            self._prove(trial, k, len(proved), watch)
        self._complete = True

    @staticmethod
    def _prove(trial: _Trial, number: int, many: int, watch: WatchTrials) -> None:
        changed = trial.changed

        def watch_run(run: int, now_s: float) -> None:
            watch(trial.change.what, (number + (run + now_s / changed.until_s) / changed.count) / many)

        try:
            changed.run(watch_run)
        except (FaultError, InputError) as error:
            trial.fault = str(error)

    @property
    def document(self) -> Document:
        """What the runs come to, and for each change what it gives, the best first: those with proved motions, and then
        the others. It is `complete` if all trials are, too."""
        found, rows = self._base.document, [self._row(trial) for trial in self._trials]
        rows.sort(key=lambda row: (row["percent"] is None, -(row["percent"] or 0.0)))
        return found | {"complete": found["complete"] and self._complete, "helps": rows}

    def _row(self, trial: _Trial) -> Document:
        own, changed = self._base.rates, trial.changed.rates if trial.changed.complete else []
        mean = sum(own) / len(own) if own else 0.0
        proved = [100.0 * (rate - before) / mean for before, rate in zip(own, changed, strict=False) if mean > 0.0]
        # the difference of two counts is known to a part of each
        low_high = interval(proved, 100.0 * math.sqrt(2.0) / (mean * self._base.minutes)) if proved else None
        return {
            "what": trial.change.what,
            "set": trial.change.values,
            "table_percent": 100.0 * (trial.table_rate / self._table_rate - 1.0) if self._table_rate > 0.0 else None,
            "percent": sum(proved) / len(proved) if proved else None,
            "interval": low_high,
            "gain": None if low_high is None else low_high[0] > 0.0,
            "parts_per_minute": sum(changed) / len(changed) if changed else None,
            "fault": trial.fault,
        }


def _mean_table_rate(of: Simulation) -> float:
    seeds = range(of.first, of.first + of.count)
    return sum(table_rate(of.cell, seed, of.until_s, of.planning_ms) for seed in seeds) / of.count
