"""``python -m benchmarks.recheck FILE.json OUT.jsonl``: exit 1 if anything is wrong with any answer."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import track
from rich.table import Table

from benchmarks.judge.problems import Finding, recheck
from benchmarks.problem_set import ProblemSet, read_problem_set

CONSOLE = Console(stderr=True)


def main(
    file: Annotated[Path, typer.Argument(exists=True, dir_okay=False, help="The problem set that was run.")],
    answers: Annotated[Path, typer.Argument(exists=True, dir_okay=False, help="What run_problems wrote.")],
    match: Annotated[str, typer.Option(help="position, velocity, or what each line says it was run with.")] = "stated",
    partial: Annotated[bool, typer.Option("--partial", help="Not every problem of the set was run.")] = False,
) -> None:
    """Recheck every answer by a second implementation of everything."""
    if match not in ("stated", "position", "velocity"):
        raise typer.BadParameter("position, velocity or stated", param_hint="--match")
    problems = read_problem_set(file)
    lines = answers.read_bytes().splitlines()
    findings, counts = recheck_lines(problems, lines, match, partial)
    report(findings, counts)
    raise typer.Exit(1 if findings else 0)


def recheck_lines(
    problems: ProblemSet, lines: list[bytes], match: str = "stated", partial: bool = False
) -> tuple[list[Finding], Counter[str]]:
    """Findings over all lines of an answer file, lines that are missing or too many among them."""
    findings: list[Finding] = []
    counts: Counter[str] = Counter()
    by_name = {str(problem["id"]): problem for problem in problems.problems}
    seen: set[str] = set()
    for number, line in enumerate(track(lines, "recheck", console=CONSOLE, transient=True), start=1):
        try:
            answer: dict[str, Any] = json.loads(line)
            name = str(answer["id"])
        except (ValueError, KeyError, TypeError) as error:
            findings.append(Finding(f"line {number}", "form", f"not an answer: {error!r}"))
            continue
        if name in seen or name not in by_name:
            findings.append(Finding(name, "form", "answered twice" if name in seen else "not a problem of this set"))
            continue
        seen.add(name)
        counts[str(answer.get("status"))] += 1
        velocity = (answer.get("match") if match == "stated" else match) == "velocity"
        findings += recheck(problems, by_name[name], answer, "velocity" if velocity else "position")
    if not partial:
        findings += [Finding(name, "form", "has no line") for name in by_name if name not in seen]
    return findings, counts


def report(findings: list[Finding], counts: Counter[str]) -> None:
    """The findings as a table, and the number of checked answers in a sentence."""
    console = Console()
    counted = ", ".join(f"{count} {status}" for status, count in sorted(counts.items()))
    if not findings:
        console.print(f"rechecked every 0.5 ms ({counted}): nothing found")
        return
    table = Table("problem", "kind", "finding", title=f"{len(findings)} findings ({counted})")
    for finding in findings:
        table.add_row(finding.problem, finding.kind, finding.text)
    console.print(table)


if __name__ == "__main__":
    typer.run(main)
