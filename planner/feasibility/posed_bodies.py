"""Bodies where they are at the start, and whether they touch, for warnings about requests."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.collision.fcl_door import Posed
from assur.planner.collision.proof import Prover
from assur.planner.frames.motion import Pose
from assur.planner.model.attachments import AT_START
from assur.planner.model.deadline import look
from assur.planner.model.scene import Scene


class AtStart:
    """Bodies of the surroundings as they are at the start. Each frame, and each body, is posed once."""

    def __init__(self, scene: Scene, prover: Prover) -> None:
        self.scene, self.prover = scene, prover
        self._frames: dict[str, Pose | None] = {}
        self._posed: dict[str, list[Posed]] = {}
        self._arrays: tuple[list[str], FloatArray] | None = None

    def pose(self, name: str, at: tuple[str, Pose] | None = None) -> Pose | None:
        """Where a body is in the world, or where it would be `at` a pose in a frame; None: the frame's motion is not
        known then."""
        frame, pose = at or (self.scene.index[name].frame, self.scene.index[name].pose)
        if frame not in self._frames:
            motion = self.scene.frames[frame].law.motion(np.array(self.scene.start.time))
            numbers = (*motion.p.tolist(), float(motion.yaw))
            self._frames[frame] = Pose(*numbers) if all(map(math.isfinite, numbers)) else None
        origin = self._frames[frame]
        return None if origin is None else origin.then(pose)

    def shapes(self, name: str) -> list[Posed]:
        """The shapes of a body."""
        if name not in self._posed:
            arrangement = self.prover.arrangement(AT_START)
            units = np.array(arrangement.pieces(arrangement.number[name]))
            start = self.scene.start
            self._posed[name] = self.prover.posed(arrangement, start.q, start.time, units)
        return self._posed[name]

    def near(self, name: str, lowest: float, highest: float) -> list[str]:
        """The other bodies, in their order, that may touch a body between two heights in the world, m: the circles
        about both meet, and theirs is not all above or below. None of those whose place is not known."""
        names, table = self._table()
        own = self.pose(name)
        if own is None:
            return []
        apart = np.hypot(table[:, 0] - own.x, table[:, 1] - own.y)
        reach = apart <= table[:, 2] + self.scene.index[name].body.radius
        reach &= (table[:, 4] >= lowest) & (table[:, 3] <= highest)
        return [names[k] for k in np.flatnonzero(reach).tolist() if names[k] != name]

    def _table(self) -> tuple[list[str], FloatArray]:
        """Names of bodies whose place is known, and of each x, y, radius, lowest and highest z in the world, m."""
        if self._arrays is None:
            names, rows = list[str](), []
            for world in self.scene.bodies:
                look()
                pose, body = self.pose(world.name), world.body
                if pose is not None and world.name in self.prover.arrangement(AT_START).number:
                    low, high = body.heights
                    names.append(world.name)
                    rows.append((pose.x, pose.y, body.radius, pose.z + low, pose.z + high))
            self._arrays = names, np.array(rows).reshape(-1, 5)
        return self._arrays


def moved(posed: Iterable[Posed], by: FloatArray) -> list[Posed]:
    """Shapes shifted by (3,) m."""
    return [replace(each, position=each.position + by) for each in posed]


def touch(prover: Prover, ones: list[Posed], others: list[Posed]) -> bool:
    """Whether any two of the shapes touch. Looks at the deadline before each two."""
    for one in ones:
        for other in others:
            look()
            if prover.collider.touch(one, other):
                return True
    return False
