"""Whether the smallest clearances that an answer states are so, from both sides: that of the arm, its tool and what it
holds, and that of parts that were put down, where the arm bears neither of both bodies.

That no pair comes nearer is proved with the rows of the certificate (`separation`): where the normal of a row does not
show it, the checker looks for its own, and halves the interval.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.checker.jets import TABLES
from assur.planner.checker.legs import TIME_S
from assur.planner.checker.motion import LINKS, Tables, all_jets, carry
from assur.planner.checker.rows import Apart
from assur.planner.checker.separation import (
    HINT,
    ITEM,
    MISSED,
    ONE,
    ONE_ON,
    OTHER,
    OTHER_ON,
    PAIR_ONE,
    PAIR_OTHER,
    REACHED,
    WHEN,
    distance,
)  # fmt: skip
from assur.planner.checker.solids import BODY, CARRIER, FIRST, I2
from assur.planner.checker.verdict import Code, Finding
from assur.planner.compiled import kernel
from assur.planner.model.claims import Claims
from assur.planner.model.outcome import Nearest

WITHIN_M = 5e-5
"""By how much a smallest clearance may be off, m, either way: the promise of the planner, 0.05 mm. Proved is, that all
pairs keep what is claimed less this; and the pair that is named, when it is said, is not farther apart than with it."""


@kernel(f"float64({I2}, float64, {TABLES}, float64)", allocates=True)
def pair_distance(pair: IntArray, t: float, tables: Tables, claimed: float) -> float:
    """The distance, m, of two bodies at an instant: an upper value of it. `pair` (2, 3): their first pieces, how many,
    and their carriers. `claimed`: what it is compared with. NaN where it is not known."""
    jets, item, found = all_jets(tables), np.zeros(ITEM), math.inf
    for c in (pair[0, 2], pair[1, 2]):
        if not carry(0 if c < tables[0][0, LINKS] else c, t, t, tables, jets):
            return math.nan
    item[ONE_ON], item[OTHER_ON] = pair[0, 2], pair[1, 2]
    for i in range(pair[0, 0], pair[0, 0] + pair[0, 1]):
        for k in range(pair[1, 0], pair[1, 0] + pair[1, 1]):
            item[ONE], item[OTHER], item[HINT], item[HINT + 1], item[HINT + 2] = i, k, 0.0, 0.0, 1.0
            found = min(found, distance(tables, jets, item, claimed)[1])
    return found


def claimed(claims: Claims) -> tuple[float, float]:
    """What all pairs of both kinds are to be shown to keep, m; -inf: nothing is said of them."""
    one, other = (
        -math.inf if said is None else math.inf if said[0] is None else said[0].gap_m - WITHIN_M
        for said in (claims.nearest, claims.placed)
    )
    return one, other


def nearest(apart: Apart, claims: Claims, against: FloatArray) -> list[Finding]:
    """Findings about both smallest clearances that are claimed, of which the proof found what is `against` one of them
    (`separation.STATE`)."""
    if claims.nearest is None and claims.placed is None:
        return []
    findings, table = [], apart.table
    if against[REACHED] != math.inf:
        names = [
            table.bodies[int(b)].name for b in (_body(apart, against[PAIR_ONE]), _body(apart, against[PAIR_OTHER]))
        ]
        what = f"{' and '.join(sorted(names))} come nearer than the smallest clearance that is stated"
        where = f"{against[WHEN]:.6g} s"
        if math.isnan(against[REACHED]):
            what += " (or could not be shown not to)"
        missed = float(against[MISSED] + WITHIN_M - against[REACHED])
        findings.append(Finding(Code.NEAREST, what, missed if missed < math.inf else math.nan, "m", where))
    for placed, said in ((False, claims.nearest), (True, claims.placed)):
        claim = None if said is None else said[0]
        if claim is not None:
            off = _off(apart, claim, placed=placed)
            findings += [] if off <= WITHIN_M else [_not_so_near(claim, off)]
    return findings


def pairs(apart: Apart, claims: tuple[Nearest, ...]) -> list[Finding]:
    """A finding for each pair that is not as near as is said, at the time and in the phase that are said. That it comes
    no nearer at any other time is not looked at: of all pairs together `nearest` says so."""
    findings = []
    for claim in claims:
        off = _off(apart, claim, placed=False)
        findings += [] if -WITHIN_M <= off <= WITHIN_M else [_not_so_near(claim, abs(off))]
    return findings


def _off(apart: Apart, claim: Nearest, *, placed: bool) -> float:
    """How much farther apart the pair that is named is than claimed, m; inf: there is no such pair then."""
    return min((_distance(apart, i, claim, placed) for i in range(len(apart.phases))), default=math.inf) - claim.gap_m


def _not_so_near(claim: Nearest, off: float) -> Finding:
    what = f"{' and '.join(claim.bodies)} are not as near in {claim.phase} as is stated"
    return Finding(Code.NEAREST, what, off, "m", f"{claim.time:.6g} s")


def _body(apart: Apart, solid: float) -> int:
    """The body of a solid of the table."""
    seats = apart.table.seats
    return int(seats[np.searchsorted(seats[:, FIRST], solid, side="right") - 1, BODY])


def _distance(apart: Apart, phase: int, claim: Nearest, placed: bool) -> float:
    """The distance of the pair that is named, at the time, if that is in this phase and the pair may not touch there,
    m; else inf. `placed`: the arm must bear neither of both, else one of them. Where a phase ends is known up to
    `TIME_S`."""
    table, number, at = apart.table, apart.table.number, apart.phases[phase]
    then = at.t0 - TIME_S <= claim.time <= at.t1 + TIME_S
    if not (then and at.kind == claim.phase and all(name in number for name in claim.bodies)):
        return math.inf
    a, b = (number[name] for name in claim.bodies)
    if not apart.required(phase, a, b):
        return math.inf
    pair = np.empty((2, 3), dtype=np.int64)
    for row, body in zip(pair, (a, b), strict=True):
        seat = table.seats[table.seat[phase, body]]
        row[:] = seat[FIRST], table.count[body], seat[CARRIER]
    if placed is not bool((pair[:, 2] >= table.links).all()):
        return math.inf
    return pair_distance(pair, claim.time, apart.tables, claim.gap_m + WITHIN_M)
