"""A duration that no plan beats: `least_duration(scene)`, from the request alone.

Each event of the task (`events`) is met at some time T. Times are excluded one interval after the other; the first that
cannot be excluded ends the bound. A time is excluded if a joint cannot come from where it was left in time (`fastest`,
`guided_joints`). An arm leaves a point that moves at its first possible time or later. Until then going along with the
point is a motion within bounds, so the state at that first time stands for all later ones.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.bound.events import (
    ALONG,
    PASSES,
    STOPS,
    Event,
    Unplaced,
    allowed_modes,
    climbs,
    events,
    places,
    rate_bounds,
    straight_times,
    turns_within,
)
from assur.planner.bound.fastest import EXACT, FREE, KINDS, STATE, arrivals, changed
from assur.planner.bound.guided import BOUNDED, DYAD, UNKNOWN, first_open, guided_joints
from assur.planner.frames.motion import Pose
from assur.planner.laws.belt_window import travelled
from assur.planner.model.scene import Scene

RESERVE = 1e-6
"""Share of the bound that is not claimed: limits are kept up to as much (of the jerk), and times round."""
UNBOUNDED_JERK_S = 1e-9
"""Where the jerk has no limit, the acceleration counts as reached in this time, s, and as much is not claimed."""
INTERVALS, ROUNDS, FINEST_S = 8, 24, 1e-7
"""Into so many intervals the time in question is cut, at most so often, until one is as short as this, s."""
SHARES = np.arange(INTERVALS + 1.0) / INTERVALS
"""Where the edges of these intervals are, as shares of that time."""
FIRST_S = 0.3
"""The time that is searched first, s; twice as much where all of it is excluded."""
WAITS_S = (0.8, 0.4, 0.2, 0.1, 0.05)
"""How long an arm may be guided along before it leaves a point that moves, s: the first of them for which its rates are
bounded; no bound says that the next point is met later than that."""
MOST_STATES = 64
"""States from which an arm may leave a point, at most: with more, the way to the next point has no bound."""
WINDOW_S, WINDOW_M = 1e-9, 1e-6
"""A window counts as wider by this at both ends: so much of it a check of a plan allows."""


@dataclass(frozen=True, eq=False)
class Departure:
    """How an arm may leave a point: one of `states` (S, 4, n), each joint at its time of `times` (S, n), s, or later,
    along what keeps to `kept` (S, 3, n). What is met next is met at `until` at the latest, s, or it is not known."""

    states: FloatArray
    times: FloatArray
    kept: FloatArray
    until: float = math.inf


@np.errstate(all="ignore")
def least_duration(scene: Scene) -> float | None:
    """Seconds from the start that every plan takes at least; None: nothing is known.

    It is for plans that meet their points as the request requires: in the working mode of the options, along a frame
    with its velocity and acceleration. What the tolerances of a check would save is not taken off.
    """
    floor, left, lifts, points = scene.start.time, _begun(scene), 0.0, events(scene)
    # the limits of the way so far: before a point without a bound the gripper may hold another part
    since = _limits(scene, points[0].before)
    for event in points:
        before, behind = _limits(scene, event.before), _limits(scene, event.after)
        early, late, lifts = 0.0, 0.0, 0.0
        if not climbs(scene.frames[event.frame].law):
            early, late, lifts = straight_times(scene, event, before[2:], behind[2:])
        since = _widest(since, before)
        found = _Way(scene, event, left, since, max(floor, event.opens), early, late).met()
        if found is None:
            # nothing is known of where it is met; it is left after its dwell, and the way goes on from the one before
            met = max(floor + early, event.opens)
        else:
            met, left = found
            since = behind
        floor = met + event.dwell + event.traced + late
        lifts -= late
    return _claimed(scene, max(floor + lifts, _rested(scene, left, since, points[-1].after)) - scene.start.time)


def _widest(one: FloatArray, other: FloatArray) -> FloatArray:
    """Limits (5, n) that hold whichever of both hold."""
    return np.concatenate([np.minimum(one[:1], other[:1]), np.maximum(one[1:], other[1:])])


def _rested(scene: Scene, left: Departure, since: FloatArray, held: str | None) -> float:
    """When all joints can stand still first, s, after a point was left, within the limits `since` then (5, n) or those
    at the end, with the part `held` in the gripper (None: none)."""
    soon = math.inf
    if scene.options.end != "rest":
        return -soon
    limits = _widest(since, _limits(scene, held))
    for state, since, kept in zip(left.states, left.times, left.kept, strict=True):
        rates = np.maximum(limits[2:], kept)
        rests = [
            since[k] + (changed(state[1, k], state[2, k], 0.0, 0.0, rates[1, k], rates[2, k]) if known_ else 0.0)
            for k, known_ in enumerate(state[KINDS] == EXACT)
        ]
        soon = min(soon, max(rests))
    return min(soon, left.until)


def _claimed(scene: Scene, lasts: float) -> float | None:
    """A bound less its reserve; None where it says nothing."""
    own = 0.0 if scene.options.jerk_limited else UNBOUNDED_JERK_S * 4 * len(scene.task)
    bound = lasts - RESERVE * lasts - own
    return bound if bound > RESERVE else None


def _begun(scene: Scene) -> Departure:
    start, n = scene.start, len(scene.robot.joints)
    state = np.array([[start.q, start.qd, start.qdd, np.full(n, EXACT)]])
    return Departure(state, np.full((1, n), start.time), np.zeros((1, 3, n)))


def _limits(scene: Scene, part: str | None) -> FloatArray:
    """Range, velocity, acceleration and jerk (5, n) with a part in the gripper."""
    limits = np.array(scene.limits_with(part).table)
    if not scene.options.jerk_limited:
        limits[4] = limits[3] / UNBOUNDED_JERK_S
    return limits


@dataclass(frozen=True, eq=False)
class _Way:
    """The way to an event, from how the arm may have `left` the one before, within `limits` (5, n), met no sooner than
    at `floor`, s. For `early` s before it and `late` s after it no joint but the lift moves against the point."""

    scene: Scene
    event: Event
    left: Departure
    limits: FloatArray
    floor: float
    early: float
    late: float

    def met(self) -> tuple[float, Departure] | None:
        """When the event can be met first, and how it is left then; None: nothing is known of where it is."""
        scene, event = self.scene, self.event
        modes = allowed_modes(scene.robot, scene.options.elbow, scene.start.q)
        if scene.frames[event.frame].law.is_fixed:
            return self._met_still(modes)
        bounded = scene.robot.dyads > 0 and scene.frames[event.frame].law.link is None
        if not bounded or not event.poses:
            return None
        met = min(self._hit(pose, modes) for pose in event.poses)
        return met, self._along(met, modes)

    def _besides_lift(self, time: float) -> FloatArray:
        """A time for each joint (n,), 0 for the lift."""
        found = np.full(len(self.scene.robot.joints), time)
        if self.scene.robot.lift is not None:
            found[self.scene.robot.lift] = 0.0
        return found

    def _met_still(self, modes: tuple[int, ...]) -> tuple[float, Departure] | None:
        """`met` of a point that stands still: the arm may wait there, so what is not too soon stays so."""
        scene, event, left = self.scene, self.event, self.left
        goals, latest = list[FloatArray](), max(left.until, self.floor)
        for pose in event.poses:
            # a frame that stands still stands still before and behind the times for which it is known, too
            p = scene.frames[event.frame].law.numbers.pose.then(pose)
            yaw = math.nan if event.free else p.yaw
            try:
                goals.append(places(scene.robot, modes, p.x, p.y, p.z, yaw, event.pitch, event.roll))
            except Unplaced:
                return None
        if not goals:
            return None
        every = np.concatenate(goals)
        if len(every) > MOST_STATES:
            return None
        states = np.zeros((len(every), STATE, every.shape[1]))
        states[:, 0] = every
        states[:, KINDS] = FREE if event.kind == PASSES else EXACT
        times, rates = np.empty(len(every)), np.ascontiguousarray(self.limits[2:])
        guides, floor = self._besides_lift(self.early), max(self.floor, scene.start.time)
        arrivals(left.states, left.kept, left.times, states, guides, rates, floor, times)
        leaves = np.repeat((np.minimum(times, latest) + event.dwell)[:, None], every.shape[1], axis=1)
        leaves += self._besides_lift(self.late)
        return min(float(times.min()), latest), Departure(states, leaves, np.zeros((len(every), 3, every.shape[1])))

    def _along(self, met: float, modes: tuple[int, ...]) -> Departure:
        """How a point that moves is left, if it was met at `met`, s, or later."""
        scene, event = self.scene, self.event
        n, law = len(scene.robot.joints), scene.frames[event.frame].law
        times = met + event.dwell + self._besides_lift(self.late)
        begin, work = met + event.dwell + self.late, np.zeros(2 * DYAD)
        for waits in WAITS_S if event.kind == ALONG else ():
            states, kept, fine = list[FloatArray](), list[FloatArray](), True
            for pose in event.poses:
                point = self._points(pose, np.array([begin]))[0]
                bounds = rate_bounds(law, math.hypot(pose.x, pose.y), np.array([begin]), np.array([begin + waits]))[0]
                for mode in modes:
                    state, most = np.zeros((STATE, n)), np.zeros((3, n))
                    found = guided_joints(scene.robot.row, mode, point, bounds, waits, state, most, work)
                    fine = fine and found != UNKNOWN and bool(np.isfinite(bounds).all())
                    if found == BOUNDED and fine:
                        choices = [turns_within(scene.robot, k, state[0, k], most[0, k] * waits) for k in range(n)]
                        fine = len(states) + math.prod(map(len, choices)) <= MOST_STATES
                        turns = product(*choices) if fine else ()
                        states += [np.array([q, *state[1:]]) for q in turns]
                        kept += [most] * (len(states) - len(kept))
            if fine and states:
                return Departure(np.array(states), np.tile(times, (len(states), 1)), np.array(kept), begin + waits)
        nowhere = np.zeros((1, STATE, n))
        nowhere[:, 0], nowhere[:, KINDS] = np.nan, FREE
        return Departure(nowhere, times[None, :], np.zeros((1, 3, n)))

    def _points(self, pose: Pose, t: FloatArray) -> FloatArray:
        """The motion (T, 4, 4) of the flange at times (T,): a row an order, columns x, y, z, yaw."""
        motion = self.scene.frames[self.event.frame].law.motion(t).at(pose)
        found = np.empty((len(t), 4, 4))
        found[:, 0, :3], found[:, 1, :3], found[:, 2, :3], found[:, 3, :3] = motion.p, motion.v, motion.a, motion.j
        found[:, 0, 3], found[:, 1, 3], found[:, 2, 3] = motion.yaw, motion.yaw_d, motion.yaw_dd
        found[:, 3, 3] = motion.yaw_ddd
        if self.event.free:
            found[:, :, 3] = np.nan
        return found

    def _hit(self, pose: Pose, modes: tuple[int, ...]) -> float:
        """The first time at which the flange at `pose` in a frame that moves may be met, s, or one before it."""
        scene, event, left = self.scene, self.event, self.left
        law, guides = scene.frames[event.frame].law, self._besides_lift(self.early)
        # times are those from which the other joints are guided, `early` before the point is met
        early = float(guides.max(initial=0.0))
        low = max(self.floor - early, law.valid[0])
        end = min(law.valid[1], max(left.until, self.floor)) - early
        span, arm_m, ahead, chosen = FIRST_S, math.hypot(pose.x, pose.y), early - guides, np.array(modes)
        for _ in range(ROUNDS):
            high = min(low + span, end)
            if not high > low:
                break
            edges = SHARES * (high - low) + low
            edges[-1] = high
            k = first_open(
                edges,
                self._points(pose, edges[1:]),
                rate_bounds(law, arm_m, edges[:-1], edges[1:]),
                self._outside(edges + early),
                scene.robot.row,
                chosen,
                event.kind == STOPS,
                event.kind == PASSES,
                left.states,
                left.kept,
                left.times,
                ahead,
                self.limits,
            )
            if k == INTERVALS:
                low, span = float(edges[-1]), 2.0 * span
                continue
            low, span = float(edges[k]), float(edges[k + 1] - edges[k])
            if span <= FINEST_S:
                break
        return max(self.floor, low + early)

    def _outside(self, edges: FloatArray) -> BoolArray:
        """Whether the point is outside its window, for certain, over each of N intervals; `edges` (N + 1,), s."""
        event = self.event
        law, window = self.scene.frames[event.frame].law, event.step.window
        out = np.zeros(len(edges) - 1, dtype=bool)
        if window.time is not None:
            out |= edges[:-1] > window.time[1] + WINDOW_S
        if window.along is not None and law.way is not None:
            gone = travelled(law, event.point, edges)
            off = rate_bounds(law, 0.0, edges[:-1], edges[1:])[:, :6:3].sum(axis=1) * np.diff(edges)
            out |= (gone[1:] + off < window.along[0] - WINDOW_M) | (gone[1:] - off > window.along[1] + WINDOW_M)
        return out
