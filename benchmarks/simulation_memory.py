"""``python -m benchmarks.simulation_memory``: what a run of 100,000 parts keeps in memory.

One run of a belt-to-nest cell (`benchmarks.flows`), every motion planned, proved and checked. Parts come twice as often
as the arm can take them, as near as they may be: the others are missed. So the run is shorter than a day, which is as
long as a simulation may be. The memory of the process is read each 1 % of the run. Until the first reading libraries
and kernels are loaded, and what is kept is made.
"""

from __future__ import annotations

import gc
import resource
from pathlib import Path
from typing import Annotated

import typer

from assur.scenes.set_values import with_values
from assur.scenes.simulation.cell import simulated
from assur.scenes.simulation.run import Run
from benchmarks.figures import Document, figure, finish, progress
from benchmarks.flows import flow

PARTS, FEW_PARTS = 100_000, 40
CELL, STREAM, PERIOD_S = "belt-to-nest", "brackets", 0.5
"""So often a part comes, s."""
READINGS = 100
MIB = 2**20
STATM = Path("/proc/self/statm")


def main(
    parts: Annotated[int, typer.Option(help="Number of parts that come.")] = PARTS,
    quick: Annotated[bool, typer.Option("--quick", help="A few parts.")] = False,
) -> None:
    """Measure what a long run keeps."""
    parts = FEW_PARTS if quick else parts
    records = measured(parts)

    def grown(rows: list[Document]) -> float:
        return float(max(row["resident_mib"] for row in rows) - rows[0]["resident_mib"])

    figures = [
        figure("memory that grows in a long run", [records], grown, "MiB", (20.0,), note=f"{parts} parts come"),
        figure("parts that were seen in it", [records], lambda rows: rows[-1]["known"], decimals=0),
        figure("motions in it, proved and checked", [records], lambda rows: rows[-1]["checked"], decimals=0),
    ]
    finish("simulation_memory", "memory of a long run", quick, {"parts": parts}, records, figures)


def measured(parts: int, readings: int = READINGS) -> dict[str, Document]:
    """The records of a run of so many parts: the resident memory, MiB, and the motions until then."""
    until_s, records = parts * PERIOD_S, dict[str, Document]()
    run = Run(simulated(with_values(flow(CELL), {f"streams.{STREAM}.every_s": PERIOD_S})), 1, until_s, 20.0)
    for number in progress(range(1, readings + 1), "parts"):
        while run.session.clock_s < until_s * number / readings:
            run.step()
        gc.collect()
        resident = int(STATM.read_text(encoding="ascii").split()[1]) * resource.getpagesize()
        figures = {key: getattr(run.tally, key) for key in ("known", "plans", "checked")}
        records[f"{number} of {readings}"] = {"resident_mib": resident / MIB, **figures, "findings": []}
    return records


if __name__ == "__main__":
    typer.run(main)
