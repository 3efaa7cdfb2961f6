"""Does the claim state that the tool is where the task requires it: at its control points, and while it tracks them?

A claim may state more: smaller errors, a lower height, a longer time.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from assur.planner.checker.statement.differences import MEET, SAME, TRACKED_M, TRACKED_RAD, Interval
from assur.planner.checker.statement.statement import Statement, all_of, at_most, same
from assur.planner.checker.verdict import Code
from assur.planner.claim import columns as c
from assur.planner.model.outcome import Leg, LegKind
from assur.planner.model.scene import Step, Trace

LONGER = 1.1
"""A straight part is so many times as long as the distance in travel at least: docs/request.md."""


def require_points(statement: Statement) -> None:
    """The tool is at the control point of each step when it is met, when it is left, and while it is tracked; it may be
    higher in the straight parts before and behind, at whose outer ends it is that high."""
    turns = "yaw" in statement.scene.robot.coordinates
    rates = (MEET, MEET) if turns else (MEET,)
    for number, step in enumerate(statement.scene.task):
        arrival, tracked = statement.arrivals[number], statement.legs(number, tracked=True)
        met, left = (arrival.time, arrival.time), (arrival.until, arrival.until)
        if isinstance(step, Trace):
            # guides are compared with the path; the tool keeps its yaw
            if turns:
                _require_point(statement, number, (tracked[0].t0, tracked[-1].t1), math.inf, TRACKED_RAD)
            continue
        if arrival.missed_by is not None:
            _require_point(statement, number, met, arrival.missed_by.distance_m + MEET, math.inf)
            continue
        matched = arrival.matched or (step.match == "velocity" and not step.via)
        _require_point(statement, number, met, MEET, MEET, rates=rates if matched else ())
        if left != met:
            _require_point(statement, number, left, MEET, MEET)
        for leg in tracked:
            high, stops, outer = _height(statement, step, leg)
            _require_point(statement, number, (leg.t0, leg.t1), TRACKED_M, TRACKED_RAD, (0.0, high))
            if high > 0.0:
                end = rates if stops else ()
                _require_point(statement, number, (outer, outer), TRACKED_M, TRACKED_RAD, (high, high), end)


def _height(statement: Statement, step: Step, leg: Leg) -> tuple[float, bool, float]:
    """How high above its control point the tool may be in a leg that tracks it, m; whether it stops at the outer end of
    the leg, and the time of that end."""
    if leg.kind is LegKind.APPROACH:
        length, stops, outer = step.approach_m, step.approach_stop, leg.t0
    else:
        length, stops, outer = step.depart_m, step.depart_stop, leg.t1
    if leg.kind is LegKind.FOLLOW or step.part is None:
        return 0.0, stops, outer
    return length if stops else max(length, LONGER * statement.scene.options.clearance.travel_m), stops, outer


def _require_point(
    statement: Statement,
    number: int,
    when: Interval,
    position: float,
    yaw: float,
    heights: Interval = (0.0, 0.0),
    rates: Sequence[float] = (),
) -> None:
    """The tool point is within heights above the control point of a step, no farther off than `position` m and, if the
    flange turns about the vertical, `yaw` rad; and with no greater differences of velocities than `rates`, m/s and
    rad/s."""
    frame, target = statement.tool_point(number)
    bounds = [
        all_of(when),
        same(c.POINT_FRAME, statement.frames[frame], statement.flange, *statement.tcp, *target),
        at_most(c.POINT_POSITION, position),
    ]
    if yaw < math.inf and "yaw" in statement.scene.robot.coordinates:
        bounds.append((c.POINT_YAW, (0.0,), (yaw,)))
    if rates:
        # velocities are compared when the row begins
        bounds += [(c.POINT_T0, when[:1], when[:1]), (c.POINT_RATE, (0.0,) * len(rates), rates)]
    if not heights[1] > 0.0:
        bounds.append(at_most(c.POINT_HEIGHT, -1.0))
    rows, slack = statement.rows("points", *bounds), TRACKED_M + SAME
    middle, half = rows[:, c.POINT_MIDDLE], np.maximum(rows[:, c.POINT_HEIGHT], 0.0)
    high = (middle - half >= heights[0] - slack) & (middle + half <= heights[1] + slack)
    what = f"the tool is not stated to be at {statement.scene.task[number].name}"
    statement.require(high.any(), Code.POINT, what, when)
