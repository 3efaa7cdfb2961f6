"""``python -m benchmarks.profile SET``: where a millisecond goes in the median request of a set.

The set is run once; the problems nearest to the median time to the first answer are run again and again, each from its
request in memory, and sampled (`benchmarks.stages`). What is shown is the mean over those problems, scaled to the time
that they take unwatched.
"""

from __future__ import annotations

from collections import Counter
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console

from assur.planner.model.outcome import NotPlanned
from assur.planner.pipeline import plan
from assur.scenes.requests import scene_of
from benchmarks.bench import WORK
from benchmarks.cold import forget
from benchmarks.judged import SETS, judged, label, problem_set, warm_up
from benchmarks.machine import ROOT, commit, machine, pin
from benchmarks.problem_set import ProblemSet
from benchmarks.report import PROFILES, RESULTS, columns, printed
from benchmarks.run_problems import answer
from benchmarks.runner import write
from benchmarks.stages import INTERVAL_S, clocked, milliseconds, sampled
from benchmarks.translation import Manners, request

SAMPLES = WORK / "quick" / "results"
"""Where the profile of a part of a set goes, as the results of a quick benchmark do: no page is filled from there."""
MIDDLE = 5
"""Problems about the median that are looked at."""
SECONDS = 2.0
"""For which each is repeated."""


def main(
    name: Annotated[str, typer.Argument(metavar="SET", help="static, moving_bodies or moving_goal.")],
    match: Annotated[str, typer.Option(help="position or velocity.")] = "position",
    limit: Annotated[int | None, typer.Option(min=1, help="Only the first problems of the set.")] = None,
    seconds: Annotated[float, typer.Option(min=0.01, help="How long each problem is repeated.")] = SECONDS,
    tag: Annotated[str, typer.Option(help="Added to the name of the result: before, after.")] = "",
    out: Annotated[Path | None, typer.Option(help="Folder of the result.")] = None,
) -> None:
    """Write the profile of a set as JSON and print it as a table.

    It goes to benchmarks/results, from where the pages are filled; with --limit to out/bench/quick/results.
    """
    refuse(name, match)
    folder = out or (RESULTS if limit is None else SAMPLES)
    pinned = pin()
    problems = problem_set(name)
    manners = Manners(match="velocity" if match == "velocity" else "position")
    data = profiled(problems, manners, limit, seconds)
    stem = "-".join(word for word in (PROFILES, label(name, match).replace(", ", " ").replace(" ", "-"), tag) if word)
    document = {
        "schema": "assur-benchmark/1",
        "section": stem,
        "about": f"where a millisecond goes: {label(name, match)}",
        "sample": limit is not None,
        "date": datetime.now(UTC).date().isoformat(),
        **commit(),
        "machine": machine(),
        "pinned": pinned,
        "parameters": {"set": name, "match": match, "seconds": seconds, "interval_s": INTERVAL_S, "limit": limit},
        "figures": [],
        "data": data,
    }
    write(folder / f"{stem}.json", document)
    Console().print(printed(str(document["about"]), columns({stem: document})))
    shown = folder.relative_to(ROOT) if folder.is_relative_to(ROOT) else folder
    Console().print(f"problems {' '.join(data['problems'])}; {data['samples']} samples; written to {shown}/{stem}.json")


def refuse(name: str, match: str) -> None:
    """Raises `typer.BadParameter` for a set that there is not, and for a match that it has not."""
    names = list(dict.fromkeys(known for known, _ in SETS))
    if name not in names:
        raise typer.BadParameter(f"{name!r} is none of {', '.join(names)}", param_hint="SET")
    matches = [way for known, way in SETS if known == name]
    if match not in matches:
        allowed = f"{match!r} is not {' or '.join(matches)}, which {name} can be met with"
        raise typer.BadParameter(allowed, param_hint="--match")


def profiled(problems: ProblemSet, manners: Manners, limit: int | None, seconds: float) -> dict[str, Any]:
    """Stages of the median requests of a set, ms. Raises `RuntimeError` for answers that are not clean."""
    warm_up(problems)
    first: dict[str, float] = {}
    by_id = {str(problem["id"]): problem for problem in problems.problems[:limit]}
    for problem in by_id.values():
        forget()
        record = judged(problems, problem, answer(problem, problems, manners), manners.match)
        if record["findings"]:
            raise RuntimeError(f"{problem['id']}: {record['findings'][0]}")
        if record["first_s"] is not None:
            first[str(problem["id"])] = record["first_s"]
    if not first:
        raise RuntimeError("no problem was solved, so none is the median")
    median = float(np.median(list(first.values())))
    chosen = sorted(first, key=lambda name: abs(first[name] - median))[:MIDDLE]
    counts: Counter[str] = Counter()
    totals = []
    for name in chosen:
        document = request(by_id[name], problems.limits, manners)

        def once(document: dict[str, Any] = document) -> None:
            forget()
            if isinstance(plan(scene_of(document)), NotPlanned):
                raise RuntimeError("planned before, and not now")

        alone = clocked(once, max(3, int(seconds / 2 / median)))
        totals.append(float(np.median(alone)))
        with sampled() as seen:
            clocked(once, max(3, int(seconds / 2 / median)))
        counts += seen
    total = float(np.mean(totals))
    return {
        "problems": chosen,
        "median_of_set_ms": 1e3 * median,
        "total_ms": 1e3 * total,
        "samples": sum(counts.values()),
        "stages_ms": milliseconds(counts, total),
    }


if __name__ == "__main__":
    typer.run(main)
