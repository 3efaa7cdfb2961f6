"""``python -m benchmarks.compiled``: what a compiled kernel would bring, measured.

In an environment with the extra `compiled` (`make bench-compiled` makes one); without numba it says so and measures
nothing.
"""

from __future__ import annotations

import hashlib
import os
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from benchmarks.compiled import table
from benchmarks.machine import ROOT, pin
from benchmarks.report import RESULTS, printed
from benchmarks.runner import write

NAME = "compiled.json"
QUICK = ROOT / "out" / "bench" / "quick" / "results"
KEPT = ROOT / "out" / "compiled"
"""What numba has compiled is kept here, by the digest of the kernels' sources: it looks at a kernel's own file only."""


def kept() -> Path:
    """The folder for these sources."""
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(path.read_bytes() + b"\0")
    return KEPT / digest.hexdigest()[:16]


def measured(quick: bool, console: Console) -> dict[str, Any]:
    """The result; ends the program with a sentence where it cannot be measured."""
    # numba reads this when it is imported
    os.environ.setdefault("NUMBA_CACHE_DIR", str(kept()))
    from benchmarks.compiled import door

    if not door.is_there():
        console.print(door.MISSING, highlight=False)
        raise typer.Exit(2)
    pinned = pin()
    try:
        from benchmarks.compiled.measuring import experiment
    except (ImportError, AttributeError) as error:
        console.print(
            f"The planner has not what this replaces, the experiment must follow it: {error}", highlight=False
        )
        raise typer.Exit(1) from error
    from benchmarks.compiled.comparing import Differs
    from benchmarks.compiled.replacements import Gone

    try:
        return experiment(quick, pinned, lambda text: console.print(text, highlight=False))
    except (Gone, Differs) as error:
        console.print(f"Nothing was timed: {error}", highlight=False)
        raise typer.Exit(1) from error


def main(
    quick: Annotated[bool, typer.Option(help="A sample; the result of the repository is left alone.")] = False,
    out: Annotated[Path | None, typer.Option(help="Folder of the result.")] = None,
) -> None:
    """Compare, measure, write `compiled.json`, print the tables."""
    console = Console()
    document = measured(quick, console)
    folder = out or (QUICK if quick else RESULTS)
    write(folder / NAME, document)
    console.print(printed("whole requests", table.requests(document)))
    console.print(printed("stages of the median requests, ms", table.stages(document)))
    console.print(printed("function by function, ms a request", table.functions(document)))
    console.print(printed("starting", table.starting(document)))


if __name__ == "__main__":
    typer.run(main)
