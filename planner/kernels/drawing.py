"""Compiled: random candidates by free vias, drawn anew or varied from others. The random numbers come from the caller.

A candidate is a row of `assur.planner.kernels.candidates`. `chances` are uniform in [0, 1), `normals` are standard
normal numbers; a row of them serves one candidate.
"""

from __future__ import annotations

import math

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.compiled import kernel
from assur.planner.kernels.candidates import (
    EFFORT,
    FIRST_VIA,
    LATE,
    LOWER,
    MOST_VIAS,
    OPTION,
    PACES,
    THROUGH,
    UPPER,
    VIAS,
    WAIT,
)

VIA_PACES = (0.0, 0.4, 0.8, 1.2)
"""Paces at which a free via is flown by."""
EFFORTS = (1.0, 1.0, 0.7, 0.4)
"""Shares of the limits of acceleration that are used by joint legs among moving bodies."""
SLOWEST_THROUGH, FASTEST_THROUGH = 0.2, 1.0
"""Range of the paces at which a via control point is passed."""
WAIT_S, LATE_S = 0.5, 0.3
"""Means of waits and of delays behind the earliest meeting, s."""
WAIT_TOO, LATE_TOO = 0.3, 0.3
"""How often a candidate through vias waits as well, and how often one comes late."""

EARLIEST, LATEST = 0.1, 0.9
"""A via is drawn beside the straight joint motion between these shares of it."""
NEAR_WAY, ANYWHERE = 0.3, 0.4
"""Shares of vias near the straight joint motion and anywhere; the others are near it with a folded arm."""
SPREAD = 0.2
"""Spread of vias near the straight joint motion, in ranges of the joints."""
FOLDED = 0.3
"""A folded joint is this far from an end of its range at most, in ranges."""
ABOVE, BELOW_TOP = 0.7, 0.6
"""How often the lift joint stays above both ends, and how often it is not at its very top."""

NUDGES = (0.03, 0.08)
"""Spread of a varied via, in ranges of the joints."""
NUDGED = 3
"""Joints that a variation moves: the first of them; the others turn the tool."""
PACE_NUDGE, TIME_NUDGE_S = 0.2, 0.1
"""Spread of a varied pace, and of a varied wait or delay, s."""
NUDGED_TIME = 0.5
"""How often the wait, and how often the delay, of a varied candidate changes."""
GAINS_A_VIA = 0.6
"""How often a varied candidate without vias gets one: a direct motion that is nearly free may need it."""

VIA_CHANCES, CHANCES = 8, 10
"""Chances that a via takes, and one more for each joint; those that a candidate takes besides, two for shares of the
way among them."""
VARIED_CHANCES, VARIED_NORMALS = 4, MOST_VIAS + 2
"""What a variation takes, and a normal number for each joint of each via besides."""

TURNS, CLEARS, LIFTS = range(3)
"""What a joint does in a via: it turns with the way only, it clears something, or it lifts."""


@kernel("int64(float64[::1], float64)")
def chosen(cumulative: FloatArray, chance: float) -> int:
    """The number of the choice for a chance, of those with `cumulative` (N,) weights, the last of them 1."""
    for k in range(len(cumulative) - 1):
        if chance < cumulative[k]:
            return k
    return len(cumulative) - 1


@kernel(
    "void(float64[:, ::1], int64[::1], float64[::1], float64[::1], float64, float64[::1], float64[::1], float64[::1])",
    entry=True,
)
def free_via(
    limits: FloatArray,
    roles: IntArray,
    start: FloatArray,
    goal: FloatArray,
    share: float,
    chances: FloatArray,
    normals: FloatArray,
    via: FloatArray,
) -> None:
    """Fills `via` (n,) with joints within `limits` (≥ 2, n) beside `share` of the way from `start` (n,) to `goal`.

    `roles` (n,): what each joint does; `chances` (VIA_CHANCES + n,), `normals` (n,).
    """
    n, clearing, seen = len(start), 0, 0
    for j in range(n):
        clearing += roles[j] == CLEARS
    anywhere, folds = NEAR_WAY <= chances[0] < NEAR_WAY + ANYWHERE, chances[0] >= NEAR_WAY + ANYWHERE
    # one joint near an end of its range, but never the first: a folded arm passes where a stretched one does not
    folded = 1 + int(chances[1] * (clearing - 1)) if folds and clearing > 1 else -1
    for j in range(n):
        lower, upper = limits[LOWER, j], limits[UPPER, j]
        span, q = upper - lower, start[j] + share * (goal[j] - start[j])
        if roles[j] == CLEARS:
            if anywhere:
                q = lower + chances[VIA_CHANCES + j] * span
            elif seen == folded:
                inward = FOLDED * chances[2] * span
                q = upper - inward if chances[3] < 0.5 else lower + inward
            else:
                q += SPREAD * normals[j] * span
            seen += 1
        elif roles[j] == LIFTS:
            low = min(max(start[j], goal[j]), upper) if chances[4] < ABOVE else lower
            q = low + chances[5] * (upper - low) if chances[6] < BELOW_TOP else upper
        via[j] = min(max(q, lower), upper)


@kernel(
    "void(float64[:, ::1], int64[::1], float64[::1], float64[:, ::1], float64[::1], float64[::1], float64[::1],"
    " boolean, boolean, boolean, float64[:, ::1], float64[:, ::1], float64[:, ::1])"
)
def draw(
    limits: FloatArray,
    roles: IntArray,
    start: FloatArray,
    goals: FloatArray,
    late: FloatArray,
    options: FloatArray,
    vias: FloatArray,
    waits: bool,
    moving: bool,
    through: bool,
    chances: FloatArray,
    normals: FloatArray,
    rows: FloatArray,
) -> None:
    """Fills `rows` (N, FIRST_VIA + 2n) with new candidates.

    `goals` (M, n): joints at which each option is met, `late` (M,): whether it can be met later (1 or 0); `options`
    (M,) and `vias` (3,): cumulative weights of the options, and of none, one and two vias; whether the arm may wait,
    anything is moving, and the control point is passed `through`. `chances` (N, CHANCES + 2 (VIA_CHANCES + n)),
    `normals` (N, 2n).
    """
    n = len(start)
    for i in range(len(rows)):
        row, chance = rows[i], chances[i]
        option, count = chosen(options, chance[0]), chosen(vias, chance[1])
        row[OPTION], row[VIAS] = option, count
        wait = waits and moving and (count == 0 or chance[2] < WAIT_TOO)
        row[WAIT] = -WAIT_S * math.log(1.0 - chance[3]) if wait else 0.0
        row[LATE] = -LATE_S * math.log(1.0 - chance[4]) * late[option] if chance[5] < LATE_TOO else 0.0
        row[EFFORT] = EFFORTS[int(chance[6] * len(EFFORTS))] if moving else 1.0
        row[THROUGH] = SLOWEST_THROUGH + chance[7] * (FASTEST_THROUGH - SLOWEST_THROUGH) if through else 0.0
        for k in range(MOST_VIAS):
            share = min(chance[8], chance[9]) if k == 0 else max(chance[8], chance[9])
            of_via = chance[CHANCES + k * (VIA_CHANCES + n) : CHANCES + (k + 1) * (VIA_CHANCES + n)]
            via = row[FIRST_VIA + k * n : FIRST_VIA + (k + 1) * n]
            share = EARLIEST + (LATEST - EARLIEST) * share
            free_via(limits, roles, start, goals[option], share, of_via, normals[i, k * n : (k + 1) * n], via)
            row[PACES + k] = VIA_PACES[int(of_via[7] * len(VIA_PACES))]


@kernel(
    "void(float64[:, ::1], float64[::1], boolean, float64[:, ::1], float64[:, ::1], float64[:, ::1], float64[:, ::1])"
)
def vary(
    limits: FloatArray,
    late: FloatArray,
    waits: bool,
    parents: FloatArray,
    chances: FloatArray,
    normals: FloatArray,
    rows: FloatArray,
) -> None:
    """Fills `rows` (N, FIRST_VIA + 2n) with one child of each of `parents`.

    `late`: as in `draw`; `waits`: whether waiting is possible and changes anything. `chances` (N, VARIED_CHANCES),
    `normals` (N, VARIED_NORMALS + 2n).
    """
    n = limits.shape[1]
    for i in range(len(rows)):
        parent, row, chance, normal = parents[i], rows[i], chances[i], normals[i]
        for column in range(len(row)):
            row[column] = parent[column]
        spread = NUDGES[0] if chance[0] < 0.5 else NUDGES[1]
        for k in range(MOST_VIAS):
            row[PACES + k] = max(0.0, row[PACES + k] + PACE_NUDGE * normal[k])
            for j in range(min(n, NUDGED)):
                lower, upper, column = limits[LOWER, j], limits[UPPER, j], FIRST_VIA + k * n + j
                moved = row[column] + spread * (upper - lower) * normal[VARIED_NORMALS + k * n + j]
                row[column] = min(max(moved, lower), upper)
        if waits and chance[1] < NUDGED_TIME:
            row[WAIT] = max(0.0, row[WAIT] + TIME_NUDGE_S * normal[MOST_VIAS])
        if late[int(parent[OPTION])] > 0.0 and chance[2] < NUDGED_TIME:
            row[LATE] = max(0.0, row[LATE] + TIME_NUDGE_S * normal[MOST_VIAS + 1])
        if row[VIAS] == 0.0 and chance[3] < GAINS_A_VIA:
            row[VIAS] = 1.0
