"""Is what an arrival states of its control point so? Name, pose, way along a belt, velocity, a yaw that is kept."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from assur.planner.checker.statement import laws
from assur.planner.checker.statement.arms import flange_row
from assur.planner.checker.statement.differences import MEET, SAME, Difference, Topic
from assur.planner.checker.statement.holding import Handling
from assur.planner.claim import columns as c
from assur.planner.model.outcome import Arrival

AHEAD = 0.5
"""Of a row whose axis is stated to point roughly in a direction: a sine alone would allow the opposite one."""


def arrivals_agree(handling: Handling, claim: c.Claim) -> Iterator[Difference]:
    """Differences of arrivals, of which the request does not leave a choice."""
    for number, step in enumerate(handling.scene.task):
        arrival = handling.arrivals[number]
        when = (arrival.time, arrival.until)
        if arrival.control_point != step.name:
            yield Difference(Topic.ARRIVAL, f"the arrival at {step.name} has another name", when)
        if step.match == "velocity" and not step.via and not arrival.matched:
            yield Difference(Topic.ARRIVAL, f"the velocity of {step.name} is to be matched", when)
        tool, pose = handling.tool_at(arrival.time), arrival.pose
        off = max(math.dist(tool[:3], (pose.x, pose.y, pose.z)), abs(math.remainder(tool[3] - pose.yaw, math.tau)))
        if not off <= MEET:
            yield Difference(Topic.ARRIVAL, f"the tool is not at the pose that is stated at {step.name}", when)
        if not _is_so_far_along(handling, number, arrival):
            yield Difference(Topic.ARRIVAL, f"{step.name} is not so far along its belt", when)
        if step.target is not None and step.target.yaw_keep and not _keeps_yaw(handling, number, claim):
            yield Difference(Topic.AXIS, f"the tool is not stated to keep its yaw until {step.name}", when)


def _is_so_far_along(handling: Handling, number: int, arrival: Arrival) -> bool:
    """How far the control point is along its belt when it is met, from the pose that the request has for it."""
    frame, pose = handling.point(number)
    measured = laws.measured_along(handling.scene.frames[frame].law)
    if arrival.along_m is None or measured is None:
        return arrival.along_m is None
    way = np.array(handling.in_world((frame, pose), arrival.time)[:3]) - np.array(measured[1][:3])
    return abs(float(way @ np.array(measured[0])) - arrival.along_m) <= MEET


def _keeps_yaw(handling: Handling, number: int, claim: c.Claim) -> bool:
    """When the step begins the tool has the yaw, in the world, with which its point row states that it is met."""
    begin = next(leg.t0 for leg in handling.plan.legs if leg.step == number)
    yaw, own = handling.in_world(handling.tool_point(number), handling.arrivals[number].time)[3], handling.tcp[3]
    ahead, aside = (math.cos(own), math.sin(own), 0.0), (-math.sin(own), math.cos(own), 0.0)
    same = [flange_row(handling.scene.robot), 0.0]
    for axis, low, high in ((aside, -MEET, MEET), (ahead, AHEAD, math.inf)):
        wanted = np.array([begin, begin, *same, *axis, -1.0, math.cos(yaw), math.sin(yaw), 0.0])
        rows = claim.axes[(np.abs(claim.axes[:, : c.AXIS_LOW] - wanted) <= SAME).all(1)]
        if not ((rows[:, c.AXIS_LOW] >= low) & (rows[:, c.AXIS_HIGH] <= high)).any():
            return False
    return True
