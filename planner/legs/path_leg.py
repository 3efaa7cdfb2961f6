"""Cartesian legs along a path: lines, arcs and splines in a frame, corners rounded, without a stop in between.

The tool point is at r(s L) of a path of length L in the frame, its yaw, pitch and roll go from end to end by the same
s, and s goes from 0 to 1 by a phase law, as on a straight leg (`assur.planner.legs.straight`). At s = 0 and s = 1 the
tool moves with the frame.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError, InputError
from assur.planner.frames.motion import Pose
from assur.planner.legs.control_point import ControlPoint
from assur.planner.legs.course import PathCourse
from assur.planner.legs.follower import UNIFORM, Jumps, PathTask, first_beyond, followed, looks, marks_of
from assur.planner.legs.limits import rates, too_fast
from assur.planner.legs.phase_law import CORNER_SAMPLES, STEEPER, TABLE, Bends, quickest, slowed_at_bends
from assur.planner.legs.state import State, TimedLeg
from assur.planner.legs.straight import CLOSE_ROUNDS, by_law, constant_law
from assur.planner.legs.tilt import flange_of, tilt_of
from assur.planner.legs.tracking import TrackingLegs, cut
from assur.planner.model.outcome import Traced
from assur.planner.model.path import Path
from assur.planner.model.refusal import (
    BeyondRange,
    MotionLimit,
    Obstacle,
    Quantity,
    Reason,
    Refusal,
    Stage,
    unmoved,
)
from assur.planner.model.scene import Move, Scene, Trace
from assur.planner.robots.facts import Code, Limits
from assur.planner.trajectory import Trajectory


def along_path(
    scene: Scene, point: ControlPoint, state: State, modes: tuple[int, int], tracked: ControlPoint | None
) -> TimedLeg | Refusal:
    """A leg along the path of a move from `state`, at rest or while `tracked` is tracked, until the tool is at `point`.

    Refused: another frame or working mode than it begins in, points from which there is no path, and, with the place on
    the path, out of reach, too near a singularity, a joint beyond its range.
    """
    course = _course(scene, point, state, modes, tracked)
    if isinstance(course, Refusal):
        return course
    way = PathTask(scene, Stage.STRAIGHT, point.step, course, UNIFORM, state.time, point.frame)
    mode, limits = modes[0], point.limits
    found = [by_law(way, state, mode, law, CLOSE_ROUNDS, limits) for law in _laws(way, course, mode, limits)]
    if not (point.still and any(isinstance(leg, TimedLeg) for leg in found)):
        plain = by_law(way, state, mode, constant_law(), 0, limits)
        found.append(_placed(way, state, mode, plain) if isinstance(plain, Refusal) else plain)
    legs = [leg for leg in found if isinstance(leg, TimedLeg)]
    return min(legs, key=lambda leg: leg.knots.end) if legs else found[-1]


def _placed(way: PathTask, state: State, mode: int, refusal: Refusal) -> Refusal:
    """A refusal of a joint's range with where on the path it is beyond."""
    if not isinstance(refusal.facts, BeyondRange) or refusal.joint is None:
        return refusal
    way = replace(way, phase=constant_law())
    made = followed(way, state, mode)
    if isinstance(made, Refusal):
        return refusal
    return replace(refusal, facts=replace(refusal.facts, **way.spot(first_beyond(way.scene, made, refusal.joint))))


def _course(
    scene: Scene, point: ControlPoint, state: State, modes: tuple[int, int], tracked: ControlPoint | None
) -> PathCourse | Refusal:
    move = point.facts
    if not isinstance(move, Move) or modes[0] != modes[1]:
        return unmoved(Stage.STRAIGHT, point.step, Obstacle.OTHER_MODE)
    if tracked is None and not state.resting:
        return unmoved(Stage.STRAIGHT, point.step, Obstacle.STRAIGHT_FROM_MOTION)
    still = scene.frames[point.frame].law.is_fixed
    if not (still if tracked is None else tracked.frame == point.frame):
        return unmoved(Stage.STRAIGHT, point.step, Obstacle.OTHER_FRAME)
    begin = tool_in(scene, point.frame, state.q, state.time)
    path = path_from(move, point.step, begin)
    if isinstance(path, Refusal):
        return path
    end, length = point.pose.then(scene.tool.tcp), path.length
    turn = float(np.remainder(end.yaw - begin.yaw + np.pi, 2 * np.pi) - np.pi)
    before = tilt_of(scene.robot, state.q)
    tilts = None if before is None or point.tilt is None else (before, point.tilt)
    tcp, none = scene.tool.tcp, np.zeros(3)
    return PathCourse(scene, point.frame, path, (0.0, length), length, tcp, none, (begin.yaw, turn), tilts)


def tool_in(scene: Scene, frame: str, q: FloatArray, t: float) -> Pose:
    """The pose of the tool in a frame with the joints `q` (n,) at a time."""
    at = scene.frames[frame].law.motion(np.array(t))
    x, y, z = at.p.tolist()
    there = Pose(x, y, z, float(at.yaw))
    return there.inverse().then(flange_of(scene.robot, q).then(scene.tool.tcp))


def path_from(move: Move, step: int, begin: Pose) -> Path | Refusal:
    """The path of a move, which is step number `step`, from a pose of the tool in its frame, if there is one."""
    try:
        path = move.path_from((begin.x, begin.y, begin.z))
        path.curve  # noqa: B018 - what is wrong with a path is found when it is made
    except InputError:
        return unmoved(Stage.STRAIGHT, step, Obstacle.NO_PATH)
    return path


def _laws(way: PathTask, course: PathCourse, mode: int, limits: Limits) -> list[Trajectory]:
    """Laws made for the path in the frame as it stands when the leg begins: one that slows down where the path bends,
    and the quickest that is found without parts."""
    stands, curve, robot = replace(way, course=replace(course, stands=way.begin)), course.path.curve, way.scene.robot
    _, places, half = course.widths
    over = dict(zip(places.tolist(), (2 * half).tolist(), strict=True))
    bends = list[Bends]()
    for begin, end in pairwise(curve.edges.tolist()):
        # not at the ends: there the next part counts
        inner = begin + (end - begin) * np.clip(np.linspace(0.0, 1.0, CORNER_SAMPLES), 1e-9, 1 - 1e-9)
        found = robot.inverse(stands.motion(way.begin + inner / curve.length), mode, 2)
        if not (found.code == Code.ASSEMBLED).all():
            return []
        bends.append(Bends(end - begin, found.qd / curve.length, found.qdd / curve.length**2, over.get(begin, 0.0)))
    slow = slowed_at_bends(bends, limits.velocity, limits.acceleration, limits.jerk)
    laws = [] if slow is None else [slow]
    s = np.linspace(0.0, 1.0, TABLE)
    found = robot.inverse(stands.motion(way.begin + s), mode, 2)
    if not (found.code == Code.ASSEMBLED).all():
        return laws
    bend = found.qdd.copy()
    # where the curvature jumps q'' does: it is taken to change over as much of the path as the quintic is steep on
    for place, reach in zip(places / curve.length, half / curve.length / STEEPER, strict=True):
        i, k = int(np.floor((place - reach) * (TABLE - 1))), int(np.ceil((place + reach) * (TABLE - 1)))
        if 0 <= i < k < TABLE:
            bend[i : k + 1] = np.linspace(bend[i], bend[k], k - i + 1)
    quick = quickest((found.qd, bend, np.gradient(bend, s, axis=0)), limits)
    return laws if quick is None else [*laws, quick]


# Traces: the tool point goes along a path in a frame that may move, at a process speed (equations Q6 and Q7).
#
# The place on the path is a law of time alone: it rises on a straight lead-in, has the process speed over all of the
# path and falls on a lead-out. The joints follow from it and from the frame. Where the curvature of the path jumps, as
# from a line to an arc, the acceleration would; there knots lie on both sides and none between, and the quintic between
# them leaves the path by some micrometres, within the promise.

TRACED_M, SPEED_SHARE = 1e-5, 0.01
"""The promise: how far the tool point may be from its place on the path, m, and how much its speed may differ."""
RESERVE_M, RESERVE_SHARE = 1e-6, 1e-3
"""Added to what is found at these times; the checker bounds what lies between."""


def _times(step: Trace) -> tuple[float, float, float]:
    """When a trace comes to its path and leaves it, and when its lead-out ends, s since its lead-in began: from rest
    the mean speed of a lead is half of the process speed."""
    met = 2.0 * step.lead_in_m / step.speed_m_s
    left = met + step.dwell_s
    return met, left, left + 2.0 * step.lead_out_m / step.speed_m_s


def _process(step: Trace) -> Trajectory:
    """The arc length of a trace, m from the path's first point, over the time since its lead-in began (Q6)."""
    (met, left, end), v, length = _times(step), step.speed_m_s, step.path.length
    knots = np.array(
        [
            [0.0, -step.lead_in_m, 0.0, 0.0],
            [met, 0.0, v, 0.0],
            [left, length, v, 0.0],
            [end, length + step.lead_out_m, 0.0, 0.0],
        ]
    )
    return Trajectory.of_knots(knots[0 if met > 0.0 else 1 : 4 if end > left else 3])


def lead(point: ControlPoint) -> float:
    """Seconds from the beginning of the lead-in to that of the path."""
    return _times(_trace(point))[0]


def left_at(point: ControlPoint) -> ControlPoint:
    """The point in the frame at which the flange is when a lead-out has ended."""
    step = _trace(point)
    r, _, _ = step.path.curve.at(np.array([-step.lead_in_m, step.path.length + step.lead_out_m]))
    x, y, z = (r[1] - r[0]).tolist()
    pose = point.pose
    return replace(point, pose=Pose(pose.x + x, pose.y + y, pose.z + z, pose.yaw))


def _trace(point: ControlPoint) -> Trace:
    step = point.facts
    if not isinstance(step, Trace):
        raise FaultError(f"{step.name} is no trace")
    return step


def _way(point: ControlPoint, begin: float) -> PathTask:
    """The motion of the flange along the path from `begin`, s."""
    step, scene = _trace(point), point.scene
    edges = -step.lead_in_m, step.path.length + step.lead_out_m
    beside = point.pose.position - step.path.curve.at(np.array(edges[:1]))[0][0]
    tilts = None if point.tilt is None else (point.tilt, point.tilt)
    course = PathCourse(scene, point.frame, step.path, edges, 1.0, Pose(), beside, (point.pose.yaw, 0.0), tilts)
    return PathTask(scene, Stage.TRACKING, point.step, course, _process(step), begin, point.frame)


def trace(point: ControlPoint, state: State, mode: int) -> TrackingLegs | Refusal:
    """Lead-in, path and lead-out from `state`, in which the flange is where the lead-in begins, moving with the frame.

    Refused, with the place on the path: out of reach, too near a singularity, a joint beyond its range or its rates.
    """
    way, step = _way(point, state.time), _trace(point)
    spline = followed(way, state, mode)
    if isinstance(spline, Refusal):
        if not isinstance(spline.facts, MotionLimit):
            return spline
        spline = replace(spline, facts=replace(spline.facts, speed_m_s=step.speed_m_s))
        jumps = Jumps.of(way)
        return _too_fast(way, point, mode, jumps.free(marks_of(way, jumps))) or spline
    refusal = _refused_rates(way, point, spline)
    met, left, _ = _times(step)
    return refusal or cut(spline, way.begin + met, way.begin + left)


def _refused_rates(way: PathTask, point: ControlPoint, spline: Trajectory) -> Refusal | None:
    """Which joint breaks a limit, and where on the path it does most."""
    fast = rates(way.scene, way.stage, way.step, spline, point.limits)
    if isinstance(fast, Refusal):
        when, facts = first_beyond(way.scene, spline, fast.joint), fast.facts
        if not isinstance(facts, BeyondRange):
            raise FaultError("a joint beyond its range without its facts")
        return replace(fast, interval=(when, when), facts=replace(facts, **way.spot(when)))
    if fast.ok:
        return None
    kind, joint = (int(k) for k in np.unravel_index(int(fast.ratios.argmax()), fast.ratios.shape))
    t = looks(spline.time)
    return _at(way, point, fast.ratios, float(t[int(np.abs(spline.evaluate(t, kind + 1)[:, joint]).argmax())]))


def _too_fast(way: PathTask, point: ControlPoint, mode: int, t: FloatArray) -> Refusal | None:
    """Which joint would be too fast for the exact motion at times `t` (T,), and where on the path it would be most."""
    found, limits = way.scene.robot.inverse(way.motion(t), mode, 2), point.limits
    ratios = np.abs(np.stack([found.qd, found.qdd])) / np.stack([limits.velocity, limits.acceleration])[:, None]
    ratios[~np.isfinite(ratios)] = 0.0
    if not ratios.max() > 1.0:
        return None
    worst = np.zeros((3, ratios.shape[2]))
    worst[:2] = ratios.max(1)
    return _at(way, point, worst, float(t[int(ratios.max((0, 2)).argmax())]))


def _at(way: PathTask, point: ControlPoint, ratios: FloatArray, when: float) -> Refusal:
    """The refusal of a joint that is too fast for a path, with where on it that is at its worst; `ratios` (3, n) of its
    rates to their limits."""
    refusal = too_fast(way.scene, way.stage, way.step, ratios, point.limits, point.frame)
    if not isinstance(refusal.facts, MotionLimit):
        raise FaultError("a joint too fast without its facts")
    speed = _trace(point).speed_m_s
    facts = replace(refusal.facts, obstacle=Obstacle.PATH_TOO_FAST, speed_m_s=speed, **way.spot(when))
    return replace(refusal, interval=(when, when), facts=facts)


def traced(scene: Scene, point: ControlPoint, trajectory: Trajectory, begin: float, until: float) -> Traced | Refusal:
    """The report on a path that is traced from `begin` to `until`, s; a refusal where the promise is not kept."""
    step = _trace(point)
    way = _way(point, begin - lead(point))
    t = np.clip(looks(trajectory.time[(trajectory.time >= begin) & (trajectory.time <= until)]), begin, until)
    robot, none = scene.robot, np.zeros((len(t), len(scene.robot.joints)))
    q, qd, _ = trajectory.states(t)
    motion = robot.link_motion(len(robot.links) - 1, q, qd, none, none).at(scene.tool.tcp)
    frame = scene.frames[point.frame].law.motion(t)
    place, velocity = motion.p - frame.p, motion.v - frame.v
    velocity[:, 0] += frame.yaw_d * place[:, 1]
    velocity[:, 1] -= frame.yaw_d * place[:, 0]
    speed = np.linalg.norm(velocity, axis=1)
    r, _, _ = step.path.curve.at(way.phases(t)[0])
    goal = frame.carrying(r, np.zeros_like(r), np.zeros_like(r))
    v, error = step.speed_m_s, float(np.linalg.norm(motion.p - goal.p, axis=1).max()) + RESERVE_M
    slowest, fastest = float(speed.min()) - RESERVE_SHARE * v, float(speed.max()) + RESERVE_SHARE * v
    if slowest >= (1 - SPEED_SHARE) * v and fastest <= (1 + SPEED_SHARE) * v and error <= TRACED_M:
        return Traced(step.path.length, slowest, fastest, error)
    worst = float(t[int(np.abs(speed - v).argmax())])
    return Refusal(
        stage=Stage.TRACKING,
        reason=Reason.MOTION_LIMIT,
        step=point.step,
        interval=(worst, worst),
        amount=Quantity.of(max(v - slowest, fastest - v) / v - SPEED_SHARE, "1"),
        facts=MotionLimit(obstacle=Obstacle.PROCESS_SPEED, frame=point.frame, speed_m_s=v, **way.spot(worst)),
    )
