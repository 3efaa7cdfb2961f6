"""``python -m benchmarks.bench [--quick]``: measure every section, write its result, print the table of the bars.

A run that was stopped goes on where it was, as long as neither sources nor parameters nor machine have changed. A quick
run takes a sample of everything, and leaves its results beside the full ones, never in their place.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from benchmarks import runner
from benchmarks.bars import answers, refused, table
from benchmarks.machine import ROOT
from benchmarks.progress import Progress as Kept
from benchmarks.report import peers, printed, results, sections
from benchmarks.sections.all_of_them import SECTIONS

RESULTS = ROOT / "benchmarks" / "results"
WORK = ROOT / "out" / "bench"
"""Progress and logs: nothing in it is needed once results are written."""
WIDTH = 120
"""Characters of the tables, where the terminal has not more."""


def main(
    quick: Annotated[bool, typer.Option("--quick", help="A sample of everything, in under 3 minutes.")] = False,
    only: Annotated[list[str] | None, typer.Option(help="Only this section; repeatable.")] = None,
    out: Annotated[Path | None, typer.Option(help="Folder of the results.")] = None,
    progress: Annotated[Path | None, typer.Option(help="Folder of what was measured so far.")] = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="Do not resume: measure everything again.")] = False,
) -> None:
    """Run the benchmark. Exit 1 if an answer was not clean."""
    names = [section.name for section in SECTIONS]
    for name in only or []:
        if name not in names:
            raise typer.BadParameter(f"one of {', '.join(names)}", param_hint="--only")
    work = (progress or WORK) / ("quick" if quick else "full")
    folder = out or (work / "results" if quick else RESULTS)
    work.mkdir(parents=True, exist_ok=True)
    columns = (TextColumn("{task.description:<10}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True)) as shown:
        for section in SECTIONS:
            if only and section.name not in only:
                continue
            parameters = section.parameters(quick)
            path = work / f"{section.name}.jsonl"
            if fresh:
                path.unlink(missing_ok=True)
            kept = Kept(path, runner.key(section, parameters, quick))
            items = section.items(parameters)
            records_there = [kept.records.get(item.name) for item in items]
            there = sum(record is not None and not section.again(record) for record in records_there)
            task = shown.add_task(section.name, total=len(items), completed=there)
            opened = partial(runner.process, log=work / "log.txt")
            records = runner.measured(section, parameters, kept, partial(shown.advance, task), opened)
            made = section.summary(parameters, records)
            if section.after is not None and not quick:
                section.after(parameters, records)
            runner.write(folder / f"{section.name}.json", runner.result(section, parameters, quick, records, made))
    there_now = sections(results(folder))
    console = Console(width=max(WIDTH, Console().width))
    if "peers" in there_now:
        console.print(printed("ours and the peers, static problems", peers(there_now)))
    console.print(table(there_now, "a sample; " if quick else ""))
    for text in refused(there_now):
        console.print(f"refused: {text}", soft_wrap=True)
    console.print(f"results: {folder.relative_to(ROOT) if folder.is_relative_to(ROOT) else folder}")
    raise typer.Exit(1 if answers(there_now)[1] else 0)


if __name__ == "__main__":
    typer.run(main)
