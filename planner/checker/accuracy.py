"""Whether the tool can be farther from a control point than an arrival says (equation U4).

All combinations of signs of what a request does not know are looked at: errors of the frame, joints that lag to either
end, and a start that is late by any time. Joints that lag move the tool along a bent way: the arm is looked at with its
joints at the ends of their lag, and in between the way is bent by no more than the second derivative lets it.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import product

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker import motion
from assur.planner.checker.doubts import counted, line_of, stands
from assur.planner.checker.targets import Target
from assur.planner.checker.uncertainty import sway
from assur.planner.checker.verdict import Code, Finding
from assur.planner.checker.world import World
from assur.planner.frames.law import EXACT
from assur.planner.frames.motion import Pose
from assur.planner.model.outcome import Arrival
from assur.planner.model.phases import Handled, Phase
from assur.planner.model.scene import Pick, Place, Trace
from assur.planner.robots.scara import Scara

STEPS = 64
"""Parts of the time by which a start may be late."""
ROUNDING_M, ROUNDING_RAD = 1e-9, 1e-9


def accuracies(
    world: World, arrivals: tuple[Arrival, ...], found: tuple[Target, ...], phases: tuple[Phase, ...]
) -> list[Finding]:
    """A finding for each arrival whose error is larger than it says, or than its step allows."""
    findings: list[Finding] = []
    if world.scene.exact or [arrival.step for arrival in arrivals] != list(range(len(found))):
        return findings  # no error is asked for; or it is not said of which point an arrival is
    for arrival, target in zip(arrivals, found, strict=True):
        handled = next((phase.handled for phase in phases if phase.step == arrival.step), Handled())
        if isinstance(target.step, Trace):
            target = replace(target, point=target.step.end)  # where the tool is when it is done
        shifting = {belt for phase in phases if phase.step == arrival.step for belt in phase.corrected}
        shifting = set() if target.step.tracks else shifting - {target.frame}
        bound, said = _bound(world, arrival, target, handled, shifting), arrival.error
        within = EXACT if said is None else said.within
        stated = (0.0 if said is None else said.position_m, within.position_m, within.vertical_m, within.yaw_rad)
        where, name = f"{arrival.until:.6g} s", target.step.name
        for what, amount, least, unit in zip(
            ("far", "far to the side", "far up or down", "much turned"), stated, bound, ("m", "m", "m", "rad"),
            strict=True,
        ):  # fmt: skip
            rounding = ROUNDING_RAD if unit == "rad" else ROUNDING_M
            if not amount >= least - rounding:
                text = f"the tool may be more {what} off {name} than its arrival says"
                findings.append(Finding(Code.ERROR, text, least - amount, unit, where))
        allowed = target.step.tolerance
        if bound[0] > allowed.position_m + ROUNDING_M or bound[3] > allowed.yaw_rad + ROUNDING_RAD:
            over = max(bound[0] - allowed.position_m, 0.0) or bound[3] - allowed.yaw_rad
            text = f"the tool may be farther off {name} than its tolerance allows"
            findings.append(Finding(Code.ERROR, text, over, "m" if bound[0] > allowed.position_m else "rad", where))
    return findings


def _bound(
    world: World, arrival: Arrival, target: Target, handled: Handled, shifting: set[str]
) -> tuple[float, float, float, float]:
    """No error is larger: distance, horizontal distance, height, m, and yaw, rad. `shifting`: the belts for which a
    correction may have shifted the tool on its way."""
    scene, step, until = world.scene, target.step, arrival.until
    frame, late = scene.frames[target.frame], scene.execution.start_tolerance_s
    known, carrier = frame.uncertainty, world.frame[target.frame]
    (point,), (origin,) = world.states([(carrier, target.point, until)]), world.states([(carrier, Pose(), until)])
    flat, upright, yaw = 0.0, 0.0, known.yaw_rad
    # errors of the frame, each with either sign
    signed = [(0.0, 0.0, known.vertical_m)]
    line, lasts = line_of(frame.law), max(until + late - scene.start.time, 0.0)
    along = known.position_m + known.speed_m_s * lasts
    if scene.execution.belt_correction and step.tracks and counted(frame.law):
        along = 0.0  # an encoder counts the way of a belt
    level = 0.0 if line is None else math.hypot(line[0], line[1])
    if line is None:
        flat += along
    else:
        signed.append((along * line[0], along * line[1], along * line[2]))
    if level > 0.0 and line is not None:
        signed.append((-known.lateral_m * line[1] / level, known.lateral_m * line[0] / level, 0.0))
    else:
        flat += known.lateral_m
    for name in shifting:
        belt, way = scene.frames[name].uncertainty, line_of(scene.frames[name].law) or (0.0, 0.0, 0.0)
        size = belt.position_m + belt.speed_m_s * lasts
        signed.append((size * way[0], size * way[1], size * way[2]))
    ax, ay = point.x - origin.x, point.y - origin.y
    signed.append((-known.yaw_rad * ay, known.yaw_rad * ax, 0.0))
    flat += math.hypot(ax, ay) * known.yaw_rad**2 / 2.0
    # parts
    if isinstance(step, Pick):
        own = handled.of(step.part) or scene.index[step.part].uncertainty
    elif isinstance(step, Place):
        own = handled.of(step.part) or EXACT
    else:
        own = EXACT
    flat, upright, yaw = flat + own.position_m, upright + own.vertical_m, yaw + own.yaw_rad
    gone, bow, turned = _gone(world, target, until)
    lags, bent, lagged = _lagged(world, (point.x, point.y, point.z), until)
    flat, upright, yaw = flat + bow + bent, upright + bow, yaw + turned + lagged
    if scene.robot.tilting:
        upright += bent
    used = [vector for vector in signed if any(vector)]
    sums = np.array([np.sum([sign * np.array(v) for sign, v in zip(signs, used, strict=True)], axis=0) + np.zeros(3)
                     for signs in product((-1.0, 1.0), repeat=len(used))])  # fmt: skip
    off = sums[:, None, None, :] + gone[None, :, None, :] - lags[None, None, :, :]
    side, height = np.hypot(off[..., 0], off[..., 1]) + flat, np.abs(off[..., 2]) + upright
    far = float(np.hypot(side, height).max())
    if isinstance(step, Pick):
        far += yaw * math.hypot(step.grasp.x, step.grasp.y)
    return far, float(side.max()), float(height.max()), yaw


def _gone(world: World, target: Target, until: float) -> tuple[FloatArray, float, float]:
    """How far the point has gone on (K, 3), m, when the robot is late or the frame shifted in time; by how much its way
    is bent between; and by how much it has turned, rad."""
    frame = world.scene.frames[target.frame]
    low, high = frame.uncertainty.shift_s
    first, last = -high, world.scene.execution.start_tolerance_s - low
    if stands(frame.law) or not last > first:
        return np.zeros((1, 3)), 0.0, 0.0
    carrier, times = world.frame[target.frame], np.linspace(first, last, STEPS + 1)
    here, *there = world.states([(carrier, target.point, until + t) for t in (0.0, *times.tolist())])
    jets = motion.all_jets(world.tables) * np.nan
    if not motion.carry(carrier, until + first, until + last, world.tables, jets):
        return np.full((1, 3), np.inf), math.inf, math.inf
    reach = math.sqrt(target.point.x**2 + target.point.y**2 + target.point.z**2)
    step = (last - first) / STEPS
    bow = _second(jets[carrier], reach) * step**2 / 8.0
    rate = float(np.hypot(*np.abs(jets[carrier, 3:5, 2:4]).max(1)))
    turns = max(abs(math.remainder(state.yaw - here.yaw, math.tau)) for state in there)
    turned = turns + rate * step / 2.0 if rate > 0.0 else 0.0
    return np.array([np.subtract(state.p, here.p) for state in there]), bow, turned


def _second(jets: FloatArray, reach: float) -> float:
    """A bound of the second derivative of a point of a carrier that is `reach` from its origin."""
    own = np.abs(jets[:3, 4:6]).max(1)
    axes = np.abs(jets[3:, 4:6]).max(1)
    return float(np.sqrt((own**2).sum()) + reach * np.sqrt((axes**2).sum()))


def _lagged(world: World, point: tuple[float, float, float], until: float) -> tuple[FloatArray, float, float]:
    """How far the tool at a point of the world is moved by joints at the ends of their lag (K, 3), m; by how much more
    in between; and how far it is turned, rad."""
    scene, lag = world.scene, np.array(world.scene.execution.lag)
    if not scene.execution.lags:
        return np.zeros((1, 3)), 0.0, 0.0
    row, q, n = world.tables[0][0], world.joints(until, until)[:, 0], len(lag)
    tilts = bool(scene.robot.tilting)

    def flange(joints: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Position (3,) and rotation (3, 3) of the flange for joints (n,)."""
        still, jets = np.zeros((8, 6)), motion.all_jets(world.tables) * np.nan
        still[:n, 0] = still[:n, 1] = joints
        motion.links(row, still, jets, 0)
        return jets[world.flange, :3, 0], jets[world.flange, 3:, 0].reshape(3, 3).T

    place, axes = flange(q)
    local = np.zeros(3) if tilts else axes.T @ (np.array(point) - place)
    moved, turns = [], [0.0]
    for signs in product((-1.0, 1.0), repeat=n):
        there, turned = flange(q + lag * signs)
        moved.append(there + turned @ local - place - axes @ local)
        turns.append(abs(_turn(axes, turned)))
    jets = motion.all_jets(world.tables) * np.nan
    doubt = (np.zeros((0, 11)), np.zeros((1, 1, 2)), np.zeros((1, 0, 2)), np.append(lag, np.zeros(4)), np.zeros(4))
    if not sway(world.tables, doubt, until, until, jets):
        return np.full((1, 3), np.inf), math.inf, math.inf
    # the flange stays upright: its own axis does not turn (of an arm that tilts the point is the flange's own)
    bent = _second(jets[world.flange], math.hypot(*local[:2].tolist()))
    turn = max(turns)
    if tilts:
        turn = 0.0  # such an arm has no yaw to be asked for
    elif not isinstance(scene.robot, Scara):
        turn = float(np.hypot(*np.abs(jets[world.flange, 3:5, 2:4]).max(1)))
    return np.array(moved), bent, turn


def _turn(before: FloatArray, after: FloatArray) -> float:
    """By how much an upright flange has turned, rad."""
    both = before.T @ after
    return math.atan2(float(both[1, 0]), float(both[0, 0]))
