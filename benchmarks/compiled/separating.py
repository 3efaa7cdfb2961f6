"""Kernels: supports, gaps and likely normals of pairs of units, as `planner.separation` has them, pair by pair.

A unit is a row of `number` (carrier, hull, first and behind its last vertex) and of `table` (centre 0:3, rotation 3:12,
half sizes 12:15, disc, ball); a placed unit is a row of twelve: centre and axes, both in the world.
"""

from __future__ import annotations

import numpy as np

from benchmarks.compiled.door import inner, kernel
from planner.arrays import FloatArray, IntArray

ROUNDS = 3


@inner
def least(x: float, y: float) -> float:
    """`numpy.minimum`: NaN if one of them is."""
    return x if (x <= y or x != x) else y


@inner
def most(x: float, y: float) -> float:
    """`numpy.maximum`: NaN if one of them is."""
    return x if (x >= y or x != x) else y


@inner
def clamp(x: float, size: float) -> float:
    """x between −size and size; NaN stays."""
    below = -size if x < -size else x
    return size if below > size else below


@inner
def put(
    position: FloatArray, rotation: FloatArray, t: int, number: IntArray, table: FloatArray, u: int, out: FloatArray
) -> None:
    """Unit u at time number t."""
    k = number[u, 0]
    for i in range(3):
        r0, r1, r2 = rotation[t, k, i, 0], rotation[t, k, i, 1], rotation[t, k, i, 2]
        out[i] = (r0 * table[u, 0] + r1 * table[u, 1] + r2 * table[u, 2]) + position[t, k, i]
        for j in range(3):
            out[3 + 3 * i + j] = r0 * table[u, 3 + j] + r1 * table[u, 6 + j] + r2 * table[u, 9 + j]


@inner
def sigma(
    number: IntArray, table: FloatArray, vertices: FloatArray, u: int, at: FloatArray, x: float, y: float, z: float
) -> float:
    """The support of a placed unit along (x, y, z), from its centre."""
    p = x * at[3] + y * at[6] + z * at[9]
    q = x * at[4] + y * at[7] + z * at[10]
    r = x * at[5] + y * at[8] + z * at[11]
    if number[u, 1] >= 0:
        first = number[u, 2]
        found: float = p * vertices[first, 0] + q * vertices[first, 1] + r * vertices[first, 2]
        for k in range(first + 1, number[u, 3]):
            found = most(found, p * vertices[k, 0] + q * vertices[k, 1] + r * vertices[k, 2])
        return found
    total: float = abs(p) * table[u, 12] + abs(q) * table[u, 13] + abs(r) * table[u, 14]
    if table[u, 15] != 0.0:
        total += table[u, 15] * np.sqrt(p * p + q * q)
    return float(total + table[u, 16])


@inner
def gap(
    number: IntArray,
    table: FloatArray,
    vertices: FloatArray,
    a: int,
    one: FloatArray,
    b: int,
    other: FloatArray,
    x: float,
    y: float,
    z: float,
) -> float:
    """Along (x, y, z), which points from a to b."""
    between: float = x * (other[0] - one[0]) + y * (other[1] - one[1]) + z * (other[2] - one[2])
    return (
        between - sigma(number, table, vertices, a, one, x, y, z) - sigma(number, table, vertices, b, other, -x, -y, -z)
    )


@inner
def nearest(table: FloatArray, u: int, at: FloatArray, x: float, y: float, z: float) -> tuple[float, float, float]:
    """The point of a unit's core nearest to (x, y, z)."""
    dx, dy, dz = x - at[0], y - at[1], z - at[2]
    p = dx * at[3] + dy * at[6] + dz * at[9]
    q = dx * at[4] + dy * at[7] + dz * at[10]
    r = dx * at[5] + dy * at[8] + dz * at[11]
    h0, h1, h2 = table[u, 12], table[u, 13], table[u, 14]
    i, j, k = clamp(p, h0), clamp(q, h1), clamp(r, h2)
    if table[u, 15] != 0.0:
        ox, oy = p - i, q - j
        square, disc = ox * ox + oy * oy, table[u, 15]
        share = 1.0 if square <= disc * disc else disc / np.sqrt(square)
        i += ox * share
        j += oy * share
    return (
        (at[3] * i + at[4] * j + at[5] * k) + at[0],
        (at[6] * i + at[7] * j + at[8] * k) + at[1],
        (at[9] * i + at[10] * j + at[11] * k) + at[2],
    )


@kernel
def towards(table: FloatArray, a: int, one: FloatArray, b: int, other: FloatArray, n: FloatArray) -> None:
    """`centre_normals` of a pair into n (2.., 3)."""
    n[0, 0] = n[0, 1] = 0.0
    n[0, 2] = 1.0 if other[2] >= one[2] else -1.0
    bx, by, bz = other[0], other[1], other[2]
    ax, ay, az = bx, by, bz
    for _ in range(ROUNDS):
        ax, ay, az = nearest(table, a, one, bx, by, bz)
        bx, by, bz = nearest(table, b, other, ax, ay, az)
    x, y, z = bx - ax, by - ay, bz - az
    length = np.sqrt(x * x + y * y + z * z)
    if length > 1e-9:
        n[1, 0], n[1, 1], n[1, 2] = x / length, y / length, z / length
    else:
        n[1, 0], n[1, 1], n[1, 2] = n[0, 0], n[0, 1], n[0, 2]


@kernel
def faces(one: FloatArray, other: FloatArray, n: FloatArray) -> None:
    """`face_normals` of a pair into n (6, 3)."""
    dx, dy, dz = other[0] - one[0], other[1] - one[1], other[2] - one[2]
    for k in range(6):
        at, j = (one, k) if k < 3 else (other, k - 3)
        x, y, z = at[3 + j], at[6 + j], at[9 + j]
        side = 1.0 if x * dx + y * dy + z * dz >= 0 else -1.0
        n[k, 0], n[k, 1], n[k, 2] = x * side, y * side, z * side


@kernel
def likely(
    number: IntArray,
    table: FloatArray,
    vertices: FloatArray,
    a: int,
    one: FloatArray,
    b: int,
    other: FloatArray,
    n: FloatArray,
) -> float:
    """`likely_gaps` of a pair; `n` (6, 3) is scratch."""
    towards(table, a, one, b, other, n)
    found = most(
        gap(number, table, vertices, a, one, b, other, n[0, 0], n[0, 1], n[0, 2]),
        gap(number, table, vertices, a, one, b, other, n[1, 0], n[1, 1], n[1, 2]),
    )
    if not found > 0:
        faces(one, other, n)
        for k in range(6):
            found = most(found, gap(number, table, vertices, a, one, b, other, n[k, 0], n[k, 1], n[k, 2]))
    return -np.inf if found != found else found


@kernel
def height(table: FloatArray, number: IntArray, vertices: FloatArray, u: int, at: FloatArray) -> float:
    """Half the height of a placed unit; of a hull the radius about its origin."""
    if number[u, 1] >= 0:
        return width(table, number, vertices, u)
    found = abs(at[9]) * table[u, 12] + abs(at[10]) * table[u, 13] + abs(at[11]) * table[u, 14]
    return float(found + (table[u, 15] * np.hypot(at[9], at[10]) + table[u, 16]))


@kernel
def width(table: FloatArray, number: IntArray, vertices: FloatArray, u: int) -> float:
    """The radius of a unit about its centre in all directions."""
    if number[u, 1] >= 0:
        far = 0.0
        for k in range(number[u, 2], number[u, 3]):
            far = most(far, vertices[k, 0] ** 2 + vertices[k, 1] ** 2 + vertices[k, 2] ** 2)
        return float(np.sqrt(far))
    square = table[u, 12] ** 2 + table[u, 13] ** 2 + table[u, 14] ** 2
    return float(np.sqrt(square) + table[u, 15] + table[u, 16])


@kernel
def rough(one: FloatArray, tall_a: float, wide_a: float, other: FloatArray, tall_b: float, wide_b: float) -> float:
    """`rough_gaps` of a pair."""
    x, y = other[0] - one[0], other[1] - one[1]
    found: float = most(abs(other[2] - one[2]) - tall_a - tall_b, np.sqrt(x * x + y * y) - wide_a - wide_b)
    return found
