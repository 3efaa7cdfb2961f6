"""Whether legs go as their routes say. A course follows from the task, except that an ARCH has to be one: the lift goes
up first, and then down. How many vias a planner chose, and whether it could have met a point sooner, no plan shows."""

from __future__ import annotations

from itertools import pairwise

from assur.planner.checker.legs import TIME_S
from assur.planner.checker.verdict import Code, Finding
from assur.planner.checker.world import World
from assur.planner.model.outcome import TRACKING, Arrival, Course, Leg, LegKind
from assur.planner.model.scene import Move

BACK_M_S = 1e-4
"""m/s. So fast the lift may go the wrong way in an arch: 10 µm in a tenth of a second."""
RISE_M = 1e-6
"""m. So far an arch goes above both of its ends at least, or to the end of the lift's range."""
FINEST_S = 1e-4
"""Intervals of an arch are halved no further, s: then the lift goes the wrong way there, or might."""


def routes(world: World, legs: tuple[Leg, ...], arrivals: tuple[Arrival, ...]) -> list[Finding]:
    """Findings about the routes of legs, none of which has to be said."""
    until = {arrival.step: arrival.until for arrival in arrivals}
    waited = [False, *(before.kind is LegKind.WAIT and before.step == leg.step for before, leg in pairwise(legs))]
    findings = list[Finding]()
    for i, (leg, after_wait) in enumerate(zip(legs, waited, strict=True)):
        if leg.kind is LegKind.ARCH and not _arches(world, leg):
            what = "a leg that is called ARCH does not go up and then down"
            findings.append(Finding(Code.CLAIM, what, where=f"legs[{i}].kind"))
        if leg.route is None:
            continue
        possible = _courses(world, leg, until.get(leg.step, world.end))
        if leg.route.course not in possible:
            told = " or ".join(map(repr, map(str, possible))) or "none, as it tracks its point"
            what = f"the course of a {leg.kind} is said to be {str(leg.route.course)!r}, and is {told}"
            findings.append(Finding(Code.CLAIM, what, where=f"legs[{i}].route.course"))
        if leg.route.after_wait is not after_wait:
            what = f"a {leg.kind} begins {'' if after_wait else 'not '}after a wait, and it is said otherwise"
            findings.append(Finding(Code.CLAIM, what, where=f"legs[{i}].route.after_wait"))
    return findings


def _courses(world: World, leg: Leg, until: float) -> tuple[Course, ...]:
    """The courses that a leg may have; `until`: when its step is done, s."""
    step, blended = world.scene.task[leg.step], world.scene.options.blended
    if leg.kind in TRACKING:
        return ()
    if leg.kind is LegKind.WAIT:
        return (Course.FOR_BODIES, Course.FOR_POINT) if blended else (Course.FOR_BODIES,)
    if leg.kind is LegKind.ARCH:
        return (Course.ARCH,)
    if leg.t0 >= until - TIME_S:
        return (Course.TO_REST,)
    if blended:
        return (Course.BLENDS,)
    if isinstance(step, Move) and step.leg == "cartesian":
        return (Course.PATH,) if step.path else (Course.STRAIGHT,)
    return (Course.DIRECT,)


def _arches(world: World, leg: Leg) -> bool:
    """Whether the lift goes up until some instant and then down, up to `BACK_M_S`, and higher than both ends."""
    lift = world.scene.robot.lift
    if lift is None:
        return False
    time = world.knots.time
    inside = time[(time > leg.t0) & (time < leg.t1)].tolist()
    begin, *tops, end = (world.joints(t, t)[lift, 0] for t in (leg.t0, *inside, leg.t1))
    most = min(max(begin, end) + RISE_M, float(world.scene.robot.limits.upper[lift]) - RISE_M)
    if not max(tops, default=begin) >= most:
        return False
    falls, stack = False, [(leg.t0, leg.t1)]
    while stack:
        a, b = stack.pop()
        low, high = world.joints(a, b)[lift, 2:4].tolist()
        if low >= -BACK_M_S and not (falls and high > BACK_M_S):
            continue  # it goes up, or stands
        if high <= BACK_M_S:
            falls = True
            continue
        if not b - a > FINEST_S:
            # up and down within: the turn, if it has not turned yet and goes up at the beginning
            if falls or world.joints(a, a)[lift, 2] < -BACK_M_S:
                return False
            falls = True
            continue
        middle = (a + b) / 2.0
        stack += [(middle, b), (a, middle)]
    return True
