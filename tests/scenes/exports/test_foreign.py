"""Trajectories of others: what is right is proved, what is not is refused with what, when and by how much."""

from __future__ import annotations

import copy
import json
import math
from functools import cache
from typing import Any

import pytest

from assur.api.cli.trajectories import lines
from assur.planner.collision.rows import ProofFailure
from assur.planner.errors import InputError
from assur.scenes.bounds import MAX_KNOTS
from assur.scenes.exports.documents import check_trajectory_document, export_document
from assur.scenes.faults import DocumentError
from assur.scenes.resampling.certifying import unproved
from assur.scenes.resampling.grid import MOST_KNOTS
from tests.refused import refused_at
from tests.scenes.exports.plans import planned, request_of

MOVES = "shutter"
"""A scenario whose motion touches nothing: it can be judged without legs."""


@cache
def exported(name: str, form: str = "csv", tick_ms: float | None = 1.0) -> str:
    """The file of a plan of ours."""
    tick = {} if tick_ms is None else {"tick_ms": tick_ms}
    file: str = export_document(request_of(name), planned(name), {"format": form, "jerk": "report", **tick})["file"]
    return file


def judged(name: str, file: str, plan: Any = None, **how: Any) -> dict[str, Any]:
    return check_trajectory_document(request_of(name), {"file": file, "format": "csv", "jerk": "report", **how}, plan)


def table(file: str) -> tuple[list[str], list[list[str]]]:
    """Header and rows of a file."""
    rows = [line.split(",") for line in file.splitlines() if not line.startswith("#")]
    return rows[0], rows[1:]


def text(header: list[str], rows: list[list[str]]) -> str:
    return "\n".join(",".join(row) for row in [header, *rows]) + "\n"


def test_a_plan_that_touches_nothing_is_accepted_without_legs() -> None:
    verdict = judged(MOVES, exported(MOVES))
    assert (verdict["ok"], verdict["first"], verdict["judged_as"]) == (True, None, "travel")
    assert verdict["clearance"]["gap_m"] == pytest.approx(planned(MOVES)["margins"]["nearest"]["gap_m"], abs=2e-4)
    assert judged(MOVES, exported(MOVES), jerk="limit")["first"]["what"].endswith("breaks its jerk limit")
    ros = {"file": exported(MOVES, "ros2", None), "format": "ros2"}
    assert check_trajectory_document(request_of(MOVES), ros)["ok"]
    json_text = {"file": exported(MOVES, "ros2-json", None), "format": "ros2"}
    assert check_trajectory_document(request_of(MOVES), json_text)["ok"]


def test_a_sample_in_an_obstacle_is_refused_with_the_time_and_the_pair() -> None:
    name = "two-robots-late"
    header, rows = table(exported(name))
    file = text(header, rows)
    assert judged(name, file, planned(name))["ok"]
    request = copy.deepcopy(request_of(name))
    spoilt = copy.deepcopy(rows)
    middle, column = len(rows) // 2, header.index("j2_deg")
    spoilt[middle][column] = repr(float(rows[middle][column]) + 120.0)
    verdict = check_trajectory_document(
        request, {"file": text(header, spoilt), "format": "csv", "jerk": "report"}, planned(name)
    )
    assert verdict["ok"] is False
    near = [finding for finding in verdict["findings"] if finding["code"] == "SEPARATION"]
    assert near
    assert " and " in near[0]["what"]
    t = float(rows[middle][0])
    assert abs(float(near[0]["where"].rpartition(", ")[2].removesuffix(" s")) - t) < 2e-3
    assert t - 2e-3 <= verdict["first"]["time_s"] <= t


def test_a_motion_into_an_obstacle_within_the_limits_names_the_pair_first() -> None:
    request = copy.deepcopy(request_of(MOVES))
    header, rows = table(exported(MOVES))
    wall = {"name": "new-wall", "shape": {"box": {"size_mm": [20, 20, 20]}}}
    request["bodies"].append({**wall, "pose": {"at_m": planned(MOVES)["arrivals"][-1]["at_m"]}})
    verdict = check_trajectory_document(request, {"file": text(header, rows), "format": "csv", "jerk": "report"})
    assert verdict["ok"] is False
    assert "new-wall" in verdict["first"]["bodies"]
    before = check_trajectory_document(
        request,
        {
            "file": text(header, [row for row in rows if float(row[0]) <= verdict["first"]["time_s"] - 2e-3]),
            "format": "csv",
            "jerk": "report",
        },
    )
    assert before["first"] is None or before["first"]["bodies"] is None


def test_a_spike_of_velocity_is_refused_with_the_joint_and_the_time() -> None:
    header, rows = table(exported(MOVES))
    spoilt, k = copy.deepcopy(rows), 700
    spoilt[k][header.index("j1_deg_s")] = repr(float(rows[k][header.index("j1_deg_s")]) + 2000.0)
    verdict = judged(MOVES, text(header, spoilt))
    assert verdict["ok"] is False
    assert verdict["first"]["what"] == "j1 breaks its velocity limit"
    assert float(rows[k - 1][0]) == pytest.approx(verdict["first"]["time_s"], abs=1e-9)
    assert any(finding["what"] == "j1 breaks its velocity limit" for finding in verdict["findings"])


def test_a_start_that_may_be_late_counts() -> None:
    verdicts = [judged(MOVES, exported(MOVES), start_tolerance_ms=late) for late in (0.0, 1000.0)]
    assert [verdict["ok"] for verdict in verdicts] == [True, False]
    assert verdicts[1]["start_tolerance_s"] == 1.0
    assert verdicts[1]["first"]["bodies"] is not None


def test_another_clock_is_another_motion() -> None:
    ros = {"file": exported(MOVES, "ros2", None), "format": "ros2"}
    assert check_trajectory_document(request_of(MOVES), {**ros, "start_s": 0.8})["ok"] is False
    with pytest.raises(InputError, match="when the request begins"):
        check_trajectory_document(request_of(MOVES), {**ros, "start_s": -5.0})
    with pytest.raises(InputError, match="the cell's clock"):
        judged(MOVES, exported(MOVES), start_s=0.0)


HEADER = "time_s," + ",".join(f"{j}{u}" for j, unit in (("j1", "deg"), ("j2", "deg"), ("j3", "mm"), ("j4", "deg"))
                              for u in (f"_{unit}", f"_{unit}_s", f"_{unit}_s2"))  # fmt: skip
ROW = ",".join(["0"] * 12)


@pytest.mark.parametrize(
    ("file", "line", "told"),
    [
        ("", 1, "a header with time_s"),
        ("# nothing\n", 1, "a header with time_s"),
        (f"{HEADER}\n", None, "at least two points"),
        (f"{HEADER}\n0,{ROW}\n", None, "at least two points"),
        (f"{HEADER}\n0,{ROW}\n0,{ROW}\n", 3, "later than 0 s"),
        (f"# c\n{HEADER}\n0,{ROW}\n\n1,{ROW}\n0.5,{ROW}\n", 6, "later than 1 s"),
        (f"{HEADER}\n0,nan,{ROW[2:]}\n", 2, "a finite number"),
        (f"{HEADER}\n0,1e999,{ROW[2:]}\n", 2, "from -1000 to 1000 rad"),
        (f"{HEADER}\n0,{ROW},1\n", 2, "13 values"),
        (f"{HEADER}\n0,{ROW[2:]}\n", 2, "13 values"),
        (f"{HEADER.replace('j4', 'j5')}\n0,{ROW}\n", 1, "j4"),
        (f"{HEADER.replace('j2_deg,', 'j1_rad,')}\n0,{ROW}\n", 1, "one column for j1_rad or j1_deg"),
        ("time_s,j1_deg,j2_deg,j3_mm,j4_deg\n0,0,0,0,0\n", 1, "j1_rad_s or j1_deg_s"),
        (f"{HEADER}\n0,9999999,{ROW[2:]}\n", 2, "from -1000 to 1000 rad"),
        (f'{HEADER}\n0,"{ROW}\n', 2, "comma-separated values"),
    ],
)
def test_what_is_wrong_with_a_file_is_told_with_its_line(file: str, line: int | None, told: str) -> None:
    with pytest.raises(DocumentError, match=told) as caught:
        judged("demo", file)
    assert caught.value.line == line


@pytest.mark.parametrize(
    ("old", "new", "field"),
    [
        ("joint_names: [j1", "joint_names: [j9", "joint_names"),
        ("nanosec: 0}\n- ", "nanosec: 0.5}\n- ", "points[0].time_from_start"),
        ("{sec: 0, nanosec: 0}\n- ", "{sec: 5, nanosec: 0}\n- ", "points[0].time_from_start"),
        ("points:\n- positions: [", "points:\n- positions: [0.0, ", "points[0].positions"),
        ("points:\n- positions: [", "points:\n- positions: [.nan, ", "points[0].positions"),
        ("points:\n- positions", "points:\n- efforts", "points[0].positions"),
    ],
)
def test_what_is_wrong_with_a_message_is_told_at_its_field(old: str, new: str, field: str) -> None:
    file = exported(MOVES, "ros2", None)
    assert old in file
    with pytest.raises(InputError) as caught:
        check_trajectory_document(request_of(MOVES), {"file": file.replace(old, new, 1), "format": "ros2"})
    assert caught.value.field.startswith(field)


def test_a_motion_that_is_not_as_long_as_the_plan_has_not_its_legs() -> None:
    header, rows = table(exported("demo"))
    with pytest.raises(InputError, match="as the plan's legs last"):
        judged("demo", text(header, rows[:200]), planned("demo"))


def ending_at(rate: float, stay_s: float = 3.0, **options: Any) -> dict[str, Any]:
    """The verdict on an arm that stands over a belt, whose last point has this speed of j4, rad/s."""
    header = "time_s," + ",".join(f"j{i}_{u}{r}" for i, u in enumerate(("rad", "rad", "m", "rad"), start=1)
                                  for r in ("", "_s", "_s2"))  # fmt: skip
    row = "-0.27748792,0,0,0.34719429,0,0,0.19756756,0,0,0"
    request = copy.deepcopy(request_of("demo"))
    request["options"] = {**request.get("options", {}), "stay_safe_s": stay_s, **options}
    file = f"{header}\n0,{row},0,0\n1.05,{row},{rate!r},0\n"
    return check_trajectory_document(request, {"file": file, "format": "csv"})


def test_a_motion_that_ends_all_but_at_rest_has_its_standstill_proved_too() -> None:
    for rate in (0.0, 1e-12, 1e-10):  # a part on the belt comes
        verdict = ending_at(rate)
        assert (verdict["ok"], verdict["ends_moving"]) == (False, False)
        assert verdict["first"]["bodies"] == ["cup", "bar"]
        assert verdict["first"]["time_s"] == pytest.approx(1.1527, abs=2e-3)
        assert ending_at(rate, 0.05)["ok"]


def test_a_motion_that_ends_moving_is_refused_or_told() -> None:
    moving = ending_at(1e-6)
    assert (moving["ok"], moving["ends_moving"]) == (False, True)
    assert [finding["code"] for finding in moving["findings"]] == ["END"]
    asked = ending_at(1e-6, 0.0, end="moving")
    assert (asked["ok"], asked["ends_moving"]) == (True, True)
    told = [line for line in lines("x.csv", asked) if isinstance(line, str)]
    assert "ends moving: nothing after its last point is proved" in told


@pytest.mark.parametrize("step", ["5e-324", "1e-300", "1e-12", "0.9e-9"])
def test_points_that_are_closer_than_a_nanosecond_are_refused(step: str) -> None:
    with refused_at("file: time_s", match="later than 0 s, that of the point before, by 1e-09 s", line=3):
        judged("demo", f"{HEADER}\n0,{ROW}\n{step},{ROW}\n1,{ROW}\n")
    assert judged("demo", f"{HEADER}\n0,{ROW}\n1e-9,{ROW}\n1,{ROW}\n")["points"] == 3


@pytest.mark.parametrize("nanosec", [1, 500_000_000])
def test_a_message_whose_first_point_is_later_than_its_start_is_refused(nanosec: int) -> None:
    file = exported(MOVES, "ros2", None)
    late = file.replace("{sec: 0, nanosec: 0}\n- ", f"{{sec: 0, nanosec: {nanosec}}}\n- ", 1)
    with refused_at("points[0].time_from_start", match="0 s at the first point"):
        check_trajectory_document(request_of(MOVES), {"file": late, "format": "ros2"})


@pytest.mark.parametrize("file", ["a: &x 1\nb: *x\n", '{"points": [', "a: [1\n", "\t- x"])
def test_a_fault_of_the_text_is_told_as_one_of_the_file(file: str) -> None:
    with pytest.raises(InputError) as caught:
        check_trajectory_document(request_of(MOVES), {"file": file, "format": "ros2"})
    assert caught.value.field in ("file", "a")


def test_a_point_that_is_no_later_than_the_one_before_is_told_at_its_field() -> None:
    message = json.loads(exported(MOVES, "ros2-json", None))
    message["points"][1]["time_from_start"] = message["points"][0]["time_from_start"]
    with refused_at("points[1].time_from_start", match="later than 0 s"):
        check_trajectory_document(request_of(MOVES), {"file": json.dumps(message), "format": "ros2"})


def test_what_is_only_not_shown_has_no_amount() -> None:
    near = unproved(ProofFailure(("a", "b"), 1.0, 0.26, 0.001, touching=False, of_robot=True), "travel")
    assert "not shown" in near.what
    assert math.isnan(near.amount)
    assert unproved(ProofFailure(("a", "b"), 1.0, 0.0005, 0.001, touching=False, of_robot=True), "x").amount == 0.0005


def test_what_is_written_has_no_more_knots_than_what_is_read() -> None:
    assert MOST_KNOTS == MAX_KNOTS
