"""``python -m benchmarks.part_order``: what it is worth to look ahead when the next part is chosen, by table times.

Each rule runs on the same streams of parts in seven cells (`benchmarks.selection.cells`). The best simple rule is
chosen afterwards, cell by cell, speed by speed, load by load; that favours it. Eight parts at twice the capacity are
ordered exactly, too: all orders and omissions, with all parts known from the start.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Iterable
from typing import Annotated, Any

import numpy as np
import typer

from assur.planner.selection.names import RULES
from benchmarks.figures import Document, figure, finish, progress
from benchmarks.selection.cells import CELLS, Cell, stream, tables
from benchmarks.selection.running import run

AHEAD, *SIMPLE = RULES
SEEDS, SECONDS = range(30), 300.0
SPEEDS, LOADS = (0.1, 0.2, 0.4), (0.85, 1.0, 1.15, 1.3)
FEW_SEEDS, FEW_SPEEDS, FEW_LOADS = range(2), (0.1,), (1.15,)
EIGHT, EXACT_LOAD, EXACT_S, EXACT_SEEDS, FEW_EXACT = 8, 2.0, 60.0, 200, 5
"""Parts that are ordered exactly; how many come in a mean cycle; until when; how often."""


def main(quick: Annotated[bool, typer.Option("--quick", help="Few seeds, one speed, one load.")] = False) -> None:
    """Compare the rules."""
    seeds, speeds, loads = (FEW_SEEDS, FEW_SPEEDS, FEW_LOADS) if quick else (SEEDS, SPEEDS, LOADS)
    records: dict[str, Document] = {}
    ordered(CELLS["one lane"], 1)  # compiles before anything is timed
    for name, speed, load in progress(list(itertools.product(CELLS, speeds, loads)), "streams"):
        records[f"{name}, {1e3 * speed:g} mm/s, load {load:g}"] = {
            "cell": name, "speed": speed, "load": load, **compared(CELLS[name].at_speed(speed), load, seeds),
        }  # fmt: skip
    exact = {f"{name}, eight parts": ordered(cell, FEW_EXACT if quick else EXACT_SEEDS) for name, cell in CELLS.items()}
    two, mixed = ("two belts, two places",), ("mixed parts", "upstream nest")

    def gain(names: Iterable[str] = CELLS) -> Callable[[list[Document]], float | None]:
        def least(rows: list[Document]) -> float | None:
            chosen = list(names)
            slow = [x for x in rows if x["cell"] in chosen and x["speed"] < 0.4 and x["load"] >= 1.0]
            return min((x["gain"] for x in (rows if chosen == list(CELLS) else slow)), default=None)

        return least

    took = "a decision of the look-ahead, mean, the most"
    of = "look-ahead over the best simple rule, the least"
    figures = [
        figure(f"{of}, all cells", [records], gain(), "%", (-0.5,), at_least=True, decimals=2),
        figure(f"{of}, two belts and two places", [records], gain(two), "%", (4.0,), at_least=True, decimals=2),
        figure(f"{of}, mixed parts, nest upstream", [records], gain(mixed), "%", (2.0,), at_least=True, decimals=2),
        figure("behind the exact order of 8 parts, the most", [exact], _most("behind"), "%", (1.0,), decimals=2),
        figure(took, [records], _most("decision_ms"), "ms", (5.0,), decimals=3),
    ]  # fmt: skip
    finish("part_order", "which part is next", quick, {"seconds": SECONDS}, records | exact, figures)


def _most(key: str) -> Callable[[list[Document]], float | None]:
    return lambda rows: max(x[key] for x in rows)


def compared(cell: Cell, load: float, seeds: Iterable[int]) -> Document:
    """Parts a minute of each rule, the best simple one, and by how much the look-ahead is better, %, with half of its
    95 % interval over paired streams."""
    found: dict[str, list[float]] = {rule: [] for rule in RULES}
    decisions, took = 0, 0.0
    for seed in seeds:
        parts = stream(cell, load, SECONDS, seed)
        for rule in RULES:
            began = time.perf_counter()
            result = run(tables(cell), parts, rule, SECONDS)
            if rule == AHEAD:
                decisions, took = decisions + result.decisions, took + time.perf_counter() - began
            found[rule].append(result.each_minute(SECONDS))
    best = max(SIMPLE, key=lambda rule: float(np.mean(found[rule])))
    gains = 100.0 * (np.array(found[AHEAD]) - found[best]) / np.mean(found[best])
    return {
        "each_minute": {rule: float(np.mean(values)) for rule, values in found.items()},
        "best_simple": best,
        "gain": float(gains.mean()),
        "half_width": float(1.96 * gains.std(ddof=1) / np.sqrt(len(gains))),
        "decision_ms": 1e3 * took / decisions,
        "findings": [],
    }


def ordered(cell: Cell, seeds: int) -> dict[str, Any]:
    """How many of eight parts the look-ahead takes, by how much that is behind the exact order, %."""
    taken, most = 0, 0
    for seed in range(seeds):
        parts = stream(cell, EXACT_LOAD, EXACT_S, seed).first(EIGHT)
        taken += int(np.isfinite(run(tables(cell), parts, AHEAD, EXACT_S).done).sum())
        parts.known[:] = parts.known.min()
        known = run(tables(cell), parts, AHEAD, EXACT_S, depth=EIGHT, lazy=False)
        most += int(np.isfinite(known.done).sum())
    return {"taken": taken / seeds, "exact": most / seeds, "behind": 100.0 * (1.0 - taken / most), "findings": []}


if __name__ == "__main__":
    typer.run(main)
