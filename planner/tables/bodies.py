"""The bodies of a cell as rows of numbers: one *unit* per convex piece, and one per bounding box of a body of several.

A unit is carried by a link of the robot (0..L-1) or a frame of the cell (L..L+F-1). Which part is carried by what
depends on the phase: an `Arrangement` is one such state. All are made from one table of the scene, in which an
attachment (a part that is held, or was placed elsewhere) rewrites the rows of that part and no others. The columns are
those of `assur.planner.kernels.solids`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import Hull, Primitive
from assur.planner.kernels.solids import BODY, CARRIER, COLUMNS, COVER, PIECE, PIECES
from assur.planner.kernels.units import OFFSET, OWN_COLUMNS, seat_bodies, seat_units, write_units
from assur.planner.laws import Law
from assur.planner.model.attachments import AT_START, Attachments
from assur.planner.model.scene import Scene

__all__ = ["COVER", "Arrangement", "Bodies"]


@dataclass(frozen=True, eq=False)
class Arrangement:
    """The units (U,) of a cell while parts are carried by certain links and frames.

    `rows` (U, COLUMNS) are the table of the kernels; `boxes` (U, 6) are the least and greatest coordinates of what
    stands still, in the world, NaN for what does not.
    """

    bodies: Bodies
    rows: FloatArray
    boxes: FloatArray

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the bodies (B,)."""
        return self.bodies.names

    @property
    def number(self) -> dict[str, int]:
        """Number of each body by its name."""
        return self.bodies.number

    @property
    def links(self) -> int:
        """How many carriers are links."""
        return self.bodies.links

    @property
    def roots(self) -> IntArray:
        """(B,) for each body the unit that stands for all of it."""
        return self.bodies.roots

    @property
    def cell(self) -> tuple[FloatArray, FloatArray, IntArray]:
        """What kernels read: units, vertices, and which carriers stand still for ever (1), (K,)."""
        return self.rows, self.bodies.vertices, self.bodies.still

    @cached_property
    def carrier(self) -> IntArray:
        """(U,) number of the carrier of each unit."""
        return self.rows[:, CARRIER].astype(np.int64)

    @cached_property
    def body(self) -> IntArray:
        """(U,) number of the body of each unit."""
        return self.rows[:, BODY].astype(np.int64)

    @cached_property
    def piece(self) -> IntArray:
        """(U,) number of the piece in its body, or COVER."""
        return self.rows[:, PIECE].astype(np.int64)

    @cached_property
    def of_robot(self) -> BoolArray:
        """(B,) whether a body is the robot's, its tool's, or the part that it holds."""
        return np.asarray(self.rows[self.roots, CARRIER] < self.links)

    def pieces(self, body: int) -> range:
        """The units of the convex pieces of a body."""
        root = int(self.roots[body])
        count = int(self.rows[root, PIECES])
        return range(root + 1, root + 1 + count) if count else range(root, root + 1)

    def shape(self, unit: int) -> Primitive | Hull:
        """The shape of a piece."""
        table, body = self.bodies.pieces, int(self.rows[unit, BODY])
        return table.shapes[int(table.first[body]) + int(self.rows[unit, PIECE])]

    def offset(self, unit: int) -> FloatArray:
        """(3,) where the centre of a unit is in the axes of its shape."""
        return self.bodies.own[unit, OFFSET : OFFSET + 3]


class Bodies:
    """The bodies of a scene, and the arrangements that were asked for."""

    def __init__(self, scene: Scene) -> None:
        robot, table, tool = scene.robot, scene.pieces, scene.tool.bodies
        self.links, self._flange = len(robot.links), robot.links.index("flange")
        self._frames = {name: self.links + k for k, name in enumerate(scene.frames)}
        self.names = (*(each.body.name for each in robot.bodies), *(body.name for body in tool), *scene.index)
        self.number = {name: k for k, name in enumerate(self.names)}
        self.pieces = table
        carriers = [each.link for each in robot.bodies] + [self._flange] * len(tool)
        poses = [(0.0, 0.0, 0.0, 0.0)] * len(carriers)
        frames = self._frames
        for body in scene.bodies:
            pose = body.pose
            carriers.append(frames[body.frame])
            poses.append((pose.x, pose.y, pose.z, pose.yaw))
        places = [NOWHERE] * self.links + [_place(frame.law) for frame in scene.frames.values()]
        self.still = np.array([int(place is not NOWHERE) for place in places], dtype=np.int64)
        self._places = np.array(places)
        self.vertices = np.concatenate([np.zeros((0, 3)), *(hull.vertices for hull in table.hulls)])
        begins = np.cumsum([0, *(len(hull.vertices) for hull in table.hulls)])
        many, core = len(table.shapes) + len(self.names), np.empty((len(table.shapes), 5))
        core[:, :3], core[:, 3], core[:, 4] = table.half, table.disc, table.ball
        rows, own, self.roots = np.zeros((many, COLUMNS)), np.zeros((many, OWN_COLUMNS)), np.empty_like(table.count)
        place, turn = np.array(table.position), np.array(table.rotation)
        units = write_units(
            np.array(table.count), place, turn, core, np.array(table.hull), begins, self.vertices, rows, own, self.roots
        )
        rows, self.own, boxes = rows[:units], own[:units], np.empty((units, 6))
        numbers = np.array(poses).reshape(-1, 4)
        seat_bodies(
            self.own, self.vertices, self.roots, np.array(carriers, dtype=np.int64), numbers, self._places, rows, boxes
        )
        self._made = {AT_START: Arrangement(self, rows, boxes)}

    def __call__(self, attached: Attachments) -> Arrangement:
        """The arrangement in which the held part is carried by the flange and each placed part by its frame."""
        found = self._made.get(attached)
        if found is None:
            found = self._made[attached] = self._arranged(attached)
        return found

    def _arranged(self, attached: Attachments) -> Arrangement:
        start = self._made[AT_START]
        rows, boxes = start.rows.copy(), start.boxes.copy()
        moved = [(part, self._frames[frame], pose) for part, frame, pose in attached.placed]
        if attached.held is not None:
            moved.append((attached.held.part, self._flange, attached.held.in_flange))
        for part, carrier, pose in moved:
            units = start.pieces(self.number[part])
            root, end = int(self.roots[self.number[part]]), units.stop
            seat_units(self.own, self.vertices, root, end, carrier, np.array(_numbers(pose)), self._places, rows, boxes)
        return Arrangement(self, rows, boxes)


NOWHERE = (np.nan, np.nan, np.nan, np.nan)
"""The place of a carrier that does not stand still."""


def _place(law: Law) -> tuple[float, float, float, float]:
    """Where a frame stands that stands still and is known for ever."""
    return _numbers(law.numbers.pose) if law.is_fixed and law.valid == (-np.inf, np.inf) else NOWHERE


def _numbers(pose: Pose) -> tuple[float, float, float, float]:
    return pose.x, pose.y, pose.z, pose.yaw
