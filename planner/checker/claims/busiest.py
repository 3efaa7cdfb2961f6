"""Whether the limit that binds is used longest in the leg that an answer names, and for as long as it says.

A planner counts the instants at which the limit is used within a hundredth of its peak, so an end of a stretch in which
it is may be off by the time between two of them.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.checker import along
from assur.planner.checker.legs import TIME_S
from assur.planner.checker.limits import KINDS, weighed
from assur.planner.checker.spline import JOINT, ROOM
from assur.planner.checker.verdict import Code, Finding
from assur.planner.checker.world import World
from assur.planner.model.claims import Claims
from assur.planner.model.outcome import Busiest
from assur.planner.model.phases import Phase
from assur.planner.model.scene import WORLD

NEAR_PEAK = 0.01
"""A limit is used within this share of its peak."""
APART_S, MOST = 1e-3, 100_000
"""How far the instants of a planner are apart, s, or so many of them if that is further."""
FINER = 8
"""So many instants of ours for one of these; of the tool point's acceleration one."""
WHERE = "margins.busiest"


def busiest(
    world: World, phases: tuple[Phase, ...], claims: Claims, binding: tuple[float, str, str] | None
) -> list[Finding]:
    """Findings about the leg in which the limit that binds is used longest. `binding`: share of the limit that is used
    at most, its kind and its joint (none: the carried part's acceleration); None: it is not said what binds."""
    if claims.busiest is None:
        return []
    (said,) = claims.busiest
    if binding is None:
        what = "the busiest leg cannot be verified without what binds"
        return [Finding(Code.CLAIM, what, where=WHERE)]
    runs = [phase for phase in phases if phase.step >= 0 and phase.t1 > phase.t0]
    step = max(APART_S, (world.end - world.start) / MOST)
    shares = [_share(world, phases, phase) for phase in runs]
    found = [_time_at_peak(world, p, share, binding, step) for p, share in zip(runs, shares, strict=True)]
    number = None if said is None else next((i for i, p in enumerate(runs) if _named(said, p)), None)
    if said is not None and number is None:
        return [Finding(Code.CLAIM, "the busiest leg that is stated is none of the plan", where=WHERE)]
    stated, own = (0.0, 0.0) if said is None or number is None else (said.at_limit_s, found[number][1])
    findings = list[Finding]()
    if said is not None and number is not None:
        off = abs(said.at_limit_s - found[number][0])
        if not off <= own:
            what = "the limit that binds is used for another time in the busiest leg"
            findings.append(Finding(Code.CLAIM, what, off, "s", WHERE))
    for i, (phase, (time, doubt)) in enumerate(zip(runs, found, strict=True)):
        if i != number and not time - doubt <= stated + own:
            what = f"the limit that binds is used longer in {phase.kind} from {phase.t0:.6g} s on"
            findings.append(Finding(Code.CLAIM, what, time - stated, "s", WHERE))
            break
    return findings


def _named(said: Busiest, phase: Phase) -> bool:
    off = max(abs(said.t0 - phase.t0), abs(said.t1 - phase.t1))
    return said.kind == phase.kind and said.step == phase.step and off <= TIME_S


def _share(world: World, phases: tuple[Phase, ...], phase: Phase) -> float:
    """What the load of a phase leaves of the limits of acceleration and jerk."""
    loads = weighed(world.scene, phases, turned=False)
    return next((load.share for load in loads if load.t0 <= phase.t0 and phase.t1 <= load.t1), 1.0)


def _time_at_peak(
    world: World, phase: Phase, share: float, binding: tuple[float, str, str], step: float
) -> tuple[float, float]:
    """For how long, s, a limit is used within `NEAR_PEAK` of its peak in a phase, and by how much a count of instants
    may be off."""
    ratio, kind, joint = binding
    least, t0, t1 = (1.0 - NEAR_PEAK) * ratio, phase.t0, min(phase.t1, world.end)
    if not joint and phase.attached.held is None:
        return 0.0, step
    count = max(1, math.ceil((t1 - t0) / step * (FINER if joint else 1)))
    t = t0 + (np.arange(count) + 0.5) * (t1 - t0) / count
    at_peak: BoolArray
    if joint:
        number = [each.name for each in world.scene.robot.joints].index(joint)
        limits = world.scene.robot.limits
        limit = float(
            (limits.velocity, share * limits.acceleration, share * limits.jerk)[KINDS.index(kind) - 1][number]
        )
        at_peak = np.asarray(np.abs(_rate(world, number, KINDS.index(kind), t)) >= least * limit)
    else:
        pulls = world.relative(world.frame[WORLD], np.stack([t, t], axis=1))[:, along.BEND]
        at_peak = np.asarray(pulls >= least * float(world.scene.carry_acceleration or 0.0))
    ends = int(np.count_nonzero(np.diff(at_peak.astype(np.int64)))) + int(at_peak[0]) + int(at_peak[-1])
    return float(np.count_nonzero(at_peak)) * (t1 - t0) / count, (1 + ends) * step


def _rate(world: World, joint: int, order: int, t: FloatArray) -> FloatArray:
    """The order-th derivative (T,) of a joint at times within the motion, by the control values of its pieces."""
    rows = world.tables[1][: len(world.knots.time)]
    begins = rows[:, 0]
    piece = np.clip(np.searchsorted(begins, t, side="right") - 1, 0, len(rows) - 2)
    h = begins[piece + 1] - begins[piece]
    s = np.clip((t - begins[piece]) / np.where(h > 0.0, h, 1.0), 0.0, 1.0)
    at, degree = 1 + JOINT * joint + ROOM * order, 5 - order
    values = rows[piece, at : at + degree + 1]
    for _ in range(degree):
        values = values[:, :-1] + s[:, None] * (values[:, 1:] - values[:, :-1])
    return np.asarray(values[:, 0])
