"""What is claimed of the tool, row by row: shown for the time of the row, or for all parts of it."""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.claim import tables as tb
from assur.planner.checker.claim.chain import chain, slot_of, vector
from assur.planner.checker.claim.joint_bounds import sum_within
from assur.planner.checker.claim.motion import joints_over, piece_begun_at, rounding
from assur.planner.checker.claim.obligations import amount_of, corrected_within, is_fixed, share_of
from assur.planner.checker.claim.points import (
    CORRECTED,
    DISTANCES,
    ERRORS,
    POINTS,
    RATES,
    SUMS,
    is_near_chord,
    moves_with_point,
    rate_within,
    see,
)
from assur.planner.checker.claim.rows import place_side
from assur.planner.checker.claim.solids import jet, length, put
from assur.planner.checker.claim.tables import F1, F2, f8, i8
from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from assur.planner.compiled import kernel, types

# Two bodies are no farther apart than is claimed at an instant: points of both are so near to each other.

CHOSEN = 1e-9
"""m, or a sine: what a direction does not choose by more than this is in the middle."""


@kernel(f8(F1, i8, F1))
def component_along(own: FloatArray, at: int, direction: FloatArray) -> float:
    """The scalar product of the vector in columns `at` to `at` + 2 with a direction."""
    return float(own[at] * direction[0] + own[at + 1] * direction[1] + own[at + 2] * direction[2])


@kernel(types.void(F1, f8, F1, i8))
def add(result: FloatArray, share: float, own: FloatArray, at: int) -> None:
    """Adds a share of the vector in columns `at` to `at` + 2."""
    for m in range(3):
        result[m] += share * own[at + m]


@kernel(types.void(tb.GEOMETRY, F2, i8, f8, F1, F2, F1))
def add_farthest(
    g: tb.Geometry,
    at: FloatArray,
    solid: int,
    weight: float,
    direction: FloatArray,
    room: FloatArray,
    result: FloatArray,
) -> None:
    """Adds a weight of the point of a solid that is farthest along a unit vector of the world. `at`: the jets of its
    carrier. `room`: for three vectors."""
    own, here, local, far = g.solids[solid], room[0], room[1], -math.inf
    first, many = int(own[tb.SOLID_VERTEX]), int(own[tb.SOLID_VERTICES])
    for column in range(3):
        local[column] = 0.0
        for m in range(3):
            local[column] += direction[m] * at[3 + 3 * column + m, 0]
    for i in range(first, first + many):
        far = max(far, component_along(g.vertices[i], 0, local))
    here[:3] = 0.0
    add(here, 1.0, own, tb.SOLID_CENTRE)
    for i in range(first + many - 1, first - 1, -1):
        if component_along(g.vertices[i], 0, local) >= far - CHOSEN:
            here[:3] = 0.0
            add(here, 1.0, g.vertices[i], 0)
    for e in range(tb.SOLID_EDGE, tb.SOLID_EDGE + 3 * int(own[tb.SOLID_EDGES]), 3):
        way = component_along(own, e, local)
        add(here, 1.0 if way > CHOSEN else -1.0 if way < -CHOSEN else 0.0, own, e)
    add(local, -component_along(own, tb.SOLID_AXIS, local), own, tb.SOLID_AXIS)
    across = length(local, 0, 3)
    add(here, own[tb.SOLID_DISC] / across if across > CHOSEN else 0.0, local, 0)
    for m in range(3):
        place = at[m, 0] + here[0] * at[3 + m, 0] + here[1] * at[6 + m, 0] + here[2] * at[9 + m, 0]
        result[m] += weight * (place + own[tb.SOLID_BALL] * direction[m])


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, F2))
def is_near(k: Claim, g: tb.Geometry, s: tb.Scratch, own: FloatArray, stack: FloatArray) -> bool:
    """Whether two bodies are no farther apart than is claimed. `stack`: room for what a row is about, and vectors."""
    p, t, total, off = int(own[c.DISTANCE_PHASE]), own[c.DISTANCE_TIME], 0.0, tb.SLACK
    room, points, direction = stack[0], stack[1], stack[2]
    if not k.phases[p, c.PHASE_T0] <= t <= k.phases[p, c.PHASE_T1]:
        return False
    for i in range(4):
        total += own[c.DISTANCE_WEIGHT + i]
    if not abs(total - 1.0) <= 1e-9:
        return False
    points[:3] = 0.0
    for side in range(2):
        at, sign = side * tb.SIDES, 1.0 - 2.0 * side
        place_side(k, g, room, at, p, int(own[c.DISTANCE_BODY + side]), own[c.DISTANCE_PIECE + side])
        solid, on = int(room[at + tb.SIDE_SOLID]), int(room[at + tb.SIDE_CARRIER])
        slot = slot_of(k, g, s, on, t, t)
        if slot < 0:
            return False
        off += rounding(g, on, 0, g.solids[solid, tb.SOLID_SIZE])
        for i in range(4):
            d = c.DISTANCE_DIRECTION + 3 * i
            if own[c.DISTANCE_WEIGHT + i] == 0.0:
                continue
            size = length(own, d, d + 3)
            if not 0.0 < size < math.inf:
                return False
            direction[:3] = 0.0
            add(direction, sign / size, own, d)
            weight = sign * own[c.DISTANCE_WEIGHT + i] / total
            add_farthest(g, s.jets[slot, on], solid, weight, direction, stack[3:], points)
    return bool(length(points, 0, 3) + off <= own[c.DISTANCE_MOST])


# How far the tool may be from its point, whatever is uncertain (N15): the worst sum of all displacements.
#
# What has a direction counts with either sign, and all signs are combined. What has any horizontal direction, or goes
# up or down, is added to the longest sum. Lag moves the tool along the rates of its joints, but for a bow: half of what
# bounds the second derivative. A late frame is evaluated at instants; between them its way leaves a chord (N9).

INSTANTS = 65
"""Of a frame that may be late."""
MOST_SIGNED = 10
"""Vectors whose signs are combined; what are more count in full."""
FLAT, UP, YAW, SIGNED = range(4)
"""Sums of what counts in full: horizontally, up or down, m, as yaw, rad; and how many vectors there are."""


@kernel(types.void(F2, F1, f8, f8, f8))
def add_signed(vectors: FloatArray, sums: FloatArray, x: float, y: float, z: float) -> None:
    """Adds a vector that counts with either sign. A vertical one goes up or down, whatever the others do."""
    many = int(sums[SIGNED])
    if (x == 0.0 and y == 0.0) or many >= MOST_SIGNED:
        sums[FLAT], sums[UP] = sums[FLAT] + math.sqrt(x * x + y * y), sums[UP] + abs(z)
        return
    vectors[many, 0], vectors[many, 1], vectors[many, 2] = x, y, z
    sums[SIGNED] += 1.0


@kernel(types.void(tb.CLAIM, F1, F2, F1))
def add_displaced(k: Claim, own: FloatArray, vectors: FloatArray, sums: FloatArray) -> None:
    """Adds displacements of frames, each with the share by which it moves the point against the tool."""
    p, d = int(own[c.ERROR_PHASE]), c.DISPLACED_DIRECTION
    for i in range(len(k.displaced)):
        row, (least, most) = k.displaced[i], share_of(k, p, i)
        if row[c.DISPLACED_FRAME] == own[c.ERROR_FRAME]:
            least, most = 1.0 - most, 1.0 - least
        size = max(abs(least), abs(most)) * amount_of(k, i, own[c.ERROR_TIME])
        if size > 0.0 and row[c.DISPLACED_LEVEL] > 0.0:
            sums[FLAT] += size
        elif size > 0.0:
            add_signed(vectors, sums, size * row[d], size * row[d + 1], size * row[d + 2])


@kernel(f8(f8))
def angle_of(chord: float) -> float:
    """The angle whose chord on a circle of radius 1 is given, π at most."""
    return 2.0 * math.asin(0.5 * chord) if chord < 2.0 else math.pi


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, F2, F1))
def add_lag(k: Claim, g: tb.Geometry, s: tb.Scratch, own: FloatArray, vectors: FloatArray, sums: FloatArray) -> bool:
    """Adds what lagging joints displace and turn: for each joint the rate of the point at a rate of its lag alone, then
    half of the second derivative for all joints anywhere within their lag. False: it is not known."""
    on, n, t, tool = int(own[c.ERROR_LINK]), int(k.arms[0, c.ARM_JOINTS]), own[c.ERROR_TIME], own[c.ERROR_TOOL :]
    at, turn, chord = tb.INSTANTS + tb.INTERVALS, 0.0, 0.0
    s.way[0], s.way[1], s.way[2], yaw = math.cos(tool[3]), math.sin(tool[3]), 0.0, int(k.links[on, c.LINK_YAW])
    if at >= len(s.jets):
        return True  # no joint lags
    # rows of bodies keep jets in this slot for an interval: they are computed anew
    jets, s.known[at, 0, 0] = s.jets[at], np.nan
    for j in range(n + 1):
        lag = k.required[0, c.REQUIRED_LAG + j] if j < n else 1.0
        if lag == 0.0:
            continue
        if not joints_over(g, 0, n, t, t, s):
            return False
        for m in range(n):
            q, most = s.joints[m], k.required[0, c.REQUIRED_LAG + m]
            q[1], q[2], q[3], q[4], q[5] = 0.0, lag if m == j else 0.0, 0.0, 0.0, 0.0
            if j == n:
                q[1], q[3] = most, most
        if not chain(k, g, 0, jets, s):
            return False
        for axis in range(3):
            put(s.vectors, 0, axis, vector(jets, on, axis, tool, True))
            put(s.vectors, 1, axis, vector(jets, on, axis, s.way, False))
        u, v, w = jet(s.vectors, 0, 0), jet(s.vectors, 0, 1), jet(s.vectors, 0, 2)
        a, b = jet(s.vectors, 1, 0), jet(s.vectors, 1, 1)
        if j < n:
            turn += abs(k.angles[yaw, c.ANGLE_SHARE + j]) * lag
            chord += math.sqrt(a[2] * a[2] + b[2] * b[2])
            add_signed(vectors, sums, u[2], v[2], w[2])
        else:
            sums[FLAT] += 0.5 * math.sqrt((abs(u[4]) + u[5]) ** 2 + (abs(v[4]) + v[5]) ** 2)
            sums[UP] += 0.5 * (abs(w[4]) + w[5])
            chord += 0.5 * math.sqrt((abs(a[4]) + a[5]) ** 2 + (abs(b[4]) + b[5]) ** 2)
    if g.carriers[on, tb.CARRIER_UPRIGHT] > 0.0:
        sums[YAW] += turn if k.links[on, c.LINK_COUPLER] < 0.0 else angle_of(chord)
    return True


@kernel(i8(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, F2, F1))
def late_ways(k: Claim, g: tb.Geometry, s: tb.Scratch, own: FloatArray, ways: FloatArray, sums: FloatArray) -> int:
    """Writes where the point of a frame that may be late is, seen from the tool, at instants (.., 3), m, then its place
    on the frame in axes of the world (.., 2). Adds by how much its way and its turn may differ. Returns how many
    instants there are; 0: it is not known."""
    on, f, t, tool = int(own[c.ERROR_LINK]), int(own[c.ERROR_FRAME]), own[c.ERROR_TIME], own[c.ERROR_TOOL :]
    frame_on, target, many, bow, bow_up, turn, bend = int(g.on[f, 0]), own[c.ERROR_TARGET :], 1, 0.0, 0.0, 0.0, 0.0
    first = last = fast = 0.0
    if not is_fixed(g, f):
        first = -k.frames[f, c.FRAME_SHIFT + 1]
        last = k.required[0, c.REQUIRED_LATE] - k.frames[f, c.FRAME_SHIFT]
        many = INSTANTS if last > first else 1
    step, s.way[0], s.way[1], s.way[2] = (last - first) / max(many - 1, 1), 1.0, 0.0, 0.0
    if not (see(k, g, s, 0, on, True, tool, t, t) and see(k, g, s, 1, frame_on, False, s.way, t, t)):
        return 0
    for i in range(many):
        u = t + first + i * step
        for part in range(2 if i + 1 < many else 1):
            v = u if part == 0 else t + first + (i + 1) * step
            if not (see(k, g, s, 2, frame_on, True, target, u, v) and see(k, g, s, 3, frame_on, False, s.way, u, v)):
                return 0
            there = slot_of(k, g, s, frame_on, u, v)
            for axis in range(3):
                at, x = s.vectors[2, axis], s.vectors[3, axis]
                fast = max(fast, abs(at[2]) + at[3], abs(x[2]) + x[3])
                if part == 0:
                    ways[i, axis] = at[0] - s.vectors[0, axis, 0]
                    ways[i, 3 + axis] = at[0] - s.jets[there, frame_on, axis, 0]
                    ways[many, axis] = x[0] - s.vectors[1, axis, 0]
                else:
                    ways[many, axis], ways[many, 3 + axis] = abs(at[4]) + at[5], abs(x[4]) + x[5]
            if part == 0:
                turn = max(turn, length(ways[many], 0, 3))
            else:
                bow, bow_up = max(bow, length(ways[many], 0, 2)), max(bow_up, ways[many, 2])
                bend = max(bend, length(ways[many], 3, 6))
    # instants are sums, which round
    off = 3.0 * tb.ULP * (abs(t) + abs(first) + abs(last)) * fast if first != 0.0 or last != 0.0 else 0.0
    sums[YAW] += angle_of(turn + bend * step * step / 8.0) + off
    off += rounding(g, frame_on, 0, length(target, 0, 3))
    sums[FLAT] += bow * step * step / 8.0 + s.vectors[0, 0, 1] + s.vectors[0, 1, 1] + off
    sums[UP] += bow_up * step * step / 8.0 + s.vectors[0, 2, 1] + off
    return many


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, F1), allocates=True)
def error_within(k: Claim, g: tb.Geometry, s: tb.Scratch, own: FloatArray, state: FloatArray) -> bool:
    """Whether the tool is no farther from its point than is claimed."""
    vectors, ways, sums, t = np.zeros((MOST_SIGNED, 3)), np.zeros((INSTANTS + 1, 6)), np.zeros(SIGNED + 1), own[0]
    p, yaw = int(own[c.ERROR_PHASE]), k.frames[int(own[c.ERROR_FRAME]), c.FRAME_YAW]
    sums[FLAT], sums[UP], sums[YAW] = own[c.ERROR_OFF] + tb.SLACK, own[c.ERROR_OFF + 1] + tb.SLACK, tb.SLACK
    sums[YAW] += own[c.ERROR_OFF + 2] + yaw
    sums[SIGNED] = 1.0  # the first vector is the turn of the frame
    if not k.phases[p, c.PHASE_T0] <= t <= k.phases[p, c.PHASE_T1]:
        return False
    add_displaced(k, own, vectors, sums)
    many = late_ways(k, g, s, own, ways, sums) if add_lag(k, g, s, own, vectors, sums) else 0
    count = int(sums[SIGNED])
    state[tb.WORK] -= 1.0 + many * 2.0**count / 50.0
    if many == 0 or not state[tb.WORK] > 0.1 * s.work[tb.TOUCHED]:
        return False
    far, level, high = 0.0, 0.0, 0.0
    for i in range(many):
        arm = length(ways[i], 3, 5)
        vectors[0, 0], vectors[0, 1] = -yaw * ways[i, 4], yaw * ways[i, 3]
        for signs in range(2**count if arm * yaw > 0.0 else 2 ** (count - 1)):
            x, y, z = ways[i, 0], ways[i, 1], ways[i, 2]
            for m in range(count):
                # the first vector, which may be 0, has the last sign
                sign = 1.0 - 2.0 * ((signs >> ((m - 1) % count)) & 1)
                x, y, z = x + sign * vectors[m, 0], y + sign * vectors[m, 1], z + sign * vectors[m, 2]
            # a turn leaves its tangent by less than half its square
            side = math.sqrt(x * x + y * y) + sums[FLAT] + 0.5 * arm * yaw * yaw
            height = abs(z) + sums[UP]
            far, level, high = max(far, math.sqrt(side * side + height * height)), max(level, side), max(high, height)
    within = far + sums[YAW] * own[c.ERROR_ARM] <= own[c.ERROR_FAR] and level <= own[c.ERROR_FLAT]
    return bool(within and high <= own[c.ERROR_UP] and sums[YAW] <= own[c.ERROR_YAW])


@kernel(f8(tb.GEOMETRY, f8, f8))
def middle(g: tb.Geometry, t0: float, t1: float) -> float:
    """Where an interval is divided: where two pieces of the robot's motion meet, for there its acceleration may jump;
    else in its middle. As many pieces are on either side, for halves of a time never reach a piece that is far shorter
    than its neighbours."""
    first = int(g.spans[0, 0])
    last = first + int(g.spans[0, 1]) - 1
    i, j = piece_begun_at(g.curves, first, last, t0), piece_begun_at(g.curves, first, last, t1)
    if g.curves[j, 0] >= t1:
        j -= 1
    return float(g.curves[(i + j + 1) // 2, 0]) if i < j else 0.5 * (t0 + t1)


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, i8, i8, F1, F2, F1))
def claim_holds(
    k: Claim, g: tb.Geometry, s: tb.Scratch, kind: int, row: int, own: FloatArray, stack: FloatArray, state: FloatArray
) -> bool:
    """Whether a row of one of the tables above is shown. `stack`: room for intervals, the last rows for numbers."""
    result, top = stack[len(stack) - 1], 1
    stack[0, 0], stack[0, 1], stack[0, 2] = own[0], own[1], 0.0
    if kind == SUMS:
        return sum_within(k, own, -1.0, stack, state)
    if kind == DISTANCES:
        state[tb.WORK] -= 1.0
        return is_near(k, g, s, own, stack)
    if kind == ERRORS:
        return error_within(k, g, s, own, state)
    if kind == POINTS and not moves_with_point(k, g, s, own, result):
        return False
    while top > 0:
        top -= 1
        t0, t1, depth, shown = stack[top, 0], stack[top, 1], stack[top, 2], False
        state[tb.WORK] -= 1.0
        if kind == RATES:
            shown = rate_within(k, g, s, own, t0, t1)
        elif kind == CORRECTED:
            shown = own[c.PHASE_ROBOT] == 0.0 or corrected_within(k, g, s, row, t0, t1)
        else:
            shown = is_near_chord(k, g, s, kind, own, t0, t1, result, state)
        if shown:
            continue
        if depth >= tb.DEEPEST or t0 == t1 or not state[tb.WORK] > 0.1 * s.work[tb.TOUCHED]:
            return False
        t = middle(g, t0, t1)
        for half in range(2):
            stack[top, 0], stack[top, 1] = (t, t1) if half == 0 else (t0, t)
            stack[top, 2], top = depth + 1.0, top + 1
    return True
