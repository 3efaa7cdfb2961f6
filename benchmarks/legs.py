"""``python -m benchmarks.legs``: how much longer straight Cartesian legs are than the joint move between their ends.

Ends are drawn (seeded) with r from 0.25 to 0.52 m, angle within ±1.5 rad, z from 0.06 to 0.20 m, yaw 0, elbow `right`,
for the robot of the problems; lines on which a joint would leave its range are drawn anew. The reference is Ruckig's
motion from rest to rest, the fastest of all joint motions between the ends, straight or not.
"""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
import ruckig
import typer

from benchmarks.commits import ask, planning
from benchmarks.figures import Document, figure, finish, progress, quantile
from benchmarks.first_answer import refusals
from benchmarks.judge.arms import Arm
from benchmarks.judge.spline import Spline
from benchmarks.judged import judged, problem_set
from benchmarks.machine import ROOT, pin
from benchmarks.peers.arm import along
from benchmarks.translation import Terms, request

LEGS, SAMPLE, SEED = 200, 20, 20_240
BUDGET_S = 0.2
R_M, ANGLE_RAD, Z_M = (0.25, 0.52), 1.5, (0.06, 0.20)
SHORT_M = 0.02
"""Ends closer than this make no leg."""
STRAIGHT_M = 2e-5
"""How far a straight leg may leave its line."""
SIGN = 1.0
"""Of θ2, elbow `right`."""
CHECKED = 400
"""Samples of a leg that are held to the line."""


def main(quick: Annotated[bool, typer.Option("--quick", help="A few legs.")] = False) -> None:
    """Measure straight legs."""
    parameters: Document = {"legs": SAMPLE if quick else LEGS, "seed": SEED, "budget_s": BUDGET_S, "pinned": pin()}
    problems = problem_set("static")
    records: dict[str, Document] = {}
    with planning(ROOT, problems) as program:
        for number in progress(range(parameters["legs"]), "legs"):
            start, end = ends(number, problems.limits)
            q = along(start, end, (0.0, 0.0), SIGN, CHECKED)
            problem = {"id": number, "start": q[0].tolist(), "goal": {"pos": end, "yaw": 0.0}, "obstacles": []}
            document = request(problem, problems.limits, Terms(BUDGET_S, "budget"))
            document["task"][0]["move"]["leg"] = "cartesian"
            document["options"]["elbow"] = "keep"
            answer = ask(program, document)
            record = judged(problems, problem, answer, "position", document)
            if answer["status"] == "planned":
                record["findings"] += bent(document, answer["trajectory"], start, end)
            records[f"leg {number}"] = record | {"reference_s": fastest_joint_move(q[0], q[-1], problems.limits)}

    def over(share: float) -> Any:
        return lambda rows: quantile(
            [row["duration_s"] / row["reference_s"] for row in rows if row["status"] == "planned"], share
        )

    missed = sum(record["status"] != "planned" for record in records.values())
    name, note = "straight legs over the joint move", f"{missed} of {len(records)} not planned" if missed else ""
    figures = [
        figure(f"{name}, median", [records], over(0.5), "", (1.1,), decimals=3, note=note),
        figure(f"{name}, 95 %", [records], over(0.95), decimals=3),
        *refusals(records),
    ]
    finish("legs", "straight legs over the joint move between their ends", quick, parameters, records, figures)


def ends(number: int, limits: Any) -> tuple[list[float], list[float]]:
    """Tool points at both ends of a leg on which every joint stays within the limits."""
    random = np.random.default_rng([SEED, number])
    while True:
        r, angle = random.uniform(*R_M, 2), random.uniform(-ANGLE_RAD, ANGLE_RAD, 2)
        z = random.uniform(*Z_M, 2)
        points = np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=-1)
        q = along(points[0], points[1], (0.0, 0.0), SIGN, CHECKED)
        inside = np.all((q >= limits["qmin"]) & (q <= limits["qmax"]))  # not where the line is out of reach: NaN
        if inside and np.linalg.norm(points[1] - points[0]) >= SHORT_M:
            return points[0].tolist(), points[1].tolist()


def bent(document: Document, knots: Document, start: list[float], end: list[float]) -> list[str]:
    """Whether the tool leaves the line between its ends, or does not end there, and by how much."""
    spline = Spline.of(knots)
    q = spline.evaluate(np.linspace(spline.time[0], spline.time[-1], CHECKED))
    p = Arm.of(document["robot"]).tool(q).p
    a, way = np.array(start), np.array(end) - np.array(start)
    s = np.clip((p - a) @ way / (way @ way), 0.0, 1.0)
    off = float(np.linalg.norm(p - a - s[:, None] * way, axis=-1).max())
    missed = float(max(np.linalg.norm(p[0] - a), np.linalg.norm(p[-1] - np.array(end))))
    found = [] if off <= STRAIGHT_M else [f"the tool leaves the line by {off * 1e6:.0f} µm"]
    return found if missed <= STRAIGHT_M else [*found, f"the tool misses an end by {missed * 1e6:.0f} µm"]


def fastest_joint_move(q0: Any, q1: Any, limits: Any) -> float:
    """Seconds from rest to rest, every joint on its own, by Ruckig."""
    parameters = ruckig.InputParameter(4)
    parameters.current_position, parameters.target_position = list(q0), list(q1)
    parameters.max_velocity, parameters.max_acceleration = list(limits["vmax"]), list(limits["amax"])
    parameters.max_jerk = list(limits["jmax"])
    made = ruckig.Trajectory(4)
    if ruckig.Ruckig(4).calculate(parameters, made) != ruckig.Result.Working:
        raise RuntimeError("Ruckig has no motion from rest to rest")
    return float(made.duration)


if __name__ == "__main__":
    typer.run(main)
