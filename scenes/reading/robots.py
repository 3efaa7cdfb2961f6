"""The robot of a document: arm, narrower limits, tool, and joint values in its maker's words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.model.scene import Start, Tool
from assur.planner.robots.five_bar import FiveBar
from assur.planner.robots.protocol import Limits, Robot
from assur.scenes.bounds import FAR_M
from assur.scenes.catalogue import arm_named, shipped_robot
from assur.scenes.conventions import Conventions, JointConvention, converted, places
from assur.scenes.faults import Path, as_written, fault, located
from assur.scenes.reading.arms import BuiltArm, built, turned_over
from assur.scenes.reading.bodies import attached
from assur.scenes.reading.frames import placed, pose_of
from assur.scenes.robot_facts import assumptions
from assur.scenes.schema.robots import (
    LONGEST_KEPT,
    MOST_KEPT,
    JointValues,
    LimitsDocument,
    RobotDocument,
    StartDocument,
    ToolDocument,
)
from assur.scenes.units import from_si, si_key, twin_of


@dataclass(frozen=True, eq=False)
class Equipped:
    """A robot at its base with its limits narrowed, its tool, and the conventions in which its maker counts."""

    robot: Robot
    tool: Tool
    conventions: Conventions


_kept: dict[str, Equipped] = {}


def equipped(document: object, path: Path, item: RobotDocument) -> Equipped:
    """The robot of a document with its tool. A robot that many requests repeat is built once: its document decides.

    Raises `DocumentError` at the field at fault.
    """
    found = _kept.get(item.text)
    if found is None:
        of = _arm(document, path, item)
        limits = _narrowed(document, (*path, "limits"), item.limits, of)
        with located(document, *path):
            made = of.robot(pose_of(item.base), limits)
        found = Equipped(made, _tool(document, (*path, "tool"), item.tool, of), of.conventions)
        if len(item.text) <= LONGEST_KEPT:
            if len(_kept) >= MOST_KEPT:
                _kept.clear()
            _kept[item.text] = found
    return found


def assumptions_of(document: object, path: Path, item: RobotDocument) -> tuple[str, ...]:
    """What an answer says of the arm's numbers, in the units in which they are written."""
    given = item.written_out()
    if given is None:
        return shipped_robot(str(item.model)).assumptions
    family, _ = given
    _, written = as_written(document, (*path, family))
    return assumptions(family, written)  # type: ignore[arg-type]


def _arm(document: object, path: Path, robot: RobotDocument) -> BuiltArm:
    """The arm that is written out, or the shipped one that is named."""
    given = robot.written_out()
    if given is not None:
        family, item = given
        return built(document, (*path, family), family, item)
    if robot.file is not None:
        raise fault(document, (*path, "file"), "a model, or an arm written out: a request never names a file")
    try:
        return arm_named(str(robot.model))
    except InputError as error:
        raise fault(document, (*path, "model"), error.allowed) from None


def _tool(document: object, path: Path, item: ToolDocument, of: BuiltArm) -> Tool:
    """The tool in the planner's flange frame, whose z axis points up."""
    bodies = tuple(attached(document, (*path, "bodies", i), body) for i, body in enumerate(item.bodies))
    tcp = placed(item.tcp_m, item.tcp_yaw_rad)
    if of.z_down:
        bodies, tcp = tuple(turned_over(body) for body in bodies), Pose(tcp.x, -tcp.y, -tcp.z, -tcp.yaw)
    return Tool(tcp, bodies, item.mass_kg)


START_RATIO = 1e-9
"""A start velocity or acceleration may exceed its limit by this share, as the planner has it: rounding of units."""


def start(document: object, item: StartDocument, conventions: Conventions, limits: Limits) -> Start:
    """The state at the start. Raises `DocumentError` unless each joint has its value, within the (narrowed) limits."""
    path: Path = ("start", "joints")
    q = joint_values(document, path, item.joints, conventions, "")
    _hold(document, path, q, (limits.lower, limits.upper), conventions, "")
    rates = []
    for key, given, limit, rate in (
        ("velocity", item.velocity, limits.velocity, "_s"),
        ("acceleration", item.acceleration, limits.acceleration, "_s2"),
    ):
        values = np.zeros(len(conventions))
        if given is not None:
            path = ("start", key)
            values = joint_values(document, path, given, conventions, rate)
            most = limit * (1 + START_RATIO)
            _hold(document, path, values, (-most, most), conventions, rate)
        rates.append(values)
    return Start(item.at_s, q, *rates)


def refuse_open_chain(document: object, robot: Robot, start: Start) -> None:
    """Raises `DocumentError` at `start.joints` for a five-bar whose couplers cannot meet there."""
    if not isinstance(robot, FiveBar):
        return
    apart, (left, right) = 1e3 * float(np.hypot(*robot.span(start.q))), (1e3 * length for length in robot.distal)
    if abs(left - right) <= apart <= left + right:
        return
    couplers = f"{left + right:.1f} mm long together" if apart > left + right else f"{left:g} mm and {right:g} mm long"
    allowed = f"joints with which the chain closes; the elbows are {apart:.1f} mm apart, the couplers {couplers}"
    raise fault(document, ("start", "joints"), allowed)


def _hold(
    document: object,
    path: Path,
    values: FloatArray,
    ends: tuple[FloatArray, FloatArray],
    conventions: Conventions,
    rate: str,
) -> None:
    """Raises `DocumentError` at the first joint beyond its limits, which are told as the joint was written."""
    for i, joint in enumerate(conventions):
        lower, upper = float(ends[0][i]), float(ends[1][i])
        if not lower <= values[i] <= upper:
            refused = fault(document, (*path, _key(joint, rate)), "")
            unit = si_key(refused.field)
            signed = sorted(joint.sign * end + 0.0 for end in (lower, upper))
            low, high = (end if unit is None else from_si(end, unit[1]) for end in signed)
            key = _key(joint, rate)
            far = unit is None and joint.unit == "m" and abs(values[i]) > FAR_M
            meant = f"; did you mean {twin_of(key)}?" if far else ""
            raise fault(document, (*path, key), f"{low:.6g} to {high:.6g}{meant}")


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


def _narrowed(document: object, path: Path, item: LimitsDocument, of: BuiltArm) -> Limits:
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


def _ranges(
    document: object, path: Path, ranges: dict[str, Sequence[float]], of: BuiltArm
) -> tuple[FloatArray, FloatArray]:
    lower, upper = of.limits.lower.copy(), of.limits.upper.copy()
    keys, own = [_key(joint) for joint in of.conventions], places(of.conventions)
    for key, (first, last) in ranges.items():
        if key not in keys:
            allowed = ["velocity", "acceleration", "jerk", *keys]
            raise fault(document, (*path, key), f"one of {', '.join(allowed)} (ranges also in deg, mm)")
        joint, i = of.conventions[keys.index(key)], int(own[keys.index(key)])
        low, high = sorted((joint.sign * first, joint.sign * last))
        if not (first < last and lower[i] <= low and high <= upper[i]):
            ends = sorted(joint.sign * x + 0.0 for x in (lower[i], upper[i]))
            known = f"{ends[0]:.6g} to {ends[1]:.6g} {joint.unit}"
            raise fault(document, (*path, key), f"a range, lower end first, within that of {of.name}: {known}")
        lower[i], upper[i] = low, high
    return lower, upper
