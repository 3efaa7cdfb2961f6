"""The ways in which a control point can be met, those with the least possible duration first."""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from assur.planner.legs.control_point import control_point
from assur.planner.legs.forbidden_yaw import free_yaws_between
from assur.planner.legs.meeting import Meetings
from assur.planner.legs.tilt import tilts
from assur.planner.model.deadline import look
from assur.planner.model.scene import Scene
from assur.planner.robots.robot import Robot
from assur.planner.search.partial_plan import Option, PartialPlan
from assur.planner.search.tuning import ANY_YAW, EVALUATED_MEETINGS, SHARE_OF_A_TURN

SAME_RAD = 1e-6
"""A wrist that differs by less is where it was."""


def options(scene: Scene, partial: PartialPlan, found: list[Meetings]) -> tuple[Option, ...]:
    """All branches of all turns of the part, those with the least possible duration first; of about the same duration
    the one that turns the wrist least (`SHARE_OF_A_TURN`)."""
    state, limits = partial.state, partial.attached.limits(scene)
    start = np.array([state.q, state.qd, state.qdd])
    result = []
    for meeting in found:
        look()
        for branch in meeting.branches:
            every = 1 + len(branch.meetings) // EVALUATED_MEETINGS
            least = branch.least_durations(start, limits, every, jerk_limited=scene.options.jerk_limited)
            if not branch.still:
                # the earliest of these times that the least duration allows
                time = branch.time[::every]
                least = time[time >= state.time + least] - state.time
            result.append(Option(meeting, branch, float(least.min(initial=np.inf))))
    # where an option is met first
    result.sort(key=lambda option: option.least * preference(scene.robot, state.q, option.branch.q[0]))
    return tuple(result)


def preference(robot: Robot, one: FloatArray, other: FloatArray) -> float:
    """What the duration of a way between joints (n,) is multiplied by to compare it with others: `SHARE_OF_A_TURN` is
    added for a turn of the wrist, the last joint, if that turns."""
    wrist = abs(float(other[-1] - one[-1])) * float(robot.revolute[-1])
    return 1.0 + SHARE_OF_A_TURN * wrist / (2 * math.pi)


def free_yaws(scene: Scene, partial: PartialPlan, number: int, modes: tuple[int, ...]) -> tuple[float, ...]:
    """Yaws that are tried where the control point of step `number` leaves the yaw free: those for which the wrist stays
    as it is if the point is met at once, one a mode, those beside forbidden ranges, and `ANY_YAW` all round; or the one
    that is to be kept."""
    robot, q, step = scene.robot, partial.state.q, scene.task[number]
    tilt, t = tilts(scene, step, q)[0], np.array([partial.state.time])
    if step.target is not None and step.target.yaw_keep:
        point = control_point(scene, number, partial.attached, 0.0, tilt)
        there = scene.frames[point.frame].law.yaw
        if there is None:
            raise FaultError(f"the yaw in {point.frame} is to be kept, but this frame turns")
        return (math.remainder(float(robot.forward(q)[1]) - (there + point.pose.yaw), math.tau),)
    found: list[float] = []
    for mode in modes if robot.revolute[-1] else ():
        offset = 0.0
        for _ in range(2):
            point = control_point(scene, number, partial.attached, offset, tilt)
            off = float(q[-1] - robot.inverse(point.flange(t, point.approach).at_rest(), mode, 0).q[0, -1])
            if not math.isfinite(off):
                break
            off = math.remainder(off, 2 * math.pi)
            if abs(off) <= SAME_RAD:
                found.append(offset)
                break
            offset += off
    if scene.forbidden_yaw:
        here = float(control_point(scene, number, partial.attached, 0.0, tilt).flange(t).yaw[0])
        found += [math.remainder(yaw - here, math.tau) for yaw in free_yaws_between(scene)]
    return tuple(dict.fromkeys([*found, *(2 * np.pi * np.arange(ANY_YAW) / ANY_YAW).tolist()]))
