"""The bodies of a cell as rows of numbers: one *unit* per convex piece, and one per bounding box of a body of several.

A unit is carried by a link of the robot (0..L-1) or a frame of the cell (L..L+F-1). Which body is carried by what
depends on the phase: the seats of a claim say so, and an `Arrangement` is the units on one set of seats. The columns of
units are those of `assur.planner.kernels.solids`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from itertools import accumulate

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.claim import columns as c
from assur.planner.claim.obligations import carriers_of, seat_of, seats_of
from assur.planner.geometry.shapes import Hull, Primitive
from assur.planner.kernels.links import POSE_COLUMNS, put_upright
from assur.planner.kernels.pairs import Frames
from assur.planner.kernels.solids import BODY, CARRIER, COLUMNS, COVER, PIECE, PIECES, Units, place
from assur.planner.kernels.units import seat_bodies, write_units
from assur.planner.model.attachments import Attachments, at_start
from assur.planner.model.scene import Scene, bodies_in

__all__ = ["COVER", "Arrangement", "Bodies"]


class Arrangement:
    """The units (U,) of a cell while bodies are on certain `seats` (B, c.SEAT).

    `rows` (U, COLUMNS) are the table of the kernels; `boxes` (U, 6) are the least and greatest coordinates of what
    stands still, in the world, NaN for what does not. `carrier`, `body`, `piece` (U,): numbers of each unit's carrier,
    body, and piece in its body, or COVER. `names`, `number`, `roots`: of the bodies (B,) in order, by their names, and
    the unit that stands for all of each; `of_robot` (B,): whether a body is the robot's, its tool's, or the part that
    it holds. `links`: how many carriers are links. `cell`: what kernels read: units, vertices, and which carriers stand
    still for ever (1), (K,).
    """

    def __init__(self, bodies: Bodies, seats: FloatArray, rows: FloatArray, boxes: FloatArray) -> None:
        self.bodies, self.seats, self.rows, self.boxes = bodies, seats, rows, boxes
        self.names, self.number, self.roots, self.links = bodies.names, bodies.carriers.body, bodies.roots, bodies.links
        self.cell = rows, bodies.vertices, bodies.still
        self.carrier, self.body, self.piece = rows[:, [CARRIER, BODY, PIECE]].T.astype(np.int64)
        self.of_robot: BoolArray = seats[:, c.SEAT_LINK] >= 0.0

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
        return np.asarray(self.bodies.offset[unit])

    def placed(self, carriers: FloatArray, units: Iterable[int]) -> Units:
        """Rows, vertices, and (1, U, POSE_COLUMNS) centre and axes in the world of `units`, with their carriers (K, 12)
        where they are."""
        placed = np.empty((1, len(self.rows), POSE_COLUMNS))
        for unit in units:
            place(self.rows, unit, carriers, placed, 0)
        return self.rows, self.bodies.vertices, placed


MOST = 64
"""Arrangements that are kept, and pairs. When there are more, all but the arrangement of the start are dropped."""


def bodies_of(scene: Scene) -> Bodies:
    """The bodies of a scene, kept with its cell."""
    return scene.kept.of(Bodies, scene, scene.start.holding)


class Bodies:
    """The bodies of a cell, and arrangements of them: of those scenes in which the same part is held at the start."""

    def __init__(self, scene: Scene) -> None:
        self.scene, table, every = scene, scene.pieces, bodies_in(scene)
        self.names = tuple([body.name for body in every])
        self.hollow = {body.name: body.surface for body in every if body.surface is not None}
        """The surfaces of those that are meshes, by name."""
        self.carriers = carriers_of(scene)
        self.links, self.pieces = len(scene.robot.links), table
        count = len(scene.frames)
        self._fixed, turned, late = np.zeros(count, np.bool_), np.zeros(count), np.zeros((2, count))
        self._places = np.empty((self.links + count, POSE_COLUMNS))
        """Where carriers are that stand still for ever; NaN: the others."""
        self._places[:] = np.nan
        for k, frame in enumerate(scene.frames.values()):
            law, turned[k] = frame.law, frame.uncertainty.yaw_rad
            self._fixed[k] = law.is_fixed
            if self._fixed[k] and law.valid == (-np.inf, np.inf):
                at = law.numbers.pose
                put_upright(self._places, self.links + k, at.x, at.y, at.z, math.cos(at.yaw), math.sin(at.yaw))
            else:
                late[:, k] = frame.uncertainty.shift_s
        self.still = np.isfinite(self._places[:, 0]).astype(np.int64)
        self.frames: Frames = self.still[self.links :], turned, late
        self.vertices = np.concatenate([np.zeros((0, 3)), *[hull.vertices for hull in table.hulls]])
        begins = np.array([0, *accumulate([len(hull.vertices) for hull in table.hulls])])
        many, core = len(table.shapes) + len(self.names), [table.half, table.disc[:, None], table.ball[:, None]]
        own, offset, self.roots = np.zeros((many, COLUMNS)), np.zeros((many, 3)), np.empty_like(table.count)
        units = write_units(
            table.count.copy(), table.position.copy(), table.rotation.copy(), np.concatenate(core, 1),
            table.hull.copy(), begins, self.vertices, own, offset, self.roots,
        )  # fmt: skip
        self.own, self.offset = own[:units], offset[:units]
        self.seats = seats_of(scene, self.carriers).rows
        start = self._seated(self.seats, self.own.copy(), np.empty((units, 6)), range(len(self.names)))
        self._start = at_start(scene), start
        self._made = dict([self._start])

    def __call__(self, attached: Attachments) -> Arrangement:
        """The arrangement in which the held part is carried by the flange and each placed part by its frame."""
        found = self._made.get(attached)
        if found is None:
            (first, start), moved = self._start, {part for part, _, _ in attached.placed}
            moved |= {each.held.part for each in (first, attached) if each.held is not None}
            seats, numbers = start.seats.copy(), [self.carriers.body[part] for part in sorted(moved)]
            for number in numbers:
                seats[number] = seat_of(self.scene, self.carriers, attached, self.names[number])
            found = self._seated(seats, start.rows.copy(), start.boxes.copy(), numbers)
            if len(self._made) >= MOST:
                self._made = dict([self._start])
            self._made[attached] = found
        return found

    def keeping(self, arrangement: Arrangement, frame: str) -> BoolArray:
        """Which bodies (B,) of the surroundings are on a frame, or on one that never moves against it."""
        on, own = arrangement.seats[:, c.SEAT_FRAME].astype(np.int64), self.carriers.frame[frame]
        return np.asarray((on == own) | ((on >= 0) & self._fixed[own] & self._fixed[on]))

    def _seated(self, seats: FloatArray, rows: FloatArray, boxes: FloatArray, numbers: Iterable[int]) -> Arrangement:
        """The arrangement on these seats; of the rows and boxes those of some bodies are written."""
        chosen = np.array(numbers, dtype=np.int64)
        seat_bodies(self.own, self.vertices, self.roots, seats, chosen, self.links, self._places, rows, boxes)
        return Arrangement(self, seats, rows, boxes)
