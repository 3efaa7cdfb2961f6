"""Plans of random cells, each run many times: what was accepted, what was refused and why, what went wrong."""

from __future__ import annotations

import statistics
from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.checker_refusals import Refused, codes_of, keep, said
from benchmarks.soak.poses import Document
from benchmarks.soak.random_cells import KINDS, random_cell
from benchmarks.soak.realisations import Realisations
from benchmarks.soak.simulation import Outcome, simulated

REALISATIONS = 20


@dataclass(eq=False)
class Tally:
    """Of one kind of cells. `ratios`: of each arrival the error that is reported over the worst that was realised;
    `deepest_m`: the contact that came nearest to what was allowed, beside it."""

    planned: int = 0
    refused: Counter[str] = field(default_factory=Counter)
    runs: int = 0
    collisions: int = 0
    faults: Counter[str] = field(default_factory=Counter)
    deepest_m: float = 0.0
    deepest_allowed_m: float = 0.0
    ratios: list[float] = field(default_factory=list)
    unchecked: Refused = field(default_factory=Refused)

    def add(self, outcome: Outcome, runs: int) -> None:
        self.planned += 1
        self.runs += runs
        self.collisions += outcome.collisions
        self.faults.update(fault.kind for fault in outcome.faults)
        self.ratios += [said / worst for _, said, worst in outcome.errors if worst > 0.0]
        if self.deepest_allowed_m == 0.0 or (
            outcome.deepest_allowed_m > 0.0
            and outcome.deepest_m - outcome.deepest_allowed_m > self.deepest_m - self.deepest_allowed_m
        ):
            self.deepest_m, self.deepest_allowed_m = outcome.deepest_m, outcome.deepest_allowed_m

    def merged(self, other: Tally) -> None:
        """Adds another kind's."""
        deepest = max((self, other), key=lambda t: (t.deepest_allowed_m > 0.0, t.deepest_m - t.deepest_allowed_m))
        self.deepest_m, self.deepest_allowed_m = deepest.deepest_m, deepest.deepest_allowed_m
        self.planned, self.runs = self.planned + other.planned, self.runs + other.runs
        self.collisions += other.collisions
        self.unchecked.merged(other.unchecked)
        self.refused.update(other.refused)
        self.faults.update(other.faults)
        self.ratios += other.ratios

    @property
    def median(self) -> float | None:
        return statistics.median(self.ratios) if self.ratios else None

    @property
    def clean(self) -> bool:
        return not self.faults and not self.unchecked.unknown


def campaign(
    plans: int, seed: int, out: Path | None = None, realisations: int = REALISATIONS, checked: bool = False
) -> Iterator[dict[str, Tally]]:
    """Cells of all kinds in turn, until `plans` were accepted: after each cell what was found so far, by kind.

    A plan of which a run keeps a promise not, and one that the checker refuses, is written to `out` as a request, with
    what went wrong beside it.
    `checked`: every plan goes through the checker, too.
    """
    found = {kind: Tally() for kind in KINDS}
    number, accepted = 0, 0
    while accepted < plans:
        kind = list(KINDS)[number % len(KINDS)]
        own = seed * 1_000_000 + number // len(KINDS)
        number += 1
        accepted += counted(found[kind], kind, own, random_cell(kind, own), out, realisations, checked)
        yield found


ELBOW = "start.elbow"
"""The field of the one fault that a random cell may have: its arm cannot stand there with its elbow on that side."""


def as_si(document: object) -> Document:
    """A request as the simulation reads it: every quantity in SI, what is silent left out."""
    from assur.scenes.requests import validate

    return dict(validate(document).model_dump(mode="json", exclude_unset=True, by_alias=True))


def counted(
    tally: Tally,
    kind: str,
    seed: int,
    request: Document,
    out: Path | None = None,
    realisations: int = REALISATIONS,
    checked: bool = False,
) -> bool:
    """Whether the plan of a cell of this kind and seed was accepted, which was run then; the tally counts it, or why it
    was refused. Raises `InputError` for a request that is at fault in anything but `ELBOW`."""
    from assur.planner.errors import InputError
    from assur.scenes.requests import check_document, plan_document

    try:
        answer = plan_document(request, certificate="full" if checked else "digest")
    except InputError as error:
        if error.field != ELBOW:
            raise
        tally.refused[ELBOW] += 1
        return False
    found, faults = bool(answer["status"] == "planned"), list[Document]()
    findings: list[Any] = list(check_document(request, answer)["findings"]) if found and checked else []
    if found:
        outcome, real = simulated(request, answer, realisations, np.random.default_rng(seed))
        tally.add(outcome, realisations)
        faults = faults_of(outcome, real)
    else:
        tally.refused[str(answer["reason"])] += 1
    unknown = tally.unchecked.add(as_si(request), codes_of(answer, findings))
    if out is not None and (faults or unknown):
        keep(out, f"{kind}-{seed}", request, {"kind": kind, "seed": seed, "faults": faults, **said(answer, findings)})
    return found


def faults_of(outcome: Outcome, real: Realisations) -> list[Document]:
    """The first faults of a plan, each with what was realised in its run."""
    return [{**asdict(fault), "realised": real.described(fault.run)} for fault in outcome.faults[:20]]
