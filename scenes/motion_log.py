"""Recorded motion for the identification of limits: times and positions of joints, of any file that is read here
(`assur.scenes.motions`)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from assur.planner.arrays import FloatArray
from assur.scenes.bounds import MAX_LOG_BYTES, MAX_LOG_ROWS
from assur.scenes.faults import NOTHING, DocumentError
from assur.scenes.motions.csv_motion import csv_motion
from assur.scenes.motions.motion import POSITION, STATES, TIME
from assur.scenes.motions.ros_motion import is_message, ros_motion


@dataclass(frozen=True, eq=False)
class LoggedJoint:
    """A joint of a log: its name, the SI unit of its positions (None: rad or m, the file does not say), and these
    (n,)."""

    name: str
    unit: str | None
    position: FloatArray


@dataclass(frozen=True, eq=False)
class MotionLog:
    """A log: the name of its file, times (n,) in s from its first row, its joints, and what was read otherwise than as
    it is written, or not read."""

    name: str
    time: FloatArray
    joints: tuple[LoggedJoint, ...]
    notes: tuple[str, ...] = ()


def load_log(path: Path) -> MotionLog:
    """The log in a file. Raises `DocumentError` with the file's name, column and line, or `OSError`."""
    with path.open("rb") as file:
        return parse_log(file.read(MAX_LOG_BYTES + 1), path.name)


def parse_log(data: bytes, name: str) -> MotionLog:
    """The log that `data` spells, CSV or messages of ROS, of the file called `name`. Raises `DocumentError`."""
    from assur.scenes.identification.recording import fault_of_times

    motion = (ros_motion if is_message(data) else csv_motion)(data, name, MAX_LOG_ROWS)
    fault = fault_of_times(motion.time)
    if fault is not None:
        row, allowed = fault
        field, line = motion.where(row, TIME, 0)
        raise DocumentError(f"{field} in s", float(motion.time[row]) if len(motion.time) else NOTHING, allowed, line)
    joints = []
    for i, track in enumerate(motion.tracks):
        position = track.states[POSITION]
        if position is None:
            field, line = motion.where(0, POSITION, i)
            raise DocumentError(field, NOTHING, f"positions of {track.name}", line)
        joints.append(LoggedJoint(track.name, track.unit, position))
    rates = [STATES[k] for k in (1, 2) if any(track.states[k] is not None for track in motion.tracks)]
    notes = motion.notes + ((f"{' and '.join(rates)} are not used",) if rates else ())
    return MotionLog(name, motion.time - motion.time[0], tuple(joints), notes)
