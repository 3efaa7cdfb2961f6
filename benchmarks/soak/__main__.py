"""``python -m benchmarks.soak``: exit 1 if any run of any plan keeps a promise not, or errors are overstated."""

from __future__ import annotations

import signal
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

from benchmarks.soak.campaign import REALISATIONS, Tally, campaign

CONSOLE, PROGRESS = Console(width=140), Console(stderr=True)
LARGEST_MEDIAN = 1.3
"""Of the error that is reported over the worst that was realised."""


def main(
    plans: Annotated[int, typer.Option(min=1, help="Accepted plans to run.")] = 2000,
    realisations: Annotated[int, typer.Option(min=8, help="Runs of each.")] = REALISATIONS,
    seed: Annotated[int, typer.Option(min=0, help="Another seed makes other cells.")] = 0,
    out: Annotated[Path, typer.Option(help="Where cases that fail are written.")] = Path("out/soak"),
    check: Annotated[bool, typer.Option("--check", help="Every plan goes through the checker, too.")] = False,
) -> None:
    """Plan random cells, run each plan many times with what is not known realised, and print what was found."""
    found: dict[str, Tally] = {}
    # also where a shell that started this in the background has it ignored
    signal.signal(signal.SIGINT, signal.default_int_handler)
    with Progress(console=PROGRESS) as progress:
        task = progress.add_task("plans", total=plans)
        try:
            for found in campaign(plans, seed, out, realisations, check):
                progress.update(task, completed=sum(tally.planned for tally in found.values()))
        except KeyboardInterrupt:
            PROGRESS.print("interrupted: what was run until then")
    CONSOLE.print(table_of(found))
    total = Tally()
    for tally in found.values():
        total.merged(tally)
    reasons = ", ".join(f"{reason} {count}" for reason, count in total.refused.most_common())
    CONSOLE.print(f"refused: {reasons or 'none'}")
    CONSOLE.print(f"refused by the checker: {total.unchecked}")
    if not total.clean:
        CONSOLE.print(f"NOT CLEAN: {dict(total.faults)}; see {out}")
    if not total.clean or (total.median or 0.0) > LARGEST_MEDIAN:
        raise typer.Exit(1)


def table_of(found: dict[str, Tally]) -> Table:
    table = Table(box=None, header_style="bold")
    for name in ("kind", "accepted", "refused", "runs", "collisions", "faults", "contact mm", "allowed mm"):
        table.add_column(name, justify="left" if name == "kind" else "right")
    table.add_column("reported / worst", justify="right")
    table.add_column("max", justify="right")
    total = Tally()
    for kind, tally in found.items():
        total.merged(tally)
        table.add_row(*_row(kind, tally))
    table.add_row(*_row("all", total), style="bold")
    return table


def _row(kind: str, tally: Tally) -> list[str]:
    deep = ("", "") if tally.deepest_allowed_m == 0.0 else (tally.deepest_m * 1e3, tally.deepest_allowed_m * 1e3)
    return [
        kind,
        str(tally.planned),
        str(tally.refused.total()),
        str(tally.runs),
        str(tally.collisions),
        str(tally.faults.total() + tally.unchecked.unknown),
        *(each if isinstance(each, str) else f"{each:.3f}" for each in deep),
        "" if tally.median is None else f"{tally.median:.3f}",
        f"{max(tally.ratios):.2f}" if tally.ratios else "",
    ]


if __name__ == "__main__":
    typer.run(main)
