"""Which bodies must stay how far apart in a phase, kept for all phases of one kind."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.claim import columns as c
from assur.planner.claim.frames import displaced_of
from assur.planner.claim.obligations import Seats, distances_of, phases_of
from assur.planner.collision.bodies import MOST, Arrangement, Bodies, bodies_of
from assur.planner.kernels.pairs import pairs_of_phase
from assur.planner.kernels.solids import EARLY, FIRST, LATE, REQUIRED, SECOND, SET
from assur.planner.kernels.uncertainty import Errors
from assur.planner.model.phases import Phase
from assur.planner.model.refusal import Rule
from assur.planner.model.scene import Scene, bodies_in

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
        tables, self.displaced = distances_of(scene), displaced_of(scene)
        self.required = tables["required"][0]
        self.distances = tables["self_pairs"], self.required, tables["rules"], self.displaced
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
        rows, rules, sets, across, own = pairs_of_phase(
            (seats, arrangement.roots, self.radii),
            self.bodies.frames,
            self.distances,
            (story["off"][0], story["shares"][0], story["contacts"], story["put_down"], story["supports"]),
            phase.near,
            phase.robot,
        )
        mine = arrangement.roots[(seats[:, c.SEAT_LINK] >= 0.0) & phase.robot]
        shift = shift_of(self.displaced, story["shares"][0])
        clock = np.array([start, self.required[c.REQUIRED_LATE], *shift])
        lag = self.required[c.REQUIRED_LAG :][: len(self.scene.robot.joints)].copy()
        apart = rows[:, REQUIRED] >= 0.0
        return Pairs(rows, rows[apart], rows[~apart], rules, across, own, mine, (sets, lag, clock))


def shift_of(displaced: FloatArray, shares: FloatArray) -> tuple[float, float]:
    """How far, m, corrections may shift the tool, which has these `shares` (2 F) in displacements of frames, and by how
    much that grows, m/s."""
    if not len(displaced):
        return 0.0, 0.0
    most = shares.reshape(2, -1)[1, displaced[:, c.DISPLACED_FRAME].astype(np.int64)] * displaced[:, c.DISPLACED_SHARED]
    amount, growth = most @ displaced[:, c.DISPLACED_AMOUNT : c.DISPLACED_GROWTH + 1]
    return float(amount), float(growth)
