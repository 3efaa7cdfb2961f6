"""Does the claim state that the tool is where the task asks: at its control points, and while it tracks them?

A claim may state more: smaller errors, a lower height, a longer time.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from assur.planner.checker.statement.arms import flange_row
from assur.planner.checker.statement.differences import (
    MEET,
    SAME,
    TRACKED_M,
    TRACKED_RAD,
    Difference,
    Four,
    Interval,
    Topic,
)
from assur.planner.checker.statement.holding import Handling
from assur.planner.checker.statement.poses import is_same_pose
from assur.planner.claim import columns as c
from assur.planner.model.outcome import LegKind
from assur.planner.model.scene import Follow, Move, Scene, Step, Trace

LONGER = 1.1
"""A straight part is so many times as long as the distance in travel at least: docs/request.md."""
Row = list[float]


@dataclass(frozen=True)
class Point:
    """The tool point is at a pose of a frame, from `least` to `up` m above it, no farther off than `position` m and
    `yaw` rad (-1: any), and with no greater difference of velocities than `rates`, m/s and rad/s (-1: any)."""

    frame: int
    target: Four
    when: Interval
    position: float
    yaw: float
    up: float = 0.0
    rates: tuple[float, float] = (-1.0, -1.0)
    least: float = 0.0


def points_agree(handling: Handling, claim: c.Claim) -> Iterator[Difference]:
    """Differences of the points."""
    scene, stated = handling.scene, claim.points.tolist()
    for number, step in enumerate(scene.task):
        for point in _points_of(handling, number):
            if not any(_is_point(row, point, handling.tcp, flange_row(scene.robot)) for row in stated):
                yield Difference(Topic.POINT, f"the tool is not stated to be at {step.name}", point.when)


def _points_of(handling: Handling, number: int) -> Iterator[Point]:
    """What is required of the tool at the control point of a step: when it is met, when it is left, and while it is
    tracked; it may be higher in the straight parts before and behind, at whose outer ends it is that high."""
    scene, step, arrival = handling.scene, handling.scene.task[number], handling.arrivals[number]
    frame, target = handling.tool_point(number)
    turns = "yaw" in scene.robot.coordinates
    at, tracked_yaw = list(scene.frames).index(frame), TRACKED_RAD if turns else -1.0
    tracks = [leg for leg, is_ in zip(handling.plan.legs, handling.tracks, strict=True) if is_ and leg.step == number]
    if isinstance(step, Trace):
        # guides are compared with the path; the tool keeps its yaw
        if turns:
            yield Point(at, target, (tracks[0].t0, tracks[-1].t1), math.inf, tracked_yaw)
        return
    rates = (MEET, MEET if turns else -1.0)
    matched = rates if arrival.matched or _matches_velocity(step) else (-1.0, -1.0)
    if arrival.missed_by is not None:
        yield Point(at, target, (arrival.time, arrival.time), arrival.missed_by.distance_m + MEET, -1.0)
        return
    met = Point(at, target, (arrival.time, arrival.time), MEET, MEET if turns else -1.0, rates=matched)
    yield met
    if arrival.until != arrival.time:
        yield replace(met, when=(arrival.until, arrival.until), rates=(-1.0, -1.0))
    for leg in tracks:
        up, stops, outer = _height(scene, step, leg.kind), step.approach_stop, leg.t0
        if leg.kind is LegKind.DEPART:
            stops, outer = step.depart_stop, leg.t1
        yield Point(at, target, (leg.t0, leg.t1), TRACKED_M, tracked_yaw, up)
        if up > 0.0:
            end = Point(at, target, (outer, outer), TRACKED_M, tracked_yaw, up, least=up)
            yield replace(end, rates=rates if stops else (-1.0, -1.0))


def _matches_velocity(step: Step) -> bool:
    """Whether a step asks for the velocity of its control point."""
    if isinstance(step, Move):
        return step.match == "velocity" and not step.via
    return isinstance(step, Follow) or step.match == "velocity"


def _height(scene: Scene, step: Step, kind: LegKind) -> float:
    """How high above its control point the tool may be in a leg that tracks it, m."""
    if kind is LegKind.FOLLOW or step.part is None:
        return 0.0
    if kind is LegKind.APPROACH:
        length, stop = step.approach_m, step.approach_stop
    else:
        length, stop = step.depart_m, step.depart_stop
    return length if stop else max(length, LONGER * scene.options.clearance.travel_m)


def _is_point(row: Row, point: Point, tcp: Four, flange: int) -> bool:
    """Whether a row of the claim states as much: for as long, and as near, as straight and as slow."""
    (first, last), half = point.when, max(row[c.POINT_HEIGHT], 0.0)
    return (
        row[c.POINT_T0] <= first
        and last <= row[c.POINT_T1]
        and row[c.POINT_FRAME] == point.frame
        and row[c.POINT_LINK] == flange
        and is_same_pose(row[c.POINT_TOOL : c.POINT_TARGET], tcp)
        and is_same_pose(row[c.POINT_TARGET : c.POINT_MIDDLE], point.target)
        and row[c.POINT_POSITION] <= point.position
        and (row[c.POINT_HEIGHT] == -1.0 or point.up > 0.0)
        and row[c.POINT_MIDDLE] + half <= point.up + TRACKED_M + SAME
        and row[c.POINT_MIDDLE] - half >= point.least - TRACKED_M - SAME
        and _is_no_larger(row[c.POINT_YAW], point.yaw)
        # velocities are compared when the row begins
        and (point.rates[0] < 0.0 or row[c.POINT_T0] == first)
        and all(_is_no_larger(row[c.POINT_RATE + k], point.rates[k]) for k in (0, 1))
    )


def _is_no_larger(stated: float, required: float) -> bool:
    """Whether an error is stated that is no larger than required; -1: any."""
    return required < 0.0 or 0.0 <= stated <= required


def is_axis_stated(
    scene: Scene,
    claim: c.Claim,
    axis: Sequence[float],
    direction: Sequence[float],
    bounds: tuple[float, float],
    when: Interval,
) -> bool:
    """Whether the claim states that an axis of the flange times a direction of the world is within these bounds."""
    required = [0.0, *axis, -1.0, *direction]
    for row in claim.axes.tolist():
        same = all(abs(x - y) <= SAME for x, y in zip(row[c.AXIS_PLACE : c.AXIS_LOW], required, strict=True))
        within = row[c.AXIS_LOW] >= bounds[0] - SAME and row[c.AXIS_HIGH] <= bounds[1] + SAME
        long = row[c.AXIS_T0] <= when[0] and when[1] <= row[c.AXIS_T1]
        if same and within and long and row[c.AXIS_LINK] == flange_row(scene.robot):
            return True
    return False
