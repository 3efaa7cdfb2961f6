"""Files of trajectories that are too large: each is refused at its limit, and what is just within it is read."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from assur.scenes.bounds import LINES_A_ROW, MAX_JSON_BYTES, MAX_KNOTS, MAX_LOG_BYTES, MAX_ROW_CHARACTERS
from assur.scenes.exports.foreign import trajectory_from
from assur.scenes.faults import DocumentError
from assur.scenes.requests import cell_of, shipped
from tests.api.test_command_line import run
from tests.refused import refused_at
from tests.scenes.exports.test_foreign import HEADER, ROW

BAD_INPUT = 2
MAX_LINES = LINES_A_ROW * MAX_KNOTS


def read(text: str | bytes, form: str = "csv") -> Any:
    scenario = shipped("transfer")
    conventions = cell_of(scenario.request, folder=scenario.folder).conventions
    data = text.encode() if isinstance(text, str) else text
    return trajectory_from(data, form, conventions, None if form == "csv" else 0.0, 0.0, jumps=False)[0]


def rows(count: int) -> str:
    return "\n".join([HEADER, *(f"{0.001 * k:.3f},{ROW}" for k in range(count))]) + "\n"


def message(count: int, names: list[str]) -> str:
    still = {key: [0.0] * len(names) for key in ("positions", "velocities", "accelerations")}
    points = [{**still, "time_from_start": {"sec": k // 1000, "nanosec": k % 1000 * 10**6}} for k in range(count)]
    return json.dumps({"joint_names": names, "points": points}, separators=(",", ":"))


JOINTS = ["j1", "j2", "j3", "j4"]


def test_too_many_rows_are_refused_at_the_first_that_is_too_many() -> None:
    assert len(read(rows(MAX_KNOTS)).time) == MAX_KNOTS
    with refused_at("file", match=f"at most {MAX_KNOTS} rows", line=MAX_KNOTS + 2):
        read(rows(MAX_KNOTS + 1))


def test_too_many_points_of_a_message_are_refused() -> None:
    assert len(read(message(1000, JOINTS), "ros2").time) == 1000
    with refused_at("points", match=f"a list of 2 to {MAX_KNOTS} points"):
        read(message(MAX_KNOTS + 1, JOINTS), "ros2")


@pytest.mark.parametrize("line", [",".join(["1"] * MAX_ROW_CHARACTERS), "x" * MAX_ROW_CHARACTERS, '"' + "," * 10_000])
@pytest.mark.parametrize("before", ["", f"{HEADER}\n0,{ROW}\n", "# a comment\n"])
def test_a_line_that_is_too_long_is_refused_with_its_number(line: str, before: str) -> None:
    with refused_at("file", match=f"lines of up to {MAX_ROW_CHARACTERS} characters", line=before.count("\n") + 1):
        read(f"{before}{line}\n")


def test_a_comment_that_is_too_long_is_refused_too_and_a_long_one_is_read() -> None:
    assert len(read(f"#{' ' * (MAX_ROW_CHARACTERS - 2)}\n{rows(3)}").time) == 3
    with pytest.raises(DocumentError, match="characters"):
        read(f"#{' ' * MAX_ROW_CHARACTERS}\n{rows(3)}")


def test_a_row_does_not_go_on_in_the_next_line() -> None:
    many = ",".join(['"0\n"'] * 5)
    with pytest.raises(DocumentError, match="each row on one line") as caught:
        read(f"{HEADER}\n0,{ROW}\n{many}\n")
    assert caught.value.line == 3
    assert len(read(rows(3).replace("j1_deg,", '"j1_deg",')).time) == 3


@pytest.mark.parametrize(("form", "most"), [("csv", MAX_LOG_BYTES), ("ros2", MAX_JSON_BYTES)])
def test_too_many_bytes_are_refused(form: str, most: int) -> None:
    text = rows(3) if form == "csv" else message(3, JOINTS)
    blanks = ("#" + " " * 8000 + "\n") * (most // 8002) if form == "csv" else ""
    blanks = blanks[: most - len(text)].ljust(most - len(text), "\n")
    assert len(read(text + blanks, form).time) == 3
    with pytest.raises(DocumentError, match=f"at most {most} bytes") as caught:
        read(text + blanks + "\n", form)
    assert caught.value.field == "file"


def test_too_many_lines_are_refused_whatever_is_in_them() -> None:
    text = rows(3)
    assert len(read(text + "\n" * (MAX_LINES - 4)).time) == 3
    with pytest.raises(DocumentError, match=f"at most {MAX_LINES} lines") as caught:
        read(text + "\n" * (MAX_LINES - 3))
    assert caught.value.line == MAX_LINES + 1


@pytest.mark.parametrize("name", ["huge.csv", "huge.yaml"])
def test_a_file_that_is_too_long_is_not_read_to_its_end(tmp_path: Path, name: str) -> None:
    huge = tmp_path / name
    with huge.open("wb") as file:
        file.truncate(1 << 40)  # what would read it all would not end
    code, _, errors = run("check-trajectory", "transfer", str(huge))
    assert (code, f"at most {MAX_LOG_BYTES} bytes" in errors) == (BAD_INPUT, True)
