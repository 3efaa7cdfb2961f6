"""What a row of the table is: how it is measured, how its numbers are judged, and how one line reports them."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Protocol

from benchmarks.machine import commit

Numbers = dict[str, Any]
"""What a row has measured, as it is written to the results: plain data."""

MET, NOT_MET, IN_PART, NOT_THERE = "met", "not met", "in part", "not there"
"""Verdicts. In part: what could be measured meets its bar, and something that belongs to the row is not there."""


class NotThereError(Exception):
    """What the row measures is not there in this service or on this machine; the message says what."""


class RowError(Exception):
    """The row could not be measured: a service did not start, or nothing was served. The row is not met."""


@dataclass(frozen=True)
class Run:
    """How a run is made: its short form, the seed of all random choices, the folder of logs and failing bodies, and
    where progress is reported."""

    short: bool
    seed: int
    folder: Path
    say: Callable[[str], None]

    def pick(self, short: float, whole: float) -> float:
        """A number of the short form, or of the whole one."""
        return short if self.short else whole

    def below(self, name: str) -> Path:
        """A folder of a row, which is made."""
        folder = self.folder / name
        folder.mkdir(parents=True, exist_ok=True)
        return folder


class RowModule(Protocol):
    """How a row is measured and judged."""

    def measure(self, run: Run) -> Numbers:
        """The numbers of the row, among them `missing`: missing programs or files, in words."""

    def judge(self, numbers: Numbers) -> list[str]:
        """Why the numbers do not meet the bar, or nothing; it depends on the numbers alone."""

    def summary(self, numbers: Numbers) -> str:
        """The numbers in one line."""


@dataclass(frozen=True)
class Row:
    """A row of the table. `before`: the result before the service was made for many clients. `judge_times`: as `judge`,
    of times and rates, which a busy machine spoils: the short form reports them and does not fail for them."""

    name: str
    title: str
    before: str
    bar: str
    module: RowModule
    judge_times: Callable[[Numbers], list[str]] = lambda _: []


@dataclass(frozen=True)
class Result:
    """A row that was run: its numbers and verdict, when, on which commit, and the load of the machine."""

    name: str
    verdict: str
    told: str
    reasons: list[str]
    numbers: Numbers
    short: bool
    date: str
    commit: str | None
    changed: bool | None
    load: float
    took_s: float

    def document(self) -> dict[str, Any]:
        """The result as it is written."""
        return asdict(self)


def judged(row: Row, numbers: Numbers, short: bool = False) -> tuple[str, list[str]]:
    """The verdict on numbers, and its reasons."""
    reasons, slow = row.module.judge(numbers), row.judge_times(numbers)
    missing = [f"not there: {what}" for what in numbers.get("missing", [])]
    if short:
        missing += [f"not judged in the short form: {what}" for what in slow]
    else:
        reasons += slow
    if reasons:
        return NOT_MET, [*reasons, *missing]
    return (IN_PART, missing) if missing else (MET, [])


def run_row(row: Row, run: Run) -> Result:
    """Measures and judges a row. A row that is not there, or could not be measured, is a result, too."""
    began, load, at = time.monotonic(), os.getloadavg()[0], datetime.now(UTC).date().isoformat()
    numbers: Numbers = {}
    try:
        numbers = row.module.measure(run)
    except NotThereError as missing:
        verdict, reasons, summary = NOT_THERE, [str(missing)], f"not there: {missing}"
    except RowError as failed:
        verdict, reasons, summary = NOT_MET, [str(failed)], f"not measured: {failed}"
    else:
        (verdict, reasons), summary = judged(row, numbers, run.short), row.module.summary(numbers)
    here = commit()
    took_s = round(time.monotonic() - began, 1)
    return Result(
        row.name,
        verdict,
        summary,
        reasons,
        numbers,
        run.short,
        at,
        here["commit"],
        here["changed"],
        round(load, 2),
        took_s,
    )


def above(numbers: Numbers, limits: Mapping[str, float]) -> list[str]:
    """The numbers that are above their limit, or were not measured, in words."""
    found = []
    for name, limit in limits.items():
        value = numbers.get(name)
        words = name.replace("_", " ")
        if value is None:
            found.append(f"{words}: not measured")
        elif not value <= limit:  # a NaN is refused as well
            found.append(f"{words}: {value:g}, allowed at most {limit:g}")
    return found
