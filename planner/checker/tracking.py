"""What must hold over the whole of some legs: tracking, height of an arch, a hand's tilt, acceleration with a part."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from assur.planner.checker import along
from assur.planner.checker.along import MEET_M, TRACKED_M
from assur.planner.checker.legs import TIME_S
from assur.planner.checker.meeting import MEET_M_S, posed
from assur.planner.checker.targets import Target
from assur.planner.checker.verdict import Code, Finding
from assur.planner.checker.world import World
from assur.planner.model.outcome import TRACKING, Arrival, Leg, LegKind
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Move, Pick, Place, Trace

HALF_RAD = 1e-6
"""rad. Ways that are so near to half a turn are as short one way round as the other: the one that was gone counts."""
YAW_RAD = 1e-9
"""rad. Forbidden ranges of yaw count wider by this at both ends, for rounding of sines and cosines."""
WHAT = ("leaves its line or point", "goes below its point", "goes higher than asked", "is turned", "tilts or rolls")
INSTANTS, ROUNDS = 16, 9
"""Times at which the height of an arch is looked for, and rounds, each between the neighbours of the highest."""
BACK_M, BACK = 1e-4, 0.1
"""m, and share of the height to which an arch rises above its ends: so far the lift may go the wrong way in total. A
motion through ticks of a controller, 4 ms apart, sways by some tenths of a millimetre where the lift turns."""
RISE_M = 1e-6
"""m. So far an arch goes above both of its ends at least, or to the end of the lift's range."""
CUTS = 5
"""How often the pieces of an arch are halved until its ways up and down are known."""


def tracked(world: World, legs: tuple[Leg, ...], found: tuple[Target, ...]) -> list[Finding]:
    """Findings for the tracking legs that leave their point, their line, or do not go as high as asked."""
    findings = []
    for leg in legs:
        if leg.kind not in TRACKING or isinstance(found[leg.step].step, Trace):
            continue  # `paths.following` looks at traces
        target = found[leg.step]
        step, follows, height = target.step, leg.kind is LegKind.FOLLOW, 0.0
        if isinstance(step, Pick | Place) and not follows:
            height = world.scene.straight(step)[leg.kind is LegKind.DEPART]
        tilt, frame = target.tilt or (0.0, 0.0), world.frame[target.frame]
        asked = [(along.FRAME, frame), (along.FOLLOWS, float(follows)), (along.HEIGHT, height)]
        asked += [(along.TURNS, float(target.turns)), (along.PITCH, tilt[0]), (along.ROLL, tilt[1])]
        excess = world.keeps(along.TRACK, asked + posed(target.tool), leg.t0, leg.t1)
        name = f"{leg.kind} of {step.name}"
        if excess is not None:
            unit = "rad" if excess.column >= 3 else "m"
            what = f"the tool {WHAT[excess.column]} in {name}"
            what += "" if excess.decided else " (or could not be shown not to)"
            findings.append(Finding(Code.TRACKING, what, excess.amount, unit, f"{excess.time:.6g} s"))
        if not follows:
            down = leg.kind is LegKind.APPROACH
            outer, stops = (leg.t0, step.approach_stop) if down else (leg.t1, step.depart_stop)
            tool, point = world.states([(world.flange, world.scene.tool.tcp, outer), (frame, target.tool, outer)])
            missing = height - (tool.z - point.z)
            if not missing <= TRACKED_M:
                what = f"{name} is shorter than required"
                findings.append(Finding(Code.TRACKING, what, missing, "m", f"{outer:.6g} s"))
            speed = abs(tool.v[2] - point.v[2])
            if stops and not speed <= MEET_M_S:
                what = f"the tool does not stop at the outer end of {name}"
                findings.append(Finding(Code.TRACKING, what, speed, "m/s", f"{outer:.6g} s"))
    return findings


def arches(world: World, legs: tuple[Leg, ...]) -> list[Finding]:
    """Whether each ARCH goes up and then down, and the tool point rises as high as its step asks: a value that is taken
    proves it."""
    findings = [
        Finding(Code.CLAIM, "a leg that is called ARCH does not go up and then down", where=f"legs[{i}].kind")
        for i, leg in enumerate(legs)
        if leg.kind is LegKind.ARCH and not _goes_over(world, leg)
    ]
    for number, step in enumerate(world.scene.task):
        spans = [leg for leg in legs if leg.step == number and leg.kind is LegKind.ARCH]
        if step.arch is None or not spans:
            continue
        low, high, top, at = spans[0].t0, spans[-1].t1, -math.inf, spans[0].t0
        for _ in range(ROUNDS):
            t = np.linspace(low, high, INSTANTS + 1).tolist()
            z = [state.z for state in world.states([(world.flange, world.scene.tool.tcp, x) for x in t])]
            k = int(np.argmax(z))
            top, at, low, high = z[k], t[k], t[max(0, k - 1)], t[min(INSTANTS, k + 1)]
            if top >= step.arch.top_m:
                break
        missing = step.arch.top_m - top
        if not missing <= MEET_M:
            findings.append(Finding(Code.ARCH, f"the arch to {step.name} is too low", missing, "m", f"{at:.6g} s"))
    return findings


def _goes_over(world: World, leg: Leg) -> bool:
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


def straight(world: World, legs: tuple[Leg, ...], arrivals: tuple[Arrival, ...]) -> list[Finding]:
    """Findings for straight legs on which the hand does not go from its pitch and roll at the beginning to those at the
    end, the short way and both together, by whatever law of time.
    """
    if "pitch" not in world.scene.robot.coordinates:
        return []
    met, findings = {arrival.step: arrival.time for arrival in arrivals}, []
    for number, step in enumerate(world.scene.task):
        # however many legs the way is cut into, and whatever they are called
        own = [leg for leg in legs if leg.step == number and leg.kind is not LegKind.WAIT]
        own = [leg for leg in own if leg.t1 <= met.get(number, -math.inf) + TIME_S]
        if not (isinstance(step, Move) and step.leg == "cartesian" and own):
            continue
        t0, t1 = own[0].t0, own[-1].t1
        begin, halfway, end = ((tool.pitch, tool.roll) for tool in map(world.tool, (t0, (t0 + t1) / 2, t1)))
        asked = []
        for k in range(2):
            way, gone = math.remainder(end[k] - begin[k], math.tau), math.remainder(halfway[k] - begin[k], math.tau)
            if abs(way) > math.pi - HALF_RAD and way * gone < 0:
                way -= math.copysign(math.tau, way)
            asked += [(along.PITCH + k, begin[k]), (along.ROLL + 1 + k, way)]
        excess = world.keeps(along.STRAIGHT, asked, t0, t1)
        if excess is not None:
            what = f"the hand leaves the way between pitch and roll at the ends of the straight leg to {step.name}"
            findings.append(Finding(Code.TRACKING, what, excess.amount, "rad", f"{excess.time:.6g} s"))
    return findings


def pulled(world: World, phases: tuple[Phase, ...]) -> list[Finding]:
    """A finding for each phase in which the tool point accelerates harder than a held part allows."""
    limit, findings = world.scene.carry_acceleration, []
    for phase in phases if limit is not None else ():
        if phase.attached.held is not None and phase.t0 < world.end:
            asked = [(along.HEIGHT, float(limit or 0.0))]
            for t0, t1 in _smooth(world, phase.t0, min(phase.t1, world.end)):
                excess = world.keeps(along.CARRY, asked, t0, t1)
                if excess is not None:
                    what = f"the tool accelerates too hard in {phase.kind}"
                    findings.append(Finding(Code.CARRY, what, excess.amount, "m/s²", f"{excess.time:.6g} s"))
                    break
    return findings


def _smooth(world: World, t0: float, t1: float) -> list[tuple[float, float]]:
    """[t0, t1] in parts in which no acceleration jumps. An interval across a jump would be bounded by one joint's
    acceleration before it together with another's behind it, which never occur at once, however short it is. Of a
    part that ends at a jump the spline's bounds are those before it, and of one that begins there those behind it."""
    time = world.knots.time
    inside = np.unique(time[(time > t0) & (time < t1)]).tolist() if world.knots.jumps else []
    return list(pairwise([t0, *inside, t1]))


def turned_into(world: World) -> list[Finding]:
    """A finding for each forbidden range of yaw that the tool enters from the first knot to the last (V7): joints that
    lag turn it by the sum of their lags at most, and a belt correction does not turn it, for the wrist turns back."""
    scene, findings = world.scene, list[Finding]()
    if not scene.forbidden_yaw:
        return findings  # arms without a wrist among them: they have no fourth joint
    lag = scene.execution.lag
    slack = lag[0] + lag[1] + lag[3] if lag else 0.0  # of a SCARA; of a five-bar the first two do not lag here
    for each in scene.forbidden_yaw:
        half = math.fmod(each.last - each.first, math.tau)
        half = (half if half > 0.0 else half + math.tau) / 2.0
        middle, width = each.first + half, min(half + slack + YAW_RAD, math.pi)
        asked = [(along.PITCH, math.cos(middle)), (along.ROLL, math.sin(middle)), (along.HEIGHT, math.cos(width))]
        excess = world.keeps(along.YAW, asked, world.start, world.end)
        if excess is None:
            continue
        yaw = world.tool(excess.time).yaw
        deep = half + slack - abs(math.remainder(yaw - middle, math.tau))
        ends = f"{math.degrees(each.first):.6g}° to {math.degrees(each.last):.6g}°"
        what = f"the tool turns into the forbidden range of yaw from {ends}"
        what += "" if excess.decided else " (or could not be shown not to)"
        findings.append(Finding(Code.YAW, what, max(deep, 0.0), "rad", f"{excess.time:.6g} s"))
    return findings


def assembled(world: World) -> list[Finding]:
    """A finding if a closed chain is not proved to stay assembled, with the robot's least parallel margin."""
    robot = world.scene.robot
    if robot.parallel_least <= 0.0:
        return []  # no loop: it assembles wherever its joints are
    excess = world.keeps(along.ASSEMBLED, [(along.HEIGHT, robot.parallel_least)], world.start, world.end)
    if excess is None:
        return []
    what = f"{robot.name} leaves its assembly mode, or comes nearer to a type 2 singularity than it may"
    if not excess.decided:
        what = f"{robot.name} is not proved to stay in its assembly mode"
    return [Finding(Code.ASSEMBLY, what, excess.amount, "1", f"{excess.time:.6g} s")]
