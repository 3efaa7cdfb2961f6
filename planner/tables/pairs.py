"""Which bodies must stay how far apart (equation N8): phases, contacts, clearance and uncertainty as numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations_with_replacement

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.kernels.solids import CARRIER, EARLY, FIRST, LATE, PAIR_COLUMNS, REQUIRED, SECOND, SET
from assur.planner.kernels.uncertainty import Doubt
from assur.planner.model.clearance import clearances, contact_gap
from assur.planner.model.phases import Phase, pair
from assur.planner.model.scene import Scene
from assur.planner.tables.bodies import Arrangement
from assur.planner.tables.uncertainty import ARM, BASE, HELD, TOOL, Displacements, Seat

MANY = 64
"""Pairs of a phase from which on planes are looked for: for fewer, rows of pairs cost less."""


@dataclass(frozen=True, eq=False)
class Pairs:
    """What must be kept apart in phases of one kind. Distances in m, times in s.

    `mine` (R,): units of the robot's bodies, and their `kinds` (R,). `others` (O, PAIR_COLUMNS - 1): units of the
    surroundings and what is required of them, the columns of a pair without its first unit; the set is that of the
    first kind. `own` (S, PAIR_COLUMNS): pairs within the robot, and of parts that were put down with what passes by.
    `special` (A, PAIR_COLUMNS): pairs that may touch, or may be nearer, with what is required of them instead. `doubt`:
    the sets, and what else kernels know of uncertainty.
    """

    mine: IntArray
    kinds: IntArray
    others: FloatArray
    own: FloatArray
    special: FloatArray
    doubt: Doubt

    @property
    def many(self) -> bool:
        """Whether there are so many that planes between them are worth their rows."""
        return len(self.mine) * len(self.others) > MANY

    @cached_property
    def every(self) -> FloatArray:
        """All pairs (P, PAIR_COLUMNS): the robot's bodies against all others, then those of `own`."""
        found = np.empty((len(self.mine) * len(self.others) + len(self.own), PAIR_COLUMNS))
        across = found[: len(found) - len(self.own)]
        across[:, FIRST] = np.repeat(self.mine, len(self.others))
        across[:, SECOND:] = np.tile(self.others, (len(self.mine), 1))
        across[:, SET] += np.where(across[:, SET] >= 0.0, np.repeat(self.kinds, len(self.others)), 0)
        for row in self.special:
            across[(across[:, FIRST] == row[FIRST]) & (across[:, SECOND] == row[SECOND])] = row
        found[len(across) :] = self.own
        return found

    def exactly(self, arm: float, placed: float) -> FloatArray:
        """Pairs (P, PAIR_COLUMNS) that may not touch, with other distances, m, where nothing is uncertain: `arm` with a
        unit of the robot, `placed` without one. Those of which less than 0 is required are left out."""
        found = self.every[self.every[:, REQUIRED] >= 0.0]
        found[:, REQUIRED] = np.where(np.isin(found[:, FIRST], self.mine), arm, placed)
        found[:, SET], found[:, EARLY:] = -1.0, 0.0
        return found[found[:, REQUIRED] >= 0.0]

    def __len__(self) -> int:
        return len(self.mine) * len(self.others) + len(self.own)


class PairTables:
    """The pairs of a scene by arrangement and kind of phase, made once each."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        number = scene.robot.links.index
        links = len(scene.robot.links)
        self._wanted: BoolArray = np.zeros((links, links), dtype=np.bool_)
        """(L, L) between the bodies of which links a distance is required."""
        for one, other in (map(number, names) for names in scene.robot.self_pairs):
            self._wanted[one, other] = self._wanted[other, one] = one != other
        arms = {"link1": ARM, "link2": ARM, "base": BASE}
        self._kinds = [arms.get(name, TOOL) for name in scene.robot.links]
        self._lag = np.zeros(len(scene.robot.joints))
        if scene.execution.lags:
            self._lag[:] = scene.execution.lag
        self._made: dict[tuple[object, ...], Pairs] = {}
        self._shifts: FloatArray | None = None

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
        scene, roots, of_robot = self.scene, arrangement.roots, arrangement.of_robot
        sets, execution = Displacements(scene, phase), scene.execution
        carrier = arrangement.rows[roots, CARRIER].astype(np.int64)
        ones = np.flatnonzero(of_robot) if phase.robot else np.zeros(0, dtype=np.int64)
        around = np.flatnonzero(~of_robot)
        names = arrangement.names
        held = None if phase.attached.held is None else phase.attached.held.part
        kinds = np.array([HELD if names[b] == held else self._kinds[carrier[b]] for b in ones.tolist()], dtype=np.int64)
        asked = clearances(scene, phase.near, [names[b] for b in ones], [names[b] for b in around])
        others = np.empty((len(around), PAIR_COLUMNS - 1))
        others[:, 0] = roots[around]
        others[:, REQUIRED - 1] = asked.max(0) if len(ones) else 0.0
        others[:, SET - 1] = -1.0 if sets.known else [sets.of_others(self._seat(phase, names[b])) for b in around]
        if self._shifts is None:
            self._shifts = self._all_shifts(arrangement)
        shifts = self._shifts
        ahead = shifts[carrier[around] - arrangement.links]
        others[:, EARLY - 1 :] = ahead[:, :2]
        others[:, LATE - 1] += execution.start_tolerance_s * ahead[:, 2]
        special = self._special(arrangement, phase, ones, kinds, others, asked)
        own = self._own(arrangement, phase, ones, kinds, sets) if phase.robot else []
        own += self._put_down(arrangement, phase, sets, shifts)
        clock = np.array([scene.start.time, execution.start_tolerance_s, *sets.shift])
        return Pairs(roots[ones], kinds, others, _table(own), special, (sets.table, self._lag, clock))

    def _seat(self, phase: Phase, name: str) -> Seat:
        """Where a body of the surroundings sits."""
        scene = self.scene
        frame, pose = phase.attached.pose_of(scene, name)
        world = scene.index[name]
        within = phase.handled.of(name) or world.uncertainty
        return Seat(frame, float(np.hypot(pose.x, pose.y)) + world.body.radius, world.body.radius, within)

    def _all_shifts(self, arrangement: Arrangement) -> FloatArray:
        """Between which times, s, each frame may be ahead of its law, and whether it moves, (F, 3)."""
        moves = arrangement.bodies.still[arrangement.links :] == 0
        late = np.array([frame.uncertainty.shift_s for frame in self.scene.frames.values()]).reshape(-1, 2)
        return np.column_stack([-late[:, 1] * moves + 0.0, -late[:, 0] * moves + 0.0, moves])

    def _special(
        self, arrangement: Arrangement, phase: Phase, ones: IntArray, kinds: IntArray, others: FloatArray,
        asked: FloatArray,
    ) -> FloatArray:  # fmt: skip
        """Pairs of which less is required than `others` say: those that may be nearer, and those that may touch."""
        roots, found = arrangement.roots, dict[tuple[int, int], float]()
        if not phase.contacts and not self.scene.options.clearance.exceptions:
            return np.empty((0, PAIR_COLUMNS))
        if self.scene.options.clearance.exceptions:
            for r, o in np.argwhere(asked < others[:, REQUIRED - 1]).tolist():
                found[r, o] = asked[r, o]
        at = {unit: o for o, unit in enumerate(others[:, 0].tolist())}
        mine = {body: r for r, body in enumerate(roots[ones].tolist())}
        for names in sorted(phase.contacts):
            if all(name in arrangement.number for name in names):
                one, other = (int(roots[arrangement.number[name]]) for name in names)
                one, other = (one, other) if one in mine else (other, one)
                if one in mine and other in at:
                    found[mine[one], at[other]] = contact_gap(phase)
        rows = np.empty((len(found), PAIR_COLUMNS))
        for row, ((r, o), distance) in zip(rows, found.items(), strict=True):
            row[FIRST], row[SECOND:] = roots[ones[r]], others[o]
            row[REQUIRED], row[SET] = distance, row[SET] + (kinds[r] if row[SET] >= 0.0 else 0)
        return rows

    def _own(
        self, arrangement: Arrangement, phase: Phase, ones: IntArray, kinds: IntArray, sets: Displacements
    ) -> list[tuple[float, ...]]:
        """Pairs within the robot."""
        roots, names, carrier = arrangement.roots, arrangement.names, arrangement.carrier[arrangement.roots]
        mine = [names[b] for b in ones]
        asked = clearances(self.scene, phase.near, mine, mine)
        on, found, known = carrier[ones], list[tuple[float, ...]](), dict[tuple[int, int], int]()
        distances, roots_of, kind_of = asked.tolist(), roots[ones].tolist(), kinds.tolist()
        wanted = self._wanted[on[:, None], on].tolist()
        for i, k in combinations_with_replacement(range(len(mine)), 2):
            if not wanted[i][k]:
                continue
            touches = pair(mine[i], mine[k]) in phase.contacts
            both = kind_of[i], kind_of[k]
            if both not in known:
                known[both] = -1 if sets.known else sets.within_robot(*both)
            distance = contact_gap(phase) if touches else distances[i][k]
            found.append((roots_of[i], roots_of[k], distance, known[both], 0.0, 0.0))
        return found

    def _put_down(
        self, arrangement: Arrangement, phase: Phase, sets: Displacements, shifts: FloatArray
    ) -> list[tuple[float, ...]]:
        """Pairs of a part that was put down and a body that moves against it: what does not, the part was proved to
        stay clear of while it was put down."""
        held = None if phase.attached.held is None else phase.attached.held.part
        parts = [name for name, _ in phase.handled.within if name != held]
        if not parts:
            return []
        names, roots, number = arrangement.names, arrangement.roots, arrangement.number
        found, done = list[tuple[float, ...]](), set[tuple[str, str]]()
        frames = arrangement.rows[roots, CARRIER].astype(np.int64) - arrangement.links
        moves: BoolArray = shifts[:, 2] > 0.0
        for part in parts:
            a = number[part]
            for b in np.flatnonzero(~arrangement.of_robot).tolist():
                one, other = frames[a], frames[b]
                both = pair(part, names[b])
                apart = one != other and (moves[one] or moves[other]) and both not in phase.handled.supports
                if not apart or both in done:
                    continue
                done.add(both)
                distance = float(clearances(self.scene, True, [part], [names[b]])[0, 0])
                which = sets.placed(self._seat(phase, part), self._seat(phase, names[b]))
                early = shifts[other, 0] - shifts[one, 1], shifts[other, 1] - shifts[one, 0]
                still = not moves[other]
                found.append((roots[a], roots[b], distance, which, *((0.0, 0.0) if still else early)))
        return found


def _table(pairs: Sequence[tuple[float, ...]]) -> FloatArray:
    return np.array(pairs, dtype=np.float64).reshape(-1, PAIR_COLUMNS)
