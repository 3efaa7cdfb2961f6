"""Which kinds of change the cause of a refusal asks for, the likeliest first; and where no change can help."""

from __future__ import annotations

from assur.planner.model.phases import CONTACT_M
from assur.planner.model.refusal import LawEnds, NotTouching, Overshoot, Reason, Refusal, Separation, Stage

OF_GEOMETRY = frozenset({"window", "elbow", "pitch", "heights"})
"""Where a point cannot be reached, only another time, another posture or another height can help."""
OF_LAW = frozenset({"window", "latest end", "dwell"})
"""Where it is proved that the motion of a frame is known for too short a time, only what needs less of it can help."""
OF_START = frozenset({"pair clearance", "clearance", "without"})
"""Where the arm starts too near a body, only what asks for less distance can help."""
ONLY = {
    Reason.OUT_OF_REACH: OF_GEOMETRY,
    Reason.JOINT_LIMIT: OF_GEOMETRY,
    Reason.START_IN_COLLISION: OF_START,
}
"""Kinds of change that alone can help."""
HIGHER = ("point height", "place heights")
IN_THE_WAY = ("pair clearance", "clearance", "heights", "point height", "place heights", "without")
ABOUT: dict[Reason, tuple[str, ...]] = {
    Reason.WINDOW_MISSED: ("window", "latest end", "dwell", "belt speed"),
    Reason.LAW_ENDS: ("dwell", "window", "latest end"),
    Reason.BODY_COLLISION: IN_THE_WAY,
    Reason.CONTROL_POINT_IN_COLLISION: IN_THE_WAY,
    Reason.START_IN_COLLISION: IN_THE_WAY,
    Reason.NOT_CERTIFIED: IN_THE_WAY,
    Reason.SELF_COLLISION: ("pair clearance", "elbow"),
    Reason.OUT_OF_REACH: ("window", "elbow", "pitch", "heights"),
    Reason.JOINT_LIMIT: ("window", "elbow", "pitch", "heights"),
    Reason.NEAR_SINGULARITY: ("singularity margin", "elbow"),
    Reason.MOTION_LIMIT: ("process speed", "blend", "acceleration time", "match", "belt speed", "dwell"),
    Reason.CARRY_LIMIT: ("belt speed", "heights"),
}
"""Kinds of change that are about what a refusal is about, the likeliest first."""
HOPELESS = frozenset({Reason.START_IN_COLLISION, Reason.LAW_ENDS, Reason.LOAD_LIMIT, Reason.FORBIDDEN_YAW})
"""Reasons that no change of the list can mend, but for what `worth_trying` says."""


def kinds_about(refusal: Refusal | None) -> tuple[str, ...]:
    """The kinds of change that a refusal asks for, in the order in which they are tried, before all others."""
    if refusal is None:
        return ()
    kinds, facts = ABOUT.get(refusal.reason, ()), refusal.facts
    if isinstance(facts, Separation):
        kinds = tuple(dict.fromkeys((*_of_separation(refusal, facts), *kinds)))
    return kinds


def _of_separation(refusal: Refusal, facts: Separation) -> tuple[str, ...]:
    """What mends that two bodies are too near where the arm must be."""
    if facts.end is not None:
        return ("straight part",)
    if facts.gap_m is None:
        return ()
    # planned to be one in the other: the point is too low; else the uncertainty presses them together
    planned = facts.gap_m < -CONTACT_M
    if facts.rule == "contact":
        return (*HIGHER, "contact tolerance") if planned else ("contact tolerance", *HIGHER)
    return HIGHER if planned and refusal.stage is Stage.CONTROL_POINT else ()


def allowed(refusal: Refusal | None, what: str, *, proved: bool) -> bool:
    """Whether a kind of change may help at all."""
    if proved and what == "budget":
        return False
    if refusal is not None and refusal.reason is Reason.LAW_ENDS and proved:
        return what in OF_LAW
    return refusal is None or what in ONLY.get(refusal.reason, (what,))


def worth_trying(refusal: Refusal | None) -> bool:
    """Whether any change of the list could help: also where the motion of a frame is known for too short a time for a
    control point, and where the arm starts too near a body and does not overlap it."""
    if refusal is None or not (refusal.reason in HOPELESS or isinstance(refusal.facts, NotTouching | Overshoot)):
        return True
    facts = refusal.facts
    if refusal.reason is Reason.START_IN_COLLISION and isinstance(facts, Separation):
        return facts.gap_m is not None and facts.gap_m > 0.0
    return isinstance(facts, LawEnds) and facts.tracked_s is not None
