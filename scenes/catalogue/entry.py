"""What a catalogue says of an arm, number by number, each with its source and status."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Literal

Status = Literal["vendor", "vendor_config", "third_party", "disputed", "defined", "estimated"]
"""Whose word a number is.

vendor         the maker's own data
vendor_config  from a configuration file of the maker's, where it may be a placeholder
third_party    second hand
disputed       second hand, and sources differ
defined        exact, because the arm exists only in the document that defines it
estimated      ours; plausible, measured by nobody
"""
SURE: frozenset[Status] = frozenset({"vendor", "defined"})
"""Statuses that need no mention among a plan's assumptions."""

LinkName = Literal[
    "base",
    "link1",
    "link2",
    "link3",
    "link4",
    "quill",
    "flange",
    "proximal-left",
    "distal-left",
    "proximal-right",
    "distal-right",
]
Family = Literal["scara", "elbow_arm", "polar_arm", "five_axis_arm", "five_bar"]


@dataclass(frozen=True, slots=True)
class Number:
    """A number in the unit in which its source gives it (a suffix of our keys: deg_s, mm, rad_s2)."""

    value: float
    unit: str
    status: Status
    source: str


@dataclass(frozen=True, slots=True)
class Axis:
    """A joint as its maker sees it: name, which way it counts, range, limits.

    `sign` -1: it counts against the planner's direction (turning left, lifting). `zero`: of a lifting joint, the height
    of the flange above the mounting face at the maker's zero.
    """

    name: str
    kind: Literal["revolute", "prismatic"]
    lower: Number
    upper: Number
    velocity: Number
    acceleration: Number
    jerk: Number
    sign: Literal[1, -1] = 1
    zero: Number | None = None


@dataclass(frozen=True, slots=True)
class Solid:
    """A solid of the arm: a box (full edges) or an upright cylinder (radius, height), mm, centred at `at`.

    `at` is in the link's frame. Of a SCARA: mounting face for base, that face's height at the axis for link1 and link2,
    the flange for quill and flange. Of an arm whose links tilt: mounting face for base, shoulder for link1 and link2,
    elbow or end of the ram for link3, pitch axis of the wrist for link4, the flange for flange; x along the link.
    """

    name: str
    link: LinkName
    kind: Literal["box", "cylinder"]
    size: tuple[float, ...]
    at: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Entry:
    """An arm of the catalogue. Its axes are in the maker's order.

    `l1`, `l2`: lengths of a SCARA's links, or of an elbow arm's upper arm and forearm; `l3`: of a five-axis arm's hand,
    from the pitch axis to the tool point; `height`: of the shoulder of an arm whose links tilt, above the mounting
    face; `tool_frame`: which way the flange's z axis points.
    """

    model: str
    title: str
    axes: tuple[Axis, ...]
    solids: tuple[Solid, ...]
    solids_status: Status
    solids_source: str
    self_pairs: tuple[tuple[LinkName, LinkName], ...]
    payload: Number | None = None
    family: Family = "scara"
    l1: Number | None = None
    l2: Number | None = None
    l3: Number | None = None
    height: Number | None = None
    tool_frame: Literal["z_up", "z_down"] = "z_up"

    def lengths(self) -> Iterator[tuple[str, Number]]:
        """Its lengths, by field."""
        for name, number in (("l1", self.l1), ("l2", self.l2), ("l3", self.l3), ("height", self.height)):
            if number is not None:
                yield name, number

    def numbers(self) -> Iterator[tuple[str, Number]]:
        """Every number that a plan depends on (the payload is not one), with what it is of, in words."""
        for name, number in self.lengths():
            yield LENGTHS[name], number
        for axis in self.axes:
            for name in ("lower", "upper", "velocity", "acceleration", "jerk", "zero"):
                number = getattr(axis, name)
                if number is not None:
                    yield f"{axis.name} {WORDS.get(name, name)}", number

    def assumptions(self) -> tuple[str, ...]:
        """A sentence for each number that is not the maker's own word."""
        found = [
            f"{self.model}: {what} {number.value:g} {plain(number.unit)}, {number.status}: {number.source}"
            for what, number in self.numbers()
            if number.status not in SURE
        ]
        if self.solids and self.solids_status not in SURE:
            each = "; ".join(
                f"{s.name} {s.kind} {' x '.join(f'{x:g}' for x in s.size)} at {', '.join(f'{x:g}' for x in s.at)}"
                for s in self.solids
            )
            found.append(f"{self.model}: solids in mm, {self.solids_status}: {self.solids_source}: {each}")
        return tuple(found)


LENGTHS = {
    "separation": "distance of the crank axes",
    "l1": "length of link 1",
    "l2": "length of link 2",
    "l3": "length of the hand",
    "height": "height of the shoulder",
}


@dataclass(frozen=True, slots=True)
class FiveBarEntry(Entry):
    """A five-bar of the catalogue, the same on both sides: `l1` is the proximal length, `l2` the distal one."""

    family: Family = "five_bar"
    separation: Number = field(kw_only=True)

    def lengths(self) -> Iterator[tuple[str, Number]]:
        """Those of any arm, and the distance of the crank axes."""
        yield "separation", self.separation
        yield from Entry.lengths(self)


WORDS = {"lower": "lower end of its range", "upper": "upper end of its range", "zero": "height at its zero"}

STANDARD_PAIRS: tuple[tuple[LinkName, LinkName], ...] = (
    ("base", "link2"),
    ("base", "quill"),
    ("base", "flange"),
    ("link1", "quill"),
    ("link1", "flange"),
    ("link2", "flange"),
)
"""Links that can meet. Left out are those that are joined (base with link 1, link 1 with link 2, quill with flange) and
quill with link 2, through which it slides: they overlap by construction."""

TILTING_PAIRS: tuple[tuple[LinkName, LinkName], ...] = (
    ("base", "link3"),
    ("base", "flange"),
    ("link1", "link3"),
    ("link1", "flange"),
    ("link2", "flange"),
)
"""The same for arms whose links tilt: the turret carries link 2, link 2 carries link 3, link 3 the flange."""

WRIST_PAIRS: tuple[tuple[LinkName, LinkName], ...] = (
    *TILTING_PAIRS,
    ("base", "link4"),
    ("link1", "link4"),
    ("link2", "link4"),
    ("link3", "flange"),
)
"""The same for arms with a wrist: link 3 carries link 4, the hand, on which the flange rolls."""

JERK_TIME_S = 0.02
"""Time in which an arm is taken to build up its full acceleration, s, since no maker publishes a jerk."""


def jerk_of(acceleration: Number) -> Number:
    """The estimate of a jerk limit: the acceleration limit built up in 20 ms."""
    unit = acceleration.unit.removesuffix("2") + "3"
    value = float(f"{acceleration.value / JERK_TIME_S:.12g}")
    return Number(value, unit, "estimated", "acceleration / 20 ms, for no maker publishes it")


def plain(unit: str) -> str:
    """deg_s2 → deg/s^2, for people."""
    head, _, rest = unit.partition("_")
    return head + (f"/{rest[0]}" + (f"^{rest[1:]}" if len(rest) > 1 else "") if rest else "")
