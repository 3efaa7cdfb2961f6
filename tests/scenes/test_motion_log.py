"""Logs in CSV: what is read, and what is refused, with the column, the line, the value and what is allowed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from assur.scenes import motion_log
from assur.scenes.faults import DocumentError
from assur.scenes.motion_log import load_log, parse_log
from assur.scenes.motions import csv_motion

ROWS = 60
HEADER = "t_ms,j1_deg,j3_mm"


def lines(header: str = HEADER, rows: int = ROWS) -> list[str]:
    return [header, *(f"{4 * i},{i / 10},{-i}" for i in range(rows))]


def log(*, line: int = 0, text: str = "") -> bytes:
    """A log that is right but for line `line`, counted from 1."""
    found = lines()
    if line:
        found[line - 1] = text
    return ("\n".join(found) + "\n").encode()


def test_times_and_positions_leave_in_si_by_the_names_of_the_joints() -> None:
    found = parse_log(log(), "cycle.csv")
    assert (found.name, [(j.name, j.unit) for j in found.joints]) == ("cycle.csv", [("j1", "rad"), ("j3", "m")])
    assert found.time == pytest.approx(0.004 * np.arange(ROWS))
    assert found.joints[0].position == pytest.approx(np.radians(np.arange(ROWS) / 10))
    assert found.joints[1].position == pytest.approx(-np.arange(ROWS) / 1000)


@pytest.mark.parametrize(
    "header", ["t_s,j1_rad,j3_m", "j1_rad,t_s,j3_m", '"t_s", j1_rad ,j3_m', "\ufefft_s,theta1_deg,d3_mm"]
)
def test_columns_may_stand_in_any_order_and_be_quoted(header: str) -> None:
    text = "\r\n".join([header, *(f"{i / 250},{i / 250 + 0.001},{i / 250 + 0.002}" for i in range(ROWS))])
    found = parse_log(text.encode(), "x.csv")
    assert len(found.joints) == 2
    assert found.time[0] == 0


def test_times_begin_at_zero() -> None:
    text = "\n".join(["t_s,j1_rad", *(f"{5000 + i / 250},0" for i in range(ROWS))])
    assert parse_log(text.encode(), "x.csv").time[[0, 1]] == pytest.approx([0.0, 0.004])


BAD = {
    "a value that is no number": (log(line=7, text="24,abc,0"), 7, "cycle.csv: j1_deg", "'abc'", "a finite number"),
    "not a number": (log(line=7, text="24,nan,0"), 7, "cycle.csv: j1_deg", "'nan'", "a finite number"),
    "infinity": (log(line=7, text="24,0,-inf"), 7, "cycle.csv: j3_mm", "'-inf'", "a finite number"),
    "a number that overflows": (log(line=7, text="24,1e999,0"), 7, "cycle.csv: j1_deg", "'1e999'", "-1000 to 1000 rad"),
    "a number of another script": (log(line=7, text="24,١,0"), 7, "cycle.csv: j1_deg", "'١'", "a finite number"),
    "a number with an underline": (log(line=7, text="24,1_0,0"), 7, "cycle.csv: j1_deg", "'1_0'", "a finite number"),
    "an empty value": (log(line=7, text="24,,0"), 7, "cycle.csv: j1_deg", "''", "a finite number"),
    "an angle of a thousand turns": (
        log(line=7, text="24,9e4,0"),
        7,
        "cycle.csv: j1_deg",
        "'9e4'",
        "-1000 to 1000 rad",
    ),
    "a length of a kilometre": (log(line=7, text="24,0,1e6"), 7, "cycle.csv: j3_mm", "'1e6'", "-100 to 100 m"),
    "a time of the calendar, once": (
        log(line=2, text="1.7e12,0,0"),
        3,
        "cycle.csv: t_ms",
        "'4'",
        "from the first time on",
    ),
    "a row that is too short": (log(line=7, text="24,0"), 7, "cycle.csv", "'2 values'", "3 values"),
    "a row that is too long": (log(line=7, text="24,0,0,0"), 7, "cycle.csv", "'4 values'", "3 values"),
    "time that stands still": (log(line=7, text="16,0,0"), 7, "cycle.csv: t_ms in s", "0.016", "later than the row"),
    "time that goes back": (log(line=7, text="8,0,0"), 7, "cycle.csv: t_ms in s", "0.008", "later than the row"),
    "a gap": (log(line=61, text="260,0,0"), 61, "cycle.csv: t_ms in s", "0.26", "0.004 s is usual"),
    "an empty file": (b"", 1, "cycle.csv", "nothing", "a header"),
    "a header alone": (HEADER.encode(), 1, "cycle.csv: t_ms in s", "nothing", "at least 50 rows"),
    "one row": (f"{HEADER}\n0,0,0\n".encode(), 2, "cycle.csv: t_ms in s", "0.0", "at least 50 rows"),
    "no header": (log(line=1, text="-4,0,0"), 1, "cycle.csv", "'-4,0,0'", "a header"),
    "no column of times": (
        log(line=1, text="j2_deg,j1_deg,j3_mm"),
        1,
        "cycle.csv: column",
        "nothing",
        "a column of times",
    ),
    "two columns of times": (log(line=1, text="t_ms,t_s,j3_mm"), 1, "cycle.csv: column", "'t_s'", "one column for t"),
    "no joint": (b"t_s\n0\n", 1, "cycle.csv", "'0 joints'", "1 to 16 joints"),
    "a joint twice": (log(line=1, text="t_ms,j1_deg,j1_rad"), 1, "cycle.csv: column", "'j1_rad'", "one column for j1"),
    "an unknown unit": (log(line=1, text="t_ms,j1_deg,j3_inch"), 1, "cycle.csv: column", "'j3_inch'", "j3_mm"),
    "a column without a unit": (log(line=1, text="t_ms,j1,j3_mm"), 1, "cycle.csv: column", "'j1'", "no other columns"),
    "a speed": (log(line=1, text="t_ms,j1_deg_s,j3_mm"), 1, "cycle.csv: column", "'j1_deg_s'", "positions of j1"),
    "a joint that is called as time is": (
        log(line=1, text="t_ms,t_deg,j3_mm"),
        1,
        "cycle.csv: column",
        "'t_deg'",
        "no",
    ),
    "a name that is no joint's": (log(line=1, text="t_ms,=1+1_deg,j3_mm"), 1, "cycle.csv: column", "'=1+1_deg'", "no"),
    "a quote that is not closed": (log(line=7, text='24,"0,0'), 7, "cycle.csv", "'unexpected end of data'", "comma"),
    "not UTF-8": (log(line=7, text="24,0,0").replace(b"24,0,0", b"24,\xff,0"), 7, "cycle.csv", "'byte ", "UTF-8"),
    "a null character": (log(line=7, text="24,\0,0"), 7, "cycle.csv", "'a null character'", "UTF-8"),
    "binary": (bytes(range(256)) * 8, 2, "cycle.csv", "'byte 128 of the file'", "UTF-8"),
}


@pytest.mark.parametrize("kind", BAD)
def test_a_bad_log_is_refused_where_it_is_bad(kind: str) -> None:
    data, line, field, value, allowed = BAD[kind]
    with pytest.raises(DocumentError) as caught:
        parse_log(data, "cycle.csv")
    assert (caught.value.line, caught.value.field) == (line, field)
    assert value in repr(caught.value.value) or value.strip("'") in str(caught.value.value)
    assert allowed in caught.value.allowed
    assert len(str(caught.value)) < 400


def test_a_log_that_is_too_large_is_refused(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    file = tmp_path / "cycle.csv"
    file.write_bytes(log())
    assert len(load_log(file).time) == ROWS
    monkeypatch.setattr(motion_log, "MAX_LOG_ROWS", ROWS - 1)
    with pytest.raises(DocumentError, match=r"line 61: .*at most 59 rows"):
        load_log(file)
    for module in (motion_log, csv_motion):
        monkeypatch.setattr(module, "MAX_LOG_BYTES", len(log()) - 1)
    with pytest.raises(DocumentError, match=r"at most .* bytes"):
        load_log(file)


def test_a_value_that_is_very_long_is_not_repeated_whole() -> None:
    with pytest.raises(DocumentError) as caught:
        parse_log(log(line=7, text="24," + "9" * 100_000 + ",0"), "cycle.csv")
    assert len(str(caught.value)) < 400
