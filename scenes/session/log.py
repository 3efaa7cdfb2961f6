"""The log of a session: an MCAP file with its cell, its calls and the motion of the joints.

Messages are those of ROS 2, which Foxglove and Rerun show: on ``/session`` each call as text (JSON), on
``/joint_states`` the state of the joints each `STEP_S`. Log times count from the first time of the session's clock.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from assur.planner.errors import InputError
from assur.scenes.conventions import as_maker, rates_as_maker

try:
    from mcap.reader import SeekingReader
    from mcap_ros2.decoder import DecoderFactory
    from mcap_ros2.writer import Writer
except ModuleNotFoundError as missing:
    if (missing.name or "").partition(".")[0] not in ("mcap", "mcap_ros2"):
        raise
    raise ModuleNotFoundError(
        "the log of a session needs mcap-ros2-support, which is not installed: pip install 'assur[log]'",
        name=missing.name,
    ) from None

if TYPE_CHECKING:
    from assur.scenes.session.committed import CommittedMotion

Document = dict[str, Any]
CALLS, STATES, CELL = "/session", "/joint_states", "cell.json"
STEP_S = 0.01
"""Between two states of the joints, s."""
MOST_BYTES = 256 * 2**20
"""Of a record of a log that is read: a cell with meshes is one."""
TEXT = "string data"
STATE = """std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec"""
"""Definitions of the messages, as MCAP files have them: std_msgs/String and sensor_msgs/JointState of ROS 2."""


class SessionLog:
    """Writes the log of a session into a file, as a record of its calls (`assur.scenes.session.recorded`)."""

    def __init__(self, path: Path, cell: Document) -> None:
        """Raises `OSError` for a file that cannot be written."""
        self._file = path.open("wb")
        self._writer = Writer(self._file)
        self._writer.add_attachment(0, 0, CELL, "application/json", json.dumps(cell).encode())
        self._text = self._writer.register_msgdef("std_msgs/msg/String", TEXT)
        self._state = self._writer.register_msgdef("sensor_msgs/msg/JointState", STATE)
        self._from_s: float | None = None
        self._closed = False

    def called(self, event: Document) -> None:
        """As a record. A call behind `close` is not written."""
        if self._closed:
            return
        if self._from_s is None:
            self._from_s = event["clock_s"]
        text = {"data": json.dumps(event)}
        self._writer.write_message(CALLS, self._text, text, self._log_time(event["clock_s"]))

    def moved(self, motion: CommittedMotion, from_s: float, to_s: float) -> None:
        """As a record."""
        if self._closed:
            return
        first, last = math.floor(from_s / STEP_S) + 1, math.floor(to_s / STEP_S)
        for number in range(first, last + 1):
            at_s = number * STEP_S
            there = motion.at(at_s)
            q, qd, _ = there.state(at_s)
            known = there.cell.conventions
            seconds = math.floor(at_s)
            stamp = {"sec": seconds, "nanosec": round(1e9 * (at_s - seconds)) % 10**9}
            state = {
                "header": {"stamp": stamp, "frame_id": "world"},
                "name": [joint.name for joint in known],
                "position": as_maker(q, known).tolist(),
                "velocity": rates_as_maker(qd, known).tolist(),
                "effort": [],
            }
            self._writer.write_message(STATES, self._state, state, self._log_time(at_s))

    def close(self) -> None:
        """Finishes the file. It can be read up to here as well if this is never called, but not by all readers."""
        self._closed = True
        self._writer.finish()  # type: ignore[no-untyped-call]
        self._file.close()

    def _log_time(self, at_s: float) -> int:
        """Nanoseconds since the session began."""
        return round(1e9 * (at_s - (self._from_s or 0.0)))


def read_log(path: Path) -> tuple[Document, Iterator[Any]]:
    """The cell of a log, and its calls in their order. Raises `InputError` for what is no log of a session, also while
    the calls are read, and `OSError`."""
    with path.open("rb") as file, _no_log(path):
        cell = next(each.data for each in _reader(file).iter_attachments() if each.name == CELL)
        return json.loads(cell), _calls(path)


def _calls(path: Path) -> Iterator[Any]:
    with path.open("rb") as file, _no_log(path):
        for _, _, _, message in _reader(file).iter_decoded_messages(topics=[CALLS], log_time_order=False):
            yield json.loads(message.data)


def _reader(file: BinaryIO) -> SeekingReader:
    factories = [DecoderFactory()]
    return SeekingReader(file, validate_crcs=True, decoder_factories=factories, record_size_limit=MOST_BYTES)


@contextmanager
def _no_log(path: Path) -> Iterator[None]:
    """Whatever the libraries raise while they read a file that is damaged, or no log, becomes an `InputError`."""
    try:
        yield
    except Exception as error:
        why = str(error) or type(error).__name__
        raise InputError("log", path.name, f"the log of a session, an MCAP file that was closed ({why})") from error
