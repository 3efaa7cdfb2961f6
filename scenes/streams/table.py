"""Tables of arrivals: a CSV file with a row for each part that comes."""

from __future__ import annotations

import csv
import io
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from assur.planner.errors import InputError
from assur.scenes import bounds
from assur.scenes.faults import Refused, dotted
from assur.scenes.files import below
from assur.scenes.schema.streams import ArrivalsDocument
from assur.scenes.units import si_key, to_si

NEEDED, POSSIBLE = ("time_s", "x_m", "y_m"), ("yaw_rad", "kind")
"""Columns that a table has, and may have, by their names in SI."""
TITLES = "time_s, x_mm, y_mm, and perhaps yaw_deg and kind (or the same in m, rad and ms)"
MOST = {"time_s": bounds.LONG_S, "x_m": bounds.FAR_M, "y_m": bounds.FAR_M, "yaw_rad": bounds.TURNS_RAD}
LONGEST_CELL = 64


@dataclass(frozen=True)
class Row:
    """A part that comes: when, s, where in the frame, m and rad, its kind (None: one at random), and its `line`."""

    time_s: float
    x_m: float
    y_m: float
    yaw_rad: float
    kind: str | None
    line: int


def rows_of(table: ArrivalsDocument, kinds: tuple[str, ...]) -> tuple[Row, ...]:
    """The rows of a table, in the order of time. Raises `Refused`."""
    if table.text is None:
        raise Refused("the text of the table: `assur.load` puts it in place of the name of a file", "csv", "file")
    found = list[Row]()
    reader = csv.reader(io.StringIO(table.text.removeprefix("\ufeff")), strict=True)
    columns: list[tuple[str, str | None]] | None = None
    try:
        for cells in reader:
            if not any(cell.strip() for cell in cells) or cells[0].lstrip().startswith("#"):
                continue
            if columns is None:
                columns = _columns(cells, reader.line_num)
                continue
            if len(found) == bounds.MAX_ARRIVALS:
                raise _refused(reader.line_num, f"at most {bounds.MAX_ARRIVALS:,} rows")
            found.append(_row(cells, columns, kinds, reader.line_num))
            if len(found) > 1 and found[-1].time_s < found[-2].time_s:
                raise _refused(reader.line_num, f"a time of {found[-2].time_s:g} s or later, as that of the row before")
    except csv.Error as error:
        raise _refused(reader.line_num, f"CSV ({error})") from error
    if not found:
        raise Refused(f"a table with a row for each part, under the titles {TITLES}", "csv")
    return tuple(found)


def _refused(line: int, allowed: str) -> Refused:
    return Refused(f"in line {line} of the table {allowed}", "csv")


def _columns(titles: list[str], line: int) -> list[tuple[str, str | None]]:
    """The name in SI and the unit of each column."""
    found = list[tuple[str, str | None]]()
    for title in titles:
        name = title.strip()
        found.append(si_key(name) or (name, None))
    names = [name for name, _ in found]
    if len(set(names)) < len(names) or not {*NEEDED} <= {*names} <= {*NEEDED, *POSSIBLE}:
        raise _refused(line, f"the titles {TITLES}, each once")
    return found


def _row(cells: list[str], columns: list[tuple[str, str | None]], kinds: tuple[str, ...], line: int) -> Row:
    if len(cells) != len(columns):
        raise _refused(line, f"{len(columns)} values, one for each column; there are {len(cells)}")
    values: dict[str, Any] = {"yaw_rad": 0.0, "kind": None}
    for cell, (name, unit) in zip(cells, columns, strict=True):
        text = cell.strip()
        if name == "kind":
            if text not in kinds:
                raise _refused(line, f"a kind of this stream ({', '.join(kinds)}); there is {text[:LONGEST_CELL]!r}")
            values[name] = text
            continue
        try:
            number = float(text)
        except ValueError:
            number = math.nan
        value: Any = number if unit is None else to_si(number, unit)
        if not abs(value) <= MOST[name]:
            raise _refused(line, f"a finite number for {name}, up to {MOST[name]:g}; there is {text[:LONGEST_CELL]!r}")
        values[name] = float(value)
    return Row(**values, line=line)


def with_arrivals(document: Any, folder: Path) -> Any:
    """The cell with the text of each table of arrivals that it names, which must lie below `folder`, in its place.
    Raises `DocumentError` at the name of the file."""
    streams = document.get("streams") if isinstance(document, dict) else None
    if not isinstance(streams, dict):
        return document
    return {**document, "streams": {name: _with_table(item, name, folder) for name, item in streams.items()}}


def _with_table(item: Any, name: object, folder: Path) -> Any:
    table = item.get("csv") if isinstance(item, dict) else None
    if not isinstance(table, dict) or table.keys() != {"file"} or not isinstance(table["file"], str):
        return item  # nothing to put in, or a document that its model refuses
    field = dotted(("streams", str(name), "csv", "file"))
    found = below(folder, table["file"], field, (".csv",), bounds.MAX_ARRIVALS_BYTES)
    try:
        text = found.read_bytes().decode("utf-8")
    except UnicodeDecodeError as error:
        raise InputError(field, table["file"], f"a file with text in UTF-8; byte {error.start} is none") from None
    if not text.strip():
        raise InputError(field, table["file"], f"a table of arrivals with the titles {TITLES}; this file is empty")
    return {**item, "csv": {"text": text}}
