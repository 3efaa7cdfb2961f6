"""The robot of a document: arm, narrower limits, tool, and joint values in its maker's words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from planner.arrays import FloatArray
from planner.errors import InputError
from planner.robots import five_bar_links, scara
from planner.robots.planar import upright
from planner.robots.protocol import Limits, Robot, RobotBody
from planner.scene import Start, Tool
from scenes.build.bodies import attached
from scenes.build.frames import placed, pose_of
from scenes.catalogue import arm_named
from scenes.catalogue.arm import (
    Arm,
    Conventions,
    FiveBarArm,
    JointConvention,
    JointKind,
    ScaraArm,
    converted,
    limits_of,
)
from scenes.documents.robots import (
    FiveBarDocument,
    JointDocument,
    JointValues,
    LimitsDocument,
    RobotDocument,
    ScaraDocument,
    StartDocument,
    ToolDocument,
)
from scenes.documents.shapes import FiveBarBody, LinkBody
from scenes.faults import Path, fault, located
from scenes.units import twin_of

KINDS: tuple[JointKind, ...] = ("revolute", "revolute", "prismatic", "revolute")
"""Kinds of the joints of a SCARA and of a five-bar, in order."""


def arm(document: object, path: Path, robot: RobotDocument) -> Arm:
    """The arm of the catalogue, or the inline one. Raises `DocumentError` at the field at fault."""
    if robot.scara is not None:
        return ScaraArm(
            name="inline-scara",
            l1=robot.scara.l1_m,
            l2=robot.scara.l2_m,
            **_inline(document, (*path, "scara"), robot.scara, "SCARA", scara.LINKS, 0.0),
        )
    if robot.five_bar is not None:
        item = robot.five_bar
        return FiveBarArm(
            name="inline-five-bar",
            separation=item.separation_m,
            proximal=(item.proximal_m[0], item.proximal_m[1]),
            distal=(item.distal_m[0], item.distal_m[1]),
            assembly=item.assembly,
            parallel_least=item.parallel_margin,
            **_inline(document, (*path, "five_bar"), item, "five-bar", five_bar_links.LINKS, item.height_m),
        )
    try:
        return arm_named(str(robot.model))
    except InputError as error:
        raise fault(document, (*path, "model"), error.allowed) from None


def robot(document: object, path: Path, item: RobotDocument, of: Arm) -> Robot:
    """The robot at its base, with its limits narrowed."""
    limits = _narrowed(document, (*path, "limits"), item.limits, of)
    with located(document, *path):
        return of.robot(pose_of(item.base), limits)


def tool(document: object, path: Path, item: ToolDocument) -> Tool:
    """The tool in the flange's frame."""
    bodies = tuple(attached(document, (*path, "bodies", i), body) for i, body in enumerate(item.bodies))
    return Tool(placed(item.tcp_m, item.tcp_yaw_rad), bodies, item.mass_kg)


def start(document: object, item: StartDocument, conventions: Conventions) -> Start:
    """The state at the start. Raises `DocumentError` unless each joint has its value."""
    q = joint_values(document, ("start", "joints"), item.joints, conventions, "")
    rest = np.zeros(len(conventions))
    qd, qdd = rest, rest
    if item.velocity is not None:
        qd = joint_values(document, ("start", "velocity"), item.velocity, conventions, "_s")
    if item.acceleration is not None:
        qdd = joint_values(document, ("start", "acceleration"), item.acceleration, conventions, "_s2")
    return Start(item.at_s, q, qd, qdd)


def joint_values(document: object, path: Path, values: JointValues, conventions: Conventions, rate: str) -> FloatArray:
    """The planner's values (n,) from a mapping of maker's joints; `rate`: what follows rad or m in the unit."""
    keys = [_key(joint, rate) for joint in conventions]
    given = values.model_extra or {}
    for key in given:
        if key not in keys:
            raise fault(document, (*path, key), f"one of {', '.join(keys)} (or in deg, mm)")
    for key in keys:
        if key not in given:
            raise fault(document, (*path, key), f"{key} or {twin_of(key)}, which must be given")
    return converted(np.array([given[key] for key in keys], dtype=np.float64), conventions)


def _key(joint: JointConvention, rate: str = "") -> str:
    return f"{joint.name}_{joint.unit}{rate}"


def _narrowed(document: object, path: Path, item: LimitsDocument, of: Arm) -> Limits:
    limits = of.limits
    ranges = item.model_extra or {}
    lower, upper = limits.lower, limits.upper
    if ranges:
        lower, upper = _ranges(document, path, ranges, of)
    scales = (item.velocity, item.acceleration, item.jerk)
    if not ranges and scales == (1.0, 1.0, 1.0):
        return limits
    return Limits(lower, upper, *(scale * rate for scale, rate in zip(scales, _rates(limits), strict=True)))


def _rates(limits: Limits) -> tuple[FloatArray, FloatArray, FloatArray]:
    return limits.velocity, limits.acceleration, limits.jerk


def _ranges(document: object, path: Path, ranges: dict[str, Sequence[float]], of: Arm) -> tuple[FloatArray, FloatArray]:
    lower, upper = of.limits.lower.copy(), of.limits.upper.copy()
    keys = [_key(joint) for joint in of.conventions]
    for key, (first, last) in ranges.items():
        if key not in keys:
            allowed = ["velocity", "acceleration", "jerk", *keys]
            raise fault(document, (*path, key), f"one of {', '.join(allowed)} (ranges also in deg, mm)")
        i = keys.index(key)
        low, high = sorted((of.conventions[i].sign * first, of.conventions[i].sign * last))
        if not (first < last and lower[i] <= low and high <= upper[i]):
            ends = sorted(of.conventions[i].sign * x + 0.0 for x in (lower[i], upper[i]))
            known = f"{ends[0]:.6g} to {ends[1]:.6g} {of.conventions[i].unit}"
            raise fault(document, (*path, key), f"a range, lower end first, within that of {of.name}: {known}")
        lower[i], upper[i] = low, high
    return lower, upper


def _inline(
    document: object,
    path: Path,
    item: ScaraDocument | FiveBarDocument,
    family: str,
    links: tuple[str, ...],
    height: float,
) -> dict[str, Any]:
    """What an inline arm of any family has; `height`: of the flange above the mounting face, if there is no lift."""
    joints = item.joints
    names = [joint.name for joint in joints]
    for i, (joint, kind) in enumerate(zip(joints, KINDS, strict=False)):
        _check_joint(document, (*path, "joints", i), joint, kind, names[:i], family)
    zero = (joints[2].zero_m or 0.0) if len(joints) > 2 else height
    riders: Sequence[LinkBody | FiveBarBody] = item.bodies
    bodies = tuple(
        RobotBody(
            attached(document, (*path, "bodies", i), body, 0.0 if body.link in ("quill", "flange") else zero),
            links.index(body.link),
        )
        for i, body in enumerate(riders)
    )
    for i, solid in enumerate(bodies):
        if links[solid.link] == "quill" and not all(upright(piece) for piece in solid.body.pieces):
            allowed = "an upright cylinder, capsule or sphere about the quill's axis"
            raise fault(document, (*path, "bodies", i, "shape"), allowed)
    conventions = tuple(
        JointConvention(joint.name, kind, joint.sign) for joint, kind in zip(joints, KINDS, strict=False)
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
    return {
        "conventions": conventions,
        "limits": limits,
        "zero_m": zero,
        "bodies": bodies,
        "self_pairs": tuple((pair[0], pair[1]) for pair in item.self_pairs),
        "assumptions": ("the robot's data are the request's own",),
    }


def _range(joint: JointDocument) -> tuple[float, float]:
    ends = joint.range_rad or joint.range_m or [0.0, 0.0]  # the model has seen to one of them; [0, 0] is refused
    return ends[0], ends[1]


def _check_joint(
    document: object, path: Path, joint: JointDocument, kind: JointKind, taken: list[str], family: str
) -> None:
    if joint.name in taken:
        raise fault(document, (*path, "name"), "a name that no other joint has")
    wrong, right = ("_m", "_rad") if kind == "revolute" else ("_rad", "_m")
    for stem, rate in (("range", ""), ("velocity", "_s"), ("acceleration", "_s2"), ("jerk", "_s3")):
        if getattr(joint, stem + wrong + rate) is not None:
            allowed = f"{stem}{right}{rate}: joint {len(taken) + 1} of a {family} is {kind}"
            raise fault(document, (*path, stem + wrong + rate), allowed)
    if kind == "revolute" and joint.zero_m is not None:
        raise fault(document, (*path, "zero_m"), "a zero height for the lifting joint only")
    ends = _range(joint)
    if not ends[0] < ends[1]:
        raise fault(document, (*path, "range" + right), "two ends, the lower first")
