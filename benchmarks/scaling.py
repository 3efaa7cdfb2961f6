"""``python -m benchmarks.scaling``: how planning time grows with the bodies of the cell.

Distant bodies: 10 to 1,000 of the same density round one path. Each cell contains all smaller ones, so only the cost of
excluding the far bodies differs. Bodies aside: ten or a thousand within the arm's reach and away from its
way. Every size is built and planned anew in each repeat, one size after the other.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Annotated

import numpy as np
import typer

from benchmarks.commits import ask, planning
from benchmarks.figures import Document, Figure, Records, figure, finish, progress
from benchmarks.first_answer import refusals
from benchmarks.judged import judged, problem_set
from benchmarks.machine import ROOT, pin
from benchmarks.peers.arm import along
from benchmarks.problem_set import Problem
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
        runs = [(kind, cell, i) for kind in sizes for cell in range(cells) for i in range(repeats)]
        for kind, cell, i in progress(runs, "scaling"):
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


DENSITY_M2 = 8.0
"""Bodies in a square metre of floor: ten of them within the arm's reach of 0.6 m, as crowded as a static problem."""
INNER_M = 0.12
"""Least distance of a body from the shoulder's axis."""
CLEAR_M = 0.07
"""Least distance of a body from start or goal, from above."""
ASIDE_M, ASIDE_RAD = (0.2, 0.58), 2.4
"""Places of bodies that the arm could reach and does not come near: radii, and least angle from the front."""
SMALL_M = 0.004
"""Edge of a body that is so small that a thousand of them are apart from each other."""


def _point(r: float, angle: float) -> list[float]:
    """A place of the tool, m."""
    return [float(r * np.cos(angle)), float(r * np.sin(angle)), 0.12]


def crowd(seed: int, bodies: int) -> Problem:
    """A static problem with this many bodies. Those of a smaller crowd are in every larger one: they fill the floor
    from the middle outwards, evenly, so what the arm can reach is the same whatever their number."""
    random = np.random.default_rng([11, seed])
    begin = _point(0.42, random.uniform(-1.2, -0.6))
    goal = _point(random.uniform(0.3, 0.5), random.uniform(0.6, 1.2))
    start = along(begin, begin, (0.0, 0.0), 1.0, 1)[0].tolist()  # yaw 0, the elbow on the right
    obstacles: list[Document] = []
    area = np.pi * INNER_M**2
    while len(obstacles) < bodies:
        area += random.exponential(1 / DENSITY_M2)
        r, angle = np.sqrt(area / np.pi), random.uniform(-np.pi, np.pi)
        edge, height, yaw = random.uniform(0.04, 0.1), random.uniform(0.05, 0.24), random.uniform(-1.0, 1.0)
        upright_box = bool(random.integers(2))
        at = np.array([r * np.cos(angle), r * np.sin(angle)])
        if min(np.linalg.norm(at - np.array(each[:2])) for each in (begin, goal)) < CLEAR_M + edge:
            continue
        pos = [float(at[0]), float(at[1]), height / 2]
        if upright_box:
            obstacles.append({"type": "box", "size": [edge, edge, height], "pos": pos, "yaw": yaw})
        else:
            obstacles.append({"type": "cylinder", "radius": edge / 2, "height": height, "pos": pos, "yaw": 0.0})
    return {
        "id": f"crowd-{seed}-{bodies}",
        "start": start,
        "goal": {"pos": goal, "yaw": 0.0},
        "obstacles": obstacles,
    }


def aside(seed: int, bodies: int) -> Problem:
    """Start and goal in front of the arm; all bodies are behind it, within its reach."""
    random = np.random.default_rng([14, seed])
    obstacles: list[Document] = []
    for _ in range(bodies):
        r, angle = random.uniform(*ASIDE_M), np.pi + random.uniform(ASIDE_RAD - np.pi, np.pi - ASIDE_RAD)
        pos = [float(r * np.cos(angle)), float(r * np.sin(angle)), random.uniform(0.05, 0.25)]
        obstacles.append({"type": "box", "size": [SMALL_M] * 3, "pos": pos, "yaw": random.uniform(-1.0, 1.0)})
    return crowd(seed, 0) | {"id": f"aside-{seed}-{bodies}", "obstacles": obstacles}


if __name__ == "__main__":
    typer.run(main)
