"""Does the claim state that joints rest where the task asks, go on at vias, and give the tool its pitch and roll?

Rows of sums bound a sum of shares of the joints, or a derivative of it. Pitch and roll are such sums (H2).
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.statement.arms import hand_shares, states_at
from assur.planner.checker.statement.differences import MEET, SAME, TRACKED_RAD, Difference, Interval, Topic
from assur.planner.checker.statement.holding import Handling
from assur.planner.claim import columns as c
from assur.planner.model.outcome import TRACKING, LegKind

STANDS = 2e-8
"""A joint that stays within this stands, rad or m: the claim checker keeps a tenth of it for rounding."""
STRAIGHT_RAD, HALF_RAD = 1e-4, 1e-6
"""How far pitch and roll may be off the way along a straight leg; ways so near to half a turn may go round either
way."""
BESIDE_S, WAY = 0.01, 1e-9
"""How long before and behind a via its joints are evaluated, s; a joint that goes a shorter way stands, rad or m."""


def sums_of(claim: c.Claim, order: int, shares: FloatArray, when: Interval) -> list[tuple[float, float]]:
    """Bounds that a claim states of a sum of joints, (n,) shares, or of a derivative of it, over all of an interval."""
    rows = claim.sums
    wanted = np.append(shares, np.zeros(c.MOST_JOINTS - len(shares)))
    own = (rows[:, c.SUM_ORDER] == order) & (np.abs(rows[:, c.SUM_SHARE : c.SUM_LOW] - wanted) <= SAME).all(1)
    own &= (rows[:, c.SUM_T0] <= when[0]) & (when[1] <= rows[:, c.SUM_T1])
    return [(low, high) for low, high in rows[own][:, [c.SUM_LOW, c.SUM_HIGH]].tolist()]


def _is_within(stated: list[tuple[float, float]], low: float, high: float) -> bool:
    return any(low - SAME <= x and y <= high + SAME for x, y in stated)


def joints_agree(handling: Handling, claim: c.Claim) -> Iterator[Difference]:
    """Differences of joints that wait, rest, or go on."""
    scene, single = handling.scene, np.eye(len(handling.scene.robot.joints))
    for leg in handling.plan.legs:
        when = (leg.t0, leg.t1)
        if leg.kind is LegKind.WAIT and not all(
            any(high - low <= 2.0 * STANDS for low, high in sums_of(claim, 0, each, when)) for each in single
        ):
            yield Difference(Topic.SUM, "the arm is not stated to stand while it waits", when)
    for number, step in enumerate(scene.task):
        when = (handling.arrivals[number].time,) * 2
        if step.via:
            if step.leg == "joint" and not _is_flown_by(handling, claim, when[0]):
                yield Difference(Topic.SUM, f"the arm may stop at {step.name}, which is to be flown by", when)
        elif step.match == "position" and not all(
            _is_within(sums_of(claim, 1, each, when), -MEET, MEET) for each in single
        ):
            yield Difference(Topic.SUM, f"the arm is not stated to rest at {step.name}", when)


def _is_flown_by(handling: Handling, claim: c.Claim, time: float) -> bool:
    """The arm does not wait at a via; and a joint goes on, or each joint that moves turns round there."""
    path = handling.plan.trajectory
    if any(leg.kind is LegKind.WAIT and abs(leg.t0 - time) <= SAME for leg in handling.plan.legs):
        return False
    for joint in np.eye(path.n):
        for sign in (1.0, -1.0):
            if any(low > MEET for low, _ in sums_of(claim, 1, sign * joint, (time, time))):
                return True
    if not float(path.time[0]) < time < float(path.time[-1]):
        return True
    before, there, behind = (states_at(path, time + off)[0] for off in (-BESIDE_S, 0.0, BESIDE_S))
    ways = there - before, behind - there
    goes_on = (np.minimum(np.abs(ways[0]), np.abs(ways[1])) > WAY) & (ways[0] * ways[1] > 0.0)
    return not goes_on.any()


def hands_agree(handling: Handling, claim: c.Claim) -> Iterator[Difference]:
    """Pitch and roll of the tool: those of the request, or, where it leaves them free, of the arrival."""
    has_hand = "pitch" in handling.scene.robot.coordinates
    for number, step in enumerate(handling.scene.task):
        arrival = handling.arrivals[number]
        angles, when = (arrival.pitch, arrival.roll), (arrival.time, arrival.until)
        if not has_hand:
            if angles != (None, None):
                yield Difference(Topic.ARRIVAL, f"{step.name} is met with a pitch, which the arm has not", when)
            continue
        if step.target is None or arrival.pitch is None or arrival.roll is None:
            yield Difference(Topic.ARRIVAL, f"it is not stated with what pitch and roll {step.name} is met", when)
            continue
        asked = zip((arrival.pitch, arrival.roll), (step.target.pitch, step.target.roll), strict=True)
        if not all(y is None or abs(math.remainder(x - y, math.tau)) <= MEET for x, y in asked):
            yield Difference(Topic.ARRIVAL, f"{step.name} is met with another pitch or roll", when)
        if arrival.missed_by is None and not _is_directed(handling, number, (arrival.pitch, arrival.roll), claim):
            yield Difference(Topic.SUM, f"the tool is not stated to have the pitch and roll of {step.name}", when)
        if step.leg == "cartesian" and not _goes_straight(handling, number, claim):
            what = f"pitch and roll are not stated to go straight on the way to {step.name}"
            yield Difference(Topic.SUM, what, when)


def _is_directed(handling: Handling, number: int, angles: tuple[float, float], claim: c.Claim) -> bool:
    """Pitch and roll are these when the control point is met and while it is tracked, and do not change where its
    velocity is matched."""
    arrival = handling.arrivals[number]
    tracked = [leg for leg in handling.plan.legs if leg.step == number and leg.kind in TRACKING]
    spans = [(MEET, (arrival.time, arrival.time))]
    spans += [(TRACKED_RAD, (tracked[0].t0, tracked[-1].t1))] if tracked else []
    for shares, angle in zip(hand_shares(handling.scene.robot), angles, strict=True):
        for off, when in spans:
            # whatever full turns they differ by
            stated = sums_of(claim, 0, shares, when)
            turns = [math.tau * round(((low + high) / 2.0 - angle) / math.tau) for low, high in stated]
            near = zip(stated, turns, strict=True)
            if not any(_is_within([each], angle + k - off, angle + k + off) for each, k in near):
                return False
        met = (arrival.time, arrival.time)
        if arrival.matched and not _is_within(sums_of(claim, 1, shares, met), -MEET, MEET):
            return False
    return True


def _goes_straight(handling: Handling, number: int, claim: c.Claim) -> bool:
    """Pitch and roll go from those at the begin of a straight leg to those at its end, both by one share, the short way
    round: a row bounds them across that way, and one along it."""
    when, hand = handling.way(number), hand_shares(handling.scene.robot)
    begin, end = (hand @ states_at(handling.plan.trajectory, t)[0] for t in when)
    way, length = end - begin, float(np.hypot(*(end - begin)))
    if not (np.abs(way) <= math.pi + HALF_RAD).all():
        return False
    ahead = way / length if length > HALF_RAD else np.array([1.0, 0.0])
    for direction, far in ((ahead, length), (np.array([-ahead[1], ahead[0]]), 0.0)):
        first = float(direction @ begin)
        stated = sums_of(claim, 0, direction @ hand, when)
        if not _is_within(stated, first - STRAIGHT_RAD, first + far + STRAIGHT_RAD):
            return False
    return True
