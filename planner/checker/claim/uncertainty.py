"""How much nearer what is uncertain may bring two bodies (N8): displaced frames, lagging joints, belt corrections."""

from __future__ import annotations

import math

from assur.planner.arrays import FloatArray
from assur.planner.checker.claim import tables as tb
from assur.planner.checker.claim.chain import chain
from assur.planner.checker.claim.jets import turned
from assur.planner.checker.claim.motion import joints_over, rounding
from assur.planner.checker.claim.solids import derivative_bound
from assur.planner.checker.claim.tables import F1, f8, i8
from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from assur.planner.compiled import kernel, types


@kernel(types.UniTuple(f8, 3)(tb.CLAIM, f8, tb.SCRATCH))
def correction_turns(k: Claim, shift: float, s: tb.Scratch) -> tuple[float, float, float]:
    """By how much the two upright links that carry the tool of the robot turn if the tool is shifted by up to `shift`
    (m, N10): the length of the first, m, and the greatest turn of both, rad, for `s.joints` with their lag.
    Infinite: the arm may be stretched or folded, or the tool is not carried by two such links."""
    none, tool, required = (math.inf, math.inf, math.inf), int(k.required[0, c.REQUIRED_TOOL]), k.required[0]
    if tool < 3 or int(k.arms[0, c.ARM_JOINTS]) != 4 or int(k.arms[0, c.ARM_LINKS]) <= tool:
        return none
    first, second, last = k.links[1], k.links[2], k.links[tool]
    plain = first[c.LINK_PARENT] == 0.0 and second[c.LINK_PARENT] == 1.0 and last[c.LINK_PARENT] == 2.0
    for link in (first, second):
        plain = plain and link[c.LINK_PITCH] < 0.0 and link[c.LINK_COUPLER] < 0.0
    one, other = k.angles[int(first[c.LINK_YAW])], k.angles[int(second[c.LINK_YAW])]
    for j in range(c.MOST_JOINTS):
        plain = plain and one[c.ANGLE_SHARE + j] == (1.0 if j < 1 else 0.0)
        plain = plain and other[c.ANGLE_SHARE + j] == (1.0 if j < 2 else 0.0)
    a, b = second[c.LINK_OFFSET], last[c.LINK_OFFSET]
    for link in (second, last):
        plain = plain and link[c.LINK_OFFSET + 1] == 0.0
        plain = plain and (link[c.LINK_SLIDE] < 0.0 or (link[c.LINK_AXIS] == 0.0 and link[c.LINK_AXIS + 1] == 0.0))
    if not (plain and a > 0.0 and b > 0.0):
        return none
    # the angle between both links is the difference of their yaws, whose constants may differ
    constant, lag = other[c.ANGLE_CONSTANT] - one[c.ANGLE_CONSTANT], required[c.REQUIRED_LAG + 1]
    elbow = turned((s.joints[1, 0] + constant, s.joints[1, 1] + lag, 0.0, 0.0, 0.0, 0.0))[0]
    low, high = a * a + b * b + 2.0 * a * b * (elbow[0] - elbow[1]), a * a + b * b + 2.0 * a * b * (elbow[0] + elbow[1])
    near, far, square = (
        math.sqrt(max(low, 0.0)) - shift - tb.SLACK,
        math.sqrt(max(high, 0.0)) + shift + tb.SLACK,
        math.inf,
    )
    if not (near > abs(a - b) and far < a + b):
        return none
    for radius in (near, far):
        cosine = (radius * radius - a * a - b * b) / (2.0 * a * b)
        square = min(square, 1.0 - cosine * cosine)
    if not square > tb.SLACK:
        return none
    sine = math.sqrt(square)
    return a, shift / (a * sine), shift / (b * sine)


@kernel(f8(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, i8, f8, f8))
def lag_displacement(
    k: Claim, g: tb.Geometry, s: tb.Scratch, about: FloatArray, side: int, t0: float, t1: float
) -> float:
    """By how much lagging joints may bring one side of a row nearer along its normal over [t0, t1], m: the sum of lags
    times the rates of its points at a rate of one of that joint alone, for all joint values within their lag. These
    jets are in the slots behind those of instants and intervals. Infinite: they are not known."""
    first, n, total = tb.INSTANTS + tb.INTERVALS, int(k.arms[0, c.ARM_JOINTS]), 0.0
    solid, on, known = int(about[side + tb.SIDE_SOLID]), int(about[side + tb.SIDE_CARRIER]), s.known[first, 0]
    x, y, z = about[tb.OBJECT_NORMAL], about[tb.OBJECT_NORMAL + 1], about[tb.OBJECT_NORMAL + 2]
    if not (known[0] == t0 and known[1] == t1):
        known[0], known[1], known[2] = t0, t1, tb.KNOWN if joints_over(g, 0, n, t0, t1, s) else tb.NOT_GIVEN
        for j in range(n):
            s.joints[j, 1] += k.required[0, c.REQUIRED_LAG + j]
            s.joints[j, 2:] = 0.0
        for j in range(n):
            if known[2] == tb.KNOWN and k.required[0, c.REQUIRED_LAG + j] > 0.0:
                s.joints[j, 2] = 1.0
                known[2] = tb.KNOWN if chain(k, g, 0, s.jets[first + j], s) else tb.TOO_WIDE
                s.joints[j, 2] = 0.0
    for j in range(n):
        lag = k.required[0, c.REQUIRED_LAG + j]
        if lag > 0.0 and known[2] == tb.KNOWN:
            one = derivative_bound(g, s.jets, first + j, 1, solid, on, x, y, z)
            other = derivative_bound(g, s.jets, first + j, 1, solid, on, -x, -y, -z)
            total += lag * max(one, other, 0.0)
    return float(total) if known[2] == tb.KNOWN else math.inf


@kernel(f8(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, F1, f8, f8))
def required_gap(
    k: Claim, g: tb.Geometry, s: tb.Scratch, about: FloatArray, pair: FloatArray, t0: float, t1: float
) -> float:
    """The gap along a unit normal that is required over [t0, t1], m, with what is uncertain of both bodies (N8) and
    what their places round by. Infinite: it is not known."""
    x, y, z, p = (
        about[tb.OBJECT_NORMAL],
        about[tb.OBJECT_NORMAL + 1],
        about[tb.OBJECT_NORMAL + 2],
        int(pair[tb.PAIR_PHASE]),
    )
    required, flat, total, n = (
        k.required[0],
        math.sqrt(x * x + y * y),
        pair[tb.PAIR_DISTANCE],
        int(k.arms[0, c.ARM_JOINTS]),
    )
    frames, bodies, shift, lags = len(k.frames), len(k.bodies), 0.0, False
    lasts = max(t1 + required[c.REQUIRED_LATE] - required[c.REQUIRED_SINCE], 0.0)
    one, other = k.seats[int(about[tb.SIDE_SEAT])], k.seats[int(about[tb.SIDES + tb.SIDE_SEAT])]
    tool, other_tool = one[c.SEAT_LINK] >= required[c.REQUIRED_TOOL], other[c.SEAT_LINK] >= required[c.REQUIRED_TOOL]
    for i in range(len(k.displaced) if not (tool and other_tool) else 0):
        own, f, low, high = k.displaced[i], int(k.displaced[i, c.DISPLACED_FRAME]), 0.0, 0.0
        if own[c.DISPLACED_SHARED] > 0.0:
            low, high = k.shares[p, f], k.shares[p, frames + f]
        amount = own[c.DISPLACED_AMOUNT] + own[c.DISPLACED_GROWTH] * lasts
        shift += max(abs(low), abs(high)) * amount
        least, most = (1.0, 1.0) if int(one[c.SEAT_FRAME]) == f else (low, high) if tool else (0.0, 0.0)
        other_least, other_most = (
            (1.0, 1.0) if int(other[c.SEAT_FRAME]) == f else (low, high) if other_tool else (0.0, 0.0)
        )
        share = max(abs(most - other_least), abs(other_most - least))
        if share > 0.0:
            d = c.DISPLACED_DIRECTION
            along = flat if own[c.DISPLACED_LEVEL] > 0.0 else abs(x * own[d] + y * own[d + 1] + z * own[d + 2])
            total += share * amount * along
    for j in range(n):
        lags = lags or required[c.REQUIRED_LAG + j] > 0.0
    for side in (0, tb.SIDES):
        solid, seat = int(about[side + tb.SIDE_SOLID]), k.seats[int(about[side + tb.SIDE_SEAT])]
        body, f, link = int(seat[c.SEAT_BODY]), int(seat[c.SEAT_FRAME]), int(seat[c.SEAT_LINK])
        reach = g.solids[solid, tb.SOLID_REACH]
        total += rounding(g, int(about[side + tb.SIDE_CARRIER]), 0, g.solids[solid, tb.SOLID_SIZE])
        total += k.frames[f, c.FRAME_YAW] * reach * flat if f >= 0 else 0.0
        total += k.off[p, body] * flat + k.off[p, bodies + body] * abs(z)
        if link >= 0 and lags:
            total += lag_displacement(k, g, s, about, side, t0, t1)
        if shift > 0.0 and 0 < link < int(required[c.REQUIRED_TOOL]):
            if link > 2 or not joints_over(g, 0, n, t0, t1, s):
                return math.inf
            inner, first, second = correction_turns(k, shift, s)
            total += flat * (reach * first if link == 1 else inner * first + reach * second)
    return float(total)
