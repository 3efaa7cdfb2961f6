"""``python -m benchmarks.best_known``: the shortest motion known for each problem, in `benchmarks/best_known.json`.

A record may only ever be lowered, and only by an answer that the checker accepts and in which the independent recheck
finds nothing, jerk included. So neither `witness` nor `direct_time` of the problem files is a record: both are
trapezoids without a limit of jerk. For each problem the planner searches 30 s with each of 3 seeds, which takes ten
hours for all of them; the command can be stopped, and goes on where it was.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from benchmarks.judged import SETS, judged, label, problem_set, warm_up
from benchmarks.machine import ROOT, commit, sources
from benchmarks.progress import Progress as Kept
from benchmarks.run_problems import answer
from benchmarks.translation import Manners

PATH = ROOT / "benchmarks" / "best_known.json"
SCHEMA = "assur-best-known/1"

Record = dict[str, Any]
Known = dict[str, dict[str, Record]]
"""Set in words → problem → {duration_s, by, commit, searched_s}; the last: how long this command searched for it in
all, 0 for what other runs found on their way."""


class RaisedError(Exception):
    """Somebody wants to raise a record, or to drop one."""


def read(path: Path) -> Known:
    """The records; none where there is no file. `ValueError` for a file that is of another form."""
    if not path.exists():
        return {}
    document = json.loads(path.read_text(encoding="utf-8"))
    if not isinstance(document, dict) or document.get("schema") != SCHEMA:
        raise ValueError(f"{path.name}: no {SCHEMA}")
    known: Known = document["records"]
    for name, records in known.items():
        for problem, record in records.items():
            if not record["duration_s"] > 0:
                raise ValueError(f"{path.name}: {name}, {problem}: duration {record['duration_s']!r}")
    return known


def merged(known: Known, new: Known) -> tuple[Known, list[str]]:
    """Both, the shorter of each pair; and the problems that `new` lowered or brought."""
    result = {name: dict(records) for name, records in known.items()}
    lowered = []
    for name, records in new.items():
        mine = result.setdefault(name, {})
        for problem, record in records.items():
            if not record["duration_s"] > 0:
                raise ValueError(f"{name}/{problem}: duration {record['duration_s']!r}")
            old = mine.get(problem)
            if old is None or record["duration_s"] < old["duration_s"]:
                mine[problem] = record
                lowered.append(f"{name}/{problem}")
            if old is not None:
                mine[problem] = mine[problem] | {"searched_s": max(old["searched_s"], record["searched_s"])}
    return result, lowered


def write(path: Path, known: Known) -> None:
    """The records on disk. Raises `RaisedError` where one there is lower, or would be gone; then nothing is written."""
    for name, records in read(path).items():
        for problem, record in records.items():
            would = known.get(name, {}).get(problem)
            if would is None or not would["duration_s"] <= record["duration_s"]:
                told = "dropped" if would is None else f"raised to {would['duration_s']}"
                raise RaisedError(f"{name}/{problem}: {record['duration_s']} would be {told}")
    ordered = {name: dict(sorted(records.items())) for name, records in sorted(known.items())}
    lines = json.dumps({"schema": SCHEMA, "records": ordered}, indent=1, allow_nan=False)
    beside = path.with_suffix(".part")
    beside.write_text(lines + "\n", encoding="utf-8")
    beside.replace(path)


def found(name: str, answers: Mapping[str, Mapping[str, Any]], by: str, searched_s: float = 0.0) -> Known:
    """The records that judged answers are, problem by problem: planned ones in which nothing was found."""
    now = commit()["commit"]
    made = {
        problem: {"duration_s": line["duration_s"], "by": by, "commit": now, "searched_s": searched_s}
        for problem, line in answers.items()
        if line.get("findings") == [] and line["duration_s"] is not None
    }
    return {name: made} if made else {}


def main(
    budget_s: Annotated[float, typer.Option(min=0.01, help="Longest search for one problem and seed.")] = 30.0,
    seeds: Annotated[int, typer.Option(min=1, help="Seeds: 0, 1, …")] = 3,
    only: Annotated[list[str] | None, typer.Option(help="Only this problem; repeatable.")] = None,
    limit: Annotated[int | None, typer.Option(min=1, help="Only the first problems of each set.")] = None,
    known: Annotated[Path, typer.Option(help="The file of records; one process at a time writes it.")] = PATH,
    work: Annotated[Path, typer.Option(help="Folder of what was searched so far.")] = ROOT / "out" / "best_known",
) -> None:
    """Search long, and lower the records."""
    asked = [
        (name, match, problem, seed)
        for seed in range(seeds)
        for name, match in SETS
        for problem in problem_set(name).problems[:limit]
        if not only or problem["id"] in only
    ]
    done = Kept(work / f"{budget_s:g}s.jsonl", {"budget_s": budget_s, "sources": sources()})
    warm_up(problem_set(SETS[0][0]))
    count = 0
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        for name, match, problem, seed in progress.track(asked, description="searching"):
            item = f"{name}/{match}/{problem['id']}/{seed}"
            if item not in done.records:
                problems = problem_set(name)
                line = answer(problem, problems, Manners(budget_s, "budget", match, seed))
                done.add(item, judged(problems, problem, line, match))
            by = f"assur, {budget_s:g} s, seed {seed}"
            searched = budget_s * (seed + 1)
            records = found(label(name, match), {problem["id"]: done.records[item]}, by, searched)
            all_of_them, lowered = merged(read(known), records)
            if records:
                write(known, all_of_them)
            count += len(lowered)
    total = sum(len(records) for records in read(known).values())
    Console().print(f"{len(asked)} searches, {count} records lowered or new, {total} problems have one")


if __name__ == "__main__":
    typer.run(main)
