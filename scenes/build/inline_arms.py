"""Arms that a request writes out itself, of every family."""

from __future__ import annotations

from typing import Any

import numpy as np

from assur.planner.geometry.shapes import Body, Piece
from assur.planner.robots.planar import upright
from assur.planner.robots.protocol import RobotBody
from assur.scenes.build.bodies import attached
from assur.scenes.catalogue.arm import (
    AT_FLANGE,
    LINKS,
    WITH_QUILL,
    Arm,
    FiveBarArm,
    JointConvention,
    JointKind,
    in_order,
    limits_of,
    order_of,
)
from assur.scenes.catalogue.entry import Family
from assur.scenes.documents.robots import (
    ElbowArmDocument,
    FiveAxisArmDocument,
    FiveBarDocument,
    JointDocument,
    PolarArmDocument,
    ScaraDocument,
)
from assur.scenes.faults import Path, fault, located

FAMILIES: tuple[Family, ...] = ("scara", "elbow_arm", "polar_arm", "five_axis_arm", "five_bar")
Inline = ScaraDocument | ElbowArmDocument | PolarArmDocument | FiveAxisArmDocument | FiveBarDocument
KINDS: dict[str, tuple[JointKind, ...]] = {
    "rrpr": ("revolute", "revolute", "prismatic", "revolute"),
    "rprr": ("revolute", "prismatic", "revolute", "revolute"),
    "elbow_arm": ("revolute", "revolute", "revolute"),
    "polar_arm": ("revolute", "revolute", "prismatic"),
    "five_bar": ("revolute", "revolute", "prismatic", "revolute"),
    "five_axis_arm": ("revolute",) * 5,
}
"""Kinds of the joints in the arm's own order: of a SCARA by its axis order, of the others by their family."""
CALLED: dict[Family, str] = {
    "scara": "a SCARA",
    "elbow_arm": "an elbow arm",
    "polar_arm": "a polar arm",
    "five_bar": "a five-bar",
    "five_axis_arm": "a five-axis arm",
}
OVER = np.diag([1.0, -1.0, -1.0])
"""Half a turn about x."""


def turned_over(body: Body) -> Body:
    """A body that is given in a flange frame whose z axis points down, in that whose z axis points up."""
    pieces = tuple(Piece(p.shape, OVER @ p.position, OVER @ p.rotation) for p in body.pieces)
    surface = body.surface
    if surface is not None:
        vertices = surface[0] @ OVER
        vertices.flags.writeable = False
        surface = (vertices, surface[1])
    return Body(body.name, pieces, surface)


def inline_arm(document: object, path: Path, family: Family, item: Inline) -> Arm:
    """The arm. Raises `DocumentError` at the field at fault."""
    joints, scara = item.joints, item if isinstance(item, ScaraDocument) else None
    kinds = KINDS[scara.axis_order if scara else family][: len(joints)]
    names = [joint.name for joint in joints]
    for i, (joint, kind) in enumerate(zip(joints, kinds, strict=True)):
        _check_joint(document, (*path, "joints", i), joint, kind, names[:i], family)
    zero, z_down = 0.0, scara is not None and scara.tool_frame == "z_down"
    own, rise = order_of(kinds) if scara else ((None,) * len(kinds), False)
    if family in WITH_QUILL and "prismatic" in kinds:
        zero = joints[kinds.index("prismatic")].zero_m or 0.0
    elif isinstance(item, FiveBarDocument):
        zero = item.height_m
    conventions = tuple(
        JointConvention(joint.name, kind, joint.sign, place)
        for joint, kind, place in zip(joints, kinds, own, strict=True)
    )
    with located(document, *path, "joints"):
        limits = limits_of(
            [_range(joint) for joint in joints],
            [joint.sign for joint in joints],
            [
                [j.velocity_rad_s or j.velocity_m_s or 0.0 for j in joints],
                [j.acceleration_rad_s2 or j.acceleration_m_s2 or 0.0 for j in joints],
                [j.jerk_rad_s3 or j.jerk_m_s3 or 0.0 for j in joints],
            ],
        )
    shared: dict[str, Any] = {
        "name": "inline-" + family.replace("_", "-"),
        "conventions": conventions,
        "limits": in_order(limits, conventions),
        "zero_m": zero,
        "bodies": _bodies(document, path, family, item, zero, z_down),
        "self_pairs": _pairs(document, path, family, item),
        "assumptions": ("the robot's data are the request's own",),
        "family": family,
    }
    if isinstance(item, FiveBarDocument):
        return FiveBarArm(
            separation=item.separation_m,
            proximal=(item.proximal_m[0], item.proximal_m[1]),
            distal=(item.distal_m[0], item.distal_m[1]),
            assembly=item.assembly,
            parallel_least=item.parallel_margin,
            **shared,
        )
    return Arm(
        **shared,
        l1=0.0 if isinstance(item, PolarArmDocument) else item.l1_m,
        l2=0.0 if isinstance(item, PolarArmDocument) else item.l2_m,
        l3=item.l3_m if isinstance(item, FiveAxisArmDocument) else 0.0,
        height=0.0 if isinstance(item, ScaraDocument) else item.height_m,
        arms_rise=rise,
        z_down=z_down,
    )


def _bodies(
    document: object,
    path: Path,
    family: Family,
    item: Inline,
    zero: float,
    z_down: bool,
) -> tuple[RobotBody, ...]:
    found = []
    for i, given in enumerate(item.bodies):
        if given.link not in LINKS[family]:
            raise fault(document, (*path, "bodies", i, "link"), f"one of {', '.join(LINKS[family])}")
        body = attached(document, (*path, "bodies", i), given, 0.0 if given.link in AT_FLANGE else zero)
        if z_down and given.link == "flange":
            body = turned_over(body)
        if given.link == "quill" and not all(upright(piece) for piece in body.pieces):
            allowed = "an upright cylinder, capsule or sphere about the quill's axis"
            raise fault(document, (*path, "bodies", i, "shape"), allowed)
        found.append(RobotBody(body, LINKS[family].index(given.link)))
    return tuple(found)


def _pairs(document: object, path: Path, family: Family, item: Inline) -> tuple[tuple[str, str], ...]:
    for i, pair in enumerate(item.self_pairs):
        if not set(pair) <= set(LINKS[family]):
            raise fault(document, (*path, "self_pairs", i), f"two of {', '.join(LINKS[family])}")
        if pair[0] == pair[1]:
            allowed = "two links that differ: what is on one link keeps its place there"
            raise fault(document, (*path, "self_pairs", i), allowed)
    return tuple((pair[0], pair[1]) for pair in item.self_pairs)


def _range(joint: JointDocument) -> tuple[float, float]:
    ends = joint.range_rad or joint.range_m or [0.0, 0.0]  # the model has seen to one of them; [0, 0] is refused
    return ends[0], ends[1]


def _check_joint(
    document: object, path: Path, joint: JointDocument, kind: JointKind, taken: list[str], family: Family
) -> None:
    if joint.name in taken:
        raise fault(document, (*path, "name"), "a name that no other joint has")
    wrong, right = ("_m", "_rad") if kind == "revolute" else ("_rad", "_m")
    for stem, rate in (("range", ""), ("velocity", "_s"), ("acceleration", "_s2"), ("jerk", "_s3")):
        if getattr(joint, stem + wrong + rate) is not None:
            allowed = f"{stem}{right}{rate}: joint {len(taken) + 1} of {CALLED[family]} is {kind}"
            raise fault(document, (*path, stem + wrong + rate), allowed)
    if joint.zero_m is not None and (kind == "revolute" or family not in WITH_QUILL):
        raise fault(document, (*path, "zero_m"), "a zero height for a joint that lifts a quill only")
    ends = _range(joint)
    if not ends[0] < ends[1]:
        raise fault(document, (*path, "range" + right), "two ends, the lower first")
