"""With which pitch and roll a control point may be met: as required, and choices where that is free."""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from assur.planner.frames.motion import Motion, Pose, Tilt
from assur.planner.model.scene import Scene, Step
from assur.planner.robots.robot import Robot

PATH_RAD = 1e-5
"""Between knots pitch and roll leave their path by less than this, rad; the promise of tracking legs is 1e-4."""
PITCHES = 24
"""Pitches that are tried where a control point leaves the pitch free, beside the one that the arm has: every 15°."""
SAME_RAD = 1e-9
"""Pitches nearer to each other than this are one: rounding."""


def flange_of(robot: Robot, q: FloatArray) -> Pose:
    """The pose of the flange in the world, pitch and roll aside, in the joint position q (n,)."""
    position, yaw = robot.forward(q)
    x, y, z = position.tolist()
    return Pose(x, y, z, float(yaw))


def tilt_of(robot: Robot, q: FloatArray) -> Tilt | None:
    """Pitch and roll, rad, of the arm's hand in the joint position q (n,); None for an arm that has none."""
    there = _hand(robot, q)
    if there is None:
        return None
    pitch, roll = there.tolist()
    return pitch, roll


def _hand(robot: Robot, q: FloatArray) -> FloatArray | None:
    """Pitch and roll (..., 2), rad, in joint positions (..., n)."""
    none = np.zeros_like(q)
    motion = robot.link_motion(robot.links.index("flange"), q, none, none, none)
    return motion.tilt if motion.tilted else None


def tilts(scene: Scene, step: Step, q: FloatArray) -> tuple[Tilt | None, ...]:
    """Pitches and rolls with which an arm in the joint position q (n,) may go to a step's control point.

    A free roll is kept; it turns nothing else. Of a free pitch the arm's own comes first, then others, nearest first.
    An arm without them has one choice: None.
    """
    target = step.target
    if "pitch" not in scene.robot.coordinates or target is None:
        return (None,)
    now = tilt_of(scene.robot, q)
    if now is None:
        raise FaultError(f"{scene.robot.name} has a coordinate pitch, and none in its motion")
    roll = now[1] if target.roll is None else target.roll
    if target.pitch is not None:
        return ((target.pitch, roll),)
    grid = [2 * math.pi * k / PITCHES - math.pi for k in range(1, PITCHES + 1)]
    away = {pitch: abs(math.remainder(pitch - now[0], 2 * math.pi)) for pitch in grid}
    others = sorted((pitch for pitch in grid if away[pitch] > SAME_RAD), key=lambda pitch: (away[pitch], pitch))
    return tuple((pitch, roll) for pitch in (now[0], *others))


def tilt_off(robot: Robot, q: FloatArray, path: Motion) -> FloatArray:
    """How far (T,), rad, the hand in the joint positions q (T, n) is turned against the pitch and roll of its path; 0
    for a path that has none."""
    if not path.tilted:
        return np.zeros(len(q))
    there = _hand(robot, q)
    if there is None:
        raise FaultError(f"{robot.name} has no pitch and roll to keep to a path")
    off = there - path.tilt
    return np.asarray(np.abs(off - 2 * np.pi * np.round(off / (2 * np.pi))).max(-1))


def pitch_free(scene: Scene, step: Step) -> bool:
    """Whether a step leaves the pitch to choose, so that what was tried is not all there is."""
    return "pitch" in scene.robot.coordinates and (step.target is None or step.target.pitch is None)
