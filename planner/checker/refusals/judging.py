"""The story of a check of a refusal: it is proved if the checker can show, from the request and the witness alone, that
no plan exists, and if what the refusal states is what was shown.

Whatever cannot be shown is a finding: the planner then states that it was not proved.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from assur.planner.checker.refusals import points, start
from assur.planner.checker.refusals.meetings import met, never_touching
from assur.planner.checker.refusals.obstructions import obstructed
from assur.planner.checker.refusals.stated import NotShownError, Proof, states
from assur.planner.checker.refusals.windows import missed, overshoots
from assur.planner.checker.verdict import Code, Finding, Verdict
from assur.planner.model.refusal import (
    BeyondRange,
    ForbiddenYaw,
    LawEnds,
    MotionLimit,
    NotTouching,
    OutOfReach,
    Overload,
    Overshoot,
    Reason,
    Refusal,
    Singular,
    Stage,
)
from assur.planner.model.scene import Scene
from assur.planner.model.witness import OpenIntervals, Overlap, PeriodicReach, Unreachable, Witness

OBSTRUCTED = frozenset(
    {
        Reason.OUT_OF_REACH,
        Reason.JOINT_LIMIT,
        Reason.NEAR_SINGULARITY,
        Reason.NEAR_PARALLEL_SINGULARITY,
        Reason.FORBIDDEN_YAW,
    }
)
"""There must be one of these reasons for each way to a control point."""
BY_STEP: dict[tuple[Stage, type], Callable[[Scene, int], Iterator[Proof]]] = {
    (Stage.START, BeyondRange): start.beyond_limits,
    (Stage.START, MotionLimit): start.beyond_limits,
    (Stage.START, Overshoot): overshoots,
    (Stage.START, Singular): start.unassembled,
    (Stage.START, LawEnds): start.law_over,
    (Stage.START, ForbiddenYaw): start.turned_into_range,
    (Stage.CONTROL_POINT, ForbiddenYaw): points.yaws_forbidden,
    (Stage.CONTROL_POINT, OutOfReach): points.every_pitch,
    (Stage.INVERSE, BeyondRange): points.arch,
    (Stage.STRAIGHT, MotionLimit): points.no_path,
}
"""What shows refusals that need no witness, by their stage and their facts."""
BY_FACTS: dict[tuple[Stage, type], Callable[[Scene, Refusal], Iterator[Proof]]] = {
    (Stage.START, Overload): start.overload,
    (Stage.CONTROL_POINT, Overload): start.overload,
    (Stage.CONTROL_POINT, NotTouching): never_touching,
}
"""The same where a number of the refusal may be any number of a range."""


@np.errstate(all="ignore")
def check_refusal(scene: Scene, refusal: Refusal, witness: Witness | None) -> Verdict:
    """Whether a refusal that is stated to be proved is proved: no plan of `scene` exists, for what it states."""
    what = _missing(scene, refusal, witness)
    found = [Finding(Code.REFUSAL, f"the refusal is not shown to be right: {what}", where="refusal")] if what else []
    return Verdict.of(found)


def _missing(scene: Scene, refusal: Refusal, witness: Witness | None) -> str:
    """Why a refusal is not shown to be right; nothing: it is."""
    if not 0 <= refusal.step < len(scene.task):
        return f"the task has no step {refusal.step}"
    if refusal.stage is Stage.START and refusal.step != 0:
        return "the start belongs to no later step"
    when = refusal.interval
    if refusal.stage is Stage.INVERSE and when is not None and when[0] == when[1] >= scene.start.time:
        # a point that stands still is evaluated at one time, which counts for all
        refusal = replace(refusal, interval=None)
    try:
        if any(states(refusal, each) for each in _shown(scene, refusal, witness)):
            return ""
    except NotShownError as error:
        return str(error)
    return "what it states is not what is shown"


def _shown(scene: Scene, refusal: Refusal, witness: Witness | None) -> Iterator[Proof]:
    """What can be shown of the kind of a refusal with a witness."""
    match witness:
        case Unreachable() if refusal.stage in (Stage.CONTROL_POINT, Stage.INVERSE) and refusal.reason in OBSTRUCTED:
            yield from obstructed(scene, refusal, witness)
        case Overlap() if refusal.stage in (Stage.START, Stage.CONTROL_POINT):
            yield from met(scene, refusal, witness)
        case OpenIntervals() if refusal.stage is Stage.WINDOW:
            yield from missed(scene, refusal, witness)
        case PeriodicReach() if refusal.stage is Stage.CONTROL_POINT and refusal.facts == OutOfReach():
            yield from points.orbit(scene, refusal, witness)
        case None:
            kind = refusal.stage, type(refusal.facts)
            if kind in BY_STEP:
                yield from BY_STEP[kind](scene, refusal.step)
            elif kind in BY_FACTS:
                yield from BY_FACTS[kind](scene, refusal)
            else:
                raise NotShownError("it has no witness")
        case _:
            raise NotShownError("its witness proves nothing of it")
