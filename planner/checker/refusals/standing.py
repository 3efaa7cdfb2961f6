"""The arm as it stands in one joint position, and the frames at any time: the checker's kinematics without a plan."""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.refusals.postures import Goal, posture
from assur.planner.checker.refusals.spans import ANY, around, beyond
from assur.planner.checker.world import World
from assur.planner.frames.motion import Pose
from assur.planner.model.outcome import Certificate, Plan
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory

NOWHERE = np.zeros(0)
NO_BODIES = np.zeros(0, dtype=np.int64)
SAME = 1e-6
"""Two joint positions nearer than this, rad or m, are one: what a posture of the arm's own flange may be off."""


def standing(scene: Scene, q: FloatArray, lasts: float = 1.0) -> World:
    """A world in which the arm stands at q (n,) from the start on, for `lasts` seconds."""
    still = np.array([q, q])
    begin = scene.start.time
    trajectory = Trajectory(np.array([begin, begin + lasts]), still, 0.0 * still, 0.0 * still)
    nothing = Certificate(
        (), NOWHERE, NOWHERE, NO_BODIES, NO_BODIES, NO_BODIES, NO_BODIES, np.zeros((0, 3)),
    )  # fmt: skip
    return World(scene, Plan(trajectory, (), (), nothing))


def modes_of(scene: Scene) -> tuple[str, ...]:
    """Names of the working modes that the start is in: one, or more where it is singular."""
    robot, start = scene.robot, scene.start
    flange = standing(scene, start.q).states([(len(robot.links) - 1, Pose(), start.time)])[0]
    tilts = "pitch" in robot.coordinates
    goal = Goal(
        around(flange.x, 0.0),
        around(flange.y, 0.0),
        around(flange.z, 0.0),
        around(flange.yaw, 0.0) if robot.turns_load else ANY,
        around(flange.pitch, 0.0) if tilts else ANY,
        around(flange.roll, 0.0) if tilts else ANY,
    )
    found = []
    for mode in robot.modes:
        joints = posture(robot, mode, goal).joints
        off = [
            beyond(span, value - SAME, value + SAME, turns=joint.kind == "revolute")
            for joint, value, span in zip(robot.joints, start.q.tolist(), joints, strict=True)
        ]
        if not any(off):
            found.append(mode)
    return tuple(found)


def allowed_modes(scene: Scene) -> tuple[str, ...]:
    """Names of the working modes that the request allows."""
    modes, elbow = scene.robot.modes, scene.options.elbow
    if elbow == "auto":
        return tuple(modes)
    return (modes_of(scene) or tuple(modes)) if elbow == "keep" else (elbow,)


def place_of(world: World, name: str, t: float) -> Pose | None:
    """The pose of a frame; None: it is not known then."""
    state = world.states([(world.frame[name], Pose(), t)])[0]
    known = all(math.isfinite(value) for value in state[:4])
    return Pose(state.x, state.y, state.z, state.yaw) if known else None
