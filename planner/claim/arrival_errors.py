"""Rows of errors: how far the tool may be from its point at the end of an arrival, whatever is uncertain (N15).

The numbers are those of the answer. What is uncertain of frames, joints and the start is in other tables; a row adds
what is uncertain of the point itself: of a part where it lies, or in the gripper.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from assur.planner.claim.frames import unstated
from assur.planner.claim.points import LATER_S, MEET_M, TRACKED_M
from assur.planner.frames.motion import Pose
from assur.planner.laws import EXACT
from assur.planner.model.arrival_error import ArrivalError
from assur.planner.model.outcome import Arrival, LegKind, Plan
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Pick, Place, Scene, Trace

ROUNDED = 1e-8
"""Added to each number of an answer, m or rad: ten times what the claim checker keeps for rounding. How far the tool is
from its point if nothing is uncertain is added to lengths."""
Row = tuple[float, ...]


def errors_of(scene: Scene, plan: Plan, phases: Sequence[Phase]) -> list[Row]:
    """The row of each arrival that states an error."""
    return [_row(scene, each, each.error, phases) for each in plan.arrivals if each.error is not None]


def _row(scene: Scene, arrival: Arrival, error: ArrivalError, phases: Sequence[Phase]) -> Row:
    step, tcp, within = scene.task[arrival.step], scene.tool.tcp, error.within
    done = [
        k
        for k, phase in enumerate(phases)
        if phase.step == arrival.step
        and abs(phase.t1 - arrival.until) <= LATER_S
        and (phase.kind is LegKind.FOLLOW if step.tracks else phase.kind is not LegKind.WAIT)
    ]
    if not done:
        raise unstated(f"{step.name}, which no leg ends at")
    number = done[0]
    attached, handled = phases[number].attached, phases[number].handled
    frame, point = attached.point(scene, step)
    tool, off, arm = tcp, EXACT, 0.0
    planned = TRACKED_M if isinstance(step, Trace) else MEET_M
    if arrival.missed_by is not None:
        planned += arrival.missed_by.distance_m
    if isinstance(step, Pick):
        tool = tcp.then(Pose(yaw=arrival.yaw_offset).then(step.grasp).inverse())
        off = handled.of(step.part) or scene.index[step.part].uncertainty
        arm = math.hypot(step.grasp.x, step.grasp.y)
    elif isinstance(step, Place) and attached.held is not None:
        tool, off = attached.held.in_flange, handled.of(step.part) or EXACT
    else:
        point = step.end if isinstance(step, Trace) else point
        point = Pose(point.x, point.y, point.z, point.yaw + arrival.yaw_offset)
    return (
        *(arrival.until, number, list(scene.frames).index(frame), len(scene.robot.links) - 1),
        *(tool.x, tool.y, tool.z, tool.yaw, point.x, point.y, point.z, point.yaw),
        *(off.position_m, off.vertical_m, off.yaw_rad, arm),
        *(each + planned + ROUNDED for each in (error.position_m, within.position_m, within.vertical_m)),
        within.yaw_rad + ROUNDED,
    )
