"""``python -m benchmarks.record DIR``: what the planner answers today, so that another commit can be compared with it.

With `--against OTHER` the new folder is compared with one that was recorded before. Every search ends by a count, and
readings of the clock are left out, so the same sources write the same bytes on the same machine. A folder has:

- `answers`, `bundles`: a file for each shipped scenario, and for each of them that is planned;
- `cells.json`: for each random cell, the digest of its answer;
- `durations.json`: for each scenario, problem of a set and random cell the duration in s, or why there is no plan.

`benchmarks/recorded` has the durations of scenarios and sets. For kernels of the least processor of the family, as in
the image, NUMBA_CPU_NAME is `generic` and NUMBA_CPU_FEATURES is empty in the environment.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console

from assur.scenes.bundle import bundle_document
from assur.scenes.kernels import load
from assur.scenes.requests import plan_document, plan_scenario
from assur.scenes.scenarios import shipped, shipped_scenarios
from benchmarks.figures import progress
from benchmarks.judge.product import BAD_INPUT, planned
from benchmarks.judged import SETS, label, problem_set
from benchmarks.random_requests.kinds import KINDS, random_cell
from benchmarks.translation import Terms, request

Document = dict[str, Any]
Durations = dict[str, float | str]
"""Item → duration of its plan, s, or the reason for which there is none."""

READINGS = frozenset({"elapsed_s", "first_s"})
"""Fields of an answer that are readings of the clock."""
SEEDS = 3
COUNT, BUDGET_S = 400, 60.0
"""Candidates after which the search for a problem ends; the time limit is never reached."""
CELLS = 3_000
"""Random cells; two of three have a plan."""
SAME_S = 1e-9
"""Durations that differ by no more are equal, s."""
SOLVED, EQUAL, LENGTH = 0.01, 0.95, 0.002
"""Gates of a group: largest change of the share that is solved, least share of equal durations, and largest relative
change of the median and of the 95 % quantile of the durations of what has a plan before and now."""
CONSOLE = Console(width=120)


def without_readings(answer: Any) -> Any:
    """A document without readings of the clock, at any depth."""
    if isinstance(answer, dict):
        return {key: without_readings(value) for key, value in answer.items() if key not in READINGS}
    return [without_readings(value) for value in answer] if isinstance(answer, list) else answer


def outcome(answer: Document) -> float | str:
    """The duration of a plan, s, or the reason of a refusal."""
    return float(answer["duration_s"]) if answer["status"] == "planned" else str(answer["reason"])


def record_scenarios(folder: Path, names: Iterable[str]) -> Durations:
    """Writes the answers and bundles of shipped scenarios."""
    durations: Durations = {}
    for name in names:
        scenario = shipped(name)
        answer = without_readings(json.loads(json.dumps(plan_scenario(scenario, certificate="full"))))
        write(folder / "answers" / f"{name}.json", answer)
        durations[name] = outcome(answer)
        if answer["status"] == "planned":
            bundle = bundle_document(scenario.request, answer, folder=scenario.folder)
            write(folder / "bundles" / f"{name}.json", bundle)
    return durations


def record_sets(seeds: int, every: int = 1) -> Iterator[tuple[str, Durations]]:
    """The durations of each problem set with each seed; of every `every`-th problem."""
    for name, match in SETS:
        problems = problem_set(name)
        for seed in range(seeds):
            durations: Durations = {}
            for problem in problems.problems[::every]:
                document = request(problem, problems.limits, Terms(BUDGET_S, "first", match, seed))
                document["options"]["max_candidates"] = COUNT
                durations[str(problem["id"])] = outcome(plan_document(document))
            yield f"{label(name, match)}, seed {seed}", durations


def record_cells(numbers: Iterable[int]) -> tuple[Durations, dict[str, str]]:
    """Durations and digests of the answers of random cells, which have all kinds in turn."""
    durations: Durations = {}
    digests = {}
    for number in numbers:
        kind, seed = KINDS[number % len(KINDS)], number // len(KINDS)
        answer, field = planned(random_cell(kind, seed))
        item = f"{kind} {seed}"
        durations[item] = f"{BAD_INPUT} {field}" if answer is None else outcome(answer)
        content = json.dumps(without_readings(answer), sort_keys=True, allow_nan=False)
        digests[item] = hashlib.sha256(content.encode()).hexdigest()[:16]
    return durations, digests


def write(path: Path, document: Any, indent: int | None = 1) -> None:
    """Writes a document, its keys in order. Raises `ValueError` for a number that JSON does not have."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(document, sort_keys=True, indent=indent, allow_nan=False) + "\n", encoding="utf-8")


@dataclass(frozen=True)
class Change:
    """Of a group of items that two folders have: their number, how many are solved before and now, how many durations
    are equal and how many items have a plan in either, the relative changes of median and 95 % quantile of those
    that have one in both, and the items that differ."""

    items: int
    solved: tuple[int, int]
    equal: int
    plans: int
    lengths: tuple[float, float]
    differing: list[str]

    @property
    def within(self) -> bool:
        """Whether the gates are met."""
        solved = abs(self.solved[1] - self.solved[0]) <= SOLVED * self.items
        lengths = all(abs(change) <= LENGTH for change in self.lengths)
        return self.items > 0 and solved and self.equal >= EQUAL * self.plans and lengths

    def __str__(self) -> str:
        solved = f"{self.solved[0]} → {self.solved[1]} of {self.items} solved"
        lengths = " / ".join(f"{100 * change:+.3f} %" for change in self.lengths)
        return f"{solved}, {self.equal} of {self.plans} durations equal, median / 95 % {lengths}"


def change(before: Durations, now: Durations) -> Change:
    """Compares the items that both have."""
    items = sorted(before.keys() & now.keys())
    plans = [item for item in items if isinstance(before[item], float) or isinstance(now[item], float)]
    differing = [item for item in items if not same(before[item], now[item])]
    both = [item for item in plans if isinstance(before[item], float) and isinstance(now[item], float)]
    old, new = ([float(side[item]) for item in both] for side in (before, now))
    lengths = [0.0, 0.0]
    if both:
        lengths = [float(np.quantile(new, share) / np.quantile(old, share)) - 1.0 for share in (0.5, 0.95)]
    equal = len(plans) - len(set(plans) & set(differing))
    was, solved = (sum(isinstance(side[item], float) for item in plans) for side in (before, now))
    return Change(len(items), (was, solved), equal, len(plans), (lengths[0], lengths[1]), differing)


def same(before: float | str, now: float | str) -> bool:
    """Whether two outcomes are equal: durations within `SAME_S`, or reasons."""
    if isinstance(before, float) and isinstance(now, float):
        return abs(before - now) <= SAME_S
    return before == now


def largest_difference(before: Any, now: Any) -> float:
    """The largest difference of any number at the same place of two documents; infinite where they differ otherwise."""
    if isinstance(before, dict) and isinstance(now, dict) and before.keys() == now.keys():
        return max((largest_difference(before[key], now[key]) for key in before), default=0.0)
    if isinstance(before, list) and isinstance(now, list) and len(before) == len(now):
        return max(map(largest_difference, before, now), default=0.0)
    numbers = all(isinstance(value, int | float) and not isinstance(value, bool) for value in (before, now))
    if numbers:
        return float(abs(before - now))
    return 0.0 if before == now else float("inf")


def differences(before: Path, now: Path) -> dict[str, str]:
    """Files of answers or bundles that are not in both folders with the same bytes → how they differ."""
    found = {}
    for name in sorted({path.name for folder in (before, now) for path in folder.glob("*.json")}):
        old, new = before / name, now / name
        if not (old.is_file() and new.is_file()):
            found[name] = "only before" if old.is_file() else "only now"
        elif old.read_bytes() != new.read_bytes():
            first, second = json.loads(old.read_bytes()), json.loads(new.read_bytes())
            tables = {key: largest_difference(first.get(key), second.get(key)) for key in {**first, **second}}
            found[name] = ", ".join(f"{key} {most:.2g}" for key, most in sorted(tables.items()) if most > 0.0)
    return found


def compare(before: Path, now: Path) -> tuple[bool, bool]:
    """Prints how two folders differ; whether the gates are met, and whether everything is equal."""
    old, new = (json.loads((folder / "durations.json").read_bytes()) for folder in (before, now))
    groups = [group for group in old if group in new]
    met, equal = bool(groups), True
    for group in groups:
        found = change(old[group], new[group])
        met, equal = met and found.within, equal and not found.differing
        CONSOLE.print(f"{group}: {found}{'' if found.within else ' NOT WITHIN THE GATES'}", highlight=False)
        for item in found.differing:
            CONSOLE.print(f"  {item}: {old[group][item]} → {new[group][item]}", highlight=False)
    for part in ("answers", "bundles"):
        if (before / part).is_dir() and (now / part).is_dir():
            files = differences(before / part, now / part)
            equal = equal and not files
            CONSOLE.print(f"{part}: {len(files)} differ; largest differences of numbers", highlight=False)
            for name, how in files.items():
                CONSOLE.print(f"  {name}: {how or 'only in the way numbers are written'}", highlight=False)
    if (before / "cells.json").is_file() and (now / "cells.json").is_file():
        first, second = (json.loads((folder / "cells.json").read_bytes()) for folder in (before, now))
        other = [item for item in first if item in second and first[item] != second[item]]
        equal = equal and not other
        CONSOLE.print(f"answers of random cells that are not the same bytes: {len(other)}", highlight=False)
    return met, equal


PARTS = ("scenarios", "sets", "cells")


def main(
    folder: Annotated[Path, typer.Argument(help="Where the record is written.")],
    against: Annotated[Path | None, typer.Option(help="A folder to compare it with.")] = None,
    only: Annotated[list[str] | None, typer.Option(help=f"One of {', '.join(PARTS)}; default: all.")] = None,
    cells: Annotated[int, typer.Option(min=1, help="How many random cells.")] = CELLS,
    exactly: Annotated[bool, typer.Option("--exactly", help="Exit 1 unless every answer has the same bytes.")] = False,
) -> None:
    """Record answers, and compare them. Exit 1 where a gate is not met."""
    parts = only or PARTS
    if unknown := [part for part in parts if part not in PARTS]:
        raise typer.BadParameter(f"--only: got {unknown[0]}; allowed: {', '.join(PARTS)}")
    load()
    durations: dict[str, Durations] = {}
    if "scenarios" in parts:
        names = progress(list(shipped_scenarios()), "scenarios")
        durations["scenarios"] = record_scenarios(folder, names)
    if "sets" in parts:
        total = SEEDS * len(SETS)
        durations |= dict(progress(record_sets(SEEDS), "sets", total))
    if "cells" in parts:
        durations["random cells"], digests = record_cells(progress(range(cells), "cells"))
        write(folder / "cells.json", digests)
    write(folder / "durations.json", durations)
    if against is not None:
        met, equal = compare(against, folder)
        raise typer.Exit(0 if (equal if exactly else met) else 1)


if __name__ == "__main__":
    typer.run(main)
