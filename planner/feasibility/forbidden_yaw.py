"""A start, or a point on a frame that never turns, whose yaw is forbidden in every way in which it may be met."""

from __future__ import annotations

import math

from assur.planner.legs.control_point import control_point
from assur.planner.legs.forbidden_yaw import tool_yaw, yaw_refused
from assur.planner.model.attachments import Attachments, at_start
from assur.planner.model.deadline import look
from assur.planner.model.phases import yaw_offsets
from assur.planner.model.refusal import Refusal, Stage
from assur.planner.model.scene import Pick, Place, Scene

MOST_WAYS = 64
"""Ways in which parts may sit in the gripper that are looked at, all together."""


def yaw_impossible(scene: Scene) -> Refusal | None:
    """The start, or the first step, at which the tool cannot but be in a forbidden range of yaw; None: there is none.

    Not looked at: points whose yaw is free or kept, or on a frame that turns, and places of parts that were picked in
    any yaw. The search decides about them.
    """
    if not scene.forbidden_yaw:
        return None
    t = scene.start.time
    starts = yaw_refused(scene, Stage.START, 0, float(tool_yaw(scene, scene.start.q)), interval=(t, t))
    if starts is not None:
        return starts
    ways: tuple[Attachments, ...] = (at_start(scene),)
    turned = False
    for number, step in enumerate(scene.task):
        look()
        offsets = yaw_offsets(scene, step)
        if offsets is None or (turned and isinstance(step, Place)):
            turned = isinstance(step, Pick) or (turned and not isinstance(step, Place))
            offsets, known = (0.0,), False
        else:
            known = not (scene.options.vias_missed and step.via)
        points = [(held, control_point(scene, number, held, turn)) for held in ways for turn in offsets]
        refusals = []
        for _, point in points:
            yaw = scene.frames[point.frame].law.yaw
            yaw = math.nan if yaw is None or not known else yaw + point.pose.yaw + scene.tool.tcp.yaw
            refusals.append(yaw_refused(scene, Stage.CONTROL_POINT, number, yaw) if math.isfinite(yaw) else None)
        if all(refusal is not None for refusal in refusals):
            return refusals[0]
        ways = tuple(dict.fromkeys(held.after(scene, step, point.yaw_offset) for held, point in points))
        if len(ways) > MOST_WAYS:
            return None
    return None
