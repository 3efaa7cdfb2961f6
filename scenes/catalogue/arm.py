"""An arm ready for the planner: geometry, limits, bodies, and the maker's joint conventions.

The planner counts a lifting joint upwards from its base origin. That origin is put where the maker's zero is, so
maker's and planner's values differ by a sign at most, and converting a trajectory to the maker's convention and back is
exact in floating point: a plan that was written out and read again is the same plan, bit by bit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from planner.arrays import FloatArray, IntArray
from planner.frames.motion import Pose
from planner.robots import five_axis_arm, scara, vertical_plane
from planner.robots.elbow_arm import ElbowArm
from planner.robots.five_axis_arm import FiveAxisArm
from planner.robots.polar_arm import PolarArm
from planner.robots.protocol import Limits, Robot, RobotBody
from planner.robots.scara import Scara
from planner.shapes import AXES, Body, Piece, Primitive, box, cylinder
from scenes.catalogue.entry import Axis, Entry, Family, Number
from scenes.units import TWIN_UNITS, to_si

JointKind = Literal["revolute", "prismatic"]
SI_OF: dict[JointKind, str] = {"revolute": "rad", "prismatic": "m"}


@dataclass(frozen=True, slots=True)
class JointConvention:
    """How the maker counts a joint: planner's value = sign × maker's value, in rad or m; `place`: which joint it is in
    the planner's order (None: the same)."""

    name: str
    kind: JointKind
    sign: Literal[1, -1] = 1
    place: int | None = None

    @property
    def unit(self) -> str:
        return SI_OF[self.kind]


Conventions = tuple[JointConvention, ...]


def places(conventions: Conventions) -> IntArray:
    """Which of the planner's joints each of the maker's is, (n,)."""
    own = [i if joint.place is None else joint.place for i, joint in enumerate(conventions)]
    return np.array(own, dtype=np.int64)


def converted(values: FloatArray, conventions: Conventions) -> FloatArray:
    """Joint values (..., n) of the maker in the planner's order and convention."""
    turned = np.empty(values.shape)
    turned[..., places(conventions)] = values * _signs(conventions) + 0.0  # + 0.0: no negative zeros
    return turned


def as_maker(values: FloatArray, conventions: Conventions) -> FloatArray:
    """Joint values (..., n) of the planner in the maker's order and convention; exactly what `converted` undoes."""
    turned: FloatArray = values[..., places(conventions)] * _signs(conventions) + 0.0
    return turned


def _signs(conventions: Conventions) -> FloatArray:
    return np.array([float(joint.sign) for joint in conventions])


LINKS: dict[Family, tuple[str, ...]] = {
    "scara": scara.LINKS,
    "elbow_arm": vertical_plane.LINKS,
    "polar_arm": vertical_plane.LINKS,
    "five_axis_arm": five_axis_arm.LINKS,
}
"""Names of the link frames of each family, in order."""
AT_FLANGE = ("quill", "flange")
"""Links of a SCARA whose solids are given from the flange; those of the others are given from the mounting face."""


@dataclass(frozen=True, eq=False)
class Arm:
    """Everything about an arm that does not depend on where it stands. `zero_m`: the planner's base origin above the
    mounting face; `z_down`: the flange frame that requests speak of is turned by π about its x axis; limits and bodies
    are in the planner's order and frames."""

    name: str
    conventions: Conventions
    limits: Limits
    zero_m: float
    bodies: tuple[RobotBody, ...]
    self_pairs: tuple[tuple[str, str], ...]
    assumptions: tuple[str, ...]
    family: Family = "scara"
    l1: float = 0.0
    l2: float = 0.0
    l3: float = 0.0
    height: float = 0.0
    arms_rise: bool = False
    z_down: bool = False

    def robot(self, base: Pose, limits: Limits) -> Robot:
        """The planner's robot, its mounting face at `base` in the world."""
        order = np.argsort(places(self.conventions))
        names = tuple(self.conventions[int(i)].name for i in order)
        base = base.then(Pose(z=self.zero_m))
        if self.family == "scara":
            lengths = (self.l1, self.l2, len(self.conventions))
            return Scara(self.name, *lengths, limits, base, self.bodies, self.self_pairs, names, self.arms_rise)
        shared: dict[str, Any] = {
            "name": self.name,
            "height": self.height,
            "limits": limits,
            "base": base,
            "bodies": self.bodies,
            "self_pairs": self.self_pairs,
            "joint_names": names,
        }
        if self.family == "five_axis_arm":
            return FiveAxisArm(l1=self.l1, l2=self.l2, l3=self.l3, **shared)
        return PolarArm(**shared) if self.family == "polar_arm" else ElbowArm(l1=self.l1, l2=self.l2, **shared)


def order_of(kinds: Sequence[str]) -> tuple[tuple[int | None, ...], bool]:
    """Places of a SCARA's joints in the planner's order, and whether its lift carries the arms (R-P-R-R)."""
    if kinds[1] != "prismatic":
        return (None,) * len(kinds), False
    return (0, 2, 1, 3)[: len(kinds)], True


def limits_of(ranges: Sequence[tuple[float, float]], signs: Sequence[int], rates: Sequence[Sequence[float]]) -> Limits:
    """The planner's limits from the maker's ranges, and velocities, accelerations and jerks, all SI."""
    ends = [pair if sign > 0 else (-pair[1], -pair[0]) for pair, sign in zip(ranges, signs, strict=True)]
    lower, upper = np.array(ends).T + 0.0  # + 0.0: no negative zeros
    return Limits(lower, upper, *(np.array(rate) for rate in rates))


def attached(
    name: str, shape: Primitive, at: Sequence[float], yaw: float = 0.0, axis: Literal["x", "y", "z"] = "z"
) -> Body:
    """A body of one primitive at a pose in its carrier's frame; `axis`: along which the primitive's z lies."""
    c, s = np.cos(yaw), np.sin(yaw)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return Body(name, (Piece(shape, np.array(at), turn @ AXES[axis]),))


def si(number: Number) -> float:
    """A number of the catalogue in SI."""
    return float(to_si(number.value, number.unit)) if number.unit in TWIN_UNITS else float(number.value)  # type: ignore[arg-type]


def in_order(limits: Limits, conventions: Conventions) -> Limits:
    """Limits that are in the maker's order in the planner's."""
    order = np.argsort(places(conventions))
    return Limits(*(getattr(limits, name)[order] for name in LIMITS))


LIMITS = ("lower", "upper", "velocity", "acceleration", "jerk")


def arm_of(entry: Entry) -> Arm:
    """The arm of a catalogue entry."""
    kinds, rise, zero = [axis.kind for axis in entry.axes], False, 0.0
    own: tuple[int | None, ...] = (None,) * len(kinds)
    if entry.family == "scara":
        own, rise = order_of(kinds)
        lift = entry.axes[kinds.index("prismatic")]
        zero = 0.0 if lift.zero is None else si(lift.zero)
    bodies = []
    for solid in entry.solids:
        size = [x / 1000 for x in solid.size]
        lower = 0.0 if solid.link in AT_FLANGE else zero
        at = (solid.at[0] / 1000, solid.at[1] / 1000, solid.at[2] / 1000 - lower)
        shape = box(*size) if solid.kind == "box" else cylinder(*size)
        bodies.append(RobotBody(attached(solid.name, shape, at), LINKS[entry.family].index(solid.link)))
    conventions = tuple(
        JointConvention(axis.name, axis.kind, axis.sign, place) for axis, place in zip(entry.axes, own, strict=True)
    )
    return Arm(
        name=entry.model,
        conventions=conventions,
        limits=in_order(_limits(entry.axes), conventions),
        zero_m=zero,
        bodies=tuple(bodies),
        self_pairs=entry.self_pairs,
        assumptions=entry.assumptions(),
        family=entry.family,
        arms_rise=rise,
        z_down=entry.tool_frame == "z_down",
        **{name: si(number) for name, number in entry.lengths()},
    )


def _limits(axes: tuple[Axis, ...]) -> Limits:
    return limits_of(
        [(si(axis.lower), si(axis.upper)) for axis in axes],
        [axis.sign for axis in axes],
        [[si(getattr(axis, name)) for axis in axes] for name in ("velocity", "acceleration", "jerk")],
    )
