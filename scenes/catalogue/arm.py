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

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.frames.motion import Pose
from assur.planner.robots import five_axis_arm, five_bar_links, scara, vertical_plane
from assur.planner.robots.elbow_arm import ElbowArm
from assur.planner.robots.five_axis_arm import FiveAxisArm
from assur.planner.robots.five_bar import FiveBar
from assur.planner.robots.polar_arm import PolarArm
from assur.planner.robots.protocol import Limits, Robot, RobotBody
from assur.planner.robots.scara import Scara
from assur.scenes.catalogue.entry import Family

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


WITH_QUILL: tuple[Family, ...] = ("scara", "five_bar")
"""Families whose flange is lifted by a quill, or by nothing."""
LINKS: dict[Family, tuple[str, ...]] = {
    "scara": scara.LINKS,
    "elbow_arm": vertical_plane.LINKS,
    "polar_arm": vertical_plane.LINKS,
    "five_bar": five_bar_links.LINKS,
    "five_axis_arm": five_axis_arm.LINKS,
}
"""Names of the link frames of each family, in order."""
AT_FLANGE = ("quill", "flange")
"""Links of families with a quill whose solids are given from the flange; those of the other links are given from the
mounting face."""


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


@dataclass(frozen=True, eq=False, kw_only=True)
class FiveBarArm(Arm):
    """A five-bar: distance of the crank axes, lengths left and right, m; its assembly and least parallel margin."""

    separation: float
    proximal: tuple[float, float]
    distal: tuple[float, float]
    assembly: str
    parallel_least: float

    def robot(self, base: Pose, limits: Limits) -> FiveBar:
        return FiveBar(
            name=self.name,
            separation=self.separation,
            proximal=self.proximal,
            distal=self.distal,
            axes=len(self.conventions),
            limits=limits,
            base=base.then(Pose(z=self.zero_m)),
            bodies=self.bodies,
            self_pairs=self.self_pairs,
            joint_names=tuple(joint.name for joint in self.conventions),
            assembly=self.assembly,
            parallel_least=self.parallel_least,
        )


def limits_of(ranges: Sequence[tuple[float, float]], signs: Sequence[int], rates: Sequence[Sequence[float]]) -> Limits:
    """The planner's limits from the maker's ranges, and velocities, accelerations and jerks, all SI."""
    ends = [pair if sign > 0 else (-pair[1], -pair[0]) for pair, sign in zip(ranges, signs, strict=True)]
    lower, upper = np.array(ends).T + 0.0  # + 0.0: no negative zeros
    return Limits(lower, upper, *(np.array(rate) for rate in rates))


def in_order(limits: Limits, conventions: Conventions) -> Limits:
    """Limits that are in the maker's order in the planner's."""
    order = np.argsort(places(conventions))
    return Limits(*(getattr(limits, name)[order] for name in LIMITS))


LIMITS = ("lower", "upper", "velocity", "acceleration", "jerk")
