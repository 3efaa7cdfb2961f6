"""``python -m benchmarks.judge``: exit 1 if an answer breaks a promise."""

from __future__ import annotations

import signal
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

from benchmarks.judge.campaigns import CAMPAIGNS, SOAK, RunningCampaign, Tally, run

CONSOLE, PROGRESS = Console(width=140), Console(stderr=True)


def main(
    minutes: Annotated[float | None, typer.Option(min=0.01, help="How long; or --count.")] = None,
    count: Annotated[int | None, typer.Option(min=1, help="Answers that each campaign looks at; or --minutes.")] = None,
    only: Annotated[list[str] | None, typer.Option(help=f"{', '.join(CAMPAIGNS)}; default: the first three.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="Another seed makes other cells.")] = 0,
    out: Annotated[Path, typer.Option(help="Where cases that fail are written.")] = Path("out/soak"),
) -> None:
    """Plan random cells, send impossible requests, judge the answers by other means, and print the faults."""
    names = only or list(SOAK)
    if unknown := [name for name in names if name not in CAMPAIGNS]:
        raise typer.BadParameter(f"--only: got {unknown[0]}; allowed: {', '.join(CAMPAIGNS)}")
    if (minutes is None) == (count is None):
        raise typer.BadParameter("one of --minutes and --count")
    going = [RunningCampaign(name, seed) for name in dict.fromkeys(names)]
    # also where a shell that started this in the background has it ignored
    signal.signal(signal.SIGINT, signal.default_int_handler)
    with Progress(console=PROGRESS) as progress:
        tasks = {each.name: progress.add_task(each.name, total=count) for each in going}

        def after_each() -> None:
            for each in going:
                progress.update(tasks[each.name], completed=each.done)

        try:
            run(going, out, count, None if minutes is None else 60.0 * minutes, after_each)
        except KeyboardInterrupt:
            PROGRESS.print("interrupted: what was run until then")
    clean = [_printed(each) for each in going]
    if not all(clean):
        CONSOLE.print(f"NOT CLEAN; see {out}")
        raise typer.Exit(1)


def _printed(going: RunningCampaign) -> bool:
    """Prints what a campaign has found; whether there is nothing wrong."""
    CONSOLE.print(f"\n[bold]{going.name}[/bold], seed {going.seed}: {going.done} answers")
    CONSOLE.print(_table(going.found, going.total))
    return going.total.clean


def _table(found: Mapping[str, Tally], total: Tally) -> Table:
    table = Table(box=None, header_style="bold")
    for name in ("kind", *total.row()):
        table.add_column(name, justify="left" if name in ("kind", "others") else "right")
    for kind, tally in found.items():
        table.add_row(kind, *tally.row().values())
    table.add_row("all", *total.row().values(), style="bold")
    return table


if __name__ == "__main__":
    typer.run(main)
