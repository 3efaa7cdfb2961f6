"""Which bodies must stay how far apart in a phase (equation N8), from the tables of the claim.

Errors that two bodies have in common do not part them: the bodies on a belt are off by one error, and a controller that
corrects for it shifts the tool by the same. So a body has a share in each displacement of a frame: all of it on that
frame, the tool as much as the claim says, all else none. What counts of a pair is the greatest difference of both
shares.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.claim import columns as c
from assur.planner.claim.frames import displaced_of
from assur.planner.claim.obligations import distances_of, phases_of
from assur.planner.claim.solids import bodies_in
from assur.planner.collision.bodies import Arrangement, Bodies
from assur.planner.kernels.solids import EARLY, FIRST, LATE, PAIR_COLUMNS, REQUIRED, SECOND, SET
from assur.planner.kernels.uncertainty import (
    FLAT,
    FLAT_GROWTH,
    SEGMENT,
    SEGMENTS,
    SET_COLUMNS,
    UPRIGHT,
    UPRIGHT_GROWTH,
    Doubt,
)
from assur.planner.model.phases import Phase
from assur.planner.model.refusal import Rule
from assur.planner.model.scene import Scene

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
    then those within the robot, and of parts that were put down with what passes by. `rules` (P,): what requires the
    distance of each pair, a number of `RULES`. `mine` (R,): units of the robot's bodies. `doubt`: the sets, and what
    else kernels know of uncertainty.
    """

    rows: FloatArray
    rules: IntArray
    across: int
    mine: IntArray
    doubt: Doubt

    def __len__(self) -> int:
        return len(self.rows)

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
        unit of the robot, `placed` without one. Those of which less than 0 is required are left out."""
        found = certain(self.rows[self.rows[:, REQUIRED] >= 0.0])
        found[:, REQUIRED] = np.where(np.isin(found[:, FIRST], self.mine), arm, placed)
        return found[found[:, REQUIRED] >= 0.0]

    def rule(self, one: int, other: int) -> tuple[Rule, float]:
        """What says how far the bodies of two roots must stay apart, before what is uncertain of them, and how far, m:
        less than 0 for a pair that may touch."""
        units = self.rows[:, FIRST : SECOND + 1]
        number = int(np.flatnonzero((units == (one, other)).all(1) | (units == (other, one)).all(1))[0])
        return RULES[self.rules[number]], float(self.rows[number, REQUIRED])


class PairTables:
    """The pairs of a scene by arrangement and kind of phase, made once each."""

    def __init__(self, scene: Scene, bodies: Bodies) -> None:
        self.scene, self.bodies = scene, bodies
        self.tables, self.displaced = distances_of(scene, bodies.carriers), displaced_of(scene)
        self.required = self.tables["required"][0]
        known = [frame.uncertainty for frame in scene.frames.values()]
        self._radii = np.array([body.radius for body in bodies_in(scene)])
        self._yaw = np.array([each.yaw_rad for each in known])
        moves = bodies.still[bodies.links :, None] == 0
        self._late = np.array([each.shift_s for each in known]).reshape(-1, 2) * moves
        self._moves = moves[:, 0]
        self._made: dict[tuple[object, ...], Pairs] = {}

    def __call__(self, arrangement: Arrangement, phase: Phase) -> Pairs:
        """The pairs of a phase, in the arrangement that it has."""
        key = (
            arrangement, phase.near, phase.tracked, phase.corrected, phase.contacts, phase.contact_tolerance_m,
            phase.handled, phase.robot,
        )  # fmt: skip
        if key not in self._made:
            self._made[key] = self._pairs(arrangement, phase)
        return self._made[key]

    def _pairs(self, arrangement: Arrangement, phase: Phase) -> Pairs:
        story, seats = phases_of(self.scene, self.bodies.carriers, self.bodies.seats, [phase]), arrangement.seats
        link, frame = seats[:, c.SEAT_LINK].astype(np.int64), seats[:, c.SEAT_FRAME].astype(np.int64)
        around = np.flatnonzero(link < 0)
        mine = np.flatnonzero(link >= 0) if phase.robot else np.zeros(0, dtype=np.int64)
        across = len(mine) * len(around)
        i, k = (mine[each] for each in np.triu_indices(len(mine), 1))
        within = (link[i] != link[k]) & (self.tables["self_pairs"][link[i], link[k]] > 0.0)
        moves = np.where(link < 0, self._moves[frame] if len(self._moves) else False, False)
        others, done = [np.zeros((2, 0), dtype=np.int64)], list[int]()
        for part, supports in zip(story["put_down"][:, c.PUT_BODY].astype(np.int64), story["supports"], strict=True):
            # what does not move against a part, it was proved to stay clear of while it was put down
            passes = (link < 0) & (frame != frame[part]) & (moves | moves[part]) & (supports == 0.0)
            passes[done] = False
            done.append(part)
            b = np.flatnonzero(passes)
            others.append(np.stack((np.full(len(b), part), b)))
        placed = np.concatenate(others, 1)
        first = np.concatenate((np.repeat(mine, len(around)), i[within], placed[0]))
        second = np.concatenate((np.tile(around, len(mine)), k[within], placed[1]))
        near = np.full(len(first), phase.near)
        near[len(first) - placed.shape[1] :] = True
        rows = np.empty((len(first), PAIR_COLUMNS))
        rows[:, FIRST], rows[:, SECOND] = arrangement.roots[first], arrangement.roots[second]
        rows[:, REQUIRED], rules = self._distances(first, second, near, story["contacts"])
        sets, rows[:, SET] = self._sets(first, second, across, seats, story)
        # the robot may start late, and then all else is ahead of it while it moves
        behind, ahead = np.zeros(len(link)), np.full(len(link), self.required[c.REQUIRED_LATE])
        if len(self._late):
            behind, ahead = np.where(link < 0, self._late[frame].T, (behind, ahead))
        rows[:, EARLY] = np.where(moves[second], behind[first] - ahead[second], 0.0)
        rows[:, LATE] = np.where(moves[second], ahead[first] - behind[second], 0.0)
        shift = shift_of(self.displaced, story["shares"][0])
        clock = np.array([self.required[c.REQUIRED_SINCE], self.required[c.REQUIRED_LATE], *shift])
        lag = self.required[c.REQUIRED_LAG :][: len(self.scene.robot.joints)].copy()
        return Pairs(rows, rules, across, arrangement.roots[mine], (sets, lag, clock))

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
        if not (off.any() or self._yaw.any() or len(self.displaced)):
            return np.zeros((0, SET_COLUMNS)), np.full(len(first), -1.0)
        frame = seats[:, c.SEAT_FRAME].astype(np.int64)
        sets: FloatArray = np.zeros((len(first), SET_COLUMNS))
        flat, upright = off.reshape(2, -1)
        far = np.hypot(seats[:, c.SEAT_POSE], seats[:, c.SEAT_POSE + 1]) + self._radii
        flat = flat + np.where(link < 0.0, self._yaw[frame] * far, 0.0)
        sets[:, FLAT], sets[:, UPRIGHT] = flat[first] + flat[second], upright[first] + upright[second]
        free, tool = np.full(len(first), SEGMENTS), link >= self.required[c.REQUIRED_TOOL]
        for own in self.displaced:
            f, direction = int(own[c.DISPLACED_FRAME]), own[c.DISPLACED_DIRECTION : c.DISPLACED_AMOUNT]
            of_tool = shares.reshape(2, -1)[:, f, None] * own[c.DISPLACED_SHARED] * tool
            least, most = np.where(frame == f, 1.0, of_tool)
            share = np.maximum(abs(most[first] - least[second]), abs(least[first] - most[second]))
            size = share[:, None] * own[c.DISPLACED_AMOUNT : c.DISPLACED_GROWTH + 1]
            named = np.flatnonzero(share > 0.0)
            if own[c.DISPLACED_LEVEL] > 0.0:
                sets[:, FLAT : FLAT_GROWTH + 1] += size
            elif not direction[:2].any():
                sets[:, UPRIGHT : UPRIGHT_GROWTH + 1] += size * abs(direction[2])
            else:
                # more than there is room for: in every direction
                rest, fits = named[free[named] >= SET_COLUMNS], named[free[named] < SET_COLUMNS]
                sets[rest, FLAT : FLAT_GROWTH + 1] += size[rest]
                sets[rest, UPRIGHT : UPRIGHT_GROWTH + 1] += size[rest] * abs(direction[2])
                at = free[fits, None] + np.arange(SEGMENT)
                sets[fits[:, None], at] = np.column_stack((size[fits], np.tile(direction, (len(fits), 1))))
                free[fits] += SEGMENT
        table, number = np.unique(sets, axis=0, return_inverse=True)
        none: BoolArray = np.asarray(~sets.any(1), dtype=np.bool_)
        none[:across] = False  # with a set, also with an empty one, the coarse score of a motion tries other normals
        return table, np.where(none, -1.0, number.reshape(-1))


def shift_of(displaced: FloatArray, shares: FloatArray) -> tuple[float, float]:
    """How far, m, corrections may shift the tool, which has these `shares` (2 F) in displacements of frames, and by how
    much that grows, m/s."""
    most = shares.reshape(2, -1)[1, displaced[:, c.DISPLACED_FRAME].astype(np.int64)] * displaced[:, c.DISPLACED_SHARED]
    amount, growth = most @ displaced[:, c.DISPLACED_AMOUNT : c.DISPLACED_GROWTH + 1]
    return float(amount), float(growth)
