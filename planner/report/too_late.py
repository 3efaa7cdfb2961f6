"""Sentences about windows that are missed, and about frames whose motion is not known for long enough."""

from __future__ import annotations

from assur.planner.model.refusal import LawEnds, Refusal
from assur.planner.model.scene import Pick, Place, Scene, Window
from assur.planner.model.window_missed import Miss, WindowMissed
from assur.planner.report.number_format import amount

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
