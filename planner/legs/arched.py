"""Arches: the lift joint goes up and down while the others go across, timed apart and laid over each other.

On a standard cycle of 25/300/25 mm, overlapping the corners takes half of the time that stopping at them does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.legs.pace import Pace, part
from assur.planner.timing import Numbers, Settled, Sketch, TimingRefusal, combine

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


def vertical(start: Numbers, goal: Numbers, top: float, pace: Pace) -> Vertical | TimingRefusal:
    """The fastest ways of the lift joint from the start up to `top` and from there down to the goal."""
    high = [top], [0.0], [0.0]
    up = pace.lifting.sketch(part(start, pace.lift), high)
    if isinstance(up, TimingRefusal):
        return up
    down = pace.lifting.sketch(high, part(goal, pace.lift))
    return down if isinstance(down, TimingRefusal) else (up, down)


def arch(
    start: Numbers,
    goal: Numbers,
    hop: Hop,
    pace: Pace,
    duration: float | None,
    ways: Vertical | TimingRefusal | None = None,
) -> Arched | TimingRefusal:
    """The arch from one joint state to another, the fastest or the one that takes `duration` seconds.

    The lift joint goes up and down, the others across, overlapping at the corners where both ends of the way across
    are at rest; at a moving end there is no time to spare, so the joints across fill it. `ways`: from `vertical`,
    where they are known already.
    """
    ways = vertical(start, goal, hop.top, pace) if ways is None else ways
    if isinstance(ways, TimingRefusal):
        return ways
    up, down = ways
    begin, end = part(start, pace.others), part(goal, pace.others)
    resting, arriving = (not (any(state[1]) or any(state[2])) for state in (begin, end))
    before = hop.rise * up.duration if resting else 0.0
    after = hop.fall * down.duration if arriving else 0.0
    flat = pace.across.sketch(begin, end)
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
            flat = pace.across.sketch(begin, end, asked)
            if isinstance(flat, TimingRefusal):
                return flat
    return Arched(up, down, flat, before, total, pace)


@dataclass(frozen=True, eq=False)
class Arched:
    """Three profiles laid over each other: lift up from 0, lift down to the end, the others from `before` on."""

    up: Sketch | Settled
    down: Sketch | Settled
    flat: Sketch | Settled
    before: float
    total: float
    pace: Pace

    @property
    def duration(self) -> float:
        return self.total

    def positions(self, t: FloatArray) -> FloatArray:
        """q (T, n) at times t (T,) from the beginning of the arch, the joints standing still before and after."""
        x = np.empty((len(t), len(self.pace.others) + len(self.pace.lift)))
        x[:, self.pace.others] = self.flat.positions(t - self.before)
        lifted, rising = x[:, self.pace.lift[0]], t <= self.up.duration
        lifted[rising] = self.up.positions(t[rising])[:, 0]
        lifted[~rising] = self.down.positions(t[~rising] - (self.total - self.down.duration))[:, 0]
        return x

    def knots(self, offset: float) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Knots (time, q, q̇, q̈) at the switches of all three, for an arch that begins at `offset` s."""
        up, down, flat = self.up.profile, self.down.profile, self.flat.profile
        offsets = (0.0, self.total - down.duration, self.before)
        whole = combine((up, down, flat), offsets, self.total, (self.pace.lift, self.pace.lift, self.pace.others))
        return whole.knots(offset)
