"""``python -m benchmarks.scaling``: how planning time grows with the bodies of the cell.

Distant bodies: 10 to 1,000 of the same density round one path, in cells of which each holds all smaller ones, so only
what it costs to rule the far ones out differs. Bodies aside: ten or a thousand within the arm's reach and away from its
way. Every size is built and planned anew in each repeat, one size after the other.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Annotated

import numpy as np
import typer
from rich.console import Console
from rich.progress import track

from benchmarks.cells import aside, crowd
from benchmarks.commits import ask, planning
from benchmarks.figures import Document, Figure, Records, figure, finish
from benchmarks.first_answer import refusals
from benchmarks.judged import judged, problem_set
from benchmarks.machine import ROOT, pin
from benchmarks.translation import Terms, request

SIZES = {"distant": (10, 30, 100, 300, 1000), "aside": (10, 1000)}
FEW_SIZES = {"distant": (10, 1000), "aside": (10, 1000)}
CELLS, FEW_CELLS = 12, 3
REPEATS, FEW_REPEATS = 5, 2
BUDGET_S = 5.0


def main(quick: Annotated[bool, typer.Option("--quick", help="Few sizes and cells.")] = False) -> None:
    """Measure planning and building over the number of bodies."""
    cells, repeats, sizes = (FEW_CELLS, FEW_REPEATS, FEW_SIZES) if quick else (CELLS, REPEATS, SIZES)
    problems = problem_set("static")
    parameters: Document = {"sizes": sizes, "cells": cells, "repeats": repeats, "pinned": pin()}
    records: dict[str, Document] = {}
    with planning(ROOT, problems) as program:
        asked = [(kind, cell, i) for kind in sizes for cell in range(cells) for i in range(repeats)]
        for kind, cell, i in track(asked, "scaling", console=Console(stderr=True)):
            for size in sizes[kind]:
                problem = crowd(cell, size) if kind == "distant" else aside(cell, size)
                document = request(problem, problems.limits, Terms(BUDGET_S))
                record = judged(problems, problem, ask(program, document), "position", document)
                if record["status"] != "planned":  # all of these have a plan
                    record["findings"].append(f"not planned: {record['reason']}")
                records[f"{kind}/{size}/{cell}/{i}"] = record
    finish("scaling", "planning over the number of bodies", quick, parameters, records, figures_of(records, sizes))


def median_s(records: Records, kind: str, size: int, of: Callable[[Document], float]) -> float:
    """Median time over cells and repeats, s."""
    return float(np.median([of(record) for item, record in records.items() if item.startswith(f"{kind}/{size}/")]))


def building(record: Document) -> float:
    """Seconds to read a request and build its scene."""
    return float(record["build_s"])


def searching(record: Document) -> float:
    """Seconds to plan on a built scene."""
    return float(record["wall_s"] - record["build_s"])


def figures_of(records: Records, sizes: Mapping[str, tuple[int, ...]]) -> list[Figure]:
    """What each further body costs, and the growth from ten to a thousand."""
    least, most = min(sizes["distant"]), max(sizes["distant"])
    distant, near = (
        {item: record for item, record in records.items() if item.startswith(f"{kind}/")} for kind in sizes
    )

    def each_us(of: Callable[[Document], float]) -> float:
        ends = [median_s(records, "distant", size, of) for size in (least, most)]
        return 1e6 * (ends[1] - ends[0]) / (most - least)

    def growth() -> float:
        return median_s(records, "aside", most, searching) / median_s(records, "aside", least, searching)

    return [
        figure("each further distant body, planning", [distant], lambda _: each_us(searching), "µs", (1,)),
        figure("each further distant body, building", [distant], lambda _: each_us(building), "µs", (20,)),
        figure("a thousand bodies within reach over ten, planning", [near], lambda _: growth(), "times", (4,)),
        *refusals(records),
    ]


if __name__ == "__main__":
    typer.run(main)
