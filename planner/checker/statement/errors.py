"""Does the claim state the error of each arrival, whatever is uncertain, and with all that is uncertain of the point?

The claim checker shows that no error is larger than a row says. Here the row is compared with the request, and the
answer with the row. Errors follow from the task: the part as it is known before the step, and the phase in which the
step is done.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from assur.planner.checker.statement.arms import flange_row
from assur.planner.checker.statement.differences import MEET, SAME, TRACKED_M, Difference, Four, Topic
from assur.planner.checker.statement.holding import Handling
from assur.planner.checker.statement.poses import inverse, is_same_pose, then
from assur.planner.claim import columns as c
from assur.planner.laws.law import EXACT
from assur.planner.model.arrival_error import ArrivalError
from assur.planner.model.outcome import LegKind
from assur.planner.model.scene import Pick, Trace

ROUNDED = 2e-8
"""By which a row may be larger than the number of the answer, m or rad: what the claim checker keeps for rounding. A
length may be larger, too, by what the tool may be off its point if nothing is uncertain."""


def errors_agree(handling: Handling, claim: c.Claim) -> Iterator[Difference]:
    """Differences of errors."""
    stated = claim.errors.tolist()
    for number, step in enumerate(handling.scene.task):
        arrival = handling.arrivals[number]
        error = arrival.error
        if error is not None and not any(_is_error(handling, number, error, row) for row in stated):
            yield Difference(Topic.ERROR, f"{step.name} may be missed by more", (arrival.until, arrival.until))


def _is_error(handling: Handling, number: int, error: ArrivalError, row: list[float]) -> bool:
    """Whether a row states no more than the error, for the place and with the uncertainty that the request has."""
    step, arrival, (frame, tool, point) = (
        handling.scene.task[number],
        handling.arrivals[number],
        _place(handling, number),
    )
    done = [
        k
        for k, leg in enumerate(handling.plan.legs)
        if leg.step == number
        and abs(leg.t1 - arrival.until) <= SAME
        and (leg.kind is LegKind.FOLLOW or not step.tracks)
    ]
    known, arm = EXACT, 0.0
    if step.part is not None:
        known = handling.uncertainty(step.part, handling.handed_before_step(number)) or EXACT
    if isinstance(step, Pick):
        arm = math.hypot(step.grasp.x, step.grasp.y)
    planned = TRACKED_M if isinstance(step, Trace) else MEET
    if arrival.missed_by is not None:
        planned += arrival.missed_by.distance_m
    off, within = (known.position_m, known.vertical_m, known.yaw_rad, arm), error.within
    most = *(planned + each for each in (error.position_m, within.position_m, within.vertical_m)), within.yaw_rad
    return (
        row[c.ERROR_TIME] == arrival.until
        and row[c.ERROR_PHASE] in done
        and row[c.ERROR_FRAME] == list(handling.scene.frames).index(frame)
        and row[c.ERROR_LINK] == flange_row(handling.scene.robot)
        and is_same_pose(row[c.ERROR_TOOL : c.ERROR_TARGET], tool)
        and is_same_pose(row[c.ERROR_TARGET : c.ERROR_OFF], point)
        and all(x >= y - SAME for x, y in zip(row[c.ERROR_OFF : c.ERROR_FAR], off, strict=True))
        and all(x <= y + ROUNDED for x, y in zip(row[c.ERROR_FAR :], most, strict=True))
    )


def _place(handling: Handling, number: int) -> tuple[str, Four, Four]:
    """The point whose error counts: its frame, its pose on the flange and its pose in the frame. It is the origin of
    the part, or the target; of a trace the end of the path."""
    step, (frame, at) = handling.scene.task[number], handling.tool_point(number)
    if isinstance(step, Trace):
        return frame, handling.tcp, (*step.path.end, at[3])
    point = at if step.part is None else handling.point(number)[1]
    return frame, then(handling.tcp, then(inverse(at), point)), point
