"""Logs as loggers, spreadsheets and recorders of ROS write them: each gives the limits of the same log as we write it,
or is refused with what was found."""

from __future__ import annotations

from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest

from assur.scenes.catalogue import shipped_robot
from assur.scenes.faults import DocumentError
from assur.scenes.fitted_limits import fit_limits, part
from assur.scenes.motion_log import MotionLog, parse_log
from tests.refused import refused_at

LOG = Path(__file__).parents[3] / "docs" / "logs" / "cycle.csv"
TEXT = LOG.read_text(encoding="utf-8")
TITLES = TEXT.splitlines()[0].split(",")
ROWS = [line.split(",") for line in TEXT.splitlines()[1:]]
BASE = parse_log(TEXT.encode(), "cycle.csv")
START = Decimal(1_700_000_000)


def text(titles: list[str], rows: list[list[str]], separator: str = ",") -> str:
    return "\n".join(separator.join(row) for row in [titles, *rows]) + "\n"


def timed(title: str, digits: int, start: Decimal = START) -> str:
    """The log with times since 1970 in a unit that is `digits` below the second."""
    return text(
        [title, *TITLES[1:]], [[format((start + Decimal(row[0])).scaleb(digits), "f"), *row[1:]] for row in ROWS]
    )


def of_ros(time: str, *others: str) -> str:
    """The log in SI with titles of ROS: `others` are j1, j2, j3, with columns that bear no motion."""
    rows = [
        [row[0], *(repr(float(np.radians(float(each)))) for each in row[1:3]), repr(float(row[3]) / 1000)]
        for row in ROWS
    ]
    return text([time, *others], rows)


def same(found: MotionLog) -> None:
    """Asserts that a log is the log as we write it, bit by bit: its limits are then the same."""
    np.testing.assert_array_equal(found.time, BASE.time)
    for joint, own in zip(found.joints, BASE.joints, strict=True):
        assert (joint.name, joint.unit) == (own.name, own.unit)
        np.testing.assert_array_equal(joint.position, own.position)


AS_WRITTEN = {
    "epoch in s": timed("t_s", 0),
    "epoch in ms": timed("time_ms", 3),
    "epoch in us": timed("t_us", 6),
    "epoch in ns": timed("time_ns", 9),
    "epoch without a unit, s": timed("timestamp", 0),
    "epoch without a unit, ns": timed("time", 9),
    "a computer that has run for 12 days": timed("t_s", 0, Decimal(1_036_800)),
    "time_s": TEXT.replace("t_s", "time_s", 1),
    "blank lines": TEXT.replace("\n", "\n\n", 3) + "\n \n\n",
    "CRLF": TEXT.replace("\n", "\r\n") + "\r\n",
    "rows of separators at the end": TEXT + ",,,\n,,,\n",
    "comments": "# a log\n" + TEXT.replace("\n", "\n# the motion begins\n// here\n", 1) + "# end\n",
    "titles in a comment": "# " + TEXT,
    "semicolons": TEXT.replace(",", ";"),
    "tabs": TEXT.replace(",", "\t"),
    "blanks behind commas": TEXT.replace(",", ", "),
    "quotes": "\n".join(",".join(f'"{cell}"' for cell in line.split(",")) for line in TEXT.splitlines()),
    "a spreadsheet's first line": "sep=;\n" + TEXT.replace(",", ";"),
    "a separator at the end of each line": TEXT.replace("\n", ",\n"),
    "a byte order mark": "\ufeff" + TEXT,
    "units in brackets": TEXT.replace("t_s,j1_deg,j2_deg,j3_mm", "time [s],j1 [deg],j2 (°),j3 [mm]", 1),
}


@pytest.mark.parametrize("how", AS_WRITTEN)
def test_a_log_is_read_as_loggers_write_it(how: str) -> None:
    same(parse_log(AS_WRITTEN[how].encode(), "cycle.csv"))


def test_an_epoch_log_gives_the_limits_of_the_same_log_and_says_how_its_times_count() -> None:
    short = "\n".join(TEXT.splitlines()[:240]) + "\n"
    epoch = "\n".join(timed("t_s", 0).splitlines()[:240]) + "\n"
    one, other = (fit_limits(parse_log(each.encode(), "cycle.csv")) for each in (short, epoch))
    assert any(joint["acceleration"]["value"] for joint in one["joints"])
    assert one.pop("notes") == []
    assert other.pop("notes") == ["times count from the first row, 1700000000.000000 s"]
    assert one == other


SHUFFLED = "t_s,j1_deg,j1_deg_s,j2_deg,j3_mm"


def test_speeds_in_a_log_are_not_used_and_that_is_said() -> None:
    rows = [[row[0], row[1], "0", *row[2:]] for row in ROWS]
    found = parse_log(text(SHUFFLED.split(","), rows).encode(), "cycle.csv")
    same(found)
    assert found.notes == ("velocities are not used",)


ROS_TITLES = {
    "PlotJuggler": ("__time", "/joint_states/j1/position", "/joint_states/j2/position", "/joint_states/j3/position"),
    "by number": ("time_s", "position[0]", "position[1]", "position[2]"),
    "a bag": ("t_s", "position.j1", "position.j2", "position.j3"),
}


@pytest.mark.parametrize("how", ["PlotJuggler", "a bag"])
def test_a_recorded_message_in_csv_takes_its_units_from_the_robot(how: str) -> None:
    log = parse_log(of_ros(*ROS_TITLES[how]).encode(), "bag.csv")
    assert [(joint.name, joint.unit) for joint in log.joints] == [("j1", None), ("j2", None), ("j3", None)]
    with pytest.raises(DocumentError, match=r"j1 without a unit.*--robot"):
        fit_limits(log)
    for joint, own in zip(log.joints, BASE.joints, strict=True):
        np.testing.assert_allclose(joint.position, own.position, rtol=1e-15)
    small = MotionLog(log.name, log.time[:60], tuple(type(j)(j.name, j.unit, j.position[:60]) for j in log.joints))
    found = fit_limits(small, robot=shipped_robot("fanuc-sr-3ia"))
    assert [joint["unit"] for joint in found["joints"]] == ["rad", "rad", "m"]


def test_columns_by_number_are_named_by_their_columns_of_names() -> None:
    titles = ["%time", "field.header.seq", "field.header.stamp", "field.header.frame_id", "field.name0", "field.name1"]
    titles += ["field.position0", "field.position1", "field.effort0"]
    stamps = [str(int((START + Decimal(row[0])).scaleb(9))) for row in ROWS]
    rows = [
        [str(int(stamp) + 7_000_000 + 1000 * (k % 5)), str(k), stamp, "", "arm/j2", "arm/j1", row[2], row[1], "0.1"]
        for k, (stamp, row) in enumerate(zip(stamps, ROWS, strict=True))
    ]
    found = parse_log(text(titles, rows).encode(), "bag.csv")
    np.testing.assert_array_equal(found.time, BASE.time)  # the stamps of the messages, not of the recorder
    assert [joint.name for joint in found.joints] == ["arm/j2", "arm/j1"]
    assert found.notes[-1] == (
        "columns that are not used: field.header.seq, field.header.frame_id, field.effort0, %time"
    )
    no_stamp = [[row[0], row[1], "0", *row[3:]] for row in rows]
    assert parse_log(text(titles, no_stamp).encode(), "bag.csv").time[1] == pytest.approx(0.004001)
    rows[3][4] = "arm/j3"
    with pytest.raises(DocumentError, match="the name of one joint in each row: arm/j2 is in the first") as caught:
        parse_log(text(titles, rows).encode(), "bag.csv")
    assert (caught.value.value, caught.value.line) == ("arm/j3", 5)


def test_seconds_and_nanoseconds_in_two_columns_are_one_time() -> None:
    titles = ["header.stamp.secs", "header.stamp.nsecs", *TITLES[1:]]
    rows = []
    for row in ROWS:
        whole, rest = divmod(START + Decimal(row[0]), 1)
        rows.append([str(whole), str(int(rest.scaleb(9))), *row[1:]])
    same(parse_log(text(titles, rows).encode(), "bag.csv"))
    rows[2][1] = "1000000000"
    with pytest.raises(DocumentError, match="from 0 to 999999999") as caught:
        parse_log(text(titles, rows).encode(), "bag.csv")
    assert caught.value.line == 4


def test_of_two_stamps_none_is_chosen() -> None:
    titles = ["header.stamp.sec", "header.stamp.nanosec", "goal.time_from_start.sec", "goal.time_from_start.nanosec"]
    rows = [["7", str(k * 10_000_000), "0", "0", *row[1:]] for k, row in enumerate(ROWS[:90])]
    with pytest.raises(DocumentError, match=r"one stamp; header\.stamp\.sec is of another") as caught:
        parse_log(text([*titles, *TITLES[1:]], rows).encode(), "bag.csv")
    assert caught.value.value == "goal.time_from_start.sec"
    two = ["t_s", "name0", "name0", "position0"]
    with pytest.raises(DocumentError, match="one column of names for a number"):
        parse_log(text(two, [["0", "a", "b", "1"]]).encode(), "bag.csv")


def test_a_stamp_that_begins_at_0_is_one() -> None:
    """As of a simulation: the recorder's own times jitter."""
    titles = ["__time", "header.stamp.sec", "header.stamp.nanosec", *TITLES[1:]]
    rows = []
    for k, row in enumerate(ROWS):
        recorded, stamp = START + Decimal(row[0]) + Decimal(k % 3) / 1000, divmod(int(Decimal(row[0]).scaleb(9)), 10**9)
        rows.append([str(recorded), *map(str, stamp), *row[1:]])
    same(parse_log(text(titles, rows).encode(), "bag.csv"))


@pytest.mark.parametrize("prefix", ["line3_", "robot/", "cell.arm-"])
def test_joints_behind_one_prefix_are_those_of_the_robot(prefix: str) -> None:
    names = TEXT.replace("j1_deg,j2_deg,j3_mm", f"{prefix}j1_deg,{prefix}j2_deg,{prefix}j3_mm", 1)
    few = "\n".join(names.splitlines()[:61]) + "\n"
    log = parse_log(few.encode(), "cycle.csv")
    found = fit_limits(log, robot=shipped_robot("fanuc-sr-3ia"))
    assert [joint["name"] for joint in found["joints"]] == ["j1", "j2", "j3"]
    assert found["notes"] == [f"the names of the joints are read without {prefix!r}"]
    assert f'- name: "{prefix}j1"' in part(fit_limits(log))
    mixed = few.replace(f"{prefix}j2", "other_j2", 1)
    with pytest.raises(DocumentError, match=r"a joint of the robot: j1, j2, j3, j4.*all may have one prefix"):
        fit_limits(parse_log(mixed.encode(), "cycle.csv"), robot=shipped_robot("fanuc-sr-3ia"))


COMMAS = text(TITLES, [[cell.replace(".", ",") for cell in row] for row in ROWS], ";")
JUMP = timed("t_s", 0).replace("1700000000.008", "1800000000.008")
COLUMN = "cycle.csv: column"
REFUSED = {
    "decimal commas": (COMMAS, "cycle.csv: j1_deg", "0,000027", "this one has a decimal comma", 2),
    "decimal commas between commas": (COMMAS.replace(";", ","), "cycle.csv", "8 values", "decimal comma", 2),
    "a time without a unit": (
        TEXT.replace("t_s", "time", 1),
        "cycle.csv: time",
        "a time of 0.000000 without a unit",
        "time_s, time_ms",
        2,
    ),
    "ms that are called s": (timed("t_s", 3), "cycle.csv: t_s", "1700000000000.000 s", "in ms it would be a time", 2),
    "ns that are called ms": (timed("t_ms", 9), "cycle.csv: t_ms", "1700000000000000000 ms", "in ns it would be", 2),
    "a jump of the clock": (JUMP, "cycle.csv: t_s", "1800000000.008000", "from the first time on", 4),
    "UTF-16": ("", "cycle.csv", "text in UTF-16", "UTF-8", 1),
    "no titles": (TEXT.partition("\n")[2], "cycle.csv", "0.000000,0.000027,40", "a header with time_s", 1),
    "an unknown column": (TEXT.replace("j3_mm", "heat_C", 1), COLUMN, "heat_C", "no other columns", 1),
    "by number without names": (of_ros(*ROS_TITLES["by number"]), COLUMN, "position[0]", "name0, position0", 1),
    "a cut last line": (TEXT[:-12], "cycle.csv", "3 values", "4 values", len(ROWS) + 1),
    "a joint in two units": (TEXT.replace("j2_deg", "j1_mm", 1), COLUMN, "j1_mm", "one column for j1", 1),
}


@pytest.mark.parametrize("how", REFUSED)
def test_what_is_ambiguous_or_wrong_is_refused_with_what_was_found(how: str) -> None:
    content, field, value, allowed, line = REFUSED[how]
    data = content.encode() if content else TEXT.encode("utf-16")
    with refused_at(field, allowed, line=line, value=value):
        parse_log(data, "cycle.csv")
