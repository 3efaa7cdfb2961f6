"""Tables of the times in which a robot goes from places to parts and back, without obstacles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.frames.motion import Motion, Pose
from assur.planner.kernels.dyads import ASSEMBLED
from assur.planner.laws.law import Law
from assur.planner.robots.robot import Robot
from assur.planner.selection import columns as c
from assur.planner.selection.columns import Times
from assur.planner.timing.solver import Solver, TimingRefusal

STEP_M = 0.01
"""Between two points of a grid, m, or less."""


@dataclass(frozen=True, eq=False)
class Lane:
    """Where parts ride one behind the other. A part that passes the mark at t0 is picked at time t with the tool at
    `grasp` in the frame that is where `law` has it at t - t0. `window`: of t - t0, s, in which the cell allows it."""

    law: Law
    grasp: Pose
    window: tuple[float, float]


@dataclass(frozen=True, eq=False)
class Place:
    """Where parts are put down: at `slots`, one after the other and then from the first on, in a frame that rests; or,
    with a `period`, s, in the one slot of a moving frame that passes its mark in each period, up to `window` after it,
    s."""

    law: Law
    slots: tuple[Pose, ...]
    period: float = 0.0
    window: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True, eq=False)
class CycleTerms:
    """What all cycles have in common. `tcp`: the tool's point in the flange's frame; `above`: how far above their
    points travels end, m; `ride_pick`, `ride_place`: from there until the tool is as high again, s; `margin`: the
    singularity margin of a meeting, no unit."""

    tcp: Pose
    above: float
    ride_pick: float
    ride_place: float
    margin: float = 0.0


def times_of(
    robot: Robot,
    modes: Sequence[int],
    lanes: Sequence[Lane],
    places: Sequence[Place],
    handling: CycleTerms,
    shares: FloatArray | None = None,
) -> Times:
    """The tables of a cell, for an arm that uses these working modes. The time between two states is that of the
    fastest jerk-limited motion of the joints that carry the tool: the lift moves during the ride, and the tool turns
    meanwhile. Lanes and places move steadily. `shares` (L, P): of the parts that come on each lane for each place, for
    the mean cycle; None: equal ones. Raises `InputError` for a lane with less than two points in reach."""
    arm = _Arm(robot, tuple(modes), handling)
    long = max(len(_grid(lane.law, lane.grasp, lane.window)) for lane in lanes)
    wide = max(len(_grid(x.law, x.slots[0], x.window)) if x.period else len(x.slots) for x in places)
    picks, puts = [arm.above_lane(lane, long) for lane in lanes], [arm.above_place(place, wide) for place in places]
    there = np.full((len(puts), wide, len(modes), len(picks), len(modes), long), c.UNREACHED)
    back = np.full((len(picks), len(modes), long, len(puts), wide, len(modes)), c.UNREACHED)
    for (p, put), (number, pick) in product(enumerate(puts), enumerate(picks)):
        for (e, u), (f, s) in product(put.reached(), pick.reached()):
            there[p, u, e, number, f, s] = arm.least_time(put.states[e, u], pick.states[f, s])
            back[number, f, s, p, u, e] = arm.least_time(pick.states[f, s], put.states[e, u])
    rows = np.array([pick.row for pick in picks]), np.array([put.row for put in puts])
    rides = np.array([[handling.ride_pick, handling.ride_place, 0.0]])
    made = Times(there, back, *rows, rides, *(np.array([each.points for each in side]) for side in (picks, puts)))
    means = mean_cycles(made)
    rides[0, c.NOMINAL] = np.average(means, weights=np.ones_like(means) if shares is None else shares)
    return made


def mean_cycles(times: Times) -> FloatArray:
    """How long a cycle takes for parts of each lane and each place (L, P), s: the mean over the window and over the
    places from which the arm comes, in the mode that is best on average."""
    found, ride = np.empty((len(times.lanes), len(times.places))), float(times.rides[0, : c.NOMINAL].sum())
    for number, own in enumerate(times.lanes):
        t = own[c.LANE_BEGIN] + own[c.LANE_STEP] * np.arange(times.there.shape[-1])
        inside = np.flatnonzero((t >= own[c.LANE_ENTERS] - 1e-9) & (t <= own[c.LANE_LEAVES] + 1e-9))
        later = np.minimum(inside + round(times.rides[0, c.RIDE_PICK] / own[c.LANE_STEP]), len(t) - 1)
        there, back = (np.where(x < c.UNREACHED, x, np.nan) for x in (times.there[:, :, :, number], times.back[number]))
        come = np.nanmean(np.nanmin(there[..., inside], axis=2), axis=(0, 1))
        for p in range(len(times.places)):
            go = np.nanmean(np.nanmin(back[:, later, p], axis=-1), axis=-1)
            found[number, p] = ride + np.nanmin(np.nanmean(come + go, axis=1))
    return found


@dataclass(frozen=True, eq=False)
class _Stop:
    """Where travels end: the `states` (E, K, 3, n) of the joints, NaN where a mode does not reach it; its row of a
    table, and its `points` (2, K), m."""

    states: FloatArray
    row: FloatArray
    points: FloatArray

    def reached(self) -> list[list[int]]:
        found: list[list[int]] = np.argwhere(np.isfinite(self.states).all(axis=(2, 3))).tolist()
        return found


class _Arm:
    """A robot in some of its working modes, and the joints of it that are timed."""

    def __init__(self, robot: Robot, modes: tuple[int, ...], handling: CycleTerms) -> None:
        self.robot, self.modes, self.handling = robot, modes, handling
        turns = len(robot.joints) - 1 if robot.turns_load else None
        self.joints = [k for k in range(len(robot.joints)) if k not in (robot.lift, turns)]
        self.limits: FloatArray = robot.limits.table[:, self.joints]
        self.solver = Solver(*self.limits[2:].tolist())

    def least_time(self, begin: FloatArray, end: FloatArray) -> float:
        found = self.solver.shortest(begin.tolist(), end.tolist())
        return c.UNREACHED if isinstance(found, TimingRefusal) else found

    def above_lane(self, lane: Lane, many: int) -> _Stop:
        t = np.linspace(*lane.window, many)
        motion = lane.law.motion(t).at(lane.grasp)
        states = self.states(motion)
        known = np.isfinite(states).all(axis=(2, 3)).any(axis=0)
        edges = np.flatnonzero(np.diff(known.astype(np.int64), prepend=0, append=0))
        k = int(np.argmax(edges[1::2] - edges[::2])) if len(edges) else 0
        if not len(edges) or edges[2 * k + 1] - edges[2 * k] < 2:
            raise InputError("lane", lane.window, "a window with two points that the arm reaches")
        first, last = t[edges[2 * k]], t[edges[2 * k + 1] - 1]
        return _Stop(states, np.array([t[0], t[1] - t[0], first, last - self.handling.ride_pick]), motion.p[:, :2].T)

    def above_place(self, place: Place, many: int) -> _Stop:
        if place.period:
            t = np.linspace(*place.window, many)
            motion = place.law.motion(t).at(place.slots[0])
        else:
            t = np.arange(float(many))
            slots = [place.law.motion(np.zeros(1)).at(slot).table for slot in place.slots]
            motion = Motion(np.concatenate(slots + slots[-1:] * (many - len(slots))))
        row = np.array([t[0], t[1] - t[0] if many > 1 else 1.0, t[-1], place.period, len(place.slots)])
        return _Stop(self.states(motion), row, motion.p[:, :2].T)

    def states(self, motion: Motion) -> FloatArray:
        """States above the points of a motion (K), within the limits and with the margin."""
        flange, found = motion.at(Pose(0.0, 0.0, self.handling.above, 0.0)).at(self.handling.tcp.inverse()), []
        lower, upper, velocity, acceleration, _ = self.limits
        for mode in self.modes:
            inverse = self.robot.inverse(flange, mode, 2)
            q, qd, qdd = (each[:, self.joints] for each in (inverse.q, inverse.qd, inverse.qdd))
            kept = (inverse.code == ASSEMBLED) & inverse.keeps(self.handling.margin)
            kept &= ((q >= lower) & (q <= upper) & (abs(qd) <= velocity) & (abs(qdd) <= acceleration)).all(axis=1)
            found.append(np.where(kept[:, None, None], np.stack([q, qd, qdd], axis=1), np.nan))
        return np.array(found)


def _grid(law: Law, point: Pose, window: tuple[float, float]) -> FloatArray:
    """Times in the window that are STEP_M apart at most, two at least."""
    speed = float(np.linalg.norm(law.motion(np.array([0.0])).at(point).v))
    return np.linspace(*window, max(2, math.ceil(speed * (window[1] - window[0]) / STEP_M - 1e-9) + 1))
