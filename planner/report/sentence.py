"""Why there is no plan: the leading refusal, and one sentence that a shift leader understands."""

from __future__ import annotations

import math

from assur.planner.model.outcome import ABOVE, LATEST, TOLD_AS, Census, CensusLine, Reason, Refusal
from assur.planner.model.scene import Scene, Window

SEARCHED = frozenset({"timing", "screening", "certificate", "limits", "glued", "straight", "window"})
"""Stages that refuse candidates, one by one."""


def leading(census: Census, deepest: int) -> CensusLine | None:
    """The most frequent refusal at the step that was never passed."""
    here = [line for line in census.lines if line.step == deepest]
    candidates = [line for line in here if line.stage in SEARCHED] or here
    # a Cartesian leg, or a mode that is not reached at all, refuses once for all candidates: it counts as most frequent
    once = [line for line in here if line.stage == "inverse"]
    if once and not any(line.stage in SEARCHED for line in here):
        return once[0]
    return max(candidates, key=lambda line: line.count, default=None)


def sentence(scene: Scene, refusal: Refusal | CensusLine | None, census: Census, *, cut: bool, budget: float) -> str:
    """One sentence, in the words of the shop."""
    if refusal is None:
        if census.candidates:
            return f"No plan was found among {census.candidates} candidates; the last step was not tried any more."
        return f"No plan was found in {budget:g} s; nothing was tried."
    step = scene.task[refusal.step].name
    what = _because(scene, refusal)
    tail = ""
    if isinstance(refusal, CensusLine) and refusal.stage in SEARCHED and census.candidates:
        tail = f" ({refusal.count} of {census.candidates} candidates{_span(refusal)})"
        if cut:
            tail += f"; the budget of {budget:g} s was spent"
    return f"{'' if refusal.stage == 'start' else step + ': '}{what}{_others(refusal, census)}{tail}."


def _others(refusal: Refusal | CensusLine, census: Census) -> str:
    """Bodies that are in the way about as often, at the same step."""
    if not isinstance(refusal, CensusLine) or refusal.reason is not Reason.BODY_COLLISION:
        return ""
    seen, found = set(refusal.bodies[1:]), []
    for line in census.lines:
        same = (line.reason, line.step) == (refusal.reason, refusal.step)
        if same and 2 * line.count >= refusal.count and not seen.issuperset(line.bodies[1:]):
            seen |= set(line.bodies[1:])
            found.append(f"{line.bodies[0]} with {' and '.join(line.bodies[1:])}")
    return f"; likewise {', '.join(found[:2])}" if found else ""


def _span(line: CensusLine) -> str:
    if line.interval is None:
        return ""
    a, b = line.interval
    return f", at {a:.2f} s" if b - a < 0.005 else f", between {a:.2f} s and {b:.2f} s"


def _number(refusal: Refusal | CensusLine) -> str:
    amount = refusal.least if isinstance(refusal, CensusLine) else refusal.amount
    if not math.isfinite(amount):
        return ""
    unit = refusal.unit
    if unit == "m":
        return f"{1e3 * amount:.1f} mm"
    if unit == "rad":
        return f"{math.degrees(amount):.1f}°"
    if unit == "s":
        return f"{1e3 * amount:.0f} ms"
    if unit in TOLD_AS:
        told, factor = TOLD_AS[unit]
        return f"{factor * amount:,.0f} {told}"
    return f"{amount:.3g}"


def _beyond(refusal: Refusal | CensusLine) -> str:
    """Which limit of a joint a motion breaks, where the unit says it."""
    joint = refusal.bodies[0] if len(refusal.bodies) == 1 and refusal.unit.endswith(("/s", "/s²", "/s³")) else "a joint"
    if refusal.unit.endswith("/s²"):
        return f"{joint} would have to accelerate more than it can"
    if refusal.unit.endswith("/s³"):
        return f"{joint} would have to change its acceleration faster than it may"
    return f"{joint} would have to be faster than it can be"


def _missed(scene: Scene, refusal: Refusal | CensusLine) -> str:
    """What a motion comes too late for: a step without a window has only the end of the plan."""
    window = getattr(scene.task[refusal.step], "window", Window())
    no_window = window.time is None and window.along is None
    only_latest = no_window and scene.options.latest_end_s is not None
    return LATEST if only_latest or LATEST in refusal.detail else "the window"


def _because(scene: Scene, refusal: Refusal | CensusLine) -> str:
    bodies = " and ".join(refusal.bodies)
    number = _number(refusal)
    detail = refusal.detail
    match refusal.reason:
        case Reason.OUT_OF_REACH:
            return (
                f"the point is {number} out of reach ({detail})" if number else f"the point is out of reach ({detail})"
            )
        case Reason.JOINT_LIMIT:
            where = f"{detail.rpartition(', ')[2]} " if detail.endswith(ABOVE) else ""
            return f"{where}{bodies or 'a joint'} would have to go {number} beyond its limit" if number else detail
        case Reason.NEAR_SINGULARITY:
            return (
                f"the arm would be too near a singular position ({detail})"
                if detail
                else "the arm would be too near a singular position"
            )
        case Reason.NEAR_PARALLEL_SINGULARITY:
            return f"the arm would be too near a position in which its motors do not hold the tool ({detail})"
        case Reason.SELF_COLLISION:
            return f"the arm would hit itself: {bodies}"
        case Reason.BODY_COLLISION:
            verb = "would hit" if detail != "too close" else "would come too close to"
            first, *rest = refusal.bodies
            return f"{first} {verb} {' and '.join(rest)}"
        case Reason.START_IN_COLLISION:
            return f"the arm collides where it stands at the start: {detail}"
        case Reason.CONTROL_POINT_IN_COLLISION:
            return f"the control point can never be met: {detail}"
        case Reason.MOTION_LIMIT:
            return f"{_beyond(refusal)}{': ' + detail if detail else ''}"
        case Reason.CARRY_LIMIT:
            return f"the part would be accelerated by {number} too much"
        case Reason.WINDOW_MISSED:
            least = "" if "the glue takes" in detail else "at least "
            return f"{_missed(scene, refusal)} is missed by {least}{number}: {detail}" if number else detail
        case Reason.LAW_ENDS:
            return f"the motion of {bodies or 'a frame'} is not known for long enough{': ' + detail if detail else ''}"
        case Reason.NOT_CERTIFIED:
            return f"{bodies} could not be proved to stay apart"
        case Reason.TIMED_OUT:
            return "the budget was spent before anything could be tried"
    raise AssertionError(refusal.reason)
