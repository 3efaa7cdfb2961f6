"""The smallest clearance of a plan: each phase in one kernel, from the spline to GJK."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np

from benchmarks.compiled.bounding import curve
from benchmarks.compiled.curves import positions
from benchmarks.compiled.door import kernel
from benchmarks.compiled.gjk import distance
from benchmarks.compiled.packing import FALLBACKS, cell, units
from benchmarks.compiled.placing import everywhere
from benchmarks.compiled.separating import height, likely, put, rough, width
from planner import separation
from planner.arrays import FloatArray, IntArray
from planner.certificate import Prover
from planner.phases import Phase
from planner.trajectory import Trajectory

original: Any = getattr(import_module("planner.margins"), "_nearest", None)
"""What it is put in the place of, as it was when this was imported."""


@kernel
def least_gap(
    position: FloatArray,
    rotation: FloatArray,
    number: IntArray,
    table: FloatArray,
    vertices: FloatArray,
    a: IntArray,
    b: IntArray,
    which: IntArray,
) -> tuple[float, int, int]:
    """Least gap, the number of its time and of its pair: the roughly nearest first, until no other can be nearer."""
    count, many = len(table), len(which)
    wide = np.empty(count)
    at, tall = np.empty((len(position), count, 12)), np.empty(count)
    about = np.empty((len(position), many))
    for u in range(count):
        wide[u] = width(table, number, vertices, u)
    for t in range(len(position)):
        for u in range(count):
            put(position, rotation, t, number, table, u, at[t, u])
            tall[u] = height(table, number, vertices, u, at[t, u])
        for k in range(many):
            i, j = a[which[k]], b[which[k]]
            about[t, k] = rough(at[t, i], tall[i], wide[i], at[t, j], tall[j], wide[j])
    flat = about.ravel()
    best, when, pair = np.inf, 0, which[0]
    n, normal = np.empty((6, 3)), np.empty(3)
    for m in np.argsort(flat, kind="mergesort"):
        if not flat[m] < best:
            break
        t, k = m // many, which[m % many]
        i, j = a[k], b[k]
        gap = likely(number, table, vertices, i, at[t, i], j, at[t, j], n)
        if gap < best:
            true = max(gap, 0.0, distance(number, table, vertices, i, at[t, i], j, at[t, j], normal))
            if true < best:
                best, when, pair = true, t, k
    return best, when, pair


def nearest_of_phase(
    prover: Prover, trajectory: Trajectory, phase: Phase, t: FloatArray, only: int | None
) -> tuple[float, float, int] | None:
    solids = prover.solids(phase.carried, phase.rides)
    known, packed = cell(prover.scene), units(solids)
    a, b = prover.asked(solids)
    if known is None or not packed.plain or phase.exempt or len(a) > separation.FEW:
        FALLBACKS["nearest"] += 1
        answer: tuple[float, float, int] | None = original(prover, trajectory, phase, t, only)
        return answer
    which = np.arange(len(a)) if only is None else np.array([only])
    if not len(which):
        return None
    way = curve(trajectory)
    q = positions(way.edges, way.c, way.last, t)
    where = everywhere(known.arm, known.laws, q, t)
    best, when, pair = least_gap(*where, packed.number, packed.table, packed.vertices, a, b, which)
    return float(best), float(t[when]), int(pair)
