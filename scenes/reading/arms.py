"""Arms of every family: from the document of a robot's file or of a request to what the planner takes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeVar

import numpy as np

from assur.planner.errors import FaultError
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import Body, Piece
from assur.planner.model.load import LoadLimits
from assur.planner.robots.facts import Limits, RobotBody, upright
from assur.planner.robots.five_axis_arm import FiveAxisArm
from assur.planner.robots.five_bar import FiveBar
from assur.planner.robots.robot import Robot
from assur.planner.robots.scara import Scara
from assur.planner.robots.tilting import ElbowArm, PolarArm
from assur.scenes.conventions import Conventions, JointConvention, JointKind, converted
from assur.scenes.faults import Refused, within
from assur.scenes.reading.bodies import attached
from assur.scenes.reading.loads import load_limits
from assur.scenes.robot_facts import unnamed
from assur.scenes.schema.robots import (
    Arm,
    ElbowArmDocument,
    Family,
    FiveAxisArmDocument,
    FiveBarDocument,
    JointDocument,
    PolarArmDocument,
    ScaraDocument,
)
from assur.scenes.schema.shapes import LinkBody
from assur.scenes.schema.stated import Stated, value_of

T = TypeVar("T")

WITH_QUILL: tuple[Family, ...] = ("scara", "five_bar")
"""Families whose flange is lifted by a quill, or by nothing, and turned about the vertical by the fourth joint."""
LINKS: dict[Family, tuple[str, ...]] = {
    "scara": Scara.links,
    "elbow_arm": ElbowArm.links,
    "polar_arm": PolarArm.links,
    "five_bar": FiveBar.links,
    "five_axis_arm": FiveAxisArm.links,
}
"""Names of the link frames of each family, in order."""
AT_FLANGE = ("quill", "flange")
"""Links of families with a quill whose solids are given from the flange; those of the other links are given from the
mounting face."""
KINDS: dict[str, tuple[JointKind, ...]] = {
    "rrpr": ("revolute", "revolute", "prismatic", "revolute"),
    "rprr": ("revolute", "prismatic", "revolute", "revolute"),
    "prrr": ("prismatic", "revolute", "revolute", "revolute"),
    "rrrp": ("revolute", "revolute", "revolute", "prismatic"),
    "elbow_arm": ("revolute", "revolute", "revolute"),
    "polar_arm": ("revolute", "revolute", "prismatic"),
    "five_bar": ("revolute", "revolute", "prismatic", "revolute"),
    "five_axis_arm": ("revolute",) * 5,
}
"""Kinds of the joints in the maker's order: of a SCARA by its axis order, of the others by their family."""
LIFT_ELSEWHERE = {"rprr": (0, 2, 1, 3), "prrr": (2, 0, 1, 3), "rrrp": (0, 1, 3, 2)}
"""Which of the planner's joints those of a SCARA are whose lift does not come third, by its axis order."""
LIFTS_LINKS = ("rprr", "prrr")
"""Axis orders of a SCARA whose lift carries both links."""
CALLED: dict[Family, str] = {
    "scara": "a SCARA",
    "elbow_arm": "an elbow arm",
    "polar_arm": "a polar arm",
    "five_bar": "a five-bar",
    "five_axis_arm": "a five-axis arm",
}
OVER = np.diag([1.0, -1.0, -1.0])
"""Half a turn about x."""


@dataclass(frozen=True, eq=False)
class BuiltArm:
    """An arm that does not stand anywhere yet: the maker's joint conventions, its own limits in the planner's order.

    `origin`: the planner's base origin in the frame in which a request places the arm; `z_down`: the flange frame that
    requests speak of is turned by π about its x axis; `load`: what it may carry; `make`: the planner's robot of these
    limits and this base.
    """

    name: str
    conventions: Conventions
    limits: Limits
    origin: Pose
    z_down: bool
    load: LoadLimits
    make: Callable[..., Robot]

    def robot(self, base: Pose, limits: Limits) -> Robot:
        """The planner's robot, its mounting face at `base` in the world."""
        return self.make(limits=limits, base=base.then(self.origin))

    @property
    def zero_m(self) -> float:
        """The planner's base origin above the mounting face."""
        return self.origin.z


def built(family: Family, arm: Arm) -> BuiltArm:
    """The arm of a document. Raises `Refused` at the field at fault."""
    joints = arm.joints
    order = arm.axis_order if isinstance(arm, ScaraDocument) else ""
    if order == "rrrp" and len(joints) == 3:
        raise Refused("rrpr, rprr or prrr: with rrrp and three joints there would be no lift", "axis_order")
    kinds = KINDS[order or family][: len(joints)]
    for i, (joint, kind) in enumerate(zip(joints, kinds, strict=True)):
        with within("joints", i):
            _check_joint(joint, kind, [other.name for other in joints[:i]], family)
    own = LIFT_ELSEWHERE.get(order, (None,) * len(joints))[: len(joints)]
    conventions = Conventions(
        JointConvention(joint.name, kind, joint.sign, place, value_of(joint.zero_rad or 0.0))
        for joint, kind, place in zip(joints, kinds, own, strict=True)
    )
    with within("joints"):
        limits = _limits(joints, conventions)
    zero = 0.0
    if family in WITH_QUILL and "prismatic" in kinds:
        zero = value_of(joints[kinds.index("prismatic")].zero_m or 0.0)
    elif isinstance(arm, FiveBarDocument):
        zero = value_of(arm.height_m)
    z_down = isinstance(arm, ScaraDocument) and arm.tool_frame == "z_down"
    name = arm.name or unnamed(family)
    make = _maker(
        arm,
        name=name,
        bodies=_bodies(family, arm, zero, z_down),
        self_pairs=_pairs(family, arm),
        joint_names=tuple(conventions[i].name for i in conventions.order),
    )
    load = load_limits(arm, wrist=family in WITH_QUILL and len(joints) == 4)
    x, y = [0.0, 0.0] if arm.base_offset_m is None else value_of(arm.base_offset_m)
    return BuiltArm(name, conventions, limits, Pose(x, y, zero), z_down, load, make)


def _maker(arm: Arm, **shared: Any) -> Callable[..., Robot]:
    """The constructor of the planner's robot, waiting for its limits and base."""
    match arm:
        case ScaraDocument():
            rise = arm.axis_order in LIFTS_LINKS
            l1, l2 = value_of(arm.l1_m), value_of(arm.l2_m)
            return partial(Scara, l1=l1, l2=l2, axes=len(arm.joints), arms_rise=rise, **shared)
        case FiveBarDocument():
            (p_left, p_right), (d_left, d_right) = value_of(arm.proximal_m), value_of(arm.distal_m)
            return partial(
                FiveBar,
                separation=value_of(arm.separation_m),
                proximal=(p_left, p_right),
                distal=(d_left, d_right),
                axes=len(arm.joints),
                assembly=arm.assembly,
                parallel_least=arm.parallel_margin,
                **shared,
            )
        case PolarArmDocument():
            return partial(PolarArm, height=value_of(arm.height_m), **shared)
        case ElbowArmDocument() | FiveAxisArmDocument():
            shared |= {"height": value_of(arm.height_m), "l1": value_of(arm.l1_m), "l2": value_of(arm.l2_m)}
            if isinstance(arm, ElbowArmDocument):
                return partial(ElbowArm, **shared)
            return partial(FiveAxisArm, l3=value_of(arm.l3_m), **shared)


def _limits(joints: list[JointDocument], conventions: Conventions) -> Limits:
    """The limits in the planner's order and directions, SI."""
    lower, upper = np.sort(converted(np.array([_range(joint) for joint in joints]).T, conventions), 0)
    rates = (
        [_given(joint.velocity_rad_s, joint.velocity_m_s) for joint in joints],
        [_given(joint.acceleration_rad_s2, joint.acceleration_m_s2) for joint in joints],
        [_given(joint.jerk_rad_s3, joint.jerk_m_s3) for joint in joints],
    )
    return Limits(lower, upper, *(np.array(rate)[conventions.order] for rate in rates))


def _range(joint: JointDocument) -> tuple[float, float]:
    lower, upper = _given(joint.range_rad, joint.range_m)
    return lower, upper


def _given(angular: T | Stated[T] | None, linear: T | Stated[T] | None) -> T:
    """The value of the fact that is given; the model has seen to exactly one."""
    fact = angular if angular is not None else linear
    if fact is None:
        raise FaultError("a joint without one of its limits was taken for a valid one")
    return value_of(fact)


def turned_over(body: Body) -> Body:
    """A body that is given in a flange frame whose z axis points down, in that whose z axis points up."""
    pieces = tuple(Piece(p.shape, OVER @ p.position, OVER @ p.rotation) for p in body.pieces)
    surface = body.surface
    if surface is not None:
        vertices = surface[0] @ OVER
        vertices.flags.writeable = False
        surface = (vertices, surface[1])
    return Body(body.name, pieces, surface)


def _bodies(family: Family, arm: Arm, zero: float, z_down: bool) -> tuple[RobotBody, ...]:
    bodies: list[LinkBody] = value_of(arm.bodies)
    found = []
    for i, given in enumerate(bodies):
        with within("bodies", *(["value"] if isinstance(arm.bodies, Stated) else []), i):
            if given.link not in LINKS[family]:
                raise Refused(f"one of {', '.join(LINKS[family])}", "link")
            body = attached(given, 0.0 if given.link in AT_FLANGE else zero)
            if z_down and given.link == "flange":
                body = turned_over(body)
            if given.link == "quill" and not all(upright(piece) for piece in body.pieces):
                raise Refused("an upright cylinder, capsule or sphere about the quill's axis", "shape")
            found.append(RobotBody(body, LINKS[family].index(given.link)))
    return tuple(found)


def _pairs(family: Family, arm: Arm) -> tuple[tuple[str, str], ...]:
    for i, pair in enumerate(arm.self_pairs):
        if not set(pair) <= set(LINKS[family]):
            raise Refused(f"two of {', '.join(LINKS[family])}", "self_pairs", i)
        if pair[0] == pair[1]:
            raise Refused("two links that differ: what is on one link keeps its place there", "self_pairs", i)
    return tuple((pair[0], pair[1]) for pair in arm.self_pairs)


def _check_joint(joint: JointDocument, kind: JointKind, taken: list[str], family: Family) -> None:
    if joint.name in taken:
        raise Refused("a name that no other joint has", "name")
    wrong, right = ("_m", "_rad") if kind == "revolute" else ("_rad", "_m")
    for stem, rate in (("range", ""), ("velocity", "_s"), ("acceleration", "_s2"), ("jerk", "_s3")):
        if getattr(joint, stem + wrong + rate) is not None:
            allowed = f"{stem}{right}{rate}: joint {len(taken) + 1} of {CALLED[family]} is {kind}"
            raise Refused(allowed, stem + wrong + rate)
    if joint.zero_rad is not None and kind == "prismatic":
        raise Refused("a zero angle for a joint that turns only", "zero_rad")
    if joint.zero_m is not None and (kind == "revolute" or family not in WITH_QUILL):
        raise Refused("a zero height for a joint that lifts a quill only", "zero_m")
    lower, upper = _range(joint)
    if not lower < upper:
        stated = isinstance(joint.range_rad or joint.range_m, Stated)
        raise Refused("two ends, the lower first", "range" + right, *(["value"] if stated else []))
