"""``python -m benchmarks.demo_cycle``: the time of a whole pick and place, from a running belt to a turning dial.

The shipped cell `demo` with `stop: first`, from the request in memory to the checked answer, once with each seed.
"""

from __future__ import annotations

from typing import Annotated

import typer

from assur.scenes import load
from benchmarks.commits import ask, planning
from benchmarks.figures import Document, figure, finish, of_planned
from benchmarks.first_answer import refusals
from benchmarks.judged import problem_set
from benchmarks.machine import ROOT, pin

SEEDS, FEW = 30, 5


def main(quick: Annotated[bool, typer.Option("--quick", help="Few seeds.")] = False) -> None:
    """Measure the planning of the demo's cycle."""
    seeds = FEW if quick else SEEDS
    parameters: Document = {"cell": "demo", "stop": "first", "seeds": seeds, "pinned": pin()}
    records: dict[str, Document] = {}
    with planning(ROOT, problem_set("static")) as program:
        for seed in range(-1, seeds):
            document = load("demo")
            document["options"] |= {"stop": "first", "seed": max(seed, 0)}
            answer = ask(program, document)
            good = answer["status"] == "planned" and answer["checked"]
            answer.pop("trajectory", None)
            if seed >= 0:  # the first warms up: it reads the meshes
                records[f"seed {seed}"] = answer | {"findings": [] if good else [str(answer["reason"])]}

    figures = [
        figure("pick from a belt and place on a dial, median", [records], of_planned("wall_s", 0.5), "ms", (10,)),
        figure("pick from a belt and place on a dial, 95 %", [records], of_planned("wall_s", 0.95), "ms"),
        refusals(records)[0],
    ]
    finish("demo_cycle", "the demo's pick and place", quick, parameters, records, figures)


if __name__ == "__main__":
    typer.run(main)
