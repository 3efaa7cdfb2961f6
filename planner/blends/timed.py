"""Joint moves with parabolic blends, from rest through poses to rest: which poses, when, and how long it takes.

A control point that moves is met where it is when its pose is due, and when that is depends on where it is: times are
put in, poses follow, the law gives times, until they are the same. The arm is faster than what it meets, so they are
soon; where they are not, there is no such move.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.blends.durations import TooShort, fastest, with_acceleration_time
from assur.planner.blends.law import ParabolicBlend
from assur.planner.legs.branch import Branch
from assur.planner.legs.control_point import ControlPoint
from assur.planner.model.attachments import at_start
from assur.planner.model.joint_range import beyond
from assur.planner.model.outcome import Course, Route
from assur.planner.model.refusal import (
    AccelerationTime,
    JointName,
    Obstacle,
    Quantity,
    Reason,
    Refusal,
    Stage,
    of_joint,
    out_of_reach,
    unmoved,
    window_missed,
)
from assur.planner.model.scene import Scene
from assur.planner.model.window_missed import Miss, WindowMissed
from assur.planner.robots.facts import Code

AGREES_S = 1e-12
"""Times that are put in and that come out agree to this, s: at 10 m/s a place is then known to 10 pm."""
ROUNDS = 60
"""Rounds after which a point is too fast to be met: a frame at half the arm's speed takes 40."""
SEARCHED = 3
"""Rounds in which proportions of the segments are looked for; later ones keep them, for a search may jump."""
REACHED_S = 1e-9
"""A point comes into reach at this time of its grid or that much before it, s: at 10 m/s it has gone 10 nm by then."""
WINDOW_S = 1e-12
"""A window is kept up to this, s, as by other legs."""


@dataclass(frozen=True, eq=False)
class Station:
    """A control point that is blended past, or stopped at, in one branch of its joint positions."""

    point: ControlPoint
    branch: Branch

    def at(self, scene: Scene, t: float) -> FloatArray | Refusal:
        """Joints (n,) of the pose that is due at `t`."""
        if self.branch.still:
            return np.asarray(self.branch.q[0])
        robot, step = scene.robot, self.point.step
        found = robot.inverse(self.point.flange(np.array([t])).at_rest(), self.branch.mode, 0)
        if found.code[0] != Code.ASSEMBLED:
            return out_of_reach(Stage.TIMING, step, interval=(t, t))
        # the turns of the branch: those of the meeting that is nearest
        row = int(np.argmin(np.abs(self.branch.time - t)))
        turns = robot.revolute * np.round((self.branch.q[row] - found.q[0]) / (2 * np.pi))
        q = found.q[0] + 2 * np.pi * turns
        if not robot.within(q[None])[0]:
            joint = int(np.maximum(robot.limits.lower - q, q - robot.limits.upper).argmax())
            return Refusal(
                stage=Stage.TIMING,
                reason=Reason.JOINT_LIMIT,
                step=step,
                subject=JointName(robot.joints[joint].name),
                interval=(t, t),
                facts=beyond(scene, joint, float(q[joint])),
            )
        return np.asarray(q)

    def from_(self, t: float) -> float:
        """The first time from `t` on at which the point can be met in this branch; inf: it cannot any more."""
        if self.branch.still:
            return t
        time, numbers = self.branch.time, self.branch.numbers
        k = int(np.clip(np.searchsorted(time, t, side="right") - 1, 0, len(time) - 1))
        behind = min(k + 1, len(time) - 1)
        if time[0] <= t <= time[-1] and numbers[behind] - numbers[k] <= 1:
            return t
        later = np.flatnonzero(time >= t - REACHED_S)
        return max(t, float(time[later[0]])) if len(later) else np.inf


@dataclass(frozen=True, eq=False)
class BlendShape:
    """A way through stations: wait first; `frees[k]` (each (n,)) are more poses on the way to station k; `effort`:
    share of the limits of acceleration (velocity by its root) that is used, where no acceleration time is given;
    `pace`: share of the speeds that is used, given time or not, so that a held part is not accelerated too hard."""

    stations: tuple[Station, ...]
    frees: tuple[tuple[FloatArray, ...], ...]
    wait: float = 0.0
    effort: float = 1.0
    pace: float = 1.0

    @property
    def route(self) -> Route:
        return Route(Course.BLENDS, sum(map(len, self.frees)))


@dataclass(frozen=True, eq=False)
class Blended:
    """The law of a way that begins at `begin`, and for each station the number of its pose and its time."""

    begin: float
    law: ParabolicBlend
    poses: tuple[int, ...]
    times: tuple[float, ...]


def blended(scene: Scene, step: int, time: float, q: FloatArray, shape: BlendShape) -> Blended | Refusal:
    """The move from rest in q (n,) at `time`, through the stations, to rest in the last; windows wait for an early arm.

    `step`: the first of the steps, for refusals.
    """
    begin = time + shape.wait
    for _ in range(len(shape.stations) + 2):
        found = _timed(scene, step, begin, q, shape)
        if isinstance(found, Refusal):
            return found
        early = 0.0
        for station, t in zip(shape.stations, found.times, strict=True):
            missed = _window(station.point, t)
            if isinstance(missed, Refusal):
                return missed
            later = station.from_(t) - t
            early = max(early, missed, later if later > REACHED_S else 0.0)
        if not early > 0:
            return found
        begin += early
    return window_missed(Stage.WINDOW, step, WindowMissed(miss=Miss.NO_COMMON_BEGIN))


def _window(point: ControlPoint, t: float) -> float | Refusal:
    """How much too early `t` is for the point's window, s; a refusal where all of it is over."""
    spans = point.intervals
    if any(low - WINDOW_S <= t <= high + WINDOW_S for low, high in spans):
        return 0.0
    later = [low - t for low, _ in spans if low > t]
    if later:
        return min(later)
    late = t - max((high for _, high in spans), default=np.nan)
    span = spans[-1] if spans else None
    facts = WindowMissed(miss=Miss.CLOSED_ON_ARRIVAL)
    return window_missed(Stage.WINDOW, point.step, facts, amount=Quantity.of(float(late), "s"), interval=span)


def _timed(scene: Scene, step: int, begin: float, q: FloatArray, shape: BlendShape) -> Blended | Refusal:
    """The move that begins at `begin`."""
    numbers = tuple(int(k) for k in np.cumsum([len(free) + 1 for free in shape.frees]))
    times, proportions = (begin,) * len(numbers), None
    for attempt in range(ROUNDS):
        poses = [q]
        for station, free, t in zip(shape.stations, shape.frees, times, strict=True):
            # where it can be met first, if that is not yet so: the motion will then have to begin later
            soonest = station.from_(t)
            if not np.isfinite(soonest):
                missed = _window(station.point, t)
                if isinstance(missed, Refusal):
                    return missed
                return out_of_reach(Stage.TIMING, station.point.step, interval=(t, t))
            at = station.at(scene, soonest)
            if isinstance(at, Refusal):
                return at
            poses += [*free, at]
        law = _law(scene, step, np.array(poses), shape, proportions)
        if isinstance(law, Refusal):
            return law
        passed = [begin + float(law.passed[k]) for k in numbers]
        passed[-1] = float(law.duration) + begin
        still = all(station.branch.still for station in shape.stations)
        if still or max(abs(a - b) for a, b in zip(times, passed, strict=True)) <= AGREES_S:
            return Blended(begin, law, numbers, tuple(passed))
        times = tuple(passed)
        if attempt >= SEARCHED:
            proportions = law.segments
    return unmoved(Stage.TIMING, step, Obstacle.POINT_TOO_FAST)


def _law(
    scene: Scene, step: int, poses: FloatArray, shape: BlendShape, proportions: FloatArray | None
) -> ParabolicBlend | Refusal:
    limits, given = at_start(scene).limits(scene), scene.options.acceleration_time_s
    velocity, share = limits.velocity * shape.pace, shape.effort * shape.pace**2
    if given is None:
        return fastest(poses, velocity * shape.effort**0.5, limits.acceleration * share, proportions)
    made = with_acceleration_time(poses, velocity, limits.acceleration, given)
    if not isinstance(made, TooShort):
        return made
    joint = scene.robot.joints[made.joint]
    return Refusal(
        stage=Stage.TIMING,
        reason=Reason.MOTION_LIMIT,
        step=step,
        subject=JointName(joint.name),
        amount=of_joint(joint.kind, made.needed - made.limit, 2),
        facts=AccelerationTime(given_s=given, needed=made.needed, limit=made.limit, enough_s=made.enough),
    )
