"""Motion in messages of ROS as YAML or JSON: what `ros2 topic echo`, actions, MoveIt and rosbridge write.

A `trajectory_msgs/JointTrajectory` is read wherever it is in a message, if it is the only one in the file (a goal of
FollowJointTrajectory, a RobotTrajectory, the `msg` of rosbridge); else a row of `sensor_msgs/JointState` messages.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from decimal import Decimal
from typing import Any, NamedTuple

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.scenes.bounds import LONG_S, MAX_JOINTS, MAX_JSON_BYTES
from assur.scenes.faults import NOTHING, WHOLE, DocumentError, Path, dotted
from assur.scenes.motions.motion import STATES, TIME, Motion, Track, largest, listed, seconds
from assur.scenes.text.json_text import parse_json
from assur.scenes.text.yaml_text import Lines, parse_documents

SCENARIO = "scenario"
"""What the reader of YAML calls what it reads."""
SECONDS, NANOSECONDS = ("sec", "secs"), ("nanosec", "nanosecs", "nsec", "nsecs")
LOST = b"A message was lost"
KNOWN = ("header", "joint_names", "points", *STATES, "time_from_start")
CONTENT = "a trajectory_msgs/JointTrajectory (joint_names, points), or sensor_msgs/JointState messages (name, position)"
BEGINS_A_MESSAGE = re.compile(rb"---|[\[{]|(?:- +)?[A-Za-z_][A-Za-z0-9_]*\s*:(?:\s|$)")


class _Place(NamedTuple):
    """A mapping in a file: the lines of its document, its path there, and itself."""

    lines: Lines
    path: Path
    value: dict[str, Any]

    def field(self, *more: str | int) -> tuple[str, int | None]:
        """What an error calls a field below it, and its line."""
        path = (*self.path, *more)
        name = dotted(path) if path else ""
        return name, self.lines.get(name or WHOLE)

    def wrong(self, value: object, allowed: str, *more: str | int) -> DocumentError:
        name, line = self.field(*more)
        return DocumentError(name, value, allowed, line)


def is_message(data: bytes) -> bool:
    """Whether a file is YAML or JSON rather than CSV, by its first line that is no comment."""
    for line in data.removeprefix(b"\xef\xbb\xbf").splitlines():
        bare = line.strip()
        if bare and not bare.startswith((b"#", b"//")):
            return BEGINS_A_MESSAGE.match(bare) is not None
    return False


def ros_motion(data: bytes, name: str, most_rows: int) -> Motion:
    """The motion in the messages of a file of up to `most_rows` points that errors call `name`. Raises
    `DocumentError`."""
    found = _documents(data, name)
    places = [each for lines, document in found for each in _within(lines, document)]
    trajectories = [each for each in places if _is_trajectory(each.value)]
    if len(trajectories) > 1:
        where = ", ".join(
            f"{dotted(each.path) if each.path else 'one'} in line {each.field('points')[1] or 1}"
            for each in trajectories[:4]
        )
        more = ", ..." if len(trajectories) > 4 else ""
        shown = f"{len(trajectories)} trajectories: {where}{more}"
        raise DocumentError(name, shown, "one trajectory in a file: copy the one that counts into a file of its own")
    if trajectories:
        return _trajectory(trajectories[0], most_rows, [each for _, each in found])
    states = [each for each in places if {"name", "position"} <= each.value.keys() and "points" not in each.value]
    if states:
        return _joint_states(states, name, most_rows)
    keys = [key for _, document in found if isinstance(document, dict) for key in document]
    got = f"messages with the keys {listed(list(dict.fromkeys(keys)))}" if keys else "no message"
    raise DocumentError(name, got if found else NOTHING, CONTENT)


def _documents(data: bytes, name: str) -> list[tuple[Lines, Any]]:
    """The documents of a file, with lines where it is YAML. JSON may have one document, or one on each line."""
    if len(data) > MAX_JSON_BYTES:
        raise DocumentError(name, f"{len(data)} bytes", f"at most {MAX_JSON_BYTES} bytes of YAML or JSON")
    if LOST in data:
        line = data[: data.index(LOST)].count(b"\n") + 1
        raise DocumentError(name, LOST.decode(), "a record without lost messages", line)
    try:
        if data.lstrip()[:1] not in (b"{", b"["):
            return [(lines, document) for document, lines in parse_documents(data, limit_bytes=MAX_JSON_BYTES)]
        rows = [row for row in data.splitlines() if row.strip()]
        if len(rows) > 1 and all(row.startswith(b"{") and row.rstrip().endswith(b"}") for row in rows):
            return [({}, parse_json(row)) for row in rows]
        return [({}, parse_json(data))]
    except InputError as error:  # readers of text call what they read by other names
        field = name if error.field in (WHOLE, SCENARIO) else error.field
        raise DocumentError(field, error.value, error.allowed, getattr(error, "line", None)) from None


def _within(lines: Lines, document: Any) -> Iterator[_Place]:
    """Every mapping of a document but those in `points`, in the order of the text."""
    waiting: list[tuple[Path, Any]] = [((), document)]
    while waiting:
        path, value = waiting.pop()
        if isinstance(value, dict):
            yield _Place(lines, path, value)
            waiting.extend(((*path, key), item) for key, item in reversed(value.items()) if key != "points")
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            waiting.extend(((*path, i), item) for i, item in reversed(list(enumerate(value))))


def _is_trajectory(value: dict[str, Any]) -> bool:
    """Whether a mapping is meant as a trajectory; the one of joints with several axes that a RobotTrajectory has as
    well is mostly empty."""
    return "points" in value and not (value.get("points") == [] and value.get("joint_names", []) == [])


def _names(place: _Place, key: str) -> list[str]:
    names = place.value.get(key, NOTHING)
    if not (isinstance(names, list) and all(isinstance(each, str) for each in names)):
        keys = f"nothing, of the keys {listed(place.value)}" if names is NOTHING else names
        raise place.wrong(keys, "a list of names of joints", *([key] if names is not NOTHING else ["joint_names"]))
    if not 1 <= len(names) <= MAX_JOINTS or len(set(names)) < len(names):
        raise place.wrong(listed(names), f"1 to {MAX_JOINTS} names, each once", key)
    return names


def _trajectory(place: _Place, most_rows: int, documents: list[Any]) -> Motion:
    names = _names(place, "joint_names")
    points = place.value["points"]
    if not (isinstance(points, list) and 2 <= len(points) <= most_rows):
        shown = f"{len(points)} points" if isinstance(points, list) else points
        raise place.wrong(shown, f"a list of 2 to {most_rows} points", "points")
    kept = [order for order in range(3) if order == 0 or any(_row(point, order) for point in points)]
    states = {order: np.empty((len(points), len(names))) for order in kept}
    times: list[Decimal] = []
    for k, point in enumerate(points):
        if not isinstance(point, dict):
            cut = point == "..."
            shown = "'...', where the message was cut" if cut else point
            allowed = (
                "every point: ros2 topic echo --full-length" if cut else f"{', '.join(STATES)} and time_from_start"
            )
            raise place.wrong(shown, allowed, "points", k)
        if "transforms" in point:
            raise place.wrong("transforms", "points of joints with one axis", "points", k)
        for order, rows in states.items():
            rows[k] = _numbers(
                place, point.get(STATES[order], NOTHING), len(names), order, ("points", k, STATES[order])
            )
        times.append(_since(place, point.get("time_from_start", NOTHING), ("points", k, "time_from_start")))
    time = _seconds(times, [place.field("points", k, "time_from_start") for k in range(len(points))])[0]
    tracks = tuple(
        Track(each, None, (states[0][:, i], *(states[order][:, i] if order in states else None for order in (1, 2))))  # type: ignore[arg-type]
        for i, each in enumerate(names)
    )

    def where(k: int, order: int, joint: int) -> tuple[str, int | None]:
        if order == TIME:
            return place.field("points", k, "time_from_start")
        whole = order not in states
        return place.field("points", k, STATES[order]) if whole else place.field("points", k, STATES[order], joint)

    return Motion(time, tracks, where, place.field("joint_names"), notes=tuple(_not_read(place, points, documents)))


def _row(point: Any, order: int) -> bool:
    """Whether a point has a state; ROS writes an empty list where it has not."""
    return isinstance(point, dict) and point.get(STATES[order], []) not in ([], None)


def _numbers(place: _Place, row: Any, count: int, order: int, at: Path) -> FloatArray:
    if not isinstance(row, list) or len(row) != count:
        shown = f"{len(row)} numbers" if isinstance(row, list) else row
        raise place.wrong(shown, f"{count} numbers, one for each joint", *at)
    most = largest(None, order)
    for i, value in enumerate(row):
        if not _number(value) or not abs(value) <= most:
            raise place.wrong(value, f"a number from -{most:g} to {most:g}", *at, i)
    return np.array(row, dtype=np.float64)


def _since(place: _Place, given: Any, at: Path) -> Decimal:
    """Nanoseconds of a time or a duration."""
    keys = list(given) if isinstance(given, dict) else []
    own = [[key for key in keys if key in words] for words in (SECONDS, NANOSECONDS)]
    numbers = [given[key] for key in keys]
    right = 0 < len(keys) == sum(map(len, own)) and all(len(each) <= 1 for each in own)
    if not right or not all(isinstance(each, int) and not isinstance(each, bool) for each in numbers):
        shown = "{" + ", ".join(f"{key}: {given[key]}" for key in keys) + "}" if keys else given
        raise place.wrong(shown, "sec and nanosec (or secs and nsecs), whole numbers", *at)
    sec, nanosec = (given[each[0]] if each else 0 for each in own)
    if not (sec >= 0 and 0 <= nanosec < 10**9):
        allowed = f"sec from 0 to {LONG_S:g}, nanosec from 0 to 999999999"
        raise place.wrong(f"{{sec: {sec}, nanosec: {nanosec}}}", allowed, *at)
    return Decimal(sec) * 10**9 + nanosec


def _seconds(times: list[Decimal], where: list[tuple[str, int | None]]) -> tuple[FloatArray, str | None]:
    return seconds(times, "ns", where)


def _joint_states(places: list[_Place], name: str, most_rows: int) -> Motion:
    """The motion that a row of JointState messages records; those of other joints in between are refused."""
    if len(places) > most_rows:
        raise DocumentError(name, f"{len(places)} messages", f"at most {most_rows} messages")
    first = _names(places[0], "name")
    positions = np.empty((len(places), len(first)))
    times: list[Decimal] = []
    for k, place in enumerate(places):
        own = _names(place, "name")
        if sorted(own) != sorted(first):
            raise place.wrong(listed(own), f"the joints of the first message: {listed(first)}", "name")
        row = _numbers(place, place.value["position"], len(own), 0, ("position",))
        positions[k] = row[[own.index(each) for each in first]]
        header = place.value.get("header")
        stamp = header.get("stamp", NOTHING) if isinstance(header, dict) else NOTHING
        times.append(_since(place, stamp, ("header", "stamp")))
    time, begin = _seconds(times, [place.field("header", "stamp") for place in places])

    def where(k: int, order: int, joint: int) -> tuple[str, int | None]:
        return places[k].field("header", "stamp") if order == TIME else places[k].field("position", joint)

    notes = [f"{len(places)} JointState messages; only their positions are read"]
    if begin is not None:
        notes.append(f"times count from the first message, {begin} s")
    tracks = tuple(Track(each, None, (positions[:, i], None, None)) for i, each in enumerate(first))
    return Motion(time, tracks, where, places[0].field("name"), relative=begin is not None, notes=tuple(notes))


def _not_read(place: _Place, points: list[Any], documents: list[Any]) -> Iterator[str]:
    """Sentences about what a file holds besides a trajectory that is read, where it is not empty or 0."""
    if place.path:
        yield f"the trajectory is in the field {dotted(place.path)}"
    header = place.value.get("header")
    stamp = header.get("stamp") if isinstance(header, dict) else None
    if isinstance(stamp, dict) and any(stamp.values()):
        stamped = ", ".join(f"{key}: {value}" for key, value in stamp.items())
        yield f"header.stamp ({stamped}) is not used: the motion begins when the request does, or at start_s"
    around: set[str] = set()
    for document in documents:
        value: Any = document
        for key in (*place.path, None):
            if isinstance(value, dict):
                around |= {each for each, item in value.items() if each != key and not _empty(item)}
            value = _below(value, key)
    around |= {key for point in points for key, item in point.items() if not _empty(item)}
    unread = sorted(around - set(KNOWN))
    if unread:
        yield f"fields that are not used: {', '.join(unread)}"


def _below(value: Any, key: str | int | None) -> Any:
    if isinstance(value, dict):
        return value.get(key)
    return value[key] if isinstance(value, list) and isinstance(key, int) and key < len(value) else None


def _empty(value: Any) -> bool:
    """Whether a value says nothing: 0, an empty text or list, or mappings and lists of such."""
    if isinstance(value, dict):
        return all(_empty(item) for item in value.values())
    if isinstance(value, list):
        return all(_empty(item) for item in value)
    return value in (None, "", 0)


def _number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
