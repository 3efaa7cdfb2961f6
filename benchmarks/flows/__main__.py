"""``python -m benchmarks.flows OUT``: writes the cells with streams, arrivals and results as a data set."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from assur.scenes.simulation.simulate import LEAST_MINUTES, MOST_MINUTES, MOST_SEEDS
from benchmarks.flow_simulation import FEW_MINUTES, FEW_SEEDS, FIRST, MINUTES, SEEDS
from benchmarks.flows import FLOWS
from benchmarks.flows.data_set import write_data_set

LENGTH = "Length of each run, on its own clock."


def main(
    out: Annotated[Path, typer.Argument(metavar="OUT", help="Folder to write; files of the data set are replaced.")],
    minutes: Annotated[float, typer.Option(min=LEAST_MINUTES, max=MOST_MINUTES, help=LENGTH)] = MINUTES,
    seeds: Annotated[
        int, typer.Option(min=1, max=MOST_SEEDS, help="Number of runs of each cell with each rule.")
    ] = SEEDS,
    only: Annotated[list[str] | None, typer.Option(help="Only this cell; may be given several times.")] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Few and short runs.")] = False,
) -> None:
    """Write the data set."""
    minutes, seeds = (FEW_MINUTES, FEW_SEEDS) if quick else (minutes, seeds)
    for name in only or ():
        if name not in FLOWS:
            raise typer.BadParameter(f"--only: got {name}; allowed: one of {', '.join(FLOWS)}")
    shown = Console(stderr=True)
    for what in write_data_set(out, minutes=minutes, seeds=range(FIRST, FIRST + seeds), names=only or FLOWS):
        shown.print(what)


if __name__ == "__main__":
    typer.run(main)
