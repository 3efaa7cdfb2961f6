"""Kernel: GJK of one pair, step by step as `planner.gjk` goes."""

from __future__ import annotations

import numpy as np

from benchmarks.compiled.door import kernel
from planner.arrays import FloatArray, IntArray
from planner.gjk import ABSOLUTE_M, ITERATIONS, RELATIVE


@kernel
def corner(
    number: IntArray,
    table: FloatArray,
    vertices: FloatArray,
    u: int,
    at: FloatArray,
    x: float,
    y: float,
    z: float,
    out: FloatArray,
    sign: float,
) -> None:
    """Adds `sign` times the support point of a unit's core along (x, y, z) to out."""
    p = at[3] * x + at[6] * y + at[9] * z
    q = at[4] * x + at[7] * y + at[10] * z
    r = at[5] * x + at[8] * y + at[11] * z
    if number[u, 1] >= 0:
        best, top = number[u, 2], -np.inf
        for k in range(number[u, 2], number[u, 3]):
            value = p * vertices[k, 0] + q * vertices[k, 1] + r * vertices[k, 2]
            if value > top:
                best, top = k, value
        i, j, k = vertices[best, 0], vertices[best, 1], vertices[best, 2]
    else:
        i = table[u, 12] if p >= 0 else -table[u, 12]
        j = table[u, 13] if q >= 0 else -table[u, 13]
        k = table[u, 14] if r >= 0 else -table[u, 14]
        if table[u, 15] > 0:
            across = np.sqrt(p * p + q * q)
            if across > 0:
                i += table[u, 15] * p / across
                j += table[u, 15] * q / across
    out[0] += sign * (at[0] + (at[3] * i + at[4] * j + at[5] * k))
    out[1] += sign * (at[1] + (at[6] * i + at[7] * j + at[8] * k))
    out[2] += sign * (at[2] + (at[9] * i + at[10] * j + at[11] * k))


@kernel
def dot(a: FloatArray, b: FloatArray) -> float:
    return float(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


@kernel
def keep(points: FloatArray, i: int, out: FloatArray) -> int:
    out[0] = points[i]
    return 1


@kernel
def segment(a: FloatArray, b: FloatArray, v: FloatArray, out: FloatArray) -> int:
    """Nearest point v of a segment to the origin; the corners it depends on into out, their count."""
    ab = b - a
    length = dot(ab, ab)
    s = -dot(a, ab) / length if length > 0 else 0.0
    if s <= 0:
        v[:] = a
        out[0] = a
        return 1
    if s >= 1:
        v[:] = b
        out[0] = b
        return 1
    for i in range(3):
        v[i] = (1 - s) * a[i] + s * b[i]
    out[0], out[1] = a, b
    return 2


@kernel
def triangle(a: FloatArray, b: FloatArray, c: FloatArray, v: FloatArray, out: FloatArray) -> int:
    ab, ac = b - a, c - a
    d1, d2, d3, d4, d5, d6 = -dot(ab, a), -dot(ac, a), -dot(ab, b), -dot(ac, b), -dot(ab, c), -dot(ac, c)
    if d1 <= 0 and d2 <= 0:
        v[:] = a
        out[0] = a
        return 1
    if d3 >= 0 and d4 <= d3:
        v[:] = b
        out[0] = b
        return 1
    if d6 >= 0 and d5 <= d6:
        v[:] = c
        out[0] = c
        return 1
    vc, vb, va = d1 * d4 - d3 * d2, d5 * d2 - d1 * d6, d3 * d6 - d5 * d4
    if vc <= 0 and d1 >= 0 and d3 <= 0:
        return segment(a, b, v, out)
    if vb <= 0 and d2 >= 0 and d6 <= 0:
        return segment(a, c, v, out)
    if va <= 0 and d4 - d3 >= 0 and d5 - d6 >= 0:
        return segment(b, c, v, out)
    total = va + vb + vc
    if not total > 0:
        # the corners lie on one line: the nearest of the three edges
        point, kept, count = np.empty(3), np.empty((4, 3)), segment(a, b, v, out)
        for p, q in ((a, c), (b, c)):
            found = segment(p, q, point, kept)
            if dot(point, point) < dot(v, v):
                v[:] = point
                out[:] = kept
                count = found
        return count
    for i in range(3):
        v[i] = va / total * a[i] + vb / total * b[i] + vc / total * c[i]
    out[0], out[1], out[2] = a, b, c
    return 3


@kernel
def tetrahedron(s: FloatArray, v: FloatArray, out: FloatArray) -> int:
    """As `triangle`, for four corners; 0: the origin is inside."""
    best, point, kept = 0, np.empty(3), np.empty((4, 3))
    for i, j, k, other in ((0, 1, 2, 3), (0, 1, 3, 2), (0, 2, 3, 1), (1, 2, 3, 0)):
        p, q, r = s[i], s[j], s[k]
        e, f = q - p, r - p
        nx, ny, nz = e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]
        away = s[other] - p
        side = nx * away[0] + ny * away[1] + nz * away[2]
        # a flat tetrahedron has no inside: every face is a candidate then
        if side * -(nx * p[0] + ny * p[1] + nz * p[2]) > 0 and abs(side) > 1e-18:
            continue
        count = triangle(p, q, r, point, kept)
        if best == 0 or dot(point, point) < dot(v, v):
            best = count
            v[:] = point
            out[:] = kept
    return best


@kernel
def centre(number: IntArray, vertices: FloatArray, u: int, at: FloatArray, out: FloatArray, sign: float) -> None:
    """Adds `sign` times a point inside a unit to out."""
    i = j = k = 0.0
    if number[u, 1] >= 0:
        for m in range(number[u, 2], number[u, 3]):
            i, j, k = i + vertices[m, 0], j + vertices[m, 1], k + vertices[m, 2]
        count = number[u, 3] - number[u, 2]
        i, j, k = i / count, j / count, k / count
    out[0] += sign * (at[0] + (at[3] * i + at[4] * j + at[5] * k))
    out[1] += sign * (at[1] + (at[6] * i + at[7] * j + at[8] * k))
    out[2] += sign * (at[2] + (at[9] * i + at[10] * j + at[11] * k))


@kernel
def distance(
    number: IntArray,
    table: FloatArray,
    vertices: FloatArray,
    a: int,
    one: FloatArray,
    b: int,
    other: FloatArray,
    normal: FloatArray,
) -> float:
    """`separate` of a pair, m, its unit normal into `normal` (3,); −1: they meet."""
    v, w = np.zeros(3), np.zeros(3)
    centre(number, vertices, b, other, v, 1.0)
    centre(number, vertices, a, one, v, -1.0)
    if dot(v, v) == 0:
        return -1.0
    corner(number, table, vertices, b, other, -v[0], -v[1], -v[2], w, 1.0)
    corner(number, table, vertices, a, one, v[0], v[1], v[2], w, -1.0)
    v[:] = w
    simplex, kept = np.empty((4, 3)), np.empty((4, 3))
    simplex[0] = v
    count, best = 1, -np.inf
    normal[:] = v
    for _ in range(ITERATIONS):
        length = np.sqrt(dot(v, v))
        if not length > 1e-12:
            return -1.0
        w[:] = 0.0
        corner(number, table, vertices, b, other, -v[0], -v[1], -v[2], w, 1.0)
        corner(number, table, vertices, a, one, v[0], v[1], v[2], w, -1.0)
        found = dot(v, w) / length
        if found > best:
            best = found
            normal[:] = v
        again = False
        for i in range(count):
            again = again or (simplex[i, 0] == w[0] and simplex[i, 1] == w[1] and simplex[i, 2] == w[2])
        if length - best <= RELATIVE * length + ABSOLUTE_M or again:
            break
        simplex[count] = w
        if count == 1:
            count = segment(simplex[0], simplex[1], v, kept)
        elif count == 2:
            count = triangle(simplex[0], simplex[1], simplex[2], v, kept)
        else:
            count = tetrahedron(simplex, v, kept)
            if count == 0:
                return -1.0
        simplex[:] = kept
    size = np.sqrt(dot(normal, normal))
    for i in range(3):
        normal[i] /= size
    found = best - table[a, 16] - table[b, 16]
    return found if found > 0.0 else 0.0
