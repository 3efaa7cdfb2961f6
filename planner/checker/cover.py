"""Whether the rows leave out no pair of bodies, no pair of pieces and no instant.

Times are compared by their rank among all times that occur, so nothing is rounded: a row may begin where another ends,
and not an ulp later.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.checker.far import Planes, far
from assur.planner.checker.rows import Rows
from assur.planner.checker.stage import Stage
from assur.planner.checker.verdict import Code, Finding
from assur.planner.model.phases import Phase

BATCH = 2_000_000
"""Pairs of pieces, row by row, that are looked at in one go: some 100 MB."""


@dataclass(frozen=True, eq=False)
class _Spans:
    """Rows (N,) as stretches [begin, end] of ranks that serve keys `key` (N,)."""

    key: IntArray
    begin: IntArray
    end: IntArray


def uncovered(stage: Stage, phases: tuple[Phase, ...], rows: Rows, behind: Planes) -> list[Finding]:
    """A finding for each phase in which a pair that must stay apart is not covered throughout, by rows or by a plane
    that the one stays behind."""
    keys, phase, first, second = _asked(stage, phases)
    left = np.flatnonzero(~far(stage, phases, behind, phase, first, second))
    keys, phase, first, second = keys[left], phase[left], first[left], second[left]
    times = np.unique(np.concatenate([rows.t0, rows.t1, [x for p in phases for x in (p.t0, p.t1)]]))
    bounds = np.searchsorted(times, np.array([[p.t0, p.t1] for p in phases]))
    spans, pieces = _by_key(stage, rows, times, keys)
    count = stage.solids.count
    whole = (pieces[0] < 0) & (pieces[1] < 0)
    hole = _holes(np.arange(len(keys)), bounds[phase], _pick(spans, whole))
    left = np.flatnonzero(hole >= 0)
    if not len(left):
        return []
    sizes = count[first] * count[second]
    for part in _batches(left, sizes, np.bincount(spans.key, minlength=len(keys))):
        hole[part] = _piecewise(part, bounds[phase], spans, pieces, count[first], count[second])
    return _told(stage, phases, times, phase, first, second, hole)


def asked_pairs(stage: Stage) -> BoolArray:
    """(P, B, B), above the diagonal: the pairs of bodies that must stay apart in each phase."""
    found = np.zeros((len(stage.seat), stage.seat.shape[1], stage.seat.shape[1]), dtype=bool)
    found[_pairs(stage)] = True
    return found


def _pairs(stage: Stage) -> tuple[IntArray, IntArray, IntArray]:
    """Phases, and first and second bodies, first < second, of all pairs that must stay apart."""
    robot, links = stage.of_robot, stage.scene.robot.links
    wanted = np.zeros((len(links), len(links)), dtype=bool)
    for names in stage.scene.robot.self_pairs:
        i, k = (links.index(name) for name in names)
        wanted[i, k] = wanted[k, i] = i != k
    phase, mine = np.nonzero(robot)
    carrier = np.where(robot, stage.carrier[stage.seat], 0)
    later = np.arange(robot.shape[1]) > mine[:, None]
    own = robot[phase] & wanted[carrier[phase, mine][:, None], carrier[phase]] & later
    row, other = np.nonzero(~robot[phase] | own)
    phase, mine = phase[row], mine[row]
    return phase, np.minimum(mine, other), np.maximum(mine, other)


def _asked(stage: Stage, phases: tuple[Phase, ...]) -> tuple[IntArray, IntArray, IntArray, IntArray]:
    """Keys, ascending, of all pairs asked for in phases that last; their phases and bodies."""
    phase, first, second = _pairs(stage)
    keys = _key(stage, phase, first, second)
    order = np.argsort(keys)
    order = order[np.array([p.t1 > p.t0 for p in phases], dtype=bool)[phase[order]]]
    return keys[order], phase[order], first[order], second[order]


def _key(stage: Stage, phase: IntArray, first: IntArray, second: IntArray) -> IntArray:
    """One number for two bodies, first < second, in a phase."""
    count = len(stage.solids.count)
    return np.asarray((phase * count + first) * count + second)


def _by_key(stage: Stage, rows: Rows, times: FloatArray, keys: IntArray) -> tuple[_Spans, tuple[IntArray, IntArray]]:
    """Rows that serve a key, as ranks, and their pieces of the key's first and second body (−1: all of them)."""
    swap = rows.first > rows.second
    low, high = np.where(swap, rows.second, rows.first), np.where(swap, rows.first, rows.second)
    key = _key(stage, rows.phase, low, high)
    place = np.minimum(np.searchsorted(keys, key), max(0, len(keys) - 1))
    serves = keys[place] == key if len(keys) else np.zeros(len(key), dtype=bool)
    spans = _Spans(place, np.searchsorted(times, rows.t0), np.searchsorted(times, rows.t1))
    of = []
    for body, piece in (
        (low, np.where(swap, rows.second_piece, rows.first_piece)),
        (high, np.where(swap, rows.first_piece, rows.second_piece)),
    ):
        of.append(np.where(stage.solids.count[body] == 1, -1, piece)[serves])
    return _pick(spans, serves), (of[0], of[1])


def _piecewise(
    part: IntArray,
    bounds: IntArray,
    spans: _Spans,
    pieces: tuple[IntArray, IntArray],
    count_first: IntArray,
    count_second: IntArray,
) -> IntArray:
    """`_holes` of some keys, pair of pieces by pair of pieces: the first hole of each key."""
    place = np.full(len(bounds), -1)
    place[part] = np.arange(len(part))
    mine = np.flatnonzero(place[spans.key] >= 0)
    key = spans.key[mine]
    sizes = count_first[part] * count_second[part]
    start = np.cumsum(sizes) - sizes
    i, j = pieces[0][mine], pieces[1][mine]
    wide, high = np.where(i < 0, count_first[key], 1), np.where(j < 0, count_second[key], 1)
    row = np.repeat(np.arange(len(mine)), wide * high)
    step = np.arange(len(row)) - np.repeat(np.cumsum(wide * high) - wide * high, wide * high)
    one = np.where(i[row] < 0, step // high[row], i[row])
    other = np.where(j[row] < 0, step % high[row], j[row])
    sub = start[place[key[row]]] + one * count_second[key[row]] + other
    of_key = np.repeat(np.arange(len(part)), sizes)
    found = _holes(of_key, bounds[part], _Spans(sub, spans.begin[mine][row], spans.end[mine][row]))
    open_ = np.flatnonzero(found >= 0)
    result = np.full(len(part), -1)
    result[of_key[open_][::-1]] = found[open_][::-1]
    return result


def _holes(of_key: IntArray, bounds: IntArray, spans: _Spans) -> IntArray:
    """For each item (M,), the rank at which the spans with its number as key stop covering `bounds[of_key]`; −1: never.

    Spans lie inside those bounds. The idea: in the order of their begins, each must begin no later than the latest end
    before it.
    """
    many = len(of_key)
    begin, end = bounds[of_key, 0], bounds[of_key, 1]
    key = np.concatenate([np.arange(many), spans.key])
    first = np.concatenate([begin, spans.begin])
    last = np.concatenate([begin, spans.end])
    order = np.lexsort((first, key))
    key, first, last = key[order], first[order], last[order]
    width = int(bounds.max(initial=0)) + 1
    latest = np.maximum.accumulate(key * width + last) - key * width
    hole = np.full(many, -1)
    final = np.flatnonzero(np.append(key[1:] != key[:-1], True)) if len(key) else np.zeros(0, dtype=np.int64)
    short = latest[final] < end[key[final]]
    hole[key[final][short]] = latest[final][short]
    late = np.flatnonzero((key[1:] == key[:-1]) & (first[1:] > latest[:-1]))[::-1]
    hole[key[late]] = latest[late]
    return hole


def _pick(spans: _Spans, which: BoolArray) -> _Spans:
    return _Spans(spans.key[which], spans.begin[which], spans.end[which])


def _batches(left: IntArray, sizes: IntArray, rows: IntArray) -> list[IntArray]:
    """The keys left, in lots that stay below `BATCH`."""
    lot = np.cumsum(sizes[left] * np.maximum(1, rows[left])) // BATCH
    return np.split(left, np.flatnonzero(np.diff(lot)) + 1)


def _told(
    stage: Stage,
    phases: tuple[Phase, ...],
    times: FloatArray,
    phase: IntArray,
    first: IntArray,
    second: IntArray,
    hole: IntArray,
) -> list[Finding]:
    """One finding a phase: the earliest hole in it."""
    findings = []
    bodies = stage.solids.bodies
    for k in range(len(phases)):
        open_ = np.flatnonzero((phase == k) & (hole >= 0))
        if len(open_):
            i = open_[np.argmin(hole[open_])]
            names = f"{bodies[first[i]].name} and {bodies[second[i]].name}"
            where = f"{phases[k].kind} of step {phases[k].step}, {times[hole[i]]:.6g} s"
            findings.append(Finding(Code.COVER, f"no row keeps {names} apart", float(len(open_)), "pairs", where))
    return findings
