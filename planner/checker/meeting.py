"""Whether the tool point is at its control point when the plan says so, with its velocity, and within its window."""

from __future__ import annotations

import math
from collections.abc import Sequence

from assur.planner.checker import along
from assur.planner.checker.along import MEET_M
from assur.planner.checker.legs import TIME_S
from assur.planner.checker.targets import TURN, Target, asks_passing, asks_rest, asks_velocity, may_turn
from assur.planner.checker.verdict import Code, Finding
from assur.planner.checker.world import World
from assur.planner.laws import Law
from assur.planner.model.outcome import Arrival, Leg, LegKind
from assur.planner.model.scene import Trace

MEET_RAD = 1e-6
"""rad. As `MEET_M` (1 µm: a planner reaches 1e-9 m, no servo reaches this), for yaw, and for pitch and roll."""
MEET_M_S = 1e-6
"""m/s. A matched velocity may be off by this: a fifth of what anyone may find; in 1 s it adds up to 1 µm."""
MEET_RAD_S = 1e-6
"""rad/s. The same for rates of yaw, pitch and roll; and for each joint where the arm is asked to stand."""


def meetings(
    world: World, legs: tuple[Leg, ...], arrivals: tuple[Arrival, ...], found: tuple[Target, ...]
) -> list[Finding]:
    """One arrival a step, at the right time, true in what it says, and what the request asks."""
    if [arrival.step for arrival in arrivals] != list(range(len(found))):
        return [Finding(Code.ARRIVAL, "there must be one arrival for each step, in order")]
    findings, before = list[Finding](), world.start
    for arrival, target in zip(arrivals, found, strict=True):
        findings += _kept(world, before, arrival, target)
        before = max((leg.t1 for leg in legs if leg.step == target.number), default=arrival.until)
        name = target.step.name
        at = f"{arrival.time:.6g} s"
        times = _times(legs, target.number)
        off = min((max(abs(arrival.time - a), abs(arrival.until - b)) for a, b in times), default=math.inf)
        if not off <= TIME_S:
            findings.append(Finding(Code.ARRIVAL, f"the arrival at {name} is not when its legs end", off, "s", at))
        if arrival.control_point != name:
            findings.append(Finding(Code.ARRIVAL, f"the arrival at {name} names {arrival.control_point!r:.60}"))
        turned = 0.0 if target.turns else arrival.yaw_offset  # where no yaw is asked for there is none to offset
        if not may_turn(world.scene, target.step, arrival.yaw_offset) or not abs(turned) <= TURN:
            what = f"the tool may not be turned so at {name}"
            findings.append(Finding(Code.ARRIVAL, what, arrival.yaw_offset, "rad"))
        findings += _met(world, arrival, target) + _in_window(world, arrival, target)
    return findings


def _kept(world: World, before: float, arrival: Arrival, target: Target) -> list[Finding]:
    """Whether the tool has the yaw that it had at `before`, s, where that is to be kept."""
    goal = target.step.target
    if goal is None or not goal.yaw_keep:
        return []
    turned = abs(math.remainder(world.tool(arrival.time).yaw - world.tool(before).yaw, math.tau))
    if turned <= MEET_RAD:
        return []
    what = f"the tool has not kept its yaw when it meets {target.step.name}"
    return [Finding(Code.ARRIVAL, what, turned, "rad", f"{arrival.time:.6g} s")]


def _times(legs: tuple[Leg, ...], number: int) -> list[tuple[float, float]]:
    """When the control point of a step may be met, and until when: its FOLLOW, or else the end of its way.

    After the last way of the task there may be one more, to come to rest.
    """
    own = [leg for leg in legs if leg.step == number]
    follows = [(leg.t0, leg.t1) for leg in own if leg.kind is LegKind.FOLLOW]
    if follows or not own:
        return follows
    ways = [leg for leg in own if leg.kind is not LegKind.WAIT]
    last = ways[-2:] if own[-1] is legs[-1] and ways[-1].kind is LegKind.MOVE else ways[-1:]
    return [(leg.t1, leg.t1) for leg in last]


def _met(world: World, arrival: Arrival, target: Target) -> list[Finding]:
    """At both ends of a dwell the tool is at its control point; at its begin it has what velocity is required."""
    step, findings = target.step, []
    where = f"{arrival.time:.6g} s"

    def hold(code: Code, off: float, allowed: float, unit: str, what: str) -> None:
        if not off <= allowed:
            findings.append(Finding(code, what, off, unit, where))

    frame, tcp = world.frame[target.frame], world.scene.tool.tcp
    tool, goal, left, behind = world.states(
        [(c, pose, t) for t in (arrival.time, arrival.until) for c, pose in ((world.flange, tcp), (frame, target.tool))]
    )
    # checker.passed says by how much vias are missed, paths.following what a trace does
    if not (isinstance(step, Trace) or (world.scene.options.vias_missed and asks_passing(step))):
        hands = ((tool.pitch, tool.roll), (left.pitch, left.roll))
        findings += tilted(hands if target.tilt is not None else (), arrival, target)
        for here, there in ((tool, goal), (left, behind)):
            hold(Code.ARRIVAL, math.dist(here.p, there.p), MEET_M, "m", f"the tool is not at {step.name}")
            turned = abs(math.remainder(here.yaw - there.yaw, math.tau)) if target.turns else 0.0
            hold(Code.ARRIVAL, turned, MEET_RAD, "rad", f"the tool is turned against {step.name}")
    said = arrival.pose
    off = max(math.dist(tool.p, (said.x, said.y, said.z)), abs(math.remainder(tool.yaw - said.yaw, math.tau)))
    hold(Code.ARRIVAL, off, MEET_M, "m or rad", f"the arrival at {step.name} says another pose")
    if isinstance(step, Trace):
        return findings
    if asks_velocity(step) and not arrival.matched:
        findings.append(Finding(Code.MATCH, f"the velocity of {step.name} is asked to be matched", where=where))
    if arrival.matched or asks_velocity(step):
        hold(Code.MATCH, math.dist(tool.v, goal.v), MEET_M_S, "m/s", f"the tool has not the velocity of {step.name}")
        spin = abs(tool.yaw_d - goal.yaw_d) if target.turns else 0.0
        hold(Code.MATCH, spin, MEET_RAD_S, "rad/s", f"the tool has not the yaw rate of {step.name}")
        if target.tilt is not None:
            fast = max(abs(tool.pitch_d), abs(tool.roll_d))
            hold(Code.MATCH, fast, MEET_RAD_S, "rad/s", f"the tool tilts or rolls when it meets {step.name}")
    if asks_rest(step):
        hold(Code.MATCH, tool.fastest, MEET_RAD_S, "1/s", f"the arm does not stand when it meets {step.name}")
    return findings


def tilted(found: Sequence[tuple[float, float]], arrival: Arrival, target: Target) -> list[Finding]:
    """Whether the hand, with each pitch and roll of `found`, has those that are asked and that the arrival says."""
    name, where = target.step.name, f"{arrival.time:.6g} s"
    if target.tilt is None:
        if arrival.pitch is None and arrival.roll is None:
            return []
        return [Finding(Code.ARRIVAL, f"the arrival at {name} says a pitch or a roll, which the arm has not")]
    if arrival.pitch is None or arrival.roll is None:
        return [Finding(Code.ARRIVAL, f"the arrival at {name} does not say pitch and roll")]
    findings = []
    for what, asked in (
        ("is tilted or rolled against", target.tilt),
        ("has not the pitch and roll that are said at", (arrival.pitch, arrival.roll)),
    ):
        off = [abs(math.remainder(tilt[k] - asked[k], math.tau)) for tilt in found for k in range(2)]
        if not all(amount <= MEET_RAD for amount in off):
            findings.append(Finding(Code.ARRIVAL, f"the tool {what} {name}", max(off), "rad", where))
    return findings


def _in_window(world: World, arrival: Arrival, target: Target) -> list[Finding]:
    """Within the window over the whole of the dwell, in time, and in metres along a conveyor: from the pose that was
    given for it (its place at its `at_time`), in the direction of travel."""
    window, name, law = target.step.window, target.step.name, world.scene.frames[target.frame].law
    findings = []
    if window.time is not None:
        over = max(window.time[0] - arrival.time, arrival.until - window.time[1])
        if not over <= TIME_S:
            what = f"{name} is met outside its window"
            findings.append(Finding(Code.WINDOW, what, over, "s", f"{arrival.time:.6g} s"))
    way = measured(law)
    if way is None:
        if arrival.along_m is not None:
            findings.append(Finding(Code.ARRIVAL, f"{name} is said to be along a conveyor, and is on none"))
        if window.along is not None:
            findings.append(Finding(Code.WINDOW, f"{name} has a window in metres, and is not on a conveyor"))
        return findings
    (u, zero), frame = way, world.frame[target.frame]
    if arrival.along_m is not None:
        (point,) = world.states([(frame, target.point, arrival.time)])
        off = abs(arrival.along_m + zero - _along(point.p, u))
        if not off <= MEET_M:
            findings.append(Finding(Code.ARRIVAL, f"{name} is not that far along its conveyor", off, "m"))
    if window.along is not None:
        low, high = window.along
        asked = [(along.FRAME, frame), (along.FOLLOWS, zero + low), (along.HEIGHT, zero + high)]
        asked += [(along.TCP + k, u[k]) for k in range(3)] + posed(target.point)
        excess = world.keeps(along.ALONG, asked, arrival.time, arrival.until)
        if excess is not None:
            where, amount = f"{excess.time:.6g} s", excess.amount + MEET_M
            findings.append(Finding(Code.WINDOW, f"{name} is outside its window", amount, "m", where))
    return findings


def measured(law: Law) -> tuple[tuple[float, ...], float] | None:
    """The direction of travel (3,) in the world along which a conveyor is measured, and where its pose is along it, m;
    None: it is none."""
    if law.kind not in ("conveyor", "linear"):
        return None
    yaw = law.numbers.pose.yaw
    way = (math.cos(yaw), math.sin(yaw), 0.0) if law.kind == "conveyor" else law.numbers.velocity
    length = math.hypot(*way)
    u = tuple(share / length for share in way) if length > 0.0 else (1.0, 0.0, 0.0)
    return u, _along(law.numbers.pose.position.tolist(), u)


def posed(pose: object) -> list[tuple[int, float]]:
    """The columns of a pose in a frame that the tool takes."""
    return [(along.POINT + k, getattr(pose, name)) for k, name in enumerate(("x", "y", "z", "yaw"))]


def _along(point: Sequence[float], u: Sequence[float]) -> float:
    return sum(one * other for one, other in zip(point, u, strict=True))
