"""Trajectories in files of others: CSV as our exports have it, and `trajectory_msgs/JointTrajectory` of ROS 2.

A point has positions, velocities and accelerations, and the motion between two points is the quintic through them. A
file without accelerations says nothing of what its controller does between its points, and is refused.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.scenes.bounds import (
    FAR_M,
    LONG_S,
    MAX_JSON_BYTES,
    MAX_KNOTS,
    MAX_LINES,
    MAX_LOG_BYTES,
    MAX_ROW_CHARACTERS,
    SHORTEST_STEP_S,
    STRONG,
    TURNS_RAD,
)
from assur.scenes.conventions import Conventions, JointConvention, converted, converted_rates
from assur.scenes.faults import NOTHING, WHOLE, DocumentError
from assur.scenes.motion_log import NUMBER
from assur.scenes.reading.neighbours import crowded
from assur.scenes.text.json_text import parse_json
from assur.scenes.text.scalars import LONGEST_SHOWN
from assur.scenes.text.yaml_text import Lines, parse_yaml
from assur.scenes.units import si_key, to_si, twin_of

if TYPE_CHECKING:
    from assur.planner.trajectory import Trajectory

RATES = ("", "_s", "_s2")
"""What follows rad or m in the units of positions, velocities and accelerations."""
STATES = ("positions", "velocities", "accelerations")
FILE = "file"
"""What errors call the file."""
SCENARIO = "scenario"
"""What the reader of YAML calls it."""


def trajectory_from(data: bytes, form: str, conventions: Conventions, start_s: float, *, jumps: bool) -> Trajectory:
    """The trajectory in a file; `form`: csv or ros2. `start_s`: the cell's clock at the start of a ROS trajectory;
    times in CSV are those of the cell's clock. `jumps`: whether two points may be at one time (parabolic blends).

    Raises `DocumentError` with the line, or the field of a message.
    """
    from assur.planner.trajectory import Trajectory

    if form == "csv":
        time, states, lines = _csv(data, conventions)
        places: list[tuple[str, int | None]] = [(f"{FILE}: time_s", line) for line in lines]
    else:
        time, states, places = _ros2(data, conventions)
        time = start_s + time
    if len(time) < 2:
        raise DocumentError(FILE, f"{len(time)} points", "at least two points")
    k = crowded(time, jumps=jumps)
    if k is not None:
        allowed = f"a time later than {time[k - 1]:.9g} s, that of the point before, by {SHORTEST_STEP_S:g} s at least"
        raise DocumentError(places[k][0], float(time[k]), allowed, places[k][1])
    q, qd, qdd = converted(states[0], conventions), *(converted_rates(each, conventions) for each in states[1:])
    try:
        return Trajectory(time, q, qd, qdd, jumps=jumps)
    except InputError as error:
        raise DocumentError(FILE, error.value, error.allowed) from error


def _lines(text: str) -> Iterator[str]:
    """The lines of a text. Raises `DocumentError` at one that is too long: it is refused before it is taken apart.
    Likewise where there are too many."""
    for number, line in enumerate(io.StringIO(text, newline=""), start=1):
        if len(line) > MAX_ROW_CHARACTERS:
            allowed = f"lines of up to {MAX_ROW_CHARACTERS} characters"
            raise DocumentError(FILE, f"a line of {len(line)} characters", allowed, number)
        if number > MAX_LINES:
            raise DocumentError(FILE, "one more line", f"at most {MAX_LINES} lines", number)
        yield line


def _largest(joint: JointConvention, rate: int) -> float:
    return (TURNS_RAD if joint.unit == "rad" else FAR_M) if rate == 0 else STRONG


def _csv(data: bytes, conventions: Conventions) -> tuple[FloatArray, FloatArray, list[int]]:
    """Times (K,), states (3, K, n) as the maker counts, and the line of each row."""
    if len(data) > MAX_LOG_BYTES:
        raise DocumentError(FILE, f"more than {MAX_LOG_BYTES} bytes", f"at most {MAX_LOG_BYTES} bytes")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise DocumentError(FILE, f"byte {error.start} of the file", "text in UTF-8", line) from None
    if "\0" in text:
        raise DocumentError(FILE, "a null character", "text", text.count("\n", 0, text.index("\0")) + 1)
    reader = csv.reader(_lines(text), strict=True)
    where: list[tuple[int, int, str | None, float, str]] | None = None
    rows: list[list[float]] = []
    lines: list[int] = []
    line = 0
    try:
        for cells in reader:
            if reader.line_num > line + 1:
                raise DocumentError(FILE, "a row over several lines", "each row on one line", line + 1)
            line = reader.line_num
            if not cells or cells[0].lstrip().startswith("#"):
                continue
            if where is None:
                where = _header([cell.strip() for cell in cells], conventions, reader.line_num)
            elif len(rows) == MAX_KNOTS:
                raise DocumentError(FILE, "one more row", f"at most {MAX_KNOTS} rows", reader.line_num)
            else:
                rows.append(_row(cells, where, reader.line_num))
                lines.append(reader.line_num)
    except csv.Error as error:
        raise DocumentError(FILE, str(error), "comma-separated values", reader.line_num) from None
    if where is None:
        raise DocumentError(FILE, NOTHING, _columns(conventions), 1)
    table = np.array(rows, dtype=np.float64).reshape(-1, len(where))
    time, states = np.empty(len(table)), np.empty((3, len(table), len(conventions)))
    for column, (rate, joint, *_) in enumerate(where):
        if rate < 0:
            time = table[:, column]
        else:
            states[rate, :, joint] = table[:, column]
    return time, states, lines


def _columns(conventions: Conventions) -> str:
    first = conventions[0]
    names = ", ".join(f"{first.name}_{first.unit}{rate}" for rate in RATES)
    joints = ", ".join(joint.name for joint in conventions)
    return f"a header with time_s and, of each joint ({joints}), three columns as in {names} (or in deg, mm)"


def _header(titles: list[str], conventions: Conventions, line: int) -> list[tuple[int, int, str | None, float, str]]:
    """Of each column: which state it is of (-1: the time), of which joint, its unit if that is not SI, the largest
    value in SI, and its title."""
    known = {f"{joint.name}_{joint.unit}{rate}": (r, i) for i, joint in enumerate(conventions)
             for r, rate in enumerate(RATES)}  # fmt: skip
    known["time_s"] = (-1, 0)
    found: list[tuple[int, int, str | None, float, str]] = []
    taken: set[str] = set()
    for title in titles:
        twin = si_key(title)
        key = title if twin is None else twin[0]
        if key not in known:
            raise DocumentError(f"{FILE}: column", title[:LONGEST_SHOWN], _columns(conventions), line)
        if key in taken:
            raise DocumentError(f"{FILE}: column", title, f"one column for {key} or {twin_of(key)}", line)
        taken.add(key)
        rate, joint = known[key]
        largest = LONG_S if rate < 0 else _largest(conventions[joint], rate)
        found.append((rate, joint, None if twin is None else twin[1], largest, title))
    for key in known:
        if key not in taken:
            allowed = f"a column {key} or {twin_of(key)}: the motion between points is the quintic through all three"
            raise DocumentError(f"{FILE}: column", NOTHING, allowed, line)
    return found


def _row(cells: list[str], where: list[tuple[int, int, str | None, float, str]], line: int) -> list[float]:
    if len(cells) != len(where):
        raise DocumentError(FILE, f"{len(cells)} values", f"{len(where)} values, one for each column", line)
    row = []
    for cell, (_, _, twin, largest, title) in zip(cells, where, strict=True):
        if NUMBER.fullmatch(cell.strip()) is None:
            raise DocumentError(f"{FILE}: {title}", cell[:LONGEST_SHOWN], "a finite number", line)
        value = float(cell)
        if twin is not None:
            value = float(to_si(value, twin))  # type: ignore[arg-type]
        if not abs(value) <= largest:
            raise DocumentError(f"{FILE}: {title}", cell, f"from -{largest:g} to {largest:g} in SI", line)
        row.append(value)
    return row


def _ros2(data: bytes, conventions: Conventions) -> tuple[FloatArray, FloatArray, list[tuple[str, int | None]]]:
    """Times (K,) since the start, states (3, K, n) as the maker counts, and where the time of each point is."""
    lines: Lines = {}
    if len(data) > MAX_JSON_BYTES:
        raise DocumentError(FILE, f"{len(data)} bytes", f"at most {MAX_JSON_BYTES} bytes of YAML or JSON")
    try:
        if data.lstrip()[:1] in (b"{", b"["):
            message = parse_json(data)
        else:
            message, lines = parse_yaml(data, limit_bytes=MAX_JSON_BYTES)
    except InputError as error:  # readers of text call what they read by other names
        field = FILE if error.field in (WHOLE, SCENARIO) else error.field
        raise DocumentError(field, error.value, error.allowed, getattr(error, "line", None)) from None
    names = [joint.name for joint in conventions]

    def wrong(field: str, value: object, allowed: str) -> DocumentError:
        return DocumentError(field, value, allowed, lines.get(field))

    if not isinstance(message, dict):
        raise wrong(FILE, NOTHING if message is None else message, "a trajectory_msgs/JointTrajectory")
    given = message.get("joint_names", NOTHING)
    if not isinstance(given, list) or sorted(map(str, given)) != sorted(names):
        raise wrong("joint_names", given, f"the robot's joints, each once: {', '.join(names)}")
    order = [given.index(name) for name in names]
    points = message.get("points", NOTHING)
    if not (isinstance(points, list) and 2 <= len(points) <= MAX_KNOTS):
        raise wrong("points", points, f"a list of 2 to {MAX_KNOTS} points")
    time, states = np.empty(len(points)), np.empty((3, len(points), len(names)))
    places: list[tuple[str, int | None]] = []
    for k, point in enumerate(points):
        at = f"points[{k}]"
        if not isinstance(point, dict):
            raise wrong(at, point, f"an object with {', '.join(STATES)} and time_from_start")
        for rate, key in enumerate(STATES):
            row = point.get(key, NOTHING)
            if not isinstance(row, list) or len(row) != len(names):
                raise wrong(f"{at}.{key}", row, f"{len(names)} numbers, one for each joint")
            for i, value in enumerate(row):
                largest = _largest(conventions[names.index(given[i])], rate)
                if not _number(value) or not abs(value) <= largest:
                    raise wrong(f"{at}.{key}[{i}]", value, f"a number from -{largest:g} to {largest:g}")
            states[rate, k] = [row[i] for i in order]
        time[k] = _since(point.get("time_from_start", NOTHING), f"{at}.time_from_start", wrong)
        if k == 0 and time[0] > 0.0:
            allowed = "0 s at the first point: before a later one the controller would add a motion of its own"
            raise wrong(f"{at}.time_from_start", point["time_from_start"], allowed)
        places.append((f"{at}.time_from_start", lines.get(f"{at}.time_from_start")))
    return time, states, places


def _since(given: Any, field: str, wrong: Any) -> float:
    whole = isinstance(given, dict) and given.keys() <= {"sec", "nanosec"}
    numbers = [given.get("sec", 0), given.get("nanosec", 0)] if whole else []
    if not numbers or not all(isinstance(each, int) and not isinstance(each, bool) for each in numbers):
        raise wrong(field, given, "sec and nanosec, whole numbers")
    sec, nanosec = numbers
    if not (0 <= sec <= LONG_S and 0 <= nanosec < 10**9):
        raise wrong(field, given, f"sec from 0 to {LONG_S:g}, nanosec from 0 to 999999999")
    return float(sec + nanosec * 1e-9)


def _number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
