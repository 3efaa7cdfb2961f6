"""Whether a Cartesian leg keeps the joints' limits, by the exact extrema of its spline; and by how much it does not."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.model.assembly_mode import has_loop
from assur.planner.model.refusal import (
    RATES,
    JointName,
    MotionLimit,
    Obstacle,
    Quantity,
    Reason,
    Refusal,
    Singular,
    Stage,
    finite,
    of_joint,
)
from assur.planner.model.scene import Scene, beyond
from assur.planner.robots.facts import Code, Inverse, Limits
from assur.planner.robots.robot import Robot
from assur.planner.trajectory import Trajectory, accepted_bands, keeps_bands


@dataclass(frozen=True, slots=True, eq=False)
class Rates:
    """How a motion uses its `limits`: the lowest and the highest q and derivatives, `extremes` (4, 2, n), which are
    exact; the peaks of velocity, acceleration and jerk over their limits, `ratios` (3, n), 0 for a jerk that has no
    limit; and which positions and rates are `kept` (4, n)."""

    limits: Limits
    extremes: FloatArray
    ratios: FloatArray
    kept: BoolArray

    @property
    def ok(self) -> bool:
        return bool(self.kept.all())

    @property
    def ratio(self) -> float:
        """By what the speed of the leg is to be divided for it to reach its limits, if rates scale with it."""
        velocity, acceleration, jerk = self.ratios.max(1).tolist()
        return float(max(velocity, math.sqrt(acceleration), math.pow(jerk, 1 / 3)))


def used(trajectory: Trajectory, limits: Limits) -> Rates:
    """How a motion uses its limits; its jerk has none where its acceleration may jump."""
    extremes, bands = trajectory.extremes, _bands(limits, trajectory.jumps)
    kept = (bands[:, 0] <= extremes[:, 0]) & (extremes[:, 1] <= bands[:, 1])
    ratios = np.abs(extremes[1:]).max(1) / limits.table[2:]
    if trajectory.jumps:
        ratios[2] = 0.0
    return Rates(limits, extremes, ratios, kept)


def rates(scene: Scene, stage: Stage, step: int, trajectory: Trajectory, limits: Limits) -> Rates | Refusal:
    """How fast the leg is for the limits that hold with its load; a refusal where a joint position is beyond its limit,
    which no slowing down mends."""
    fast = used(trajectory, limits)
    return fast if fast.kept[0].all() else _beyond(scene, stage, step, trajectory)


@lru_cache(maxsize=16)
def _bands(limits: Limits, jumps: bool) -> FloatArray:
    """What is accepted of motions within these limits, that of the jerk only where the acceleration does not jump; for
    every robot once."""
    jerk = None if jumps else limits.jerk
    return accepted_bands(limits.lower, limits.upper, limits.velocity, limits.acceleration, jerk)


def beyond_limits(scene: Scene, step: int, trajectory: Trajectory, limits: Limits) -> Refusal | None:
    """Whether a joint breaks one of `limits` on the way: moving ends overshoot, and the spline as written is what
    counts."""
    if keeps_bands(trajectory, _bands(limits, trajectory.jumps)):
        return None
    fast = rates(scene, Stage.LIMITS, step, trajectory, limits)
    if isinstance(fast, Refusal):
        return fast
    if fast.ok:
        return None
    return too_fast(scene, Stage.LIMITS, step, fast.ratios, limits)


def parts(trajectory: Trajectory, spans: Sequence[tuple[float, Limits]]) -> list[tuple[Trajectory, Limits]]:
    """The parts of a trajectory with the limits that hold there: `spans` are the times, which are knots, at which they
    end, and their limits; those with the same limits that follow each other are one. Spans of no length have no part.
    """
    if all(limits is spans[0][1] for _, limits in spans):
        return [(trajectory, spans[0][1])]
    found, begin, knots = [], 0, trajectory.knots
    for k, (end, limits) in enumerate(spans):
        if k + 1 < len(spans) and spans[k + 1][1] is limits:
            continue
        last = int(np.searchsorted(knots[:, 0], end)) if k + 1 < len(spans) else len(knots) - 1
        if last > begin:
            found.append((Trajectory.of_knots(knots[begin : last + 1].copy(), jumps=trajectory.jumps), limits))
        begin = last
    return found


def too_fast(
    scene: Scene, stage: Stage, step: int, ratios: FloatArray, limits: Limits, frame: str | None = None
) -> Refusal:
    """The refusal of rates whose `ratios` (3, n) to their limits are too large: the joint and the rate with the
    greatest; `frame`: which the tool tracks."""
    kind, joint = (int(k) for k in np.unravel_index(int(ratios.argmax()), ratios.shape))
    limit = float(limits.table[2 + kind, joint])
    what, value = scene.robot.joints[joint], float(ratios[kind, joint]) * limit
    obstacle = Obstacle.FRAME_TOO_FAST if frame else Obstacle.RATE
    return Refusal(
        stage=stage,
        reason=Reason.MOTION_LIMIT,
        step=step,
        subject=JointName(what.name),
        amount=of_joint(what.kind, value - limit, kind + 1),
        facts=MotionLimit(obstacle=obstacle, rate=RATES[kind], frame=frame, value=value, limit=limit),
    )


def _beyond(scene: Scene, stage: Stage, step: int, trajectory: Trajectory) -> Refusal:
    """The joint that is farthest beyond its limit of position for its range, and by how much."""
    limits, (low, high) = scene.robot.limits, trajectory.extrema(0)
    over = np.array([limits.lower - low, high - limits.upper])
    joint = int((over.max(0) / (limits.upper - limits.lower)).argmax())
    below, above = over[:, joint].tolist()
    what = scene.robot.joints[joint]
    return Refusal(
        stage=stage,
        reason=Reason.JOINT_LIMIT,
        step=step,
        subject=JointName(what.name),
        interval=(trajectory.start, trajectory.end),
        amount=of_joint(what.kind, max(below, above)),
        facts=beyond(scene, joint, float((low if below > above else high)[joint])),
    )


# How near a motion comes to singular positions: looked for at instants, more closely around each of the nearest.

AROUND, ROUNDS = 32, 4
"""Parts of the surroundings of an instant that is near, and how often they are parted: 1 ms to less than 1 ns."""
_PARTS = np.arange(AROUND + 1.0)
FINE_S = 0.001
"""Apart as a rule, s, are the instants at which all of a motion is evaluated."""
MOST_FINE = 100_000
"""So many of these times at most: where the arm moves for longer they are further apart. Where it rests there are none
beyond so many."""
Least = tuple[float, float]
"""A least margin, and when, s."""


def least_margins(robot: Robot, trajectory: Trajectory, t: FloatArray) -> tuple[Least, Least | None]:
    """Least singularity margin of a motion, and, of an arm with a loop, least parallel margin (None: it has none), from
    times t (T,) on, which are 1 ms apart as a rule: where the margin is smooth, or falls and rises again at one rate as
    it does where an arm passes through a singular position, it is then known to 1e-4. NaN where one is none."""
    parallel = _least(robot.parallel_margin, trajectory, t) if has_loop(robot) else None
    return _least(robot.margin, trajectory, t), parallel


def instants(trajectory: Trajectory) -> tuple[FloatArray, FloatArray]:
    """Times (T,), and for how long each counts (T,), s: `FINE_S` at most, in a motion that is not long."""
    count = math.ceil(trajectory.duration / FINE_S) + 1
    if count <= MOST_FINE:
        t = np.linspace(trajectory.start, trajectory.end, max(2, count))
        return t, np.full(len(t), t[1] - t[0])
    rates = np.asarray(np.concatenate([trajectory.qd, trajectory.qdd], axis=1).any(axis=1))
    spans = np.stack([trajectory.time[:-1], trajectory.time[1:]], 1)[rates[:-1] | rates[1:]]
    lengths = spans[:, 1] - spans[:, 0]
    apart = max(FINE_S, float(lengths.sum()) / MOST_FINE)
    counts = np.ceil(lengths / apart).astype(np.int64)
    within = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    even = within * np.repeat(lengths / counts, counts) + np.repeat(spans[:, 0], counts)
    return np.append(even, trajectory.time[-1]), np.append(np.repeat(lengths / counts, counts), 0.0)


def _least(margin: Callable[[FloatArray], FloatArray], trajectory: Trajectory, t: FloatArray) -> Least:
    found = margin(trajectory.evaluate(t))
    if not np.isfinite(found).all():
        return float("nan"), float(t[int(np.argmin(np.isfinite(found)))])
    return min(_around(margin, trajectory, t, k) for k in _lows(found))


def _lows(found: FloatArray) -> list[int]:
    """Instants around which the least of all may be: none beside one of them has less, and the least is no farther
    below it than it changes from there to the instants beside."""
    steps = found[1:] - found[:-1]
    falls, change, sizes = np.ones(len(found), dtype=bool), np.zeros(len(found)), np.abs(steps)
    falls[1:] = steps < 0.0
    falls[:-1] &= steps >= 0.0
    change[1:] = sizes
    np.maximum(change[:-1], sizes, out=change[:-1])
    return [int(k) for k in np.flatnonzero(falls & (found - change <= found.min()))]


def _around(margin: Callable[[FloatArray], FloatArray], trajectory: Trajectory, t: FloatArray, k: int) -> Least:
    for _ in range(ROUNDS):
        low, high = t[max(k - 1, 0)], t[min(k + 1, len(t) - 1)]
        t = _PARTS * ((high - low) / AROUND) + low  # as `linspace`, which takes five times as long
        t[-1] = high
        found = margin(trajectory.evaluate(t))
        k = int(np.argmin(found))  # of what is no number, the first
    return float(found[k]), float(t[k])


# How near an arm would be to a singular position, as facts of a refusal: serial and parallel apart.


@dataclass(frozen=True, slots=True)
class Near:
    """The singularity that is nearest, by `reason`; its `margin` (no unit), `missing` too small.

    `row`: where.
    """

    reason: Reason
    margin: float
    missing: float
    row: int

    def refusal(
        self,
        stage: Stage,
        step: int,
        interval: tuple[float, float],
        *,
        mode: str | None = None,
        distance_m: float | None = None,
        positions: tuple[str, ...] = (),
    ) -> Refusal:
        """The refusal at a stage and step; the rest as in `Singular`."""
        margin, required = finite(self.margin), finite(self.margin + self.missing)
        return Refusal(
            stage=stage,
            reason=self.reason,
            step=step,
            interval=interval,
            amount=Quantity.of(self.missing, "1"),
            facts=Singular(margin=margin, required=required, mode=mode, positions=positions, distance_m=distance_m),
        )


class Margins(NamedTuple):
    """Code and margins of postures, (N,), as `Inverse` has them."""

    code: IntArray
    margin: FloatArray
    parallel: FloatArray | None


def nearest(robot: Robot, found: Inverse | Margins, least: float, rows: IntArray, *, best: bool) -> Near:
    """The margin that is short by most in the row of `rows` that is best (or worst) in this; NaN is no margin.

    The parallel margin must be `least` and the robot's own `parallel_least`, whichever is more.
    """
    need = max(least, robot.parallel_least)
    serial = least - found.margin[rows]
    parallel = np.full(len(rows), -np.inf) if found.parallel is None else need - found.parallel[rows]
    short: FloatArray = np.fmax(serial, parallel)
    at = int(np.nanargmin(short) if best else np.nanargmax(short))
    if parallel[at] >= serial[at] or (found.code[rows[at]] == Code.PARALLEL):
        return Near(Reason.NEAR_PARALLEL_SINGULARITY, need - float(parallel[at]), float(parallel[at]), int(rows[at]))
    return Near(Reason.NEAR_SINGULARITY, float(found.margin[rows[at]]), float(serial[at]), int(rows[at]))


def too_near(scene: Scene, stage: Stage, step: int, trajectory: Trajectory, t0: float, t1: float) -> Refusal | None:
    """Whether the arm comes nearer to a singular position than `singularity_margin` over [t0, t1] of a motion."""
    least, robot = scene.options.singularity_margin, scene.robot
    if not (least > 0.0 and t1 > t0):
        return None
    t, _ = instants(trajectory)
    t = np.concatenate([[t0], t[(t0 < t) & (t < t1)], [t1]])
    q = trajectory.evaluate(t)
    margin, parallel = robot.margin(q), robot.parallel_margin(q) if robot.parallel_least > 0.0 else None
    kept = margin >= least if parallel is None else (margin >= least) & (parallel >= least)
    if kept.all():
        return None
    rows = np.flatnonzero(~kept)
    near = nearest(robot, Margins(robot.singularity(q), margin, parallel), least, rows, best=False)
    return near.refusal(stage, step, (float(t[rows[0]]), float(t[rows[-1]])))
