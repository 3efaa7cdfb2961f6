"""Why a control point that stands still can be met in no way: an obstruction for each working mode and each turn of
the part.

Each holds for every flange within the tolerances of a plan about the place that is required (`PROVED_M`, `PROVED_RAD`),
so no plan that the checker accepts can meet the point so.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import chain

from assur.planner.checker.refusals.postures import forbidden, posture_in_mode, reaches_by_joint, unreachable
from assur.planner.checker.refusals.spans import Span, span_beyond
from assur.planner.checker.refusals.stated import NotShownError, Proof, exceeded, same
from assur.planner.checker.refusals.ways import GraspOption, each_way
from assur.planner.model.refusal import (
    JointName,
    OutOfReach,
    Quantity,
    Reason,
    Refusal,
    Singular,
    Unit,
)
from assur.planner.model.scene import Scene
from assur.planner.model.scene import beyond as beyond_range
from assur.planner.model.witness import PROVED_M, PROVED_RAD, PROVED_SHARE, PROVED_TRACKED_M, Obstruction, Unreachable

STATED = 5e-6
"""Amounts that are stated may be off by this, m, rad or 1: the square root of what a posture that is nearly stretched
rounds, and what the planner counts ranges of yaw wider."""
NUMBER: Unit = "1"
MOST = 4096
"""A witness with more obstructions is refused: four modes, dozens of turns, and all joints of each are fewer."""
ProvedObstruction = tuple[Obstruction, list[Proof]]
"""What a witness states of an obstruction, and what a refusal may state of it."""


def witness_of(scene: Scene, number: int) -> Unreachable | None:
    """The obstructions of each way and mode in which a control point might be met; None: there may be a way."""
    found = [[each for each, _ in obstructions(scene, way, mode)] for way, mode, _ in each_way(scene, number, ())]
    return Unreachable(ways=tuple(dict.fromkeys(chain.from_iterable(found)))) if all(found) else None


def obstructed(scene: Scene, refusal: Refusal, witness: Unreachable) -> Iterator[Proof]:
    """What obstructs each way to a point as the witness states. Raises `NotShownError` where one is not."""
    if len(witness.ways) > MOST:
        raise NotShownError("its witness has more obstructions than there are")
    shown, left = list[Proof](), set(map(id, witness.ways))
    for way, mode, here in each_way(scene, refusal.step, witness.ways):
        own = list(obstructions(scene, way, mode)) if here else []
        held = [next((stated for true, stated in own if _is_same(each, true)), None) for each in here]
        if not held or None in held:
            raise NotShownError(f"in mode {mode} the point may be met, or not for what the witness says")
        shown += [each for stated in held for each in stated or ()]
        left -= set(map(id, here))
    if left:
        raise NotShownError("the witness has ways that there are not")
    yield from shown


def _is_same(one: Obstruction, other: Obstruction) -> bool:
    alike = (one.reason, one.joint, one.unit) == (other.reason, other.joint, other.unit)
    return alike and same(one.above_m, other.above_m) and same(one.by, other.by, STATED)


def obstructions(scene: Scene, way: GraspOption, mode: str) -> Iterator[ProvedObstruction]:
    """Everything that prevents the arm from meeting the point of a way that stands still; nothing: perhaps it can."""
    for above in dict.fromkeys((0.0, *scene.straight(scene.task[way.number]))):
        for stated in _at_height(scene, way, mode, above):
            # the first has the amount
            reason, _, amount, subject, *_ = stated[0]
            by, unit = (0.0, NUMBER) if amount is None else (max(amount.value, 0.0), amount.unit)
            joint = subject.name if isinstance(subject, JointName) else None
            yield (
                Obstruction(mode=mode, turn_rad=way.turn, above_m=above, reason=reason, joint=joint, by=by, unit=unit),
                stated,
            )


def _at_height(scene: Scene, way: GraspOption, mode: str, above: float) -> Iterator[list[Proof]]:
    """What may be stated of each obstruction at a height above the point."""
    at, robot, step = way.still(scene), scene.robot, scene.task[way.number]
    if at is None:
        return
    near = PROVED_TRACKED_M if above > 0.0 else PROVED_M
    goal = way.goal(scene, at, above, 0.0, 0.0)
    exact = posture_in_mode(robot, mode, goal)
    wide = posture_in_mode(robot, mode, way.goal(scene, at, above, near, PROVED_RAD))
    far = OutOfReach(
        mode=mode,
        heights_m=(goal.z.middle, robot.base.z),
        from_axis_m=math.hypot(goal.x.middle - robot.base.x, goal.y.middle - robot.base.y),
        pitch_rad=way.tilt[0],
        **way.on_path,
    )
    if wide.level.low > 0.0 or wide.level.high < 0.0:
        yield [Proof(Reason.OUT_OF_REACH, far, Quantity(abs(exact.level.middle), "m"), within=STATED)]
    if wide.short.low > 0.0 and not reaches_by_joint(robot):
        yield [Proof(Reason.OUT_OF_REACH, far, Quantity(max(exact.short.low, 0.0), "m"), within=STATED)]
        return
    if scene.options.vias_missed and step.via:
        return  # its joints are missed; that there are none is all that can be shown
    limits = robot.limits
    for k, joint in enumerate(robot.joints):
        low, high = float(limits.lower[k]), float(limits.upper[k])
        turns, least = joint.kind == "revolute", PROVED_SHARE * (high - low)
        if span_beyond(wide.joints[k], low, high, turns=turns) > least:
            middle = exact.joints[k].middle
            by = span_beyond(Span(middle, middle), low, high, turns=turns)
            # the end that it is beyond, by the best full turn; both where both are as near
            off = {value: value - middle for value in (low - by, high + by)}
            ends = [v for v, d in off.items() if abs(math.remainder(d, math.tau) if turns else d) <= STATED]
            facts = [replace(beyond_range(scene, k, v), mode=mode, above_m=above, **way.on_path) for v in ends]
            yield [exceeded(scene, Reason.JOINT_LIMIT, k, by, each, by=STATED) for each in facts]
    # the margin that is required where the tool tracks the point, and that to a type 2 singularity everywhere
    margin = scene.options.singularity_margin if step.tracks else 0.0
    for reason, need, one, other in (
        (Reason.NEAR_SINGULARITY, margin, exact.margin, wide.margin),
        (Reason.NEAR_PARALLEL_SINGULARITY, max(margin, robot.parallel_least), exact.parallel, wide.parallel),
    ):
        if one is not None and other is not None and other.high < need * (1.0 - PROVED_SHARE):
            near_one = Singular(margin=one.middle, required=need, mode=mode)
            yield [Proof(reason, near_one, Quantity(need - one.middle, "1"), within=STATED)]
    if scene.forbidden_yaw and way.turn is not None and robot.turns_load:
        yaw = at.then(way.flange).yaw + scene.tool.tcp.yaw
        stated = forbidden(scene, yaw, mode) or unreachable(scene, yaw, wide.joints, mode)
        yield from [stated] * bool(stated)
