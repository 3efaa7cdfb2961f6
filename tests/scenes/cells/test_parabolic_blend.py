"""The joint move of source 004 as a shipped cell: planned, checked, written down, read back, tampered with, refused."""

from __future__ import annotations

import copy
import math
from functools import cache
from typing import Any

import numpy as np
import pytest

from assur.api.cli.console_report import everything
from assur.experiments.printed_joint_move import ParabolicBlend, inverse
from assur.planner.errors import InputError
from assur.scenes.requests import cell_of, check_document, plan_cell, plan_document, with_options
from assur.scenes.scenarios import shipped
from tests.scenes.bad_requests import Bad

Document = dict[str, Any]
NAME = "parabolic-blend"
POSE = (0.2, 0.2, -0.1), (0.2, 0.2, -0.2)


@cache
def _answer() -> Document:
    return plan_cell(cell_of(shipped(NAME).request), unstated={"report": "full"})


def answer() -> Document:
    return copy.deepcopy(_answer())


def request_of(**options: Any) -> Document:
    request: Document = copy.deepcopy(shipped(NAME).request)
    request["options"] |= options
    return request


def reading() -> ParabolicBlend:
    """The move by the formulas of the source's reading, which know nothing of the planner."""
    one, two = (inverse(np.array(p), np.array(0.0), 0.2, 0.2, g) for p, g in zip(POSE, (1, -1), strict=True))
    return ParabolicBlend(np.stack([one, two, one]), 0.4, 0.1)


def knots(document: Document) -> dict[str, Any]:
    found: dict[str, Any] = document["trajectory"]
    return found


def test_the_plan_is_the_move_of_the_source_with_its_change_of_the_elbow() -> None:
    move, path = reading(), knots(answer())
    time = np.array(path["time_s"])
    assert np.abs(np.array(path["position"]) - move.evaluate(time)).max() <= 1e-12
    assert np.abs(np.array(path["velocity"]) - move.evaluate(time, 1)).max() <= 1e-10
    assert time.tolist() == pytest.approx([0, 0, 0.2, 0.2, 0.4, 0.4, 0.6, 0.6, 0.8, 0.8, 1, 1])
    assert path["acceleration_jumps"] is True
    middle = move.evaluate(np.array([0.5]))[0]
    assert middle[1] < 0 < np.array(path["position"])[0, 1]


def test_the_answer_says_what_is_missed_what_is_covered_and_that_the_jerk_is_unbounded() -> None:
    document = answer()
    past, back = document["arrivals"]
    assert past["missed_by"]["joints"] == pytest.approx(reading().missed_by[1].tolist(), abs=1e-12)
    assert past["missed_by"]["joints"] == pytest.approx(
        [math.radians(-11.25), math.radians(22.5), 0.0125, math.radians(-11.25)]
    )
    away = np.array(past["at_m"]) - np.array(POSE[1])
    assert past["missed_by"]["distance_m"] == pytest.approx(np.linalg.norm(away), abs=1e-12)
    assert back["missed_by"] is None
    assert document["margins"]["jerk"] == "unbounded"
    assert all(peak["jerk"] is peak["jerk_ratio"] is None for peak in document["margins"]["peaks"])
    assert document["certificate"]["covers"] == ["separation", "position", "velocity", "acceleration"]
    told = [item for item in everything(document) if isinstance(item, str)]
    assert any("the jerk is unbounded" in line for line in told)


def test_without_the_bars_the_elbow_stays_and_the_move_is_shorter() -> None:
    request = request_of()
    del request["bodies"]
    found = plan_document(request)
    assert found["status"] == "planned"
    assert found["duration_s"] == pytest.approx(0.6, abs=1e-4)  # 100 mm down and up again
    assert min(row[1] for row in found["trajectory"]["position"]) > 0


def test_jerk_limited_the_same_move_misses_nothing_and_has_a_limit_of_jerk() -> None:
    request = request_of(timing="jerk_limited")
    del request["options"]["acceleration_time_ms"], request["bodies"]
    found = plan_document(with_options(request, {"report": "full"}))
    assert found["status"] == "planned"
    assert found["margins"]["jerk"] == "limited"
    assert found["certificate"]["covers"][-1] == "jerk"
    assert found["trajectory"]["acceleration_jumps"] is False
    assert [arrival["missed_by"] for arrival in found["arrivals"]] == [None, None]
    assert (np.diff(found["trajectory"]["time_s"]) > 0).all()


def findings(document: Document, **options: Any) -> set[str]:
    verdict = check_document(request_of(**options), document)
    assert verdict["ok"] == (not verdict["findings"])
    return {finding["code"] for finding in verdict["findings"]}


def test_a_motion_that_is_changed_is_refused() -> None:
    changed = answer()
    changed["trajectory"]["acceleration"][3][0] += 0.1
    assert {"DIGEST", "BLEND"} <= findings(changed)


def test_doubled_knots_are_refused_where_the_answer_does_not_own_up_to_them_or_the_request_has_none() -> None:
    silent = answer()
    silent["trajectory"]["acceleration_jumps"] = False
    with pytest.raises(InputError) as caught:
        check_document(request_of(), silent)
    assert caught.value.field.startswith("plan.trajectory.time_s[")
    request = request_of(timing="jerk_limited")
    del request["options"]["acceleration_time_ms"]
    verdict = check_document(request, answer())
    assert {finding["code"] for finding in verdict["findings"]} == {"FORM", "CLAIM"}  # it is another request, too


CELL = shipped(NAME).request
BAD: tuple[Bad, ...] = (
    Bad("another timing", {"options.timing": "parabolic"}, on=CELL),
    Bad("a time of nothing", {"options.acceleration_time_ms": 0}, on=CELL),
    Bad("a time that is too short", {"options.acceleration_time_ms": 1}, on=CELL),
    Bad("a time of another timing", {"options.timing": "jerk_limited"}, "options.acceleration_time_ms", on=CELL),
    Bad("a straight leg", {"task[0].move.leg": "cartesian"}, on=CELL),
    Bad(
        "a start in motion",
        {"start.velocity": {"theta1_deg_s": 1, "theta2_deg_s": 0, "d3_mm_s": 0, "theta4_deg_s": 0}},
        on=CELL,
    ),
)


@pytest.mark.parametrize("bad", BAD, ids=lambda bad: bad.name)
def test_what_does_not_go_with_blends_is_refused_where_it_is_written(bad: Bad) -> None:
    bad.refused()


def test_an_acceleration_time_that_cannot_be_kept_is_an_answer_with_its_numbers() -> None:
    found = plan_document(request_of(acceleration_time_ms=100))
    assert (found["status"], found["reason"], found["proved"]) == ("not_planned", "MOTION_LIMIT", False)
    assert "with an acceleration time of 100 ms" in found["sentence"]
    assert "would be enough" in found["sentence"]
    assert found["refusal"]["unit"] in ("rad/s²", "m/s²")
    assert found["refusal"]["amount"] > 0


def test_a_neighbour_does_not_run_such_a_plan() -> None:
    robot = {**CELL["robot"], "base": {"at_mm": [2000, 0, 0]}}
    other = {"name": "other", "robot": robot, "trajectory": answer()["trajectory"]}
    Bad("blends", {"neighbours": [other]}, "[0].trajectory.acceleration_jumps", on=CELL).refused()
