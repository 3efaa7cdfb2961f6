"""Rows of one body: a plane that the body stays behind shows its distance from everything that stands beyond the plane.

The plane has no place of its own. Each body that stands still, with what is required of its pair, has a level: how far
along the normal the moving body may reach. The interval is halved until all levels are shown, or are reached.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.claim import tables as tb
from assur.planner.checker.claim.chain import slot_of
from assur.planner.checker.claim.motion import rounding
from assur.planner.checker.claim.obligations import is_fixed, pair_of
from assur.planner.checker.claim.rows import add_link, place_side
from assur.planner.checker.claim.solids import derivative_bound, support
from assur.planner.checker.claim.tables import F1, F2, f8, i8
from assur.planner.checker.claim.uncertainty import displaced_gap, own_gap
from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from assur.planner.compiled import kernel, types


@kernel(f8(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, f8, f8))
def reach_at_ends(k: Claim, g: tb.Geometry, s: tb.Scratch, about: FloatArray, t0: float, t1: float) -> float:
    """How far the body of a row reaches along its normal at the ends of an interval, m; infinite: it is not known."""
    solid, on, reach = int(about[tb.SIDE_SOLID]), int(about[tb.SIDE_CARRIER]), -math.inf
    for t in (t0, t1):
        slot = slot_of(k, g, s, on, t, t)
        if slot < 0:
            return math.inf
        reach = max(reach, support(g, s.jets, slot, solid, on, about[tb.OBJECT_NORMAL :], 1.0))
    return reach


@kernel(types.void(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, tb.PROOF, i8, F1))
def write_levels(k: Claim, g: tb.Geometry, s: tb.Scratch, proof: tb.Proof, i: int, levels: FloatArray) -> None:
    """Writes how far the body of row i may reach for each other body, m; -inf: the row cannot show that pair."""
    row, about, p = proof.rows[i], proof.objects[i], int(proof.objects[i, tb.OBJECT_PLANE])
    a, t, at = int(row[c.ROW_BODY]), row[c.ROW_T1], tb.SIDES
    reach = reach_at_ends(k, g, s, about, row[c.ROW_T0], t)
    for b in range(len(k.bodies)):
        number, f = pair_of(proof, p, a, b) if a != b else -1, int(k.seats[int(k.seated[p, b]), c.SEAT_FRAME])
        levels[b] = -math.inf
        if number < 0 or f < 0 or not is_fixed(g, f):
            continue
        pair = proof.pairs[number]
        if pair[tb.PAIR_EARLY] != 0.0 or pair[tb.PAIR_LATE] != 0.0:
            continue
        place_side(k, g, about, at, p, b, -1.0)
        solid, on = int(about[at + tb.SIDE_SOLID]), int(about[at + tb.SIDE_CARRIER])
        level = -support(g, s.jets, slot_of(k, g, s, on, t, t), solid, on, about[tb.OBJECT_NORMAL :], -1.0)
        off = pair[tb.PAIR_DISTANCE] + tb.SLACK + rounding(g, on, 0, g.solids[solid, tb.SOLID_SIZE])
        if not reach <= level - off:
            continue
        off += own_gap(k, g, s, about, at, p, row[c.ROW_T0], t)
        levels[b] = level - off - displaced_gap(k, about, p, t)


@kernel(f8(F1, f8))
def least_level(levels: FloatArray, least: float) -> float:
    """The least level that is not below a number; infinite: none."""
    result = math.inf
    for level in levels:
        if least <= level < result:
            result = level
    return result


@kernel(f8(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, tb.PROOF, i8, F1, F2))
def shown_level(
    k: Claim, g: tb.Geometry, s: tb.Scratch, proof: tb.Proof, i: int, levels: FloatArray, stack: FloatArray
) -> float:
    """The least level that the body of row i is shown not to exceed; infinite: none."""
    row, about, top, level = proof.rows[i], proof.objects[i], 1, least_level(levels, -1e300)
    solid, on, p = int(about[tb.SIDE_SOLID]), int(about[tb.SIDE_CARRIER]), int(about[tb.OBJECT_PLANE])
    size = g.solids[solid, tb.SOLID_SIZE]
    stack[0, 0], stack[0, 1], stack[0, 2] = row[c.ROW_T0], row[c.ROW_T1], 0.0
    while top > 0 and level < math.inf:
        top -= 1
        t0, t1, depth, bow = stack[top, 0], stack[top, 1], stack[top, 2], 0.0
        proof.state[tb.WORK] -= 0.5 + (g.solids[solid, tb.SOLID_VERTICES] + len(k.displaced)) / 50.0
        if not proof.state[tb.WORK] > 0.1 * s.work[tb.TOUCHED]:
            return math.inf
        reach = reach_at_ends(k, g, s, about, t0, t1)
        # what an instant exceeds, no halving can show
        level = level if reach <= level else least_level(levels, reach)
        if t1 > t0 and level < math.inf:
            slot = slot_of(k, g, s, on, t0, t1)
            if slot < 0:
                bow = math.inf
            else:
                bend = derivative_bound(g, s.jets, slot, 2, solid, on, about[tb.OBJECT_NORMAL :], -1.0)
                bow = max(bend + rounding(g, on, 2, size), 0.0) * (t1 - t0) ** 2 / 8.0
        if level < math.inf:
            reach += bow + rounding(g, on, 0, size) + own_gap(k, g, s, about, 0, p, t0, t1)
        if reach <= level:
            continue
        if depth < tb.DEEPEST and t1 > t0:
            for half in range(2):
                stack[top, 0], stack[top, 1] = (0.5 * (t0 + t1), t1) if half == 0 else (t0, 0.5 * (t0 + t1))
                stack[top, 2], top = depth + 1.0, top + 1
        else:
            level = least_level(levels, np.nextafter(level, np.inf))
            stack[top, 0], stack[top, 1], stack[top, 2], top = t0, t1, depth, top + 1
    return level


@kernel(types.void(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, tb.PROOF, F2), allocates=True)
def link_rows(k: Claim, g: tb.Geometry, s: tb.Scratch, proof: tb.Proof, stack: FloatArray) -> None:
    """Links the rows of each pair, in the order of their begins; a row of one body to all pairs that it shows."""
    levels, at = np.empty(len(k.bodies)), 0
    for n in range(len(proof.rows) - 1, -1, -1):
        i = proof.order[n]
        pair, p = int(proof.objects[i, tb.OBJECT_PAIR]), int(proof.objects[i, tb.OBJECT_PLANE])
        if pair >= 0:
            add_link(proof, at, i, pair)
            at += 1
        if p < 0:
            continue
        write_levels(k, g, s, proof, i, levels)
        level = shown_level(k, g, s, proof, i, levels, stack)
        proof.state[tb.ROWS] += 1.0 if level < math.inf else 0.0
        for b in range(len(k.bodies)):
            if levels[b] >= level:
                add_link(proof, at, i, pair_of(proof, p, int(proof.rows[i, c.ROW_BODY]), b))
                at += 1
