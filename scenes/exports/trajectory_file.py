"""Trajectories in files of others: CSV as our exports have it, and `trajectory_msgs/JointTrajectory` of ROS.

A point has positions, velocities and accelerations, and the motion between two points is the quintic through them. A
file without accelerations says nothing of what its controller does between its points, and is refused.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.scenes.bounds import MAX_KNOTS, SHORTEST_STEP_S
from assur.scenes.conventions import Conventions, converted, converted_rates
from assur.scenes.faults import NOTHING, DocumentError
from assur.scenes.motions.csv_motion import csv_motion
from assur.scenes.motions.joint_names import listed, matched
from assur.scenes.motions.motion import STATES, TIME, Motion, Track, largest
from assur.scenes.motions.ros_motion import ros_motion
from assur.scenes.reading.neighbours import crowded
from assur.scenes.units import twin_of

if TYPE_CHECKING:
    from assur.planner.trajectory import Trajectory

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
    try:
        return Trajectory(time, q, qd, qdd, jumps=jumps), notes
    except InputError as error:
        raise DocumentError(FILE, error.value, error.allowed) from error


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
