"""The bodies of a cell as rows of numbers: one *unit* per convex piece, and one per bounding box of a body of several.

A unit is carried by a link of the robot (0..L-1) or a frame of the cell (L..L+F-1). Which body is carried by what
depends on the phase: the seats of a claim say so, and an `Arrangement` is the units on one set of seats. The columns of
units are those of `assur.planner.kernels.solids`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import accumulate

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.claim import columns as c
from assur.planner.claim.frames import displaced_of
from assur.planner.claim.obligations import Seats, carriers_of, distances_of, phases_of, seat_of, seats_of
from assur.planner.geometry.shapes import Hull, Primitive
from assur.planner.kernels.links import POSE_COLUMNS, put_upright
from assur.planner.kernels.solids import (
    BODY,
    CARRIER,
    COLUMNS,
    COVER,
    EARLY,
    FIRST,
    LATE,
    PAIR_COLUMNS,
    PIECE,
    PIECES,
    REQUIRED,
    SECOND,
    SET,
    Units,
    place,
)
from assur.planner.kernels.uncertainty import (
    FLAT,
    FLAT_GROWTH,
    SEGMENT,
    SEGMENTS,
    SET_COLUMNS,
    UPRIGHT,
    UPRIGHT_GROWTH,
    Errors,
)
from assur.planner.kernels.units import seat_bodies, write_units
from assur.planner.model.attachments import Attachments, at_start
from assur.planner.model.phases import Phase
from assur.planner.model.refusal import Rule
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
        self._fixed, self.yaw, self.late = np.zeros(count, np.bool_), np.zeros(count), np.zeros((2, count))
        """Which frames never move, by how much each may be turned, rad, and how late it may be, s, least and most."""
        self._places = np.empty((self.links + count, POSE_COLUMNS))
        """Where carriers are that stand still for ever; NaN: the others."""
        self._places[:] = np.nan
        for k, frame in enumerate(scene.frames.values()):
            law, self.yaw[k] = frame.law, frame.uncertainty.yaw_rad
            self._fixed[k] = law.is_fixed
            if self._fixed[k] and law.valid == (-np.inf, np.inf):
                at = law.numbers.pose
                put_upright(self._places, self.links + k, at.x, at.y, at.z, math.cos(at.yaw), math.sin(at.yaw))
            else:
                self.late[:, k] = frame.uncertainty.shift_s
        self.still = np.isfinite(self._places[:, 0]).astype(np.int64)
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


# Which bodies must stay how far apart in a phase (equation N8), from the tables of the claim.
#
# Errors that two bodies have in common do not part them: the bodies on a belt are off by one error, and a controller
# that corrects for it shifts the tool by the same. So a body has a share in each displacement of a frame: all of it on
# that frame, the tool as much as the claim says, all else none. What counts of a pair is the greatest difference of
# both shares.

MANY = 64
"""Pairs of robot and surroundings from which on planes are sought: for fewer, rows of pairs cost less."""
RULES: tuple[Rule, ...] = ("travel", "near", "exception", "contact")
"""What says how far apart a pair must stay, by its number."""


def certain(pairs: FloatArray) -> FloatArray:
    """A copy of pairs (P, PAIR_COLUMNS) for the case that all is where it is planned."""
    found = pairs.copy()
    found[:, SET], found[:, EARLY : LATE + 1] = -1.0, 0.0
    return found


@dataclass(frozen=True, eq=False)
class Pairs:
    """What must be kept apart in phases of one kind. Distances in m, times in s.

    `rows` (P, PAIR_COLUMNS): the robot's bodies against all of the surroundings, which are the first `across` pairs;
    then those within the robot, with which the first `own` pairs end; then those of parts that were put down with what
    passes by. `rules` (P,): what requires the distance of each pair, a number of `RULES`. `mine` (R,): units of the
    robot's bodies. `errors`: the sets, and what else kernels know of uncertainty. `apart`: the rows of pairs that must
    not touch; `touching`: those that may.
    """

    rows: FloatArray
    apart: FloatArray
    touching: FloatArray
    rules: IntArray
    across: int
    own: int
    mine: IntArray
    errors: Errors

    def __len__(self) -> int:
        return len(self.rows)

    def since(self, start: float) -> Pairs:
        """The pairs of a plan that begins at another time, s."""
        sets, lag, clock = self.errors
        return replace(self, errors=(sets, lag, np.array([start, *clock[1:].tolist()])))

    @property
    def many(self) -> bool:
        """Whether there are so many that planes between them are worth their rows."""
        return self.across > MANY

    def number(self, arrangement: Arrangement) -> IntArray:
        """(U,) number of each unit in `mine`, -1 for all others."""
        found = np.full(len(arrangement.rows), -1)
        found[self.mine] = np.arange(len(self.mine))
        return found

    def exactly(self, arm: float, placed: float) -> FloatArray:
        """Pairs (P, PAIR_COLUMNS) that may not touch, with other distances, m, where nothing is uncertain: `arm` with a
        unit of the robot, `placed` without one. Pairs with less than 0 are left out."""
        found = certain(self.rows)
        found[: self.own, REQUIRED], found[self.own :, REQUIRED] = arm, placed
        return found[(self.rows[:, REQUIRED] >= 0.0) & (found[:, REQUIRED] >= 0.0)]

    def rule(self, one: int, other: int) -> tuple[Rule, float]:
        """What says how far the bodies of two roots must stay apart, before what is uncertain of them, and how far, m:
        less than 0 for a pair that may touch."""
        first, second = self.rows[:, FIRST], self.rows[:, SECOND]
        either = ((first == one) & (second == other)) | ((first == other) & (second == one))
        number = int(either.nonzero()[0][0])
        return RULES[self.rules[number]], float(self.rows[number, REQUIRED])


def _none_yet(_: Scene) -> list[PairTables]:
    """The pairs of a cell."""
    return []


def pair_tables_of(scene: Scene) -> PairTables:
    """The pairs of a scene, kept with its cell until there are too many when a plan begins."""
    kept = scene.kept.of(_none_yet, scene, scene.start.holding, scene.options.clearance, scene.execution)
    if not kept or len(kept[0].made) > MOST:
        kept[:] = [PairTables(scene, bodies_of(scene))]
    return kept[0]


class PairTables:
    """The pairs of a cell by arrangement, kind of phase and start, `made` once each: of scenes in which the same part
    is held at the start, with the same distances and execution."""

    def __init__(self, scene: Scene, bodies: Bodies) -> None:
        self.scene, self.bodies = scene, bodies
        self.seats = Seats(bodies.seats, ())
        """What `phases_of` needs of them where the arrangement has the seats."""
        self.tables, self.displaced = distances_of(scene), displaced_of(scene)
        self.required = self.tables["required"][0]
        self.radii = np.array([body.radius for body in bodies_in(scene)])
        self.made: dict[tuple[object, ...], Pairs] = {}
        self._of_kind: dict[tuple[object, ...], Pairs] = {}
        """The last that were made of each kind, for whatever start."""

    def __call__(self, arrangement: Arrangement, phase: Phase, start: float = math.nan) -> Pairs:
        """The pairs of a phase, in the arrangement that it has, of a plan that begins at `start`, s (NaN: their errors
        are not known)."""
        kind = (
            arrangement, phase.near, phase.tracked, phase.corrected, phase.contacts, phase.contact_tolerance_m,
            phase.handled, phase.robot,
        )  # fmt: skip
        found = self.made.get((start, *kind))
        if found is None:
            known = self._of_kind.get(kind)
            found = self._pairs(arrangement, phase, start) if known is None else known.since(start)
            self._of_kind[kind] = self.made[start, *kind] = found
        return found

    def _pairs(self, arrangement: Arrangement, phase: Phase, start: float) -> Pairs:
        story, seats = phases_of(self.scene, self.bodies.carriers, self.seats, [phase]), arrangement.seats
        link, frame = seats[:, c.SEAT_LINK].astype(np.int64), seats[:, c.SEAT_FRAME].astype(np.int64)
        around, mine = (link < 0).nonzero()[0], ((link >= 0) & phase.robot).nonzero()[0]
        across = len(mine) * len(around)
        on = link[mine]
        within = (self.tables["self_pairs"][on[:, None], on] > 0.0) & (on[:, None] != on) & (mine[:, None] < mine)
        i, k = mine[np.array(within.nonzero())]
        moves = (link < 0) & (self.bodies.still[frame + self.bodies.links] == 0)
        first = [mine.repeat(len(around)), i]
        second, done = [around[None].repeat(len(mine), 0).ravel(), k], list[int]()
        own = across + len(first[1])
        for part, supports in zip(story["put_down"][:, c.PUT_BODY].astype(np.int64), story["supports"], strict=True):
            # what does not move against a part, it was proved to stay clear of while it was put down
            passes = (link < 0) & (frame != frame[part]) & (moves | moves[part]) & (supports == 0.0)
            passes[done] = False
            done.append(part)
            b = np.flatnonzero(passes)
            first.append(np.full(len(b), part))
            second.append(b)
        one, other = np.concatenate(first), np.concatenate(second)
        near = np.empty(len(one), dtype=np.bool_)
        near[:own], near[own:] = phase.near, True
        rows = np.zeros((len(one), PAIR_COLUMNS))
        rows[:, FIRST], rows[:, SECOND] = arrangement.roots[one], arrangement.roots[other]
        rows[:, REQUIRED], rules = self._distances(one, other, near, story["contacts"])
        sets, rows[:, SET] = self._sets(one, other, across, seats, story)
        if moves.any():
            # the robot may start late, and then all else is ahead of it while it moves
            late = np.where(link < 0, self.bodies.late[:, frame], [[0.0], [self.required[c.REQUIRED_LATE]]])
            rows[:, EARLY] = np.where(moves[other], late[0, one] - late[1, other], 0.0)
            rows[:, LATE] = np.where(moves[other], late[1, one] - late[0, other], 0.0)
        shift = shift_of(self.displaced, story["shares"][0])
        clock = np.array([start, self.required[c.REQUIRED_LATE], *shift])
        lag = self.required[c.REQUIRED_LAG :][: len(self.scene.robot.joints)].copy()
        apart = rows[:, REQUIRED] >= 0.0
        parted = rows[apart], rows[~apart]
        return Pairs(rows, *parted, rules, across, own, arrangement.roots[mine], (sets, lag, clock))

    def _distances(
        self, first: IntArray, second: IntArray, near: BoolArray, contacts: FloatArray
    ) -> tuple[FloatArray, IntArray]:
        """The required distances of pairs of bodies, m, and which rule each has; of those that name a pair the last
        counts."""
        need = np.where(near, self.required[c.REQUIRED_NEAR], self.required[c.REQUIRED_TRAVEL])
        rules, many = near.astype(np.int64), len(self.bodies.names)
        for rule in self.tables["rules"]:
            one, other = rule[c.RULE_SIDE :].reshape(2, many) > 0.0
            named = (one[first] & other[second]) | (one[second] & other[first])
            need[named], rules[named] = np.where(near, rule[c.RULE_NEAR], rule[c.RULE_TRAVEL])[named], 2
        for _, one, other, depth in contacts:
            named = ((first == one) & (second == other)) | ((first == other) & (second == one))
            need[named], rules[named] = -depth, 3
        return need, rules

    def _sets(
        self, first: IntArray, second: IntArray, across: int, seats: FloatArray, story: dict[str, FloatArray]
    ) -> tuple[FloatArray, FloatArray]:
        """What two bodies of a pair may be displaced against each other: the sets (N, SET_COLUMNS) of
        `kernels.uncertainty`, and the number of that of each pair; -1: none. The first `across` pairs have one."""
        (off,), (shares,), link = story["off"], story["shares"], seats[:, c.SEAT_LINK]
        if not (off.any() or self.bodies.yaw.any() or len(self.displaced)):
            return np.zeros((0, SET_COLUMNS)), np.full(len(first), -1.0)
        frame = seats[:, c.SEAT_FRAME].astype(np.int64)
        sets: FloatArray = np.zeros((len(first), SET_COLUMNS))
        flat, upright = off.reshape(2, -1)
        far = np.hypot(seats[:, c.SEAT_POSE], seats[:, c.SEAT_POSE + 1]) + self.radii
        flat = flat + np.where(link < 0.0, self.bodies.yaw[frame] * far, 0.0)
        sets[:, FLAT], sets[:, UPRIGHT] = flat[first] + flat[second], upright[first] + upright[second]
        free, tool = np.full(len(first), SEGMENTS), link >= self.required[c.REQUIRED_TOOL]
        for own in self.displaced:
            f, direction = int(own[c.DISPLACED_FRAME]), own[c.DISPLACED_DIRECTION : c.DISPLACED_AMOUNT]
            of_tool = shares.reshape(2, -1)[:, f, None] * own[c.DISPLACED_SHARED] * tool
            least, most = np.where(frame == f, 1.0, of_tool)
            share = np.maximum(abs(most[first] - least[second]), abs(least[first] - most[second]))
            size = share[:, None] * own[c.DISPLACED_AMOUNT : c.DISPLACED_GROWTH + 1]
            level, aside = own[c.DISPLACED_LEVEL] > 0.0, direction[:2].any()
            fits = np.flatnonzero((share > 0.0) & (free < SET_COLUMNS) & (aside and not level))
            at = free[fits, None] + np.arange(SEGMENT)
            sets[fits[:, None], at] = np.column_stack((size[fits], np.tile(direction, (len(fits), 1))))
            free[fits] += SEGMENT
            size[fits] = 0.0
            # more than there is room for: in every direction
            sets[:, FLAT : FLAT_GROWTH + 1] += size * (level or aside)
            sets[:, UPRIGHT : UPRIGHT_GROWTH + 1] += size * (0.0 if level else abs(direction[2]))
        table, number = _different(sets)
        none: BoolArray = np.asarray(~sets.any(1), dtype=np.bool_)
        none[:across] = False  # with a set, also with an empty one, the coarse score of a motion tries other normals
        return table, np.where(none, -1.0, number)


def _different(rows: FloatArray) -> tuple[FloatArray, IntArray]:
    """The different ones of rows (N, M), each where it comes first, and which of these each row is (N,)."""
    content, size, number = rows.tobytes(), rows.itemsize * rows.shape[1], dict[bytes, int]()
    which = [number.setdefault(content[k : k + size], len(number)) for k in range(0, len(content), size)]
    return np.frombuffer(b"".join(number)).reshape(-1, rows.shape[1]).copy(), np.array(which, dtype=np.int64)


def shift_of(displaced: FloatArray, shares: FloatArray) -> tuple[float, float]:
    """How far, m, corrections may shift the tool, which has these `shares` (2 F) in displacements of frames, and by how
    much that grows, m/s."""
    if not len(displaced):
        return 0.0, 0.0
    most = shares.reshape(2, -1)[1, displaced[:, c.DISPLACED_FRAME].astype(np.int64)] * displaced[:, c.DISPLACED_SHARED]
    amount, growth = most @ displaced[:, c.DISPLACED_AMOUNT : c.DISPLACED_GROWTH + 1]
    return float(amount), float(growth)
