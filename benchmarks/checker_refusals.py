"""What the checker refuses of what the planner has made: each is a failure, and its request is kept.

It is refused twice over: in a search (a line of the census of stage `checker`; another plan may come after it), or when
an answer is checked. Kinds that are known, and wait for other bounds, are counted by name.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from benchmarks.soak.arms import robot_file

Document = dict[str, Any]


@dataclass(frozen=True)
class Waiting:
    """A kind that is known: its name, and whether a refusal of this request (SI) with this code is one."""

    name: str
    applies: Callable[[Document, str], bool]


@dataclass(eq=False)
class Refused:
    """Answers with a plan that the checker refuses: how many that nobody knows why, and how many of each known kind."""

    unknown: int = 0
    waiting: Counter[str] = field(default_factory=Counter)

    def add(self, request: Document, codes: list[str]) -> bool:
        """Counts an answer of whose plans the checker refused some with these codes; whether a reason is unknown."""
        names = {code: known(request, code) for code in codes}
        self.waiting.update({name for name in names.values() if name is not None})
        unknown = any(name is None for name in names.values())
        self.unknown += unknown
        return unknown

    def merged(self, other: Refused) -> None:
        """Adds another one."""
        self.unknown += other.unknown
        self.waiting.update(other.waiting)

    def __str__(self) -> str:
        named = [f"{name}: {count}" for name, count in sorted(self.waiting.items())]
        return "; ".join([str(self.unknown), *named])


def _joints(request: Document) -> Iterator[Document]:
    """The joints of a robot that is in the request itself."""
    for arm in request.get("robot", {}).values():
        if isinstance(arm, dict):
            yield from arm.get("joints", ())


def _late_neighbour(request: Document, code: str) -> bool:
    late = request.get("start", {}).get("at_s", 0.0) >= LATE_S
    return code == "LAW_ENDS" and late and bool(request.get("neighbours"))


def _lags(request: Document, *families: str) -> bool:
    """Whether the joints of an arm of one of these families may lag."""
    robot = request.get("robot", {})
    named = robot_file(robot["model"]) if "model" in robot else robot
    return any(family in named for family in families) and bool(request.get("execution", {}).get("lag"))


def _lag_on_a_tilting_arm(request: Document, code: str) -> bool:
    return code in ("SEPARATION", "COVER") and _lags(request, *TILTING)


def _error_by_lag(request: Document, code: str) -> bool:
    return code == "ERROR" and _lags(request, "five_bar", *TILTING)


def _tiny_limits(request: Document, code: str) -> bool:
    limits = [value for joint in _joints(request) for key, value in joint.items() if key.startswith(RATES)]
    return code in ("CLAIM", "LIMIT") and min(limits, default=1.0) <= TINY


TILTING = ("elbow_arm", "polar_arm", "five_axis_arm")
LATE_S = 1e3
"""A start at this time or later, s: a neighbour's spline then rounds by more than is kept for it."""
TINY = 1e-3
"""Limits of a joint of this size or less, per s, s² or s³: rounding of peaks counts then."""
RATES = ("velocity", "acceleration", "jerk")
SECOND = "second checker"
"""In place of a code: the second checker refuses a bundle of which the first one accepts the plan."""
KNOWN = (
    Waiting("a neighbour and a late clock", _late_neighbour),
    Waiting("servo lag on an arm that tilts", _lag_on_a_tilting_arm),
    Waiting("the error of an arrival by servo lag", _error_by_lag),
    Waiting("tiny limits", _tiny_limits),
)
"""Kinds that wait for the bounds that replace those of today."""


def known(request: Document, code: str) -> str | None:
    """The name of the known kind that a refusal of a request (SI) with this code is of; None: it is of none."""
    return next((each.name for each in KNOWN if each.applies(request, code)), None)


def codes_of(answer: Document, findings: list[Document] | None) -> list[str]:
    """The codes with which the checker refused plans in the search of an answer, and the answer itself."""
    searched = said(answer, findings)["in_the_search"]
    return [str(each["facts"]["code"]) for each in searched] + [str(each["code"]) for each in findings or ()]


def said(answer: Document, findings: list[Document] | None) -> Document:
    """What the checker has against an answer, and against plans in its search."""
    lines = answer["census"]["lines"]
    return {"checker": findings, "in_the_search": [line for line in lines if line["stage"] == "checker"]}


def keep(folder: Path, name: str, request: Document, told: Document) -> Path:
    """Writes the request of a case that failed as a file that can be planned, and what went wrong beside it."""
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / f"{name.replace(', ', '-').replace(' ', '-').replace('/', '-')}.json"
    file.write_text(json.dumps(request, indent=1), encoding="utf-8")
    file.with_suffix(".faults.json").write_text(json.dumps(told, indent=1, default=float), encoding="utf-8")
    return file
