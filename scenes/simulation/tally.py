"""What happened in a run: cycles, waits, refusals; and the figures of it."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from assur.planner.model.outcome import Course, LegKind

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


class Tally:
    """Counts during a run. `missed_s`: each part, and when it leaves its window."""

    def __init__(self, missed_s: Sequence[tuple[str, float]]) -> None:
        self.missed_s = tuple(missed_s)
        self.cycles: list[Cycle] = []
        self.waits: list[tuple[float, str]] = []
        """When nothing could be begun, s, and why."""
        self.refusals: Counter[str] = Counter()
        self.examples: dict[str, str] = {}
        """The first refusal of each reason: when, and its sentence."""
        self.plans = self.checked = 0
        self._last: Segment | None = None
        self._within: dict[str, float] = defaultdict(float)

    def refused(self, reason: str, sentence: str, now_s: float) -> None:
        """A part could not be planned."""
        self.refusals[reason] += 1
        self.examples.setdefault(reason, f"at {now_s:.3f} s: {sentence}")

    def follows(self, segment: Segment) -> None:
        """A motion is committed: the one before is executed until it begins."""
        if self._last is not None:
            self._executed(self._last, segment.starts_s, self._within)
        self._last = segment

    def figures(self, now_s: float) -> dict[str, Any]:
        """The figures of the run until a time, s."""
        minutes = now_s / 60.0
        picked = {cycle.part for cycle in self.cycles if cycle.picked_s <= now_s}
        placed = [cycle for cycle in self.cycles if cycle.placed_s <= now_s]
        within = defaultdict(float, self._within)
        if self._last is not None:
            self._executed(self._last, now_s, within)
        idle = self._idle(now_s)
        waiting = {reason: idle[reason] + within[reason] for reason in WAITS}
        ended = [cycle.ends_s - cycle.starts_s for cycle in self.cycles if cycle.ends_s <= now_s]
        missed = sum(left_s <= now_s and name not in picked for name, left_s in self.missed_s)
        return {
            "simulated_s": now_s,
            "known": len(self.missed_s),
            "picked": len(picked),
            "placed": len(placed),
            "missed": missed,
            "parts_per_minute": len(placed) / minutes if minutes > 0.0 else 0.0,
            "cycle_s": sum(ended) / len(ended) if ended else None,
            "moving": 1.0 - sum(waiting.values()) / now_s if now_s > 0.0 else 0.0,
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
        k, reason = 0, "planning"
        for end_s, begin_s in zip(ends, begins, strict=True):
            at_s, until_s, reason = end_s, min(begin_s, now_s), "planning"
            while k < len(self.waits) and self.waits[k][0] < begin_s:
                wait_s, new = self.waits[k]
                if wait_s > at_s:
                    found[reason] += max(0.0, min(wait_s, until_s) - at_s)
                    at_s = wait_s
                reason, k = new, k + 1
            found[reason] += max(0.0, until_s - at_s)
        return found

    @staticmethod
    def _executed(segment: Segment, until_s: float, within: dict[str, float]) -> None:
        """Adds the time in which a motion waits on its way."""
        last = len(segment.cell.scene.task) - 1
        for leg in segment.legs:
            if leg.kind is LegKind.WAIT and leg.step != last:
                for_bodies = leg.route is not None and leg.route.course is Course.FOR_BODIES
                reason = "bodies" if for_bodies else "slot" if leg.step == PLACE else "part"
                within[reason] += max(0.0, min(leg.t1, until_s) - leg.t0)
