"""A duration that no plan beats: `least_duration(scene)`, from the request alone.

Each event of the task (`events`) is met at some time T. Times are excluded one interval after the other; the first that
cannot be excluded ends the bound. A time is excluded if a joint cannot come from where it was left in time (`fastest`,
`guided`). Who leaves a point that moves leaves it at its first possible time or later; going along with the point until
later is a motion within bounds, so the state at that first time stands for all later ones.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.checker.along import MEET_M
from assur.planner.checker.bound.events import (
    ALONG,
    PASSES,
    STOPS,
    Event,
    events,
    lifted,
    still,
    straight_times,
)
from assur.planner.checker.bound.fastest import EXACT, FREE, KINDS, STATE, arrivals, changed
from assur.planner.checker.bound.guided import BOUNDED, DYAD, UNKNOWN, first_open, guided
from assur.planner.checker.bound.places import Unplaced, modes_asked, places
from assur.planner.checker.bound.rates import climbs, known, rates
from assur.planner.checker.laws import arm_row
from assur.planner.checker.legs import TIME_S
from assur.planner.frames.motion import Pose
from assur.planner.laws.belt_window import travelled
from assur.planner.model.scene import Pick, Place, Scene
from assur.planner.robots.five_bar import FiveBar
from assur.planner.robots.scara import Scara

RESERVE = 1e-6
"""Share of the bound that is not claimed: limits are kept up to as much (of the jerk), and times round."""
UNBOUNDED_JERK_S = 1e-9
"""Where the jerk has no limit, the acceleration counts as reached in this time, s, and as much is not claimed."""
INTERVALS, ROUNDS, FINEST_S = 8, 24, 1e-7
"""Into so many intervals the time in question is cut, at most so often, until one is as short as this, s."""
FIRST_S = 0.3
"""How much time is looked at first, s; twice as much where all of it is excluded."""
WAITS_S = (0.8, 0.4, 0.2, 0.1, 0.05)
"""How long an arm may be guided along before it leaves a point that moves, s: the first of them for which its rates are
bounded; the next point is not said to be met later than that."""
MOST_STATES = 64
"""States from which an arm may leave a point, at most: with more, nothing is said of the way to the next one."""
LIFT = 2
"""The joint that lifts, of an arm that has one."""


@dataclass(frozen=True, eq=False)
class Left:
    """How an arm may leave a point: one of `states` (S, 4, n), each joint at its time of `times` (S, n), s, or later,
    along what keeps to `kept` (S, 3, n). What is met next is met at `until` at the latest, s, or it is not known."""

    states: FloatArray
    times: FloatArray
    kept: FloatArray
    until: float = math.inf


@np.errstate(all="ignore")
def least_duration(scene: Scene) -> float | None:
    """Seconds from the start that every plan takes at least; None: nothing is known.

    It is of plans that meet their points as they are asked to: in the working mode of the options, along a frame with
    its velocity and acceleration. What the tolerances of a check would save is not taken off.
    """
    floor, left, lifts = scene.start.time, _begun(scene), 0.0
    # the limits of the way so far: with another part in the gripper before a point of which nothing is known
    since = _limits(scene, events(scene)[0].before)
    for event in events(scene):
        before, behind = _limits(scene, event.before), _limits(scene, event.after)
        early, late, lifts = 0.0, 0.0, 0.0
        if not climbs(scene.frames[event.frame].law):
            early, late = straight_times(scene, event, before[2:], behind[2:])
            lifts = _lifts(scene, event, behind)
        since = _widest(since, before)
        found = _met(scene, event, left, since, max(floor, event.opens), early, late)
        if found is None:
            # nothing is known of where it is met; it is left after its dwell, and the way goes on from the one before
            met = max(floor + early, event.opens)
        else:
            met, left = found
            since = behind
        floor = met + event.dwell + event.traced + late
        lifts -= late
    return _claimed(scene, max(floor + lifts, _rested(scene, left, since)) - scene.start.time)


def _lifts(scene: Scene, event: Event, limits: FloatArray) -> float:
    """How long the lift takes for the straight part behind a point if the arm comes to rest behind it, s."""
    if scene.robot.lift is None or not isinstance(event.step, Pick | Place) or scene.options.end != "rest":
        return 0.0
    return lifted(scene.straight(event.step)[1], limits[2:, scene.robot.lift], stops=True)


def _widest(one: FloatArray, other: FloatArray) -> FloatArray:
    """Limits (5, n) that hold whichever of both hold."""
    return np.concatenate([np.minimum(one[:1], other[:1]), np.maximum(one[1:], other[1:])])


def _rested(scene: Scene, left: Left, since: FloatArray) -> float:
    """When all joints can stand still first, s, after a point was left, within the limits `since` then (5, n) or those
    at the end."""
    soon = math.inf
    if scene.options.end != "rest":
        return -soon
    limits = _widest(since, _limits(scene, events(scene)[-1].after))
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


def _begun(scene: Scene) -> Left:
    start, n = scene.start, len(scene.robot.joints)
    state = np.array([[start.q, start.qd, start.qdd, np.full(n, EXACT)]])
    return Left(state, np.full((1, n), start.time), np.zeros((1, 3, n)))


def _limits(scene: Scene, part: str | None) -> FloatArray:
    """Range, velocity, acceleration and jerk (5, n) with a part in the gripper."""
    limits = np.array(scene.limits_with(part).table)
    if not scene.options.jerk_limited:
        limits[4] = limits[3] / UNBOUNDED_JERK_S
    return limits


def _met(
    scene: Scene, event: Event, left: Left, limits: FloatArray, floor: float, early: float, late: float
) -> tuple[float, Left] | None:
    """When an event can be met first, and how it is left then; None: nothing is known of where it is."""
    modes = modes_asked(scene.robot, scene.options.elbow, scene.start.q)
    guides = np.full(len(scene.robot.joints), early)
    if scene.robot.lift is not None:
        guides[LIFT] = 0.0
    if still(scene, event):
        return _met_still(scene, event, left, limits, floor, guides, late, modes)
    if not isinstance(scene.robot, Scara | FiveBar) or not known(scene.frames[event.frame].law):
        return None
    return _met_moving(scene, event, left, limits, floor, guides, late, modes)


def _met_still(
    scene: Scene,
    event: Event,
    left: Left,
    limits: FloatArray,
    floor: float,
    guides: FloatArray,
    late: float,
    modes: tuple[int, ...],
) -> tuple[float, Left] | None:
    """`_met` of a point that stands still: the arm may wait there, so what is not too soon stays so."""
    at, goals = scene.start.time, list[FloatArray]()
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
    times, rates = np.empty(len(every)), np.ascontiguousarray(limits[2:])
    arrivals(left.states, left.kept, left.times, states, guides, rates, max(floor, at), times)
    met = min(float(times.min()), max(left.until, floor))
    times = np.minimum(times, max(left.until, floor))
    leaves = np.repeat((times + event.dwell)[:, None], every.shape[1], axis=1)
    leaves += _others(scene, late)
    return met, Left(states, leaves, np.zeros((len(every), 3, every.shape[1])))


def _others(scene: Scene, late: float) -> FloatArray:
    """`late` for each joint (n,) but the lift."""
    found = np.full(len(scene.robot.joints), late)
    if scene.robot.lift is not None:
        found[LIFT] = 0.0
    return found


def _met_moving(
    scene: Scene,
    event: Event,
    left: Left,
    limits: FloatArray,
    floor: float,
    guides: FloatArray,
    late: float,
    modes: tuple[int, ...],
) -> tuple[float, Left] | None:
    """`_met` of a point that moves, for arms whose rates are bounded."""
    if not event.poses:
        return None
    met = min(_hit(scene, event, pose, left, limits, floor, guides, modes) for pose in event.poses)
    return met, _along(scene, event, met, late, modes)


def _along(scene: Scene, event: Event, met: float, late: float, modes: tuple[int, ...]) -> Left:
    """How a point that moves is left, if it was met at `met`, s, or later."""
    n, law, row = len(scene.robot.joints), scene.frames[event.frame].law, np.array(arm_row(scene.robot))
    times = met + event.dwell + _others(scene, late)
    begin, work = met + event.dwell + late, np.zeros(2 * DYAD)
    for waits in WAITS_S if event.kind == ALONG else ():
        states, kept, fine = list[FloatArray](), list[FloatArray](), True
        for pose in event.poses:
            point = _points(event, scene, pose, np.array([begin]))[0]
            bounds = rates(law, math.hypot(pose.x, pose.y), np.array([begin]), np.array([begin + waits]))[0]
            for mode in modes:
                state, most = np.zeros((STATE, n)), np.zeros((3, n))
                found = guided(row, mode, point, bounds, waits, state, most, work)
                fine = fine and found != UNKNOWN and bool(np.isfinite(bounds).all())
                if found == BOUNDED and fine:
                    choices = [_turns(scene, k, state[0, k], most[0, k] * waits) for k in range(n)]
                    fine = len(states) + math.prod(map(len, choices)) <= MOST_STATES
                    turns = product(*choices) if fine else ()
                    states += [np.array([turned, *state[1:]]) for turned in turns]
                    kept += [most] * (len(states) - len(kept))
        if fine and states:
            return Left(np.array(states), np.tile(times, (len(states), 1)), np.array(kept), begin + waits)
    nowhere = np.zeros((1, STATE, n))
    nowhere[:, 0], nowhere[:, KINDS] = np.nan, FREE
    return Left(nowhere, times[None, :], np.zeros((1, 3, n)))


def _turns(scene: Scene, joint: int, at: float, off: float) -> list[float]:
    """Positions, whole turns from `at`, that a joint may have on the way `off` from there in which it is in range."""
    low, high = (float(edge[joint]) for edge in scene.robot.limits.within)
    if math.isnan(at) or joint == LIFT:
        return [at]
    first, last = math.ceil((low - off - at) / math.tau), math.floor((high + off - at) / math.tau)
    return [at + turn * math.tau for turn in range(first, last + 1)]


def _points(event: Event, scene: Scene, pose: Pose, t: FloatArray) -> FloatArray:
    """The motion (T, 4, 4) of the flange at times (T,): a row an order, columns x, y, z, yaw."""
    motion = scene.frames[event.frame].law.motion(t).at(pose)
    found = np.empty((len(t), 4, 4))
    for row, (place, yaw) in enumerate(
        (
            (motion.p, motion.yaw),
            (motion.v, motion.yaw_d),
            (motion.a, motion.yaw_dd),
            (motion.j, motion.yaw_ddd),
        )
    ):
        found[:, row, :3], found[:, row, 3] = place, yaw
    if event.free:
        found[:, :, 3] = np.nan
    return found


def _hit(
    scene: Scene,
    event: Event,
    pose: Pose,
    left: Left,
    limits: FloatArray,
    floor: float,
    guides: FloatArray,
    modes: tuple[int, ...],
) -> float:
    """The first time at which the flange at `pose` in a frame that moves may be met, s, or one before it."""
    law, row, early = scene.frames[event.frame].law, np.array(arm_row(scene.robot)), float(guides.max(initial=0.0))
    # times are those from which the other joints are guided, `early` before the point is met
    late = early - guides
    low = max(floor - early, law.valid[0])
    end = min(law.valid[1], max(left.until, floor)) - early
    span, arm_m, seen = FIRST_S, math.hypot(pose.x, pose.y), np.array(modes)
    for _ in range(ROUNDS):
        edges = np.linspace(low, min(low + span, end), INTERVALS + 1)
        if not edges[-1] > edges[0]:
            break
        points = _points(event, scene, pose, edges[1:])
        bounds = rates(law, arm_m, edges[:-1], edges[1:])
        k = first_open(
            edges,
            points,
            bounds,
            _outside(scene, event, edges + early),
            row,
            seen,
            event.kind == STOPS,
            event.kind == PASSES,
            left.states,
            left.kept,
            left.times,
            late,
            limits,
        )
        if k == INTERVALS:
            low, span = float(edges[-1]), 2.0 * span
            continue
        low, span = float(edges[k]), float(edges[k + 1] - edges[k])
        if span <= FINEST_S:
            break
    return max(floor, low + early)


def _outside(scene: Scene, event: Event, edges: FloatArray) -> BoolArray:
    """Of which intervals (N,) between edges (N + 1,), s, it is known that the point is outside of its window."""
    law, window = scene.frames[event.frame].law, event.step.window
    out = np.zeros(len(edges) - 1, dtype=bool)
    if window.time is not None:
        out |= edges[:-1] > window.time[1] + TIME_S
    if window.along is not None and law.kind in ("conveyor", "linear"):
        gone = travelled(law, event.point, edges)
        off = rates(law, 0.0, edges[:-1], edges[1:])[:, :6:3].sum(axis=1) * np.diff(edges)
        out |= (gone[1:] + off < window.along[0] - MEET_M) | (gone[1:] - off > window.along[1] + MEET_M)
    return out
