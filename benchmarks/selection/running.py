"""A running cell by table times: one arm takes one part after the other, and a rule says which."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.selection import columns as c
from assur.planner.selection.columns import Times
from assur.planner.selection.next_part import DEPTH, PRICE, arm_after, scored
from assur.planner.selection.rules import FREE, IDLE, SCORE
from benchmarks.selection.cells import Stream


@dataclass(frozen=True, eq=False)
class Run:
    """When the cycle of each part ended (N,), s; NaN: it was missed. `decisions`: how often the rule was applied."""

    done: FloatArray
    decisions: int

    def each_minute(self, seconds: float) -> float:
        """Parts a minute within so many seconds."""
        return 60.0 * float((self.done <= seconds).sum()) / seconds


def run(
    times: Times,
    stream: Stream,
    rule: str,
    seconds: float,
    depth: int = DEPTH,
    price: float = PRICE,
    *,
    lazy: bool = True,
) -> Run:
    """The parts of a stream, taken until so many seconds have passed. `lazy`: where the arm has to wait for its part,
    and another one is seen meanwhile, it chooses anew."""
    done = np.full(len(stream.parts), np.nan)
    arm, pool, coming, decisions = _begin(times), list[int](), 0, 0
    while arm[c.ARM_TIME] < seconds:
        now = arm[c.ARM_TIME]
        while coming < len(stream.known) and stream.known[coming] <= now:
            pool.append(coming)
            coming += 1
        found = scored(times, arm, stream.parts[pool], rule, depth, price)
        can = np.isfinite(found[:, FREE])
        pool, found = [i for i, good in zip(pool, can.tolist(), strict=True) if good], found[can]
        if not pool:
            if coming == len(stream.known):
                break
            arm[c.ARM_TIME] = stream.known[coming]
            continue
        decisions += 1
        best = int(np.argmin(found[:, SCORE]))
        if lazy and coming < len(stream.known) and stream.known[coming] < now + found[best, IDLE]:
            arm[c.ARM_TIME] = stream.known[coming]
            continue
        chosen = pool.pop(best)
        arm = arm_after(times, arm, stream.parts[chosen])
        done[chosen] = arm[c.ARM_TIME]
    return Run(done, decisions)


def _begin(times: Times) -> FloatArray:
    """An arm that is free at the first place from 0 s on; of slots that pass the next one is the first that comes."""
    arm = np.zeros(c.ARM_SLOT + len(times.places))
    arm[c.ARM_WAY] = times.places[0, c.PLACE_BEGIN]
    for p, place in enumerate(times.places):
        if place[c.PLACE_PERIOD] > 0.0:
            arm[c.ARM_SLOT + p] = -np.floor(place[c.PLACE_LEAVES] / place[c.PLACE_PERIOD])
    return arm
