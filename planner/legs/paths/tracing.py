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
from assur.planner.frames.motion import Motion, Pose
from assur.planner.frames.tilted import TiltedMotion
from assur.planner.legs.control_point import ControlPoint
from assur.planner.legs.limits import Rates, rates, too_fast
from assur.planner.legs.paths.path_knots import Jumps, Way, first_beyond, fitted, looks
from assur.planner.legs.spacing import spaced
from assur.planner.legs.state import Knots, State, TimedLeg
from assur.planner.legs.tracking import SPACING_S, Tracked
from assur.planner.model.outcome import LegKind, Traced
from assur.planner.model.refusal import (
    BeyondRange,
    LawEnds,
    MotionLimit,
    Obstacle,
    PathPart,
    Quantity,
    Reason,
    Refusal,
    Spot,
    Stage,
    law_ends,
)
from assur.planner.model.scene import Scene, Trace
from assur.planner.trajectory import Trajectory

TRACED_M, SPEED_SHARE = 1e-5, 0.01
"""The promise: how far the tool point may be from its place on the path, m, and how much its speed may differ."""
RESERVE_M, RESERVE_SHARE = 1e-6, 1e-3
"""Added to what is found at these times; the checker bounds what lies between."""


@dataclass(frozen=True, eq=False)
class PathLaw:
    """The place on the path over time: it begins at `begin`, s, with the lead-in (Q6)."""

    step: Trace
    begin: float

    @property
    def lead_in(self) -> float:
        """How long the lead-in takes, s: from rest its mean speed is half of the process speed."""
        return 2.0 * self.step.lead_in_m / self.step.speed_m_s

    @property
    def met(self) -> float:
        """When the path begins, s."""
        return self.begin + self.lead_in

    @property
    def left(self) -> float:
        """When the path ends, s."""
        return self.met + self.step.dwell_s

    @property
    def end(self) -> float:
        """When the lead-out ends, s."""
        return self.left + 2.0 * self.step.lead_out_m / self.step.speed_m_s

    def evaluate(self, t: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Arc length (T,) from the path's first point, m, and its two derivatives."""
        v, length = self.step.speed_m_s, self.step.path.length
        s, sd, sdd = v * (t - self.met), np.full(len(t), v), np.zeros(len(t))
        for rows, lasts, sign, edge, place in (
            (t < self.met, self.lead_in, 1.0, self.begin, -self.step.lead_in_m),
            (t > self.left, self.end - self.left, -1.0, self.end, length + self.step.lead_out_m),
        ):
            u = np.clip(sign * (t[rows] - edge) / lasts, 0.0, 1.0)
            s[rows] = place + sign * v * lasts * u**3 * (1.0 - u / 2.0)
            sd[rows] = v * u**2 * (3.0 - 2.0 * u)
            sdd[rows] = sign * v / lasts * 6.0 * u * (1.0 - u)
        return s, sd, sdd

    def place(self, t: float) -> Spot:
        """Where the tool is at a time."""
        return spot(self.step, float(self.evaluate(np.array([t]))[0][0]))


def spot(step: Trace, s: float) -> Spot:
    """The place at arc length `s` from the path's first point, m: less than 0 on the lead-in."""
    x, y, z = step.path.curve.at(np.array([s]))[0][0].tolist()
    part: PathPart = "lead-in" if s < 0.0 else "lead-out" if s > step.path.length else "path"
    return {"path_m": s, "path_part": part, "path_at_m": (x, y, z)}


def lead_in_begin(point: ControlPoint) -> Spot:
    """Where the control point of a trace is: where its lead-in begins; nothing for one of another step."""
    return spot(point.facts, -point.facts.lead_in_m) if isinstance(point.facts, Trace) else {}


def lead(point: ControlPoint) -> float:
    """Seconds from the beginning of the lead-in to that of the path."""
    return PathLaw(_trace(point), 0.0).lead_in


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


def flange(point: ControlPoint, law: PathLaw, t: FloatArray) -> Motion:
    """Motion (T,) of the flange along the path, in the world; without jerk."""
    curve = law.step.path.curve
    s, sd, sdd = law.evaluate(t)
    begin, _, _ = curve.at(np.array([-law.step.lead_in_m]))
    r, tangent, bend = curve.at(s)
    place = point.pose.position + r - begin
    rate, pull = sd[:, None] * tangent, sdd[:, None] * tangent + sd[:, None] ** 2 * bend
    motion = point.scene.frames[point.frame].law.motion(t).carrying(place, rate, pull, point.pose.yaw)
    return motion if point.tilt is None else TiltedMotion.of(motion, np.array(point.tilt))


def trace(scene: Scene, point: ControlPoint, state: State, mode: int) -> Tracked | Refusal:
    """Lead-in, path and lead-out from `state`, in which the flange is where the lead-in begins, moving with the frame.

    Refused, with the place on the path: out of reach, too near a singularity, a joint beyond its range or its rates.
    """
    law = PathLaw(_trace(point), state.time)
    spline = _spline(scene, point, law, state, mode)
    if isinstance(spline, Refusal):
        return spline
    if point.still:
        # at rest to the bit, not to 1e-17: what follows may wait here
        table = spline.knots.copy()
        table[-1, 1 + spline.n :] = 0.0
        spline = Trajectory.of_knots(table)
    refusal = _refused_rates(scene, point, law, spline)
    if refusal is not None:
        return refusal
    knots = _with_knots(spline, (law.met, law.left))
    legs = []
    for kind, t0, t1 in (
        (LegKind.APPROACH, law.begin, law.met),
        (LegKind.FOLLOW, law.met, law.left),
        (LegKind.DEPART, law.left, law.end),
    ):
        rows = (knots[:, 0] >= t0) & (knots[:, 0] <= t1)
        legs.append(TimedLeg(kind, Knots(knots[rows])))
    return Tracked(tuple(legs), law.met, law.left)


def _spline(scene: Scene, point: ControlPoint, law: PathLaw, state: State, mode: int) -> Trajectory | Refusal:
    """The spline of the joints, with knots as close as the path asks for."""
    step = law.step
    v, curve = step.speed_m_s, step.path.curve
    edges = (-step.lead_in_m, step.path.length + step.lead_out_m)
    jumps = Jumps.of(curve.junctions, edges, lambda s: law.met + s / v)
    ends = np.array([law.begin, law.met, law.left, law.end])
    marks = spaced(np.unique(np.concatenate([ends, jumps.smooth])), SPACING_S)
    way = Way(lambda t: flange(point, law, t), law.place, Stage.TRACKING, point.step)
    made = fitted(scene, way, state, mode, marks, jumps)
    if not isinstance(made, Refusal):
        return made
    if isinstance(made.facts, MotionLimit):
        made = replace(made, facts=replace(made.facts, frame=point.frame, speed_m_s=v))
        return _too_fast(scene, point, law, mode, jumps.free(marks)) or made
    if isinstance(made.facts, LawEnds):
        valid, span = scene.frames[point.frame].law.valid, (law.begin, law.end)
        return law_ends(Stage.TRACKING, point.step, point.frame, valid, law.end, interval=span)
    return made


def _refused_rates(scene: Scene, point: ControlPoint, law: PathLaw, spline: Trajectory) -> Refusal | None:
    """Which joint breaks a limit, and where on the path it does most."""
    fast = rates(scene, Stage.TRACKING, point.step, spline, point.limits)
    if isinstance(fast, Refusal):
        joint = [each.name for each in scene.robot.joints].index(fast.joint or "")
        when = first_beyond(scene, spline, joint)
        facts = fast.facts
        if not isinstance(facts, BeyondRange):
            raise FaultError("a joint beyond its range without its facts")
        return replace(fast, interval=(when, when), facts=replace(facts, **law.place(when)))
    if fast.ok:
        return None
    kind, joint = (int(k) for k in np.unravel_index(int(fast.ratios.argmax()), fast.ratios.shape))
    t = looks(spline.time)
    when = float(t[int(np.abs(spline.evaluate(t, kind + 1)[:, joint]).argmax())])
    return _at(law, too_fast(scene, Stage.TRACKING, point.step, fast, point.frame), when)


def _too_fast(scene: Scene, point: ControlPoint, law: PathLaw, mode: int, t: FloatArray) -> Refusal | None:
    """Which joint would be too fast for the exact motion at times `t` (T,), and where on the path it would be most."""
    found, limits = scene.robot.inverse(flange(point, law, t), mode, 2), point.limits
    needed = np.abs(np.stack([found.qd, found.qdd]))
    ratios = needed / np.stack([limits.velocity, limits.acceleration])[:, None]
    ratios[~np.isfinite(ratios)] = 0.0
    kind, row, joint = (int(k) for k in np.unravel_index(int(ratios.argmax()), ratios.shape))
    if not ratios[kind, row, joint] > 1.0:
        return None
    worst = np.zeros((3, ratios.shape[2]))
    worst[:2] = ratios.max(1)
    velocity, acceleration, jerk = worst.max(1).tolist()
    fast = Rates(velocity, acceleration, jerk, ok=False, ratios=worst, limits=limits)
    return _at(law, too_fast(scene, Stage.TRACKING, point.step, fast, point.frame), float(t[row]))


def _at(law: PathLaw, refusal: Refusal, when: float) -> Refusal:
    """A refusal of a joint that is too fast for a path, with where on it that is at its worst."""
    if not isinstance(refusal.facts, MotionLimit):
        raise FaultError("a joint too fast without its facts")
    facts = replace(refusal.facts, obstacle=Obstacle.PATH_TOO_FAST, speed_m_s=law.step.speed_m_s, **law.place(when))
    return replace(refusal, interval=(when, when), facts=facts)


def _with_knots(spline: Trajectory, times: tuple[float, ...]) -> FloatArray:
    """The knots of a spline (K, 1 + 3n) with some more on it: the motion stays the same."""
    table = spline.knots
    for time in times:
        if not (table[:, 0] == time).any():
            q, qd, qdd = (spline.evaluate(np.array([time]), order)[0] for order in range(3))
            row = int(np.searchsorted(table[:, 0], time))
            table = np.insert(table, row, np.concatenate([[time], q, qd, qdd]), axis=0)
    return table


def traced(scene: Scene, point: ControlPoint, trajectory: Trajectory, begin: float, until: float) -> Traced | Refusal:
    """What is said of a path that is traced from `begin` to `until`, s; a refusal where the promise is not kept."""
    step = _trace(point)
    law = PathLaw(step, begin - lead(point))
    t = np.clip(looks(trajectory.time[(trajectory.time >= begin) & (trajectory.time <= until)]), begin, until)
    robot, none = scene.robot, np.zeros((len(t), len(scene.robot.joints)))
    q, qd, _ = trajectory.states(t)
    motion = robot.link_motion(len(robot.links) - 1, q, qd, none, none).at(scene.tool.tcp)
    frame = scene.frames[point.frame].law.motion(t)
    place, velocity = motion.p - frame.p, motion.v - frame.v
    velocity[:, 0] += frame.yaw_d * place[:, 1]
    velocity[:, 1] -= frame.yaw_d * place[:, 0]
    speed = np.linalg.norm(velocity, axis=1)
    r, _, _ = step.path.curve.at(law.evaluate(t)[0])
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
        facts=MotionLimit(obstacle=Obstacle.PROCESS_SPEED, frame=point.frame, speed_m_s=v, **law.place(worst)),
    )
