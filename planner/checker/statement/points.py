"""Does the claim state that the tool is where the task requires it: at its control points, and while it tracks them?

A claim may state more: smaller errors, a lower height, a longer time.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from assur.planner.checker.statement.differences import (
    MEET,
    SAME,
    TRACKED_M,
    TRACKED_RAD,
    Four,
    Interval,
    inverse_pose,
    numbers,
    then,
)
from assur.planner.checker.statement.statement import Statement, all_of, at_least, at_most, same
from assur.planner.checker.verdict import Code
from assur.planner.claim import columns as c
from assur.planner.laws.law import EXACT
from assur.planner.model.arrival_error import ArrivalError
from assur.planner.model.outcome import Leg, LegKind
from assur.planner.model.scene import Pick, Step, Trace

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
        bounds.append([(c.POINT_YAW, 0.0, yaw)])
    if rates:
        # velocities are compared when the row begins
        bounds += [[(c.POINT_T0, when[0], when[0])], [(k, 0.0, x) for k, x in enumerate(rates, c.POINT_RATE)]]
    if not heights[1] > 0.0:
        bounds.append(at_most(c.POINT_HEIGHT, -1.0))
    slack, is_there = TRACKED_M + SAME, False
    for row in statement.listed("points", *bounds):
        middle, half = row[c.POINT_MIDDLE], max(row[c.POINT_HEIGHT], 0.0)
        is_there |= middle - half >= heights[0] - slack and middle + half <= heights[1] + slack
    what = f"the tool is not stated to be at {statement.scene.task[number].name}"
    statement.require(is_there, Code.POINT, what, when)


# Is what an arrival states of its control point so? Name, pose, way along a belt, velocity, a yaw that is kept, and how
# far the tool may be from the point, whatever is uncertain.
#
# The claim checker shows that no error is larger than a row states. Here the row is compared with the request, and the
# answer with the row. Errors follow from the task: the part as it is known before the step, and the phase in which the
# step is done.

AHEAD = 0.5
"""Of a row whose axis is stated to point roughly in a direction: a sine alone would allow the opposite one."""
ROUNDED = 2e-8
"""By which a row may be larger than the number of the answer, m or rad: what the claim checker keeps for rounding. A
length may be larger, too, by what the tool may be off its point if nothing is uncertain."""


def require_arrivals(statement: Statement) -> None:
    """What arrivals state is so, where the request does not leave a choice."""
    for number, step in enumerate(statement.scene.task):
        arrival, name = statement.arrivals[number], step.name
        when, left = (arrival.time, arrival.until), (arrival.until, arrival.until)
        tool, pose = statement.tool_at(arrival.time), numbers(arrival.pose)
        off = max(math.dist(tool[:3], pose[:3]), abs(math.remainder(tool[3] - pose[3], math.tau)))
        way = None if arrival.along_m is None else statement.along(number, [arrival.time])
        so_far = arrival.along_m is None if way is None else abs(way[0] - (arrival.along_m or 0.0)) <= MEET
        matched = step.match != "velocity" or step.via or arrival.matched
        statement.require_all(
            Code.ARRIVAL,
            when,
            (arrival.control_point == name, f"the arrival at {name} has another name"),
            (matched, f"the velocity of {name} is to be matched"),
            (off <= MEET, f"the tool is not at the pose that is stated at {name}"),
            (so_far, f"{name} is not so far along its belt"),
        )
        kept = step.target is None or not step.target.yaw_keep or _keeps_yaw(statement, number)
        statement.require(kept, Code.DIRECTION, f"the tool is not stated to keep its yaw until {name}", when)
        known = arrival.error is None or _is_error(statement, number, arrival.error)
        statement.require(known, Code.ERROR, f"{name} may be missed by more", left)


def _keeps_yaw(statement: Statement, number: int) -> bool:
    """When the step begins the tool has the yaw, in the world, with which its point row states that it is met."""
    begin, time = statement.legs(number)[0].t0, statement.arrivals[number].time
    yaw, own = statement.in_world(statement.tool_point(number), time)[3], statement.tcp[3]
    ahead, aside = (math.cos(own), math.sin(own), 0.0), (-math.sin(own), math.cos(own), 0.0)
    world = (-1.0, math.cos(yaw), math.sin(yaw), 0.0)
    return all(
        statement.keeps("axes", (statement.flange, 0.0, *axis, *world), low, high, (begin, begin))
        for axis, low, high in ((aside, -MEET, MEET), (ahead, AHEAD, math.inf))
    )


def _is_error(statement: Statement, number: int, error: ArrivalError) -> bool:
    """Whether a row states no more than the error, for the place and with the uncertainty that the request has."""
    step, arrival = statement.scene.task[number], statement.arrivals[number]
    frame, tool, point = _place(statement, number)
    known = EXACT
    if step.part is not None:
        known = statement.uncertainty(step.part, statement.handed_before(number))
    arm = math.hypot(step.grasp.x, step.grasp.y) if isinstance(step, Pick) else 0.0
    planned = TRACKED_M if isinstance(step, Trace) else MEET
    if arrival.missed_by is not None:
        planned += arrival.missed_by.distance_m
    within, off = error.within, (known.position_m, known.vertical_m, known.yaw_rad, arm)
    most = *(planned + each for each in (error.position_m, within.position_m, within.vertical_m)), within.yaw_rad
    return any(
        statement.states(
            "errors",
            [(c.ERROR_TIME, arrival.until, arrival.until), (c.ERROR_PHASE, phase, phase)],
            same(c.ERROR_FRAME, statement.frames[frame], statement.flange, *tool, *point),
            at_least(c.ERROR_OFF, *(x - SAME for x in off)),
            at_most(c.ERROR_FAR, *(x + ROUNDED for x in most)),
        )
        for phase, leg in enumerate(statement.plan.legs)
        if leg.step == number
        and abs(leg.t1 - arrival.until) <= SAME
        and (leg.kind is LegKind.FOLLOW or not step.tracks)
    )


def _place(statement: Statement, number: int) -> tuple[str, Four, Four]:
    """The point whose error counts: its frame, its pose on the flange and its pose in the frame. It is the origin of
    the part, or the target; of a trace the end of the path."""
    step, (frame, at) = statement.scene.task[number], statement.tool_point(number)
    if isinstance(step, Trace):
        return frame, statement.tcp, (*step.path.end, at[3])
    point = at if step.part is None else statement.point(number)[1]
    return frame, then(statement.tcp, then(inverse_pose(at), point)), point
