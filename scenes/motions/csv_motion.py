"""Motion in CSV files as loggers and spreadsheets write them: comma, semicolon or tab; empty lines and those that begin
with `#` or `//` are skipped; the titles may be in the last comment before the numbers."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator
from decimal import Decimal

import numpy as np

from assur.scenes.bounds import LINES_A_ROW, MAX_LOG_BYTES, MAX_ROW_CHARACTERS
from assur.scenes.faults import NOTHING, DocumentError
from assur.scenes.motions.clock import seconds, unit_of_calendar
from assur.scenes.motions.columns import HEADER, Column, Columns, columns_of
from assur.scenes.motions.motion import TIME, Motion, Track, largest
from assur.scenes.text.scalars import LONGEST_SHOWN
from assur.scenes.units import to_si

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
        said = str(error)
        allowed = "comma-separated values, each row on one line, with quotes that are closed"
        raise DocumentError(name, said, allowed, number) from None
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
    """Times in s (from the first on where that is a time of the calendar), this first time, and what is to be said."""
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
