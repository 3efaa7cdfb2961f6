"""A continuation by parabolic blends: a run through vias to the next stop, timed, with its legs and arrivals.

A control point that moves is met where it is when its pose is due, and when that is depends on where it is: times are
put in, poses follow, the law gives times, until they are the same. The arm is faster than what it meets, so they are
soon; where they are not, there is no such run.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.blends.law import ParabolicBlend, fastest, with_acceleration_time
from assur.planner.legs.control_point import WINDOW_S
from assur.planner.legs.forbidden_yaw import turns_into
from assur.planner.legs.limits import beyond_limits
from assur.planner.legs.state import Knots
from assur.planner.model.assembly_mode import leaves_assembly
from assur.planner.model.outcome import Arrival, Course, Leg, LegKind, Missed, Route
from assur.planner.model.phases import cleared, phases
from assur.planner.model.refusal import (
    Carrying,
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
from assur.planner.search.extension import arrival, too_hard
from assur.planner.search.meeting_options import ends_too_late
from assur.planner.search.partial_plan import Candidate, Extension, Option, PartialPlan
from assur.planner.trajectory import Trajectory
from assur.planner.trajectory.trajectory import joined

AGREES_S = 1e-12
"""Times that are put in and that come out agree to this, s: at 10 m/s a place is then known to 10 pm."""
ROUNDS = 60
"""Rounds after which a point is too fast to be met: a frame at half the arm's speed takes 40."""
SEARCHED = 3
"""Rounds in which proportions of the segments are searched; later ones keep them, for a search may jump."""
REACHED_S = 1e-9
"""A point comes into reach at this time of its grid or that much before it, s: at 10 m/s it has gone 10 nm by then."""
SLOWED, SLOWER = 8, 0.97
"""Times that a run which accelerates the held part too hard is timed again, with this share of what would be enough."""


@dataclass(frozen=True, eq=False)
class Run(Candidate):
    """A run through control points, each in one branch (`stations`), to the last one; `frees[k]` (each (n,)): more
    poses on the way to station k. Of its shape the wait counts, and the effort where no acceleration time is given."""

    stations: tuple[Option, ...] = ()
    frees: tuple[tuple[FloatArray, ...], ...] = ()

    @property
    def numbers(self) -> list[int]:
        """The number of each station's pose among all poses; that of the start is 0."""
        return [int(k) for k in np.cumsum([len(free) + 1 for free in self.frees])]

    def times(self, begin: float, law: ParabolicBlend) -> list[float]:
        """When the pose of each station is due, s, if the run begins at `begin`."""
        return [*(begin + float(law.passed[k]) for k in self.numbers[:-1]), float(law.duration) + begin]


def extended_by_run(scene: Scene, partial: PartialPlan, run: Run) -> Extension | Refusal:
    """The extension by a run, within all limits but that of the jerk.

    A run that accelerates a held part too hard is timed again, slower as a whole.
    """
    found = slower = _extended(scene, partial, run, 1.0)
    pace = 1.0
    for _ in range(SLOWED):
        if not (isinstance(slower, Refusal) and isinstance(slower.facts, Carrying)):
            break
        # the same way at a share of the speed has its square of the acceleration, unless the blends have a given time
        share = SLOWER * slower.facts.limit / slower.facts.acceleration
        pace *= share if scene.options.acceleration_time_s is not None else share**0.5
        slower = _extended(scene, partial, run, pace)
    # where no slower motion will do, the limit is why: at its own pace there was a motion
    return found if isinstance(slower, Refusal) else slower


def _extended(scene: Scene, partial: PartialPlan, run: Run, pace: float) -> Extension | Refusal:
    found = _timed(scene, partial, run, pace)
    if isinstance(found, Refusal):
        return found
    begin, law = found
    knots = Knots(law.knots(begin))
    if begin > partial.state.time:
        knots = Knots.standing(partial.state, begin).then(knots)
    trajectory = Trajectory.of_knots(knots.table, jumps=True)
    refused = (
        ends_too_late(scene, partial.step, knots.end)
        or beyond_limits(scene, partial.step, trajectory, partial.attached.limits(scene))
        or leaves_assembly(scene.robot, partial.step, trajectory)
        or turns_into(scene, partial.step, trajectory)
    )
    if refused is not None:
        return refused
    times = run.times(begin, law)
    arrivals = partial.arrivals + _arrivals(scene, partial, run, law, times, trajectory)
    attached, handled = cleared(scene, partial.attached, partial.handled, arrivals, knots.end)
    legs = _legs(partial, run, [begin, *times[:-1], knots.end])
    after = replace(
        partial,
        step=partial.step + len(run.stations),
        state=knots.last,
        mode=run.branch.mode,
        attached=attached,
        handled=handled,
        legs=partial.legs + legs,
        arrivals=arrivals,
        knots=knots if partial.knots is None else Knots(joined(partial.knots.table, knots.table)),
    )
    ours = phases(scene, after.legs, after.arrivals)[len(partial.legs) :]
    if after.step < len(scene.task):
        ours = ours[: len(legs)]  # the arm does not stand still here
    heavy = too_hard(scene, partial.step, trajectory, tuple(ours))
    return Extension(partial, run, trajectory, ours, after) if heavy is None else heavy


def _legs(partial: PartialPlan, run: Run, times: list[float]) -> tuple[Leg, ...]:
    """A leg to each station, between these times; before the first a wait, if there is one."""
    legs, since = list[Leg](), partial.state.time
    if times[0] > since:
        # a wait that was sampled is for bodies; the rest is for points that are not yet there
        course = Course.FOR_BODIES if run.shape.wait > 0 else Course.FOR_POINT
        legs.append(Leg(LegKind.WAIT, partial.step, since, times[0], Route(course)))
    for k, (begin, end) in enumerate(pairwise(times)):
        route = Route(Course.ROUNDED, len(run.frees[k]), after_wait=k == 0 and begin > since)
        legs.append(Leg(LegKind.MOVE, partial.step + k, begin, end, route))
    return tuple(legs)


def _arrivals(
    scene: Scene, partial: PartialPlan, run: Run, law: ParabolicBlend, times: list[float], trajectory: Trajectory
) -> tuple[Arrival, ...]:
    made = []
    for station, number, time in zip(run.stations, run.numbers, times, strict=True):
        point, t = station.meeting.point, min(time, trajectory.end)
        there = arrival(scene, point, partial, trajectory, t, t)
        if point.via:
            away = there.pose.position - point.flange(np.array(t)).at(scene.tool.tcp).p
            missed = Missed(tuple(law.missed_by[number].tolist()), float(np.sqrt((away**2).sum())))
            there = replace(there, missed_by=missed)
        made.append(there)
    return tuple(made)


def _timed(scene: Scene, partial: PartialPlan, run: Run, pace: float) -> tuple[float, ParabolicBlend] | Refusal:
    """When the run begins, s, and its law, at this share of the joints' speeds. An arm that would come too early for a
    point waits before it begins."""
    begin = partial.state.time + run.shape.wait
    for _ in range(len(run.stations) + 2):
        law = _met(scene, partial, run, begin, pace)
        if isinstance(law, Refusal):
            return law
        early = 0.0
        for station, t in zip(run.stations, run.times(begin, law), strict=True):
            soonest = _soonest(station, t)
            if isinstance(soonest, Refusal):
                return soonest
            early = max(early, soonest - t)
        if not early > REACHED_S:
            return begin, law
        begin += early
    return window_missed(Stage.WINDOW, partial.step, WindowMissed(miss=Miss.NO_COMMON_BEGIN))


def _met(scene: Scene, partial: PartialPlan, run: Run, begin: float, pace: float) -> ParabolicBlend | Refusal:
    """The law that begins at `begin` and meets each station when its pose is due."""
    times, proportions = [begin] * len(run.stations), None
    for attempt in range(ROUNDS):
        poses = [partial.state.q]
        for station, free, t in zip(run.stations, run.frees, times, strict=True):
            at = _pose(scene, station, t)
            if isinstance(at, Refusal):
                return at
            poses += [*free, at]
        law = _law(scene, partial, np.array(poses), run.shape.effort, pace, proportions)
        if isinstance(law, Refusal):
            return law
        before, times = times, run.times(begin, law)
        still = all(station.branch.still for station in run.stations)
        if still or max(abs(a - b) for a, b in zip(before, times, strict=True)) <= AGREES_S:
            return law
        if attempt >= SEARCHED:
            proportions = law.segments
    return unmoved(Stage.TIMING, partial.step, Obstacle.POINT_TOO_FAST)


def _soonest(station: Option, t: float) -> float | Refusal:
    """The first time from `t` on at which the point's window is open and it can be met in this branch."""
    branch, point = station.branch, station.meeting.point
    spans = [span for span in point.intervals if t <= span[1] + WINDOW_S]
    if not spans:
        late = Quantity.of(t - max((high for _, high in point.intervals), default=math.nan), "s")
        facts, span = WindowMissed(miss=Miss.CLOSED_ON_ARRIVAL), point.intervals[-1] if point.intervals else None
        return window_missed(Stage.WINDOW, point.step, facts, amount=late, interval=span)
    opens = min(low for low, _ in spans)
    t = t if opens - WINDOW_S <= t else opens
    if branch.still:
        return t
    time, numbers = branch.time, branch.numbers
    k = int(np.clip(np.searchsorted(time, t, side="right") - 1, 0, len(time) - 1))
    if time[0] <= t <= time[-1] and numbers[min(k + 1, len(time) - 1)] - numbers[k] <= 1:
        return t
    later = time[time >= t - REACHED_S]
    if not len(later):
        return out_of_reach(Stage.TIMING, point.step, interval=(t, t))
    return max(t, float(later[0]))


def _pose(scene: Scene, station: Option, t: float) -> FloatArray | Refusal:
    """Joints (n,) at `t`, or when the point can be met first after it: then the run will have to begin later."""
    branch, point, robot = station.branch, station.meeting.point, scene.robot
    if branch.still:
        return np.asarray(branch.q[0])
    soonest = _soonest(station, t)
    if isinstance(soonest, Refusal):
        return soonest
    found = robot.inverse(point.flange(np.array([soonest])).at_rest(), branch.mode, 0)
    # the turns of the branch: those of the meeting that is nearest
    row = int(np.argmin(np.abs(branch.time - soonest)))
    q = found.q[0] + 2 * np.pi * robot.revolute * np.round((branch.q[row] - found.q[0]) / (2 * np.pi))
    if found.code[0] == Code.ASSEMBLED and robot.within(q[None])[0]:
        return np.asarray(q)
    return out_of_reach(Stage.TIMING, point.step, interval=(soonest, soonest))


def _law(
    scene: Scene, partial: PartialPlan, poses: FloatArray, effort: float, pace: float, proportions: FloatArray | None
) -> ParabolicBlend | Refusal:
    limits, given = partial.attached.limits(scene), scene.options.acceleration_time_s
    velocity = limits.velocity * pace
    if given is None:
        return fastest(poses, velocity * effort**0.5, limits.acceleration * (effort * pace**2), proportions)
    made = with_acceleration_time(poses, velocity, limits.acceleration, given)
    if isinstance(made, ParabolicBlend):
        return made
    joint, facts = scene.robot.joints[made[0]], made[1]
    return Refusal(
        stage=Stage.TIMING,
        reason=Reason.MOTION_LIMIT,
        step=partial.step,
        subject=JointName(joint.name),
        amount=of_joint(joint.kind, facts.needed - facts.limit, 2),
        facts=facts,
    )
