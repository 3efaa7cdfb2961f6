"""A pose of the tool for an arm: the pose of its flange, the turns of its wrist, and why a mode has no solution."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Motion
from assur.planner.report.number_format import SHOWN_AS, amount
from assur.planner.report.refusal_words import POSITIONS
from assur.planner.robots.facts import TURN, Code
from assur.planner.robots.turns import ModeSolutions
from assur.scenes.conventions import JointConvention, as_maker, rates_as_maker
from assur.scenes.faults import Refused
from assur.scenes.reading.bodies import Places, resolve
from assur.scenes.reading.frames import Frames, known_from, knows
from assur.scenes.reading.robots import RobotWithTool
from assur.scenes.reading.task import NO_HEADING, NO_TILT, NO_YAW
from assur.scenes.schema.robots import ToolPoseDocument


def flange_of(item: ToolPoseDocument, given: RobotWithTool, frames: Frames, places: Places, t: float) -> Motion:
    """The flange at rest in the world, a motion of shape (), when the tool is at a pose at time `t`, s.

    Raises `Refused` for an angle that is missing or that the arm has not, a frame or body that there is not, and a
    frame whose motion is not known then.
    """
    coordinates = given.robot.coordinates
    for key, of, none in (
        ("yaw_rad", "yaw", NO_HEADING if "pitch" in coordinates else NO_YAW),
        ("pitch_rad", "pitch", NO_TILT.format("pitch")),
        ("roll_rad", "roll", NO_TILT.format("roll")),
    ):
        value = getattr(item, key)
        if value is not None and of not in coordinates:
            raise Refused(none, key)
        if value is None and of in coordinates:
            raise Refused(f"{key} or {of}_deg, which must be given", key)
    frame, pose = resolve(item, item.yaw_rad or 0.0, frames, places)
    law = frames.laws[frame].law
    if not knows(law, t):
        allowed = f"a frame that is known at {t:g} s; {frame} is {known_from(law)}"
        raise Refused(allowed, "body" if item.body else "frame")
    flange = law.motion(np.array(t)).at(pose.then(given.tool.tcp.inverse())).at_rest()
    if item.pitch_rad is None:
        return flange
    return flange.with_tilt(np.array([item.pitch_rad, item.roll_rad]))


def wrist_turns(found: FloatArray, given: RobotWithTool) -> list[int] | None:
    """In which full turn the wrist is in each joint vector (M, n), by its maker's count: 0 is from more than −180° to
    180°. None: the arm has no wrist, which turns its tool and nothing else."""
    if not {"yaw", "roll"} & set(given.robot.coordinates):
        return None
    # the wrist is the planner's last joint of all of these arms
    values = as_maker(found, given.conventions)[:, given.conventions.order[-1]]
    return [math.ceil((value - math.pi) / TURN) for value in values.tolist()]


def nearest_to_zero(found: FloatArray, given: RobotWithTool) -> FloatArray:
    """Which of several joint vectors (M, n) turns the wrist least, and then the other joints, (n,)."""
    turns = wrist_turns(found, given)
    centred = np.abs(found - given.conventions.zeros)

    def key(i: int) -> tuple[float, ...]:
        row = centred[i].tolist()
        return tuple(row) if turns is None else (row[-1], abs(turns[i]), *row)

    return np.asarray(found[min(range(len(found)), key=key)])


def in_words(joint: JointConvention, value: float) -> str:
    """A value of a joint as the maker counts it, in degrees or mm."""
    unit, factor = SHOWN_AS[joint.unit]
    return f"{value * factor:.6g} {unit}"


def joints_in_words(q: FloatArray, given: RobotWithTool) -> str:
    """All joints with their values, those of a joint vector (n,), as the maker counts them."""
    pairs = zip(given.conventions, as_maker(q, given.conventions).tolist(), strict=True)
    return ", ".join(f"{joint.name} {in_words(joint, value)}" for joint, value in pairs)


def lacks(mode: ModeSolutions, given: RobotWithTool) -> str:
    """Why a working mode has no solution."""
    robot = given.robot
    if mode.code is Code.OUT_OF_REACH:
        return f"{amount(mode.short_m, 'm')} out of reach"
    if mode.code is Code.PARALLEL and mode.parallel < 0.0:
        return "only the other assembly of the arm comes there"
    if mode.code is Code.PARALLEL:
        margins = f"parallel margin {mode.parallel:.3f}, required {robot.parallel_least:g}"
        return f"the couplers would be too near to one line ({margins})"
    if mode.code is not Code.ASSEMBLED:
        return POSITIONS[mode.code.name.lower()]
    ranges = as_maker(np.array([mode.q, robot.limits.lower, robot.limits.upper]), given.conventions)
    beyond = np.abs(rates_as_maker(mode.beyond, given.conventions))
    return " and ".join(
        f"{joint.name} would be at {in_words(joint, at)}, {amount(over, joint.unit)} beyond its range of "
        f"{in_words(joint, min(ends)).split()[0]} to {in_words(joint, max(ends))}"
        for joint, at, *ends, over in zip(given.conventions, *ranges.tolist(), beyond.tolist(), strict=True)
        if over > 0.0
    )


def lack(modes: Iterable[ModeSolutions], given: RobotWithTool) -> str:
    """Why several working modes have no solution; a reason that all of them have is stated once."""
    reasons = {given.robot.modes[mode.mode]: lacks(mode, given) for mode in modes}
    if len(set(reasons.values())) == 1:
        return next(iter(reasons.values()))
    return "; ".join(f"{name}: {words}" for name, words in reasons.items())
