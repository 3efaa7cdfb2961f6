"""``python -m benchmarks.soak_service``: the service under attack; exit 1 if a bar is not met.

Each row starts the services that it needs as processes of their own, and observes them only from outside.
"""

from __future__ import annotations

import json
import signal
import time
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from benchmarks.machine import machine
from benchmarks.soak_service import table as page_table
from benchmarks.soak_service.row import NOT_MET, Result, Row, Run, run_row
from benchmarks.soak_service.rows import ROWS

CONSOLE, PROGRESS = Console(width=140), Console(stderr=True, highlight=False, markup=False, soft_wrap=True)


def main(
    short: Annotated[bool, typer.Option("--short", help="Less of everything, in about 3 minutes.")] = False,
    only: Annotated[list[str] | None, typer.Option(help=f"A row: {', '.join(row.name for row in ROWS)}.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="Another seed makes other requests.")] = 0,
    out: Annotated[Path, typer.Option(help="Results; those of rows that are not run stay.")] = Path(
        "out/soak-service/results.json"
    ),
    page: Annotated[bool, typer.Option("--page", help="Write the table of docs/how-it-is-tested.md, too.")] = False,
) -> None:
    """Run the rows, print the results with their bars, and write them."""
    unknown = set(only or ()) - {row.name for row in ROWS}
    if unknown:
        raise typer.BadParameter(
            f"no such row: {', '.join(sorted(unknown))}; there are {', '.join(r.name for r in ROWS)}"
        )
    # also where a shell that started this in the background has it ignored: the services end with their blocks
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.default_int_handler)
    chosen = [row for row in ROWS if not only or row.name in only]
    out.parent.mkdir(parents=True, exist_ok=True)
    results = []
    for row in chosen:
        result = _run(row, Run(short, seed, out.parent, _say(row.name)))
        results.append(result)
        _write(out, result)
    CONSOLE.print(_table(chosen, results))
    if page:
        write_page(out)
    if any(result.verdict == NOT_MET for result in results):
        raise typer.Exit(1)


def write_page(results: Path) -> None:
    """Fills the page from a file of results, and keeps the results beside those of other benchmarks."""
    page_table.KEPT.write_text(results.read_text(encoding="utf-8"), encoding="utf-8")
    text = page_table.table(ROWS, page_table.read(page_table.KEPT))
    page_table.PAGE.write_text(page_table.filled(page_table.PAGE.read_text(encoding="utf-8"), text), encoding="utf-8")


def _say(name: str) -> Callable[[str], None]:
    began = time.monotonic()
    return lambda text: PROGRESS.print(f"{name} {time.monotonic() - began:6.1f} s  {text}")


def _run(row: Row, run: Run) -> Result:
    run.say(f"{row.title}; bar: {row.bar}")
    result = run_row(row, run)
    run.say(f"{result.told}; {result.verdict}{': ' if result.reasons else ''}{'; '.join(result.reasons)}")
    return result


def _write(out: Path, result: Result) -> None:
    """Puts a row into the results at once: it stays even if the next row fails."""
    document = page_table.read(out)
    document["machine"] = machine()
    document["rows"][result.name] = result.document()
    out.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")


def _table(rows: list[Row], results: list[Result]) -> Table:
    table = Table(header_style="bold")
    for name in ("row", "bar", "found", "verdict", "why"):
        table.add_column(name)
    for row, result in zip(rows, results, strict=True):
        why = "\n".join([*result.reasons[:4], *(["..."] if len(result.reasons) > 4 else [])])
        table.add_row(row.name, row.bar, result.told, result.verdict, why)
    return table


if __name__ == "__main__":
    typer.run(main)
