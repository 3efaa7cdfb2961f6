"""Does the claim state that joints rest where the task requires it, go on at vias, and give the tool its pitch and
roll?

Rows of sums bound a sum of shares of the joints, or a derivative of it. Pitch and roll are such sums (H2).
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.checker.statement.arms import hand_shares
from assur.planner.checker.statement.differences import MEET, SAME, TRACKED_RAD
from assur.planner.checker.statement.statement import Statement
from assur.planner.checker.verdict import Code
from assur.planner.model.outcome import LegKind

STANDS = 2e-8
"""A joint that stays within this of its value stands, rad or m: the claim checker keeps a tenth of it for rounding."""
STRAIGHT_RAD, HALF_RAD = 1e-4, 1e-6
"""How far pitch and roll may be off the way along a straight leg; ways so near to half a turn may go round either
way."""
BESIDE_S, WAY = 0.01, 1e-9
"""How long before and behind a via its joints are evaluated, s; a joint that goes a shorter way stands, rad or m."""


def require_joints(statement: Statement) -> None:
    """The arm stands while it waits, rests where a step matches the position, and goes on at vias."""
    single = np.eye(len(statement.scene.robot.joints)).tolist()
    for leg in statement.plan.legs:
        if leg.kind is LegKind.WAIT:
            when, values = (leg.t0, leg.t1), statement.state_at(leg.t0)[0].tolist()
            stands = all(
                statement.sum_keeps(0, joint, q - STANDS, q + STANDS, when)
                for joint, q in zip(single, values, strict=True)
            )
            statement.require(stands, Code.JOINTS, "the arm is not stated to stand while it waits", when)
    for number, step in enumerate(statement.scene.task):
        time = statement.arrivals[number].time
        if step.via:
            goes_on = step.leg != "joint" or _is_flown_by(statement, time)
            what = f"the arm may stop at {step.name}, which is to be flown by"
            statement.require(goes_on, Code.JOINTS, what, (time, time))
        elif step.match == "position":
            rests = all(statement.sum_keeps(1, joint, -MEET, MEET, (time, time)) for joint in single)
            what = f"the arm is not stated to rest at {step.name}"
            statement.require(rests, Code.JOINTS, what, (time, time))


def _is_flown_by(statement: Statement, time: float) -> bool:
    """The arm does not wait at a via; and a joint goes on, or each joint that moves turns round there."""
    if any(leg.kind is LegKind.WAIT and abs(leg.t0 - time) <= SAME for leg in statement.plan.legs):
        return False
    least = MEET + 2.0 * SAME  # what is slower may rest
    signed = np.concatenate([sign * np.eye(statement.plan.trajectory.n) for sign in (1.0, -1.0)]).tolist()
    if any(statement.sum_keeps(1, joint, least, math.inf, (time, time)) for joint in signed):
        return True
    if not statement.whole[0] < time < statement.whole[1]:
        return True
    before, there, behind = (statement.state_at(time + off)[0] for off in (-BESIDE_S, 0.0, BESIDE_S))
    ways = there - before, behind - there
    goes_on = (np.minimum(np.abs(ways[0]), np.abs(ways[1])) > WAY) & (ways[0] * ways[1] > 0.0)
    return not goes_on.any()


def require_hands(statement: Statement) -> None:
    """Pitch and roll of the tool: those of the request, or, where it leaves them free, of the arrival."""
    has_hand = "pitch" in statement.scene.robot.coordinates
    for number, step in enumerate(statement.scene.task):
        arrival = statement.arrivals[number]
        angles, when = (arrival.pitch, arrival.roll), (arrival.time, arrival.until)
        if not has_hand:
            what = f"{step.name} is met with a pitch, which the arm has not"
            statement.require(angles == (None, None), Code.ARRIVAL, what, when)
            continue
        if step.target is None or arrival.pitch is None or arrival.roll is None:
            what = f"it is not stated with what pitch and roll {step.name} is met"
            statement.require(False, Code.ARRIVAL, what, when)
            continue
        pairs = zip((arrival.pitch, arrival.roll), (step.target.pitch, step.target.roll), strict=True)
        same = all(y is None or abs(math.remainder(x - y, math.tau)) <= MEET for x, y in pairs)
        statement.require(same, Code.ARRIVAL, f"{step.name} is met with another pitch or roll", when)
        directed = arrival.missed_by is not None or _is_directed(statement, number, (arrival.pitch, arrival.roll))
        what = f"the tool is not stated to have the pitch and roll of {step.name}"
        statement.require(directed, Code.JOINTS, what, when)
        straight = step.leg != "cartesian" or _goes_straight(statement, number)
        what = f"pitch and roll are not stated to go straight on the way to {step.name}"
        statement.require(straight, Code.JOINTS, what, when)


def _is_directed(statement: Statement, number: int, angles: tuple[float, float]) -> bool:
    """Pitch and roll are these when the control point is met and while it is tracked, and do not change where its
    velocity is matched."""
    arrival, tracked = statement.arrivals[number], statement.legs(number, tracked=True)
    met = (arrival.time, arrival.time)
    spans = [(MEET, met)] + ([(TRACKED_RAD, (tracked[0].t0, tracked[-1].t1))] if tracked else [])
    for shares, angle in zip(hand_shares(statement.scene.robot), angles, strict=True):
        # whatever full turns they differ by
        value = float(shares @ statement.state_at(arrival.time)[0])
        goal = angle + math.tau * round((value - angle) / math.tau)
        if not all(statement.sum_keeps(0, shares, goal - off, goal + off, when) for off, when in spans):
            return False
        if arrival.matched and not statement.sum_keeps(1, shares, -MEET, MEET, met):
            return False
    return True


def _goes_straight(statement: Statement, number: int) -> bool:
    """Pitch and roll go from those at the begin of a straight leg to those at its end, both by one share, the short way
    round: a row bounds them across that way, and one along it."""
    when, hand = statement.way(number), hand_shares(statement.scene.robot)
    begin, end = (hand @ statement.state_at(t)[0] for t in when)
    way, length = end - begin, float(np.hypot(*(end - begin)))
    if not (np.abs(way) <= math.pi + HALF_RAD).all():
        return False
    ahead = way / length if length > HALF_RAD else np.array([1.0, 0.0])
    across = np.array([-ahead[1], ahead[0]])
    return all(
        statement.sum_keeps(
            0, direction @ hand, direction @ begin - STRAIGHT_RAD, direction @ begin + far + STRAIGHT_RAD, when
        )
        for direction, far in ((ahead, length), (across, 0.0))
    )
