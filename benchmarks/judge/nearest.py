"""How near bodies come to each other in a plan, also between the sampled instants."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.judge.motion import Motion, Phase
from benchmarks.judge.poses import Floats, Poses
from benchmarks.judge.solids import Gap
from benchmarks.judge.stages import Pair

STEP_S = 4e-3
"""Time between two instants at which all pairs are evaluated."""
ROUNDS, PARTS = 4, 8
"""Number of refinements around a gap that is smaller than its neighbours, and of parts in each."""
RESERVE = 1.5
"""What a body may do between two instants, over the chord of its way between them."""

FAR_M = 1e3
"""In place of a gap that was not evaluated."""
FOUND_M = 3e-6
"""A gap that is less by no more than this is not searched, m: `coal` ends its search within a micrometre."""


@dataclass(frozen=True)
class NearPair:
    """A pair at its nearest in one phase: the gap, m, when, s, what it must keep, m, the kind of the phase, and whether
    the robot bears neither body."""

    pair: Pair
    gap_m: float
    time_s: float
    kind: str
    put_down: bool


def nearest_of(motion: Motion, beyond_m: float) -> list[NearPair]:
    """Each pair at its nearest in each phase, as far as it comes within `beyond_m` of what it must keep, or nearer than
    `beyond_m` to each other."""
    found: list[NearPair] = []
    for phase in motion.phases:
        found += _in_phase(motion, phase, beyond_m)
    return found


def _in_phase(motion: Motion, phase: Phase, beyond_m: float) -> list[NearPair]:
    t0, t1 = phase.stage.t0, phase.stage.t1
    grid = np.linspace(t0, t1, max(int(np.ceil((t1 - t0) / STEP_S)), 2) + 1)
    names = {name for pair in phase.pairs for name in (pair.first, pair.second)}
    places = motion.bodies(phase, grid, names)
    centres = {name: place.points(motion.shapes[name].inner.p) for name, place in places.items()}
    ways = {name: _way(places[name], centres[name], motion.shapes[name].radius) for name in names}
    found = []
    for pair in phase.pairs:
        one, other = motion.shapes[pair.first], motion.shapes[pair.second]
        apart = np.linalg.norm(centres[pair.first] - centres[pair.second], axis=-1) - one.radius - other.radius
        slack = RESERVE * (ways[pair.first] + ways[pair.second])
        limit = max(beyond_m, pair.required + beyond_m)
        near = np.flatnonzero(apart - slack < limit)
        if len(near) == 0:
            continue
        gap, values = Gap(one, other), np.full(len(grid), np.inf)
        values[near] = gap.among(places[pair.first], places[pair.second], near)
        best_k = int(np.argmin(values))
        best, when = float(values[best_k]), float(grid[best_k])
        for k in dips(values, slack, best):
            if values[k] - slack[k] > best - FOUND_M:
                continue
            low, high = grid[max(k - 1, 0)], grid[min(k + 1, len(grid) - 1)]
            value, time = _finer(motion, phase, pair, gap, float(low), float(high), best)
            if value < best:
                best, when = value, time
        if best < limit:
            found.append(NearPair(pair, best, when, phase.kind, phase.put_down(pair)))
    return found


def _way(place: Poses, centre: Floats, radius: float) -> Floats:
    """How far a body goes to the next or from the last instant, at most, about (T,), m."""
    shift = np.linalg.norm(np.diff(centre, axis=0), axis=-1)
    turn = np.linalg.norm(np.diff(place.r, axis=0), axis=(-2, -1)) / np.sqrt(2.0)
    step = shift + radius * turn
    return np.asarray(np.maximum(np.append(step, 0.0), np.append(0.0, step)))


def dips(values: Floats, slack: Floats, best: float) -> list[int]:
    """Instants beside which a gap may be below `best`; the ones that may be lowest first. Beside an instant whose gap
    is no larger than at the next ones, it falls no more than twice what it changes by to them. Beside any other it
    falls no more than half of that: there is a second dip then."""
    before, after = np.append(values[:1], values[:-1]), np.append(values[1:], values[-1:])
    known = np.isfinite(values)
    values = np.where(known, values, FAR_M)
    change = np.maximum(np.where(known, np.minimum(before, FAR_M) - values, 0.0), np.minimum(after, FAR_M) - values)
    share = np.where((values <= before) & (values <= after), 2.0, 0.5)
    lowest = values - np.minimum(slack, share * change)
    found = np.flatnonzero(known & (lowest < best - FOUND_M))
    return [int(k) for k in found[np.argsort(lowest[found])]]


def _finer(
    motion: Motion, phase: Phase, pair: Pair, gap: Gap, low: float, high: float, best: float
) -> tuple[float, float]:
    """The smallest gap between two instants, and when. The search ends early if it cannot come near `best`."""
    value, time, begin, end = np.inf, low, low, high
    for number in range(ROUNDS):
        grid = np.linspace(low, high, PARTS + 1)
        places = motion.bodies(phase, grid, {pair.first, pair.second})
        a, b = places[pair.first], places[pair.second]
        values = gap.among(a, b, np.arange(len(grid)))
        k = int(np.argmin(values))
        value, time = float(values[k]), float(grid[k])
        rough = float(np.abs(np.diff(values)).max())
        if number and value - rough > best - FOUND_M:
            break
        low, high = max(float(grid[max(k - 1, 0)]), begin), min(float(grid[min(k + 1, PARTS)]), end)
    return value, time
