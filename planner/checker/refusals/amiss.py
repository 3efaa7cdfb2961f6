"""What a refusal says beside its facts: of which joint, frame or bodies, in which unit, and when."""

from __future__ import annotations

from assur.planner.model.refusal import (
    BeyondRange,
    Enclosed,
    ForbiddenYaw,
    LawEnds,
    MotionLimit,
    NotTouching,
    OutOfReach,
    Overload,
    Overshoot,
    Refusal,
    Separation,
    Singular,
    Stage,
    Unit,
)
from assur.planner.model.scene import Scene
from assur.planner.model.window_missed import Miss, WindowMissed

OF_JOINTS, OF_FRAMES = (BeyondRange, MotionLimit, Overshoot), (LawEnds,)
OF_BODIES = (Separation, Enclosed, Overload, NotTouching)
"""Facts that are about a joint, a frame, and bodies; the others are about none."""
RATES: dict[str, tuple[Unit, Unit]] = {"velocity": ("rad/s", "m/s"), "acceleration": ("rad/s²", "m/s²")}


def amiss(scene: Scene, refusal: Refusal) -> str:
    """What is wrong beside the facts of a refusal that is said to be proved; nothing: nothing is."""
    facts = refusal.facts
    if refusal.stage is Stage.START and refusal.step != 0:
        return "the start belongs to no later step"
    about = (refusal.joint is not None, refusal.frame is not None, bool(refusal.bodies))
    should = tuple(isinstance(facts, kinds) for kinds in (OF_JOINTS, OF_FRAMES, OF_BODIES))
    may_be_none = isinstance(facts, MotionLimit | Overload) and not any(about)
    if about != should and not may_be_none:
        return "it is about something else than its facts"
    unit = None if refusal.amount is None else refusal.amount.unit
    if unit is not None and unit != _unit(scene, refusal):
        return f"its amount is not in {unit}"
    return "" if _when(scene, refusal) else "it is told of another time"


def _unit(scene: Scene, refusal: Refusal) -> Unit | None:
    """The unit of the amount."""
    facts = refusal.facts
    revolute = any(joint.name == refusal.joint and joint.kind == "revolute" for joint in scene.robot.joints)
    match facts:
        case OutOfReach() | Separation() | NotTouching():
            return "m"
        case BeyondRange():
            return "rad" if revolute else "m"
        case Singular():
            return "1"
        case Overshoot() if facts.rate is None:
            return "rad" if revolute else "m"
        case MotionLimit() | Overshoot() if facts.rate in RATES:
            return RATES[facts.rate][0 if revolute else 1]
        case Overload():
            return "kg·m²" if facts.of == "max_inertia" else "kg"
        case ForbiddenYaw():
            return "rad"
        case WindowMissed():
            return "m" if facts.miss is Miss.NEVER_INSIDE else "s"
        case LawEnds():
            return "s"
    return None


def _when(scene: Scene, refusal: Refusal) -> bool:
    """Whether the interval of a refusal is that of what it is about."""
    when, t, facts = refusal.interval, scene.start.time, refusal.facts
    if when is None:
        return True
    if isinstance(facts, LawEnds):
        frame = scene.frames.get(refusal.frame or "")
        return refusal.stage is Stage.START and frame is not None and when == frame.law.valid
    if isinstance(facts, WindowMissed):
        return facts.miss is Miss.TOO_SHORT
    if refusal.stage is Stage.START:
        return when == (t, t) and not isinstance(facts, Overload)
    # a point that stands still is looked at at one time, which stands for all
    return refusal.stage is Stage.INVERSE and when[0] == when[1] >= t
