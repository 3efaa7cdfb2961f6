"""The plans of a log, each as far as it was executed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any

from assur.scenes.session.recorded import FIRST

Document = dict[str, Any]
OF_STEP = ("pick", "place", "move", "follow", "trace")
OF_ERROR = ("position_m", "yaw_rad")


def worst(errors: Iterable[Document]) -> Document:
    """Of errors of arrivals the largest distance, m, and the largest yaw, rad; 0 without any."""
    every = [*errors]
    return {key: max((each[key] for each in every), default=0.0) for key in OF_ERROR}


@dataclass(frozen=True, eq=False)
class LoggedPlan:
    """A plan of a log: request and answer; executed from `starts_s` until `until_s`, s."""

    request: Document
    answer: Document
    starts_s: float
    until_s: float

    def legs(self) -> Iterator[tuple[Document, str, bool]]:
        """The legs that were begun, the kind of the step of each, and whether it is on the way to the refuge."""
        last = len(self.request["task"]) - 1
        for leg in self.answer["legs"]:
            if leg["from_s"] < self.until_s:
                kind = next(key for key in OF_STEP if key in self.request["task"][leg["step"]])
                yield {**leg, "to_s": min(leg["to_s"], self.until_s)}, kind, leg["step"] == last

    def pick_error(self) -> Document:
        """The worst error of the parts that were gripped, as far as the proof allows one."""
        at_s = self.handled("pick")
        return worst(each["error"] for each in self.answer["arrivals"] if each["until_s"] in at_s and each.get("error"))

    def handled(self, kind: str) -> list[float]:
        """When parts were gripped (``pick``) or put down (``place``), s."""
        task = self.request["task"]
        arrivals = [each for each in self.answer["arrivals"] if kind in task[each["step"]]]
        return [each["until_s"] for each in arrivals if each["until_s"] <= self.until_s]


def executed_plans(events: Iterable[Document]) -> tuple[list[LoggedPlan], float]:
    """The plans of the calls of a log, in their order, and the last time of its clock, s."""
    plans, clock_s = list[LoggedPlan](), 0.0
    for event in events:
        if "refused" in event:
            continue
        clock_s, result = float(event["clock_s"]), event["result"]
        if event["call"] in (FIRST, "commit"):
            starts_s = float(result.get("starts_s", clock_s))
            plans = [each for each in plans if each.starts_s < starts_s]
            if plans:
                plans[-1] = replace(plans[-1], until_s=starts_s)
            plans.append(LoggedPlan(result["request"], result["answer"], starts_s, starts_s))
        elif event["call"] == "advance":
            clock_s = float(event["arguments"]["to_s"])
    plans = [each for each in plans if each.starts_s < clock_s]
    if plans:
        plans[-1] = replace(plans[-1], until_s=clock_s)
    return plans, clock_s
