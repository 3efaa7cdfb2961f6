"""A continuation by parabolic blends: through vias to the next stop, timed, with its legs and arrivals."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from assur.planner.blends.timed import Blended, BlendShape, Station, blended
from assur.planner.errors import FaultError
from assur.planner.legs.forbidden_yaw import turns_into
from assur.planner.legs.joint import Shape
from assur.planner.legs.state import Knots
from assur.planner.model.assembly_mode import leaves_assembly
from assur.planner.model.attachments import at_start
from assur.planner.model.joint_range import beyond
from assur.planner.model.outcome import Arrival, Course, Leg, LegKind, Missed, Route
from assur.planner.model.phases import phases
from assur.planner.model.refusal import (
    RATES,
    BeyondRange,
    Carrying,
    JointName,
    MotionLimit,
    Obstacle,
    Quantity,
    Reason,
    Refusal,
    Stage,
)
from assur.planner.model.scene import Move, Scene
from assur.planner.search.extension import arrival, too_hard
from assur.planner.search.late_end import ends_too_late
from assur.planner.search.partial_plan import Candidate, Extension, PartialPlan
from assur.planner.trajectory import Trajectory, check_limits
from assur.planner.trajectory.joining import joined

SLOWED = 8
"""Times that a run which accelerates the held part too hard is timed again."""
SLOWER = 0.97
"""... with this share of what would be just enough."""


def run_of(scene: Scene, step: int) -> range:
    """The steps from `step` on that are one motion from rest to rest: vias, and the stop behind them."""
    last = step
    while isinstance(scene.task[last], Move) and getattr(scene.task[last], "via", False):
        last += 1
    return range(step, last + 1)


def blend_extension(scene: Scene, partial: PartialPlan, shape: BlendShape) -> Extension | Refusal:
    """The extension through the stations of the next run of steps, within all limits but that of the jerk.

    A run that accelerates a held part too hard is timed again, slower as a whole.
    """
    found, limit = _extended(scene, partial, shape), scene.carry_acceleration
    slower, given = found, scene.options.acceleration_time_s is not None
    for _ in range(SLOWED if limit is not None else 0):
        if not (isinstance(slower, Refusal) and isinstance(slower.facts, Carrying)):
            break
        # the same way at a share of the speed has its square of the acceleration, unless the blends have a given time
        share = SLOWER * slower.facts.limit / slower.facts.acceleration
        shape = replace(shape, pace=shape.pace * (share if given else share**0.5))
        slower = _extended(scene, partial, shape)
    # where no slower motion will do, the limit is why: at its own pace there was a motion
    return found if isinstance(slower, Refusal) else slower


def _extended(scene: Scene, partial: PartialPlan, shape: BlendShape) -> Extension | Refusal:
    if not partial.state.resting:
        raise FaultError("parabolic blends begin at rest")
    found = blended(scene, partial.step, partial.state.time, partial.state.q, shape)
    if isinstance(found, Refusal):
        return found
    knots = _knots(partial, found)
    late = ends_too_late(scene, partial.step, knots.end)
    if late is not None:
        return late
    trajectory = Trajectory(knots.time, knots.q, knots.qd, knots.qdd, jumps=True)
    beyond = _beyond(scene, partial.step, trajectory) or leaves_assembly(scene.robot, partial.step, trajectory)
    beyond = beyond or turns_into(scene, partial.step, trajectory)
    if beyond is not None:
        return beyond
    legs = _legs(partial, shape, found, knots.end)
    arrivals = _arrivals(scene, partial, shape, found, trajectory)
    after = _after(partial, shape.stations[-1], legs, arrivals, knots)
    ours = phases(scene, after.legs, after.arrivals)[len(partial.legs) :]
    if after.step < len(scene.task):
        ours = ours[: len(legs)]  # the arm does not stand still here
    heavy = too_hard(scene, partial.step, trajectory, tuple(ours))
    if heavy is not None:
        return heavy
    last = shape.stations[-1]
    candidate = Candidate(last.point.yaw_offset, last.branch, Shape(wait=shape.wait))
    return Extension(partial, candidate, trajectory, ours, after)


def _knots(partial: PartialPlan, found: Blended) -> Knots:
    """The knots of the motion, the wait before it included."""
    time, q, qd, qdd = found.law.knots(found.begin)
    if found.begin > partial.state.time:
        time, none = np.append(partial.state.time, time), np.zeros_like(q[:1])
        q, qd, qdd = (np.concatenate([first, part]) for first, part in ((q[:1], q), (none, qd), (none, qdd)))
    return Knots.made(time, q, qd, qdd)


def _legs(partial: PartialPlan, shape: BlendShape, found: Blended, end: float) -> tuple[Leg, ...]:
    """A leg to each station, which ends when its pose is due; before the first a wait, if there is one."""
    edges = [found.begin, *found.times[:-1], end]
    legs = [
        Leg(LegKind.MOVE, station.point.step, t0, t1, Route(Course.BLENDS, len(free)))
        for station, free, t0, t1 in zip(shape.stations, shape.frees, edges[:-1], edges[1:], strict=True)
    ]
    if found.begin > partial.state.time:
        # a wait that was sampled is for bodies; the rest is for points that are not yet there
        route = Route(Course.FOR_BODIES if shape.wait > 0 else Course.FOR_POINT)
        first = legs[0]
        waited = None if first.route is None else replace(first.route, after_wait=True)
        wait = Leg(LegKind.WAIT, partial.step, partial.state.time, found.begin, route)
        legs = [wait, replace(first, route=waited), *legs[1:]]
    return tuple(legs)


def _arrivals(
    scene: Scene, partial: PartialPlan, shape: BlendShape, found: Blended, trajectory: Trajectory
) -> tuple[Arrival, ...]:
    made = []
    for station, number, time in zip(shape.stations, found.poses, found.times, strict=True):
        point = station.point
        t = min(time, trajectory.end)
        there = arrival(scene, point, partial, trajectory, t, t)
        if point.via:
            away = there.pose.position - point.flange(np.array(t)).at(scene.tool.tcp).p
            missed = Missed(tuple(found.law.missed_by[number].tolist()), float(np.sqrt((away**2).sum())))
            there = replace(there, missed_by=missed)
        made.append(there)
    return tuple(made)


def _after(
    partial: PartialPlan, last: Station, legs: tuple[Leg, ...], arrivals: tuple[Arrival, ...], knots: Knots
) -> PartialPlan:
    whole = knots
    if partial.knots is not None:
        before, behind = (
            tuple(getattr(k, name) for name in ("time", "q", "qd", "qdd")) for k in (partial.knots, knots)
        )
        whole = Knots.made(*joined(before, behind))
    return PartialPlan(
        step=last.point.step + 1,
        state=knots.last,
        mode=last.branch.mode,
        attached=partial.attached,
        legs=partial.legs + legs,
        arrivals=partial.arrivals + arrivals,
        knots=whole,
        proofs=partial.proofs,
    )


def _beyond(scene: Scene, step: int, trajectory: Trajectory) -> Refusal | None:
    """Whether the spline as written breaks a limit of position, velocity or acceleration."""
    limits = at_start(scene).limits(scene)  # with parabolic blends nothing is picked or placed
    report = check_limits(trajectory, limits.lower, limits.upper, limits.velocity, limits.acceleration, None)
    if report.ok:
        return None
    first = next(check for check in report.checks if not check.ok)
    position = first.kind == "position"
    rate = next((rate for rate in RATES if rate == first.kind), None)
    joint = first.joint or 0
    low, high = float(first.lower[joint]), float(first.upper[joint])
    facts: BeyondRange | MotionLimit
    if position:
        below = float(limits.lower[joint]) - low
        facts = beyond(scene, joint, low if below > high - float(limits.upper[joint]) else high)
    else:
        limit = float((limits.velocity if rate == "velocity" else limits.acceleration)[joint])
        facts = MotionLimit(obstacle=Obstacle.RATE, rate=rate, value=max(high, -low), limit=limit)
    return Refusal(
        stage=Stage.LIMITS,
        reason=Reason.JOINT_LIMIT if position else Reason.MOTION_LIMIT,
        step=step,
        subject=JointName(scene.robot.joints[joint].name),
        amount=Quantity.of(float(first.ratio.max()) - 1, "1"),
        facts=facts,
    )
