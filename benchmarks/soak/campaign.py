"""Plans of random cells, each run many times: what was accepted, what was refused and why, what went wrong."""

from __future__ import annotations

import json
import statistics
from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

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
    unchecked: int = 0

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
        self.collisions, self.unchecked = self.collisions + other.collisions, self.unchecked + other.unchecked
        self.refused.update(other.refused)
        self.faults.update(other.faults)
        self.ratios += other.ratios

    @property
    def median(self) -> float | None:
        return statistics.median(self.ratios) if self.ratios else None

    @property
    def clean(self) -> bool:
        return not self.faults and not self.unchecked


def campaign(
    plans: int, seed: int, out: Path | None = None, realisations: int = REALISATIONS, checked: bool = False
) -> Iterator[dict[str, Tally]]:
    """Cells of all kinds in turn, until `plans` were accepted: after each cell what was found so far, by kind.

    A plan of which a run keeps a promise not is written to `out` as a request, with what went wrong beside it.
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
    if answer["status"] != "planned":
        tally.refused[str(answer["reason"])] += 1
        return False
    findings = check_document(request, answer)["findings"] if checked else []
    outcome, real = simulated(request, answer, realisations, np.random.default_rng(seed))
    tally.add(outcome, realisations)
    tally.unchecked += bool(findings)
    if out is not None and (outcome.faults or findings):
        written(out, kind, seed, request, outcome, real, findings)
    return True


def written(
    folder: Path, kind: str, seed: int, request: Document, outcome: Outcome, real: Realisations, findings: list[Any]
) -> Path:
    """Writes a case that failed as the file of a request, and what went wrong beside it."""
    folder.mkdir(parents=True, exist_ok=True)
    name = f"{kind.replace(', ', '-').replace(' ', '-')}-{seed}"
    file = folder / f"{name}.json"
    file.write_text(json.dumps(request, indent=1), encoding="utf-8")
    faults = [{**asdict(fault), "realised": real.described(fault.run)} for fault in outcome.faults[:20]]
    told = {"kind": kind, "seed": seed, "faults": faults, "checker": findings}
    (folder / f"{name}.faults.json").write_text(json.dumps(told, indent=1), encoding="utf-8")
    return file
