"""The story of a check of a refusal: it is proved if the checker can show, from the request and the witness alone, that
no plan exists, and if what the refusal says is what was shown.

Whatever cannot be shown is a finding: the planner then says that it was not proved.
"""

from __future__ import annotations

import numpy as np

from assur.planner.checker.refusals import start
from assur.planner.checker.refusals.amiss import amiss
from assur.planner.checker.refusals.overshoot import overshoot
from assur.planner.checker.refusals.points import every_pitch, hindered, met, orbit, yaws_forbidden
from assur.planner.checker.refusals.start import amount_of, same
from assur.planner.checker.refusals.touching import never_touching
from assur.planner.checker.refusals.windows import missed
from assur.planner.checker.verdict import Code, Finding, Verdict
from assur.planner.model.proofs.witness import PROVED_M, Hindered, Met, Openings, Orbit, Witness
from assur.planner.model.refusal import (
    BeyondRange,
    ForbiddenYaw,
    LawEnds,
    MotionLimit,
    NotTouching,
    Obstacle,
    OutOfReach,
    Overload,
    Overshoot,
    Reason,
    Refusal,
    Singular,
    Stage,
)
from assur.planner.model.scene import Scene

HINDRANCES = frozenset(
    {
        Reason.OUT_OF_REACH,
        Reason.JOINT_LIMIT,
        Reason.NEAR_SINGULARITY,
        Reason.NEAR_PARALLEL_SINGULARITY,
        Reason.FORBIDDEN_YAW,
    }
)
"""Reasons of which there must be one for each way to a control point."""


@np.errstate(all="ignore")
def check_refusal(scene: Scene, refusal: Refusal, witness: Witness | None) -> Verdict:
    """Whether a refusal that is said to be proved is proved: no plan of `scene` exists, for what the refusal says."""
    if not 0 <= refusal.step < len(scene.task):
        return _verdict(f"the task has no step {refusal.step}")
    complaint = amiss(scene, refusal) or _complaint(scene, refusal, witness)
    return Verdict.of([]) if not complaint else _verdict(complaint)


def _verdict(complaint: str) -> Verdict:
    return Verdict.of([Finding(Code.REFUSAL, f"the refusal is not shown to be right: {complaint}", where="refusal")])


def _complaint(scene: Scene, refusal: Refusal, witness: Witness | None) -> str:
    """Why a refusal is not shown to be right; nothing: it is."""
    match witness:
        case Hindered():
            return _by_hindrances(scene, refusal, witness)
        case Met():
            at_start = refusal.reason is Reason.START_IN_COLLISION and refusal.stage is Stage.START
            at_point = refusal.reason is Reason.CONTROL_POINT_IN_COLLISION and refusal.stage is Stage.CONTROL_POINT
            if not (at_start or at_point) or (at_start and refusal.step != 0):
                return "bodies that meet prove nothing of it"
            return met(scene, refusal, witness)
        case Openings():
            if refusal.stage is not Stage.WINDOW or refusal.reason not in (Reason.WINDOW_MISSED, Reason.LAW_ENDS):
                return "times prove nothing of it"
            return missed(scene, refusal, witness)
        case Orbit():
            proves = refusal.stage is Stage.CONTROL_POINT and refusal.reason is Reason.OUT_OF_REACH
            if not proves or refusal.facts != OutOfReach():
                return "a period proves nothing of it"
            return orbit(scene, refusal, witness)
        case None:
            return _by_facts(scene, refusal)


def _by_hindrances(scene: Scene, refusal: Refusal, witness: Hindered) -> str:
    if refusal.stage not in (Stage.CONTROL_POINT, Stage.INVERSE) or refusal.reason not in HINDRANCES:
        return "hindrances prove nothing of it"
    return hindered(scene, refusal, witness)


def _by_facts(scene: Scene, refusal: Refusal) -> str:
    """... of those that need no witness: their facts and amounts are all there is to show."""
    facts, reason, stage = refusal.facts, refusal.reason, refusal.stage
    if isinstance(facts, Overload) and reason is Reason.LOAD_LIMIT and stage in (Stage.START, Stage.CONTROL_POINT):
        return start.overload(scene, refusal, facts)
    if stage is Stage.START:
        return _at_start(scene, refusal)
    if isinstance(facts, NotTouching) and (reason, stage) == (Reason.TOLERANCE, Stage.CONTROL_POINT):
        return never_touching(scene, refusal, facts)
    if isinstance(facts, ForbiddenYaw) and (reason, stage) == (Reason.FORBIDDEN_YAW, Stage.CONTROL_POINT):
        return yaws_forbidden(scene, refusal, facts)
    if isinstance(facts, OutOfReach) and (reason, stage) == (Reason.OUT_OF_REACH, Stage.CONTROL_POINT):
        return every_pitch(scene, refusal) if facts == OutOfReach(every_pitch=True) else "it has no witness"
    if isinstance(facts, BeyondRange) and (reason, stage) == (Reason.JOINT_LIMIT, Stage.INVERSE):
        return _arch(scene, refusal, facts)
    if facts == MotionLimit(obstacle=Obstacle.NO_PATH) and (reason, stage) == (Reason.MOTION_LIMIT, Stage.STRAIGHT):
        return start.no_path(scene, refusal) if refusal.amount is None else "no amount is missing"
    return "it has no witness"


def _at_start(scene: Scene, refusal: Refusal) -> str:
    facts, reason = refusal.facts, refusal.reason
    if isinstance(facts, BeyondRange) and reason is Reason.JOINT_LIMIT:
        return start.beyond_range(scene, refusal, facts)
    if isinstance(facts, MotionLimit) and reason is Reason.MOTION_LIMIT and facts.obstacle is Obstacle.RATE:
        return start.too_fast(scene, refusal, facts)
    if isinstance(facts, Overshoot) and reason is (Reason.JOINT_LIMIT if facts.rate is None else Reason.MOTION_LIMIT):
        return overshoot(scene, refusal, facts)
    if isinstance(facts, Singular) and reason is Reason.NEAR_PARALLEL_SINGULARITY:
        return start.unassembled(scene, refusal, facts)
    if isinstance(facts, LawEnds) and reason is Reason.LAW_ENDS:
        return start.law_over(scene, refusal, facts)
    if isinstance(facts, ForbiddenYaw) and reason is Reason.FORBIDDEN_YAW:
        return start.turned_into_range(scene, refusal, facts)
    return "it has no witness"


def _arch(scene: Scene, refusal: Refusal, facts: BeyondRange) -> str:
    """Of an arch that is above the range of the lift: the flange is as high above the base as the lift is extended."""
    robot, arch = scene.robot, scene.task[refusal.step].arch
    if robot.lift is None or arch is None or refusal.joint != robot.joints[robot.lift].name:
        return "there is no arch, or another joint lifts"
    top = arch.top_m - scene.tool.tcp.z - robot.base.z
    high = float(robot.limits.upper[robot.lift])
    if not top - high > PROVED_M:
        return "the lift reaches the top of the arch"
    told = facts == BeyondRange(value=facts.value, limit=facts.limit, arch_top_m=arch.top_m)
    told = told and same(amount_of(refusal), top - high)
    ends = ((facts.value, top), (facts.limit, high))
    told = told and all(same(one, scene.counted(robot.lift, other)) for one, other in ends)
    return "" if told else "the arch is too high by another amount"
