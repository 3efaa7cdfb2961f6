"""Whether the joints keep their ranges, and the arm its reach, where a belt correction shifts the tool (U3)."""

from __future__ import annotations

from assur.planner.checker.doubts import doubt_of
from assur.planner.checker.solids import Solids
from assur.planner.checker.uncertainty import shifted, turned_by
from assur.planner.checker.verdict import Code, Finding
from assur.planner.checker.world import World
from assur.planner.model.phases import Phase

HALVINGS = 14
"""How often an interval is halved before it counts as broken."""


def corrected(world: World, phases: tuple[Phase, ...], table: Solids) -> list[Finding]:
    """A finding for each phase in which a correction may bring a joint beyond its range, or the arm out of reach."""
    scene = world.scene
    if not scene.execution.belt_correction:
        return []
    doubt, findings = doubt_of(scene, phases, table), []
    late, start = scene.execution.start_tolerance_s, scene.start.time
    for p, phase in enumerate(phases):
        if not phase.robot or not shifted(doubt, p, 1.0) + shifted(doubt, p, 0.0) > 0.0:
            continue
        stack = [(phase.t0, phase.t1, 0)]
        while stack:
            t0, t1, depth = stack.pop()
            over = _beyond(world, shifted(doubt, p, max(t1 + late - start, 0.0)), t0, t1)
            if over <= 0.0:
                continue
            if depth >= HALVINGS:
                what = "a belt correction may bring a joint beyond its range, or the arm out of reach"
                findings.append(Finding(Code.LIMIT, what, over, "rad", f"{phase.kind}, {t0:.6g} s"))
                break
            middle = (t0 + t1) / 2.0
            stack += [(middle, t1, depth + 1), (t0, middle, depth + 1)]
    return findings


def _beyond(world: World, shift: float, t0: float, t1: float) -> float:
    """By how much, rad, joints may exceed their ranges over [t0, t1] with the tool shifted by `shift`, m, at most;
    infinite: it cannot be."""
    scene, bounds = world.scene, world.joints(t0, t1)
    low, high = bounds[:, 0], bounds[:, 1]
    lag = scene.execution.lag[1] if scene.execution.lag else 0.0
    first, second = turned_by(world.tables[0][0], low[1] - lag, high[1] + lag, shift)
    limits, found = scene.robot.limits, 0.0
    for joint, more in ((0, first), (1, first + second), (3, second)):
        if joint < len(low):
            found = max(found, limits.lower[joint] - low[joint] + more, high[joint] + more - limits.upper[joint])
    return found if found > RATE else 0.0


RATE = 1e-9
"""rad. What rounding may add to a joint at its limit."""
