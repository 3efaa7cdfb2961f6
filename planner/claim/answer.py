"""What an answer states beside its plan, as rows of the plan's claim."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from assur.planner.claim.distances import least_of, proofs_of
from assur.planner.claim.filling import SceneClaim, rows_of
from assur.planner.claim.joint_sums import stated_postures
from assur.planner.claim.lifts import ONLY, between_jumps, largest
from assur.planner.claim.obligations import loads_of
from assur.planner.claim.points import Rows, tool_on
from assur.planner.legs.tool_motion import carrying_peak, tool_accelerations, tool_peak
from assur.planner.model.claims import Claims
from assur.planner.model.outcome import JointPeak, Plan
from assur.planner.model.phases import Phase
from assur.planner.model.refusal import RATES
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory

# Peaks that an answer states of the joints and of the tool: bounds of the whole motion, and instants at which they are
# reached.

WITHIN = (1e-6, 1e-6, 1e-3)
"""By how much a peak of velocity, acceleration and jerk may be off, as a share of the joint's limit: rounding. Jerk is
a third difference of the knots' numbers, which over pieces of 10 µs rounds to 1e-4 of a usual limit."""
BETWEEN, REACHED, ROUNDING, LEAST = 0.01, 1e-3, 5e-4, 1e-6
"""Shares by which a peak of the tool, found at instants, may be exceeded between them; by which the largest
acceleration with a part may be missed, whose instant is not stated; and by which a peak may be off at its instant. And
m/s or m/s²: what is no faster stands."""
OFF = (1e-6, 1e-3)
"""By how much a speed, m/s, and an acceleration, m/s², of the tool may be off at its instant in addition: the
acceleration of a closed chain is known to 0.5 mm/s², and to 0.03 % near the edge of its reach."""
BESIDE_S = 1e-9
"""How far from a jump of the acceleration, s, either of its sides is evaluated."""
Row = tuple[float, ...]
Spans = list[tuple[float, float, FloatArray]]


def joint_peaks_of(scene: Scene, plan: Plan, phases: Sequence[Phase], claimed: Sequence[JointPeak]) -> list[Row]:
    """Rows of `sums` for the stated peaks of the joints, and for their shares of the limits if a load changes these."""
    found, path, names = list[Row](), plan.trajectory, [peak.joint for peak in claimed]
    if names != [joint.name for joint in scene.robot.joints]:
        return found
    own, loads = scene.robot.limits, [(t0, t1, scene.limits_with(part)) for part, t0, t1 in loads_of(phases) if t1 > t0]
    for order, kind in enumerate(RATES, start=1):
        sizes, ratios = ([getattr(peak, kind + of) for peak in claimed] for of in ("", "_ratio"))
        if None in sizes or None in ratios:
            continue
        slack = WITHIN[order - 1] * np.array(getattr(own, kind))
        found += _reached(path, order, slack, [(path.start, path.end, np.array(sizes))])
        if any(limits is not own for _, _, limits in loads):
            most = [(t0, t1, np.array(ratios) * getattr(limits, kind)) for t0, t1, limits in loads]
            found += _reached(path, order, slack, most)
    return found


def _reached(path: Trajectory, order: int, slack: FloatArray, spans: Spans) -> list[Row]:
    """Rows for each joint: rates of an order are no larger over each span than its sizes (n,) with `slack`, and once in
    one of the spans as large but for it."""
    found = list[Row]()
    peaks = [(*largest(path, order, t0, t1), sizes) for t0, t1, sizes in spans]
    for joint, off in enumerate(slack.tolist()):
        for t0, t1, sizes in spans:
            found.append((t0, t1, order, *ONLY[joint], -sizes[joint] - off, sizes[joint] + off))
        # of the spans the one in which most of what is stated is reached
        own = [(float(t[joint]), float(value[joint]), float(sizes[joint])) for t, value, sizes in peaks]
        t, value, size = max(own, key=lambda each: abs(each[1]) / each[2] if each[2] > 0.0 else 0.0)
        if size - off > 0.0:
            low, high = (size - off, size + off) if value > 0.0 else (-size - off, off - size)
            found.append((t, t, order, *ONLY[joint], low, high))
    return found


def tool_peaks_of(scene: Scene, plan: Plan, phases: Sequence[Phase], claims: Claims) -> list[Row]:
    """Rows of `rates` for the stated peaks of the tool point."""
    path, found, tool = plan.trajectory, list[Row](), claims.tool
    whole, on = (path.start, path.end), (*tool_on(scene)[:4], -1)

    def bounded(t0: float, t1: float, order: int, size: float) -> None:
        most = size * (1.0 + BETWEEN) + LEAST
        found.extend((*part, *on, order, 0.0, most) for part in between_jumps(path, t0, t1))

    if tool is not None:
        for order, size, t in ((1, tool.speed, tool.speed_time), (2, tool.acceleration, tool.acceleration_time)):
            bounded(*whole, order, size)
            at = _beside(scene, path, t) if order == 2 else min(max(t, path.start), path.end)
            off = ROUNDING * size + OFF[order - 1]
            found.append((at, at, *on, order, max(size - off, 0.0), size + off))
    if claims.tool_acceleration is not None:
        size = claims.tool_acceleration
        spans = [(p.t0, p.t1) for p in phases if p.attached.held is not None and p.t1 > p.t0 and p.step >= 0] or [whole]
        for span in spans:
            bounded(*span, 2, size)
        least = size * (1.0 - REACHED) - OFF[1]
        if least > 0.0:
            peak = carrying_peak(scene, path, tuple(phases)) or tool_peak(scene, path, *whole)
            at = _beside(scene, path, peak[1])
            found.append((at, at, *on, 2, least, size * (1.0 + BETWEEN) + LEAST))
    return found


def _beside(scene: Scene, path: Trajectory, t: float) -> float:
    """The instant itself, or beside a jump of the acceleration that which has the larger one."""
    t = min(max(t, path.start), path.end)
    if not path.jumps:
        return t
    times = np.array([max(t - BESIDE_S, path.start), min(t + BESIDE_S, path.end)])
    return float(times[int(np.argmax(tool_accelerations(scene, path, times)))])


def with_answer(base: SceneClaim, claim: Claim, plan: Plan, phases: Sequence[Phase], claims: Claims) -> Claim:
    """The claim of a plan (`filling.with_plan`) with rows for what an answer states: peaks, margins, working modes,
    smallest clearances, grips and supports. `phases`: those of the plan.

    What an answer states and what is not so gets a row that cannot be shown, or none; the checkers report it.
    """
    named = named_answer(base, plan, phases, claims)
    rows = {name: [row for _, row in each] for name, each in named.items()} | {
        "sums": joint_peaks_of(base.scene, plan, phases, claims.peaks or ()),
        "distances": base.distances(plan, phases).stated(claims),
    }
    tables = {name: np.concatenate([getattr(claim, name), c.table(name, added)]) for name, added in rows.items()}
    least = least_of(claims.nearest), least_of(claims.placed)
    tables["required"] = claim.required.copy()
    tables["required"][0, c.REQUIRED_NEAREST :] = least
    shown = proofs_of(base.prover, plan, phases, least)
    if shown is not None:
        tables["gap_rows"] = rows_of(shown, base.cell.carriers.body)
    return claim._replace(**tables)


def named_answer(base: SceneClaim, plan: Plan, phases: Sequence[Phase], claims: Claims) -> dict[str, Rows]:
    """The rows for what an answer states that have names for people, by their table."""
    return {
        "rates": [("tool", row) for row in tool_peaks_of(base.scene, plan, phases, claims)],
        "axes": stated_postures(base.scene, plan, claims),
    }
