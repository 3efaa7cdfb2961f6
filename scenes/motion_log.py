"""Recorded motion in CSV files: a column of times and a column of positions for each joint, each with its unit in its
name, as keys of documents have it (`t_ms`, `j1_deg`, `j3_mm`)."""

from __future__ import annotations

import csv
import io
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from assur.planner.arrays import FloatArray
from assur.scenes.bounds import FAR_M, LONG_S, MAX_JOINTS, MAX_LOG_BYTES, MAX_LOG_ROWS, TURNS_RAD
from assur.scenes.faults import NOTHING, DocumentError
from assur.scenes.text.scalars import LONGEST_SHOWN
from assur.scenes.units import si_key, to_si

COLUMN = re.compile(r"(?:t_(?:s|ms)|(?!t_)[A-Za-z][A-Za-z0-9]{0,15}_(?:rad|deg|m|mm))")
NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?")
LARGEST = {"s": LONG_S, "rad": TURNS_RAD, "m": FAR_M}
HEADER = "a header: t_s or t_ms, and each joint's name with its unit (j1_deg, j1_rad, j3_mm or j3_m)"


@dataclass(frozen=True, eq=False)
class LoggedJoint:
    """A joint of a log: its name, the SI unit of its positions, and these (n,)."""

    name: str
    unit: str
    position: FloatArray


@dataclass(frozen=True, eq=False)
class MotionLog:
    """A log: the name of its file, times (n,) in s from its first row, and its joints."""

    name: str
    time: FloatArray
    joints: tuple[LoggedJoint, ...]


@dataclass(frozen=True, slots=True)
class _Column:
    """A column as it is called; what it is of (`t`, or a joint), its SI unit, and the unit it is written in if that is
    another."""

    title: str
    of: str
    unit: str
    twin: str | None


def load_log(path: Path) -> MotionLog:
    """The log in a file. Raises `DocumentError` with the file's name, column and line, or `OSError`."""
    with path.open("rb") as file:
        return parse_log(file.read(MAX_LOG_BYTES + 1), path.name)


def parse_log(data: bytes, name: str) -> MotionLog:
    """The log that `data` spells, of the file called `name`. Raises `DocumentError`."""
    if len(data) > MAX_LOG_BYTES:
        raise DocumentError(name, f"more than {MAX_LOG_BYTES} bytes", f"at most {MAX_LOG_BYTES} bytes")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise DocumentError(name, f"byte {error.start} of the file", "text in UTF-8") from None
    if "\0" in text:
        raise DocumentError(name, "a null character", "text in UTF-8", text.count("\n", 0, text.index("\0")) + 1)
    reader = csv.reader(io.StringIO(text, newline=""), strict=True)
    columns: list[_Column] = []
    rows: list[list[float]] = []
    try:
        for cells in reader:
            if not columns:
                columns = _header([cell.strip() for cell in cells], name)
            elif len(rows) == MAX_LOG_ROWS:
                raise DocumentError(name, "one more row", f"at most {MAX_LOG_ROWS} rows", reader.line_num)
            else:
                rows.append(_row(cells, columns, name, reader.line_num))
    except csv.Error as error:
        raise DocumentError(name, str(error), "comma-separated values", reader.line_num) from None
    if not columns:
        raise DocumentError(name, NOTHING, HEADER, 1)
    return _log(np.array(rows, dtype=np.float64).reshape(-1, len(columns)), columns, name)


def _header(titles: list[str], name: str) -> list[_Column]:
    """The columns, each of which is known and there once."""
    if all(title == "" or NUMBER.fullmatch(title) for title in titles):
        raise DocumentError(name, ",".join(titles)[:LONGEST_SHOWN] or NOTHING, HEADER, 1)
    columns: list[_Column] = []
    for title in titles:
        if COLUMN.fullmatch(title) is None:
            raise DocumentError(f"{name}: column", title, f"{HEADER}, and no other columns", 1)
        of, _, written = title.rpartition("_")
        twin = si_key(title)
        if any(of == column.of for column in columns):
            raise DocumentError(f"{name}: column", title, f"one column for {of}", 1)
        columns.append(_Column(title, of, written if twin is None else twin[0].rpartition("_")[2], twin and written))
    if "t" not in [column.of for column in columns]:
        raise DocumentError(f"{name}: column", NOTHING, "t_s or t_ms", 1)
    if not 1 <= len(columns) - 1 <= MAX_JOINTS:
        raise DocumentError(name, f"{len(columns) - 1} joints", f"columns of 1 to {MAX_JOINTS} joints", 1)
    return columns


def _row(cells: list[str], columns: list[_Column], name: str, line: int) -> list[float]:
    """The numbers of a row in SI."""
    if len(cells) != len(columns):
        raise DocumentError(name, f"{len(cells)} values", f"{len(columns)} values, one for each column", line)
    row = []
    for cell, column in zip(cells, columns, strict=True):
        if NUMBER.fullmatch(cell.strip()) is None:
            raise DocumentError(f"{name}: {column.title}", cell, "a number", line)
        value = float(cell)
        if column.twin is not None:
            value = float(to_si(value, column.twin))  # type: ignore[arg-type]
        largest = LARGEST[column.unit]
        if not abs(value) <= largest:
            raise DocumentError(
                f"{name}: {column.title}", cell, f"from -{largest:g} to {largest:g} {column.unit}", line
            )
        row.append(value)
    return row


def _log(rows: FloatArray, columns: list[_Column], name: str) -> MotionLog:
    from assur.planner.identification import fault_of_times

    at = [column.of for column in columns].index("t")
    time = rows[:, at]
    fault = fault_of_times(time)
    if fault is not None:
        row, allowed = fault
        value = float(time[row]) if len(time) else NOTHING
        raise DocumentError(f"{name}: {columns[at].title} in s", value, allowed, row + 2)  # the header is line 1
    joints = [LoggedJoint(c.of, c.unit, rows[:, i]) for i, c in enumerate(columns) if i != at]
    return MotionLog(name, time - time[0], tuple(joints))
