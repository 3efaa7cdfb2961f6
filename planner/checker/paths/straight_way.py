"""Whether a straight leg is straight: the tool point goes along the line from where it is left to where it is met.

Both ends of that line may move: A(t) is where the tool would be, had it stayed in the frame that it leaves, B(t) where
the control point is. At instants t_k the share s_k of the way from A to B is looked for that is nearest to the tool w.
Between two of them, h apart, let s go evenly. Then r = w - (1 - s) A - s B leaves its chord by what its second
derivative allows:

    |r| <= max(|r_k|, |r_k+1|) + (|ẅ| + max(|Ä|, |B̈|) + 2 |Δs| |Ḃ - Ȧ| / h) h²/8                          (V8)

with bounds of the accelerations from jets. With s_0 = 0, the last s being 1, and no s smaller than the one before, this
shows both: the tool nowhere leaves the line, and nothing of the line is left out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker import along, motion
from assur.planner.checker.along import TRACKED_M
from assur.planner.checker.legs import TIME_S
from assur.planner.checker.targets import Target
from assur.planner.checker.verdict import Code, Finding
from assur.planner.checker.world import REST, World
from assur.planner.frames.motion import Pose
from assur.planner.model.outcome import Arrival, Leg, LegKind
from assur.planner.model.scene import WORLD, Move

STEP_S, DOUBLINGS = 1e-3, 7
"""Length of the first intervals, s; how often they are halved."""
SHORT_M = 1e-9
"""m. Of so short a line no share is looked for."""


@dataclass(frozen=True, slots=True)
class End:
    """One end of the line: a point at `pose` in a carrier, which may stand still."""

    carrier: int
    pose: Pose
    stands: bool


def straight_ways(
    world: World, legs: tuple[Leg, ...], arrivals: tuple[Arrival, ...], found: tuple[Target, ...]
) -> list[Finding]:
    """Findings about the legs that are to be straight, however many they are cut into, and whatever they are called."""
    met, findings = {arrival.step: arrival.time for arrival in arrivals}, list[Finding]()
    for target in found:
        step = target.step
        if not isinstance(step, Move) or step.leg != "cartesian" or step.path:
            continue  # `along_path` looks at paths
        own = [leg for leg in legs if leg.step == target.number and leg.kind is not LegKind.WAIT]
        own = [leg for leg in own if leg.t1 <= met.get(target.number, -math.inf) + TIME_S]
        if not own:
            findings.append(Finding(Code.LEGS, f"there is no straight leg to {step.name}"))
            continue
        t0, t1 = own[0].t0, own[-1].t1
        left = _left(world, found, target, t0)
        if left is None:
            what = f"the straight leg to {step.name} begins in motion, and not in a frame"
            findings.append(Finding(Code.TRACKING, what, where=f"{t0:.6g} s"))
            continue
        goal = End(world.frame[target.frame], target.tool, _stands(world, target.frame))
        findings += _straight(world, step.name, (left, goal), t0, t1)
    return findings


def _stands(world: World, frame: str) -> bool:
    return world.scene.frames[frame].law.kind == "fixed"


def _left(world: World, found: tuple[Target, ...], target: Target, t0: float) -> End | None:
    """Where the line begins: a place in the world where the arm rests; else in the frame of the point before. None:
    there is no such frame."""
    tool = world.tool(t0)
    if tool.fastest <= REST:
        return End(world.frame[WORLD], Pose(*tool.p), True)
    if target.number == 0:
        return None
    frame = found[target.number - 1].frame
    (at,) = world.states([(world.frame[frame], Pose(), t0)])
    if not all(math.isfinite(x) for x in (*at.p, at.yaw)):
        return None
    return End(world.frame[frame], Pose(*at.p, at.yaw).inverse().then(Pose(*tool.p)), _stands(world, frame))


def _straight(world: World, name: str, ends: tuple[End, End], t0: float, t1: float) -> list[Finding]:
    most, when = math.inf, t0
    for doubling in range(DOUBLINGS):
        t = np.linspace(t0, t1, math.ceil((t1 - t0) / STEP_S * 2**doubling) + 1)
        h = (t1 - t0) / (len(t) - 1)
        seen = world.relative(world.frame[WORLD], np.stack([t, np.append(t[1:], t[-1])], 1))
        w = seen[:, along.PLACE : along.PLACE + 3]
        (a, a_rate, a_bend), (b, b_rate, b_bend) = (_moved(world, end, t) for end in ends)
        gap = b - a
        square = (gap**2).sum(1)
        s = np.where(square > SHORT_M**2, ((w - a) * gap).sum(1) / np.maximum(square, SHORT_M**2), 0.0)
        s = np.maximum.accumulate(np.clip(np.where(np.isnan(s), 0.0, s), 0.0, 1.0))
        s[0], s[-1] = 0.0, 1.0
        off = np.sqrt(((w - a - s[:, None] * gap) ** 2).sum(1))
        apart = np.sqrt(((b_rate - a_rate)[:-1] ** 2).sum(1)) + (a_bend + b_bend) * h
        pull = seen[:-1, along.BEND] + np.maximum(a_bend, b_bend) + 2.0 * np.diff(s) * apart / h
        bound = np.maximum(off[:-1], off[1:]) + pull * h**2 / 8.0
        row = int(np.argmax(np.where(np.isnan(bound), np.inf, bound)))
        most, when = float(bound[row]), float(t[row])
        if most <= TRACKED_M:
            return []
        if not off.max() <= TRACKED_M:
            row = int(np.argmax(np.where(np.isnan(off), np.inf, off)))
            what = f"the tool leaves the straight line to {name}"
            return [Finding(Code.TRACKING, what, float(off[row]) - TRACKED_M, "m", f"{t[row]:.6g} s")]
    what = f"the tool could not be shown to keep to the straight line to {name}"
    return [Finding(Code.TRACKING, what, most - TRACKED_M, "m", f"{when:.6g} s")]


def _moved(world: World, end: End, t: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Place (T, 3) and velocity (T, 3) of an end at times t (T,), and bounds (T - 1,) of its acceleration between; NaN
    where its frame is not known."""
    states = np.array(world.states([(end.carrier, end.pose, x) for x in t.tolist()]))
    bend = np.zeros(len(t) - 1)
    if not end.stands:
        jets, pose = motion.all_jets(world.tables), end.pose
        for i in range(len(bend)):
            bend[i] = math.nan
            if motion.carry(end.carrier, t[i], t[i + 1], world.tables, jets):
                moved = along.point(jets, end.carrier, pose.x, pose.y, pose.z, pose.yaw)[:3]
                bend[i] = math.hypot(*(max(abs(jet[4]), abs(jet[5])) for jet in moved))
    return states[:, :3], states[:, 4:7], bend
