"""Plans of random cells of all kinds, each evaluated as it is planned: what was promised and is not kept."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, TypeVar

from benchmarks.checker_refusals import codes_of, keep, objections
from benchmarks.oracle.faults import Violation
from benchmarks.oracle.kinds import KINDS, random_cell
from benchmarks.oracle.product import BAD_INPUT, as_si, checked, planned
from benchmarks.oracle.promises import broken_promises
from benchmarks.soak.poses import Document

T = TypeVar("T", bound="Tally")


@dataclass(eq=False)
class Tally:
    """Of one kind of cells, or of requests. `evaluated`: number of evaluated answers; `faults`: of answers, by kind;
    `unchecked`: answers with a plan that the product's own checker refuses; `by_checker`: plans that it judged."""

    evaluated: int = 0
    refused: Counter[str] = field(default_factory=Counter)
    faults: Counter[str] = field(default_factory=Counter)
    unchecked: int = 0
    by_checker: int = 0

    def merged(self, other: Tally) -> None:
        """Adds another one."""
        self.evaluated, self.by_checker = self.evaluated + other.evaluated, self.by_checker + other.by_checker
        self.unchecked += other.unchecked
        self.refused.update(other.refused)
        self.faults.update(other.faults)

    @property
    def clean(self) -> bool:
        return not self.faults and not self.unchecked

    def row(self) -> dict[str, str]:
        """Column of a table → what it has of this."""
        return {
            "evaluated": str(self.evaluated),
            "faults": ", ".join(f"{name} {count}" for name, count in self.faults.most_common()) or "0",
            "refused by the checker": f"{self.unchecked} of {self.by_checker}",
            "others": ", ".join(f"{name} {count}" for name, count in self.refused.most_common() if count),
        }


def own_seed(seed: int, number: int) -> int:
    """The seed of the cell with this number, counted for each kind, in a campaign with `seed`."""
    return seed * 1_000_000 + number


def in_turn(
    found: dict[str, T], look: Callable[[T, str, int], bool], count: int | None, seed: int
) -> Iterator[dict[str, T]]:
    """Calls `look` with the tally of a kind, the kind and a seed, for all kinds of `found` in turn, until it has
    returned `count` times that an answer was evaluated (None: for ever). Yields all tallies after each call."""
    kinds, number, evaluated = list(found), 0, 0
    while count is None or evaluated < count:
        kind, own = kinds[number % len(kinds)], own_seed(seed, number // len(kinds))
        number += 1
        evaluated += look(found[kind], kind, own)
        yield found


def campaign(plans: int | None, seed: int, out: Path | None = None) -> Iterator[dict[str, Tally]]:
    """Cells of all kinds in turn, until `plans` were accepted (None: for ever): after each what was found, by kind."""

    def look(tally: Tally, kind: str, own: int) -> bool:
        return evaluate(tally, kind, own, random_cell(kind, own), out)

    return in_turn({kind: Tally() for kind in KINDS}, look, plans, seed)


def evaluate(tally: Tally, kind: str, seed: int, request: Document, out: Path | None = None) -> bool:
    """Whether the cell was planned, and so its plan evaluated; the tally counts it, or why it was refused."""
    answer, fault = planned(request)
    if answer is None:
        tally.refused[f"{BAD_INPUT} {fault}"] += 1
        return False
    found, si, broken = bool(answer["status"] == "planned"), as_si(request), list[Violation]()
    findings = checked(request, answer)
    if found:
        broken = broken_promises(si, answer)
        tally.evaluated += 1
    else:
        tally.refused[str(answer["reason"])] += 1
    tally.by_checker += found
    unchecked = bool(codes_of(answer, findings))
    tally.unchecked += unchecked
    tally.faults.update({each.kind for each in broken})
    if out is not None and (unchecked or broken):
        written(out, kind, seed, request, answer, broken, findings)
    return found


def written(
    folder: Path,
    kind: str,
    seed: int,
    request: Document,
    answer: Document,
    broken: list[Violation],
    findings: list[dict[str, Any]] | None,
) -> Path:
    """Writes a case that failed as the file of a request, and what went wrong as a second file."""
    faults = {
        "kind": kind,
        "seed": seed,
        "status": answer["status"],
        "sentence": answer.get("sentence"),
        "faults": [asdict(each) for each in broken[:20]],
        **objections(answer, findings),
    }
    return keep(folder, f"{kind}-{seed}", request, faults)
