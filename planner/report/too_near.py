"""Sentences about two bodies that come too near each other: how near, what is required, and what that is made of."""

from __future__ import annotations

import math

from assur.planner.model.phases import CONTACT_M
from assur.planner.model.refusal import Enclosed, Reason, Refusal, Separation
from assur.planner.model.scene import Pick, Place, Scene
from assur.planner.report.number_format import amount, apart

RULES = {"near": "clearance near a point", "travel": "clearance in travel", "exception": "clearance of the exception"}
"""What a required distance is made of, without what is not known."""
WHERE = {
    Reason.SELF_COLLISION: "the arm would hit itself: ",
    Reason.START_IN_COLLISION: "the arm collides at the start: ",
    Reason.CONTROL_POINT_IN_COLLISION: "the control point cannot be met without a collision: ",
}
"""How sentences about collisions begin."""
LEAST_M = 1e-7
"""Less than this of a distance is rounding, m."""
BY_ROUNDING = ", which differ by rounding only"
"""Said of two lengths that no digits tell apart."""


def too_near(scene: Scene, refusal: Refusal, facts: Separation | Enclosed) -> str:
    """Which two bodies are too near each other, or one inside the other."""
    first, second = refusal.bodies
    if isinstance(facts, Enclosed):
        what = f"{first} is inside {second}"
    elif refusal.reason is Reason.NOT_CERTIFIED and facts.rule == "contact" and facts.clearance_m is not None:
        deep = amount(-facts.clearance_m, "m")
        return (
            f"{first} and {second} could not be proved to be pressed together by no more than {deep}: "
            "a contact_tolerance_mm of the step allows more"
        )
    elif refusal.reason is Reason.NOT_CERTIFIED:
        return f"{first} and {second} could not be proved to stay apart"
    else:
        what = _pressed(first, second, facts) or _apart(first, second, facts)
        if facts.end is not None and facts.straight_m is not None:
            enough = ""
            if facts.least_m is not None:
                enough = f"; it must be at least {math.ceil(facts.least_m * 1e4 - 1e-6) / 10:g} mm"
            return f"{facts.end} is too short: {amount(facts.straight_m, 'm')} above the point {what}{enough}"
    return f"{WHERE.get(refusal.reason, '')}{what}{_may_touch(scene, refusal, facts)}"


def _may_touch(scene: Scene, refusal: Refusal, facts: Separation | Enclosed) -> str:
    """What to do where a part is to rest on the body that is in its way. A body that may be touched may not be pressed:
    where the part is in it, that would not help."""
    step = scene.task[refusal.step]
    if refusal.reason is not Reason.CONTROL_POINT_IN_COLLISION or isinstance(facts, Enclosed):
        return ""
    if not isinstance(step, Pick | Place) or step.part not in refusal.bodies:
        return ""
    other = next(name for name in refusal.bodies if name != step.part)
    if other not in scene.index or (facts.gap_m is not None and facts.gap_m < -CONTACT_M - step.contact_tolerance_m):
        return ""
    return f"; if {step.part} is to rest on {other}, name it in contact_with"


def _pressed(first: str, second: str, facts: Separation) -> str:
    """How deep two bodies that may touch are pressed into each other, what is not known included; nothing: they may
    not touch, or it is not known."""
    gap, required, clearance = facts.gap_m, facts.required_m, facts.clearance_m
    if facts.rule != "contact" or gap is None or required is None or clearance is None:
        return ""
    unknown = required - clearance
    deep, allowed = apart(unknown - gap, -clearance)
    of = f" (uncertainty {amount(unknown, 'm')})" if unknown > LEAST_M else ""
    by = BY_ROUNDING if deep == allowed else ""
    return (
        f"{first} would be pressed {deep} into {second}{of}, but only {allowed} is allowed{by}: "
        "a contact_tolerance_mm of the step allows more"
    )


def _apart(first: str, second: str, facts: Separation) -> str:
    """The gap, what is required, and what that is made of."""
    what = f"{first} would hit {second}" if facts.touching else f"{first} would come too close to {second}"
    gap, required = facts.gap_m, facts.required_m
    if gap is None or required is None:
        return what
    deep = gap < -LEAST_M
    there, asked = (amount(-gap, "m"), amount(required, "m")) if deep else apart(max(gap, 0.0), required)
    same = BY_ROUNDING if not deep and there == asked else ""
    what += f": {'overlap up to' if deep else 'gap'} {there}, required {asked}{same}"
    if facts.rule is None or facts.rule == "contact" or facts.clearance_m is None:
        return what
    unknown = required - facts.clearance_m
    parts = [f"{RULES[facts.rule]} {amount(facts.clearance_m, 'm')}"]
    parts += [f"uncertainty {amount(unknown, 'm')}"] * (unknown > LEAST_M)
    return f"{what} ({', '.join(parts)})"
