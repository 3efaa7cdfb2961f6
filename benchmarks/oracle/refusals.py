"""Refusals of random small requests: of each that claims a proof, whether the oracle can show that it is wrong."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from benchmarks.checker_refusals import codes_of
from benchmarks.oracle.contradicted import contradiction
from benchmarks.oracle.impossible import KINDS, random_request
from benchmarks.oracle.plans import Tally, in_turn, written
from benchmarks.oracle.product import BAD_INPUT, as_si, checked, planned
from benchmarks.oracle.promises import broken_promises
from benchmarks.soak.poses import Document

UNPROVED, PLANNED, UNJUDGED = "not proved", "planned", "proved, not judged"


def campaign(refusals: int | None, seed: int, out: Path | None = None) -> Iterator[dict[str, Tally]]:
    """Requests of all kinds in turn, until so many proved refusals were evaluated (None: for ever). Yields all tallies
    after each. `refused` of a tally counts answers that were not evaluated: plans, refusals by search, bad input."""

    def look(tally: Tally, kind: str, own: int) -> bool:
        return evaluate(tally, kind, own, random_request(kind, own), out)

    return in_turn({kind: Tally() for kind in KINDS}, look, refusals, seed)


def evaluate(tally: Tally, kind: str, seed: int, request: Document, out: Path | None = None) -> bool:
    """Whether the request was refused with a proof, and so the proof evaluated. A plan instead must keep what it
    promises, and every answer that the product's own checker takes must pass it."""
    answer, fault = planned(request)
    if answer is None:
        tally.refused[f"{BAD_INPUT} {fault}"] += 1
        return False
    findings, proved = checked(request, answer), bool(answer.get("proved"))
    broken = None
    if answer["status"] == "planned":
        tally.refused[PLANNED] += 1
        broken = broken_promises(as_si(request), answer)
    elif proved:
        broken = contradiction(as_si(request), answer)
        tally.refused[UNJUDGED] += broken is None
        tally.evaluated += broken is not None
    else:
        tally.refused[UNPROVED] += 1
    tally.by_checker += findings is not None
    unchecked = bool(codes_of(answer, findings))
    tally.unchecked += unchecked
    tally.faults.update({each.kind for each in broken or []})
    if out is not None and (unchecked or broken):
        written(out, kind, seed, request, answer, broken or [], findings)
    return proved and broken is not None
