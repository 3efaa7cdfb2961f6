"""Why a control point that stands still can be met in no way: an obstruction for each working mode and each turn of
the part.

Each holds for every flange within the tolerances of a plan about the place that is required (`PROVED_M`, `PROVED_RAD`),
so no plan that the checker accepts can meet the point so.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace

from assur.planner.checker.refusals.postures import posture, reaches_by_joint
from assur.planner.checker.refusals.spans import Span, beyond
from assur.planner.checker.refusals.standing import allowed_modes
from assur.planner.checker.refusals.stated import NotShownError, Shown, same
from assur.planner.checker.refusals.turning import forbidden, unreachable
from assur.planner.checker.refusals.ways import Way, is_turn, ways
from assur.planner.model.joint_range import beyond as beyond_range
from assur.planner.model.proofs.witness import (
    PROVED_M,
    PROVED_RAD,
    PROVED_SHARE,
    PROVED_TRACKED_M,
    Hindered,
    Hindrance,
)
from assur.planner.model.refusal import (
    Facts,
    JointName,
    OutOfReach,
    Quantity,
    Reason,
    Refusal,
    Singular,
    Stage,
    Unit,
)
from assur.planner.model.scene import Scene

STATED = 5e-6
"""Amounts that are stated may be off by this, m, rad or 1: the square root of what a posture that is nearly stretched
rounds, and what the planner counts ranges of yaw wider."""
MOST = 4096
"""A witness with more obstructions is refused: four modes, dozens of turns, and all joints of each are fewer."""
Obstruction = tuple[Hindrance, Iterator[Refusal]]
"""What a witness says of an obstruction, and the refusals that state it."""


def witness_of(scene: Scene, number: int) -> Hindered | None:
    """The obstructions of each way and mode in which a control point might be met; None: there may be a way."""
    found = list[Hindrance]()
    for way in ways(scene, number):
        for mode in allowed_modes(scene):
            own = [each for each, _ in obstructions(scene, way, mode)]
            if not own:
                return None
            found += own
    return Hindered(ways=tuple(dict.fromkeys(found)))


def obstructed(scene: Scene, refusal: Refusal, witness: Hindered) -> Iterator[Shown]:
    """Refusals of a point to which each way is obstructed as the witness says. Raises `NotShownError` where one is
    not."""
    if len(witness.ways) > MOST:
        raise NotShownError("its witness has more obstructions than there are")
    shown, used = list[Iterator[Refusal]](), set[int]()
    for way in ways(scene, refusal.step):
        for mode in allowed_modes(scene):
            here = [each for each in witness.ways if each.mode == mode and is_turn(each.turn_rad, way.turn)]
            own = list(obstructions(scene, way, mode)) if here else []
            held = [next((facts for true, facts in own if _is_same(each, true)), None) for each in here]
            if not held or None in held:
                raise NotShownError(f"in mode {mode} the point may be met, or not for what the witness says")
            shown += [facts for facts in held if facts is not None]
            used |= {id(each) for each in here}
    if {id(each) for each in witness.ways} - used:
        raise NotShownError("the witness has ways that there are not")
    for facts in shown:
        yield from (Shown(replace(each, stage=refusal.stage), STATED) for each in facts)


def _is_same(one: Hindrance, other: Hindrance) -> bool:
    alike = (one.reason, one.joint, one.unit) == (other.reason, other.joint, other.unit)
    return alike and same(one.above_m, other.above_m) and same(one.by, other.by, STATED)


def heights(scene: Scene, way: Way) -> tuple[float, ...]:
    """How far above a point, m, the arm must be as well as at it."""
    return tuple(dict.fromkeys((0.0, *scene.straight(scene.task[way.number]))))


def obstructions(scene: Scene, way: Way, mode: str) -> Iterator[Obstruction]:
    """Everything that prevents the arm from meeting the point of a way that stands still; nothing: perhaps it can."""
    for above in heights(scene, way):
        yield from _at_height(scene, way, mode, above)


def _at_height(scene: Scene, way: Way, mode: str, above: float) -> Iterator[Obstruction]:
    at, robot, step = way.still(scene), scene.robot, scene.task[way.number]
    if at is None:
        return
    near = PROVED_TRACKED_M if above > 0.0 else PROVED_M
    goal = way.goal(scene, at, above, 0.0, 0.0)
    exact = posture(robot, mode, goal)
    wide = posture(robot, mode, way.goal(scene, at, above, near, PROVED_RAD))

    def of(
        reason: Reason, by: float, unit: Unit, stated: Iterable[tuple[float, Facts]], joint: str | None = None
    ) -> Obstruction:
        by, subject = max(by, 0.0), None if joint is None else JointName(joint)
        own = Hindrance(mode=mode, turn_rad=way.turn, above_m=above, reason=reason, joint=joint, by=by, unit=unit)
        refusals = (
            Refusal(stage=Stage.CONTROL_POINT, reason=reason, step=way.number, subject=subject,
                    amount=Quantity.of(amount, unit), facts=facts)
            for amount, facts in stated
        )  # fmt: skip
        return own, refusals

    far = OutOfReach(
        mode=mode,
        heights_m=(goal.z.middle, robot.base.z),
        from_axis_m=math.hypot(goal.x.middle - robot.base.x, goal.y.middle - robot.base.y),
        pitch_rad=way.tilt[0],
        **way.on_path,
    )
    if wide.level.low > 0.0 or wide.level.high < 0.0:
        off = abs(exact.level.middle)
        yield of(Reason.OUT_OF_REACH, off, "m", [(off, far)])
    if wide.short.low > 0.0 and not reaches_by_joint(robot):
        yield of(Reason.OUT_OF_REACH, exact.short.low, "m", [(max(exact.short.low, 0.0), far)])
        return
    if scene.options.vias_missed and step.via:
        return  # its joints are missed; that there are none is all that can be shown
    limits = robot.limits
    for k, joint in enumerate(robot.joints):
        low, high = float(limits.lower[k]), float(limits.upper[k])
        turns, least = joint.kind == "revolute", PROVED_SHARE * (high - low)
        if beyond(wide.joints[k], low, high, turns=turns) > least:
            middle = exact.joints[k].middle
            by = beyond(Span(middle, middle), low, high, turns=turns)
            stated = [
                (by, replace(beyond_range(scene, k, value), mode=mode, above_m=above, **way.on_path))
                for value in (low - by, high + by)
            ]
            yield of(Reason.JOINT_LIMIT, by, "rad" if turns else "m", stated, joint.name)
    # the margin that is required where the tool tracks the point, and that to a type 2 singularity everywhere
    margin = scene.options.singularity_margin if step.tracks else 0.0
    for reason, need, one, other in (
        (Reason.NEAR_SINGULARITY, margin, exact.margin, wide.margin),
        (Reason.NEAR_PARALLEL_SINGULARITY, max(margin, robot.parallel_least), exact.parallel, wide.parallel),
    ):
        if one is not None and other is not None and other.high < need * (1.0 - PROVED_SHARE):
            near_one = Singular(margin=one.middle, required=need, mode=mode)
            yield of(reason, need - one.middle, "1", [(need - one.middle, near_one)])
    if not scene.forbidden_yaw or way.turn is None or not robot.turns_load:
        return
    yaw = at.then(way.flange).yaw + scene.tool.tcp.yaw
    inside = list(forbidden(scene, yaw, mode))
    around = None if inside else unreachable(scene, yaw, wide.joints, mode)
    if inside:
        yield of(Reason.FORBIDDEN_YAW, max(depth for depth, _ in inside), "rad", inside)
    elif around is not None:
        yield of(Reason.FORBIDDEN_YAW, around[0], "rad", around[1])
