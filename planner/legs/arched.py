"""Arches: the lift joint goes up and down while the others go across, timed apart and laid over each other.

On a standard cycle of 25/300/25 mm, overlapping the corners takes half of the time that stopping at them does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from planner.arrays import FloatArray
from planner.timing import Settled, Sketch, TimingRefusal, combine, sketch_joints

JointState = tuple[FloatArray, FloatArray, FloatArray]
"""q, q̇, q̈, each (n,)."""
SPARE_S = 1e-12
"""A way across that is shorter than its time by more than this is timed again, s: before a moving end nothing can stand
still, and this is what counts as one time when profiles are combined."""


@dataclass(frozen=True, slots=True)
class Hop:
    """Over an arch: the lift joint goes to `top`, the other joints set out when `rise` of the way up (in time) is done
    and arrive when `fall` of the way down is left. 1: corners are stopped at; 0: full overlap."""

    top: float
    rise: float
    fall: float


Vertical = tuple[Sketch | Settled, Sketch | Settled]
"""The lift joint's way up and its way down."""


def vertical(
    start: JointState, goal: JointState, top: float, lift_joint: int, limits: tuple[FloatArray, FloatArray, FloatArray]
) -> Vertical | TimingRefusal:
    """The fastest ways of the lift joint from the start up to `top` and from there down to the goal."""
    lift, none, height = [lift_joint], np.zeros(1), np.array([top])
    (q0, qd0, qdd0), (q1, qd1, qdd1), (v, a, j) = start, goal, limits
    up = sketch_joints(q0[lift], qd0[lift], qdd0[lift], height, none, none, v[lift], a[lift], j[lift])
    if isinstance(up, TimingRefusal):
        return up
    down = sketch_joints(height, none, none, q1[lift], qd1[lift], qdd1[lift], v[lift], a[lift], j[lift])
    return down if isinstance(down, TimingRefusal) else (up, down)


def arch(
    start: JointState,
    goal: JointState,
    hop: Hop,
    lift_joint: int,
    limits: tuple[FloatArray, FloatArray, FloatArray],
    duration: float | None,
    ways: Vertical | TimingRefusal | None = None,
) -> Arched | TimingRefusal:
    """The arch from one joint state to another, the fastest or the one that takes `duration` seconds.

    The lift joint goes up and down, the others across, overlapping at the corners where both ends of the way across
    are at rest; at a moving end there is no time to spare, so the joints across fill it. `ways`: from `vertical`,
    where they are known already.
    """
    across = [i for i in range(len(start[0])) if i != lift_joint]
    v, a, j = limits
    (q0, qd0, qdd0), (q1, qd1, qdd1) = start, goal
    ways = vertical(start, goal, hop.top, lift_joint, limits) if ways is None else ways
    if isinstance(ways, TimingRefusal):
        return ways
    up, down = ways
    resting = not (start[1][across].any() or start[2][across].any())
    arriving = not (goal[1][across].any() or goal[2][across].any())
    before = hop.rise * up.duration if resting else 0.0
    after = hop.fall * down.duration if arriving else 0.0

    def across_in(seconds: float | None) -> Sketch | Settled | TimingRefusal:
        begin, end = (q0[across], qd0[across], qdd0[across]), (q1[across], qd1[across], qdd1[across])
        return sketch_joints(*begin, *end, v[across], a[across], j[across], seconds)

    flat = across_in(None)
    if isinstance(flat, TimingRefusal):
        return flat
    total = max(before + flat.duration + after, up.duration + down.duration)
    if duration is not None:
        if total > duration:
            return TimingRefusal("too short", total - duration, "the arch takes longer")
        total = duration
    if not resting or not arriving:
        # moving ends leave no time to spare at that end: the joints across fill it
        asked = total - before - after
        if asked > flat.duration + SPARE_S:
            flat = across_in(asked)
            if isinstance(flat, TimingRefusal):
                return flat
    return Arched(up, down, flat, before, total, lift_joint, across)


@dataclass(frozen=True, eq=False)
class Arched:
    """Three profiles laid over each other: lift up from 0, lift down to the end, the others from `before` on."""

    up: Sketch | Settled
    down: Sketch | Settled
    flat: Sketch | Settled
    before: float
    total: float
    lift: int
    across: list[int]

    @property
    def duration(self) -> float:
        return self.total

    def positions(self, t: FloatArray) -> FloatArray:
        """q (T, n) at times t (T,) from the beginning of the arch, the joints standing still before and after."""
        x = np.empty((len(t), len(self.across) + 1))
        x[:, self.across] = self.flat.positions(t - self.before)
        fall = self.total - self.down.duration
        x[:, self.lift] = np.where(
            t <= self.up.duration, self.up.positions(t)[:, 0], self.down.positions(t - fall)[:, 0]
        )
        return x

    def knots(self, offset: float) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Knots (time, q, q̇, q̈) at the switches of all three, for an arch that begins at `offset` s."""
        up, down, flat = self.up.profile, self.down.profile, self.flat.profile
        offsets = (0.0, self.total - down.duration, self.before)
        whole = combine((up, down, flat), offsets, self.total, ([self.lift], [self.lift], self.across))
        return whole.knots(offset)
