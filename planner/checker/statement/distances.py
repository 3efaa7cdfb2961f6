"""Does the claim require the distances of the request, between all pairs, and as much lag and lateness?"""

from __future__ import annotations

from operator import ge

import numpy as np

from assur.planner.arrays import BoolArray
from assur.planner.checker.statement.differences import Requirements
from assur.planner.checker.statement.solids import bodies_of
from assur.planner.checker.statement.statement import Statement
from assur.planner.checker.verdict import Code
from assur.planner.claim import columns as c
from assur.planner.model.refusal import Rule
from assur.planner.model.scene import Scene


def require_distances(report: Requirements, scene: Scene, claim: c.Claim) -> None:
    """Distances in travel and near a control point, with their exceptions (the last one that names a pair
    counts), and the pairs of the robot's links that are kept apart."""
    names, clearance, stated = [body.name for body in bodies_of(scene)], scene.options.clearance, claim.required[0]
    sides = [[not side or name in side for name in names] for e in clearance.exceptions for side in (e.first, e.second)]
    sides += (claim.rules[:, c.RULE_SIDE :] == 1.0).reshape(2 * len(claim.rules), len(names)).tolist()
    # bodies that are on the same sides of all rules have the same distances: one of each kind counts
    kinds = dict[tuple[bool, ...], list[str]]()
    for name, kind in zip(names, zip(*sides, strict=True) if sides else [()] * len(names), strict=True):
        kinds.setdefault(kind, []).append(name)
    on = np.array([*kinds], dtype=bool).T.reshape(len(sides) // 2, 2, len(kinds))
    pairs = [_both_ways(*two) for two in on]
    required, kept = np.empty((2, len(kinds), len(kinds), 2))
    required[:] = clearance.travel_m, clearance.near_m
    for rule, between in zip(clearance.exceptions, pairs, strict=False):
        required[between] = rule.travel_m, rule.near_m
    kept[:] = stated[[c.REQUIRED_TRAVEL, c.REQUIRED_NEAR]]
    for row, between in zip(claim.rules, pairs[len(clearance.exceptions) :], strict=True):
        kept[between] = row[[c.RULE_TRAVEL, c.RULE_NEAR]]
    less, members = ~(kept >= required), list(kinds.values())
    for i, k, near in np.argwhere(less).tolist() if less.any() else ():
        if i < k or (i == k and len(members[i]) > 1):
            pair, name = f"{members[i][0]} and {members[k][-1]}", ("travel", "near")[near]
            what = f"{pair} need {required[i, k, near]:g} m ({name}), not {kept[i, k, near]:g} m"
            report.require(False, Code.DISTANCE, what)
    links = scene.robot.links
    for one, other in scene.robot.self_pairs:
        i, k = links.index(one), links.index(other)
        apart = claim.self_pairs[i, k] == 1.0 and claim.self_pairs[k, i] == 1.0
        report.require(apart, Code.DISTANCE, f"links {one} and {other} are not kept apart")
    # only the links that carry the tool share the errors of a belt that is corrected for
    first_of_tool = links.index("quill" if "quill" in links else "flange")
    what = "other links than the tool's have a share in the errors of belts"
    report.require(stated[c.REQUIRED_TOOL] == first_of_tool, Code.UNCERTAINTY, what)


def _both_ways(first: BoolArray, second: BoolArray) -> BoolArray:
    """Which pairs (B, B) have one body on each of two sides (B,)."""
    pairs = np.outer(first, second)
    return np.asarray(pairs | pairs.T)


def required_between(scene: Scene, near: bool, one: str, other: str) -> tuple[Rule, float]:
    """Which rule says how far two bodies that may not touch must stay apart, near a control point or in travel, and how
    far, m."""
    kind: Rule = "near" if near else "travel"
    for rule in reversed(scene.options.clearance.exceptions):
        for first, second in ((one, other), (other, one)):
            if first in (rule.first or {first}) and second in (rule.second or {second}):
                return "exception", float(getattr(rule, f"{kind}_m"))
    return kind, float(getattr(scene.options.clearance, f"{kind}_m"))


def require_execution(statement: Statement) -> None:
    """Lag of the joints, lateness of the start, when errors begin to grow, and that distances are kept until the last
    phase ends."""
    execution, stated = statement.scene.execution, statement.claim.required[0].tolist()
    until, end = stated[c.REQUIRED_UNTIL], statement.stages[-1].when[1]
    late, since = stated[c.REQUIRED_LATE], stated[c.REQUIRED_SINCE]
    statement.require_all(
        Code.UNCERTAINTY,
        None,
        (all(map(ge, stated[c.REQUIRED_LAG :], execution.lag)), "a joint may lag by more than the claim states"),
        (late >= execution.start_tolerance_s, "the robot may start later than the claim states"),
        (since <= statement.scene.start.time, "errors of frames grow from an earlier time on"),
    )
    statement.require(until >= end, Code.DISTANCE, "distances are not kept until the end", (until, end))
