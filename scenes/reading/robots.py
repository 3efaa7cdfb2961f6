"""The robot of a document: arm, narrower limits, tool, and joint values in its maker's words."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Pose
from assur.planner.model.forbidden_yaw import YawRange, check_ranges
from assur.planner.model.load import LoadLimits, Tool
from assur.planner.robots.facts import Limits
from assur.planner.robots.robot import Robot
from assur.scenes.bounds import FAR_M
from assur.scenes.catalogue import arm_named, shipped_robot
from assur.scenes.conventions import Conventions, converted, converted_rates
from assur.scenes.faults import Gathered, Refused, as_written, between, within
from assur.scenes.reading.arms import BuiltArm, built, turned_over
from assur.scenes.reading.bodies import attached
from assur.scenes.reading.frames import placed, pose_of
from assur.scenes.reading.loads import replaced
from assur.scenes.robot_facts import OWN, assumptions
from assur.scenes.schema.request import LagDocument
from assur.scenes.schema.robots import (
    FAMILIES,
    LONGEST_KEPT,
    MOST_KEPT,
    JointValues,
    LimitsDocument,
    RobotDocument,
    ToolDocument,
)
from assur.scenes.units import from_si, si_key, twin_of


@dataclass(frozen=True, eq=False)
class RobotWithTool:
    """A robot at its base with its narrowed limits, its tool, its maker's joint conventions, its load limits, the
    forbidden ranges of yaw of its tool, and the names of the bodies of robot and tool."""

    robot: Robot
    tool: Tool
    conventions: Conventions
    load: LoadLimits
    forbidden_yaw: tuple[YawRange, ...]
    names: tuple[str, ...]


_kept: dict[str, RobotWithTool] = {}


def equipped(item: RobotDocument) -> RobotWithTool:
    """The robot of a document with its tool. Equal documents get the same robot, which is built once.

    Raises `Refused` at the field at fault.
    """
    found = _kept.get(item.text)
    if found is None:
        of = _arm(item)
        with within("limits"):
            limits = _narrowed(item.limits, of)
            load = replaced(of.load, item.limits.acceleration_by_load)
        made = of.robot(pose_of(item.base), limits)
        ranges = _forbidden_yaw(item.limits, made)
        with within("tool"):
            tool = _tool(item.tool, of)
        names = (*(body.body.name for body in made.bodies), *(body.name for body in tool.bodies))
        found = RobotWithTool(made, tool, of.conventions, load, ranges, names)
        if len(item.text) <= LONGEST_KEPT:
            if len(_kept) >= MOST_KEPT:
                _kept.clear()
            _kept[item.text] = found
    return found


def assumptions_of(document: object, item: RobotDocument) -> tuple[str, ...]:
    """What an answer to a request says of its arm's numbers, in the units in which they are written."""
    if item.model is not None:
        return shipped_robot(item.model).assumptions
    if not item.states_sources:
        return (OWN,)
    family = next(name for name in FAMILIES if getattr(item, name) is not None)
    _, written = as_written(document, ("robot", family))
    return assumptions(family, written)  # type: ignore[arg-type]


def _arm(robot: RobotDocument) -> BuiltArm:
    """The arm that is written out, or the shipped one that is named."""
    given = robot.written_out()
    if given is not None:
        family, item = given
        with within(family):
            return built(family, item)
    if robot.file is not None:
        raise Refused("a model, or an arm written out: a request never names a file", "file")
    with within("model"):
        return arm_named(str(robot.model))


def _tool(item: ToolDocument, of: BuiltArm) -> Tool:
    """The tool in the planner's flange frame, whose z axis points up."""
    found = []
    for i, body in enumerate(item.bodies):
        with within("bodies", i):
            found.append(attached(body))
    bodies = tuple(found)
    tcp = placed(item.tcp_m, item.tcp_yaw_rad)
    if of.z_down:
        bodies, tcp = tuple(turned_over(body) for body in bodies), Pose(tcp.x, -tcp.y, -tcp.z, -tcp.yaw)
    return Tool(tcp, bodies, item.mass_kg, item.inertia_kgm2)


def lag(item: LagDocument | None, conventions: Conventions) -> tuple[float, ...]:
    """How far each joint may lag, in the planner's order; none that is not named."""
    if item is None:
        return ()
    given, faults = item.model_extra or {}, Gathered()
    _hold_names(given, conventions.keys, faults)
    faults.settle()
    found = np.array([given.get(key, 0.0) for key in conventions.keys])
    return tuple(found[conventions.order].tolist())


def hold(
    values: FloatArray, ends: tuple[FloatArray, FloatArray], conventions: Conventions, rate: str, why: str = ""
) -> None:
    """Raises `Refused` at the joints beyond their limits, which are reported in the units of the document. `why` ends
    the message."""
    if all(((ends[0] <= values) & (values <= ends[1])).tolist()):
        return
    faults = Gathered()
    for joint, key, i in zip(conventions, conventions.keys, conventions.places, strict=True):
        value, lower, upper = float(values[i]), float(ends[0][i]), float(ends[1][i])
        if not lower <= value <= upper:
            zero = 0.0 if rate else joint.zero
            signed = sorted(joint.sign * (end - zero) + 0.0 for end in (lower, upper))
            far = f"; did you mean {twin_of(key + rate)}?" if joint.unit == "m" and abs(value) > FAR_M else ""
            faults.add(Refused(partial(_range_as_written, ends=signed, far=far, why=why), key + rate))
    faults.settle()


def _range_as_written(key: str, value: object, ends: list[float], far: str, why: str) -> str:
    unit = si_key(key)
    low, high = ends if unit is None else (from_si(end, unit[1]) for end in ends)
    return f"{between(low, high, value)}{why}{far if unit is None else ''}"


def joint_values(values: JointValues, conventions: Conventions, rate: str) -> FloatArray:
    """The planner's values (n,) from a mapping of maker's joints; `rate`: what follows rad or m in the unit."""
    keys = [key + rate for key in conventions.keys] if rate else conventions.keys
    given = values.model_extra or {}
    if given.keys() != set(keys):
        faults = Gathered()
        _hold_names(given, keys, faults)
        for key in keys:
            if key not in given:
                faults.add(Refused(f"{key} or {twin_of(key)}, which must be given", key))
        faults.settle()
    turned = converted_rates if rate else converted
    return turned(np.array(list(map(given.get, keys)), dtype=np.float64), conventions)


def _hold_names(given: Iterable[str], keys: Sequence[str], faults: Gathered) -> None:
    """Gives `faults` each name of a joint that the robot has not."""
    for key in given:
        if key not in keys:
            faults.add(Refused(f"one of {', '.join(keys)} (or in deg, mm)", key))


def _narrowed(item: LimitsDocument, of: BuiltArm) -> Limits:
    limits = of.limits
    ranges = item.model_extra or {}
    lower, upper = limits.lower, limits.upper
    if ranges:
        lower, upper = _ranges(ranges, of)
    scales = (item.velocity, item.acceleration, item.jerk)
    if not ranges and scales == (1.0, 1.0, 1.0):
        return limits
    return Limits(lower, upper, *(scale * rate for scale, rate in zip(scales, _rates(limits), strict=True)))


def _forbidden_yaw(item: LimitsDocument, robot: Robot) -> tuple[YawRange, ...]:
    """The ranges of yaw. Raises `Refused` at the range that is none, or at all of them for an arm without a yaw of its
    own and for ranges that leave no yaw."""
    found = []
    for i, (first, last) in enumerate(item.forbidden_yaw_rad or ()):
        with within("limits", "forbidden_yaw_rad", i):
            found.append(YawRange(first, last))
    with within("limits", "forbidden_yaw_rad"):
        check_ranges(robot, found, ())
    return tuple(found)


def _rates(limits: Limits) -> tuple[FloatArray, FloatArray, FloatArray]:
    return limits.velocity, limits.acceleration, limits.jerk


def _ranges(ranges: dict[str, Sequence[float]], of: BuiltArm) -> tuple[FloatArray, FloatArray]:
    lower, upper = of.limits.lower.copy(), of.limits.upper.copy()
    keys, own = of.conventions.keys, of.conventions.places
    faults = Gathered()
    for key, (first, last) in ranges.items():
        with faults.part():
            if key not in keys:
                allowed = ["velocity", "acceleration", "jerk", "acceleration_by_load", "forbidden_yaw_rad", *keys]
                raise Refused(f"one of {', '.join(allowed)} (ranges also in deg, mm)", key)
            joint, i = of.conventions[keys.index(key)], int(own[keys.index(key)])
            low, high = sorted((joint.sign * first + joint.zero, joint.sign * last + joint.zero))
            if not (first < last and lower[i] <= low and high <= upper[i]):
                ends = sorted(joint.sign * (x - joint.zero) + 0.0 for x in (lower[i], upper[i]))
                known = between(ends[0], ends[1], first if first < ends[0] else last if last > ends[1] else None)
                raise Refused(f"a range, lower end first, within that of {of.name}: {known} {joint.unit}", key)
            lower[i], upper[i] = low, high
    faults.settle()
    return lower, upper
