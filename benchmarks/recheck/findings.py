"""What is wrong with an answer: all of it, each with the number that shows it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from benchmarks.problem_set import LIMITS, ProblemSet
from benchmarks.recheck.arm import placed_bodies, tool
from benchmarks.recheck.spline import Floats, Spline
from benchmarks.recheck.surroundings import collisions, goal_at, placed_obstacles

Match = Literal["position", "velocity"]

STEP_S = 0.5e-3
"""Time between samples for collisions."""
LATEST_END_S = 5.0
"""A motion must have ended by then: nothing in the problems holds beyond."""
LIMIT_EXCESS = 1e-6
"""A limit of position, velocity or acceleration may be exceeded by this part of itself: rounding."""
JERK_EXCESS = 1e-4
"""Likewise for jerk, which is a third difference."""
GOAL_M = 2e-6
"""How far from the goal a tool point may end."""
GOAL_RAD = 2e-6
"""How far from the goal's yaw a tool may end."""
GOAL_M_S = 5e-6
"""How far from the goal's velocity (or from rest) a tool point may end."""
GOAL_RAD_S = 5e-6
"""How far from the goal's yaw rate, which is zero, a tool may end."""
START = 1e-12
"""How far from the given start the first knot may be, rad or m: one conversion of units and back."""
END_S = 1e-9
"""How far the stated duration may be from the last knot, s: rounding in a sum."""

COLUMNS = ("position", "velocity", "acceleration")


@dataclass(frozen=True, slots=True)
class Finding:
    """One fault: the problem, the kind of fault, and a sentence with its number."""

    problem: str
    kind: str
    text: str


def recheck(
    problems: ProblemSet,
    problem: dict[str, Any],
    answer: dict[str, Any],
    match: Match,
    latest_end_s: float = LATEST_END_S,
) -> list[Finding]:
    """All faults of one answer; an empty list for a problem that was not solved."""
    name = str(problem["id"])

    def found(kind: str, text: str) -> list[Finding]:
        return [Finding(name, kind, text)]

    if answer.get("status") == "not_planned":
        return [] if answer.get("trajectory") is None else found("form", "not planned, yet with a trajectory")
    if answer.get("status") != "planned":
        return found("status", f"status {answer.get('status')!r}: {answer.get('reason')}")
    findings = [] if answer.get("checked") is True else found("checker", f"checked: {answer.get('checked')!r}")
    try:
        time, knots = _knots(answer)
        duration = float(answer["duration_s"])
    except (KeyError, TypeError, ValueError) as error:
        return findings + found("form", f"trajectory: {error}")
    spline = Spline.through(time, *knots)
    complaints = [
        *_ends(problem, duration, time, knots, match, latest_end_s),
        *_limits(problems, spline),
        *_collisions(problem, spline, latest_end_s),
    ]
    return findings + [Finding(name, kind, text) for kind, text in complaints]


def _knots(answer: dict[str, Any]) -> tuple[Floats, list[Floats]]:
    trajectory = answer["trajectory"]
    time = np.array(trajectory["time_s"], dtype=np.float64)
    knots = [np.array(trajectory[column], dtype=np.float64) for column in COLUMNS]
    if time.ndim != 1 or len(time) < 2 or not (np.isfinite(time).all() and np.all(np.diff(time) > 0)):
        raise ValueError("time_s must be finite and increase strictly over two knots or more")
    for column, values in zip(COLUMNS, knots, strict=True):
        if values.shape != (len(time), 4):
            raise ValueError(f"{column} has shape {values.shape}, not {(len(time), 4)}")
        if not np.isfinite(values).all():
            raise ValueError(f"{column} is not finite")
    return time, knots


def _ends(
    problem: dict[str, Any], duration: float, time: Floats, knots: list[Floats], match: Match, latest_end_s: float
) -> list[tuple[str, str]]:
    found = []
    q, qd, qdd = knots
    end = float(time[-1])
    if time[0] != 0.0:
        found.append(("start", f"the first knot is at {time[0]!r} s, not at 0"))
    off = float(np.abs(q[0] - np.array(problem["start"])).max())
    if not off <= START:
        found.append(("start", f"begins {off:.3g} away from the given start"))
    if qd[0].any() or qdd[0].any():
        found.append(("start", f"does not begin at rest: q̇ {qd[0].tolist()}, q̈ {qdd[0].tolist()}"))
    if not end <= latest_end_s:
        found.append(("end", f"ends at {end:.6f} s, later than {latest_end_s} s"))
    if not abs(duration - end) <= END_S:
        found.append(("form", f"duration_s is {duration}, the last knot is at {end}"))

    position, yaw, velocity = goal_at(problem, end)
    reached = tool(q[-1:], qd[-1:])
    away = float(np.linalg.norm(reached.position[0] - position))
    turned = float(np.abs(np.remainder(reached.yaw[0] - yaw + np.pi, 2 * np.pi) - np.pi))
    wanted = velocity if match == "velocity" else np.zeros(3)
    slip = float(np.linalg.norm(reached.velocity[0] - wanted))
    spin = abs(float(reached.yaw_rate[0]))
    if not away <= GOAL_M:
        found.append(("goal", f"the tool ends {away * 1e6:.3f} µm away from the goal"))
    if not turned <= GOAL_RAD:
        found.append(("goal", f"the tool ends {turned * 1e6:.3f} µrad away from the goal's yaw"))
    if not slip <= GOAL_M_S:
        found.append(("goal velocity", f"the tool ends {slip * 1e6:.3f} µm/s away from the required velocity"))
    if not spin <= GOAL_RAD_S:
        found.append(("goal velocity", f"the tool ends turning by {spin * 1e6:.3f} µrad/s"))
    if not wanted.any():
        # Standing still needs a still arm, not only a still tool, and no jump in acceleration.
        if not float(np.abs(qd[-1]).max()) <= GOAL_RAD_S:
            found.append(("goal velocity", f"does not end at rest: q̇ {qd[-1].tolist()}"))
        if not float(np.abs(qdd[-1]).max()) <= GOAL_RAD_S:
            found.append(("goal velocity", f"does not end at rest: q̈ {qdd[-1].tolist()}"))
    return found


def _limits(problems: ProblemSet, spline: Spline) -> list[tuple[str, str]]:
    lower, upper, *rates = (np.array(problems.limits[name]) for name in LIMITS)
    ranges = [(lower, upper), *((-rate, rate) for rate in rates)]
    found = []
    for derivative, (least, most) in enumerate(ranges):
        excess = JERK_EXCESS if derivative == 3 else LIMIT_EXCESS
        low, high = spline.extremes(derivative)
        for j in range(len(least)):
            if not (low[j] >= least[j] - excess * abs(least[j]) and high[j] <= most[j] + excess * abs(most[j])):
                kind = ("position", "velocity", "acceleration", "jerk")[derivative]
                span = f"from {low[j]:.9g} to {high[j]:.9g}"
                found.append((kind, f"joint {j + 1} goes {span}, allowed {least[j]:.9g} to {most[j]:.9g}"))
    return found


def _collisions(problem: dict[str, Any], spline: Spline, latest_end_s: float) -> list[tuple[str, str]]:
    start, end = float(spline.time[0]), float(spline.time[-1])
    # A duration without end is refused elsewhere; it must not become an endless array here.
    end = min(end, start + latest_end_s)
    samples = np.arange(start, end, STEP_S)
    t = np.unique(np.concatenate([samples, spline.time[spline.time <= end], [end]]))
    bodies, obstacles = placed_bodies(spline.evaluate(t)), placed_obstacles(problem, t)
    found = []
    for body in bodies:
        for obstacle in obstacles:
            hits = collisions(body, obstacle)
            if len(hits):
                span = f"from {t[hits[0]]:.4f} to {t[hits[-1]]:.4f} s ({len(hits)} samples)"
                found.append(("collision", f"{body.name} hits {obstacle.name} {span}"))
    return found
