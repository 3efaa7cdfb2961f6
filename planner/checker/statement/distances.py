"""Does the claim require the distances of the request, between all pairs, and as much lag and lateness?"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from assur.planner.checker.statement.arms import link_names
from assur.planner.checker.statement.differences import Difference, Topic
from assur.planner.checker.statement.solids import bodies_of
from assur.planner.claim import columns as c
from assur.planner.model.refusal import Rule
from assur.planner.model.scene import Scene


def distances_agree(scene: Scene, claim: c.Claim) -> Iterator[Difference]:
    """Distances in travel and near a control point, with their exceptions, of which the last one that names a pair
    counts; and the pairs of the robot's links that are kept apart."""
    names, clearance, stated = [body.name for body in bodies_of(scene)], scene.options.clearance, claim.required[0]
    count = len(names)
    for kind, column in (("travel", 0), ("near", 1)):
        required = np.full((count, count), getattr(clearance, f"{kind}_m"))
        for rule in clearance.exceptions:
            sides = [np.array([not side or name in side for name in names]) for side in (rule.first, rule.second)]
            required[_both_ways(*sides)] = getattr(rule, f"{kind}_m")
        kept = np.full((count, count), stated[c.REQUIRED_TRAVEL + column])
        for row in claim.rules:
            first, second = row[c.RULE_SIDE : c.RULE_SIDE + count] == 1.0, row[c.RULE_SIDE + count :] == 1.0
            kept[_both_ways(first, second)] = row[c.RULE_TRAVEL + column]
        for i, k in np.argwhere(~(kept >= required)).tolist():
            if i <= k:
                what = f"{names[i]} and {names[k]} need {required[i, k]:g} m ({kind}), not {kept[i, k]:g} m"
                yield Difference(Topic.DISTANCE, what)
    links = link_names(scene.robot)
    for one, other in scene.robot.self_pairs:
        i, k = links.index(one), links.index(other)
        if not (claim.self_pairs[i, k] == 1.0 and claim.self_pairs[k, i] == 1.0):
            yield Difference(Topic.DISTANCE, f"links {one} and {other} are not kept apart")
    # only the links that carry the tool share the errors of a belt that is corrected for
    first = links.index("quill" if "quill" in links else "flange")
    if stated[c.REQUIRED_TOOL] != first:
        yield Difference(Topic.UNCERTAINTY, "other links than the tool's have a share in the errors of belts")


def _both_ways(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Which pairs (B, B) have one body on each of two sides (B,)."""
    pairs = np.outer(first, second)
    return pairs | pairs.T


def required_between(scene: Scene, near: bool, one: str, other: str) -> tuple[Rule, float]:
    """Which rule says how far two bodies that may not touch must stay apart, near a control point or in travel, and how
    far, m."""
    kind: Rule = "near" if near else "travel"
    for rule in reversed(scene.options.clearance.exceptions):
        for first, second in ((one, other), (other, one)):
            if first in (rule.first or {first}) and second in (rule.second or {second}):
                return "exception", float(getattr(rule, f"{kind}_m"))
    return kind, float(getattr(scene.options.clearance, f"{kind}_m"))


def execution_agrees(scene: Scene, claim: c.Claim, until: float) -> Iterator[Difference]:
    """Lag of the joints, lateness of the start, when errors begin to grow, and that distances are kept until the last
    phase ends, at `until`."""
    execution, stated = scene.execution, claim.required[0].tolist()
    lag = stated[c.REQUIRED_LAG :]
    if not all(x >= y for x, y in zip(lag, execution.lag, strict=False)):
        yield Difference(Topic.UNCERTAINTY, "a joint may lag by more than the claim states")
    if not stated[c.REQUIRED_LATE] >= execution.start_tolerance_s:
        yield Difference(Topic.UNCERTAINTY, "the robot may start later than the claim states")
    if not stated[c.REQUIRED_SINCE] <= scene.start.time:
        yield Difference(Topic.UNCERTAINTY, "errors of frames grow from an earlier time on")
    if not stated[c.REQUIRED_UNTIL] >= until:
        when = (stated[c.REQUIRED_UNTIL], until)
        yield Difference(Topic.DISTANCE, "distances are not kept until the end", when)
