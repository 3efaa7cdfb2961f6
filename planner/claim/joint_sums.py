"""Rows of sums about arrivals and legs: joints that rest or go on, and the pitch and roll of the tool.

Pitch and roll are sums of joints (H2), so that a row states them beyond right angles as well.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.claim import columns as c
from assur.planner.claim.lifts import NEAR, ONLY, Row, arches_of
from assur.planner.claim.points import LATER_S, MEET_RAD, MEET_RAD_S, TRACKED_RAD, Rows
from assur.planner.legs.limits import instants, least_margins
from assur.planner.model.claims import Claims
from assur.planner.model.outcome import TRACKING, Arrival, Leg, LegKind, Plan
from assur.planner.model.scene import Move, Scene, Step
from assur.planner.robots.facts import AHEAD, LEFT, Bend
from assur.planner.robots.robot import Robot

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


# How near an arm comes to singular positions, and in which working mode it is: rows of `axes`.
#
# Each function gives rows with what they are called for people.

MARGIN = 1e-3
"""By how much a singularity margin may be missed between the instants at which a planner evaluates it, 1 ms apart; and
by how much a least margin that is stated may be off, either way."""
SIGN = 1e-9
"""By how much a number may have the other sign in a working mode: rounding, where a position is singular."""
ANY = 1e3
"""In place of a bound that does not bind."""
ORIGIN = (0.0, 0.0, 0.0)


def required_postures(scene: Scene, plan: Plan) -> Rows:
    """What a request requires: the working mode of control points that are met, and the margin where the tool is guided
    or matches a velocity."""
    least, kept = scene.options.singularity_margin - MARGIN, set[int]()
    if not least > 0.0 and scene.options.elbow == "auto":
        return []
    found, robot, required = Rows(), scene.robot, _required_mode(scene)
    for arrival, t0, t1 in guided(scene, plan) if least > 0.0 else ():
        mode = int(robot.mode_of(plan.trajectory.evaluate(arrival.time))) if required is None else required
        for bend, sign in _serial(robot, mode) + _couplers(robot):
            found.append((arrival.control_point, _beyond(bend, t0, t1, sign, least)))
        kept.add(arrival.step)
    for arrival in plan.arrivals if required is not None else ():
        # rows of a margin have the signs of the mode, too
        if required is not None and arrival.missed_by is None and arrival.step not in kept:
            found += _in_mode(robot, arrival, required)
    return found


def stated_postures(scene: Scene, plan: Plan, claims: Claims) -> Rows:
    """What an answer states: working modes of arrivals, and the least margins of all of the motion, with an instant at
    which each is reached."""
    found, robot, path = Rows(), scene.robot, plan.trajectory
    for arrival, name in zip(plan.arrivals, claims.modes or (), strict=False):
        mode = robot.modes.index(name) if name in robot.modes else None
        # what a request requires has rows already
        if mode is not None and (mode != _required_mode(scene) or arrival.missed_by is not None):
            found += _in_mode(robot, arrival, mode)
    if claims.singularity is None and claims.parallel is None:
        return found
    serial = _serial(robot, int(robot.mode_of(path.q[0])))
    stated = (("singularity", claims.singularity, serial), ("parallel", claims.parallel, _couplers(robot)))
    for (name, claimed, bends), own in zip(stated, least_margins(robot, path, instants(path)[0]), strict=True):
        if claimed is None or claimed[0] is None:
            continue
        least, reached = claimed[0] - MARGIN, claimed[0] + MARGIN
        if least > 0.0:
            # a number that is never 0 keeps its sign
            found += [(name, _beyond(bend, path.start, path.end, sign, least)) for bend, sign in bends]
        if own is not None and bends:
            t = own[1]
            nearest = min((bend for bend, _ in bends), key=lambda bend: abs(_value(robot, bend, path.evaluate(t))))
            size = reached * (nearest.length or 1.0)
            found.append((name, _row(nearest, t, t, -size, size)))
    return found


def _required_mode(scene: Scene) -> int | None:
    """The number of the working mode that a scene requires (-1: that of no mode); None: it requires none."""
    robot, elbow = scene.robot, scene.options.elbow
    if elbow == "keep":
        return int(robot.mode_of(scene.start.q))
    return None if elbow == "auto" else robot.modes.index(elbow)


def _in_mode(robot: Robot, arrival: Arrival, mode: int) -> Rows:
    """The signs of a working mode when an arrival begins. What never is 0 tells no modes apart."""
    return [
        (arrival.control_point, _beyond(bend, arrival.time, arrival.time, sign, -SIGN))
        for k, (bend, sign) in enumerate(_serial(robot, mode))
        if len({signs[k] for signs in robot.chain.signs}) > 1
    ]


def _serial(robot: Robot, mode: int) -> list[tuple[Bend, int]]:
    """The numbers of an arm from which margins and working modes follow, with their signs in a mode (-1: none)."""
    return [] if mode < 0 else list(zip(robot.chain.bends, robot.chain.signs[mode], strict=True))


def _couplers(robot: Robot) -> list[tuple[Bend, int]]:
    """The same of the angle between both couplers of a loop, whose sign never changes."""
    chain = robot.chain
    if chain.loop is None:
        return []
    first, second = [k for k, link in enumerate(chain.links) if link.coupler >= 0][:2]
    return [(Bend(second, first, LEFT), int(chain.loop.side))]


def _value(robot: Robot, bend: Bend, q: FloatArray) -> float:
    p, r = robot.placements(q[None])
    along: FloatArray = r[0, bend.other] @ np.array(bend.along)
    if bend.length > 0.0:
        return float((p[0, bend.link] - p[0, bend.other]) @ along) / bend.length
    return float(r[0, bend.link] @ np.array(AHEAD) @ along)


def guided(scene: Scene, plan: Plan) -> Iterator[tuple[Arrival, float, float]]:
    """Where an arm must keep its singularity margin: legs that track a point, straight legs, legs along a path, and the
    instant at which the velocity of a moving point is matched."""
    for arrival in plan.arrivals:
        step = scene.task[arrival.step]
        straight = isinstance(step, Move) and step.leg == "cartesian"
        legs = [leg for leg in plan.legs if leg.step == arrival.step]
        if straight:
            legs = [leg for leg in legs if leg.kind is not LegKind.WAIT and leg.t1 <= arrival.time]
        else:
            legs = [leg for leg in legs if leg.kind in TRACKING]
        yield from ((arrival, leg.t0, leg.t1) for leg in legs)
        matches = isinstance(step, Move) and step.match == "velocity" and not step.via
        if not legs and matches and step.target and not scene.frames[step.target.frame].law.is_fixed:
            yield arrival, arrival.time, arrival.time


def _beyond(bend: Bend, t0: float, t1: float, sign: int, least: float) -> tuple[float, ...]:
    """A number has this sign over [t0, t1], and no smaller size than `least`."""
    size = least * (bend.length or 1.0)
    return _row(bend, t0, t1, *((size, ANY) if sign > 0 else (-ANY, -size)))


def _row(bend: Bend, t0: float, t1: float, low: float, high: float) -> tuple[float, ...]:
    on = ORIGIN if bend.length > 0.0 else AHEAD
    return (t0, t1, bend.link, float(bend.length > 0.0), *on, bend.other, *bend.along, low, high)
