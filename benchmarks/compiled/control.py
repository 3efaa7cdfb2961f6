"""Kernels: the checker's spline in Bernstein form, and its bounds over parts (`checker.spline`, `checker.ranges`)."""

from __future__ import annotations

import numpy as np

from benchmarks.compiled.curves import piece
from benchmarks.compiled.door import kernel
from benchmarks.compiled.separating import least, most
from planner.arrays import FloatArray, IntArray

NEWTON = 4


@kernel
def value(row: FloatArray, s: float) -> float:
    """A polynomial by its control values (d+1,) at s."""
    degree = len(row) - 1
    found, choose = 0.0, 1.0
    for i in range(degree + 1):
        found += row[i] * (choose * s**i * (1.0 - s) ** (degree - i))
        choose = choose * (degree - i) / (i + 1)
    return found


@kernel
def inside(
    c0: FloatArray, c1: FloatArray, c2: FloatArray, c3: FloatArray, at: IntArray, s: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """`Spline.inside`."""
    shape = len(at), c0.shape[1]
    q, qd, qdd, qddd = np.empty(shape), np.empty(shape), np.empty(shape), np.empty(shape)
    for t in range(len(at)):
        for j in range(c0.shape[1]):
            q[t, j], qd[t, j] = value(c0[at[t], j], s[t]), value(c1[at[t], j], s[t])
            qdd[t, j], qddd[t, j] = value(c2[at[t], j], s[t]), value(c3[at[t], j], s[t])
    return q, qd, qdd, qddd


@kernel
def cut(row: FloatArray, s0: float, s1: float, out: FloatArray) -> None:
    """Control values of the part over [s0, s1], by two of de Casteljau's triangles."""
    degree = len(row) - 1
    work, left = row.copy(), np.empty(degree + 1)
    for k in range(degree + 1):
        left[k] = work[0]
        for i in range(degree - k):
            work[i] = work[i] + s1 * (work[i + 1] - work[i])
    late = s0 / s1 if s1 > 0 else 0.0
    for k in range(degree + 1):
        out[degree - k] = left[degree - k]
        for i in range(degree - k):
            left[i] = left[i] + late * (left[i + 1] - left[i])


@kernel
def heights(c0: FloatArray, c1: FloatArray, c2: FloatArray, ends: bool, out: FloatArray) -> None:
    """Greatest of q, −q, |C q̇|, |C q̈| among control values of one part, (n, 6), (m, 5), (m, 4); `ends`: of the outer
    ones only."""
    n, m = len(c0), len(c1)
    for j in range(n):
        high, low = most(c0[j, 0], c0[j, 5]), least(c0[j, 0], c0[j, 5])
        if not ends:
            for i in range(1, 5):
                high, low = most(high, c0[j, i]), least(low, c0[j, i])
        out[j], out[n + j] = high, -low
    for kind in range(2):
        c = c1 if kind == 0 else c2
        width = c.shape[1]
        for j in range(m):
            far = most(abs(c[j, 0]), abs(c[j, width - 1]))
            if not ends:
                for i in range(1, width - 1):
                    far = most(far, abs(c[j, i]))
            out[2 * n + kind * m + j] = far


@kernel
def peak(control: FloatArray) -> float:
    """`ranges._peak` of one polynomial (d+1,)."""
    degree = len(control) - 1
    highest = 0
    for i in range(degree + 1):
        if abs(control[i]) > abs(control[highest]):
            highest = i
    sign = -1.0 if control[highest] < 0 else 1.0
    s = highest / degree
    level = np.empty(degree + 1)
    for _ in range(NEWTON):
        for i in range(degree + 1):
            level[i] = sign * control[i]
        width = degree + 1
        while width > 3:
            for i in range(width - 1):
                level[i] = level[i] + s * (level[i + 1] - level[i])
            width -= 1
        curvature = level[2] - 2 * level[1] + level[0]
        first, second = level[0] + s * (level[1] - level[0]), level[1] + s * (level[2] - level[1])
        slope = (second - first) / max(1, degree - 1)
        if curvature < 0:
            s = s - slope / curvature
        s = least(most(s, 0.0), 1.0)
    return s if 0 < s < 1 else 0.5


@kernel
def parts(
    c0: FloatArray, c1: FloatArray, c2: FloatArray, tight: float, rounds: int, closest: float
) -> tuple[IntArray, FloatArray, FloatArray, FloatArray]:
    """The parts of `ranges.ranges`: piece, s0, s1 and bounds, in the order of time."""
    pieces, n, m = len(c0), c0.shape[1], c1.shape[1]
    wide = 2 * n + 2 * m
    scale, top, ends = np.zeros(2 * m), np.empty(wide), np.empty(wide)
    for p in range(pieces):
        heights(c0[p], c1[p], c2[p], False, top)
        for k in range(2 * m):
            scale[k] = most(scale[k], top[2 * n + k])
    scale *= tight
    room, count = 4 * pieces + 16, 0
    piece_of, s0s, s1s = np.empty(room, dtype=np.int64), np.empty(room), np.empty(room)
    tops = np.empty((room, wide))
    # what is still to be looked at, the earliest on top: begin, end, depth
    stack = np.empty((rounds * (2 * m + 2) + 4, 3))
    b0, b1, b2 = np.empty((n, 6)), np.empty((m, 5)), np.empty((m, 4))
    where = np.empty(2 * m + 1)
    for p in range(pieces):
        height = 1
        stack[0, 0], stack[0, 1], stack[0, 2] = 0.0, 1.0, 0.0
        while height:
            height -= 1
            s0, s1, depth = stack[height, 0], stack[height, 1], int(stack[height, 2])
            if depth == 0:
                b0[:], b1[:], b2[:] = c0[p], c1[p], c2[p]
            else:
                for j in range(n):
                    cut(c0[p, j], s0, s1, b0[j])
                for j in range(m):
                    cut(c1[p, j], s0, s1, b1[j])
                    cut(c2[p, j], s0, s1, b2[j])
            heights(b0, b1, b2, False, top)
            heights(b0, b1, b2, True, ends)
            cuts = 0
            if s1 - s0 > closest and depth < rounds - 1:
                for k in range(2 * m):
                    if not top[2 * n + k] <= ends[2 * n + k] + scale[k]:
                        if depth % 4 == 3:
                            where[0], cuts = 0.5, 1
                        else:
                            where[cuts] = peak(b1[k]) if k < m else peak(b2[k - m])
                            cuts += 1
            if cuts == 0:
                if count == room:
                    piece_of, s0s = np.append(piece_of, np.empty_like(piece_of)), np.append(s0s, np.empty_like(s0s))
                    s1s, grown = np.append(s1s, np.empty_like(s1s)), np.empty((2 * room, wide))
                    grown[:room] = tops
                    tops, room = grown, 2 * room
                piece_of[count], s0s[count], s1s[count] = p, s0, s1
                tops[count] = top
                count += 1
                continue
            ordered = np.sort(where[:cuts])
            last = s1
            for k in range(cuts - 1, -2, -1):
                begin = s0 + ordered[k] * (s1 - s0) if k >= 0 else s0
                if last > begin:
                    stack[height, 0], stack[height, 1], stack[height, 2] = begin, last, depth + 1.0
                    height += 1
                last = begin
    return piece_of[:count], s0s[:count], s1s[:count], tops[:count]


@kernel
def over(
    time: FloatArray,
    length: FloatArray,
    c0: FloatArray,
    c1: FloatArray,
    c2: FloatArray,
    piece_of: IntArray,
    begins: FloatArray,
    ends: FloatArray,
    top: FloatArray,
    standing: FloatArray,
    rests: bool,
    t0: float,
    t1: float,
    out: FloatArray,
) -> None:
    """`Ranges.sweep` of one interval: bounds of q, −q, |C q̇|, |C q̈| into out."""
    if rests and t0 >= time[-1]:
        out[:] = standing
        return
    n, m, parts_ = c0.shape[1], c1.shape[1], len(begins)
    a, b = least(most(t0, time[0]), time[-1]), least(most(t1, time[0]), time[-1])
    i = min(max(int(np.searchsorted(begins, a, side="right")) - 1, 0), parts_ - 1)
    j = max(min(int(np.searchsorted(ends, b, side="left")), parts_ - 1), i)
    b0, b1, b2 = np.empty((n, 6)), np.empty((m, 5)), np.empty((m, 4))
    found = np.empty(len(out))
    out[:] = -np.inf
    for end in range(2):
        if end == 1 and i == j:
            continue  # the same part twice: the interval lies in it
        k = i if end == 0 else j
        p = piece_of[k]
        low, high = (a, least(b, ends[k])) if end == 0 else (most(a, begins[k]), b)
        s0 = least(most((low - time[p]) / length[p], 0.0), 1.0)
        s1 = least(most((high - time[p]) / length[p], 0.0), 1.0)
        for x in range(n):
            cut(c0[p, x], s0, s1, b0[x])
        for x in range(m):
            cut(c1[p, x], s0, s1, b1[x])
            cut(c2[p, x], s0, s1, b2[x])
        heights(b0, b1, b2, False, found)
        for x in range(len(out)):
            out[x] = most(out[x], found[x])
    for k in range(i + 1, j):
        for x in range(len(out)):
            out[x] = most(out[x], top[k, x])


@kernel
def sweeps(
    time: FloatArray,
    length: FloatArray,
    c0: FloatArray,
    c1: FloatArray,
    c2: FloatArray,
    piece_of: IntArray,
    begins: FloatArray,
    ends: FloatArray,
    top: FloatArray,
    standing: FloatArray,
    rests: bool,
    t0: FloatArray,
    t1: FloatArray,
) -> FloatArray:
    """`Ranges.sweep` of many."""
    out = np.empty((len(t0), top.shape[1]))
    for k in range(len(t0)):
        over(time, length, c0, c1, c2, piece_of, begins, ends, top, standing, rests, t0[k], t1[k], out[k])
    return out


@kernel
def joints(time: FloatArray, length: FloatArray, c0: FloatArray, t: float, out: FloatArray) -> None:
    """q (n,) at one time, those outside moved to the nearest end."""
    p = piece(time, t)
    s = least(most((t - time[p]) / length[p], 0.0), 1.0)
    for j in range(c0.shape[1]):
        out[j] = value(c0[p, j], s)
