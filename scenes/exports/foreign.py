"""The verdict on a trajectory that we did not make, as a document."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.scenes.bounds import MAX_KNOTS, SHORTEST_STEP_S
from assur.scenes.conventions import Conventions, converted, converted_rates
from assur.scenes.exports.export import SPARE, cell_in, jerk_proved
from assur.scenes.exports.raised import raised
from assur.scenes.faults import NOTHING, DocumentError, raised_as
from assur.scenes.motions.csv_motion import csv_motion
from assur.scenes.motions.motion import STATES, TIME, Motion, Track, largest, listed, matched
from assur.scenes.motions.ros_motion import ros_motion
from assur.scenes.numbers import number, optional
from assur.scenes.reading.neighbours import crowded
from assur.scenes.schema.export import BeginsOff, StateName, TrajectoryVerdict
from assur.scenes.schema.robots import MOST_JERK
from assur.scenes.units import twin_of

if TYPE_CHECKING:
    from assur.planner.model.outcome import Plan
    from assur.planner.model.scene import Scene
    from assur.planner.trajectory import Trajectory
    from assur.scenes.reading.cell import Cell
    from assur.scenes.resampling.foreign import Violation
    from assur.scenes.schema.export import FirstViolation, ForeignTrajectoryDocument

SAME = 1e-6
"""States of a joint that differ by no more, SI, are the same: files have few digits."""
EARLY_S = 1e-9
"""By how much a trajectory may begin before the request does, s: rounding of its times."""


def verdict(
    cell: Cell, request: dict[str, Any], given: ForeignTrajectoryDocument, plan: Plan | None
) -> TrajectoryVerdict:
    """Whether the trajectory in a file keeps the limits and the clearances. `request`: that of the cell, with the
    content of its files; `plan`: whose legs it has, and whose promises it must keep. Raises `InputError`."""
    from assur.planner.model.phases import phases
    from assur.scenes.answer import NOTICE
    from assur.scenes.answer_facts import written
    from assur.scenes.resampling.certifying import kept_legs
    from assur.scenes.resampling.foreign import ends_at_rest, judged, travel
    from assur.scenes.resampling.measured import ratios

    scene = cell.scene
    trajectory, notes = trajectory_from(
        given.file.encode(),
        given.format,
        cell.conventions,
        given.start_s,
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
    if given.jerk == "report" and not trajectory.jumps and share.max() > 1.0:
        # beyond what a robot's document may say the jerk is a violation all the same
        most = MOST_JERK / float(own.max()) * (1.0 - SPARE)  # a limit in deg is rounded on its way to rad and back
        factor = min(float(share.max()) * (1.0 + SPARE), most)
        cell = cell_in(raised(request, factor)) if factor > 1.0 else cell
    found = judged(cell.scene, trajectory, plan)
    return {
        "schema": "assur/1",
        "ok": not found.findings,
        "judged_as": "travel" if plan is None else "plan",
        "findings": written(found.findings),
        "begins_off": list(_begins_off(scene, cell.conventions, trajectory)),
        "notes": list(notes),
        "first": None if found.first is None else _first(found.first),
        "clearance": written(found.clearance),
        "jerk": jerk_proved(cell, np.abs(share * own), own, jumps=trajectory.jumps),
        "points": len(trajectory.time),
        "start_s": number(trajectory.start),
        "duration_s": number(trajectory.duration),
        "ends_moving": not ends_at_rest(trajectory),
        "start_tolerance_s": number(scene.execution.start_tolerance_s),
        "request_digest": scene.digest,
        "notice": NOTICE,
    }


def _begins_off(scene: Scene, conventions: Conventions, trajectory: Trajectory) -> Iterator[BeginsOff]:
    """By how much the first point is off the request's start, state by state, for the joints that it has."""
    start = scene.start
    of_states: list[tuple[StateName, FloatArray, FloatArray, str]] = [
        ("position", start.q, trajectory.q[0], ""),
        ("velocity", start.qd, trajectory.qd[0], "/s"),
        ("acceleration", start.qdd, trajectory.qdd[0], "/s²"),
    ]
    for state, there, here, per in of_states:
        for joint, i in zip(conventions, conventions.places.tolist(), strict=True):
            by = abs(float(here[i] - there[i]))
            if by > SAME:
                yield {"joint": joint.name, "state": state, "by": number(by), "unit": f"{joint.unit}{per}"}


def _hold_to(plan: Plan, trajectory: Trajectory) -> None:
    """Raises `InputError` for a trajectory that cannot have the legs of a plan."""
    own, last = plan.trajectory, max((each.until for each in plan.arrivals), default=plan.trajectory.end)
    if abs(trajectory.start - own.start) > EARLY_S or not trajectory.end >= last - EARLY_S:
        allowed = f"a motion from {own.start:.15g} s until {last:.15g} s at least, as the plan's legs last"
        raise InputError("file", (trajectory.start, trajectory.end), allowed)


def _first(first: Violation) -> FirstViolation:
    return {
        "what": first.what,
        "time_s": number(first.time),
        "amount": None if first.amount is None else optional(first.amount),
        "unit": first.unit,
        "bodies": None if first.bodies is None else list(first.bodies),
    }


# Trajectories in files of others: CSV as our exports have it, and `trajectory_msgs/JointTrajectory` of ROS.
#
# A point has positions, velocities and accelerations, and the motion between two points is the quintic through them. A
# file without accelerations says nothing of what its controller does between its points, and is refused.

FILE = "file"
"""What errors call the file."""
RATES = ("", "_s", "_s2")
"""What follows rad or m in the units of positions, velocities and accelerations."""


def trajectory_from(
    data: bytes, form: str, conventions: Conventions, start_s: float | None, begin_s: float, *, jumps: bool
) -> tuple[Trajectory, tuple[str, ...]]:
    """The trajectory in a file, and what was read otherwise than as it is written; `form`: csv or ros2.

    Times in CSV are those of the cell's clock, unless they are times of the calendar. Those and the times of a message
    count from the first point, which is at `start_s` of the cell's clock (None: at `begin_s`, when the request begins).
    `jumps`: whether two points may be at one time (parabolic blends). Raises `DocumentError` with the line, or the
    field of a message.
    """
    from assur.planner.trajectory import Trajectory

    motion = csv_motion(data, FILE, MAX_KNOTS) if form == "csv" else ros_motion(data, FILE, MAX_KNOTS)
    time, notes = motion.time, motion.notes
    tracks, prefix = _in_order(motion, conventions)
    states = [_states(motion, tracks, conventions, order) for order in range(3)]
    if prefix:
        notes = (*notes, f"the names of the joints are read without {prefix!r}")
    if len(time) < 2:
        raise DocumentError(FILE, f"{len(time)} points", "at least two points")
    if form == "ros2" or motion.relative:
        if form == "ros2" and not motion.relative and time[0] > 0.0:
            allowed = (
                "0 s at the first point: before a later one the controller would add a motion of its own. If the "
                "arm is at the first point already, subtract this time from the times of all points"
            )
            field, line = motion.where(0, TIME, 0)
            raise DocumentError(field, f"{float(time[0])!r} s", allowed, line)
        time = (begin_s if start_s is None else start_s) + time
    elif start_s is not None:
        raise InputError("start_s", start_s, "none for csv, whose time_s is the cell's clock")
    k = crowded(time, jumps=jumps)
    if k is not None:
        before, (field, line) = float(time[k - 1]), motion.where(k, TIME, 0)
        allowed = f"a time later than {before:.15g} s, that of the point before, by {SHORTEST_STEP_S:g} s at least"
        raise DocumentError(field, float(time[k]), allowed, line)
    q, qd, qdd = converted(states[0], conventions), *(converted_rates(each, conventions) for each in states[1:])
    with raised_as(lambda error: DocumentError(FILE, error.value, error.allowed)):
        return Trajectory(time, q, qd, qdd, jumps=jumps), notes


def _in_order(motion: Motion, conventions: Conventions) -> tuple[list[tuple[int, Track]], str]:
    """The track of each of the robot's joints with its place in the file, and the prefix of the names there. Raises
    `DocumentError` unless each joint has one."""
    given, names = [track.name for track in motion.tracks], [joint.name for joint in conventions]
    found = matched(given, names)
    if found is None or len(found[0]) < len(names):
        field, line = motion.named
        allowed = f"the robot's joints, each once, with one prefix or none: {listed(names)}"
        raise DocumentError(field, listed(given), allowed, line)
    return [(found[0].index(name), motion.tracks[found[0].index(name)]) for name in names], found[1]


def _states(motion: Motion, tracks: list[tuple[int, Track]], conventions: Conventions, order: int) -> FloatArray:
    """The states (K, n) of one order as the maker counts. Raises `DocumentError` for a joint without them, in another
    unit than its own, or too far away."""
    columns = []
    for (i, track), joint in zip(tracks, conventions, strict=True):
        values, (field, line) = track.states[order], motion.where(0, order, i)
        if track.unit not in (None, joint.unit):
            allowed = f"{joint.unit} or {'deg' if joint.unit == 'rad' else 'mm'}, for {joint.name}"
            raise DocumentError(field, track.unit, allowed, line)
        if values is None:
            own = f"{joint.name}_{joint.unit}{RATES[order]}"
            why = "the motion between points is the quintic through positions, velocities and accelerations"
            allowed = f"{STATES[order]} of {joint.name} ({own} or {twin_of(own)} in CSV): {why}"
            raise DocumentError(field, NOTHING, allowed, line)
        most = largest(joint.unit, order)
        far = np.flatnonzero(~(np.abs(values) <= most))
        if len(far):
            field, line = motion.where(int(far[0]), order, i)
            raise DocumentError(field, float(values[far[0]]), f"a number from -{most:g} to {most:g}", line)
        columns.append(values)
    return np.stack(columns, axis=1)
