"""Sentences about windows that are missed, and about frames whose motion is not known for long enough."""

from __future__ import annotations

import math

from assur.planner.model.phases import CONTACT_M
from assur.planner.model.refusal import Enclosed, LawEnds, Reason, Refusal, Separation
from assur.planner.model.scene import Pick, Place, Scene, Window
from assur.planner.model.window_missed import Miss, WindowMissed
from assur.planner.report.number_format import amount, apart

ON_ARRIVAL = frozenset({Miss.CLOSED_ON_ARRIVAL, Miss.NO_MEETING_LEFT, Miss.OUTSIDE})
"""Misses of what ends the time for a meeting: the window, or the latest end where there is no window."""


MISSES = {
    Miss.TOO_SHORT: "the {what} must be tracked for {needed}, but its window is open for only {open}{when} "
    "({short} short{belt})",
    Miss.OVER_BEFORE_START: "the window closes {short} before the start",
    Miss.OPENS_AFTER_LATEST_END: "the window opens {short} after latest_end_s",
    Miss.LATEST_END_BEFORE_START: "latest_end_s is {short} before the start",
    Miss.ENTERS_AFTER_LATEST_END: "the point enters its window {short} after latest_end_s",
    Miss.NEVER_INSIDE: "the point never enters its window along the conveyor: it stays {short} away",
    Miss.NO_COMMON_INSTANT: "the window in time and the window along the conveyor never overlap: they are {short} "
    "apart",
    Miss.OPENS_AFTER_LAW: "the window opens when the motion of the frame is no longer known",
    Miss.NOT_INSIDE_WHILE_KNOWN: "the point does not enter its window while the motion of its frame is known",
    Miss.NOT_INSIDE_SOON: "the point does not enter its window{when}",
    Miss.CLOSED_ON_ARRIVAL: "the arm comes at least {short} after the window has closed{belt}",
    Miss.LATEST_END_ON_ARRIVAL: "the arm comes at least {short} too late to end by latest_end_s{belt}",
    Miss.ENDS_TOO_LATE: "the motion ends at least {short} after latest_end_s",
    Miss.NO_MEETING_LEFT: "the arm comes at least {short} too late {end}",
    Miss.OUTSIDE: "the point would be met {short} outside its window",
    Miss.NO_COMMON_BEGIN: "no start of the motion was found from which all windows are met",
}
"""Why a control point is not met, by the kind of the miss."""


def window_missed(scene: Scene, refusal: Refusal, facts: WindowMissed, short: str) -> str:
    """Why a control point is not met in its window, and by how much (`short`)."""
    step, closed = scene.task[refusal.step], scene.task[refusal.step].window != Window()
    if facts.miss in ON_ARRIVAL and not closed and scene.options.latest_end_s is not None:
        return f"the arm comes at least {short} too late for latest_end_s"
    return MISSES[facts.miss].format(
        short=short,
        what="part" if isinstance(step, Pick | Place) else "point",
        needed=amount(facts.needed_s, "s"),
        open=amount(facts.open_s, "s"),
        when="" if facts.searched_s is None else f" in the next {facts.searched_s:g} s",
        belt="" if facts.belt_m is None else f", {amount(facts.belt_m, 'm')} of belt",
        end="for the window" if closed else "to meet the point while it can be met",
    )


def law_ended(refusal: Refusal, facts: LawEnds) -> str:
    """Of which frame, from when to when its motion is known, and for what it is needed longer."""
    if facts.known_s is None:
        return f"the motion of a frame is not known at {at(facts.needed_s)}"
    ends = zip(("from", "to"), facts.known_s, strict=True)
    known = " ".join(f"{word} {end:g} s" for word, end in ends if end is not None)
    law = f"the motion of {refusal.frame} is known {known}"
    if facts.tracked_s is None:
        return f"{law}, but it is needed at {at(facts.needed_s)}"
    arm = "; the arm cannot be there sooner" if facts.on_arrival else ""
    if not facts.tracked_s > 0.0:
        return f"{law}, but the point cannot be met before {at(facts.needed_s)}{arm}"
    begin, long = at(facts.needed_s - facts.tracked_s), amount(facts.tracked_s, "s")
    why = f"the point must be tracked for {long}, from {begin} on{arm}"
    return f"{law}, but it is needed until {at(facts.needed_s)}: {why}"


def at(time: float) -> str:
    """An instant, to the millisecond."""
    return f"{round(time, 3) + 0.0:g} s"


# Sentences about two bodies that come too near each other: how near, what is required, and what that is made of.

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
