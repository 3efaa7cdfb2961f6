"""Whether the tool point is at its control point when the plan says so, with its velocity, and within its window."""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.order import TIME_S
from assur.planner.checker.spline import Spline, State
from assur.planner.checker.targets import Target, asks_passing, asks_rest, asks_velocity, may_turn
from assur.planner.checker.tilt import tilt, tilt_rates, turned_by, wrapped
from assur.planner.checker.verdict import Code, Finding
from assur.planner.frames.motion import Motion, Pose
from assur.planner.model.outcome import Arrival, Leg, LegKind
from assur.planner.model.scene import Scene

MEET_M = 1e-6
"""m. The tool point may be off its control point by this: 1 µm, half of what anyone may find on measuring again; a
planner reaches 1e-9 m, no servo reaches this."""
MEET_RAD = 1e-6
"""rad. The same for yaw."""
MEET_M_S = 1e-6
"""m/s. A matched velocity may be off by this: a fifth of what anyone may find; in 1 s it adds up to 1 µm."""
MEET_RAD_S = 1e-6
"""rad/s. The same for the yaw rate; and for each joint where the arm is asked to stand."""


def tool_motion(scene: Scene, line: Spline, t: FloatArray) -> Motion:
    """Motion of the tool point in the world at times t (T,)."""
    return _tool(scene, line.state(t))


def _tool(scene: Scene, state: State) -> Motion:
    """Motion of the tool point in the world with the joints in states (T, n)."""
    robot = scene.robot
    return robot.link_motion(robot.links.index("flange"), *state).at(scene.tool.tcp)


def meetings(
    scene: Scene, line: Spline, legs: tuple[Leg, ...], arrivals: tuple[Arrival, ...], found: tuple[Target, ...]
) -> list[Finding]:
    """One arrival a step, at the right time, true in what it says, and what the request asks."""
    if [arrival.step for arrival in arrivals] != list(range(len(scene.task))):
        return [Finding(Code.ARRIVAL, "there must be one arrival for each step, in order")]
    findings = []
    for arrival, target in zip(arrivals, found, strict=True):
        name = target.step.name
        times = _times(legs, target.number)
        at = f"{arrival.time:.6g} s"
        off = min((max(abs(arrival.time - a), abs(arrival.until - b)) for a, b in times), default=math.inf)
        if not off <= TIME_S:
            findings.append(Finding(Code.ARRIVAL, f"the arrival at {name} is not when its legs end", off, "s", at))
        if arrival.control_point != name:
            findings.append(Finding(Code.ARRIVAL, f"the arrival at {name} names {arrival.control_point!r:.60}"))
        if not may_turn(scene, target.step, arrival.yaw_offset):
            findings.append(
                Finding(Code.ARRIVAL, f"the tool may not be turned so at {name}", arrival.yaw_offset, "rad")
            )
        findings += _met(scene, line, arrival, target)
    return findings


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


def _met(scene: Scene, line: Spline, arrival: Arrival, target: Target) -> list[Finding]:
    name, step = target.step.name, target.step
    times = np.array([arrival.time, arrival.until])
    state = line.state(times)
    tool, goal = _tool(scene, state), target.motion(scene, times)
    findings = []
    where = f"{arrival.time:.6g} s"
    missed = scene.options.blended and asks_passing(step)  # checker.blends says by how much
    off = 0.0 if missed else float(np.sqrt(((tool.p - goal.p) ** 2).sum(-1)).max())
    if not off <= MEET_M:
        findings.append(Finding(Code.ARRIVAL, f"the tool is not at {name}", off, "m", where))
    off = float(np.abs(wrapped(tool.yaw - goal.yaw)).max()) if target.turns and not missed else 0.0
    if not off <= MEET_RAD:
        findings.append(Finding(Code.ARRIVAL, f"the tool is turned against {name}", off, "rad", where))
    if not missed:
        findings += tilted(scene, state[0], arrival, target)
    if arrival.matched or asks_velocity(step):
        findings += _tilting(scene, state, arrival, target)
    off = _apart(arrival.pose, tool)
    if not off <= MEET_M:
        findings.append(Finding(Code.ARRIVAL, f"the arrival at {name} says another pose", off, "m or rad", where))
    if asks_velocity(step) and not arrival.matched:
        findings.append(Finding(Code.MATCH, f"the velocity of {name} is asked to be matched", where=where))
    if arrival.matched or asks_velocity(step):
        off = float(np.sqrt(((tool.v[0] - goal.v[0]) ** 2).sum()))
        if not off <= MEET_M_S:
            findings.append(Finding(Code.MATCH, f"the tool has not the velocity of {name}", off, "m/s", where))
        off = abs(float(tool.yaw_d[0] - goal.yaw_d[0])) if target.turns else 0.0
        if not off <= MEET_RAD_S:
            findings.append(Finding(Code.MATCH, f"the tool has not the yaw rate of {name}", off, "rad/s", where))
    if asks_rest(step):
        off = float(np.abs(state[1][0]).max())
        if not off <= MEET_RAD_S:
            findings.append(Finding(Code.MATCH, f"the arm does not stand when it meets {name}", off, "1/s", where))
    return findings


def tilted(scene: Scene, q: FloatArray, arrival: Arrival, target: Target) -> list[Finding]:
    """Whether the hand has, in the joint positions q (T, n), the pitch and roll that are asked and that the arrival
    says."""
    name, where = target.step.name, f"{arrival.time:.6g} s"
    if target.tilt is None:
        if arrival.pitch is None and arrival.roll is None:
            return []
        return [Finding(Code.ARRIVAL, f"the arrival at {name} says a pitch or a roll, which the arm has not")]
    if arrival.pitch is None or arrival.roll is None:
        return [Finding(Code.ARRIVAL, f"the arrival at {name} does not say pitch and roll")]
    found, findings = tilt(scene.robot, q), []
    for what, asked in (
        ("is tilted or rolled against", target.tilt),
        ("has not the pitch and roll that are said at", (arrival.pitch, arrival.roll)),
    ):
        amount = float(turned_by(found, np.array(asked)).max())
        if not amount <= MEET_RAD:
            findings.append(Finding(Code.ARRIVAL, f"the tool {what} {name}", amount, "rad", where))
    return findings


def _tilting(scene: Scene, state: State, arrival: Arrival, target: Target) -> list[Finding]:
    """Whether a hand that meets its control point with its velocity keeps its pitch and roll there; `state`: then."""
    if target.tilt is None:
        return []
    q, qd = state[:2]
    fast = float(np.abs(tilt_rates(scene.robot, q, qd)[0]).max())
    if fast <= MEET_RAD_S:
        return []
    what = f"the tool tilts or rolls when it meets {target.step.name}"
    return [Finding(Code.MATCH, what, fast, "rad/s", f"{arrival.time:.6g} s")]


def _apart(pose: Pose, tool: Motion) -> float:
    across = float(np.sqrt(((tool.p[0] - pose.position) ** 2).sum()))
    return max(across, abs(math.remainder(float(tool.yaw[0]) - pose.yaw, 2 * math.pi)))
