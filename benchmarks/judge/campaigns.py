"""Campaigns: random requests of all kinds in turn, each answer judged, and what was found counted by kind.

`shifts` runs each plan many times with what is not known realised; `plans` judges plans as they are planned;
`refusals` judges refusals of small requests that claim a proof. `hard` counts how often the product's own checker
refuses what the planner has proved, on requests for which they have disagreed; `proofs` runs the second checker, too.
"""

from __future__ import annotations

import statistics
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.checker_refusals import SECOND, codes_of, keep, objections
from benchmarks.judge.poses import Document
from benchmarks.judge.product import BAD_INPUT, as_si, checked, planned, shown
from benchmarks.judge.promises import broken_promises
from benchmarks.judge.realisations import Realisations
from benchmarks.judge.refusals import contradiction
from benchmarks.judge.simulation import Outcome, simulated
from benchmarks.random_requests import hard, impossible, kinds, random_cells

REALISATIONS = 20
LARGEST_MEDIAN = 1.3
"""Of the error that is reported over the worst that was realised."""
SHOWN = 20
"""Number of faults of one answer that are written."""
ELBOW = "start.elbow"
"""The field of the one fault that a random cell may have: its arm cannot reach the start with that elbow."""
UNPROVED, PLANNED, UNJUDGED = "not proved", "planned", "proved, not judged"


@dataclass(eq=False)
class Tally:
    """Of one kind of requests. `evaluated`: number of evaluated answers; `refused`: of those that were not, by reason;
    `faults`: of answers, by kind; `unchecked`: answers that the product's own checker refuses, or had plans refused in
    the search; `codes`: why; `by_checker`: answers that it judged."""

    evaluated: int = 0
    refused: Counter[str] = field(default_factory=Counter)
    faults: Counter[str] = field(default_factory=Counter)
    codes: Counter[str] = field(default_factory=Counter)
    unchecked: int = 0
    by_checker: int = 0

    def merged(self, other: Tally) -> None:
        """Adds another one."""
        self.evaluated, self.by_checker = self.evaluated + other.evaluated, self.by_checker + other.by_checker
        self.unchecked += other.unchecked
        self.refused.update(other.refused)
        self.faults.update(other.faults)
        self.codes.update(other.codes)

    @property
    def clean(self) -> bool:
        return not self.faults and not self.unchecked

    def row(self) -> dict[str, str]:
        """Column of a table → what it has of this."""
        return {
            "evaluated": str(self.evaluated),
            "faults": _listed(self.faults) or "0",
            "refused by the checker": f"{self.unchecked} of {self.by_checker} {_listed(self.codes)}".strip(),
            "others": _listed(self.refused),
        }


@dataclass(eq=False)
class ShiftTally(Tally):
    """`ratios`: of each arrival the error that is reported over the worst that was realised; `deepest_m`: the contact
    that came nearest to the allowed depth, and that depth."""

    runs: int = 0
    collisions: int = 0
    deepest_m: float = 0.0
    deepest_allowed_m: float = 0.0
    ratios: list[float] = field(default_factory=list)

    def add(self, outcome: Outcome, runs: int) -> None:
        """Counts the runs of a plan."""
        self.runs += runs
        self.collisions += outcome.collisions
        self.ratios += [reported / worst for _, reported, worst in outcome.errors if worst > 0.0]
        self._deepest(outcome.deepest_m, outcome.deepest_allowed_m)

    def _deepest(self, m: float, allowed_m: float) -> None:
        if self.deepest_allowed_m == 0.0 or (
            allowed_m > 0.0 and m - allowed_m > self.deepest_m - self.deepest_allowed_m
        ):
            self.deepest_m, self.deepest_allowed_m = m, allowed_m

    def merged(self, other: Tally) -> None:
        super().merged(other)
        if isinstance(other, ShiftTally):
            self._deepest(other.deepest_m, other.deepest_allowed_m)
            self.runs, self.collisions = self.runs + other.runs, self.collisions + other.collisions
            self.ratios += other.ratios

    @property
    def median(self) -> float | None:
        return statistics.median(self.ratios) if self.ratios else None

    @property
    def clean(self) -> bool:
        return super().clean and (self.median or 0.0) <= LARGEST_MEDIAN

    def row(self) -> dict[str, str]:
        deep = self.deepest_allowed_m > 0.0
        return {
            "accepted": str(self.evaluated),
            "refused": str(self.refused.total()),
            "runs": str(self.runs),
            "collisions": str(self.collisions),
            "faults": str(self.faults.total() + self.unchecked),
            "contact mm": f"{self.deepest_m * 1e3:.3f}" if deep else "",
            "allowed mm": f"{self.deepest_allowed_m * 1e3:.3f}" if deep else "",
            "reported / worst": "" if self.median is None else f"{self.median:.3f}",
            "max": f"{max(self.ratios):.2f}" if self.ratios else "",
        }


def _listed(counts: Counter[str]) -> str:
    return ", ".join(f"{name} {count}" for name, count in counts.most_common() if count)


# what is judged: whether an answer to a request in SI is evaluated (else why not), and its faults

Judgement = tuple[str | None, list[Document]]


def of_shifts(tally: Tally, request: Document, answer: Document, seed: int) -> Judgement:
    """Runs a plan many times."""
    if answer["status"] != "planned":
        return str(answer["reason"]), []
    assert isinstance(tally, ShiftTally)
    outcome, real = simulated(request, answer, REALISATIONS, np.random.default_rng(seed))
    tally.add(outcome, REALISATIONS)
    return None, faults_of(outcome, real)


def faults_of(outcome: Outcome, real: Realisations) -> list[Document]:
    """The faults of a plan's runs, the first ones each with what was realised in its run."""
    found = [asdict(fault) for fault in outcome.faults]
    return [{**each, "realised": real.described(each["run"])} for each in found[:SHOWN]] + found[SHOWN:]


def of_plans(_tally: Tally, request: Document, answer: Document, _seed: int) -> Judgement:
    """Judges a plan as it is planned."""
    if answer["status"] != "planned":
        return str(answer["reason"]), []
    return None, [asdict(each) for each in broken_promises(request, answer)]


def of_refusals(_tally: Tally, request: Document, answer: Document, _seed: int) -> Judgement:
    """Judges a refusal that claims a proof. A plan instead must keep what it promises."""
    if answer["status"] == "planned":
        return PLANNED, [asdict(each) for each in broken_promises(request, answer)]
    if not answer.get("proved"):
        return UNPROVED, []
    broken = contradiction(request, answer)
    return (UNJUDGED, []) if broken is None else (None, [asdict(each) for each in broken])


def of_checkers(_tally: Tally, _request: Document, answer: Document, _seed: int) -> Judgement:
    """Leaves a plan to the product's own checker."""
    return None if answer["status"] == "planned" else str(answer["reason"]), []


def of_proofs(_tally: Tally, request: Document, answer: Document, _seed: int) -> Judgement:
    """Runs the second checker on a plan. Raises `InputError` for an answer that no bundle can state."""
    if answer["status"] != "planned":
        return str(answer["reason"]), []
    refusal = shown(request, answer)
    return None, [{"kind": SECOND, "about": refusal}] if refusal else []


@dataclass(frozen=True)
class Campaign:
    """`make`: the request of a kind and a seed; `strict`: whether bad input in anything but `ELBOW` is an error."""

    kinds: tuple[str, ...]
    make: Callable[[str, int], Document]
    judge: Callable[[Tally, Document, Document, int], Judgement]
    tally: type[Tally] = Tally
    strict: bool = False

    def evaluate(self, tally: Tally, kind: str, seed: int, request: Document, out: Path | None = None) -> bool:
        """Whether the answer to a request was evaluated; the tally counts it, or why it was not. A case that fails, or
        that the product's own checker refuses, is written to `out`. An error of the product is a fault.

        Raises `ValueError` for bad input, if that is `strict`."""
        try:
            answer, field_ = planned(request)
            findings = None if answer is None else checked(request, answer)
        except Exception as error:  # noqa: BLE001 - an error is a result of a campaign: counted, kept, and exit 1
            tally.faults[type(error).__name__] += 1
            if out is not None:
                keep(out, f"{kind}-{seed}", request, {"error": f"{type(error).__name__}: {error}"})
            return False
        if answer is None:
            if self.strict and field_ != ELBOW:
                raise ValueError(f"{kind}, seed {seed}: bad input in {field_}")
            tally.refused[f"{BAD_INPUT} {field_}"] += 1
            return False
        reason, faults = self.judge(tally, as_si(request), answer, seed)
        codes = set(codes_of(answer, findings))
        tally.evaluated += reason is None
        tally.by_checker += findings is not None
        tally.unchecked += bool(codes)
        tally.codes.update(codes)
        tally.refused.update([] if reason is None else [reason])
        tally.faults.update({each["kind"] for each in faults})
        if out is not None and (codes or faults):
            written(out, kind, seed, request, answer, faults, findings)
        return reason is None

    def tallies(self, count: int | None, seed: int, out: Path | None = None) -> Iterator[dict[str, Tally]]:
        """Requests of all kinds in turn, until `count` answers were evaluated (None: for ever). Yields all tallies by
        kind after each."""
        found, number, evaluated = {kind: self.tally() for kind in self.kinds}, 0, 0
        while count is None or evaluated < count:
            # the number of the request counts for each kind
            kind, own = self.kinds[number % len(self.kinds)], seed * 1_000_000 + number // len(self.kinds)
            number += 1
            evaluated += self.evaluate(found[kind], kind, own, self.make(kind, own), out)
            yield found


def written(
    folder: Path,
    kind: str,
    seed: int,
    request: Document,
    answer: Document,
    faults: list[Document],
    findings: list[dict[str, Any]] | None,
) -> Path:
    """Writes a case that failed as the file of a request, and what went wrong as a second file."""
    stated = {"kind": kind, "seed": seed, "status": answer["status"], "sentence": answer.get("sentence")}
    why = {**stated, "faults": faults[:SHOWN], **objections(answer, findings)}
    return keep(folder, f"{kind}-{seed}", request, why)


CAMPAIGNS = {
    "shifts": Campaign(tuple(random_cells.KINDS), random_cells.random_cell, of_shifts, ShiftTally, strict=True),
    "plans": Campaign(kinds.KINDS, kinds.random_cell, of_plans),
    "refusals": Campaign(tuple(impossible.KINDS), impossible.random_request, of_refusals),
    "proofs": Campaign(tuple(random_cells.KINDS), random_cells.random_cell, of_proofs, strict=True),
    "hard": Campaign(tuple(hard.HARD), hard.hard_request, of_checkers),
    "hard-proofs": Campaign(tuple(hard.HARD), hard.hard_request, of_proofs),
}
SOAK = tuple(CAMPAIGNS)[:3]
"""Campaigns that run if none is named."""


@dataclass(eq=False)
class RunningCampaign:
    """A campaign by its name: its tallies by kind, and whether it has reached its count."""

    name: str
    seed: int
    found: dict[str, Tally] = field(default_factory=dict)
    over: bool = False

    @property
    def done(self) -> int:
        """Number of evaluated answers."""
        return sum(each.evaluated for each in self.found.values())

    @property
    def total(self) -> Tally:
        """Of all kinds together."""
        total = CAMPAIGNS[self.name].tally()
        for each in self.found.values():
            total.merged(each)
        return total


def run(
    going: list[RunningCampaign],
    out: Path | None,
    count: int | None = None,
    seconds: float | None = None,
    after_each: Callable[[], None] = lambda: None,
) -> None:
    """Goes on with the campaigns in turn, a request each, until each has evaluated `count` answers, or the time is
    over. `after_each` is called after each. A campaign makes the same requests, however many others there are."""
    began = time.monotonic()
    steps = {each.name: CAMPAIGNS[each.name].tallies(count, each.seed, out) for each in going}
    while not all(each.over for each in going):
        for each in going:
            if seconds is not None and time.monotonic() - began > seconds:
                return
            if not each.over:
                found = next(steps[each.name], None)
                each.found, each.over = (each.found, True) if found is None else (found, False)
                after_each()
