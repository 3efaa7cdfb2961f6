"""Warnings about implausible numbers of a description, with their value in the unit that was probably meant.

They are no refusals: an arm may be unusual. The bounds are several times beyond the arms on the market.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from assur.scenes.urdf.chain import Chain
from assur.scenes.urdf.limits import Limits, Number
from assur.scenes.urdf.tree import Solid

DEGREE = math.degrees(1.0)
MM = 1000.0
ODD = 100.0
"""A link that is so many times smaller or larger than the others is reported."""
NEAR = 30.0
"""A link of another unit is, in this one, within so many times of the others."""
MOST_TURNS = 3.0
"""An end of a range beyond so many turns: wrists are made for up to two."""


@dataclass(frozen=True, slots=True)
class UsualRange:
    """What is usual of a number, SI, and the unit that is mistaken for its own: so many of them are one of SI."""

    low: float
    high: float
    unit: str
    other: str
    per: float


TURNING = {
    "range": UsualRange(0.1, math.inf, "rad", "deg", DEGREE),
    "end": UsualRange(0.0, MOST_TURNS * math.tau, "rad", "deg", DEGREE),
    "velocity": UsualRange(0.02, 70.0, "rad/s", "deg/s", DEGREE),
    "acceleration": UsualRange(0.1, 5_000.0, "rad/s2", "deg/s2", DEGREE),
}
"""Of joints that turn. The fastest wrists reach 45 rad/s and 800 rad/s2."""
SLIDING = {
    "range": UsualRange(1e-3, 10.0, "m", "mm", MM),
    "end": UsualRange(0.0, 10.0, "m", "mm", MM),
    "velocity": UsualRange(1e-3, 20.0, "m/s", "mm/s", MM),
    "acceleration": UsualRange(1e-2, 300.0, "m/s2", "mm/s2", MM),
}
"""Of joints that slide. The fastest lifts reach 3 m/s and 60 m/s2."""
REACH = UsualRange(0.01, 20.0, "m", "mm", MM)
"""The sum of the distances from joint to joint."""


def implausible(chain: Chain, limits: Sequence[Limits], sizes: Mapping[str, float]) -> list[str]:
    """A warning for each number that no arm has. `sizes`: how large the collision shapes of each link are, m."""
    reach = sum(float(np.linalg.norm(joint.origin[:3, 3])) for joint in chain.tree.path(chain.base, chain.tip) or [])
    found = [
        f"the way along the joint origins from link {chain.base} to link {chain.tip} is {remark}"
        for remark in _unusual(reach, REACH)
    ]
    found += _odd_links(reach, sizes)
    for joint, each in zip(chain.joints, limits, strict=True):
        slides = joint.kind == "prismatic"
        table = SLIDING if slides else TURNING
        found += [
            f"joint {joint.name}: its range is {remark}" for remark in _odd_range(each.range, table, slides=slides)
        ]
        found += [
            f"joint {joint.name}: its {kind} is {remark} ({number.source})"
            for kind, number in (("velocity", each.velocity), ("acceleration", each.acceleration))
            for remark in _unusual(number.single, table[kind])
        ]
    return found


def _odd_links(reach: float, sizes: Mapping[str, float]) -> Iterator[str]:
    for link, size in sizes.items():
        usual = float(np.median([reach, *(other for name, other in sizes.items() if name != link)]))
        if not usual < ODD * size or not size < ODD * usual:
            factor = MM if size < usual else 1 / MM
            remark = f"link {link}: its collision shapes are {1e3 * size:.4g} mm large, and the rest of the arm "
            remark += f"{1e3 * usual:.4g} mm"
            if usual / NEAR <= factor * size <= usual * NEAR:
                remark += f"; with {factor:g} times the scale they are {1e3 * factor * size:.4g} mm"
            yield remark


def _odd_range(ends: Number, table: Mapping[str, UsualRange], *, slides: bool) -> Iterator[str]:
    lower, upper = ends.value if isinstance(ends.value, list) else (ends.value, ends.value)
    usual, far = table["end"], max(abs(lower), abs(upper)) > table["end"].high
    if not far and upper - lower >= table["range"].low:
        return
    factor = 1 / usual.per if far else usual.per
    cause = f"these are {usual.other}" if far else "these were converted twice"
    turns = "" if slides else f", {(upper - lower) / math.tau:.3g} turns"
    meant = f"{factor * lower:.6g} to {factor * upper:.6g} {usual.unit}"
    yield f"{lower:.6g} to {upper:.6g} {usual.unit}{turns}; if {cause}, it is {meant} ({ends.source})"


def _unusual(value: float, usual: UsualRange) -> Iterator[str]:
    """A number that is not usual, and what it is if it was written in the other unit, or converted twice."""
    if value > usual.high:
        yield f"{value:.6g} {usual.unit}; if these are {usual.other}, it is {value / usual.per:.6g} {usual.unit}"
    elif value < usual.low:
        yield f"{value:.6g} {usual.unit}; if it was converted twice, it is {value * usual.per:.6g} {usual.unit}"


def size_of(solid: Solid) -> float:
    """How large a primitive is along its longest side, m."""
    match solid.kind:
        case "box":
            return max(solid.sizes)
        case "sphere":
            return 2.0 * solid.sizes[0]
        case "cylinder":
            return max(2.0 * solid.sizes[0], solid.sizes[1])
        case _:
            return 2.0 * solid.sizes[0] + solid.sizes[1]
