"""Continues a partial plan by one step: a leg to its control point, tracking there, and rest at the end."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.claim.lifts import goes_over
from assur.planner.errors import FaultError
from assur.planner.frames.motion import Motion
from assur.planner.legs.accuracy import arrival_error, too_far
from assur.planner.legs.control_point import WINDOW_S, ControlPoint
from assur.planner.legs.forbidden_yaw import turns_into
from assur.planner.legs.joint import JointMotion, slowed
from assur.planner.legs.limits import beyond_limits, parts, too_near
from assur.planner.legs.meeting import leaving
from assur.planner.legs.missed import by_law
from assur.planner.legs.path_leg import along_path, left_at, trace, traced
from assur.planner.legs.state import Knots, TimedLeg
from assur.planner.legs.straight import mode_changes, straight
from assur.planner.legs.tilt import flange_of, tilt_of
from assur.planner.legs.tool_motion import RESERVE, carrying_peak
from assur.planner.legs.tracking import track
from assur.planner.model.assembly_mode import leaves_assembly
from assur.planner.model.outcome import TRACKING, Arrival, Course, Leg, LegKind, Route
from assur.planner.model.phases import Phase, cleared, stay_phases, step_phases
from assur.planner.model.refusal import (
    Carrying,
    Obstacle,
    Quantity,
    Reason,
    Refusal,
    Stage,
    unmoved,
    window_missed,
)
from assur.planner.model.scene import Move, Scene, Trace
from assur.planner.model.window_missed import Miss, WindowMissed
from assur.planner.report.notes import window_left
from assur.planner.robots.facts import Limits
from assur.planner.robots.robot import Robot
from assur.planner.search.meeting_options import ends_too_late, laws_over, shifted_out, stops_at_via, tracked_too_long
from assur.planner.search.partial_plan import Candidate, Extension, PartialPlan, TimedCandidate, scaled_limits
from assur.planner.timing import TimingRefusal, fastest_motion
from assur.planner.trajectory import Trajectory

STILL = 1e-9
"""A last joint rate below this is rounding, rad/s or m/s (an acceleration: a thousand times as much)."""
SLOWED = 4
"""Times that a motion which pulls too hard at the held part is timed again."""
GENTLER = (1.0, 0.7)
"""Shares of the effort with which a motion is timed that is then slowed down where it pulls too hard."""
SLOWER = 0.93
"""... with this share of what would be just enough if accelerations scaled with the limits."""


def timed(
    scene: Scene, partial: PartialPlan, candidate: Candidate, ahead: FloatArray | None
) -> TimedCandidate | Refusal:
    """The joint leg to the control point that `candidate` describes, or why Ruckig has none."""
    point = candidate.option.meeting.point
    scaled = scaled_limits(scene, partial, candidate.shape, point)
    reached = JointMotion(scene, partial.step, partial.state, candidate.shape, candidate.branch, ahead, scaled).meet()
    if isinstance(reached, Refusal):
        return by_law(point, candidate.option.meeting.last, reached)
    if candidate.shape.form is not None and not _is_arch(scene, reached):
        return unmoved(Stage.TIMING, partial.step, Obstacle.NO_ARCH)
    if not point.tracks:
        missed = _window_refusal(point, reached.end)
        if missed is not None:
            return missed
    unknown = laws_over(scene, partial.step, reached.end) or turns_into(scene, partial.step, reached)
    if unknown is not None:
        return unknown
    return TimedCandidate(partial, candidate, reached, (partial.way(scene, reached.end),), ahead)


def _is_arch(scene: Scene, path: Trajectory) -> bool:
    """Whether the lift goes up and then down: from a state in motion, or to one, it may go the wrong way first."""
    n, lift = path.n, scene.robot.lift or 0
    rates, accelerations = path.knots[[0, -1], 1 + n + lift].tolist(), path.knots[[0, -1], 1 + 2 * n + lift].tolist()
    wrong = rates[0] < 0.0 or rates[1] > 0.0 or min(accelerations) < 0.0
    return not wrong or goes_over(path, lift)


def extended(scene: Scene, made: TimedCandidate) -> Extension | Refusal:
    """The extension by a timed candidate. Where it pulls too hard at the held part it is slowed down there, or, to a
    point that is met at a certain time, timed again, slower as a whole."""
    found, limit = _extended(scene, made), scene.carry_acceleration
    if limit is None or not (isinstance(found, Refusal) and isinstance(found.facts, Carrying)):
        return found
    if made.standing:
        gentle = _slowed(scene, made, limit)
        if gentle is not None:
            return gentle
    for across in (True, False):
        last, peak = made, found.facts.acceleration
        for _ in range(SLOWED):
            again = _again(scene, last, SLOWER * limit / peak, across=across)
            if isinstance(again, Refusal):
                break  # the carry limit is why: at its own pace there was a motion
            last, after = again, _extended(scene, again)
            if not isinstance(after, Refusal):
                return after
            if not isinstance(after.facts, Carrying):
                break
            peak = after.facts.acceleration
    return found


def _again(scene: Scene, made: TimedCandidate, share: float, *, across: bool) -> TimedCandidate | Refusal:
    """The candidate timed again with this share of its effort, or of the acceleration of the joints `across` alone."""
    candidate, shape = made.candidate, made.candidate.shape
    if across:
        gentle = replace(candidate, shape=replace(shape, pull=share * shape.pull))
    else:
        effort = share * candidate.tracking_effort
        gentle = replace(candidate, shape=replace(shape, effort=share * shape.effort), tracking_effort=effort)
    return timed(scene, made.before, gentle, made.ahead)


def _slowed(scene: Scene, made: TimedCandidate, limit: float) -> Extension | None:
    """The extension by a candidate that is slowed down where it pulls too hard; None: its joints leave no room for
    that."""
    before = made.before
    for share in GENTLER:
        gentle = made if share == 1.0 else _again(scene, made, share, across=False)
        if isinstance(gentle, Refusal):
            return None
        motion = slowed(scene, before.step, gentle.trajectory, limit, before.attached.limits(scene))
        if motion is not None:
            found = _extended(scene, replace(gentle, trajectory=motion))
            return None if isinstance(found, Refusal) else found
    return None


def _extended(scene: Scene, made: TimedCandidate) -> Extension | Refusal:
    shape, trajectory = made.candidate.shape, made.trajectory
    leg = TimedLeg(LegKind.ARCH if shape.form else LegKind.MOVE, Knots.of(trajectory), shape.route)
    return _continued(scene, made.before, made.candidate, leg, trajectory)


def straight_extension(scene: Scene, partial: PartialPlan, candidate: Candidate) -> Extension | Refusal:
    """The extension by a straight leg."""
    point, wait, mode = candidate.point, candidate.shape.wait, candidate.branch.mode
    key = point.yaw_offset, point.tilt, wait, mode
    if key not in partial.lines:
        partial.lines[key] = _line(scene, partial, point, wait, mode)
    line = partial.lines[key]
    return line if isinstance(line, Refusal) else _continued(scene, partial, candidate, line, None)


def _line(scene: Scene, partial: PartialPlan, point: ControlPoint, wait: float, mode: int) -> TimedLeg | Refusal:
    """A straight leg to the control point, from rest or from the frame that the tool tracks."""
    state = partial.state if wait <= 0 else Knots.standing(partial.state, partial.state.time + wait).last
    if isinstance(point.facts, Move) and point.facts.path:
        return along_path(scene, point, state, (partial.mode, mode), partial.tracked)
    if partial.tracked is not None:
        before = partial.tracked

        def left(t: FloatArray) -> Motion:
            return before.flange(t, before.depart)
    elif state.resting:
        pose, tilt = flange_of(scene.robot, state.q), tilt_of(scene.robot, state.q)

        def left(t: FloatArray) -> Motion:
            still = Motion.still(pose, np.shape(t))
            return still if tilt is None else still.with_tilt(np.array(tilt))
    else:
        return unmoved(Stage.STRAIGHT, partial.step, Obstacle.STRAIGHT_FROM_MOTION)

    def met(t: FloatArray) -> Motion:
        return point.flange(t, point.approach)

    if mode != partial.mode:
        return mode_changes(scene, partial.step, state, (partial.mode, mode), left, met)
    held = partial.attached.held
    return straight(scene, partial.step, state, mode, left, met, None if held is None else held.part)


def _continued(
    scene: Scene,
    partial: PartialPlan,
    candidate: Candidate,
    way: TimedLeg,
    kept: Trajectory | None,
) -> Extension | Refusal:
    """The extension by a leg to the control point and what follows there, to rest where the task ends. `kept`: the
    trajectory of that leg, if it is known to keep all limits."""
    point = candidate.point
    legs, final, leaves = [way], partial.step == len(scene.task) - 1, None
    if candidate.shape.wait > 0:
        if not partial.state.resting:
            raise FaultError("an arm in motion cannot wait")
        standing = Knots.standing(partial.state, partial.state.time + candidate.shape.wait)
        waited = None if way.route is None else replace(way.route, after_wait=True)
        legs = [TimedLeg(LegKind.WAIT, standing, Route(Course.FOR_BODIES)), replace(way, route=waited)]
    begin = end = way.knots.end
    if point.tracks:
        last, mode = way.knots.last, candidate.branch.mode
        if isinstance(point.facts, Trace):
            there = trace(point, last, mode)
        else:
            leaves = None if candidate.stops else leaving(scene, point, _lowered(scene, point, last.q))
            there = track(scene, point, last, mode, candidate.tracking_effort, leaves)
        if isinstance(there, Refusal):
            return there
        begin, end = there.begin, there.end
        legs += there.legs
    missed = _window_refusal(point, begin)
    if missed is not None:
        return missed
    if final and scene.options.end == "rest" and not legs[-1].knots.last.resting:
        stopped = at_rest(partial.step, legs, candidate.stop_pace, point.limits_after)
        if isinstance(stopped, Refusal):
            return stopped
        legs = stopped
    knots = legs[0].knots
    for leg in legs[1:]:
        knots = knots.then(leg.knots)
    late = ends_too_late(scene, partial.step, knots.end)
    if late is not None:
        return late
    if kept is not None and knots.table is kept.knots:
        trajectory = kept
    else:
        trajectory = Trajectory.of_knots(knots.table)
        spans = ((end, point.limits), (knots.end, point.limits_after))
        for part, limits in parts(trajectory, spans):
            beyond = beyond_limits(scene, partial.step, part, limits)
            if beyond is not None:
                return beyond
    lost = stops_at_via(scene, partial, trajectory)
    lost = lost or leaves_assembly(scene.robot, partial.step, trajectory) or turns_into(scene, partial.step, trajectory)
    lost = lost or _near_singular(scene, partial.step, trajectory, legs)
    if lost is not None:
        return lost
    made = tuple(Leg(leg.kind, partial.step, leg.knots.begin, leg.knots.end, leg.route) for leg in legs)
    met = arrival(scene, point, partial, trajectory, begin, end)
    if isinstance(point.facts, Trace):
        report = traced(scene, point, trajectory, begin, end)
        if isinstance(report, Refusal):
            return report
        met, point = replace(met, trace=report), left_at(point)
    inaccurate = too_far(scene, partial.step, met.error)
    if inaccurate is not None:
        return inaccurate
    arrivals = (*partial.arrivals, met)
    ours, attached, handled = step_phases(scene, partial.attached, partial.handled, made, arrivals)
    if final:
        ours += stay_phases(scene, trajectory.end, attached, handled, arrivals)
    attached, handled = cleared(scene, attached, handled, arrivals, knots.end)
    unknown = tracked_too_long(scene, partial.step, ours)
    if unknown is not None:
        return unknown
    lost = shifted_out(scene, partial.step, trajectory, ours)
    if lost is not None:
        return lost
    heavy = too_hard(scene, partial.step, trajectory, tuple(ours))
    if heavy is not None:
        return heavy
    after = PartialPlan(
        step=partial.step + 1,
        state=knots.last,
        mode=candidate.branch.mode,
        attached=attached,
        handled=handled,
        legs=partial.legs + made,
        arrivals=arrivals,
        knots=knots if partial.knots is None else partial.knots.then(knots),
        trajectory=trajectory if partial.knots is None else None,
        proofs=partial.proofs,
        wrist=partial.wrist + wrist_travel(scene.robot, knots.q),
        rises=0.0 if leaves is None else leaves.far - leaves.height,
        stops=candidate.stops,
        tracked=point if leaves is None and not knots.last.resting and point.matched and not point.via else None,
        scaled=partial.scaled,
    )
    return Extension(partial, candidate, trajectory, tuple(ours), after)


def _near_singular(scene: Scene, step: int, trajectory: Trajectory, legs: list[TimedLeg]) -> Refusal | None:
    """Whether a leg that tracks a point, or goes along a line or a path, comes too near to a singular position."""
    for leg in legs:
        course = None if leg.route is None else leg.route.course
        if leg.kind in TRACKING or course in (Course.STRAIGHT, Course.PATH):
            stage = Stage.TRACKING if leg.kind in TRACKING else Stage.STRAIGHT
            lost = too_near(scene, stage, step, trajectory, leg.knots.begin, leg.knots.end)
            if lost is not None:
                return lost
    return None


def _lowered(scene: Scene, point: ControlPoint, q: FloatArray) -> FloatArray:
    """Joints (n,) at a point that is met with joints `q` above it, as far as the lift goes."""
    if scene.robot.lift is None:
        return q
    lowered = q.copy()
    lowered[scene.robot.lift] -= point.approach
    return lowered


def _window_refusal(point: ControlPoint, begin: float) -> Refusal | None:
    """Whether the arm may begin to track the point at `begin`."""
    spans = point.intervals
    for low, high in spans:
        if low - WINDOW_S <= begin <= high + WINDOW_S:
            return None
    if not spans:
        facts = WindowMissed(miss=Miss.OUTSIDE, needed_s=point.dwell)
        return window_missed(Stage.WINDOW, point.step, facts, amount=Quantity.of(point.dwell, "s"))
    off = min(max(low - begin, begin - high) for low, high in spans)
    facts = WindowMissed(miss=Miss.OUTSIDE)
    return window_missed(Stage.WINDOW, point.step, facts, amount=Quantity.of(off, "s"), interval=spans[0])


def at_rest(step: int, legs: list[TimedLeg], pace: float, limits: Limits) -> list[TimedLeg] | Refusal:
    """The legs, at rest in the end: to the bit where only rounding keeps them from it, else by a leg of its own, for
    what tracks a moving frame; that ends near where braking alone would."""
    last = legs[-1].knots.last
    if np.abs(last.qd).max() <= STILL and np.abs(last.qdd).max() <= 1e3 * STILL:
        table = legs[-1].knots.table.copy()
        table[-1, 1 + len(last.q) :] = 0.0
        return [*legs[:-1], replace(legs[-1], knots=Knots(table))]
    duration = pace * float(np.max(np.abs(last.qd) / limits.acceleration + 2 * limits.acceleration / limits.jerk))
    # what an even braking over that time covers
    target = np.clip(last.q + last.qd * duration / 2, limits.lower, limits.upper)
    start, rest = (last.q.tolist(), last.qd.tolist(), last.qdd.tolist()), [0.0] * len(last.q)
    velocity, acceleration, jerk = limits.table[2:].tolist()
    found = fastest_motion(start, (target.tolist(), rest, rest), (velocity, acceleration, jerk), last.time)
    if isinstance(found, TimingRefusal):
        return unmoved(Stage.TIMING, step, Obstacle.NO_PROFILE)
    return [*legs, TimedLeg(LegKind.MOVE, Knots.of(found), Route(Course.TO_REST))]


def too_hard(scene: Scene, step: int, trajectory: Trajectory, phases: tuple[Phase, ...]) -> Refusal | None:
    """Whether the held part would be accelerated harder than it may be."""
    limit = scene.carry_acceleration
    peak = carrying_peak(scene, trajectory, phases) if limit is not None else None
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


def wrist_travel(robot: Robot, q: FloatArray) -> float:
    """By how much the last joint turns from row to row of q (K, n), there and back counted both, rad; 0 if it does not
    turn."""
    return float(np.abs(np.diff(q[:, -1])).sum()) if robot.revolute[-1] > 0 and len(robot.joints) > 3 else 0.0


def arrival(
    scene: Scene, point: ControlPoint, partial: PartialPlan, trajectory: Trajectory, begin: float, end: float
) -> Arrival:
    """The arrival at the control point that ends `partial` at `begin`, s, where the tool tracks it until `end`."""
    pose = flange_of(scene.robot, trajectory.evaluate(begin)).then(scene.tool.tcp)
    along = point.along(np.array(begin))
    return Arrival(
        step=point.step,
        control_point=point.name,
        time=begin,
        until=end,
        pose=pose,
        matched=point.matched and not point.via,
        yaw_offset=point.yaw_offset,
        along_m=None if along is None else float(along),
        window_left_s=window_left(point, begin),
        pitch=None if point.tilt is None else point.tilt[0],
        roll=None if point.tilt is None else point.tilt[1],
        error=arrival_error(scene, point.step, partial.attached, partial.handled, trajectory.evaluate(end), end),
    )
