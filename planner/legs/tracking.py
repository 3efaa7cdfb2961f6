"""Tracked legs: the tool is guided along the frame of its control point - down to it, with it, and up again.

The flange's motion is the frame's own, plus a height above the point that Ruckig times; so velocity and acceleration
match by construction and approach and retreat are straight in the frame of the part (design: Cartesian legs).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from assur.planner.frames.motion import Motion
from assur.planner.legs.control_point import ControlPoint, MovingEnd
from assur.planner.legs.follower import PathTask, followed
from assur.planner.legs.limits import Rates, parts, rates, too_fast
from assur.planner.legs.state import Knots, State, TimedLeg
from assur.planner.legs.tool_motion import lift_most
from assur.planner.model.outcome import LegKind
from assur.planner.model.refusal import Obstacle, Refusal, Stage, unmoved
from assur.planner.model.scene import Scene
from assur.planner.robots.facts import Limits
from assur.planner.timing import TimingRefusal, fastest_motion
from assur.planner.trajectory import Trajectory

SAME_S = 1e-12
"""Times of a knot and of the end of a leg that differ by less are the same: rounding."""
ROUNDS = 5
"""Rounds of slowing down the way down and up until all joints keep their limits."""
KEPT = 256
"""Profiles of heights that are kept: the tasks of a cell approach their points from the same heights."""
WITHOUT_LIFT = (0.5, 5.0, 250.0)
"""First guess of velocity, acceleration and jerk of a way down, m/s.., for a robot that has no vertical joint."""


@dataclass(frozen=True, eq=False)
class TrackingLegs:
    """The tracking legs of one step, and the span [begin, end] in which the tool is at the point itself."""

    legs: tuple[TimedLeg, ...]
    begin: float
    end: float


def _heights(down: Trajectory | None, left: float, up: Trajectory | None) -> Trajectory:
    """Height above the point, m, over the time since the way down began: down, at the point until `left`, s, and up.

    Each part may be missing, but not all of them.
    """
    first = np.zeros((1, 4)) if down is None else down.knots
    last = np.zeros((1, 4)) if up is None else up.knots.copy()
    last[:, 0] += left
    return Trajectory.of_knots(np.concatenate([first, last if left > first[-1, 0] else last[1:]]))


@dataclass(frozen=True, eq=False)
class _Above:
    """The course of the flange along the vertical of a point that may move; the phase is the height above it, m."""

    point: ControlPoint

    def motion(self, t: FloatArray, s: FloatArray, sd: FloatArray, sdd: FloatArray) -> Motion:
        """Motion (T,) of the flange in the world at times t (T,) at these heights (T,)."""
        table = self.point.flange(t).table.copy()
        table[:, :3, 2] += np.stack([s, sd, sdd], 1)
        return Motion(table)


def lead_time(scene: Scene, point: ControlPoint, effort: float) -> float | Refusal:
    """Seconds from the beginning of the way down to the point itself."""
    profile = _down(scene, point, effort)
    if isinstance(profile, Refusal):
        return profile
    return profile.duration if profile else 0.0


def track(
    scene: Scene, point: ControlPoint, state: State, mode: int, effort: float, leaves: MovingEnd | None = None
) -> TrackingLegs | Refusal:
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
        met = 0.0 if down is None else down.duration
        left = met + point.dwell
        if down is None and up is None and not point.dwell > 0.0:
            touch = Knots.made(np.array([state.time]), state.q[None], state.qd[None], state.qdd[None])
            return TrackingLegs((TimedLeg(LegKind.FOLLOW, touch),), state.time, state.time)
        heights, met, left = _heights(down, left, up), state.time + met, state.time + left
        way = PathTask(scene, Stage.TRACKING, point.step, _Above(point), heights, state.time, point.frame)
        spline = followed(way, state, mode, (met, left) if point.still else None)
        if isinstance(spline, Refusal):
            return spline
        fast = _rates(scene, point, spline, left)
        if isinstance(fast, Refusal):
            return fast
        if fast.ok:
            return cut(spline, met, left)
        refusal = too_fast(scene, Stage.TRACKING, point.step, fast.ratios, fast.limits, point.frame)
        if point.entry is not None or leaves is not None:
            break  # a moving end has one speed: stops are other candidates
        effort *= min(0.8, 0.95 / fast.ratio**2)
    return refusal


def _down(scene: Scene, point: ControlPoint, effort: float) -> Trajectory | Refusal | None:
    """The height profile of the approach."""
    if point.entry is not None:
        return point.entry.profile
    return _way(scene, point, point.approach, 0.0, effort, point.limits)


def _rates(scene: Scene, point: ControlPoint, spline: Trajectory, left: float) -> Rates | Refusal:
    """How fast the legs are where they are fastest for their limits, which change with the load when the point is left,
    s."""
    worst: Rates | None = None
    for part, limits in parts(spline, ((left, point.limits), (spline.end, point.limits_after))):
        fast = rates(scene, Stage.TRACKING, point.step, part, limits)
        if isinstance(fast, Refusal):
            return fast
        if worst is None or (not fast.ok, fast.ratio) > (not worst.ok, worst.ratio):
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
    a = min(a, lift_most(scene, carried=point.carries(up=high == 0.0)))
    found = _lift_profile(high, low, v * effort**0.5, a * effort, j * effort**1.5)
    if isinstance(found, TimingRefusal):
        return unmoved(Stage.TRACKING, point.step, Obstacle.NO_PROFILE)
    return found


@lru_cache(maxsize=KEPT)
def _lift_profile(high: float, low: float, v: float, a: float, j: float) -> Trajectory | TimingRefusal:
    """The fastest motion from rest at one height, m, to rest at another one."""
    return fastest_motion(([high], [0.0], [0.0]), ([low], [0.0], [0.0]), ([v], [a], [j]))


def cut(spline: Trajectory, met: float, left: float) -> TrackingLegs:
    """A motion as the legs before a point or path is met, s, until it is left, and behind that."""
    table = spline.knots
    for time in (met, left):
        if not (np.abs(table[:, 0] - time) <= SAME_S).any():
            # one knot more on the same motion
            state = [spline.evaluate(np.array([time]), order)[0] for order in range(3)]
            row = int(np.searchsorted(table[:, 0], time))
            table = np.insert(table, row, np.concatenate([[time], *state]), axis=0)
    legs = []
    for kind, t0, t1 in (
        (LegKind.APPROACH, spline.start, met),
        (LegKind.FOLLOW, met, left),
        (LegKind.DEPART, left, spline.end),
    ):
        # a follow of no length still says when the part is taken or let go
        if t1 > t0 + SAME_S or kind is LegKind.FOLLOW:
            rows = (table[:, 0] >= t0 - SAME_S) & (table[:, 0] <= t1 + SAME_S)
            legs.append(TimedLeg(kind, Knots(table[rows])))
    return TrackingLegs(tuple(legs), met, left)
