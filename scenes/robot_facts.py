"""The numbers of an arm as its document has them, each with its unit, status and source: for lists, and for an
answer's assumptions. No robot is built."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from assur.scenes.faults import written_key
from assur.scenes.schema.robots import Family
from assur.scenes.schema.stated import SURE
from assur.scenes.units import any_unit, from_si

Written = dict[str, Any]
"""A mapping of a valid document, as it was written."""

LENGTHS = {
    "separation_m": "distance of the crank axes",
    "proximal_m": "length of link 1",
    "distal_m": "length of link 2",
    "l1_m": "length of link 1",
    "l2_m": "length of link 2",
    "l3_m": "length of the hand",
    "height_m": "height of the shoulder",
    "base_offset_m": "place of the base axis",
}
"""Lengths of an arm of any family, by field, and what an assumption calls them."""
LOADS = {
    "rated_load_kg": "rated load",
    "max_load_kg": "maximum load",
    "max_inertia_kgm2": "maximum inertia",
    "acceleration_by_load": "acceleration by load",
}
"""What an arm may carry, by field, and what an assumption calls it."""
RATES = {"velocity": "_s", "acceleration": "_s2", "jerk": "_s3"}
SIZES = {
    "box": ("size_m",),
    "sphere": ("radius_m",),
    "cylinder": ("radius_m", "height_m"),
    "capsule": ("radius_m", "length_m"),
    "mesh": (),
}
"""Which fields of a shape are its size: full edges of a box."""
OWN = "the robot's data are the request's own"


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number, or several that belong together, in the unit in which it was written. `status` and `source` are None if
    the document states no source."""

    value: Any
    unit: str
    status: str | None = None
    source: str | None = None

    def plain(self) -> dict[str, Any]:
        """The quantity as plain data."""
        return {"value": self.value, "unit": self.unit, "status": self.status, "source": self.source}

    def part(self, index: int) -> Quantity:
        """One of several numbers."""
        return Quantity(self.value[index], self.unit, self.status, self.source)


def assumptions(family: Family, arm: Written) -> tuple[str, ...]:
    """A sentence for each number that is not the maker's own word, and one for those without a status."""
    if not any(isinstance(value, dict) for mapping in (arm, *arm["joints"]) for value in mapping.values()):
        return (OWN,)  # the mappings of an arm and its joints are the facts that are stated; here is none
    name = name_of(family, arm)
    numbers = list(_numbers(arm))
    found = [
        f"{name}: {what} {_plainly(number.value)} {_plain_unit(number.unit)}, {number.status}: {number.source}"
        for what, number in numbers
        if number.status is not None and number.status not in SURE
    ]
    solids = quantity(arm, "bodies")
    if solids.value:
        numbers.append(("solids", solids))
        if solids.status is not None and solids.status not in SURE:
            each = "; ".join(_solid_in_words(solid) for solid in map(_solid, solids.value))
            found.append(f"{name}: solids in mm, {solids.status}: {solids.source}: {each}")
    if any(number.status is None for _, number in numbers):
        found.append(f"{name}: numbers without a status are the request's own")
    return tuple(found)


def listed(family: Family, arm: Written) -> dict[str, Any]:
    """The arm as plain data, each number with unit, status and source."""
    solids = quantity(arm, "bodies")
    found: dict[str, Any] = {
        "model": name_of(family, arm),
        "title": arm.get("title", ""),
        "family": family,
        **{field.removesuffix("_m"): number.plain() for field, number in _lengths(arm)},
        "joints": [_joint(joint) for joint in arm["joints"]],
        "solids": {
            "status": solids.status,
            "source": solids.source,
            "unit": "mm",
            "each": [_solid(solid) for solid in solids.value],
        },
        "self_pairs": [list(pair) for pair in arm["self_pairs"]],
        "assumptions": list(assumptions(family, arm)),
    }
    for key in ("maker", "about"):
        if key in arm:
            found[key] = " ".join(arm[key].split())
    for field in LOADS:
        if field in arm:
            found[field.removesuffix("_kg").removesuffix("_kgm2")] = quantity(arm, field).plain()
    return found


def name_of(family: Family, arm: Written) -> str:
    """What the arm is called."""
    return str(arm.get("name", unnamed(family)))


def unnamed(family: Family) -> str:
    """What an arm without a name is called."""
    return "inline-" + family.replace("_", "-")


def quantity(mapping: Written, field: str) -> Quantity:
    """The quantity of an SI field that `mapping` has, in whichever unit, plain or stated."""
    key = written_key(mapping, field) or field
    unit = any_unit(key) or ("kg, 1" if field == "acceleration_by_load" else key.rpartition("_")[2])
    given = mapping[key]
    if isinstance(given, dict):
        return Quantity(_rows(given["value"]), unit, given["status"], given["source"])
    return Quantity(_rows(given), unit)


def _rows(value: Any) -> Any:
    """A table of shares by mass as its numbers, row by row; anything else as it is."""
    if isinstance(value, list) and value and isinstance(value[0], dict) and "share" in value[0]:
        return [number for row in value for number in (row["mass_kg"], row["share"])]
    return value


def _lengths(arm: Written) -> Iterator[tuple[str, Quantity]]:
    return ((field, quantity(arm, field)) for field in LENGTHS if written_key(arm, field) is not None)


def _numbers(arm: Written) -> Iterator[tuple[str, Quantity]]:
    """Every number that a plan depends on, with what it is of, in words."""
    for field, number in _lengths(arm):
        planar = field == "height_m" and written_key(arm, "separation_m") is not None
        yield "height of the flange" if planar else LENGTHS[field], number
    for field, word in LOADS.items():
        if field in arm:
            yield word, quantity(arm, field)
    for joint in arm["joints"]:
        for field, number in _of_joint(joint):
            yield f"{joint['name']} {WORDS.get(field, field)}", number


WORDS = {
    "lower": "lower end of its range",
    "upper": "upper end of its range",
    "zero": "height at its zero",
    "zero_angle": "angle at its zero",
}


def _of_joint(joint: Written) -> Iterator[tuple[str, Quantity]]:
    unit = "rad" if _turns(joint) else "m"
    ends = quantity(joint, f"range_{unit}")
    yield "lower", ends.part(0)
    yield "upper", ends.part(1)
    for field, rate in RATES.items():
        yield field, quantity(joint, f"{field}_{unit}{rate}")
    for field in ("zero_m", "zero_rad"):
        if written_key(joint, field) is not None:
            yield "zero" if field == "zero_m" else "zero_angle", quantity(joint, field)


def _turns(joint: Written) -> bool:
    return written_key(joint, "range_rad") is not None


def _joint(joint: Written) -> dict[str, Any]:
    kind = "revolute" if _turns(joint) else "prismatic"
    numbers = {field: number.plain() for field, number in _of_joint(joint)}
    return {"name": joint["name"], "kind": kind, "sign": joint.get("sign", 1), **numbers}


def _solid(body: Written) -> dict[str, Any]:
    """A solid with its size and place in mm."""
    ((shape, sizes),) = body["shape"].items()
    size = [number for field in SIZES[shape] for number in _in_mm(sizes, field)]
    return {"name": body["name"], "link": body["link"], "shape": shape, "size": size, "at": _in_mm(body, "at_m")}


def _in_mm(mapping: Written, field: str) -> list[float]:
    number = quantity(mapping, field)
    values = number.value if isinstance(number.value, list) else [number.value]
    return [from_si(value, "mm") if number.unit == "m" else value for value in values]


def _solid_in_words(solid: dict[str, Any]) -> str:
    size = " x ".join(f"{x:g}" for x in solid["size"])
    return " ".join((solid["name"], solid["shape"], *([size] if size else ()), "at", _plainly(solid["at"])))


def _plainly(value: Any) -> str:
    """A number, or several; a number that is the same on both sides is stated once."""
    if not isinstance(value, list):
        return f"{value:g}"
    same = len(value) == 2 and value[0] == value[1]
    return ", ".join(f"{x:g}" for x in (value[:1] if same else value))


def _plain_unit(unit: str) -> str:
    """deg_s2 → deg/s^2, for people."""
    head, _, rest = unit.partition("_")
    return head + (f"/{rest[0]}" + (f"^{rest[1:]}" if len(rest) > 1 else "") if rest else "")
