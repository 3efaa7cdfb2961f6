"""The functions of `planner.separation`, row by row in compiled loops."""

from __future__ import annotations

import numpy as np

from benchmarks.compiled.door import kernel
from benchmarks.compiled.packing import units
from benchmarks.compiled.separating import faces, gap, height, likely, most, put, rough, sigma, towards, width
from planner import separation
from planner.arrays import FloatArray, IntArray
from planner.separation import Placed
from planner.solids import Carriers, Solids


@kernel
def _put_rows(
    position: FloatArray, rotation: FloatArray, row: IntArray, unit: IntArray, number: IntArray, table: FloatArray
) -> FloatArray:
    out = np.empty((len(unit), 12))
    for i in range(len(unit)):
        put(position, rotation, row[i], number, table, unit[i], out[i])
    return out


@kernel
def _together(centre: FloatArray, axes: FloatArray) -> FloatArray:
    out = np.empty((len(centre), 12))
    for i in range(len(centre)):
        for j in range(3):
            out[i, j] = centre[i, j]
            for k in range(3):
                out[i, 3 + 3 * j + k] = axes[i, j, k]
    return out


@kernel
def _sigmas(
    number: IntArray, table: FloatArray, vertices: FloatArray, unit: IntArray, at: FloatArray, n: FloatArray
) -> FloatArray:
    out = np.empty(n.shape[:2])
    for i in range(n.shape[0]):
        for j in range(n.shape[1]):
            out[i, j] = sigma(number, table, vertices, unit[i], at[i], n[i, j, 0], n[i, j, 1], n[i, j, 2])
    return out


@kernel
def _gaps(
    number: IntArray,
    table: FloatArray,
    vertices: FloatArray,
    a: IntArray,
    one: FloatArray,
    b: IntArray,
    other: FloatArray,
    n: FloatArray,
) -> FloatArray:
    out = np.empty(n.shape[:2])
    for i in range(n.shape[0]):
        for j in range(n.shape[1]):
            x, y, z = n[i, j, 0], n[i, j, 1], n[i, j, 2]
            out[i, j] = gap(number, table, vertices, a[i], one[i], b[i], other[i], x, y, z)
    return out


@kernel
def _towards(table: FloatArray, a: IntArray, one: FloatArray, b: IntArray, other: FloatArray) -> FloatArray:
    n = np.empty((len(a), 2, 3))
    for i in range(len(a)):
        towards(table, a[i], one[i], b[i], other[i], n[i])
    return n


@kernel
def _faces(one: FloatArray, other: FloatArray) -> FloatArray:
    n = np.empty((len(one), 6, 3))
    for i in range(len(one)):
        faces(one[i], other[i], n[i])
    return n


@kernel
def _likely(
    number: IntArray,
    table: FloatArray,
    vertices: FloatArray,
    a: IntArray,
    one: FloatArray,
    b: IntArray,
    other: FloatArray,
) -> FloatArray:
    out, n = np.empty(len(a)), np.empty((6, 3))
    for i in range(len(a)):
        out[i] = likely(number, table, vertices, a[i], one[i], b[i], other[i], n)
    return out


@kernel
def _rough(
    position: FloatArray,
    rotation: FloatArray,
    number: IntArray,
    table: FloatArray,
    vertices: FloatArray,
    a: IntArray,
    b: IntArray,
) -> FloatArray:
    count = len(table)
    used, wide = np.zeros(count, dtype=np.bool_), np.empty(count)
    for k in range(len(a)):
        used[a[k]] = used[b[k]] = True
    for u in range(count):
        if used[u]:
            wide[u] = width(table, number, vertices, u)
    at, tall = np.empty((count, 12)), np.empty(count)
    out = np.empty((len(position), len(a)))
    for t in range(len(position)):
        for u in range(count):
            if used[u]:
                put(position, rotation, t, number, table, u, at[u])
                tall[u] = height(table, number, vertices, u, at[u])
        for k in range(len(a)):
            i, j = a[k], b[k]
            out[t, k] = rough(at[i], tall[i], wide[i], at[j], tall[j], wide[j])
    return out


@kernel
def _swept(
    position: FloatArray,
    rotation: FloatArray,
    number: IntArray,
    table: FloatArray,
    vertices: FloatArray,
    a: IntArray,
    b: IntArray,
) -> FloatArray:
    count = len(table)
    low, high = np.empty((count, 3)), np.empty((count, 3))
    used = np.zeros(count, dtype=np.bool_)
    for k in range(len(a)):
        used[a[k]] = used[b[k]] = True
    at = np.empty(12)
    for u in range(count):
        if not used[u]:
            continue
        wide = width(table, number, vertices, u)
        for t in range(len(position)):
            put(position, rotation, t, number, table, u, at)
            tall = height(table, number, vertices, u, at)
            for j in range(3):
                size = tall if j == 2 else wide
                # as `numpy.min` and `numpy.max` do, a NaN stays
                low[u, j] = at[j] - size if t == 0 else -most(-low[u, j], -(at[j] - size))
                high[u, j] = at[j] + size if t == 0 else most(high[u, j], at[j] + size)
    out = np.empty(len(a))
    for k in range(len(a)):
        found = -np.inf
        for j in range(3):
            found = most(found, most(low[b[k], j] - high[a[k], j], low[a[k], j] - high[b[k], j]))
        out[k] = found
    return out


def _at(placed: Placed) -> FloatArray:
    return _together(np.ascontiguousarray(placed.centre), np.ascontiguousarray(placed.axes))


def place(solids: Solids, where: Carriers, row: IntArray, unit: IntArray) -> Placed:
    packed = units(solids)
    at = _put_rows(where.position, where.rotation, row, unit, packed.number, packed.table)
    return Placed(solids, unit, at[:, :3], at[:, 3:].reshape(-1, 3, 3))


def support(placed: Placed, n: FloatArray) -> FloatArray:
    packed = units(placed.solids)
    n = np.ascontiguousarray(n)
    return _sigmas(packed.number, packed.table, packed.vertices, placed.unit, _at(placed), n)


def gaps(a: Placed, b: Placed, n: FloatArray) -> FloatArray:
    packed = units(a.solids)
    n = np.ascontiguousarray(n)
    return _gaps(packed.number, packed.table, packed.vertices, a.unit, _at(a), b.unit, _at(b), n)


def centre_normals(a: Placed, b: Placed) -> FloatArray:
    return _towards(units(a.solids).table, a.unit, _at(a), b.unit, _at(b))


def face_normals(a: Placed, b: Placed) -> FloatArray:
    return _faces(_at(a), _at(b))


def likely_gaps(one: Placed, other: Placed) -> FloatArray:
    packed = units(one.solids)
    return _likely(packed.number, packed.table, packed.vertices, one.unit, _at(one), other.unit, _at(other))


def rough_gaps(solids: Solids, where: Carriers, a: IntArray, b: IntArray) -> FloatArray:
    packed = units(solids)
    return _rough(where.position, where.rotation, packed.number, packed.table, packed.vertices, a, b)


def swept_gaps(solids: Solids, where: Carriers, a: IntArray, b: IntArray) -> FloatArray:
    if len(a) <= separation.FEW:
        return np.full(len(a), -np.inf)
    packed = units(solids)
    return _swept(where.position, where.rotation, packed.number, packed.table, packed.vertices, a, b)
