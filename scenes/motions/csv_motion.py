"""Motion in CSV files as loggers and spreadsheets write them: comma, semicolon or tab; empty lines and those that begin
with `#` or `//` are skipped; the titles may be in the last comment before the numbers."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal

import numpy as np

from assur.scenes.bounds import LINES_A_ROW, MAX_JOINTS, MAX_LOG_BYTES, MAX_ROW_CHARACTERS
from assur.scenes.faults import NOTHING, DocumentError
from assur.scenes.motions.motion import (
    ACCELERATION,
    POSITION,
    STATES,
    TIME,
    VELOCITY,
    Motion,
    Track,
    largest,
    seconds,
    unit_of_calendar,
)
from assur.scenes.text.scalars import LONGEST_SHOWN
from assur.scenes.units import any_unit, si_key, to_si, twin_of

NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?")
DECIMAL_COMMA = re.compile(r"[+-]?[0-9]*,[0-9]+(?:[eE][+-]?[0-9]{1,3})?")
SEPARATOR_LINE = re.compile(r"sep=[,;\t]", re.IGNORECASE)
"""A first line by which spreadsheets state their separator."""
COMMENTS = ("#", "//")
UTF_16 = (b"\xff\xfe", b"\xfe\xff")
Row = tuple[int, list[str]]
"""A line's number and its cells."""


def csv_motion(data: bytes, name: str, most_rows: int) -> Motion:
    """The motion in a CSV file of up to `most_rows` rows that errors call `name`. Raises `DocumentError`."""
    header, rows = _table(_text(data, name), name, most_rows)
    if header is None:
        raise DocumentError(name, NOTHING, HEADER, 1)
    line, titles = header
    columns = columns_of(titles, [cells for _, cells in rows], name, line)
    count, used = len(titles), [(column, column.place) for column in columns.states]
    numbers = np.empty((len(rows), len(used)))
    for k, (number, cells) in enumerate(rows):
        if len(cells) != count:
            hint = "; numbers with a decimal comma are not read" if len(cells) > count else ""
            allowed = f"{count} values, one for each column{hint}"
            raise DocumentError(name, f"{len(cells)} values", allowed, number)
        numbers[k] = [_value(cells[place], column, name, number) for column, place in used]
    names = _names(columns, rows, name)
    time, first, notes = _times(columns, titles, rows, name)
    joints = list(dict.fromkeys(column.joint for column in columns.states))

    def states(joint: str | int) -> Track:
        own = {column.order: i for i, column in enumerate(columns.states) if column.joint == joint}
        unit = next(column.unit for column in columns.states if column.joint == joint)
        position, velocity, acceleration = (numbers[:, own[order]] if order in own else None for order in range(3))
        return Track(names[joint], unit, (position, velocity, acceleration))

    def where(k: int, order: int, joint: int) -> tuple[str, int | None]:
        at = rows[k][0] if 0 <= k < len(rows) else line
        if order == TIME:
            return f"{name}: {titles[columns.clock[0][0]]}", at
        title = [each.title for each in columns.states if (each.joint, each.order) == (joints[joint], order)]
        return (f"{name}: {title[0]}", at) if title else (f"{name}: column", line)

    if columns.unused:
        notes.append(f"columns that are not used: {', '.join(columns.unused)}")
    tracks = tuple(states(joint) for joint in joints)
    return Motion(time, tracks, where, (f"{name}: column", line), relative=first is not None, notes=tuple(notes))


def _text(data: bytes, name: str) -> str:
    if len(data) > MAX_LOG_BYTES:
        raise DocumentError(name, f"more than {MAX_LOG_BYTES} bytes", f"at most {MAX_LOG_BYTES} bytes")
    if data[:2] in UTF_16:
        raise DocumentError(name, "text in UTF-16", "text in UTF-8: save the file in it", 1)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise DocumentError(name, f"byte {error.start} of the file", "text in UTF-8", line) from None
    if "\0" in text:
        raise DocumentError(name, "a null character", "text in UTF-8", text.count("\n", 0, text.index("\0")) + 1)
    return text


def _lines(text: str, name: str, most: int) -> Iterator[tuple[int, str]]:
    """The lines of a text with their numbers. Raises `DocumentError` at one that is too long, before it is taken apart,
    and where there are too many."""
    for number, line in enumerate(io.StringIO(text), start=1):
        if len(line) > MAX_ROW_CHARACTERS:
            allowed = f"lines of up to {MAX_ROW_CHARACTERS} characters"
            raise DocumentError(name, f"a line of {len(line)} characters", allowed, number)
        if number > most:
            raise DocumentError(name, "one more line", f"at most {most} lines", number)
        yield number, line.rstrip("\r\n")


def _table(text: str, name: str, most_rows: int) -> tuple[Row | None, list[Row]]:
    """The header, None if there is none, and the rows behind it."""
    header: Row | None = None
    comment: tuple[int, str] | None = None
    separator, rows = ",", list[Row]()
    for number, line in _lines(text, name, LINES_A_ROW * most_rows):
        bare = line.strip()
        if bare.startswith(COMMENTS):
            comment = number, bare.lstrip("#/ \t") if header is None else ""
        elif bare == "" or (header is None and SEPARATOR_LINE.fullmatch(bare)):
            continue
        elif header is None:
            separator = _separator(bare)
            header = number, _cells(line, separator, name, number)
            if _numeric(header[1]):
                rows.append(header)
                header = _commented(comment, separator, name)
                if header is None:
                    raise DocumentError(name, ",".join(rows[0][1])[:LONGEST_SHOWN], HEADER, number)
        else:
            cells = _cells(line, separator, name, number)
            if any(cells):
                if len(rows) == most_rows:
                    raise DocumentError(name, "one more row", f"at most {most_rows} rows", number)
                rows.append((number, cells))
    if header is not None and len(header[1]) > 1 and header[1][-1] == "":  # each line ends with a separator
        width = len(header[1])
        header = header[0], header[1][:-1]
        rows = [(k, row[:-1] if len(row) == width and row[-1] == "" else row) for k, row in rows]
    return header, rows


def _numeric(cells: list[str]) -> bool:
    return all(cell == "" or NUMBER.fullmatch(cell) or DECIMAL_COMMA.fullmatch(cell) for cell in cells)


def _commented(comment: tuple[int, str] | None, separator: str, name: str) -> Row | None:
    """The titles that a comment before the first numbers has; None if it has none."""
    if comment is None or separator not in comment[1]:
        return None
    cells = _cells(comment[1], separator, name, comment[0])
    return None if _numeric(cells) else (comment[0], cells)


def _separator(line: str) -> str:
    return next((separator for separator in (";", "\t") if separator in line), ",")


def _cells(line: str, separator: str, name: str, number: int) -> list[str]:
    if '"' not in line:
        return [cell.strip() for cell in line.split(separator)]
    try:
        (row,) = csv.reader([line], delimiter=separator, strict=True, skipinitialspace=True)
    except csv.Error as error:
        message = str(error)
        allowed = "comma-separated values, each row on one line, with quotes that are closed"
        raise DocumentError(name, message, allowed, number) from None
    return [cell.strip() for cell in row]


def _value(cell: str, column: Column, name: str, line: int) -> float:
    if NUMBER.fullmatch(cell) is None:
        raise _no_number(cell, f"{name}: {column.title}", line)
    value = float(cell)
    if column.twin is not None:
        value = float(to_si(value, column.twin))  # type: ignore[arg-type]
    most = largest(column.unit, column.order)
    if not abs(value) <= most:
        unit = f"{column.unit or 'in SI'}{('', '/s', '/s²')[column.order]}"
        raise DocumentError(f"{name}: {column.title}", cell[:LONGEST_SHOWN], f"from -{most:g} to {most:g} {unit}", line)
    return value


def _no_number(cell: str, field: str, line: int) -> DocumentError:
    allowed = "a finite number"
    if DECIMAL_COMMA.fullmatch(cell):
        allowed += " with a decimal point; this one has a decimal comma"
    return DocumentError(field, cell[:LONGEST_SHOWN], allowed, line)


def _names(columns: Columns, rows: list[Row], name: str) -> dict[str | int, str]:
    """The name of each joint, as columns call it: its own, or what is in the column of names, the same in each row."""
    found: dict[str | int, str] = {}
    for column in columns.states:
        if isinstance(column.joint, str):
            found[column.joint] = column.joint
            continue
        place = columns.names[column.joint]
        found[column.joint] = rows[0][1][place] if rows else str(column.joint)
        for number, cells in rows:
            if cells[place] != found[column.joint] or cells[place] == "":
                allowed = f"the name of one joint in each row: {found[column.joint] or 'none'} is in the first"
                raise DocumentError(f"{name}: column {place + 1}", cells[place][:LONGEST_SHOWN], allowed, number)
    if len(set(found.values())) < len(found):
        raise DocumentError(f"{name}: names", ", ".join(found.values()), "a name for each joint")
    return found


def _times(columns: Columns, titles: list[str], rows: list[Row], name: str) -> tuple[np.ndarray, str | None, list[str]]:
    """Times in s (from the first on where that is a time of the calendar), this first time, and notes."""
    (place, unit), field = columns.clock[0], f"{name}: {titles[columns.clock[0][0]]}"
    values: list[Decimal] = []
    for number, cells in rows:
        for each, _ in columns.clock:
            if NUMBER.fullmatch(cells[each]) is None:
                raise _no_number(cells[each], f"{name}: {titles[each]}", number)
        value = Decimal(cells[place])
        if len(columns.clock) > 1:
            nanoseconds = Decimal(cells[columns.clock[1][0]])
            if not 0 <= nanoseconds < 10**9:
                shown = f"{name}: {titles[columns.clock[1][0]]}"
                raise DocumentError(shown, str(nanoseconds)[:LONGEST_SHOWN], "from 0 to 999999999", number)
            value += nanoseconds.scaleb(-9)
        values.append(value)
    if unit is None:
        unit = unit_of_calendar(values[0]) if values else "s"
    if unit is None:
        allowed = "a unit in the title: time_s, time_ms, time_us or time_ns"
        raise DocumentError(field, f"a time of {values[0]} without a unit", allowed, rows[0][0])
    time, first = seconds(values, unit, [(field, number) for number, _ in rows])
    return time, first, [] if first is None else [f"times count from the first row, {first} s"]


# What the columns of a CSV file are, by their titles.
#
# Read are titles as our own files have them (`t_s`, `time_ms`, `j1_deg`, `j1_deg_s`, also `j1 [deg/s]`), and those that
# programs write of recorded ROS messages: `/joint_states/j1/position`, `field.position0` with `field.name0`, `__time`,
# `%time`, `header.stamp.sec` with `header.stamp.nanosec`.

HEADER = (
    "a header with time_s (or time_ms, time_us, time_ns, t_s, t_ms ...), and each joint's name with its unit (j1_deg, "
    "j1_rad, j3_mm or j3_m; speeds j1_deg_s, accelerations j1_deg_s2)"
)
NAME = re.compile(r"[A-Za-z][A-Za-z0-9_./:-]{0,63}")
CLOCK = re.compile(r"(?:t|time|timestamp|stamp|__time|%time)(?:_(s|ms|us|ns))?", re.IGNORECASE)
OF_RECORDER = {"__time": "s", "%time": "ns"}
"""Titles of times that recorders write, and their units."""
BRACKETS = re.compile(r"(.*?)\s*[\[(]\s*([^\])]+?)\s*[\])]")
ORDERS = {"": POSITION, "_s": VELOCITY, "_s2": ACCELERATION}
"""What follows rad or m in a unit → the order of the state."""
KINDS = {"position": POSITION, "velocity": VELOCITY, "acceleration": ACCELERATION}
KINDS |= {state: order for order, state in enumerate(STATES)}
NUMBERED = re.compile(r"(?:.*[./])?(name|position|velocity|acceleration)s?[.\[_]?([0-9]{1,2})\]?")
SPLIT = re.compile(r"[/.]")
SECONDS, NANOSECONDS = ("sec", "secs"), ("nanosec", "nanosecs", "nsec", "nsecs")
NOT_USED = re.compile(r"(?:.*[./])?(?:seq|frame_id|header[./].*|effort.*|.*[./]effort)", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Column:
    """A column: its place in a row and its title; of a joint, its name (or the number of its name's column), the order
    of the state, its SI unit (None: not stated) and the unit that it is written in, where that is another."""

    place: int
    title: str
    joint: str | int
    order: int
    unit: str | None = None
    twin: str | None = None


@dataclass(frozen=True)
class Columns:
    """The columns of a file: those of its times, of the names of joints by number, of states, and the titles of those
    that are not used. `clock`: (place, unit) of each time column; unit None: not stated."""

    clock: tuple[tuple[int, str | None], ...]
    names: dict[int, int]
    states: tuple[Column, ...]
    unused: tuple[str, ...]


def columns_of(titles: list[str], rows: list[list[str]], name: str, line: int) -> Columns:
    """The columns of a header, with the cells of the rows behind it. Raises `DocumentError` at the column at fault."""
    clocks: list[tuple[int, str | None]] = []
    stamps: dict[str, int] = {}
    names: dict[int, int] = {}
    states: list[Column] = []
    unused: list[str] = []
    for place, title in enumerate(titles):
        key = _plain(title)
        numbered = NUMBERED.fullmatch(key)
        last = SPLIT.split(key)[-1]
        clock = CLOCK.fullmatch(key)
        if clock is not None:
            if clocks:
                raise DocumentError(f"{name}: column", title, "one column for t", line)
            clocks.append((place, clock[1].lower() if clock[1] else OF_RECORDER.get(key)))
        elif last in (*SECONDS, *NANOSECONDS, "stamp"):
            kind = "s" if last in SECONDS else "ns" if last in NANOSECONDS else "stamp"
            if stamps.setdefault(kind, place) != place:
                allowed = f"one stamp; {titles[stamps[kind]]} is of another: remove what does not count"
                raise DocumentError(f"{name}: column", title, allowed, line)
        elif numbered is not None and numbered[1] == "name":
            if names.setdefault(int(numbered[2]), place) != place:
                raise DocumentError(f"{name}: column", title, "one column of names for a number", line)
        elif (column := _state(place, title, key, numbered)) is not None:
            states.append(column)
        elif NOT_USED.fullmatch(key):
            unused.append(title)
        else:
            shown = title[:LONGEST_SHOWN] if len(title) > 2 * LONGEST_SHOWN else title
            raise DocumentError(f"{name}: column", shown, f"{HEADER}, and no other columns", line)
    _check_states(states, names, name, line)
    own, other = _clock(clocks, stamps, rows)
    if not own:
        raise DocumentError(f"{name}: column", NOTHING, f"a column of times: {HEADER}", line)
    return Columns(own, names, tuple(states), (*unused, *(titles[place] for place in other)))


def _plain(title: str) -> str:
    """A title with its unit behind an underscore: `j1 [deg/s^2]` → `j1_deg_s2`."""
    found = BRACKETS.fullmatch(title)
    if found is None:
        return title
    unit = found[2].replace("°", "deg").replace("²", "2").replace("µ", "u").replace("/", "_").replace("^", "")
    return f"{found[1]}_{unit}"


def _state(place: int, title: str, key: str, numbered: re.Match[str] | None) -> Column | None:
    """The column of a joint's state; None for another."""
    if numbered is not None:
        return Column(place, title, int(numbered[2]), KINDS[numbered[1]])
    parts = SPLIT.split(key)
    if len(parts) > 1 and parts[-1] in KINDS and NAME.fullmatch(parts[-2]):
        return Column(place, title, parts[-2], KINDS[parts[-1]])
    if len(parts) > 1 and parts[-2] in KINDS and NAME.fullmatch(parts[-1]) and any_unit(key) is None:
        return Column(place, title, parts[-1], KINDS[parts[-2]])
    twin, unit = si_key(key), any_unit(key)
    if unit is None:
        return None
    si = unit if twin is None else any_unit(twin[0])
    head, _, rate = str(si).partition("_")
    of, order = key[: -len(unit) - 1], ORDERS.get(f"_{rate}" if rate else "")
    if head not in ("rad", "m") or order is None or NAME.fullmatch(of) is None or CLOCK.fullmatch(of):
        return None
    return Column(place, title, of, order, head, None if twin is None else unit)


def _check_states(states: list[Column], names: dict[int, int], name: str, line: int) -> None:
    """Raises `DocumentError` unless each joint has one column of positions, one at most of each rate, in units of one
    kind, and a name."""
    seen: dict[tuple[str | int, int], Column] = {}
    for column in states:
        before = seen.setdefault((column.joint, column.order), column)
        if before is not column:
            si = f"{column.joint}_{column.unit}{('', '_s', '_s2')[column.order]}"
            both = f"{si} or {twin_of(si)}" if column.unit is not None and before.unit == column.unit else column.joint
            raise DocumentError(f"{name}: column", column.title, f"one column for {both}", line)
        if isinstance(column.joint, int) and column.joint not in names:
            allowed = "a column of the joint's name for each number (name0, position0), or the name in the title"
            raise DocumentError(f"{name}: column", column.title, allowed, line)
    joints = {column.joint: column for column in reversed(states)}
    for joint, column in joints.items():
        position = seen.get((joint, POSITION))
        if position is None:
            raise DocumentError(f"{name}: column", column.title, f"a column of the positions of {joint}, too", line)
        if any(seen[key].unit != position.unit for key in seen if key[0] == joint):
            raise DocumentError(f"{name}: column", column.title, f"rad or m in all columns of {joint}", line)
    if not 1 <= len(joints) <= MAX_JOINTS:
        raise DocumentError(name, f"{len(joints)} joints", f"columns of 1 to {MAX_JOINTS} joints: {HEADER}", line)


def _clock(
    clocks: list[tuple[int, str | None]], stamps: dict[str, int], rows: list[list[str]]
) -> tuple[tuple[tuple[int, str | None], ...], list[int]]:
    """The columns of times that count, and the places of those that do not: the stamp of a message counts before the
    time of its recorder, unless it was left 0 in every row."""
    found: tuple[tuple[int, str | None], ...] = ()
    if "s" in stamps and "ns" in stamps:
        found = ((stamps["s"], "s"), (stamps["ns"], "ns"))
    elif "stamp" in stamps:
        found = ((stamps["stamp"], None),)
    left_out = all(set(row[place]) <= set("0.") for row in rows for place, _ in found if place < len(row))
    if clocks and (not found or left_out):
        return tuple(clocks), [*stamps.values()]
    used = {place for place, _ in found}
    return found, [place for place in (*(each for each, _ in clocks), *stamps.values()) if place not in used]
