"""The verdict on a trajectory that we did not make, as a document."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from assur.planner.errors import InputError
from assur.scenes.conventions import places
from assur.scenes.exports.export import SPARE, cell_in
from assur.scenes.exports.raised import raised
from assur.scenes.exports.trajectory_file import trajectory_from
from assur.scenes.numbers import number, optional
from assur.scenes.schema.export import BeginsOff, JerkProved, StateName, TrajectoryVerdict
from assur.scenes.schema.robots import MOST_JERK

if TYPE_CHECKING:
    from assur.planner.arrays import FloatArray
    from assur.planner.model.outcome import Plan
    from assur.planner.model.scene import Scene
    from assur.planner.trajectory import Trajectory
    from assur.scenes.conventions import Conventions
    from assur.scenes.reading.cell import Cell
    from assur.scenes.resampling.foreign import First
    from assur.scenes.schema import answer as written
    from assur.scenes.schema.export import FirstViolation, ForeignTrajectoryDocument

SAME = 1e-6
"""States of a joint that differ by no more, SI, are the same: files have few digits."""
EARLY_S = 1e-9
"""By how much a trajectory may begin before the request does, s: rounding of its times."""


def verdict(
    cell: Cell, request: dict[str, Any], asked: ForeignTrajectoryDocument, plan: Plan | None
) -> TrajectoryVerdict:
    """Whether the trajectory in a file keeps the limits and keeps everything apart. `request`: that of the cell, with
    what files hold in it; `plan`: whose legs it has, and whose promises it must keep. Raises `InputError`."""
    from assur.planner.model.phases import phases
    from assur.scenes.answer import NOTICE, nearest_document
    from assur.scenes.resampling.certifying import kept_legs
    from assur.scenes.resampling.foreign import ends_at_rest, judged, travel
    from assur.scenes.resampling.measured import ratios

    scene = cell.scene
    trajectory, notes = trajectory_from(
        asked.file.encode(),
        asked.format,
        cell.conventions,
        asked.start_s,
        scene.start.time,
        jumps=not scene.options.jerk_limited,
    )
    if not trajectory.start >= scene.start.time - EARLY_S:
        allowed = f"times from {scene.start.time:.15g} s on, when the request begins"
        raise InputError("file", trajectory.start, allowed)
    if plan is not None:
        _hold_to(plan, trajectory)
    of_motion = travel(scene, trajectory) if plan is None else phases(scene, *kept_legs(plan, trajectory))
    own, share = scene.robot.limits.jerk, ratios(scene, of_motion, trajectory)[2]
    if asked.jerk == "report" and not trajectory.jumps and share.max() > 1.0:
        # beyond what a robot's document may say the jerk is a violation all the same
        most = MOST_JERK / float(own.max()) * (1.0 - SPARE)  # a limit in deg is rounded on its way to rad and back
        factor = min(float(share.max()) * (1.0 + SPARE), most)
        cell = cell_in(raised(request, factor)) if factor > 1.0 else cell
    found = judged(cell.scene, trajectory, plan)
    limits = cell.scene.robot.limits.jerk
    jerk: list[JerkProved] = [
        {
            "joint": joint.name,
            "unit": "rad/s³" if joint.unit == "rad" else "m/s³",
            "highest": None if trajectory.jumps else optional(abs(share[i] * own[i])),
            "limit": number(limits[i]),
            "of_request": number(own[i]),
        }
        for joint, i in zip(cell.conventions, places(cell.conventions).tolist(), strict=True)
    ]
    findings: list[written.Finding] = [
        {
            "code": str(each.code),
            "what": each.what,
            "amount": optional(each.amount),
            "unit": each.unit,
            "where": each.where,
        }
        for each in found.findings
    ]
    return {
        "schema": "assur/1",
        "ok": not findings,
        "judged_as": "travel" if plan is None else "plan",
        "findings": findings,
        "begins_off": list(_begins_off(scene, cell.conventions, trajectory)),
        "notes": list(notes),
        "first": None if found.first is None else _first(found.first),
        "clearance": None if found.clearance is None else nearest_document(found.clearance),
        "jerk": jerk,
        "points": len(trajectory.time),
        "start_s": number(trajectory.start),
        "duration_s": number(trajectory.duration),
        "ends_moving": not ends_at_rest(trajectory),
        "start_tolerance_s": number(scene.execution.start_tolerance_s),
        "request_digest": scene.digest,
        "notice": NOTICE,
    }


def _begins_off(scene: Scene, conventions: Conventions, trajectory: Trajectory) -> Iterator[BeginsOff]:
    """By how much the first point is off the request's start, state by state, of the joints of which it is."""
    start = scene.start
    of_states: list[tuple[StateName, FloatArray, FloatArray, str]] = [
        ("position", start.q, trajectory.q[0], ""),
        ("velocity", start.qd, trajectory.qd[0], "/s"),
        ("acceleration", start.qdd, trajectory.qdd[0], "/s²"),
    ]
    for state, there, here, per in of_states:
        for joint, i in zip(conventions, places(conventions).tolist(), strict=True):
            by = abs(float(here[i] - there[i]))
            if by > SAME:
                yield {"joint": joint.name, "state": state, "by": number(by), "unit": f"{joint.unit}{per}"}


def _hold_to(plan: Plan, trajectory: Trajectory) -> None:
    """Raises `InputError` for a trajectory that cannot have the legs of a plan."""
    own, last = plan.trajectory, max((each.until for each in plan.arrivals), default=plan.trajectory.end)
    if abs(trajectory.start - own.start) > EARLY_S or not trajectory.end >= last - EARLY_S:
        allowed = f"a motion from {own.start:.15g} s until {last:.15g} s at least, as the plan's legs last"
        raise InputError("file", (trajectory.start, trajectory.end), allowed)


def _first(first: First) -> FirstViolation:
    return {
        "what": first.what,
        "time_s": number(first.time),
        "amount": None if first.amount is None else optional(first.amount),
        "unit": first.unit,
        "bodies": None if first.bodies is None else list(first.bodies),
    }
