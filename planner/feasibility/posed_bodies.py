"""Bodies where they are at the start, and whether they touch, for warnings about requests."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.collision.fcl_door import Posed
from assur.planner.collision.proof import Prover
from assur.planner.frames.motion import Pose
from assur.planner.model.attachments import AT_START
from assur.planner.model.scene import Scene


def world_pose(scene: Scene, name: str, t: float, at: tuple[str, Pose] | None = None) -> Pose | None:
    """Where a body is in the world at time t, s, or where it would be `at` a pose in a frame; None: the frame's motion
    is not known then."""
    frame, pose = at or (scene.index[name].frame, scene.index[name].pose)
    motion = scene.frames[frame].law.motion(np.array(t))
    numbers = (*motion.p.tolist(), float(motion.yaw))
    return Pose(*numbers).then(pose) if all(map(math.isfinite, numbers)) else None


def posed_body(scene: Scene, prover: Prover, name: str) -> list[Posed]:
    """The shapes of a body of the surroundings where it is at the start."""
    arrangement = prover.arrangement(AT_START)
    units = np.array(arrangement.pieces(arrangement.number[name]))
    return prover.posed(arrangement, scene.start.q, scene.start.time, units)


def moved(posed: list[Posed], by: FloatArray) -> list[Posed]:
    """Shapes shifted by (3,) m."""
    return [replace(each, position=each.position + by) for each in posed]


def touch(prover: Prover, ones: list[Posed], others: list[Posed]) -> bool:
    """Whether any two of the shapes touch."""
    return any(prover.collider.touch(one, other) for one in ones for other in others)
