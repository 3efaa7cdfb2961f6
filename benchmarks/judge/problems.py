"""What is wrong with an answer to a problem of the benchmark: all of it, each with the number that shows it.

An answer is a trajectory, by whichever planner. It is sampled, and its limits are held at exact extremes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.judge.cell import Cell
from benchmarks.judge.poses import Poses, short
from benchmarks.judge.solids import Solid, apart_at_least, gaps
from benchmarks.judge.spline import KNOTS, Floats, Spline
from benchmarks.problem_set import LIMITS, ProblemSet
from benchmarks.translation import LATEST_END_S, Match, Terms, request

STEP_S = 0.5e-3
"""Time between samples for collisions."""
APART_S = 1e-6
"""Before and after the end, for the velocity of the tool with the joint rates of the end."""
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
COLUMNS = KNOTS[1:]


@dataclass(frozen=True, slots=True)
class Finding:
    """One fault: the problem, the kind of fault, and a sentence with its number."""

    problem: str
    kind: str
    text: str

    def __str__(self) -> str:
        return f"{self.kind}: {self.text}"


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
    cell = Cell.of(request(problem, problems.limits, Terms(match=match)))
    complaints = [
        *_start(problem, time, knots),
        *_end(duration, time, latest_end_s),
        *_goal(cell, float(time[-1]), knots, match),
        *_limits(problems, spline),
        *_collisions(cell, spline, latest_end_s),
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


def _start(problem: dict[str, Any], time: Floats, knots: list[Floats]) -> list[tuple[str, str]]:
    found = []
    q, qd, qdd = (column[0] for column in knots)
    if time[0] != 0.0:
        found.append(("start", f"the first knot is at {time[0]!r} s, not at 0"))
    off = float(np.abs(q - np.array(problem["start"])).max())
    if not off <= START:
        found.append(("start", f"begins {off:.3g} away from the given start"))
    if qd.any() or qdd.any():
        found.append(("start", f"does not begin at rest: q̇ {qd.tolist()}, q̈ {qdd.tolist()}"))
    return found


def _end(duration: float, time: Floats, latest_end_s: float) -> list[tuple[str, str]]:
    end, found = float(time[-1]), []
    if not end <= latest_end_s:
        found.append(("end", f"ends at {end:.6f} s, later than {latest_end_s} s"))
    if not abs(duration - end) <= END_S:
        found.append(("form", f"duration_s is {duration}, the last knot is at {end}"))
    return found


def _goal(cell: Cell, end: float, knots: list[Floats], match: Match) -> list[tuple[str, str]]:
    """The tool is at the goal at the end, with the goal's velocity, or at rest."""
    found, (q, qd, qdd) = [], (column[-1] for column in knots)
    frame, pose = cell.seat(cell.request["task"][0]["move"]["to"])
    goal, tool = cell.frames[frame].at(np.array(end)).then(pose), cell.arm.tool(q)
    around = [cell.arm.tool(q + side * APART_S * qd) for side in (-1.0, 1.0)]
    speed = (around[1].p - around[0].p) / (2.0 * APART_S)
    wanted = np.zeros(3)
    if match == "velocity" and frame != "world":
        wanted = np.array(cell.request["frames"][frame]["linear"]["velocity_m_s"])
    away, turned = float(np.linalg.norm(tool.p - goal.p)), abs(float(short(tool.yaw - goal.yaw)))
    slip = float(np.linalg.norm(speed - wanted))
    spin = abs(float(short(around[1].yaw - around[0].yaw))) / (2.0 * APART_S)
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
        for name, rates in (("q̇", qd), ("q̈", qdd)):
            if not float(np.abs(rates).max()) <= GOAL_RAD_S:
                found.append(("goal velocity", f"does not end at rest: {name} {rates.tolist()}"))
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


def _collisions(cell: Cell, spline: Spline, latest_end_s: float) -> list[tuple[str, str]]:
    start, end = float(spline.time[0]), float(spline.time[-1])
    # A duration without end is refused elsewhere; it must not become an endless array here.
    end = min(end, start + latest_end_s)
    samples = np.arange(start, end, STEP_S)
    t = np.unique(np.concatenate([samples, spline.time[spline.time <= end], [end]]))
    links, found = cell.arm.links(spline.evaluate(t)), []
    for body in cell.arm.bodies:
        for name, (frame, pose) in cell.seats.items():
            obstacle = cell.frames[frame].at(t).then(pose)
            hits = overlaps(body.solid, links[body.link].then(body.pose), cell.solids[name], obstacle)
            if len(hits):
                span = f"from {t[hits[0]]:.4f} to {t[hits[-1]]:.4f} s ({len(hits)} samples)"
                found.append(("collision", f"{body.name} hits {name} {span}"))
    return found


def overlaps(a: Solid, at: Poses, b: Solid, beside: Poses) -> NDArray[np.intp]:
    """Indices (M,) of the poses (N,) at which two solids overlap, those that are not finite among them."""
    near = np.flatnonzero(~(apart_at_least(a, at, b, beside) >= 0.0))
    return near[~(gaps(a, at[near], b, beside[near], 0.0) >= 0.0)]
