"""Rows of sums about arrivals and legs: joints that rest or go on, and the pitch and roll of the tool.

Pitch and roll are sums of joints (H2), so that a row states them beyond right angles as well.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.claim import columns as c
from assur.planner.claim.guides import LATER_S
from assur.planner.claim.lifts import NEAR, ONLY, Row, arches_of
from assur.planner.claim.points import MEET_RAD, MEET_RAD_S, TRACKED_RAD
from assur.planner.model.outcome import TRACKING, Arrival, Leg, LegKind, Plan
from assur.planner.model.scene import Scene, Step

STRAIGHT_RAD = 1e-4
"""How far pitch and roll may be off the way between those at both ends of a straight leg."""
GOES_ON = 0.5
"""The share of its rate that a joint is stated to have at least where it does not stop."""
HALF_RAD = 1e-6
"""Ways that are so near to half a turn are as short one way round as the other."""


def sums_of(scene: Scene, plan: Plan) -> list[Row]:
    """Rows about joints at arrivals, in waits, at vias and in arches, and about pitch and roll."""
    found, path = list[Row](), plan.trajectory
    for leg in plan.legs:
        if leg.kind is LegKind.WAIT:
            values = path.evaluate(leg.t0).tolist()
            found += [(leg.t0, leg.t1, 0, *ONLY[j], q - NEAR, q + NEAR) for j, q in enumerate(values)]
    for arrival in plan.arrivals:
        step, t = scene.task[arrival.step], arrival.time
        if step.via and step.leg == "joint":
            rates = path.evaluate(t, 1)
            joint = int(np.abs(rates).argmax())
            sign, least = math.copysign(1.0, rates[joint]), GOES_ON * abs(float(rates[joint]))
            if least > MEET_RAD_S:
                shares = tuple(sign * share for share in ONLY[joint])
                found.append((t, t, 1, *shares, least, c.GREATEST))
        elif step.match == "position" and not step.via:
            found += [(t, t, 1, *ONLY[j], -MEET_RAD_S, MEET_RAD_S) for j in range(path.n)]
    found += arches_of(scene, plan)
    if "pitch" in scene.robot.coordinates:
        rows = scene.robot.chain_rows
        tilts = rows.links[scene.robot.links.index("flange"), [c.LINK_PITCH, c.LINK_ROLL]].astype(int)
        hand = rows.angles[tilts, c.ANGLE_SHARE :]
        for arrival in plan.arrivals:
            step = scene.task[arrival.step]
            legs = [leg for leg in plan.legs if leg.step == arrival.step and leg.kind is not LegKind.WAIT]
            found += _met(plan, legs, arrival, hand) + _along(plan, step, legs, arrival, hand)
    return found


def _met(plan: Plan, legs: list[Leg], arrival: Arrival, hand: FloatArray) -> list[Row]:
    """Pitch and roll when a control point is met, while it is tracked, and that they do not change when its velocity is
    matched."""
    if arrival.pitch is None or arrival.roll is None or arrival.missed_by is not None:
        return []
    found, path = list[Row](), plan.trajectory
    tracked = [leg for leg in legs if leg.kind in TRACKING]
    spans = [(arrival.time, arrival.time, MEET_RAD)]
    spans += [(tracked[0].t0, tracked[-1].t1, TRACKED_RAD)] if tracked else []
    now = hand[:, : path.n] @ path.evaluate(arrival.time)
    for shares, angle, value in zip(hand.tolist(), (arrival.pitch, arrival.roll), now.tolist(), strict=True):
        goal = value - math.remainder(value - angle, math.tau)
        found += [(t0, t1, 0, *shares, goal - off, goal + off) for t0, t1, off in spans]
        if arrival.matched:
            found.append((arrival.time, arrival.time, 1, *shares, -MEET_RAD_S, MEET_RAD_S))
    return found


def _along(plan: Plan, step: Step, legs: list[Leg], arrival: Arrival, hand: FloatArray) -> list[Row]:
    """Along a straight leg or a path pitch and roll go from those at its begin to those at its end: a row across that
    way and one along it."""
    own = [leg for leg in legs if leg.t1 <= arrival.time + LATER_S]
    if not (step.leg == "cartesian" and own):
        return []
    t0, t1 = own[0].t0, own[-1].t1
    begin, end = (hand[:, : plan.trajectory.n] @ plan.trajectory.evaluate(t) for t in (t0, t1))
    way = end - begin
    length = float(np.hypot(*way))
    ahead = way / length if length > HALF_RAD else np.array([1.0, 0.0])
    found = list[Row]()
    for direction, far in ((ahead, length), (np.array([-ahead[1], ahead[0]]), 0.0)):
        first, shares = float(direction @ begin), (direction @ hand).tolist()
        found.append((t0, t1, 0, *shares, first - STRAIGHT_RAD, first + far + STRAIGHT_RAD))
    return found
