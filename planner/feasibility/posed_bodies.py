"""Bodies where they are at the start, and whether they touch, for warnings about requests."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from itertools import product

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.collision.fcl_door import Posed
from assur.planner.collision.proof import Prover
from assur.planner.frames.motion import Pose
from assur.planner.model.attachments import AT_START, Attachments
from assur.planner.model.deadline import look
from assur.planner.model.scene import Scene


class AtStart:
    """Bodies of the surroundings as they are at the start, or would be then if parts had changed places. Each body is
    posed once in each of its places."""

    def __init__(self, scene: Scene, prover: Prover) -> None:
        self.scene, self.prover = scene, prover
        carriers = prover.carriers(scene.start.q, scene.start.time)[len(scene.robot.links) :]
        self._frames = dict(zip(scene.frames, carriers, strict=True))
        self._posed: dict[tuple[str, str, Pose], list[Posed]] = {}
        self._table: FloatArray | None = None

    def place(self, name: str, attached: Attachments = AT_START) -> FloatArray:
        """Where the origin of a body is in the world, (3,) m; NaN: the motion of its frame is not known then."""
        frame, pose = attached.pose_of(self.scene, name)
        carrier = self._frames[frame]
        return np.asarray(carrier[:3] + carrier[3:].reshape(3, 3) @ pose.position)

    def shapes(self, name: str, attached: Attachments = AT_START) -> list[Posed]:
        """The shapes of a body."""
        at = (name, *attached.pose_of(self.scene, name))
        if at not in self._posed:
            self._posed[at] = posed(self.prover, name, attached)
        return self._posed[at]

    def near(self, name: str, lowest: float, highest: float) -> list[str]:
        """The other bodies, in their order, that may touch a body at the start between two heights in the world, m: the
        circles about both meet, and theirs is not all above or below. None of those whose place is not known."""
        if self._table is None:
            self._table = np.array([self._row(each.name) for each in self.scene.bodies])
        table, own, names = self._table, self.place(name), list(self.scene.index)
        reach = np.hypot(*(table[:, :2] - own[:2]).T) <= table[:, 2] + self.scene.index[name].body.radius
        reach &= (table[:, 4] >= lowest) & (table[:, 3] <= highest)
        return [names[k] for k in np.flatnonzero(reach).tolist() if names[k] != name]

    def _row(self, name: str) -> list[float]:
        """x, y, radius, lowest and highest z of a body in the world, m."""
        look()
        (x, y, z), body = self.place(name).tolist(), self.scene.index[name].body
        return [x, y, body.radius, z + body.heights[0], z + body.heights[1]]


def posed(prover: Prover, name: str, attached: Attachments = AT_START) -> list[Posed]:
    """The shapes of any body as they are at the start, or would be then if it were so attached."""
    arrangement, start = prover.arrangement(attached), prover.scene.start
    return prover.posed(arrangement, start.q, start.time, np.array(arrangement.pieces(arrangement.number[name])))


def moved(posed: Iterable[Posed], by: FloatArray) -> list[Posed]:
    """Shapes shifted by (3,) m."""
    return [replace(each, position=each.position + by) for each in posed]


def touch(prover: Prover, ones: list[Posed], others: list[Posed], *shifts: FloatArray) -> bool:
    """Whether any two of the shapes touch, after each of the shifts (3,) of the first ones, m. Checks the deadline
    before each two."""
    for by in shifts or (np.zeros(3),):
        for one, other in product(moved(ones, by), others):
            look()
            if prover.collider.touch(one, other):
                break
        else:
            return False
    return True
