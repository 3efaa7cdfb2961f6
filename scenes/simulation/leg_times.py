"""How long the legs of a run take, by what they are for, and which limits bind them."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping
from itertools import product
from typing import TYPE_CHECKING, Any

from assur.planner.model.outcome import LegKind
from assur.planner.model.task import key_of

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

    def add_leg(self, kind: LegKind, step: str, is_last: bool, time_s: float, bound: str = "") -> None:
        """Adds a leg of a step of a kind, which may be the last of its motion; `bound`: the limit that binds it."""
        name = f"{WORDS[kind]} {ENDS['refuge'] if is_last else ENDS.get(step, ENDS[''])}"
        self.add(name, time_s, binds={bound: 1} if bound else None)

    def add_plan(self, plan: LoggedPlan) -> None:
        """Adds the legs of a plan of a log as far as they were executed."""
        for leg, step, is_last in plan.legs():
            self.add_leg(LegKind(leg["kind"]), step, is_last, leg["to_s"] - leg["from_s"])

    def add_segment(self, segment: Segment, until_s: float) -> None:
        """Adds the legs of a motion that was executed until a time, s, and the limits that bind its travels."""
        task, limits = segment.cell.scene.task, _binding_limits(segment, until_s)
        for leg in segment.legs:
            if leg.t0 < until_s:
                step, lasts_s = key_of(task[leg.step]), min(leg.t1, until_s) - leg.t0
                self.add_leg(leg.kind, step, leg.step == len(task) - 1, lasts_s, limits.get(leg.t0, ""))

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
    from assur.planner.report.notes import binding_limit

    travels = [each for each in segment.of_legs[0] if each.kind in TRAVELS and each.t0 < each.t1 <= until_s]
    return {each.t0: binding_limit(segment.cell.scene, segment.motion, each) for each in travels}
