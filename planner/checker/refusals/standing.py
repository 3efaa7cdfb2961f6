"""Where an arm is that stands at some joint values, and where frames are: by the formulas of the statement checker."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.refusals.postures import Goal, posture
from assur.planner.checker.refusals.spans import ANY, around, beyond
from assur.planner.checker.statement import arms, laws
from assur.planner.frames.motion import Pose
from assur.planner.model.scene import Scene

SAME = 1e-6
"""Two joint positions nearer than this, rad or m, are one: what a posture of the arm's own flange may be off."""


class Link(NamedTuple):
    """Where a link is in the world: its origin (3,), m, its rotation (3, 3), and yaw (full turns of the joints
    counted), pitch and roll, rad."""

    place: FloatArray
    rotation: FloatArray
    angles: tuple[float, float, float]


def links_at(scene: Scene, q: FloatArray) -> list[Link]:
    """The links of the arm at joint values q (n,), in the order of `arms.link_names`."""
    places, angles = (each[:, 0] for each in arms.textbook(scene.robot, q[None]))
    rotations = [arms.rotated(np.tile(own, (3, 1)), np.eye(3)).T for own in angles]
    return [Link(p, r, tuple(own.tolist())) for p, r, own in zip(places, rotations, angles, strict=True)]


def flange_at(scene: Scene, q: FloatArray) -> Link:
    """The flange of the arm at joint values q (n,)."""
    return links_at(scene, q)[arms.flange_row(scene.robot)]


def yaw_at(scene: Scene, q: FloatArray) -> float:
    """The yaw of the tool point in the world at joint values q (n,), rad."""
    return flange_at(scene, q).angles[0] + scene.tool.tcp.yaw


def frame_at(scene: Scene, name: str, time: float) -> Pose | None:
    """Where a frame is at a time; None: its motion is not known then."""
    law = scene.frames[name].law
    first, last = laws.known(law)
    if not first <= time <= last:
        return None
    link = laws.link_of(law)
    return Pose(*(laws.place_at(law, time) if link is None else arms.place_at(*link, time)))


def still(scene: Scene, name: str) -> Pose | None:
    """Where a frame is that never moves; None: it may move."""
    return frame_at(scene, name, scene.start.time) if laws.stands(scene.frames[name].law) else None


def modes_at_start(scene: Scene) -> tuple[str, ...]:
    """Names of the working modes that the start is in: one, or more where it is singular."""
    robot, at = scene.robot, flange_at(scene, scene.start.q)
    yaw, pitch, roll = (around(angle, 0.0) for angle in at.angles)
    x, y, z = (around(float(value), 0.0) for value in at.place)
    tilts = "pitch" in robot.coordinates
    goal = Goal(x, y, z, yaw if robot.turns_load else ANY, pitch if tilts else ANY, roll if tilts else ANY)
    found = []
    for mode in robot.modes:
        joints = zip(robot.joints, scene.start.q.tolist(), posture(robot, mode, goal).joints, strict=True)
        if not any(beyond(s, q - SAME, q + SAME, turns=joint.kind == "revolute") for joint, q, s in joints):
            found.append(mode)
    return tuple(found)


def allowed_modes(scene: Scene) -> tuple[str, ...]:
    """Names of the working modes that the request allows."""
    modes, elbow = scene.robot.modes, scene.options.elbow
    if elbow == "auto":
        return tuple(modes)
    return (modes_at_start(scene) or tuple(modes)) if elbow == "keep" else (elbow,)
