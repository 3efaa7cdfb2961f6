"""Plans of random cells, each run many times: accepted and refused plans, and faults."""

from __future__ import annotations

import statistics
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np

from benchmarks.checker_refusals import codes_of, keep, objections
from benchmarks.oracle import plans
from benchmarks.oracle.product import checked, planned
from benchmarks.soak.poses import Document
from benchmarks.soak.random_cells import KINDS, random_cell
from benchmarks.soak.realisations import Realisations
from benchmarks.soak.simulation import Outcome, simulated

REALISATIONS = 20
LARGEST_MEDIAN = 1.3
"""Of the error that is reported over the worst that was realised."""


@dataclass(eq=False)
class Tally(plans.Tally):
    """Of one kind of cells. `ratios`: of each arrival the error that is reported over the worst that was realised;
    `deepest_m`: the contact that came nearest to the allowed depth, and that depth."""

    runs: int = 0
    collisions: int = 0
    deepest_m: float = 0.0
    deepest_allowed_m: float = 0.0
    ratios: list[float] = field(default_factory=list)

    def add(self, outcome: Outcome, runs: int) -> None:
        self.evaluated += 1
        self.runs += runs
        self.collisions += outcome.collisions
        self.faults.update(fault.kind for fault in outcome.faults)
        self.ratios += [reported / worst for _, reported, worst in outcome.errors if worst > 0.0]
        self._deepest(outcome.deepest_m, outcome.deepest_allowed_m)

    def _deepest(self, m: float, allowed_m: float) -> None:
        if self.deepest_allowed_m == 0.0 or (
            allowed_m > 0.0 and m - allowed_m > self.deepest_m - self.deepest_allowed_m
        ):
            self.deepest_m, self.deepest_allowed_m = m, allowed_m

    def merged(self, other: plans.Tally) -> None:
        """Adds another kind's."""
        super().merged(other)
        if isinstance(other, Tally):
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


def campaign(
    count: int | None, seed: int, out: Path | None = None, realisations: int = REALISATIONS
) -> Iterator[dict[str, Tally]]:
    """Cells of all kinds in turn, until `count` plans were accepted (None: for ever): after each cell what was found so
    far, by kind.

    If a run breaks a promise of a plan, or the checker refuses the plan, its request is written to `out`, and what went
    wrong as a second file.
    """

    def look(tally: Tally, kind: str, own: int) -> bool:
        return counted(tally, kind, own, random_cell(kind, own), out, realisations)

    return plans.in_turn({kind: Tally() for kind in KINDS}, look, count, seed)


ELBOW = "start.elbow"
"""The field of the one fault that a random cell may have: its arm cannot reach the start with that elbow."""


def counted(
    tally: Tally, kind: str, seed: int, request: Document, out: Path | None = None, realisations: int = REALISATIONS
) -> bool:
    """Whether the plan of a cell of this kind and seed was accepted, which was run then; the tally counts it, or why it
    was refused. Raises `ValueError` for a request that is at fault in anything but `ELBOW`."""
    answer, fault = planned(request)
    if answer is None:
        if fault != ELBOW:
            raise ValueError(f"{kind}, seed {seed}: bad input in {fault}")
        tally.refused[ELBOW] += 1
        return False
    found, faults = bool(answer["status"] == "planned"), list[Document]()
    findings = checked(request, answer) if found else []
    if found:
        outcome, real = simulated(request, answer, realisations, np.random.default_rng(seed))
        tally.add(outcome, realisations)
        faults = faults_of(outcome, real)
    else:
        tally.refused[str(answer["reason"])] += 1
    unchecked = bool(codes_of(answer, findings))
    tally.unchecked += unchecked
    if out is not None and (faults or unchecked):
        keep(
            out,
            f"{kind}-{seed}",
            request,
            {"kind": kind, "seed": seed, "faults": faults, **objections(answer, findings)},
        )
    return found


def faults_of(outcome: Outcome, real: Realisations) -> list[Document]:
    """The first faults of a plan, each with what was realised in its run."""
    return [{**asdict(fault), "realised": real.described(fault.run)} for fault in outcome.faults[:20]]
