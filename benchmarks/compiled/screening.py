"""Screening of a group in one kernel: samples × pairs, from the rough order to the gap along the likely normals."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import Any

import numpy as np

from benchmarks.compiled.door import kernel
from benchmarks.compiled.packing import FALLBACKS, cell, units
from benchmarks.compiled.placing import everywhere
from benchmarks.compiled.separating import height, likely, put, rough, width
from benchmarks.compiled.separation import place
from planner import separation
from planner.arrays import FloatArray, IntArray
from planner.certificate import Prover
from planner.outcome import Refusal
from planner.phases import Phase
from planner.requirement import SLACK_M
from planner.solids import Carriers, Solids

screening: Any = import_module("planner.screening")
"""By name, for its inner functions are nobody's business: what is missing is found by `replacements`."""
original: Any = getattr(screening, "_screen_group", None)
"""What it is put in the place of, as it was when this was imported."""


@kernel
def moments(t0: FloatArray, t1: FloatArray, step: float) -> tuple[FloatArray, IntArray]:
    """Times of all members, one after the other, and where each begins."""
    first = np.zeros(len(t0) + 1, dtype=np.int64)
    for k in range(len(t0)):
        first[k + 1] = first[k] + max(2, int(np.ceil((t1[k] - t0[k]) / step)) + 1)
    t = np.empty(first[-1])
    for k in range(len(t0)):
        count = first[k + 1] - first[k]
        each = (t1[k] - t0[k]) / (count - 1)
        for i in range(count - 1):
            t[first[k] + i] = i * each + t0[k]
        t[first[k + 1] - 1] = t1[k]
    return t, first


@kernel
def unseparated(
    position: FloatArray,
    rotation: FloatArray,
    member: IntArray,
    number: IntArray,
    table: FloatArray,
    vertices: FloatArray,
    a: IntArray,
    b: IntArray,
    required: FloatArray,
    slack: float,
) -> tuple[IntArray, IntArray, FloatArray]:
    """Rows (time, pair, gap) that no likely normal parts by what is `required` (members, pairs)."""
    count = len(table)
    used, wide = np.zeros(count, dtype=np.bool_), np.empty(count)
    for k in range(len(a)):
        used[a[k]] = used[b[k]] = True
    for u in range(count):
        if used[u]:
            wide[u] = width(table, number, vertices, u)
    at, tall = np.empty((count, 12)), np.empty(count)
    n = np.empty((6, 3))
    room = 64
    row, which, gap = np.empty(room, dtype=np.int64), np.empty(room, dtype=np.int64), np.empty(room)
    found = 0
    for t in range(len(position)):
        for u in range(count):
            if used[u]:
                put(position, rotation, t, number, table, u, at[u])
                tall[u] = height(table, number, vertices, u, at[u])
        for k in range(len(a)):
            i, j, need = a[k], b[k], required[member[t], k]
            if rough(at[i], tall[i], wide[i], at[j], tall[j], wide[j]) - slack > need:
                continue
            value = likely(number, table, vertices, i, at[i], j, at[j], n)
            if value - slack > need:
                continue
            if found == room:
                row, which = np.append(row, np.empty_like(row)), np.append(which, np.empty_like(which))
                gap, room = np.append(gap, np.empty_like(gap)), 2 * room
            row[found], which[found], gap[found] = t, k, value
            found += 1
    return row[:found], which[:found], gap[:found]


def screen_group(
    prover: Prover,
    solids: Solids,
    drafts: Sequence[Any],
    members: list[tuple[int, Phase]],
    step: float,
) -> dict[int, Any]:
    scene, packed = prover.scene, units(solids)
    known = cell(scene)
    a, b = prover.asked(solids)
    if known is None or len(a) > separation.FEW:
        FALLBACKS["screening"] += 1
        answer: dict[int, Any] = original(prover, solids, drafts, members, step)
        return answer
    begins, ends = np.array([phase.t0 for _, phase in members]), np.array([phase.t1 for _, phase in members])
    t, first = moments(begins, ends, step)
    q = np.empty((len(t), len(scene.start.q)))
    for k, (draft, _) in enumerate(members):
        part = slice(first[k], first[k + 1])
        q[part] = drafts[draft].at(t[part])
    sizes = np.diff(first)
    member = np.repeat(np.arange(len(members)), sizes)
    position, rotation = everywhere(known.arm, known.laws, q, t)
    required = screening._required(prover, solids, members, a, b)
    row, which, gap = unseparated(
        position, rotation, member, packed.number, packed.table, packed.vertices, a, b, required, SLACK_M
    )
    if not len(row):
        return {}
    return _asked(prover, solids, members, (t, member, position, rotation), required, (row, which, gap))


def _asked(
    prover: Prover,
    solids: Solids,
    members: list[tuple[int, Phase]],
    sampled: tuple[FloatArray, IntArray, FloatArray, FloatArray],
    required: FloatArray,
    bad: tuple[IntArray, IntArray, FloatArray],
) -> dict[int, Any]:
    """FCL about the bad rows of each draft, deepest first, as the original asks."""
    t, member, position, rotation = sampled
    row, which, gap = bad
    a, b = prover.asked(solids)
    draft = np.array([number for number, _ in members])[member]
    samples = screening._Samples(t, draft, member, Carriers(position, rotation))
    one, other = place(solids, samples.where, row, a[which]), place(solids, samples.where, row, b[which])
    mine = draft[row]
    order = np.lexsort((gap, mine))
    total, seen = np.bincount(draft), np.bincount(draft[_each_once(row)], minlength=len(np.bincount(draft)))
    result: dict[int, Any] = {}
    confirmed: list[Refusal] = []
    asked: dict[int, int] = {}
    before = -1
    for i in order.tolist():
        owner = int(mine[i])
        if owner != before:
            confirmed, asked, before = [], {}, owner
        body = int(solids.body[b[which[i]]])
        if asked.get(body, 0) < screening.MOST_ASKED and (len(asked) < screening.MOST_BODIES or body in asked):
            asked[body] = asked.get(body, 0) + 1
            phase, need = members[int(member[row[i]])][1], float(required[member[row[i]], which[i]])
            refusal = screening._ask(prover, solids, phase, samples, int(row[i]), one, other, i, float(gap[i]), need)
            if refusal is not None:
                confirmed.append(refusal)
                asked[body] = screening.MOST_ASKED
        share = int(seen[owner]) / max(1, int(total[owner]))
        result[owner] = screening.Screened(confirmed[0] if confirmed else None, share, tuple(confirmed[1:]))
    return result


@kernel
def _each_once(row: IntArray) -> IntArray:
    """Ascending numbers, each once."""
    out, count = np.empty_like(row), 0
    for k in range(len(row)):
        if k == 0 or row[k] != row[k - 1]:
            out[count] = row[k]
            count += 1
    return out[:count]
