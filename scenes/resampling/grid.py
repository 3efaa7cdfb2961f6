"""The knots of a motion on another grid of times: whole nanoseconds, or the ticks of a controller."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.errors import InputError
from assur.planner.model.outcome import TRACKING, Arrival, Course, Leg, LegKind, Plan, Route
from assur.planner.model.phases import phases
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory
from assur.scenes.resampling.keeping import WIDE, Requirements, kept

NANO = 1e-9
SHORTEST_TICK_S, LONGEST_TICK_S = 1e-4, 0.1
"""s. With shorter ticks the rounded knots do not determine the jerk; with longer ones too little of the motion is
left."""
MOST_KNOTS = 50_000
"""Knots that a motion may have on a grid: what readers of trajectories take."""
CROWDED = 1000
"""Nanoseconds between two knots within which what states round would be a jerk."""
BORDER = 2
"""Ticks at the ends of a leg in which the tool is guided, where states may be changed for the jerk."""
LIFTED = frozenset({LegKind.FOLLOW})
"""Legs in which the joint that only moves along the vertical is guided, too: the others are along a line, and a change
of this joint does not leave a vertical one."""
ROUNDING = 1e-9
"""Of a tick: how much earlier than a tick a motion may end to end with it."""


def on_nanoseconds(trajectory: Trajectory, also: int | None = None) -> Trajectory:
    """The same motion through knots at whole nanoseconds after its start; states are those of the motion at that time.

    `also`: where a further knot is, in place of those that are nearer to it than `CROWDED` nanoseconds.

    Raises `InputError` for two knots at one time, or in one nanosecond.
    """
    if trajectory.jumps:
        allowed = "knots at different times: the acceleration of this motion jumps (timing: jerk_limited has none)"
        raise InputError("trajectory.acceleration_jumps", True, allowed)
    whole = np.rint((trajectory.time - trajectory.start) / NANO)
    if also is not None:
        apart = np.abs(whole - also) > CROWDED
        apart[0] = True
        whole = np.union1d(whole[apart], [float(also)])
    close = np.flatnonzero(np.diff(whole) < 1.0)
    if len(close):
        late = trajectory.start + float(whole[close[0] + 1]) * NANO
        raise InputError("trajectory.time_s", late, "knots 1 ns apart at least")
    time = trajectory.start + whole * NANO
    own = trajectory.time[np.clip(np.searchsorted(trajectory.time, time - NANO / 2.0), 0, len(trajectory.time) - 1)]
    # a knot at a whole nanosecond is not changed, to the bit
    return _through(trajectory, np.where(np.abs(own - time) <= 2.0 * np.spacing(np.abs(time)), own, time))


def on_ticks(scene: Scene, plan: Plan, tick_s: float, *, hold_jerk: bool = False) -> Trajectory:
    """The motion of a plan through knots at the ticks of a controller, counted from its start.

    The states are those of the plan, changed a little where the quintic between two ticks would exceed a limit of
    velocity or acceleration, and where a leg ends between two ticks: position and velocity there are the plan's. A
    motion that ends at rest stands until the next tick; another has its last knot when it ends.

    The jerk may be beyond its limit. With `hold_jerk` states are changed by as much as the limit of the jerk needs, but
    for those where the tool is guided. Where that does not suffice the jerk still is beyond its limit.

    Raises `InputError` for a tick that is out of range, jumps of the acceleration, and where limits cannot be kept.
    """
    trajectory = plan.trajectory
    if not SHORTEST_TICK_S <= tick_s <= LONGEST_TICK_S:
        least, most = SHORTEST_TICK_S, LONGEST_TICK_S
        allowed = f"from {least:g} to {most:g} s, {1e3 * least:g} to {1e3 * most:g} ms"
        raise InputError("tick_s", tick_s, allowed)
    if trajectory.jumps:
        allowed = (
            "none: between two ticks the acceleration of this motion jumps, and a motion through states at ticks "
            "has no parabolas that could be proved; export the knots as csv, or plan with timing: jerk_limited"
        )
        raise InputError("tick_s", tick_s, allowed)
    count = max(1, math.ceil(trajectory.duration / tick_s - ROUNDING))
    if count >= MOST_KNOTS:
        allowed = f"a tick with at most {MOST_KNOTS} points; this motion lasts {trajectory.duration:g} s"
        raise InputError("tick_s", tick_s, allowed)
    time: FloatArray = trajectory.start + tick_s * np.arange(count + 1, dtype=np.float64)
    if not trajectory.rest_at_end:
        time[-1] = trajectory.end
    made = _through(trajectory, time)
    limits, at = _limits(scene, plan, time), _held(plan)
    q, v = trajectory.evaluate(at), trajectory.evaluate(at, 1)
    still = ~_rates(made)
    still[[0, -1]] = True
    span = np.stack([scene.robot.limits.lower, scene.robot.limits.upper])
    states = np.stack([made.q, made.qd, made.qdd])
    for joint in range(made.n):
        required = Requirements(span[:, joint], limits[:, :, joint], still, np.stack([at, q[:, joint], v[:, joint]], 1))
        mended = kept(time, states[:, :, joint].T, required)
        if mended is None:
            what = f"a shorter tick: {scene.robot.joints[joint].name} cannot keep its limits through states at these"
            raise InputError("tick_s", tick_s, what)
        if hold_jerk:
            guided = LIFTED if joint == scene.robot.lift else TRACKING
            held = kept(time, mended, replace(required, fixed=still | _inside(plan, time, guided)), WIDE)
            mended = mended if held is None else held
        states[:, :, joint] = mended.T
    return Trajectory(time, *states)


def _through(trajectory: Trajectory, time: FloatArray) -> Trajectory:
    """The knots of a motion at other times. It ends with the state that it has at its end."""
    at = np.clip(time, trajectory.start, trajectory.end)
    at[-1] = trajectory.end
    return Trajectory(time, *trajectory.states(at))


def _limits(scene: Scene, plan: Plan, time: FloatArray) -> FloatArray:
    """Limits of velocity, acceleration and jerk on each piece between times (3, K-1, n), the least of all loads that
    are carried in it."""
    own = scene.robot.limits
    found = np.repeat(np.stack([own.velocity, own.acceleration, own.jerk])[:, None], len(time) - 1, 1)
    for phase in phases(scene, plan.legs, plan.arrivals):
        loaded = phase.attached.limits(scene)
        within = (time[:-1] < phase.t1) & (time[1:] > phase.t0)
        table = np.stack([loaded.velocity, loaded.acceleration, loaded.jerk])[:, None]
        found[:, within] = np.minimum(found[:, within], table)
    return found


def _inside(plan: Plan, time: FloatArray, kinds: frozenset[LegKind]) -> BoolArray:
    """Which times (K,) are in legs of these kinds, further than `BORDER` times from both ends."""
    found = np.zeros(len(time), dtype=np.bool_)
    for leg in plan.legs:
        if leg.kind in kinds:
            first, last = np.searchsorted(time, (leg.t0, leg.t1))
            found[first + BORDER : max(last - BORDER, 0)] = True
    return found


def _held(plan: Plan) -> FloatArray:
    """Times at which the state must be that of the plan: the ends of legs, but for those of waits."""
    exact = {t for leg in plan.legs if leg.kind is not LegKind.WAIT for t in (leg.t0, leg.t1)}
    waits = {t for leg in plan.legs if leg.kind is LegKind.WAIT for t in (leg.t0, leg.t1)}
    exact |= {t for arrival in plan.arrivals for t in (arrival.time, arrival.until)}
    inside = sorted(t for t in exact - waits if plan.trajectory.start < t <= plan.trajectory.end)
    return np.array(inside, dtype=np.float64)


def legs_on(plan: Plan, made: Trajectory) -> tuple[Leg, ...]:
    """The legs of a plan on a motion that has the same course through other knots.

    A wait lasts as long as the new motion stands in it; one in which it never stands is none. A motion that ends later
    than the plan's comes to rest on a way of its own. Raises `InputError` for a plan without legs.
    """
    rates = _rates(made)
    standing = ~(np.diff(made.q, axis=0).any(1) | rates[:-1] | rates[1:])
    legs = list[Leg]()
    for leg in plan.legs:
        if leg.kind is LegKind.WAIT:
            inside = np.flatnonzero(standing & (made.time[:-1] < leg.t1) & (made.time[1:] > leg.t0))
            if not len(inside):
                continue
            t0, t1 = float(made.time[inside[0]]), float(made.time[inside[-1] + 1])
            leg = replace(leg, t0=max(leg.t0, t0), t1=min(leg.t1, t1))
        legs.append(leg)
    joined = list[Leg]()
    for i, leg in enumerate(legs):
        follows = legs[i + 1] if i + 1 < len(legs) else None
        begin = joined[-1].t1 if joined else made.start
        end = leg.t1 if follows is None or follows.kind is not LegKind.WAIT else follows.t0
        joined.append(replace(leg, t0=begin, t1=end))
    if not joined:
        raise InputError("plan.legs", len(plan.legs), "at least one leg in which the arm moves")
    last = joined[-1]
    arrived = max((arrival.until for arrival in plan.arrivals), default=made.start)
    if made.end - plan.trajectory.end <= NANO or (last.kind is LegKind.MOVE and arrived < plan.trajectory.end):
        joined[-1] = replace(last, t1=made.end)
    else:
        joined.append(Leg(LegKind.MOVE, last.step, last.t1, made.end, Route(Course.TO_REST)))
    return tuple(_after(before, leg) for before, leg in zip((None, *joined), joined, strict=False))


def _after(before: Leg | None, leg: Leg) -> Leg:
    """The leg, with a route that says whether it begins after a wait."""
    waited = before is not None and before.kind is LegKind.WAIT and before.step == leg.step
    return leg if leg.route is None else replace(leg, route=replace(leg.route, after_wait=waited))


def arrivals_on(plan: Plan, made: Trajectory) -> tuple[Arrival, ...]:
    """The arrivals of a plan, none later than the end of a motion, and at the ends of its legs where these are nearer
    than a nanosecond: a grid rounds them."""
    ends = np.array([leg.t1 for leg in legs_on(plan, made)])

    def on(t: float) -> float:
        t = min(t, made.end)
        near = float(ends[np.abs(ends - t).argmin()])
        return near if abs(near - t) <= NANO else t

    return tuple(replace(each, time=on(each.time), until=on(each.until)) for each in plan.arrivals)


def _rates(made: Trajectory) -> BoolArray:
    """At which knots something moves (K,)."""
    return np.asarray(np.any(made.knots[:, 1 + made.n :] != 0.0, axis=1))
