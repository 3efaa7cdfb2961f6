"""Straight Cartesian legs: how much longer than the joint move between the same ends.

Ends are drawn (seeded) with r from 0.25 to 0.52 m, angle within ±1.5 rad, z from 0.06 to 0.20 m, yaw 0, elbow `right`,
for the robot of the problems; lines on which a joint would leave its range are drawn anew. The reference is Ruckig's
motion from rest to rest, the fastest of all joint motions between the ends, straight or not. TOPPRA times the same
line without a limit of jerk, in the environment of the peers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import ruckig

from benchmarks.cold import forget
from benchmarks.figures import figure, quantile
from benchmarks.judged import judged, problem_set, warm_up
from benchmarks.peers.arm import along
from benchmarks.peers.running import environment_of, peers
from benchmarks.problem_set import Problem
from benchmarks.recheck.arm import tool
from benchmarks.recheck.spline import Spline
from benchmarks.run_problems import planned
from benchmarks.section import Document, Item, Records, Section, Summary, died
from benchmarks.translation import Manners, request

LEGS, SAMPLE, SEED = 200, 20, 20_240
BUDGET_S = 0.2
R_M, ANGLE_RAD, Z_M = (0.25, 0.52), 1.5, (0.06, 0.20)
SHORT_M = 0.02
"""Ends closer than this make no leg."""
STRAIGHT_M = 2e-5
"""How far a straight leg of ours may leave its line."""
PEER_STRAIGHT_M = 2e-4
"""Likewise TOPPRA's spline through 41 points."""
SIGN = 1.0
"""Of θ2, elbow `right`."""
CHECKED = 400
"""Samples of a leg that are held to the line."""


def parameters(quick: bool) -> Document:
    return {"legs": SAMPLE if quick else LEGS, "seed": SEED, "budget_s": BUDGET_S, "stop": "budget"}


def items(parameters: Document) -> list[Item]:
    return [Item("legs", f"leg {i}") for i in range(parameters["legs"])]


def ends(number: int, seed: int, limits: Any) -> tuple[list[float], list[float]]:
    """Tool points at both ends of a leg on which every joint stays within the limits."""
    random = np.random.default_rng([seed, number])
    while True:
        r, angle = random.uniform(*R_M, 2), random.uniform(-ANGLE_RAD, ANGLE_RAD, 2)
        z = random.uniform(*Z_M, 2)
        points = np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=-1)
        q = along(points[0], points[1], (0.0, 0.0), SIGN, CHECKED)
        inside = np.all((q >= limits["qmin"]) & (q <= limits["qmax"]))  # not where the line is out of reach: NaN
        if inside and np.linalg.norm(points[1] - points[0]) >= SHORT_M:
            return points[0].tolist(), points[1].tolist()


def document(problem: Problem, limits: Any, budget_s: float, stop: str) -> Document:
    """The request for one straight leg."""
    made = request(problem, limits, Manners(budget_s, "first" if stop == "first" else "budget"))
    made["task"][0]["move"]["leg"] = "cartesian"
    made["options"]["elbow"] = "keep"
    return made


def bent(line: Document, start: list[float], end: list[float]) -> list[str]:
    """Whether the tool leaves the line between its ends, and by how much."""
    knots = line["trajectory"]
    time_s, *columns = (np.array(knots[name]) for name in ("time_s", "position", "velocity", "acceleration"))
    t = np.linspace(time_s[0], time_s[-1], CHECKED)
    return off_line(Spline.through(time_s, *columns).evaluate(t), start, end, STRAIGHT_M)


def off_line(q: Any, start: list[float], end: list[float], most: float) -> list[str]:
    """A finding if the tool at joint positions (N, 4) is further than `most` from the line, or does not end there."""
    p = tool(q, np.zeros_like(q)).position
    a, way = np.array(start), np.array(end) - np.array(start)
    s = np.clip((p - a) @ way / (way @ way), 0.0, 1.0)
    off = float(np.linalg.norm(p - a - s[:, None] * way, axis=-1).max())
    missed = float(max(np.linalg.norm(p[0] - a), np.linalg.norm(p[-1] - np.array(end))))
    found = [] if off <= most else [f"the tool leaves the line by {off * 1e6:.0f} µm"]
    return found if missed <= most else [*found, f"the tool misses an end by {missed * 1e6:.0f} µm"]


def fastest_joint_move(q0: Any, q1: Any, limits: Any) -> float:
    """Seconds from rest to rest, every joint on its own, by Ruckig."""
    asked = ruckig.InputParameter(4)
    asked.current_position, asked.target_position = list(q0), list(q1)
    asked.max_velocity, asked.max_acceleration = list(limits["vmax"]), list(limits["amax"])
    asked.max_jerk = list(limits["jmax"])
    made = ruckig.Trajectory(4)
    if ruckig.Ruckig(4).calculate(asked, made) != ruckig.Result.Working:
        raise RuntimeError("Ruckig has no motion from rest to rest")
    return float(made.duration)


@contextmanager
def measuring(parameters: Document, _group: str) -> Iterator[Callable[[str], Document]]:
    problems = problem_set("static")
    limits = {name: list(values) for name, values in problems.limits.items()}
    warm_up(problems)
    with peers(("toppra",), environment_of()) as others:
        others.ask(
            "toppra", {"start": [0.3, 0, 0.1], "end": [0.4, 0.1, 0.1], "yaw": [0, 0], "sign": 1.0, "limits": limits}
        )

        def measure(item: str) -> Document:
            start, end = ends(int(item.rpartition(" ")[2]), parameters["seed"], limits)
            q = along(start, end, (0.0, 0.0), SIGN, CHECKED)
            reference = fastest_joint_move(q[0], q[-1], limits)
            problem = {"id": item, "start": q[0].tolist(), "goal": {"pos": end, "yaw": 0.0}, "obstacles": []}
            record: Document = {"reference_s": reference, "findings": [], "answers": 0}
            for stop in ("first", parameters["stop"]):
                forget()
                line = {"id": item, "match": "position"}
                line |= planned(document(problem, limits, parameters["budget_s"], stop))
                made = judged(problems, problem, line, "position")
                if line["status"] == "planned":
                    made["findings"] += bent(line, start, end)
                record["findings"] += made["findings"]
                record["answers"] += made["answers"]
                record[stop] = {"duration_s": made["duration_s"], "elapsed_s": made["elapsed_s"]}
            asked = {"start": start, "end": end, "yaw": [0.0, 0.0], "sign": SIGN, "limits": limits}
            theirs = others.ask("toppra", asked)
            if theirs["status"] == "planned":
                theirs["findings"] = off_line(np.array(theirs.pop("position")), start, end, PEER_STRAIGHT_M)
            record["toppra"] = theirs | {"version": others.versions.get("toppra")}
            return record

        yield measure


def summary(parameters: Document, records: Records) -> Summary:
    def over(way: str, share: float) -> Callable[[Any], float | None]:
        return lambda rows: quantile(
            [r[way]["duration_s"] / r["reference_s"] for r in rows if r[way].get("duration_s") is not None], share
        )

    def took(way: str) -> Callable[[Any], float | None]:
        return lambda rows: quantile([1e3 * r[way]["elapsed_s"] for r in rows if r[way].get("elapsed_s")], 0.5)

    budget = parameters["stop"]
    missed = sum(record.get(budget, {}).get("duration_s") is None for record in records.values())
    note = f"{missed} of {len(records)} not planned" if missed else ""
    name = "straight legs over the joint move"
    figures = [
        figure(f"{name}, median", records, over(budget, 0.5), note=note),
        figure(f"{name}, 95 %", records, over(budget, 0.95)),
        figure(f"{name}, median, first answer", records, over("first", 0.5)),
        figure("straight legs: first answer, median", records, took("first"), "ms"),
    ]
    theirs = {item: record for item, record in records.items() if "toppra" in record}
    reasons = {r["toppra"]["reason"] for r in theirs.values() if r["toppra"]["status"] == "missing"}
    clean = {item: r | {"findings": r["toppra"].get("findings", [])} for item, r in theirs.items()}
    why = f"TOPPRA is missing: {', '.join(sorted(reasons))}" if reasons else ""
    version = next((r["toppra"]["version"] for r in theirs.values() if r["toppra"].get("version")), None)
    figures += [
        figure(f"{name}, median, TOPPRA without a limit of jerk", clean, over("toppra", 0.5), note=why),
        figure("straight legs: TOPPRA's time for a line, median", clean, took("toppra"), "ms", note=why),
    ]
    data = {
        "ratios": [r[budget]["duration_s"] / r["reference_s"] for r in records.values() if _there(r, budget)],
        "ratios_toppra": [
            r["toppra"]["duration_s"] / r["reference_s"] for r in records.values() if _there(r, "toppra")
        ],
        "toppra": {"version": version, "missing": sorted(reasons)},
    }
    return Summary(tuple(figures), data)


def _there(record: Document, way: str) -> bool:
    return record.get(way, {}).get("duration_s") is not None


SECTION = Section(
    "legs",
    "straight Cartesian legs over the joint move",
    parameters,
    items,
    measuring,
    summary,
    limit_s=900.0,
    again=lambda record: died(record) or record["toppra"]["status"] == "missing",
)
