"""The hand-over of a plan to a joint_trajectory_controller that runs another one (docs/export.md).

The whole motion is exact on one time base: the points of the running plan up to the switch, then those of the plan.
Both are proved: the running plan with a knot at the switch, against its own request, and the plan with the state of the
running plan at the switch as its first state.
"""

from __future__ import annotations

from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from assur.planner.errors import InputError
from assur.scenes.conventions import as_maker, rates_as_maker
from assur.scenes.exports.export import in_words
from assur.scenes.faults import NOTHING, raised_as
from assur.scenes.plan_file import MEANT, in_request, plan_file_in
from assur.scenes.requests import cell_of, read_plan

if TYPE_CHECKING:
    from assur.planner.arrays import FloatArray
    from assur.planner.model.outcome import Plan
    from assur.planner.trajectory import Trajectory
    from assur.scenes.reading.cell import Cell
    from assur.scenes.schema.export import ExportDocument

AFTER = "after"
NANO = 1e-9
SAME = 1e-9
"""By how much a joint, its velocity or its acceleration may differ at the switch, SI, as at the start of a plan."""
WHOLE_NANOS = 1e-3
"""By how much of a nanosecond a time may be off a whole one: what sums of times round, besides their own resolution."""


@dataclass(frozen=True, eq=False)
class Handover:
    """`lead_s`: by how much later the stamps are than the motion. `before`: times (K,) s and q, q̇, q̈ (K, n), in the
    planner's convention, of the points of the running plan before the switch; none: nothing runs. `digest`: that of its
    request."""

    lead_s: float
    before: tuple[FloatArray, ...] | None = None
    digest: str = ""


def handed_over(cell: Cell, made: Plan, how: ExportDocument, running: object) -> tuple[Plan, Handover]:
    """A plan that continues the plan file `running` (None: nothing runs), and the motion before it.

    Raises `InputError` if the format has no stamps, and if the running plan cannot be continued: another robot, other
    joints, a time at which it does not run, another state, or another load.
    """
    lead = how.lead_s or 0.0
    if not how.format.startswith("ros2"):
        for name, value in (("lead_s", how.lead_s), (AFTER, None if running is None else "a plan file")):
            if value is not None:
                raise InputError(name, value, f"none for {how.format}: ros2 and ros2-json have it")
    if abs(lead / NANO - round(lead / NANO)) > WHOLE_NANOS:
        raise InputError("lead_s", lead, "whole nanoseconds, for ROS times are")
    if running is None:
        if lead and not made.trajectory.rest_at_start:
            allowed = "none for a motion that begins in motion, unless the plan that runs before is given (after)"
            raise InputError("lead_s", lead, allowed)
        return made, Handover(lead)
    ran_cell, ran = _running(running)
    with _in_after():
        _same_robot(ran_cell, cell)
    motion = ran.trajectory
    nanos = _switch(motion, made.trajectory.start)
    at = min(motion.start + nanos * NANO, motion.end)
    _same_load(ran_cell, ran, cell, at)
    state = _same_state(motion, made.trajectory, at, cell)
    with _in_after():
        before = _proved_before(ran_cell, ran, nanos)
    begun = replace(made, trajectory=_begun(made.trajectory, state))
    return begun, Handover(lead, before, ran_cell.scene.digest)


def _in_after() -> AbstractContextManager[None]:
    """A fault that is raised inside is one of the plan file that runs before."""
    return raised_as(lambda error: InputError(f"{AFTER}.{error.field}", error.value, error.allowed))


def _running(document: object) -> tuple[Cell, Plan]:
    """The cell and the plan in a plan file; the plan has been read, and is not proved."""
    if not isinstance(document, dict):
        raise InputError(AFTER, document, MEANT)
    with _in_after():
        held = plan_file_in(document)
        with in_request():
            cell = cell_of(held.request)
        held.held_together(cell.scene.digest)
        made, untrue, _ = read_plan(cell, held.plan)
        if untrue:
            raise InputError("plan", "this answer", f"one that is right: {in_words(untrue)}")
        return cell, made


def _proved_before(cell: Cell, ran: Plan, nanos: int) -> tuple[FloatArray, ...]:
    """The knots of the running plan before the switch: of a motion with a knot there, which is proved."""
    from assur.scenes.resampling.certifying import Refutation, recertified
    from assur.scenes.resampling.grid import on_nanoseconds

    motion = on_nanoseconds(ran.trajectory, nanos)
    proved = recertified(cell.scene, ran, motion)
    if isinstance(proved, Refutation):
        allowed = f"one that can be proved with a point at the switch; the checker says: {in_words(proved.findings)}"
        raise InputError("plan", "this motion", allowed)
    earlier = np.rint((motion.time - motion.start) / NANO) < nanos
    return tuple(column[earlier] for column in (motion.time, motion.q, motion.qd, motion.qdd))


def _same_robot(ran: Cell, cell: Cell) -> None:
    names, own = ([joint.name for joint in each.conventions] for each in (ran, cell))
    if names != own:
        raise InputError("request.robot", names, f"the joints of the robot of this request, {', '.join(own)}")
    first, second = ran.scene.robot, cell.scene.robot
    if (replace(first, base=second.base).chain, ran.conventions) != (second.chain, cell.conventions):
        raise InputError("request.robot", first.name, f"the robot of this request, {second.name}")
    if first.base != second.base:
        raise InputError("request.robot.base", first.base, f"the base of the robot of this request, {second.base}")


def _switch(ran: Trajectory, start: float) -> int:
    """Nanoseconds after the start of the running plan at which the plan begins."""
    field = "start.at_s"
    if start <= ran.start:
        allowed = f"later than {ran.start!r} s, the start of the plan that runs before, by the same clock"
        early = f"{ran.start - start:.6g} s too early" if start < ran.start else "the same time"
        raise InputError(field, start, f"{allowed}: it is {early}")
    if start > ran.end + NANO:
        allowed = f"up to {ran.end!r} s, the end of the plan that runs before, by the same clock"
        raise InputError(field, start, f"{allowed}: it is {start - ran.end:.6g} s too late")
    nanos = round((start - ran.start) / NANO)
    off = abs(ran.start + nanos * NANO - start)
    if off > WHOLE_NANOS * NANO + 2.0 * float(np.spacing(abs(start))):
        raise InputError(
            field, start, f"whole nanoseconds after {ran.start!r} s, the start of the plan that runs before"
        )
    return nanos


def _same_load(ran_cell: Cell, ran: Plan, cell: Cell, at: float) -> None:
    """Whether something is held is the same for both plans at the switch."""
    from assur.planner.model.attachments import at_start
    from assur.planner.model.phases import phases

    held = at_start(cell.scene).held
    of_plan = phases(ran_cell.scene, ran.legs, ran.arrivals)
    parts = [phase.attached.held for phase in of_plan if phase.t0 - NANO <= at <= phase.t1 + NANO]
    if all((part is None) != (held is None) for part in parts):
        had = "nothing" if parts[0] is None else parts[0].part
        got = NOTHING if held is None else held.part
        raise InputError("start.holding", got, f"what the plan that runs before holds at {at!r} s: {had}")


def _same_state(ran: Trajectory, made: Trajectory, at: float, cell: Cell) -> tuple[FloatArray, ...]:
    """The state of the running plan at the switch, (n,) each, which is that of the plan when it begins."""
    state, begins = ran.state(at), (made.q[0], made.qd[0], made.qdd[0])
    for order, (key, rate) in enumerate((("joints", ""), ("velocity", "_s"), ("acceleration", "_s2"))):
        counted = as_maker if order == 0 else rates_as_maker
        here, there = (counted(each[order], cell.conventions).tolist() for each in (state, begins))
        for joint, value, other in zip(cell.conventions, here, there, strict=True):
            if not abs(value - other) <= SAME:
                unit = f"{joint.unit}{rate.replace('_', '/')}"
                allowed = f"{value!r}, the running plan's at {at!r} s: they differ by {abs(value - other):.6g} {unit}"
                raise InputError(f"start.{key}.{joint.name}_{joint.unit}{rate}", other, allowed)
    return state


def _begun(made: Trajectory, state: tuple[FloatArray, ...]) -> Trajectory:
    """The motion with another first state."""
    from assur.planner.trajectory import Trajectory

    columns = [np.array(each) for each in (made.q, made.qd, made.qdd)]
    for column, first in zip(columns, state, strict=True):
        column[0] = first
    return Trajectory(made.time, *columns)


def statement(handover: Handover, start: float) -> list[str]:
    """The notes on a hand-over, in short lines. `start`: when the plan begins, s of the cell's clock."""
    lines = []
    if handover.lead_s:
        lines.append(
            f"stamps are {1e3 * handover.lead_s:g} ms later than the motion, for a controller that commands the sample "
            "one update period ahead (ROS 2 Jazzy and later)"
        )
    if handover.before is not None:
        time = handover.before[0]
        lines.append(
            f"the first {len(time)} points are those of the plan that runs until {start:.9g} s, for the request "
            f"{handover.digest}"
        )
        lines.append(
            f"send it before {start:.9g} s with the header stamp of that plan, which starts at {time[0]:.9g} s; "
            "allow_trajectory_replacement must be false"
        )
    return lines
