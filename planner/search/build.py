"""Puts a continuation together from its stretches: rest at the end, limits on the way, arrival, phases."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from assur.planner.frames.motion import Pose
from assur.planner.legs.control_point import ControlPoint
from assur.planner.legs.limits import beyond_limits
from assur.planner.legs.state import Knots, State, Stretch
from assur.planner.legs.tool_motion import RESERVE, carrying_peak
from assur.planner.model.assembly_mode import leaves_assembly
from assur.planner.model.outcome import Arrival, Course, Leg, LegKind, Route
from assur.planner.model.phases import Phase, phases
from assur.planner.model.refusal import (
    Carrying,
    Miss,
    Obstacle,
    Quantity,
    Reason,
    Refusal,
    Stage,
    WindowMissed,
    law_ends,
    unmoved,
    window_missed,
)
from assur.planner.model.scene import Place, Scene
from assur.planner.search.partial_plan import Chain, Draft, Sample
from assur.planner.timing import TimingRefusal, time_joints
from assur.planner.trajectory import Trajectory

STILL = 1e-9
"""A last joint rate below this is rounding, rad/s or m/s (an acceleration: a thousand times as much)."""


def assembled(
    scene: Scene,
    chain: Chain,
    point: ControlPoint,
    sample: Sample,
    stretches: list[Stretch],
    begin: float,
    end: float,
) -> Draft | Refusal:
    """The draft of these stretches, with a last leg to rest where the task ends."""
    final = chain.step == len(scene.task) - 1
    if final and scene.options.end == "rest":
        stretches[-1] = replace(stretches[-1], knots=_settled(stretches[-1].knots))
    last = stretches[-1].knots.last
    if final and scene.options.end == "rest" and not last.resting:
        # what hangs on a moving frame comes to rest by a leg of its own
        stop = _to_rest(scene, chain.step, last, sample.stop_pace)
        if isinstance(stop, Refusal):
            return stop
        stretches.append(stop)
    knots = stretches[0].knots
    for stretch in stretches[1:]:
        knots = knots.then(stretch.knots)
    latest = scene.options.latest_end_s
    if latest is not None and not knots.time[-1] <= latest:
        return ends_too_late(chain.step, float(knots.time[-1]) - latest)
    unknown = laws_over(scene, chain.step, float(knots.time[-1]))
    if unknown is not None:
        return unknown
    trajectory = Trajectory(knots.time, knots.q, knots.qd, knots.qdd)
    beyond = beyond_limits(scene, chain.step, trajectory) or leaves_assembly(scene.robot, chain.step, trajectory)
    if beyond is not None:
        return beyond
    legs = tuple(Leg(s.kind, chain.step, float(s.knots.time[0]), float(s.knots.time[-1]), s.route) for s in stretches)
    met = arrival(scene, point, trajectory, begin, end)
    after = _after(scene, chain, point, sample, legs, met, knots)
    ours = phases(scene, after.legs, after.arrivals)[len(chain.legs) :]
    if not final:
        ours = ours[: len(legs)]  # the arm does not stand still here
    heavy = _too_hard(scene, chain.step, trajectory, ours)
    if heavy is not None:
        return heavy
    return Draft(chain, sample, tuple(stretches), legs, met, knots, trajectory, after, ours)


def _too_hard(scene: Scene, step: int, trajectory: Trajectory, ours: tuple[Phase, ...]) -> Refusal | None:
    """Whether the carried part would be accelerated harder than it may be."""
    limit = scene.carry_acceleration
    peak = carrying_peak(scene, trajectory, ours) if limit is not None else None
    if limit is None or peak is None or peak[0] <= limit * (1 - RESERVE):
        return None
    return Refusal(
        stage=Stage.LIMITS,
        reason=Reason.CARRY_LIMIT,
        step=step,
        interval=(peak[1], peak[1]),
        amount=Quantity.of(peak[0] - limit, "m/s²"),
        facts=Carrying(acceleration=peak[0], limit=limit),
    )


def ends_too_late(step: int, late: float) -> Refusal:
    """The motion ends `late` seconds after the latest end."""
    return window_missed(Stage.TIMING, step, WindowMissed(miss=Miss.ENDS_TOO_LATE), amount=Quantity.of(late, "s"))


def _after(
    scene: Scene,
    chain: Chain,
    point: ControlPoint,
    sample: Sample,
    legs: tuple[Leg, ...],
    met: Arrival,
    knots: Knots,
) -> Chain:
    resting = knots.last.resting
    return Chain(
        step=chain.step + 1,
        state=knots.last,
        mode=sample.branch.mode,
        attached=chain.attached.after(scene, scene.task[chain.step], sample.yaw_offset),
        legs=chain.legs + legs,
        arrivals=(*chain.arrivals, met),
        knots=knots if chain.knots is None else chain.knots.then(knots),
        proofs=chain.proofs,
        paces=chain.paces,
        tracked=point if not resting and point.matched and not point.via else None,
    )


def _settled(knots: Knots) -> Knots:
    """The knots, with a last one that is at rest to the bit where only rounding keeps it from being."""
    last = knots.last
    if last.resting or not (np.abs(last.qd).max() <= STILL and np.abs(last.qdd).max() <= 1e3 * STILL):
        return knots
    qd, qdd = knots.qd.copy(), knots.qdd.copy()
    qd[-1] = qdd[-1] = 0.0
    return Knots(knots.time, knots.q, qd, qdd)


def _to_rest(scene: Scene, step: int, state: State, pace: float) -> Stretch | Refusal:
    """A last leg that brings a moving arm to rest, near where braking alone would."""
    limits = scene.robot.limits
    duration = pace * float(np.max(np.abs(state.qd) / limits.acceleration + 2 * limits.acceleration / limits.jerk))
    # what an even braking over that time covers
    target = np.clip(state.q + state.qd * duration / 2, limits.lower, limits.upper)
    none = np.zeros_like(state.q)
    rates = limits.velocity, limits.acceleration, limits.jerk
    found = time_joints(state.q, state.qd, state.qdd, target, none, none, *rates, begin=state.time)
    if isinstance(found, TimingRefusal):
        return unmoved(Stage.TIMING, step, Obstacle.NO_PROFILE)
    return Stretch(LegKind.MOVE, Knots.of(found), Route(Course.TO_REST))


def laws_over(scene: Scene, step: int, end: float) -> Refusal | None:
    """Whether the law of a frame that bears a body, or will, ends before the arm, started late, has stood still for as
    long as is required."""
    stay = scene.options.stay_safe_s if scene.options.end == "rest" else 0.0
    needed = end + stay + scene.execution.start_tolerance_s
    bearing = [body.frame for body in scene.bodies]
    bearing += [each.to.frame for each in scene.task if isinstance(each, Place)]
    for name in dict.fromkeys(bearing):
        valid = scene.frames[name].law.valid
        if not needed <= valid[1]:
            return law_ends(Stage.TIMING, step, name, valid, needed)
    return None


def arrival(scene: Scene, point: ControlPoint, trajectory: Trajectory, begin: float, end: float) -> Arrival:
    """The arrival at a control point at `begin`, s, where the tool is glued to it until `end`."""
    p, yaw = scene.robot.forward(trajectory.evaluate(np.array(begin)))
    pose = Pose(float(p[0]), float(p[1]), float(p[2]), float(yaw)).then(scene.tool.tcp)
    along = point.along(np.array(begin))
    left = [high - begin for low, high in point.intervals if low - 1e-12 <= begin <= high + 1e-12]
    bounded = point.window.time is not None or point.window.along is not None
    return Arrival(
        step=point.step,
        control_point=point.name,
        time=begin,
        until=end,
        pose=pose,
        matched=point.matched and not point.via,
        yaw_offset=point.yaw_offset,
        along_m=None if along is None else float(along),
        window_left_s=left[0] if bounded and left else None,
        pitch=None if point.tilt is None else point.tilt[0],
        roll=None if point.tilt is None else point.tilt[1],
    )
