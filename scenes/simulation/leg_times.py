"""How long the legs of a run take, by what they are for, and which limits bind them."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping
from itertools import product
from typing import TYPE_CHECKING, Any

from assur.planner.model.outcome import LegKind

if TYPE_CHECKING:
    from assur.scenes.session.committed import Segment
    from assur.scenes.session.executed import LoggedPlan

Document = dict[str, Any]
TRAVELS = (LegKind.MOVE, LegKind.ARCH)
WORDS = {
    LegKind.MOVE: "travel to the",
    LegKind.ARCH: "travel to the",
    LegKind.WAIT: "wait on the way to the",
    LegKind.APPROACH: "approach of the",
    LegKind.FOLLOW: "dwell at the",
    LegKind.DEPART: "depart from the",
}
ENDS = {"pick": "part", "place": "slot", "": "point", "refuge": "refuge"}
"""What the legs of a step lead to, by the kind of the step; those of the last step of a motion lead to the refuge."""
NAMES = tuple(f"{words} {end}" for end, words in product(ENDS.values(), dict.fromkeys(WORDS.values())))
"""All legs, in the order in which they are reported."""


class LegTimes:
    """Counts legs by their names: how many, how long, s, and how often each limit binds one."""

    def __init__(self) -> None:
        self._counts = Counter[str]()
        self._times: dict[str, float] = defaultdict(float)
        self._binds: dict[str, Counter[str]] = defaultdict(Counter)

    def add(self, name: str, time_s: float, count: int = 1, binds: Mapping[str, int] | None = None) -> None:
        """Adds legs that take so long together."""
        self._counts[name] += count
        self._times[name] += time_s
        self._binds[name].update(binds or {})

    def add_plan(self, plan: LoggedPlan, segment: Segment | None = None) -> None:
        """Adds the legs of a plan as far as they were executed; which limits bind its travels is known of a segment."""
        limits = {} if segment is None else _binding_limits(segment, plan.until_s)
        for leg, step, is_last in plan.legs():
            name = f"{WORDS[LegKind(leg['kind'])]} {ENDS['refuge'] if is_last else ENDS.get(step, ENDS[''])}"
            bound = limits.get(leg["from_s"], "")
            self.add(name, leg["to_s"] - leg["from_s"], binds={bound: 1} if bound else None)

    def rows(self, lasts_s: float) -> list[Document]:
        """For each kind of leg that there was: its name, how many, mean time, s, the share of the time `lasts_s`, and
        how many each limit binds, the most frequent first."""
        return [
            {
                "leg": name,
                "count": self._counts[name],
                "mean_s": self._times[name] / self._counts[name],
                "share": self._times[name] / lasts_s,
                "binds": dict(self._binds[name].most_common()),
            }
            for name in NAMES
            if self._counts[name]
        ]


def of_runs(runs: Iterable[Document], lasts_s: float) -> list[Document]:
    """The rows of several runs together, which last so long."""
    found = LegTimes()
    for row in (row for run in runs for row in run["legs"]):
        found.add(row["leg"], row["count"] * row["mean_s"], row["count"], row["binds"])
    return found.rows(lasts_s)


def _binding_limits(segment: Segment, until_s: float) -> dict[float, str]:
    """The limit that binds each travel that was executed to its end, by the time at which it begins."""
    from assur.planner.model.phases import leg_phases
    from assur.planner.report.notes import binding_limit

    phases, _, _ = leg_phases(segment.cell.scene, segment.legs, segment.arrivals)
    travels = [each for each in phases if each.kind in TRAVELS and each.t0 < each.t1 <= until_s]
    return {each.t0: binding_limit(segment.cell.scene, segment.motion, each) for each in travels}
