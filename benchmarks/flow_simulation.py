"""``python -m benchmarks.flow_simulation``: parts a minute of five cells by each rule, with proved motions.

Each cell (`benchmarks.flows`) runs with each rule on the same parts: every motion is planned with the obstacles of the
cell, proved, checked and committed, as `assur simulate` does. The best simple rule is chosen afterwards, cell by cell;
that favours it. What the runs simulate over the time that this process takes is measured, too.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Annotated

import numpy as np
import typer

import assur
from assur.planner.selection.names import RULES
from assur.scenes.simulation.simulate import interval
from benchmarks.figures import Document, figure, finish, progress
from benchmarks.flows import FLOWS, flow
from benchmarks.machine import pin

AHEAD, *SIMPLE = RULES
MINUTES, SEEDS = 5.0, 10
FEW_MINUTES, FEW_SEEDS = 0.25, 2
FIRST, FIRST_MINUTES = 1, 0.2
"""The first seed; a run so long is not counted: in it the kernels are loaded, and what is kept is made."""
RHYTHM, TWO = "belt-to-nest", "two-belts-two-places"
"""The cell at 60 parts a minute, and the one in which the order is worth most."""


def main(
    minutes: Annotated[float, typer.Option(help="Length of each run, on its own clock.")] = MINUTES,
    seeds: Annotated[int, typer.Option(help="Number of runs of each cell with each rule, two or more.")] = SEEDS,
    quick: Annotated[bool, typer.Option("--quick", help="Few and short runs.")] = False,
) -> None:
    """Compare the rules."""
    minutes, seeds = (FEW_MINUTES, FEW_SEEDS) if quick else (minutes, seeds)
    if seeds < 2:
        raise typer.BadParameter(f"--seeds: got {seeds}; allowed: 2 or more, for an interval")
    parameters: Document = {"minutes": minutes, "seeds": seeds, "pinned": pin()}
    assur.simulate(flow(RHYTHM), minutes=FIRST_MINUTES)
    records = {name: compared(name, minutes, seeds) for name in progress(FLOWS, "cells")}
    every, rhythm, two = records, {RHYTHM: records[RHYTHM]}, {TWO: records[TWO]}

    def least(key: str) -> Callable[[list[Document]], float | None]:
        return lambda rows: min(row[key] for row in rows)

    gain, times = "look-ahead over the best simple rule", "simulated time over the time of a simulation"
    words = "; ".join(f"{name} {row['gain']:+.1f} ± {row['half_width']:.1f}" for name, row in records.items())
    cpu = least("real_time_cpu")
    figures = [
        figure(f"{gain}, proved motions, the least", [every], least("gain"), "%", (-1.0,), at_least=True, note=words),
        figure(f"{gain}, proved motions, two belts and two places", [two], least("gain"), "%", (2.0,), at_least=True),
        figure(f"{times}, 60 parts a minute, process CPU time", [rhythm], cpu, "times", (60.0,), at_least=True),
        figure(f"{times}, 60 parts a minute", [rhythm], least("real_time"), "times"),
        figure(f"{times}, the least of all cells, process CPU time", [every], cpu, "times"),
    ]
    finish("flow_simulation", "simulated cells, rule by rule", quick, parameters, records, figures)


def compared(name: str, minutes: float, seeds: int) -> Document:
    """Parts a minute of each rule in a cell, the best simple one, and by how much the look-ahead is better, %, with
    half of its 95 % interval over paired seeds; and simulated time over that of the process, of the look-ahead."""
    found, runs = flow(name), dict[str, Document]()
    for rule in RULES:
        began, began_cpu = time.perf_counter(), time.process_time()
        made = assur.simulate({**found, "selection": rule}, minutes=minutes, seed=FIRST, seeds=seeds)
        took_s, cpu_s = time.perf_counter() - began, time.process_time() - began_cpu
        runs[rule] = {
            "parts_per_minute": [run["parts_per_minute"] for run in made["runs"]],
            "real_time": 60.0 * minutes * seeds / took_s,
            "real_time_cpu": 60.0 * minutes * seeds / cpu_s,
            **{key: made[key] for key in ("placed", "missed", "cycle_s", "moving", "plans", "checked", "refusals")},
        }
    rates = {rule: np.array(run["parts_per_minute"]) for rule, run in runs.items()}
    best = max(SIMPLE, key=lambda rule: float(rates[rule].mean()))
    gains = 100.0 * (rates[AHEAD] - rates[best]) / float(rates[best].mean())
    low, high = interval(gains.tolist()) or [-np.inf, np.inf]
    return {
        "each_minute": {rule: float(each.mean()) for rule, each in rates.items()},
        "best_simple": best,
        "gain": float(gains.mean()),
        "half_width": 0.5 * (high - low),
        **{key: runs[AHEAD][key] for key in ("real_time", "real_time_cpu")},
        "runs": runs,
        "findings": [],
    }


if __name__ == "__main__":
    typer.run(main)
