"""The bodies of a cell as rows of numbers: one *unit* per convex piece, and one per bounding box of a body of several.

A unit is carried by a link of the robot (0..L-1) or a frame of the cell (L..L+F-1). Which body is carried by what
depends on the phase: the seats of a claim say so, and an `Arrangement` is the units on one set of seats. The columns of
units are those of `assur.planner.kernels.solids`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.claim import columns as c
from assur.planner.claim.obligations import carriers_of, seat_of, seats_of
from assur.planner.claim.solids import bodies_in
from assur.planner.geometry.shapes import Hull, Primitive
from assur.planner.kernels.links import POSE_COLUMNS
from assur.planner.kernels.solids import BODY, CARRIER, COLUMNS, COVER, PIECE, PIECES, place
from assur.planner.kernels.units import OFFSET, OWN_COLUMNS, seat_bodies, write_units
from assur.planner.laws import Law
from assur.planner.model.attachments import Attachments, at_start
from assur.planner.model.scene import Scene

__all__ = ["COVER", "Arrangement", "Bodies"]


@dataclass(frozen=True, eq=False)
class Arrangement:
    """The units (U,) of a cell while bodies are on certain `seats` (B, c.SEAT).

    `rows` (U, COLUMNS) are the table of the kernels; `boxes` (U, 6) are the least and greatest coordinates of what
    stands still, in the world, NaN for what does not.
    """

    bodies: Bodies
    seats: FloatArray
    rows: FloatArray
    boxes: FloatArray

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the bodies (B,)."""
        return self.bodies.names

    @property
    def number(self) -> dict[str, int]:
        """Number of each body by its name."""
        return self.bodies.carriers.body

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
        return np.asarray(self.seats[:, c.SEAT_LINK] >= 0.0)

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

    def placed(self, carriers: FloatArray, units: Iterable[int]) -> FloatArray:
        """(1, U, POSE_COLUMNS) centre and axes in the world of `units`, with their carriers (K, 12) where they are."""
        placed = np.empty((1, len(self.rows), POSE_COLUMNS))
        for unit in units:
            place(self.rows, unit, carriers, placed, 0)
        return placed


class Bodies:
    """The bodies of a scene, and the arrangements that were required."""

    def __init__(self, scene: Scene) -> None:
        self.scene, table = scene, scene.pieces
        self.names = tuple(body.name for body in bodies_in(scene))
        self.carriers = carriers_of(scene, self.names)
        self.seats = seats_of(scene, self.carriers)
        self.links, self.pieces = len(scene.robot.links), table
        places = [NOWHERE] * self.links + [_place(frame.law) for frame in scene.frames.values()]
        self.still = np.array([int(place is not NOWHERE) for place in places], dtype=np.int64)
        self._places = np.array(places)
        self.vertices = np.concatenate([np.zeros((0, 3)), *(hull.vertices for hull in table.hulls)])
        begins = np.cumsum([0, *(len(hull.vertices) for hull in table.hulls)])
        many, core = len(table.shapes) + len(self.names), np.empty((len(table.shapes), 5))
        core[:, :3], core[:, 3], core[:, 4] = table.half, table.disc, table.ball
        rows, own = np.zeros((many, COLUMNS)), np.zeros((many, OWN_COLUMNS))
        self.roots = np.empty_like(table.count)
        position, rotation = np.array(table.position), np.array(table.rotation)
        units = write_units(
            np.array(table.count), position, rotation, core, np.array(table.hull), begins, self.vertices, rows, own,
            self.roots,
        )  # fmt: skip
        self.own = own[:units]
        start = Arrangement(self, self.seats.rows, rows[:units], np.empty((units, 6)))
        self._seat(start, range(len(self.names)))
        self._made = {at_start(scene): start}

    def __call__(self, attached: Attachments) -> Arrangement:
        """The arrangement in which the held part is carried by the flange and each placed part by its frame."""
        found = self._made.get(attached)
        if found is None:
            first = at_start(self.scene)
            start, moved = self._made[first], {part for part, _, _ in attached.placed}
            moved |= {each.held.part for each in (first, attached) if each.held is not None}
            found = Arrangement(self, start.seats.copy(), start.rows.copy(), start.boxes.copy())
            numbers = [self.carriers.body[part] for part in sorted(moved)]
            for number in numbers:
                found.seats[number] = seat_of(self.scene, self.carriers, attached, self.names[number])
            self._seat(found, numbers)
            self._made[attached] = found
        return found

    def _seat(self, made: Arrangement, numbers: Iterable[int]) -> None:
        """Puts the units of some bodies on their seats."""
        chosen = np.array(numbers, dtype=np.int64)
        seat_bodies(
            self.own, self.vertices, self.roots, made.seats, chosen, self.links, self._places, made.rows, made.boxes
        )


NOWHERE = (np.nan, np.nan, np.nan, np.nan)
"""The place of a carrier that does not stand still."""


def _place(law: Law) -> tuple[float, float, float, float]:
    """The pose of a frame that stands still and is known for ever."""
    if not (law.is_fixed and law.valid == (-np.inf, np.inf)):
        return NOWHERE
    pose = law.numbers.pose
    return pose.x, pose.y, pose.z, pose.yaw
