"""Whether a motion comes as near to singular positions as an answer says: nowhere nearer, and once as near."""

from __future__ import annotations

import math

from assur.planner.checker.postures import margin_kept, parallel_kept
from assur.planner.checker.verdict import Code, Finding
from assur.planner.checker.world import World
from assur.planner.model.claims import Claims

WITHIN = 1e-3
"""By how much a least margin may be off, either way: a planner looks for it every millisecond, and closer around the
least."""


def singular(world: World, claims: Claims) -> list[Finding]:
    """Findings about the least margins of all of the motion that are claimed."""
    loop = world.scene.robot.parallel_least > 0.0
    findings = list[Finding]()
    for name, said, there, kept in (
        ("singularity", claims.singularity, True, margin_kept),
        ("parallel", claims.parallel, loop, parallel_kept),
    ):
        if said is None:
            continue
        (margin,), where = said, f"margins.{name}"
        if margin is None or not there:
            if (margin is not None) is not there:
                what = f"the arm has {'a' if there else 'no'} margin of this kind, and it is said otherwise"
                findings.append(Finding(Code.CLAIM, what, where=where))
            continue
        nearer = kept(world, margin - WITHIN, world.start, world.end)
        if nearer is not None:
            what = "the arm comes nearer to a singular position than the answer says"
            what += " (or could not be shown not to)" if math.isnan(nearer[0]) else ""
            findings.append(Finding(Code.CLAIM, what, margin - nearer[0], "1", where))
            continue
        reached = kept(world, margin + WITHIN, world.start, world.end)
        if reached is None or math.isnan(reached[0]):
            what = "the arm does not come as near to a singular position as the answer says"
            findings.append(Finding(Code.CLAIM, what, where=where))
    return findings
