"""What happened in a run: cycles, waits, refusals; and the figures of it."""

from __future__ import annotations

import copy
from array import array
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from assur.planner.model.outcome import Course, LegKind
from assur.planner.model.task import key_of
from assur.scenes.session.executed import worst
from assur.scenes.simulation.leg_times import LegTimes

if TYPE_CHECKING:
    from assur.scenes.session.committed import Segment

WAITS = ("part", "slot", "unseen", "bodies", "reach", "refused", "planning")
"""What the arm waits for: a part; a free slot; a part that is still too near to what is not seen; bodies that have to
pass; a part within its reach; a plan, for none was possible; the end of planning."""
PLACE = 1
"""The step of a motion that puts the part down, behind the one that picks it."""


@dataclass(frozen=True)
class Cycle:
    """A part that was taken: its grid, its slot there, counted from 0; and when, s: begin, part gripped, part put
    down, end. `free_s`: when the next motion may begin."""

    part: str
    grid: str
    slot: int
    starts_s: float
    picked_s: float
    placed_s: float
    ends_s: float
    free_s: float


class Cycles:
    """Cycles in little memory: a run may have 100,000."""

    def __init__(self) -> None:
        self._parts, self._grids, self._slots, self._times = list[str](), list[str](), array("l"), array("d")

    def append(self, cycle: Cycle) -> None:
        self._parts.append(cycle.part)
        self._grids.append(cycle.grid)
        self._slots.append(cycle.slot)
        self._times.extend((cycle.starts_s, cycle.picked_s, cycle.placed_s, cycle.ends_s, cycle.free_s))

    def __len__(self) -> int:
        return len(self._parts)

    def __iter__(self) -> Iterator[Cycle]:
        for k, (part, grid, slot) in enumerate(zip(self._parts, self._grids, self._slots, strict=True)):
            yield Cycle(part, grid, slot, *self._times[OF_CYCLE * k : OF_CYCLE * (k + 1)])


OF_CYCLE = 5
"""Number of times of a cycle."""


class ExecutedMotions:
    """What the motions of a run came to, as far as they were executed: waits on their way, s, by what they are for;
    their legs; and the worst error of a pick that their proofs allow."""

    def __init__(self) -> None:
        self.waits: dict[str, float] = defaultdict(float)
        self.legs = LegTimes()
        self.worst_pick_error = worst(())

    def add(self, segment: Segment, until_s: float) -> None:
        """Adds a motion that was executed until a time, s."""
        task = segment.cell.scene.task
        for leg in segment.legs:
            if leg.kind is LegKind.WAIT and leg.step != len(task) - 1:
                for_bodies = leg.route is not None and leg.route.course is Course.FOR_BODIES
                reason = "bodies" if for_bodies else "slot" if leg.step == PLACE else "part"
                self.waits[reason] += max(0.0, min(leg.t1, until_s) - leg.t0)
        self.legs.add_segment(segment, until_s)
        for arrival in segment.arrivals:
            if arrival.until <= until_s and arrival.error and key_of(task[arrival.step]) == "pick":
                error = {"position_m": arrival.error.position_m, "yaw_rad": arrival.error.within.yaw_rad}
                self.worst_pick_error = worst((self.worst_pick_error, error))


class Tally:
    """Counts during a run. `missed_s`: each part, and when it leaves its window."""

    def __init__(self, missed_s: Sequence[tuple[str, float]]) -> None:
        self.missed_s = tuple(missed_s)
        self.cycles = Cycles()
        self._waits: tuple[array[float], list[str]] = array("d"), []
        """When nothing could be begun, s, and why."""
        self.refusals: Counter[str] = Counter()
        self.examples: dict[str, str] = {}
        """The first refusal of each reason: when, and its sentence."""
        self.known = self.plans = self.checked = 0
        self._last: Segment | None = None
        self._executed = ExecutedMotions()

    def refused(self, reason: str, sentence: str, now_s: float) -> None:
        """A part could not be planned."""
        self.refusals[reason] += 1
        self.examples.setdefault(reason, f"at {now_s:.3f} s: {sentence}")

    def waits(self, now_s: float, reason: str) -> None:
        """Nothing can be begun now."""
        self._waits[0].append(now_s)
        self._waits[1].append(reason)

    def follows(self, segment: Segment) -> None:
        """A motion is committed: the one before is executed until it begins."""
        if self._last is not None:
            self._executed.add(self._last, segment.starts_s)
        self._last = segment

    def figures(self, now_s: float) -> dict[str, Any]:
        """The figures of the run until a time, s."""
        minutes = now_s / 60.0
        picked = {cycle.part for cycle in self.cycles if cycle.picked_s <= now_s}
        placed = [cycle for cycle in self.cycles if cycle.placed_s <= now_s]
        executed = copy.deepcopy(self._executed)
        if self._last is not None:
            executed.add(self._last, now_s)
        idle = self._idle(now_s)
        waiting = {reason: idle[reason] + executed.waits[reason] for reason in WAITS}
        ended = [cycle.ends_s - cycle.starts_s for cycle in self.cycles if cycle.ends_s <= now_s]
        taken = {cycle.part for cycle in self.cycles}  # and one whose pick is committed is not missed
        missed = sum(left_s <= now_s and name not in taken for name, left_s in self.missed_s)
        return {
            "simulated_s": now_s,
            "first_placed_s": min([cycle.placed_s for cycle in placed], default=None),
            "known": self.known,
            "picked": len(picked),
            "placed": len(placed),
            "missed": missed,
            "remaining": self.known - len(picked) - missed,
            "parts_per_minute": len(placed) / minutes if minutes > 0.0 else 0.0,
            "cycle_s": sum(ended) / len(ended) if ended else None,
            "moving": 1.0 - sum(waiting.values()) / now_s if now_s > 0.0 else 0.0,
            "legs": executed.legs.rows(now_s) if now_s > 0.0 else [],
            "worst_pick_error": executed.worst_pick_error,
            "waiting_s": {reason: time_s for reason, time_s in waiting.items() if time_s > 0.0},
            "plans": self.plans,
            "checked": self.checked,
            "refusals": dict(sorted(self.refusals.items())),
            "examples": dict(sorted(self.examples.items())),
        }

    def _idle(self, now_s: float) -> dict[str, float]:
        """The time between two cycles, by what it is waited for."""
        found: dict[str, float] = defaultdict(float)
        ends = [0.0, *(cycle.ends_s for cycle in self.cycles)]
        begins = [*(cycle.starts_s for cycle in self.cycles), now_s]
        times_s, reasons = self._waits
        k, reason = 0, "planning"
        for end_s, begin_s in zip(ends, begins, strict=True):
            at_s, until_s, reason = end_s, min(begin_s, now_s), "planning"
            while k < len(times_s) and times_s[k] < begin_s:
                wait_s, new = times_s[k], reasons[k]
                if wait_s > at_s:
                    found[reason] += max(0.0, min(wait_s, until_s) - at_s)
                    at_s = wait_s
                reason, k = new, k + 1
            found[reason] += max(0.0, until_s - at_s)
        return found
