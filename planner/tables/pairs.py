"""Which bodies must stay how far apart (equation C5): phases, contacts, clearance and uncertainty as numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.kernels.solids import CARRIER, FIRST, PAIR_COLUMNS, REQUIRED, SECOND
from assur.planner.model.clearance import CONTACT_GAP, clearance, drift
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene
from assur.planner.tables.bodies import Arrangement

MANY = 64
"""Pairs of a phase from which on planes are looked for: for fewer, rows of pairs cost less."""


@dataclass(frozen=True, eq=False)
class Pairs:
    """What must be kept apart in phases of one kind. Distances in m, times in s.

    `mine` (R,): units of the robot's bodies. `others` (O, PAIR_COLUMNS - 1): units of the surroundings and what is
    required of them, the columns of a pair without its first unit. `own` (S, PAIR_COLUMNS): pairs within the robot.
    `allowed` (A, PAIR_COLUMNS): pairs that may touch, with what is required of them instead.
    """

    mine: IntArray
    others: FloatArray
    own: FloatArray
    allowed: FloatArray

    @property
    def many(self) -> bool:
        """Whether there are so many that planes between them are worth their rows."""
        return len(self.mine) * len(self.others) > MANY

    @cached_property
    def every(self) -> FloatArray:
        """All pairs (P, PAIR_COLUMNS): the robot's bodies against all others, then those within the robot."""
        found = np.empty((len(self.mine) * len(self.others) + len(self.own), PAIR_COLUMNS))
        across = found[: len(found) - len(self.own)]
        across[:, FIRST] = np.repeat(self.mine, len(self.others))
        across[:, SECOND:] = np.tile(self.others, (len(self.mine), 1))
        for row in self.allowed:
            across[(across[:, FIRST] == row[FIRST]) & (across[:, SECOND] == row[SECOND])] = row
        found[len(across) :] = self.own
        return found

    def __len__(self) -> int:
        return len(self.mine) * len(self.others) + len(self.own)


class PairTables:
    """The pairs of a scene by arrangement and kind of phase, made once each."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        number = scene.robot.links.index
        self._wanted = {frozenset(map(number, pair)) for pair in scene.robot.self_pairs}
        """Pairs of links between which bodies are required to stay apart."""
        self._made: dict[tuple[object, ...], Pairs] = {}

    def __call__(self, arrangement: Arrangement, phase: Phase) -> Pairs:
        """The pairs of a phase, in the arrangement that it has."""
        key = (arrangement, phase.near, phase.tracked, phase.corrected, phase.contacts)
        if key not in self._made:
            self._made[key] = self._pairs(arrangement, phase)
        return self._made[key]

    def _pairs(self, arrangement: Arrangement, phase: Phase) -> Pairs:
        scene, roots, of_robot = self.scene, arrangement.roots, arrangement.of_robot
        mine, around = roots[of_robot], roots[~of_robot]
        carrier = arrangement.rows[roots, CARRIER].astype(np.int64)
        asked, late = clearance(scene, phase), scene.execution.start_tolerance_s
        drifts = [drift(scene, phase, name) for name in scene.frames]
        by_frame = np.array([(asked + scene.execution.tracking_m + known, growth, late) for known, growth in drifts])
        others = np.empty((len(around), PAIR_COLUMNS - 1))
        others[:, 0], others[:, REQUIRED - 1 :] = around, by_frame[carrier[~of_robot] - arrangement.links]
        allowed = _allowed(arrangement, phase)
        contacts = {frozenset(row[:2]) for row in allowed}
        own = [
            (a, b, CONTACT_GAP if frozenset((a, b)) in contacts else asked, 0.0, 0.0)
            for (a, on), (b, other) in combinations(zip(mine.tolist(), carrier[of_robot].tolist(), strict=True), 2)
            if on != other and frozenset((on, other)) in self._wanted
        ]
        return Pairs(mine, others, _table(own), _table(allowed))


def _table(pairs: Sequence[tuple[float, ...]]) -> FloatArray:
    return np.array(pairs, dtype=np.float64).reshape(-1, PAIR_COLUMNS)


def _allowed(arrangement: Arrangement, phase: Phase) -> list[tuple[float, float, float, float, float]]:
    """The pairs of a phase that may touch, the robot's unit first."""
    found = []
    for names in sorted(phase.contacts):
        if all(name in arrangement.number for name in names):
            one, other = (arrangement.number[name] for name in names)
            if arrangement.of_robot[other]:
                one, other = other, one
            found.append((float(arrangement.roots[one]), float(arrangement.roots[other]), CONTACT_GAP, 0.0, 0.0))
    return found
