"""An arm ready for the planner: geometry, limits, bodies, and the maker's joint conventions.

The planner counts a lifting joint upwards from its base origin. That origin is put where the maker's zero is, so
maker's and planner's values differ by a sign at most, and converting a trajectory to the maker's convention and back is
exact in floating point: a plan that was written out and read again is the same plan, bit by bit.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from planner.arrays import FloatArray
from planner.frames.motion import Pose
from planner.robots import five_bar_links, scara
from planner.robots.five_bar import PARALLEL_LEAST, FiveBar
from planner.robots.protocol import Limits, Robot, RobotBody
from planner.robots.scara import Scara
from planner.shapes import AXES, Body, Piece, Primitive, box, cylinder
from scenes.catalogue.entry import Axis, Entry, FiveBarEntry, Number
from scenes.units import TWIN_UNITS, to_si

JointKind = Literal["revolute", "prismatic"]
SI_OF: dict[JointKind, str] = {"revolute": "rad", "prismatic": "m"}


@dataclass(frozen=True, slots=True)
class JointConvention:
    """How the maker counts a joint: planner's value = sign × maker's value, in rad or m."""

    name: str
    kind: JointKind
    sign: Literal[1, -1] = 1

    @property
    def unit(self) -> str:
        return SI_OF[self.kind]


Conventions = tuple[JointConvention, ...]


def converted(values: FloatArray, conventions: Conventions) -> FloatArray:
    """Joint values (..., n) of the maker in the planner's convention, or the other way round: the same map."""
    signs = np.array([float(joint.sign) for joint in conventions])
    turned: FloatArray = values * signs + 0.0  # + 0.0: no negative zeros
    return turned


@dataclass(frozen=True, eq=False, kw_only=True)
class Arm(ABC):
    """Everything about an arm that does not depend on where it stands. `zero_m`: the planner's base origin above the
    mounting face."""

    name: str
    conventions: Conventions
    limits: Limits
    zero_m: float
    bodies: tuple[RobotBody, ...]
    self_pairs: tuple[tuple[str, str], ...]
    assumptions: tuple[str, ...]

    @abstractmethod
    def robot(self, base: Pose, limits: Limits) -> Robot:
        """The planner's robot, its mounting face at `base` in the world."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ScaraArm(Arm):
    """A SCARA: lengths in m."""

    l1: float
    l2: float

    def robot(self, base: Pose, limits: Limits) -> Scara:
        return Scara(
            name=self.name,
            l1=self.l1,
            l2=self.l2,
            axes=len(self.conventions),
            limits=limits,
            base=base.then(Pose(z=self.zero_m)),
            bodies=self.bodies,
            self_pairs=self.self_pairs,
            joint_names=tuple(joint.name for joint in self.conventions),
        )


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


def arm_of(entry: Entry) -> Arm:
    """The arm of a catalogue entry."""
    lift = next(axis for axis in entry.axes if axis.kind == "prismatic")
    zero = 0.0 if lift.zero is None else si(lift.zero)
    closed = isinstance(entry, FiveBarEntry)
    links = five_bar_links.LINKS if closed else scara.LINKS
    bodies = []
    for solid in entry.solids:
        size = [x / 1000 for x in solid.size]
        height = 0.0 if solid.link in ("quill", "flange") else zero
        at = (solid.at[0] / 1000, solid.at[1] / 1000, solid.at[2] / 1000 - height)
        shape = box(*size) if solid.kind == "box" else cylinder(*size)
        bodies.append(RobotBody(attached(solid.name, shape, at), links.index(solid.link)))
    common: dict[str, Any] = {
        "name": entry.model,
        "conventions": tuple(JointConvention(axis.name, axis.kind, axis.sign) for axis in entry.axes),
        "limits": _limits(entry.axes),
        "zero_m": zero,
        "bodies": tuple(bodies),
        "self_pairs": entry.self_pairs,
        "assumptions": entry.assumptions(),
    }
    l1, l2 = si(entry.l1), si(entry.l2)
    if not isinstance(entry, FiveBarEntry):
        return ScaraArm(l1=l1, l2=l2, **common)
    return FiveBarArm(
        separation=si(entry.separation),
        proximal=(l1, l1),
        distal=(l2, l2),
        assembly="front",
        parallel_least=PARALLEL_LEAST,
        **common,
    )


def _limits(axes: tuple[Axis, ...]) -> Limits:
    return limits_of(
        [(si(axis.lower), si(axis.upper)) for axis in axes],
        [axis.sign for axis in axes],
        [[si(getattr(axis, name)) for axis in axes] for name in ("velocity", "acceleration", "jerk")],
    )
