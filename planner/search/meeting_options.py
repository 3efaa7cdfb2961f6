"""The ways in which a control point can be met, those with the least possible duration first."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import accumulate

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.claim.frames import displaced_of
from assur.planner.claim.obligations import shares_of
from assur.planner.collision.pairs import shift_of
from assur.planner.errors import FaultError
from assur.planner.frames.motion import Motion
from assur.planner.kernels.meetings import least_durations
from assur.planner.kernels.postures import FITS, SINGULAR, correction_fits
from assur.planner.legs.control_point import WINDOW_S, control_point
from assur.planner.legs.forbidden_yaw import free_yaws_between
from assur.planner.legs.meeting import Meetings
from assur.planner.legs.state import Branch
from assur.planner.legs.tilt import tilts
from assur.planner.model.deadline import raise_if_late
from assur.planner.model.phases import Phase
from assur.planner.model.refusal import (
    Corrected,
    JointName,
    Obstacle,
    Quantity,
    Reason,
    Refusal,
    Stage,
    law_ends,
    of_joint,
    unmoved,
    window_missed,
)
from assur.planner.model.scene import Scene
from assur.planner.model.window_missed import Miss, WindowMissed
from assur.planner.robots.robot import Robot
from assur.planner.search.partial_plan import Option, PartialPlan
from assur.planner.search.tuning import ANY_YAW, EVALUATED_MEETINGS, SHARE_OF_A_TURN
from assur.planner.trajectory import Trajectory

SAME_RAD = 1e-6
"""A wrist that differs by less is where it was."""


def options(scene: Scene, partial: PartialPlan, found: list[Meetings]) -> tuple[Option, ...]:
    """All branches of all turns of the part, those with the least possible duration first; of about the same duration
    the one that turns the wrist least (`SHARE_OF_A_TURN`)."""
    raise_if_late()
    ways = [(meeting, branch) for meeting in found for branch in meeting.branches]
    if not ways:
        return ()
    state, n = partial.state, len(scene.robot.joints)
    tables = [branch.table[:: 1 + len(branch.table) // EVALUATED_MEETINGS] for _, branch in ways]
    rows, begins = np.concatenate(tables), [0, *accumulate(map(len, tables[:-1]))]
    start, least = np.array([state.q, state.qd, state.qdd]), np.empty(len(rows))
    limits = partial.attached.limits(scene)
    least_durations(start, rows, limits.table, scene.options.jerk_limited, least)
    if not ways[0][1].still:
        # the earliest of these times that the least duration allows
        least = np.where(rows[:, 0] >= state.time + least, rows[:, 0] - state.time, np.inf)
    least = np.minimum.reduceat(least, begins)
    # where an option is met first
    order = (least * preference(scene.robot, state.q, rows[begins, 1 : 1 + n])).argsort(kind="stable")
    return tuple([Option(ways[k][0], ways[k][1], float(least[k])) for k in order.tolist()])


def preference(robot: Robot, one: FloatArray, other: FloatArray) -> FloatArray:
    """What the duration of ways from joints (n,) to others (..., n) is multiplied by to compare them:
    `SHARE_OF_A_TURN` is added for a turn of the wrist, the last joint, if that turns."""
    wrist = np.abs(other[..., -1] - one[-1]) * robot.revolute[-1]
    return np.asarray(1.0 + SHARE_OF_A_TURN * wrist / (2 * math.pi))


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

    def turn(mode: int, offset: float) -> float:
        """By how much the wrist would turn."""
        point = control_point(scene, number, partial.attached, offset, tilt)
        there = robot.inverse(point.flange(t, point.approach).at_rest(), mode, 0).q[0, -1]
        return math.remainder(float(q[-1] - there), math.tau)

    found: list[float] = []
    for mode in modes if robot.revolute[-1] else ():
        off = turn(mode, 0.0)
        if abs(off) <= SAME_RAD:
            found.append(0.0)
        elif math.isfinite(off) and abs(turn(mode, off)) <= SAME_RAD:
            found.append(off)
    if scene.forbidden_yaw:
        here = float(control_point(scene, number, partial.attached, 0.0, tilt).flange(t).yaw[0])
        found += [math.remainder(yaw - here, math.tau) for yaw in free_yaws_between(scene)]
    return tuple(dict.fromkeys([*found, *(2 * np.pi * np.arange(ANY_YAW) / ANY_YAW).tolist()]))


# Vias that are flown by: where the arm goes on from one, and that it does not stop there while a joint goes on.

RESTS = 1e-6
"""rad/s or m/s. An arm all of whose joints are slower than this stops, as the checker counts it."""
BESIDE_S = 0.01
"""How long before and after a via the way of each joint is compared, s, as in the checker."""
WAY = 1e-9
"""rad or m. A joint that goes a shorter way in this time stands."""


def ahead(scene: Scene, partial: PartialPlan, branch: Branch) -> FloatArray | None:
    """Joints (n,) near those of the control point behind the next one, for a via that is met as `branch` says and is
    flown by; None: no such. They are those that come quickest in the mode of the via, or else in another one that is
    allowed."""
    step = scene.task[partial.step]
    if not step.via or partial.step + 1 >= len(scene.task):
        return None
    robot, q, t = scene.robot, branch.q[0], np.array([partial.state.time])
    others = range(len(robot.modes)) if scene.options.elbow == "auto" else ()
    attitudes = tilts(scene, scene.task[partial.step + 1], q)
    behind = [control_point(scene, partial.step + 1, partial.attached, 0.0, tilt) for tilt in attitudes]
    motion = Motion(np.concatenate([each.flange(t, each.approach).table for each in behind]))
    for mode in dict.fromkeys((branch.mode, *others)):
        found = robot.inverse(motion, mode, 0).q
        there = found + robot.revolute * 2 * np.pi * np.round((q - found) / (2 * np.pi))
        takes = (np.abs(there - q) / partial.attached.limits(scene).velocity).max(1)
        if np.isfinite(takes).any():
            return np.asarray(there[np.nanargmin(takes)])
    return None


def stops_at_via(scene: Scene, partial: PartialPlan, trajectory: Trajectory) -> Refusal | None:
    """Why a motion may not go on from a via at which the arm is at rest: a joint goes on in its direction. A stop is
    allowed only where all joints that move turn round."""
    before = scene.task[partial.step - 1] if partial.step > 0 else None
    if before is None or not before.via or before.leg != "joint" or partial.knots is None:
        return None
    state, done = partial.state, Trajectory.of_knots(partial.knots.table)
    if not np.abs(state.qd).max() <= RESTS or not done.start < state.time < trajectory.end:
        return None
    times = max(done.start, state.time - BESIDE_S), min(trajectory.end, state.time + BESIDE_S)
    came, goes = (
        state.q - done.evaluate(np.array(times[:1]), 0)[0],
        trajectory.evaluate(np.array(times[1:]), 0)[0] - state.q,
    )
    goes_on = (np.minimum(np.abs(came), np.abs(goes)) > WAY) & (came * goes > 0.0)
    return unmoved(Stage.TIMING, partial.step, Obstacle.STOPS_AT_VIA) if goes_on.any() else None


# Motions that end too late: after the latest end, or after what is known of the motion of a frame.


def ends_too_late(scene: Scene, step: int, end: float) -> Refusal | None:
    """Whether the motion ends after the latest end, or after the law of a frame that bears a body."""
    latest = scene.options.latest_end_s
    if latest is not None and not end <= latest + WINDOW_S:
        facts = WindowMissed(miss=Miss.ENDS_TOO_LATE)
        return window_missed(Stage.TIMING, step, facts, amount=Quantity.of(end - latest, "s"))
    return laws_over(scene, step, end)


def laws_over(scene: Scene, step: int, end: float) -> Refusal | None:
    """Whether the law of a frame that bears a body, or will, ends before the arm, started late, has stood still for as
    long as is required."""
    stay = scene.options.stay_safe_s if scene.options.end == "rest" else 0.0
    needed = end + stay + scene.execution.start_tolerance_s
    for name, valid in scene.ending:
        if not needed <= valid[1]:
            return law_ends(Stage.TIMING, step, name, valid, needed)
    return None


def tracked_too_long(scene: Scene, step: int, phases: Sequence[Phase]) -> Refusal | None:
    """Whether the law of a frame that is tracked ends before an arm that started late has left it."""
    for phase in phases:
        if phase.tracked is not None:
            valid, needed = scene.frames[phase.tracked].law.valid, phase.t1 + scene.execution.start_tolerance_s
            if not needed <= valid[1]:
                return law_ends(Stage.TIMING, step, phase.tracked, valid, needed)
    return None


# Whether the joints keep their ranges, and the arm its reach, where a belt correction shifts the tool.


def shifted_out(scene: Scene, step: int, trajectory: Trajectory, phases: list[Phase]) -> Refusal | None:
    """Why the motion of these phases cannot be corrected as far as may be needed."""
    if not scene.execution.belt_correction:
        return None
    robot, execution = scene.robot, scene.execution
    spline, lag = trajectory.spline, np.array(execution.lag or [0.0] * trajectory.n)
    displaced = displaced_of(scene)
    for phase, shares in zip(phases, shares_of(scene, phases), strict=True):
        shift = shift_of(displaced, shares)
        if not any(shift) or not phase.robot:
            continue
        clock = np.array([scene.start.time, execution.start_tolerance_s, *shift])
        found = np.empty(2)
        errors = (np.zeros((0, 1)), lag, clock)
        joint = correction_fits(robot.row, spline, robot.limits.table, errors, phase.t0, phase.t1, found)
        if joint == FITS:
            continue
        when = float(found[0])
        most = shift[0] + shift[1] * max(when + execution.start_tolerance_s - scene.start.time, 0.0)
        named = None if joint == SINGULAR else robot.joints[joint]
        return Refusal(
            stage=Stage.LIMITS,
            reason=Reason.NEAR_SINGULARITY if named is None else Reason.JOINT_LIMIT,
            step=step,
            subject=None if named is None else JointName(named.name),
            interval=(when, when),
            amount=Quantity.of(most, "m") if named is None else of_joint(named.kind, float(found[1])),
            facts=Corrected(shift_m=most, joint=None if named is None else named.name),
        )
    return None
