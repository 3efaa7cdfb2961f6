"""Whether legs go as their routes say. A course follows from the task, except that an ARCH has to be one: the lift goes
up first, and then down. How many vias a planner chose, and whether it could have met a point sooner, no plan shows."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from assur.planner.checker.legs import TIME_S
from assur.planner.checker.verdict import Code, Finding
from assur.planner.checker.world import World
from assur.planner.model.outcome import TRACKING, Arrival, Course, Leg, LegKind
from assur.planner.model.scene import Move

BACK_M, BACK = 1e-4, 0.1
"""m, and share of the height to which an arch rises above its ends: so far the lift may go the wrong way, all in all. A
motion through ticks of a controller, 4 ms apart, sways by some tenths of a millimetre where the lift turns."""
RISE_M = 1e-6
"""m. So far an arch goes above both of its ends at least, or to the end of the lift's range."""
CUTS = 5
"""How often the pieces of an arch are halved until its ways up and down are known."""


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
    step, limited = world.scene.task[leg.step], world.scene.options.jerk_limited
    if leg.kind in TRACKING:
        return ()
    if leg.kind is LegKind.WAIT:
        return (Course.FOR_BODIES,) if limited else (Course.FOR_BODIES, Course.FOR_POINT)
    if leg.kind is LegKind.ARCH:
        return (Course.ARCH,)
    if leg.t0 >= until - TIME_S:
        return (Course.TO_REST,)
    if not limited:
        return (Course.ROUNDED,)
    if isinstance(step, Move) and step.leg == "cartesian":
        return (Course.PATH,) if step.path else (Course.STRAIGHT,)
    return (Course.DIRECT,)


def _arches(world: World, leg: Leg) -> bool:
    """Whether the lift goes up and then down, up to `BACK_M` and `BACK`, and higher than both ends."""
    lift = world.scene.robot.lift
    if lift is None:
        return False
    time = world.knots.time
    edges = np.unique([leg.t0, *time[(time > leg.t0) & (time < leg.t1)].tolist(), leg.t1])
    heights = [float(world.joints(t, t)[lift, 0]) for t in edges.tolist()]
    top = int(np.argmax(heights))
    most = min(max(heights[0], heights[-1]) + RISE_M, float(world.scene.robot.limits.upper[lift]) - RISE_M)
    if not heights[top] >= most:
        return False
    turn, allowed = float(edges[top]), BACK_M + BACK * (heights[top] - max(heights[0], heights[-1]))
    for _ in range(CUTS):
        back = 0.0
        for a, b in pairwise(edges.tolist()):
            low, high = world.joints(a, b)[lift, 2:4].tolist()
            back += max(-low if b <= turn else high, 0.0) * (b - a)
        if back <= allowed:
            return True
        edges = np.sort(np.append(edges, (edges[1:] + edges[:-1]) / 2.0))
    return False
