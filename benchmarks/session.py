"""``python -m benchmarks.session``: replanning while the arm moves, through the public Python API.

The arm follows its plan towards a goal that moves. Every 20 ms the goal's speed is measured anew, and a plan is made
from the state in which the arm is then, position, velocity and acceleration, until the arm is nearly there. Each plan
is the first that is proved, and is checked inside of the time. The robot and what stands around it are read once.
"""

from __future__ import annotations

import time
from typing import Annotated, Any

import numpy as np
import typer

from assur import Cell
from benchmarks.figures import Document, figure, finish, of_planned, progress
from benchmarks.judge.spline import Spline
from benchmarks.judged import problem_set
from benchmarks.machine import pin
from benchmarks.translation import Terms, request

PERIOD_S = 0.02
"""Between plans."""
LAST_S = 0.1
"""With less time than this left the arm keeps its plan."""
SPREAD_M_S = 0.002
"""Standard deviation of the measured speed of the goal."""
MOST = 25
"""Plans of one motion."""
PROBLEMS, FEW = 40, 4
JOINTS = (("q1", "rad"), ("q2", "rad"), ("z", "m"), ("q4", "rad"))


def main(quick: Annotated[bool, typer.Option("--quick", help="Few motions.")] = False) -> None:
    """Measure replanning."""
    parameters: Document = {"problems": FEW if quick else PROBLEMS, "period_s": PERIOD_S, "pinned": pin()}
    problems = problem_set("moving_goal")
    easy = [problem for problem in problems.problems if problem["direct"]][: parameters["problems"]]
    random = np.random.default_rng(1)
    records: dict[str, Document] = {}
    for problem in progress(easy, "session"):
        document = request(problem, problems.limits, Terms(1.0, "first"))
        cell = Cell(document)
        answer = cell.plan(certificate="digest")
        for now in PERIOD_S * np.arange(1, MOST + 1):
            if answer["status"] != "planned" or answer["trajectory"]["time_s"][-1] - now < LAST_S:
                break
            document = moved(document, answer["trajectory"], float(now), random.normal(0.0, SPREAD_M_S, 2))
            changes = {"frames.goal": document["frames"]["goal"]}
            cpu, began = time.process_time(), time.perf_counter()
            answer = cell.plan(start=document["start"], set=changes, certificate="digest")
            record = {"wall_s": time.perf_counter() - began, "cpu_s": time.process_time() - cpu}
            # a missing plan is reported below; no answer is wrong for that
            records[f"{problem['id']} at {now:.2f} s"] = record | {"status": answer["status"], "findings": []}

    unplanned = sum(record["status"] != "planned" for record in records.values())
    note = f"{len(records)} plans, {unplanned} not found"
    figures = [
        figure("replanning, median", [records], of_planned("wall_s", 0.5), "ms", (0.4,), decimals=2, note=note),
        figure("replanning, 99 %", [records], of_planned("wall_s", 0.99), "ms", (2.0,), decimals=2),
        figure("replanning, 99 %, process CPU time", [records], of_planned("cpu_s", 0.99), "ms", decimals=2),
    ]
    finish("session", "replanning while the arm moves", quick, parameters, records, figures)


def moved(document: Document, knots: Document, now: float, off: Any) -> Document:
    """The request from the state at a time of a plan; the goal is where it is then, its speed measured anew."""
    spline = Spline.of(knots)
    start: Document = {"at_s": now}
    for key, derivative, suffix in (("joints", 0, ""), ("velocity", 1, "_s"), ("acceleration", 2, "_s2")):
        values = spline.evaluate(np.array([now]), derivative)[0]
        start[key] = {f"{name}_{unit}{suffix}": float(v) for (name, unit), v in zip(JOINTS, values, strict=True)}
    goal = document["frames"]["goal"]["linear"]
    measured = np.array(goal["velocity_m_s"]) + np.array([*off, 0.0])
    # the law is a line through its position at t = 0, which is chosen so that the place now is the same at a new speed
    at = np.array(goal["at_m"]) + now * (np.array(goal["velocity_m_s"]) - measured)
    frames = document["frames"] | {"goal": {"linear": {"at_m": at.tolist(), "velocity_m_s": measured.tolist()}}}
    return document | {"start": start, "frames": frames}


if __name__ == "__main__":
    typer.run(main)
