"""Recorded motion of a joint: the errors of its readings, and its segments between rests."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from scipy.signal import savgol_filter

from assur.planner.arrays import FloatArray, frozen
from assur.planner.errors import InputError

LEAST_ROWS = 50
"""Fewest rows of a record: fewer contain no move between two rests."""
SMALLEST_STEP_S, LARGEST_STEP_S = 1e-5, 0.05
"""Allowed median distance of rows, s: 100 kHz to 20 Hz."""
MOST_GAP, LEAST_GAP = 4.0, 0.05
"""Largest and smallest distance of two rows, in medians: sampling may be irregular within this range."""
LEAST_REST_S, LEAST_REST_ROWS = 0.03, 6
"""Shortest rest, s and rows."""
REST_BAND, REST_EDGE = 2.5, 0.6
"""Width of a rest, in resolutions; and largest distance from its median at both ends, where a joint may creep."""
MOST_MOVES = 6
"""Most moves without a rest between them: they are fitted together."""
LEAST_MOVED = 20
"""Shortest move, in resolutions of the readings."""
SLOW = 0.08
"""Speed at which a move may end, as a part of the greatest speed of its segment."""
LEAST_DEVIATION = 1e-9
"""Least error of a reading, as a part of the joint's range in the record: files have nine or ten digits."""
SMALL_DIFFERENCES, LEAST_DIFFERENCES, MOST_STEPS, MOST_PARTS = 50, 8, 1000, 12
"""Largest and smallest number of differences of readings that determine the encoder's step, the smallest ones; their
largest ratio; and the most steps that the smallest difference may have."""
ROUNDED, ALIKE = 0.05, 0.9
"""Rounding of readings, as a part of a step, and the least mean cosine of phases that shows a step."""
MEAN_ROWS = (8, 16, 32)
"""Rows of a mean speed: few enough for short moves, enough for a coarse encoder."""
REACH_S = 0.1
"""Longest part of the rests before and after a segment that belongs to it, s; of each rest at most a half."""


@dataclass(frozen=True, eq=False)
class Segment:
    """Readings from one rest to the next.

    time, position (n,)  s and rad or m, from the first reading
    weight (n,)          1 / standard deviation of a reading
    speed (n,)           rad/s or m/s, roughly
    moved (k,)           rad or m, of each move in it with its sign; `begins`, `ends` (k,): s, roughly
    begin                s, in the record
    """

    time: FloatArray
    position: FloatArray
    weight: FloatArray
    speed: FloatArray
    moved: FloatArray
    begins: FloatArray
    ends: FloatArray
    begin: float

    @cached_property
    def step(self) -> float:
        """Usual distance of readings, s."""
        return float(np.median(np.diff(self.time)))


def fault_of_times(time: FloatArray) -> tuple[int, str] | None:
    """The first row whose time is not allowed, and which time is; None: all are allowed. `time` (n,), s, finite."""
    if len(time) < LEAST_ROWS:
        return len(time) - 1, f"a record of at least {LEAST_ROWS} rows; this is its last"
    gaps = np.diff(time)
    wrong = np.flatnonzero(~(gaps > 0))
    if len(wrong):
        return int(wrong[0]) + 1, f"later than the row before, at {time[wrong[0]]:.15g} s"
    usual = float(np.median(gaps))
    if not SMALLEST_STEP_S <= usual <= LARGEST_STEP_S:
        return 1, f"rows {SMALLEST_STEP_S:g} to {LARGEST_STEP_S:g} s apart; these are usually {usual:.3g} s apart"
    wrong = np.flatnonzero((gaps > MOST_GAP * usual) | (gaps < LEAST_GAP * usual))
    if len(wrong):
        near, far = LEAST_GAP * usual, MOST_GAP * usual
        return int(wrong[0]) + 1, f"{near:.3g} to {far:.3g} s after the row before ({usual:.3g} s is usual here)"
    return None


@dataclass(frozen=True, eq=False)
class JointRecord:
    """Readings of one joint: `time` (n,) in s, `position` (n,) in rad or m. Raises `InputError`."""

    time: FloatArray
    position: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "time", frozen(self.time, (None,), "time"))
        object.__setattr__(self, "position", frozen(self.position, (len(self.time),), "position"))
        fault = fault_of_times(self.time)
        if fault is not None:
            raise InputError(f"time[{fault[0]}]", float(self.time[fault[0]]) if len(self.time) else None, fault[1])

    @cached_property
    def step(self) -> float:
        """Usual distance of rows, s."""
        return float(np.median(np.diff(self.time)))

    @cached_property
    def encoder_step(self) -> float | None:
        """The step whose multiples all small differences of readings are, within rounding; None: there is none."""
        small = self.differences[self.differences <= MOST_STEPS * self.differences[:1]][:SMALL_DIFFERENCES]
        if len(small) < LEAST_DIFFERENCES:
            return None
        for parts in range(1, MOST_PARTS + 1):
            steps = small[0] / parts * np.linspace(1 - ROUNDED, 1 + ROUNDED, 2 * MOST_STEPS + 1)
            alike = np.cos(2 * np.pi * small[:, None] / steps).mean(axis=0)
            best = int(np.argmax(alike))
            if alike[best] > ALIKE:
                count = np.round(small / steps[best])
                return float(small @ count / (count @ count))
        return None

    @cached_property
    def differences(self) -> FloatArray:
        """Absolute differences of successive readings, sorted, each once, without those that are rounding."""
        extent, largest = float(np.ptp(self.position)), float(np.max(np.abs(self.position)))
        different = np.unique(np.abs(np.diff(self.position)))
        return different[different > LEAST_DEVIATION * extent + 8 * np.finfo(float).eps * largest]

    @cached_property
    def noise(self) -> float:
        """Standard deviation of a reading at the quietest tenth of the record, without that of its quantisation."""
        second = np.diff(self.position, 2)
        parts = second[: len(second) // 10 * 10].reshape(-1, 10)
        return float(np.quantile(np.sqrt(np.mean(parts**2, axis=1) / 6), 0.1))

    @cached_property
    def resolution(self) -> float:
        """Smaller differences of readings have no meaning, rad or m."""
        return max(self.encoder_step or 0.0, 4 * self.deviation)

    @cached_property
    def deviation(self) -> float:
        """Standard deviation of a reading, rad or m."""
        smallest = self.differences[:1].sum()  # of several steps, if the step is not known
        least = LEAST_DEVIATION * float(np.ptp(self.position))
        return max((self.encoder_step or float(smallest)) / math.sqrt(12), self.noise, least, 1e-15)

    @cached_property
    def speed(self) -> FloatArray:
        """Roughly, rad/s or m/s (n,)."""
        rate: FloatArray = savgol_filter(self.position, 7, 2, deriv=1) / savgol_filter(self.time, 7, 2, deriv=1)
        return rate

    def fastest(self) -> float:
        """The greatest mean speed over some rows, rad/s or m/s."""
        best = 0.0
        for rows in MEAN_ROWS:
            moved = np.abs(self.position[rows:] - self.position[:-rows]) - self.resolution
            best = max(best, float(np.max(moved / (self.time[rows:] - self.time[:-rows]))))
        return best

    def rests(self) -> list[tuple[int, int]]:
        """First and last row of each rest."""
        q, t, n = self.position.tolist(), self.time.tolist(), len(self.time)
        room, creep = REST_BAND * self.resolution, REST_EDGE * self.resolution
        rests, i = [], 0
        while i < n - 1:
            j, low, high = i, q[i], q[i]
            while j + 1 < n:
                low, high = min(low, q[j + 1]), max(high, q[j + 1])
                if high - low > room:
                    break
                j += 1
            if j - i >= LEAST_REST_ROWS and t[j] - t[i] >= LEAST_REST_S:
                middle, first, last = float(np.median(q[i : j + 1])), i, j
                while abs(q[first] - middle) > creep and first < last:
                    first += 1
                while abs(q[last] - middle) > creep and last > first:
                    last -= 1
                if last - first >= LEAST_REST_ROWS and t[last] - t[first] >= LEAST_REST_S:
                    rests.append((first, last))
                i = j
            i += 1
        return rests

    def segments(self, time_error: float = 0.0) -> list[Segment]:
        """The segments between rests. `time_error`: standard deviation of the times, s."""
        q, t, v = self.position, self.time, self.speed
        changes = np.flatnonzero(np.abs(np.diff(q)) > 0.5 * self.resolution)
        edges = np.concatenate([[0], changes + 1, [len(q)]])
        # readings that repeat share one error of quantisation
        repeated = np.repeat(np.diff(edges), np.diff(edges))
        weight = 1 / np.sqrt(self.deviation**2 * repeated + (time_error * v) ** 2)
        rests, segments = self.rests(), []
        for before, after in pairwise(rests):
            cuts = self._cuts(before[1], after[0])
            if cuts is None:
                continue
            first = np.searchsorted(t, t[before[1]] - min(REACH_S, (t[before[1]] - t[before[0]]) / 2))
            last = np.searchsorted(t, t[after[0]] + min(REACH_S, (t[after[1]] - t[after[0]]) / 2))
            rows = slice(int(first), int(last) + 1)
            cut = t[cuts] - t[first]
            segments.append(
                Segment(
                    time=t[rows] - t[first],
                    position=q[rows] - q[first],
                    weight=weight[rows],
                    speed=v[rows],
                    moved=np.diff(q[cuts]),
                    begins=cut[:-1],
                    ends=cut[1:],
                    begin=float(t[first]),
                )
            )
        return segments

    def _cuts(self, first: int, last: int) -> list[int] | None:
        """Rows at which the moves between two rests begin and end; None if there are none, or too many."""
        v, q = self.speed[first : last + 1], self.position[first : last + 1]
        slow = np.abs(v) < SLOW * np.max(np.abs(v))
        slow[1:] |= v[1:] * v[:-1] < 0
        edges = np.flatnonzero(np.diff(np.concatenate([[True], slow, [True]])))
        fast = [(a, b - 1) for a, b in zip(edges[::2], edges[1::2], strict=True)]
        fast = [(a, b) for a, b in fast if b - a > 3 and abs(q[b] - q[a]) > LEAST_MOVED * self.resolution]
        if not 0 < len(fast) <= MOST_MOVES:
            return None
        between = [b + int(np.argmin(np.abs(v[b : c + 1]))) for (_, b), (c, _) in pairwise(fast)]
        return [first, *(first + i for i in between), last]
