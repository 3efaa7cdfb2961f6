"""The bodies of a cell as rows of numbers: one *unit* per convex piece, and one per bounding box of a body of several.

A unit is carried by a link of the robot (0..L-1) or a frame of the cell (L..L+F-1). Which part is carried by what
depends on the phase: an `Arrangement` is one such state. All are made from one table of the scene, in which an
attachment (a part that is held, or was placed elsewhere) rewrites the rows of that part and no others. The columns are
those of `assur.planner.kernels.solids`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.frames import Fixed
from assur.planner.frames.motion import Pose
from assur.planner.geometry.extents import extents_of
from assur.planner.geometry.shapes import Hull, Primitive
from assur.planner.geometry.units import COVER, Units, units
from assur.planner.kernels.solids import (
    BALL,
    BODY,
    CARRIER,
    CENTRE,
    COLUMNS,
    DISC,
    DISTANCE,
    HALF,
    OPENED,
    PIECE,
    PIECES,
    RADIUS,
    REACH,
    ROTATION,
    VERTEX,
    VERTICES,
)
from assur.planner.model.attachments import Attachments
from assur.planner.model.scene import Scene

__all__ = ["COVER", "Arrangement", "Bodies"]


@dataclass(frozen=True, eq=False)
class Arrangement:
    """The units (U,) of a cell while parts are carried by certain links and frames.

    `rows` (U, COLUMNS) and `vertices` (V, 3) are the tables of the kernels; `boxes` (U, 6) are the least and greatest
    coordinates of what stands still, in the world, NaN for what does not. `roots` (B,): for each body the unit that
    stands for all of it. `pieces`: for each body the units of its convex pieces. `offset` (U, 3): where the centre of a
    unit is in the axes of its shape. `still` (K,): 1 for carriers that stand still for ever.
    """

    names: tuple[str, ...]
    links: int
    rows: FloatArray
    vertices: FloatArray
    boxes: FloatArray
    roots: IntArray
    pieces: tuple[tuple[int, ...], ...]
    shapes: tuple[Primitive | Hull, ...]
    offset: FloatArray
    still: IntArray
    carrier: IntArray = field(init=False)
    """(U,) number of the carrier of each unit."""
    body: IntArray = field(init=False)
    """(U,) number of the body of each unit."""
    piece: IntArray = field(init=False)
    """(U,) number of the piece in its body, or COVER."""
    of_robot: BoolArray = field(init=False)
    """(B,) whether a body is the robot's, its tool's, or the part that it holds."""
    cell: tuple[FloatArray, FloatArray, IntArray] = field(init=False)
    """The tables that kernels read: units, vertices, and which carriers stand still."""
    number: dict[str, int] = field(init=False)
    """Number of each body by its name."""

    def __post_init__(self) -> None:
        for name, column in (("carrier", CARRIER), ("body", BODY), ("piece", PIECE)):
            object.__setattr__(self, name, self.rows[:, column].astype(np.int64))
        object.__setattr__(self, "of_robot", self.carrier[self.roots] < self.links)
        object.__setattr__(self, "cell", (self.rows, self.vertices, self.still))
        object.__setattr__(self, "number", {name: k for k, name in enumerate(self.names)})

    def opened(self, unit: int) -> tuple[int, ...]:
        """The pieces that a bounding box stands for, or the unit itself."""
        return self.pieces[int(self.body[unit])] if self.piece[unit] == COVER else (unit,)


class Bodies:
    """The bodies of a scene, and the arrangements that were asked for."""

    def __init__(self, scene: Scene) -> None:
        robot, links = scene.robot, len(scene.robot.links)
        self._links, self._flange = links, robot.links.index("flange")
        self._frames = {name: links + k for k, name in enumerate(scene.frames)}
        own = [each.body.name for each in robot.bodies] + [body.name for body in scene.tool.bodies]
        self._names = (*own, *scene.index)
        self._number = {name: k for k, name in enumerate(self._names)}
        carrier = [each.link for each in robot.bodies] + [self._flange] * len(scene.tool.bodies)
        carriers = np.array(carrier + [self._frames[each.frame] for each in scene.bodies], dtype=np.int64)
        poses = np.zeros((len(carriers), 4))
        poses[len(own) :] = np.array([_numbers(each.pose) for each in scene.bodies]).reshape(-1, 4)
        self._units = units(scene.pieces)
        self._body = np.repeat(np.arange(len(self._names)), self._units.count)
        self._still = np.array([0] * links + [_stands(frame.law) for frame in scene.frames.values()], dtype=np.int64)
        self._place = np.zeros((len(self._still), 4))
        for name, k in self._frames.items():
            law = scene.frames[name].law
            if self._still[k] and isinstance(law, Fixed):
                self._place[k] = _numbers(law.pose)
        self._write_shapes()
        every = np.arange(len(self._body))
        self._put(self.rows, self.boxes, every, carriers[self._body], poses[self._body])
        self._made: dict[Attachments, Arrangement] = {}

    def __call__(self, attached: Attachments) -> Arrangement:
        """The arrangement in which the held part is carried by the flange and each placed part by its frame."""
        if attached not in self._made:
            moved = [(part, self._frames[frame], pose) for part, frame, pose in attached.placed]
            if attached.held is not None:
                moved.append((attached.held.part, self._flange, attached.held.in_flange))
            self._made[attached] = self._arranged(moved)
        return self._made[attached]

    def _arranged(self, moved: Iterable[tuple[str, int, Pose]]) -> Arrangement:
        rows, boxes = self.rows, self.boxes
        if moved:
            rows, boxes = rows.copy(), boxes.copy()
        for part, carrier, pose in moved:
            mine = np.flatnonzero(self._body == self._number[part])
            self._put(rows, boxes, mine, np.full(len(mine), carrier), np.tile(_numbers(pose), (len(mine), 1)))
        return Arrangement(
            self._names,
            self._links,
            rows,
            self.vertices,
            boxes,
            self._units.first,
            self._pieces,
            self._units.shapes,
            self._offset,
            self._still,
        )

    def _write_shapes(self) -> None:
        """The columns that do not depend on where a body is, and the table of vertices."""
        table: Units = self._units
        count = len(self._body)
        self.rows, self.boxes = np.zeros((count, COLUMNS)), np.full((count, 6), np.nan)
        self._offset = np.zeros((count, 3))
        self.rows[:, BODY], self.rows[:, PIECE] = self._body, table.piece
        self.rows[:, HALF : HALF + 3], self.rows[:, DISC], self.rows[:, BALL] = table.half, table.disc, table.ball
        across = np.hypot(table.half[:, 0], table.half[:, 1]) + table.disc
        self.rows[:, RADIUS] = np.hypot(across, table.half[:, 2]) + table.ball
        vertices, self._corners, first = [np.zeros((0, 3))], {}, 0
        for k in np.flatnonzero([isinstance(shape, Hull) for shape in table.shapes]):
            corners = table.shapes[k].vertices  # type: ignore[union-attr]
            low, high = corners.min(0), corners.max(0)
            # about the middle of the box around it: a hull's own origin may be anywhere
            self._offset[k] = (low + high) / 2
            mine = corners - self._offset[k]
            self._corners[int(k)] = mine
            self.rows[k, HALF : HALF + 3] = (high - low) / 2
            self.rows[k, RADIUS] = np.sqrt((mine * mine).sum(1)).max()
            self.rows[k, VERTEX], self.rows[k, VERTICES] = first, len(mine)
            vertices.append(mine)
            first += len(mine)
        self.vertices = np.concatenate(vertices)
        covers = np.flatnonzero(table.piece[table.first] == COVER)
        roots, whole = table.first[covers], table.count[covers] - 1
        self.rows[roots, OPENED], self.rows[roots, PIECES] = roots + 1, whole
        begins = (table.first + (table.piece[table.first] == COVER)).tolist()
        ends = (table.first + table.count).tolist()
        self._pieces = tuple(tuple(range(begin, end)) for begin, end in zip(begins, ends, strict=True))

    def _put(self, rows: FloatArray, boxes: FloatArray, which: IntArray, carrier: IntArray, pose: FloatArray) -> None:
        """Writes where the units `which` (N,) are: at `pose` (N, 4) of their bodies on `carrier` (N,)."""
        table = self._units
        turn = _turns(pose[:, 3])
        inside = table.position[which] + (table.rotation[which] @ self._offset[which][:, :, None])[:, :, 0]
        centre = pose[:, :3] + (turn @ inside[:, :, None])[:, :, 0]
        axes = turn @ table.rotation[which]
        rows[which, CARRIER] = carrier
        rows[which, CENTRE : CENTRE + 3], rows[which, ROTATION : ROTATION + 9] = centre, axes.reshape(-1, 9)
        corners = {n: self._corners[k] for n, k in enumerate(which.tolist()) if k in self._corners}
        half = table.half[which]
        rows[which, REACH], rows[which, DISTANCE] = extents_of(
            half, table.disc[which], table.ball[which], corners, centre, axes
        )
        boxes[which] = np.nan
        here = np.flatnonzero(self._still[carrier] == 1)
        if len(here):
            stand = self._place[carrier[here]]
            turn = _turns(stand[:, 3])
            middle = stand[:, :3] + (turn @ centre[here][:, :, None])[:, :, 0]
            axes = turn @ axes[here]
            across = np.hypot(axes[..., 0], axes[..., 1]) * table.disc[which[here]][:, None]
            box = rows[which[here], HALF : HALF + 3]
            size = (np.abs(axes) @ box[:, :, None])[:, :, 0] + across + table.ball[which[here]][:, None]
            boxes[which[here], :3], boxes[which[here], 3:] = middle - size, middle + size


def _stands(law: object) -> int:
    """1 for the law of a frame that stands still and is known for ever."""
    return int(isinstance(law, Fixed) and law.valid == (-np.inf, np.inf))


def _numbers(pose: Pose) -> tuple[float, float, float, float]:
    return pose.x, pose.y, pose.z, pose.yaw


def _turns(yaw: FloatArray) -> FloatArray:
    """Rotations (N, 3, 3) about the vertical."""
    found = np.zeros((len(yaw), 3, 3))
    found[:, 0, 0] = found[:, 1, 1] = np.cos(yaw)
    found[:, 1, 0] = np.sin(yaw)
    found[:, 0, 1] = -found[:, 1, 0]
    found[:, 2, 2] = 1.0
    return found
