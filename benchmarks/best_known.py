"""``python -m benchmarks.best_known``: the shortest motion known for each problem, in `benchmarks/best_known.json`.

A record may only ever be lowered, and only by an answer that the checker accepts and in which the independent recheck
finds nothing, jerk included. So neither `witness` nor `direct_time` of the problem files is a record: both are
trapezoids without a limit of jerk. For each problem the planner searches 30 s with each of 3 seeds, which takes ten
hours for all of them; the command can be stopped, and goes on where it was. `--worst 0.25` searches only the quarter
of the problems whose duration in the results of `benchmarks.durations` is furthest above its record.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import track

from benchmarks.commits import ask, planning
from benchmarks.figures import FOLDER
from benchmarks.figures import read as read_result
from benchmarks.judged import SETS, judged, label, problem_set
from benchmarks.machine import ROOT, commit, sources
from benchmarks.translation import Terms, request

PATH = ROOT / "benchmarks" / "best_known.json"
SCHEMA = "assur-best-known/1"

Record = dict[str, Any]
Known = dict[str, dict[str, Record]]
"""Set in words → problem → {duration_s, by, commit, searched_s}. `searched_s`: time that this command searched for it;
0 for records from other runs."""


class RaisedError(Exception):
    """A record would be raised or dropped."""


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
                change = "dropped" if would is None else f"raised to {would['duration_s']}"
                raise RaisedError(f"{name}/{problem}: {record['duration_s']} would be {change}")
    ordered = {name: dict(sorted(records.items())) for name, records in sorted(known.items())}
    lines = json.dumps({"schema": SCHEMA, "records": ordered}, indent=1, allow_nan=False)
    beside = path.with_suffix(".part")
    beside.write_text(lines + "\n", encoding="utf-8")
    beside.replace(path)


def lower(path: Path, new: Known) -> list[str]:
    """Writes records that are lower or new, and returns the names of their problems."""
    everything, lowered = merged(read(path), new)
    if new:
        write(path, everything)
    return lowered


def found(name: str, answers: Mapping[str, Mapping[str, Any]], by: str, searched_s: float = 0.0) -> Known:
    """The records that judged answers are, problem by problem: planned ones in which nothing was found."""
    now = commit()["commit"]
    made = {
        problem: {"duration_s": line["duration_s"], "by": by, "commit": now, "searched_s": searched_s}
        for problem, line in answers.items()
        if line.get("findings") == [] and line.get("duration_s") is not None
    }
    return {name: made} if made else {}


def searched(path: Path, key: Record) -> dict[str, Record]:
    """Answers of an earlier run by their items, in a file whose first line is `key`; a file of another run is begun
    anew, and a last line that was cut off in writing is dropped."""
    first = json.dumps(key, sort_keys=True)
    lines = path.read_text(encoding="utf-8").split("\n") if path.exists() else []
    kept = lines[1:-1] if lines and lines[0] == first else []
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("".join(line + "\n" for line in [first, *kept]), encoding="utf-8")
    return {record["item"]: record for record in map(json.loads, kept)}


def worst(share: float) -> set[str]:
    """This share of the problems, as ``set/problem``: those furthest above their record in `benchmarks.durations`."""
    ratios = {
        item.removeprefix("0.2/"): record["duration_s"] / record["best_s"]
        for item, record in read_result(FOLDER / "durations.jsonl")[1].items()
        if item.startswith("0.2/") and record["status"] == "planned" and record["best_s"]
    }
    return set(sorted(ratios, key=lambda item: -ratios[item])[: round(share * len(ratios))])


def main(
    budget_s: Annotated[float, typer.Option(min=0.01, help="Longest search for one problem and seed.")] = 30.0,
    seeds: Annotated[int, typer.Option(min=1, help="Seeds: 0, 1, …")] = 3,
    only: Annotated[list[str] | None, typer.Option(help="Only this problem; repeatable.")] = None,
    share: Annotated[float | None, typer.Option("--worst", help="Only this share: the largest ratios.")] = None,
    known: Annotated[Path, typer.Option(help="The file of records; one process at a time writes it.")] = PATH,
    work: Annotated[Path, typer.Option(help="Folder of what was searched so far.")] = ROOT / "out" / "best_known",
) -> None:
    """Search long, and lower the records."""
    chosen = None if share is None else worst(share)
    searches = [
        (name, match, problem, seed)
        for seed in range(seeds)
        for name, match in SETS
        for problem in problem_set(name).problems
        if (not only or problem["id"] in only) and (chosen is None or f"{label(name, match)}/{problem['id']}" in chosen)
    ]
    path = work / f"{budget_s:g}s.jsonl"
    done = searched(path, {"budget_s": budget_s, "sources": sources()})
    count = 0
    with planning(ROOT, problem_set(SETS[0][0])) as program, path.open("a", encoding="utf-8") as stream:
        for name, match, problem, seed in track(searches, "searching", console=Console(stderr=True), transient=True):
            item = f"{name}/{match}/{problem['id']}/{seed}"
            if item not in done:
                problems = problem_set(name)
                document = request(problem, problems.limits, Terms(budget_s, "budget", match, seed))
                done[item] = {"item": item, **judged(problems, problem, ask(program, document), match, document)}
                stream.write(json.dumps(done[item], allow_nan=False) + "\n")
                stream.flush()
            by = f"assur, {budget_s:g} s, seed {seed}"
            count += len(
                lower(known, found(label(name, match), {problem["id"]: done[item]}, by, budget_s * (seed + 1)))
            )
    total = sum(len(records) for records in read(known).values())
    Console().print(f"{len(searches)} searches, {count} records lowered or new, {total} problems have one")


if __name__ == "__main__":
    typer.run(main)
