"""Whether a reading lies within what the committed proof assumes: by comparison, without planning."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from pydantic import Field

from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.laws.law import FARTHEST_WAY_M
from assur.scenes.conventions import as_maker, rates_as_maker
from assur.scenes.faults import DocumentError, Refused, choices, located
from assur.scenes.reading.bodies import Places, resolve_at, tilts
from assur.scenes.reading.robots import joint_values
from assur.scenes.schema.model import Document, Group, Instant, Reference, Speed
from assur.scenes.schema.read import read
from assur.scenes.schema.robots import JointValues
from assur.scenes.schema.shapes import PlaceInCell

if TYPE_CHECKING:
    from assur.planner.arrays import FloatArray
    from assur.planner.frames.motion import Motion
    from assur.planner.laws.law import Frame
    from assur.scenes.reading.cell import Cell
    from assur.scenes.session.committed import CommittedMotion, Segment

ROUNDING = 1e-9
"""A reading may be beyond its bound by this, rad or m: rounding of units and sums."""
LATE_INSTANTS = 65
"""Instants between on time and as late as a robot may be at which its joints are compared; one that fits is enough."""


class ReadingDocument(Document):
    """A reading: joints of the robot at `at_s`; the pose of a part, as a task has it, with its own `at_s`; or how far a
    frame has gone along its line at `at_s`, from where the cell has it written, and its speed. Without a time it is of
    now."""

    exactly_one: ClassVar[tuple[Group, ...]] = (("joints", "pose", "along_m"),)
    at_most_one: ClassVar[tuple[Group, ...]] = (
        *[("joints", key) for key in ("part", "frame", "speed_m_s")],
        *[("pose", key) for key in ("at_s", "frame", "speed_m_s")],
        ("along_m", "part"),
    )

    at_s: Instant | None = None
    joints: JointValues | None = None
    part: Reference | None = None
    pose: PlaceInCell | None = None
    frame: Reference | None = None
    along_m: Annotated[float, Field(ge=-FARTHEST_WAY_M, le=FARTHEST_WAY_M)] | None = None
    speed_m_s: Speed | None = None


@dataclass(frozen=True)
class Coverage:
    """Whether a reading lies within what the proof of the committed motion assumes.

    `until_s`: the proof counts until then, s; None where the reading is outside. `off_mm`: by how many mm it is outside
    (0 inside): of joints at the tool point, of a part at its farthest point; None for a part that the proof does not
    know. `reason`: why it is outside; empty inside.
    """

    holds: bool
    until_s: float | None
    off_mm: float | None
    reason: str


def covered(committed: CommittedMotion, reading: object, clock_s: float) -> Coverage:
    """Compares a reading with the committed motion. Raises `InputError` naming the field, also for a time
    before the motion that is kept or behind the clock, and for the pose of a part that the gripper holds then."""
    try:
        item: ReadingDocument = read(ReadingDocument, reading)
    except DocumentError as error:
        raise error.relocated(lambda field: "reading" if field == "request" else field) from error
    own, placed = item.at_s, None if item.pose is None else item.pose.at_s
    at_s = next((each for each in (own, placed) if each is not None), clock_s)
    first_s = committed.segments[0].starts_s
    if not first_s <= at_s <= clock_s:
        field = "at_s" if placed is None else "pose.at_s"
        raise InputError(field, at_s, f"{first_s:.6g} to {clock_s:.6g} s: from the motion that is kept up to the clock")
    with located(reading):
        if item.joints is not None:
            try:
                q = joint_values(item.joints, committed.last.cell.conventions, "")
            except Refused as error:
                raise error.at("joints") from error
            return _of_joints(committed, q, at_s)
        if item.along_m is not None:
            return _of_frame(committed.at(at_s), item.frame, item.along_m, item.speed_m_s, at_s)
        if item.part is None:
            raise Refused("the name of the part that is at this pose", "part")
        return _of_part(committed.at(at_s), item.part, item.pose or PlaceInCell(), at_s)


def _of_joints(committed: CommittedMotion, q: FloatArray, at_s: float) -> Coverage:
    """The robot is where the motion has it, up to its lag, at some instant by which it may be late."""
    cell = committed.last.cell
    execution = cell.scene.execution
    lag = np.array(execution.lag) if execution.lag else np.zeros(len(q))
    first_s = max(at_s - execution.start_tolerance_s, committed.segments[0].starts_s)
    best: tuple[float, FloatArray] | None = None
    for instant in np.unique(np.linspace(first_s, at_s, LATE_INSTANTS))[::-1].tolist():
        planned, _, _ = committed.at(instant).state(instant)
        nearest = np.minimum(np.maximum(q, planned - lag), planned + lag)
        off = q - nearest
        if np.abs(off).max() <= ROUNDING:
            return Coverage(True, committed.last.proved_until_s, 0.0, "")
        off_m = float(np.linalg.norm(_tool_point(cell, q) - _tool_point(cell, nearest)))
        if best is None or off_m < best[0]:
            best = off_m, off
    off_m, off = best if best is not None else (math.nan, lag)
    counted = rates_as_maker(off, cell.conventions)
    worst = int(np.abs(counted).argmax())
    joint, value = cell.conventions[worst], as_maker(q, cell.conventions)[worst]
    more = f"{joint.name} at {value:.6g} {joint.unit} is beyond what the request allows by {abs(counted[worst]):.3g}"
    return Coverage(False, None, 1e3 * off_m, f"{more} {joint.unit}")


def _tool_point(cell: Cell, q: FloatArray) -> FloatArray:
    """The tool point (3,) in the world, m."""
    positions, turns = cell.scene.robot.placements(q)
    return np.asarray(positions[-1] + turns[-1] @ cell.scene.tool.tcp.position)


def _of_part(there: Segment, name: str, place: PlaceInCell, at_s: float) -> Coverage:
    """The part is where the proof has it, up to what is uncertain of it and of its frame."""
    cell, (attached, known) = there.cell, there.during(at_s)
    scene = cell.scene
    if tilt := tilts(place):
        raise Refused("0: parts stay upright", "pose", tilt[0])
    try:
        frame, pose = resolve_at(place, cell.frames, Places(cell.places))
    except Refused as error:
        raise error.at("pose") from error
    if name not in scene.index or attached.has_gone(scene, name):
        return Coverage(False, None, None, f"the committed motion knows no {name} at {at_s:.6g} s")
    if attached.part == name:
        raise Refused("a part that the gripper does not hold at that time", "part")
    assumed, nominal = attached.pose_of(scene, name)
    body = scene.index[name]
    within = known.of(name) or body.uncertainty
    of_frame = scene.frames[assumed]
    level_m, upright_m, yaw_rad = _apart(
        _world(of_frame, at_s).then(nominal),
        _world(scene.frames[frame], at_s).then(pose),
        of_frame,
        at_s - there.motion.start,
    )
    beyond = [
        max(0.0, level_m - within.position_m),
        max(0.0, upright_m - within.vertical_m - of_frame.uncertainty.vertical_m),
        max(0.0, yaw_rad - within.yaw_rad),
    ]
    if max(beyond) <= ROUNDING:
        handled = [each.until for each in there.arrivals if scene.task[each.step].part == name and each.until > at_s]
        return Coverage(True, min([there.until_s, *handled]), 0.0, "")
    off_m = math.hypot(beyond[0], beyond[1]) + beyond[2] * body.body.radius
    level_mm, upright_mm = 1e3 * beyond[0], 1e3 * beyond[1]
    how = f"{level_mm:.3g} mm horizontally, {upright_mm:.3g} mm vertically and {beyond[2]:.3g} rad about its axis"
    return Coverage(False, None, 1e3 * off_m, f"{name} is beyond what the request allows by {how}")


def _of_frame(there: Segment, name: str | None, along_m: float, speed_m_s: float | None, at_s: float) -> Coverage:
    """The frame has gone as far as the proof has it, up to what is uncertain; with this speed, until when."""
    frames = there.cell.scene.frames
    lines = [each for each, frame in frames.items() if frame.law.line is not None]
    if name is None or name not in lines:
        raise Refused(f"a frame that travels along a line: {choices(lines, str(name))}", "frame")
    frame = frames[name]
    line, stated, off = np.array(frame.law.line), frame.law.numbers.pose, frame.uncertainty
    motion: Motion = frame.law.motion(np.array(at_s))
    ahead_m = along_m - float((motion.p - stated.position) @ line)
    most_m = off.position_m + off.speed_m_s * (at_s - there.motion.start)
    beyond_m = abs(ahead_m) - most_m
    if beyond_m > ROUNDING:
        how = f"{name} is {1e3 * abs(ahead_m):.4g} mm from where the motion has it; {1e3 * most_m:.4g} mm are allowed"
        return Coverage(False, None, 1e3 * beyond_m, how)
    until_s = there.until_s
    if speed_m_s is not None:
        faster = speed_m_s - float(motion.v @ line)
        for sign in (1.0, -1.0):  # ahead or behind: when it leaves what grows with the uncertainty of its speed
            closing = sign * faster - off.speed_m_s
            if closing > ROUNDING:
                until_s = min(until_s, at_s + max(0.0, most_m - sign * ahead_m) / closing)
    return Coverage(True, until_s, 0.0, "")


def _world(frame: Frame, at_s: float) -> Pose:
    """A frame in the world at an instant."""
    motion: Motion = frame.law.motion(np.array(at_s))
    x, y, z = motion.p.tolist()
    return Pose(x, y, z, float(motion.yaw))


def _apart(one: Pose, other: Pose, frame: Frame, since_s: float) -> tuple[float, float, float]:
    """How far two poses are apart horizontally, vertically, m, and in yaw, rad, beyond what the frame may be off along
    its line and across it, or in every horizontal direction, `since_s` after the start. That the frame may be turned is
    left out: a reading is then outside although the proof may cover it."""
    apart, off = other.position - one.position, frame.uncertainty
    most, line = off.position_m + off.speed_m_s * since_s, frame.law.line
    if line is None:
        level = max(0.0, math.hypot(apart[0], apart[1]) - most)
    else:
        for along, bound in ((line, most), (np.array([-line[1], line[0], 0.0]), off.lateral_m)):
            length = float(np.linalg.norm(along))
            if length > 0.0:
                way = float(apart @ along) / length
                apart = apart - min(max(way, -bound), bound) * along / length
        level = math.hypot(apart[0], apart[1])
    return level, abs(float(apart[2])), abs(math.remainder(other.yaw - one.yaw, math.tau))
