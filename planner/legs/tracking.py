"""Tracked legs: the tool is guided along the frame of its control point - down to it, with it, and up again.

The flange's motion is the frame's own, plus a height above the point that Ruckig times; so velocity and acceleration
match by construction and approach and retreat are straight in the frame of the part (design: Cartesian legs).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from assur.planner.legs.control_point import ControlPoint
from assur.planner.legs.limits import Rates, parts, rates, too_fast
from assur.planner.legs.moving_end import MovingEnd
from assur.planner.legs.singular import nearest
from assur.planner.legs.spacing import spaced
from assur.planner.legs.state import Knots, State, TimedLeg
from assur.planner.legs.tilt import PATH_RAD, tilt_off
from assur.planner.legs.tool_motion import lift_most
from assur.planner.model.deadline import look
from assur.planner.model.outcome import LegKind
from assur.planner.model.refusal import (
    FrameName,
    MotionLimit,
    Obstacle,
    Reason,
    Refusal,
    Singular,
    Stage,
    law_ends,
    out_of_reach,
    unmoved,
)
from assur.planner.model.scene import Pick, Place, Scene
from assur.planner.robots.facts import Code, Limits
from assur.planner.robots.robot import Robot
from assur.planner.timing import TimingRefusal, time_joints
from assur.planner.trajectory import Trajectory

SPACING_S = 0.02
"""Knots of a tracking leg are at most this far apart to begin with, s."""
PATH_M = 1e-6
"""Between knots the flange leaves its path by less than this, m; the promise is 10 µm."""
LONG_DWELL_S = 1.0
"""A dwell at a point that stands still has no knots within if it is longer, s: nothing moves there."""
REFINEMENTS = 6
"""Halvings of the spacing after which a path is given up: it is not smooth enough to be followed."""
ROUNDS = 5
"""Rounds of slowing down the way down and up until all joints keep their limits."""
WITHOUT_LIFT = (0.5, 5.0, 250.0)
"""First guess of velocity, acceleration and jerk of a way down, m/s.., for a robot that has no vertical joint."""


@dataclass(frozen=True, eq=False)
class Tracked:
    """The tracking legs of one step, and the span [begin, end] in which the tool is at the point itself."""

    legs: tuple[TimedLeg, ...]
    begin: float
    end: float


@dataclass(frozen=True, slots=True)
class _Heights:
    """Height above the point over all of them: down, at the point, up; each part may be missing."""

    begin: float
    down: Trajectory | None
    dwell: float
    up: Trajectory | None
    stops: bool = True
    """Whether the tool stops, in the frame of the point, where the way up ends."""

    @property
    def met(self) -> float:
        return self.begin + (self.down.duration if self.down else 0.0)

    @property
    def left(self) -> float:
        return self.met + self.dwell

    @property
    def end(self) -> float:
        return self.left + (self.up.duration if self.up else 0.0)

    def switches(self) -> FloatArray:
        found = [np.array([self.begin, self.met, self.left, self.end])]
        if self.down:
            found.append(self.begin + self.down.time)
        if self.up:
            found.append(self.left + self.up.time)
        return np.concatenate(found)

    def evaluate(self, t: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Height, its rate and acceleration at t (T,)."""
        heights = np.zeros((3, len(t)))
        if self.down:
            rows = t < self.met
            clock = np.clip(t[rows] - self.begin, 0.0, self.down.duration)
            for height, x in zip(heights, self.down.states(clock), strict=True):
                height[rows] = x[:, 0]
        if self.up:
            rows = t > self.left
            clock = np.clip(t[rows] - self.left, 0.0, self.up.duration)
            for height, x in zip(heights, self.up.states(clock), strict=True):
                height[rows] = x[:, 0]
        return heights[0], heights[1], heights[2]


def lead_time(scene: Scene, point: ControlPoint, effort: float) -> float | Refusal:
    """Seconds from the beginning of the way down to the point itself."""
    profile = _down(scene, point, effort)
    if isinstance(profile, Refusal):
        return profile
    return profile.duration if profile else 0.0


def track(
    scene: Scene, point: ControlPoint, state: State, mode: int, effort: float, leaves: MovingEnd | None = None
) -> Tracked | Refusal:
    """The tracking legs that begin in `state`, which must be that of the flange `point.approach` above the point.

    `effort`: share of the limits that heights use, between stops. `leaves`: how the tool goes on behind the depart.
    """
    for _ in range(ROUNDS):
        down = _down(scene, point, effort)
        up = leaves.profile if leaves is not None else _way(scene, point, 0.0, point.depart, effort, point.limits_after)
        if isinstance(down, Refusal):
            return down
        if isinstance(up, Refusal):
            return up
        heights = _Heights(state.time, down, point.dwell, up, stops=leaves is None)
        if not heights.end > heights.begin:
            touch = Knots.made(np.array([state.time]), state.q[None], state.qd[None], state.qdd[None])
            return Tracked((TimedLeg(LegKind.FOLLOW, touch),), state.time, state.time)
        spline = _spline(scene, point, state, mode, heights)
        if isinstance(spline, Refusal):
            return spline
        fast = _rates(scene, point, spline, heights)
        if isinstance(fast, Refusal):
            return fast
        if fast.ok:
            return _cut(heights, Knots.of(spline))
        refusal = too_fast(scene, Stage.TRACKING, point.step, fast, point.frame)
        if point.entry is not None or leaves is not None:
            break  # a moving end has one speed: stops are other candidates
        effort *= min(0.8, 0.95 / fast.squeeze)
    return refusal


def _down(scene: Scene, point: ControlPoint, effort: float) -> Trajectory | Refusal | None:
    """The height profile of the approach."""
    if point.entry is not None:
        return point.entry.profile
    return _way(scene, point, point.approach, 0.0, effort, point.limits)


def _rates(scene: Scene, point: ControlPoint, spline: Trajectory, heights: _Heights) -> Rates | Refusal:
    """How fast the legs are where they are fastest for their limits, which change with the load at the point."""
    worst: Rates | None = None
    for part, limits in parts(spline, ((heights.left, point.limits), (heights.end, point.limits_after))):
        fast = rates(scene, Stage.TRACKING, point.step, part, limits)
        if isinstance(fast, Refusal):
            return fast
        if worst is None or (not fast.ok, fast.squeeze) > (not worst.ok, worst.squeeze):
            worst = fast
    if worst is None:
        raise FaultError("tracking legs of no length")
    return worst


def _way(
    scene: Scene, point: ControlPoint, high: float, low: float, effort: float, limits: Limits
) -> Trajectory | Refusal | None:
    """The height profile from `high` to `low` above the point at this share of `limits`; None: there is no way."""
    if high == low:
        return None
    lift = scene.robot.lift
    v, a, j = WITHOUT_LIFT
    if lift is not None:
        v, a, j = float(limits.velocity[lift]), float(limits.acceleration[lift]), float(limits.jerk[lift])
    # a part is in the gripper on the way down to where it is placed, and on the way up from where it is picked
    a = min(a, lift_most(scene, carried=isinstance(point.facts, Place if low == 0.0 else Pick)))
    none = np.zeros(1)
    found = time_joints(
        np.array([high]),
        none,
        none,
        np.array([low]),
        none,
        none,
        np.array([v * effort**0.5]),
        np.array([a * effort]),
        np.array([j * effort**1.5]),
    )
    if isinstance(found, TimingRefusal):
        return unmoved(Stage.TRACKING, point.step, Obstacle.NO_PROFILE)
    return found


def _spline(scene: Scene, point: ControlPoint, state: State, mode: int, heights: _Heights) -> Trajectory | Refusal:
    """The spline through knots at all switches and close enough in between, the first being `state` itself."""
    robot, spacing = scene.robot, SPACING_S
    for _ in range(REFINEMENTS):
        look()
        t = _filled(heights.switches(), spacing, heights if point.still and heights.dwell > LONG_DWELL_S else None)
        found = joint_states(scene, point, state, mode, heights, t)
        if isinstance(found, Refusal):
            return found
        middle, trajectory = (t[1:] + t[:-1]) / 2, Trajectory.of_knots(found.table)
        held = point.tilt is None or tilt_off(robot, trajectory.evaluate(middle), point.flange(middle)) <= PATH_RAD
        if held and _off_path(robot, trajectory, point, heights, middle) <= PATH_M:
            return trajectory
        spacing /= 2
    return Refusal(
        stage=Stage.TRACKING,
        reason=Reason.MOTION_LIMIT,
        step=point.step,
        subject=FrameName(point.frame),
        facts=MotionLimit(obstacle=Obstacle.NOT_SMOOTH, frame=point.frame),
    )


def joint_states(
    scene: Scene, point: ControlPoint, state: State, mode: int, heights: _Heights, t: FloatArray
) -> Knots | Refusal:
    """Joint knots (T, n) of the flange at the heights above the moving point at times t, turned on from `state`."""
    h, hd, hdd = heights.evaluate(t)
    motion = point.flange(t)
    p, v, a = motion.p.copy(), motion.v.copy(), motion.a.copy()
    p[:, 2] += h
    v[:, 2] += hd
    a[:, 2] += hdd
    found = scene.robot.inverse(replace(motion, p=p, v=v, a=a), mode, 2)
    span = (float(t[0]), float(t[-1]))
    if not np.isfinite(p).all():
        law = scene.frames[point.frame].law
        return law_ends(Stage.TRACKING, point.step, point.frame, law.valid, span[1], interval=span)
    if not (found.code == Code.ASSEMBLED).all():
        bad = found.code[found.code != Code.ASSEMBLED]
        if (bad == Code.OUT_OF_REACH).any():
            return out_of_reach(Stage.TRACKING, point.step, interval=span)
        if not (bad == Code.PARALLEL).any():
            return Refusal(
                stage=Stage.TRACKING, reason=Reason.NEAR_SINGULARITY, step=point.step, interval=span, facts=Singular()
            )
    asked = scene.options.singularity_margin
    if not ((found.code == Code.ASSEMBLED) & found.keeps(asked)).all():
        near = nearest(scene.robot, found, asked, np.arange(len(t)), best=False)
        return near.refusal(Stage.TRACKING, point.step, span)
    q = continued(scene.robot, found.q, state.q)
    q[0], qd, qdd = state.q, found.qd.copy(), found.qdd.copy()
    qd[0], qdd[0] = state.qd, state.qdd
    if point.still:
        # at rest to the bit, not to 1e-17: what follows may wait here
        rest = ((t >= heights.end) & heights.stops) | ((t >= heights.met) & (t <= heights.left))
        qd[rest] = qdd[rest] = 0.0
    return Knots.made(t, q, qd, qdd)


def continued(robot: Robot, q: FloatArray, first: FloatArray) -> FloatArray:
    """q (T, n) with full turns added to revolute joints so that it begins near `first` and never jumps."""
    result = q.copy()
    for i, joint in enumerate(robot.joints):
        if joint.kind == "revolute":
            column = np.unwrap(q[:, i])
            result[:, i] = column + 2 * np.pi * np.round((first[i] - column[0]) / (2 * np.pi))
    return result


def _filled(switches: FloatArray, spacing: float, rests: _Heights | None = None) -> FloatArray:
    """Switches, merged where they nearly coincide, and enough times in between; none between the two at which the arm
    begins and ends to stand at a point that stands still (`rests`)."""
    t = np.unique(switches)
    keep = np.concatenate([[True], np.diff(t) > 1e-5])
    last = t[-1]
    t = t[keep]
    t[-1] = last
    if rests is None:
        return spaced(t, spacing)
    middle = (rests.met + rests.left) / 2
    parts = (part if len(part) == 1 else spaced(part, spacing) for part in (t[t <= middle], t[t > middle]))
    return np.concatenate(list(parts))


def _off_path(robot: Robot, trajectory: Trajectory, point: ControlPoint, heights: _Heights, t: FloatArray) -> float:
    """How far, m, the flange is from its path at times t at most."""
    position, _ = robot.forward(trajectory.evaluate(t))
    path = point.flange(t).p.copy()
    path[:, 2] += heights.evaluate(t)[0]
    return float(np.sqrt(((position - path) ** 2).sum(-1)).max())


def _cut(heights: _Heights, knots: Knots) -> Tracked:
    """The motion as legs."""
    marks = [
        (LegKind.APPROACH, heights.begin, heights.met),
        (LegKind.FOLLOW, heights.met, heights.left),
        (LegKind.DEPART, heights.left, heights.end),
    ]
    legs = []
    for kind, t0, t1 in marks:
        # a follow of no length still says when the part is taken or let go
        if t1 > t0 or kind is LegKind.FOLLOW:
            rows = (knots.time >= t0 - 1e-12) & (knots.time <= t1 + 1e-12)
            legs.append(TimedLeg(kind, Knots(knots.table[rows])))
    return Tracked(tuple(legs), heights.met, heights.left)
