"""Rows of one body of the robot alone: it stays behind a plane, so it is far from all that stands still before it.

In a large cell a few such rows take the place of thousands (equation C6 in docs/guarantees.md).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.collision.arrangement import exempted
from assur.planner.collision.claim import Claim, take
from assur.planner.collision.proof_facts import Facts, Intervals
from assur.planner.collision.support_gaps import place, support
from assur.planner.model.clearance import SLACK_M, worst

MANY = 64
"""Pairs of a phase from which on planes are looked for: for fewer, rows of pairs cost less."""
NO_BODY = -1
"""Stands in a row for the second unit, body and piece, where the row is of the first alone."""
SPARE_M = 1e-6
"""What must be left over of every distance that a plane proves, m: a thousand times the rounding of the two sides, so
that the checker, who adds them up in another way, comes to the same answer."""
_SIDES = np.concatenate([np.eye(3), -np.eye(3)])


@dataclass(frozen=True, slots=True)
class Behind:
    """Rows of units `unit` (r,) alone over [t0, t1] (r,)."""

    unit: IntArray
    t0: FloatArray
    t1: FloatArray
    claim: Claim

    @property
    def second(self) -> IntArray:
        return np.full(len(self.unit), NO_BODY)


def planes(facts: Facts, tables: tuple[Intervals, ...], a: IntArray, b: IntArray) -> tuple[list[Behind], BoolArray]:
    """Rows of single units of the robot, and which of the pairs of units a, b (P,) they keep apart.

    The intervals of each table follow each other and last the phase. For each unit they are those of the first table
    that does for most of its pairs. Normals are the axes of the world: first that which does for most pairs, and none
    that does for no more of them.
    """
    need = _needed(facts, a, b)
    nearest = _nearest(facts, b, need < np.inf)
    units, which = np.unique(a, return_inverse=True)
    claims = [_alone(facts, table, units) for table in tables]
    proved = []
    for table, claim in zip(tables, claims, strict=True):
        least = claim.least.reshape(len(table), len(units), len(_SIDES)).min(0)
        proved.append(least[which] + nearest - SLACK_M - SPARE_M >= need[:, None])
    behind, apart = [], np.zeros(len(a), dtype=bool)
    for k, unit in enumerate(units):
        mine = np.flatnonzero(which == k)
        best = int(np.argmax([does[mine].any(1).sum() for does in proved]))
        sides = _fewest(proved[best][mine])
        if len(sides):
            apart[mine] = proved[best][mine].any(1)
            behind.append(
                _rows(tables[best], claims[best], int(unit), k + len(units) * np.arange(len(tables[best])), sides)
            )
    return behind, apart


def _fewest(proved: BoolArray) -> IntArray:
    """Numbers of sides that together do for all pairs (P, sides) for which one does: greedily, so few, not fewest."""
    sides: list[int] = []
    while proved.any():
        sides.append(int(np.argmax(proved.sum(0))))
        proved = proved[~proved[:, sides[-1]]]
    return np.array(sides, dtype=np.int64)


def _rows(table: Intervals, claim: Claim, unit: int, at: IntArray, sides: IntArray) -> Behind:
    """The rows of a unit, which is number `at` (I,) among those of the claims, in all intervals and along `sides`."""
    chosen = (at[:, None] * len(_SIDES) + sides).ravel()
    part = np.repeat(np.arange(len(table)), len(sides))
    return Behind(np.full(len(part), unit), table.t0[part], table.t1[part], take(claim, chosen))


def _needed(facts: Facts, a: IntArray, b: IntArray) -> FloatArray:
    """What is required of pairs of units (P,), m; inf for those that planes are not for: b must ride on a frame that
    stands still and is known throughout."""
    phase, solids = facts.phase, facts.solids
    by_carrier = np.full(solids.links + len(facts.frames), np.inf)
    for k, frame in enumerate(facts.frames, start=solids.links):
        if facts.still[k]:
            by_carrier[k] = worst(facts.scene, phase, frame.name)
    need = by_carrier[solids.carrier[b]]
    if phase.exempt:
        need[exempted(solids, phase, a, b)] = np.inf
    return need


def _alone(facts: Facts, table: Intervals, units: IntArray) -> Claim:
    """Claims, one for each interval, unit and side in this order, of the unit against the origin of the world."""
    part, unit = (grid.ravel() for grid in np.indices((len(table), len(units))))
    n = np.broadcast_to(_SIDES, (len(part), *_SIDES.shape))
    gaps = []
    for at in (0, len(table), 2 * len(table)):  # starts, middles, ends
        placed = place(facts.solids, table.where, part + at, units[unit])
        gaps.append(-(np.einsum("rni,ri->rn", n, placed.centre) + support(placed, n)).ravel())
    wide = np.repeat(np.arange(len(part)), len(_SIDES))
    normal = n.reshape(-1, 3)
    speed, acceleration = facts.bounds(table, part[wide], units[unit[wide]], normal)
    h = (table.t1 - table.t0)[part[wide]]
    least = np.fmax((gaps[0] + gaps[2] - speed * h) / 2, np.minimum(gaps[0], gaps[2]) - acceleration * h**2 / 8)
    return Claim(normal, gaps[0], gaps[1], gaps[2], speed, acceleration, least, np.full(len(least), -np.inf))


def _nearest(facts: Facts, b: IntArray, still: BoolArray) -> FloatArray:
    """(P, 6): least n·x over the units b (P,), for the sides n; NaN where it does not stand still."""
    units, which = np.unique(b[still], return_inverse=True)
    table = facts.intervals(np.array([facts.phase.t0]), np.array([facts.phase.t0]))
    placed = place(facts.solids, table.where, np.zeros(len(units), dtype=np.int64), units)
    n = np.broadcast_to(-_SIDES, (len(units), *_SIDES.shape))
    found = np.full((len(b), len(_SIDES)), np.nan)
    found[still] = -(np.einsum("rni,ri->rn", n, placed.centre) + support(placed, n))[which]
    return found
