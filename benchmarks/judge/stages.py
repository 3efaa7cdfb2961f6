"""What may touch what in each leg, and how far apart everything else must stay (docs/bundle.md, N8)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from benchmarks.judge.poses import Document

if TYPE_CHECKING:
    from benchmarks.judge.cell import Cell
    from benchmarks.judge.spline import Spline

CONTACT_M = 1e-4
TRACKING = ("APPROACH", "FOLLOW", "DEPART")


@dataclass(frozen=True)
class Pair:
    """Two bodies and the gap that they must keep, m: negative, as deep as they may touch (`contact`)."""

    first: str
    second: str
    required: float
    contact: bool = False

    @property
    def allowed(self) -> float:
        """How deep they may overlap, m."""
        return max(-self.required, 0.0)


@dataclass(frozen=True, eq=False)
class Stage:
    """A leg, or the standstill behind the last one: when, which pairs may touch and how deep, which arrivals are over
    in it, which step's part is gripped or released at its end, the supports of each part that was put down, and the
    parts that are taken away by then."""

    t0: float
    t1: float
    near: bool
    contacts: frozenset[frozenset[str]] = frozenset()
    deep_m: float = CONTACT_M
    arrivals: tuple[int, ...] = ()
    handed_over: int | None = None
    placed: dict[str, frozenset[str]] = field(default_factory=dict)
    gone: frozenset[str] = frozenset()


def stages(cell: Cell, answer: Document, spline: Spline) -> list[Stage]:
    """All legs in order, and the standstill for `stay_safe_s`."""
    found: list[Stage] = []
    placed: dict[str, frozenset[str]] = {}
    seats = {name: frame for name, (frame, _) in cell.seats.items()}
    poses = {name: pose for name, (_, pose) in cell.seats.items()}
    over: set[int] = set()
    released = set[int]()
    stands: dict[int, frozenset[str]] = {}
    for leg in answer["legs"]:
        number = leg["step"]
        away = gone(cell.request, answer, number, leg["from_s"])
        for part in away & seats.keys():
            del placed[part], seats[part]
        ((kind, given),) = cell.request["task"][number].items()
        arrivals = tuple(
            k
            for k, each in enumerate(answer["arrivals"])
            if each["step"] == number and k not in over and each["until_s"] <= leg["to_s"] + 1e-9
        )
        over |= set(arrivals)
        contacts, handed, deep = frozenset[frozenset[str]](), None, CONTACT_M
        tracking = leg["kind"] in TRACKING
        if tracking and "part" in given:
            part = given["part"]
            if number not in stands:
                until = next(each["until_s"] for each in answer["arrivals"] if each["step"] == number)
                frame, pose = (seats[part], poses[part]) if kind == "pick" else cell.seat(given["to"])
                named = cell.resting_on(part, frame, pose, given.get("contact_with"), until, seats, poses)
                # nothing is put on what will be taken away
                leaves = gone(cell.request, answer, number, math.inf) if "contact_with" not in given else frozenset()
                stands[number] = frozenset(named) - leaves
            grip = frozenset(frozenset((body, part)) for body in cell.tool_bodies)
            rest = frozenset(frozenset((body, part)) for body in stands[number])
            contacts = (
                (rest if number in released else grip) if kind == "pick" else (grip if number in released else rest)
            )
            deep += float(given.get("contact_tolerance_m", 0.0))
            if leg["kind"] == "FOLLOW":
                handed = number
        found.append(Stage(leg["from_s"], leg["to_s"], tracking, contacts, deep, arrivals, handed, dict(placed), away))
        if handed is not None:
            released.add(number)
            if kind == "place":
                placed[part] = stands[number]
                seats[part], poses[part] = cell.seat(given["to"])
            else:
                placed.pop(part, None)
                seats.pop(part, None)
    options = cell.request.get("options", {})
    stay, end = float(options.get("stay_safe_s", 0.0)), float(spline.time[-1])
    if options.get("end", "rest") == "rest" and stay > 0.0:
        away = gone(cell.request, answer, len(cell.request["task"]), end)
        there = {part: supports for part, supports in placed.items() if part not in away}
        found.append(Stage(end, end + stay, False, placed=there, gone=away))
    return found


def gone(request: Document, answer: Document, number: int, time: float) -> frozenset[str]:
    """The parts that are taken away by a time, of those that steps before step `number` put down. Who takes a part away
    comes so long after it was put down, and a robot may be late."""
    late = float(request.get("execution", {}).get("start_tolerance_s", 0.0))
    found = set()
    for arrival in answer["arrivals"]:
        given = request["task"][arrival["step"]].get("place", {})
        if arrival["step"] >= number or "gone_after_s" not in given:
            continue
        if arrival["until_s"] + float(given["gone_after_s"]) + late <= time:
            found.add(given["part"])
    return frozenset(found)


def clearance(request: Document, near: bool, first: str, second: str) -> float:
    """The distance that two bodies must keep, m: of the exceptions that name them the last one counts."""
    options, key = request.get("options", {}), "near" if near else "travel"
    found = float(options.get("clearance_m", {}).get(key, 0.0))
    for rule in options.get("clearance_exceptions", []):
        one, other = rule["between"], rule.get("and")
        for a, b in ((first, second), (second, first)):
            if a in one and (other is None or b in other):
                found = float(rule["clearance_m"][key])
    return found
