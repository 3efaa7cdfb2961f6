"""Traces: the tool point goes along a path in a frame that may move, at a process speed (equations Q6 and Q7).

The place on the path is a law of time alone: it rises on a straight lead-in, has the process speed over all of the path
and falls on a lead-out. The joints follow from it and from the frame. Where the curvature of the path jumps, as from a
line to an arc, the acceleration would; there knots lie on both sides and none between, and the quintic between them
leaves the path by some micrometres, within the promise.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from assur.planner.frames.motion import Pose
from assur.planner.legs.control_point import ControlPoint
from assur.planner.legs.follower import Jumps, Way, first_beyond, followed, looks, marks_of
from assur.planner.legs.limits import Rates, rates, too_fast
from assur.planner.legs.paths.course import PathCourse, spot
from assur.planner.legs.state import State
from assur.planner.legs.tracking import Tracked, cut
from assur.planner.model.outcome import Traced
from assur.planner.model.refusal import BeyondRange, MotionLimit, Obstacle, Quantity, Reason, Refusal, Spot, Stage
from assur.planner.model.scene import Scene, Trace
from assur.planner.trajectory import Trajectory

TRACED_M, SPEED_SHARE = 1e-5, 0.01
"""The promise: how far the tool point may be from its place on the path, m, and how much its speed may differ."""
RESERVE_M, RESERVE_SHARE = 1e-6, 1e-3
"""Added to what is found at these times; the checker bounds what lies between."""


@dataclass(frozen=True, eq=False)
class Process:
    """The arc length of a trace, m from the path's first point, over the time since its lead-in began (Q6)."""

    step: Trace

    @property
    def met(self) -> float:
        """How long the lead-in takes, s: from rest its mean speed is half of the process speed."""
        return 2.0 * self.step.lead_in_m / self.step.speed_m_s

    @property
    def left(self) -> float:
        """When the path ends, s."""
        return self.met + self.step.dwell_s

    @property
    def duration(self) -> float:
        return self.left + 2.0 * self.step.lead_out_m / self.step.speed_m_s

    @property
    def time(self) -> FloatArray:
        """Begin and end of lead-in, path and lead-out, s."""
        return np.array([0.0, self.met, self.left, self.duration])

    def states(self, t: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Arc length (T, 1), m, and its two derivatives at times t (T,)."""
        v, length = self.step.speed_m_s, self.step.path.length
        s, sd, sdd = v * (t - self.met), np.full(len(t), v), np.zeros(len(t))
        for rows, lasts, sign, edge, place in (
            (t < self.met, self.met, 1.0, 0.0, -self.step.lead_in_m),
            (t > self.left, self.duration - self.left, -1.0, self.duration, length + self.step.lead_out_m),
        ):
            u = np.clip(sign * (t[rows] - edge) / lasts, 0.0, 1.0)
            s[rows] = place + sign * v * lasts * u**3 * (1.0 - u / 2.0)
            sd[rows] = v * u**2 * (3.0 - 2.0 * u)
            sdd[rows] = sign * v / lasts * 6.0 * u * (1.0 - u)
        return s[:, None], sd[:, None], sdd[:, None]


def lead_in_begin(point: ControlPoint) -> Spot:
    """Where the control point of a trace is: where its lead-in begins; nothing for one of another step."""
    return spot(point.facts.path, -point.facts.lead_in_m) if isinstance(point.facts, Trace) else {}


def lead(point: ControlPoint) -> float:
    """Seconds from the beginning of the lead-in to that of the path."""
    return Process(_trace(point)).met


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


def _way(point: ControlPoint, begin: float) -> Way:
    """The motion of the flange along the path from `begin`, s."""
    step, scene = _trace(point), point.scene
    edges = -step.lead_in_m, step.path.length + step.lead_out_m
    beside = point.pose.position - step.path.curve.at(np.array(edges[:1]))[0][0]
    tilts = None if point.tilt is None else (point.tilt, point.tilt)
    course = PathCourse(scene, point.frame, step.path, edges, 1.0, Pose(), beside, (point.pose.yaw, 0.0), tilts)
    return Way(scene, Stage.TRACKING, point.step, course, Process(step), begin, point.frame)


def trace(point: ControlPoint, state: State, mode: int) -> Tracked | Refusal:
    """Lead-in, path and lead-out from `state`, in which the flange is where the lead-in begins, moving with the frame.

    Refused, with the place on the path: out of reach, too near a singularity, a joint beyond its range or its rates.
    """
    way, law = _way(point, state.time), Process(_trace(point))
    spline = followed(way, state, mode)
    if isinstance(spline, Refusal):
        if not isinstance(spline.facts, MotionLimit):
            return spline
        spline = replace(spline, facts=replace(spline.facts, speed_m_s=law.step.speed_m_s))
        jumps = Jumps.of(way)
        return _too_fast(way, point, mode, jumps.free(marks_of(way, jumps))) or spline
    refusal = _refused_rates(way, point, spline)
    return refusal or cut(spline, way.begin + law.met, way.begin + law.left)


def _refused_rates(way: Way, point: ControlPoint, spline: Trajectory) -> Refusal | None:
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
    return _at(way, point, fast, float(t[int(np.abs(spline.evaluate(t, kind + 1)[:, joint]).argmax())]))


def _too_fast(way: Way, point: ControlPoint, mode: int, t: FloatArray) -> Refusal | None:
    """Which joint would be too fast for the exact motion at times `t` (T,), and where on the path it would be most."""
    found, limits = way.scene.robot.inverse(way.motion(t), mode, 2), point.limits
    ratios = np.abs(np.stack([found.qd, found.qdd])) / np.stack([limits.velocity, limits.acceleration])[:, None]
    ratios[~np.isfinite(ratios)] = 0.0
    if not ratios.max() > 1.0:
        return None
    worst = np.zeros((3, ratios.shape[2]))
    worst[:2] = ratios.max(1)
    velocity, acceleration, jerk = worst.max(1).tolist()
    fast = Rates(velocity, acceleration, jerk, ok=False, ratios=worst, limits=limits)
    return _at(way, point, fast, float(t[int(ratios.max((0, 2)).argmax())]))


def _at(way: Way, point: ControlPoint, fast: Rates, when: float) -> Refusal:
    """The refusal of a joint that is too fast for a path, with where on it that is at its worst."""
    refusal = too_fast(way.scene, way.stage, way.step, fast, point.frame)
    if not isinstance(refusal.facts, MotionLimit):
        raise FaultError("a joint too fast without its facts")
    speed = _trace(point).speed_m_s
    facts = replace(refusal.facts, obstacle=Obstacle.PATH_TOO_FAST, speed_m_s=speed, **way.spot(when))
    return replace(refusal, interval=(when, when), facts=facts)


def traced(scene: Scene, point: ControlPoint, trajectory: Trajectory, begin: float, until: float) -> Traced | Refusal:
    """What is said of a path that is traced from `begin` to `until`, s; a refusal where the promise is not kept."""
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
