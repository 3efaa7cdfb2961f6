"""Where an arm is that stands at some joint values, and where frames are: by the formulas of the statement checker."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.statement import arms, laws
from assur.planner.checker.statement.postures import mode_at
from assur.planner.frames.motion import Pose
from assur.planner.model.scene import Scene


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


def allowed_modes(scene: Scene) -> tuple[str, ...]:
    """Names of the working modes that the request allows: where the arm has to keep its own, that of the start."""
    robot, elbow = scene.robot, scene.options.elbow
    mode = mode_at(robot, scene.start.q) if elbow == "keep" else elbow
    return (mode,) if mode in robot.modes else tuple(robot.modes)
