"""A start at the end of a joint's range, as controllers print it: taken at the end and reported, or refused with a
range in which the number is not."""

from __future__ import annotations

import copy
import math
import re
from typing import Any

import pytest

from assur.planner.errors import InputError
from assur.scenes.conventions import as_maker
from assur.scenes.faults import between
from assur.scenes.inverse_kinematics import ik
from assur.scenes.requests import cell_of, check_document, plan_document

END = math.radians(-145)
REQUEST: dict[str, Any] = {
    "schema": "assur/1",
    "robot": {
        "scara": {
            "l1_mm": 325,
            "l2_mm": 225,
            "joints": [
                {"name": "j1", "range_deg": [-170, 170], "velocity_rad_s": 7, "acceleration_rad_s2": 70,
                 "jerk_rad_s3": 1000},
                {"name": "j2", "range_deg": [-145, 145], "velocity_rad_s": 7, "acceleration_rad_s2": 70,
                 "jerk_rad_s3": 1000},
                {"name": "j3", "range_mm": [100, 300], "velocity_m_s": 2, "acceleration_m_s2": 20, "jerk_m_s3": 400},
                {"name": "j4", "range_deg": [-360, 360], "velocity_rad_s": 20, "acceleration_rad_s2": 200,
                 "jerk_rad_s3": 4000},
            ],
            "bodies": [{"name": "rod", "link": "quill", "shape": {"cylinder": {"radius_mm": 12, "height_mm": 200}},
                        "at_mm": [0, 0, 100]}],
            "self_pairs": [],
        },
        "tool": {"tcp_mm": [0, 0, 0]},
    },
    "start": {"joints": {"j1_deg": 0, "j2_rad": -2.5307274253, "j3_mm": 250, "j4_deg": 0}},
    "task": [{"move": {"name": "go", "to": {"at_mm": [300, 250, 200], "yaw_deg": 90}}}],
    "options": {"stop": "first", "seed": 1, "max_candidates": 100, "budget_s": 20, "explain_budget_s": 0},
}  # fmt: skip
"""A start that was read back from a controller: 1e-8 rad outside of the range."""


def started(**joints: float) -> dict[str, Any]:
    request = copy.deepcopy(REQUEST)
    given: dict[str, float] = {"j1_deg": 0, "j2_deg": 60, "j3_mm": 250, "j4_deg": 0}
    for key, value in joints.items():
        given = {other: old for other, old in given.items() if other[:2] != key[:2]} | {key: value}
    request["start"]["joints"] = given
    return request


def test_a_start_that_was_read_back_is_planned_from_the_end_of_the_range_and_reported() -> None:
    answer = plan_document(REQUEST)
    assert answer["status"] == "planned"
    assert answer["trajectory"]["position"][0][1] == pytest.approx(END, abs=1e-15)
    (sentence,) = (each for each in answer["assumptions"] if each.startswith("start: "))
    assert sentence == (
        "start: j2 is given at -2.5307274253 rad, which is outside of its range by 9.9e-09; "
        f"it is taken at the end of the range, {END!r} rad"
    )
    assert check_document(REQUEST, answer)["ok"]


@pytest.mark.parametrize(
    ("joints", "name", "end"),
    [
        ({"j2_deg": 145.00005}, "j2", -END),
        ({"j1_rad": 2.96705}, None, None),  # within, and rounded towards the middle
        ({"j1_rad": 2.967061}, "j1", math.radians(170)),
        ({"j3_mm": 300.0001}, "j3", 0.3),
        ({"j3_m": 0.0999999}, "j3", 0.1),
        ({"j4_deg": -360.0004}, "j4", -2 * math.pi),
    ],
)
def test_a_joint_within_a_millionth_of_its_range_is_moved(joints: dict[str, float], name: str | None, end: Any) -> None:
    cell = cell_of(started(**joints))
    told = [each for each in cell.scene.assumptions if each.startswith("start: ")]
    if name is None:
        assert told == []
        return
    (sentence,) = told
    assert sentence.startswith(f"start: {name} is given at ")
    i = [joint.name for joint in cell.conventions].index(name)
    assert as_maker(cell.scene.start.q, cell.conventions)[i] == pytest.approx(end, abs=1e-15)
    limits = cell.scene.robot.limits
    assert ((limits.lower <= cell.scene.start.q) & (cell.scene.start.q <= limits.upper)).all()


@pytest.mark.parametrize(
    ("joints", "words"),
    [
        ({"j2_rad": -2.530734}, "-2.53073 to 2.53073; it is outside by 6.6e-06"),
        ({"j2_deg": 145.0004}, "-145 to 145; it is outside by 0.0004"),
        ({"j3_mm": 300.0004}, "100 to 300; it is outside by 0.0004"),
        ({"j4_deg": -361.0}, "-360 to 360"),
    ],
)
def test_further_outside_it_is_refused_and_the_number_is_not_in_the_range_as_it_is_printed(
    joints: dict[str, float], words: str
) -> None:
    with pytest.raises(InputError) as caught:
        cell_of(started(**joints))
    assert caught.value.allowed == words
    low, high = (float(each) for each in re.findall(r"-?[0-9.]+", words)[:2])
    assert not low <= float(str(caught.value.value)) <= high or "outside by" in words


def test_a_speed_at_the_start_is_refused_with_the_excess_that_six_digits_hide() -> None:
    request = started()
    request["start"]["velocity"] = {"j1_rad_s": 7.000001, "j2_rad_s": 0, "j3_m_s": 0, "j4_rad_s": 0}
    with pytest.raises(InputError, match=r"-7 to 7; it is outside by 9\.9e-07"):
        cell_of(request)


def test_a_range_that_a_request_narrows_is_refused_with_the_excess_that_six_digits_hide() -> None:
    request = started()
    request["robot"]["limits"] = {"j2_rad": [-2.5307275, 2]}
    with pytest.raises(InputError, match=r"-2\.53073 to 2\.53073; it is outside by 8\.5e-08"):
        cell_of(request)
    request["robot"]["limits"] = {"j2_rad": [1, -1]}
    with pytest.raises(InputError) as caught:
        cell_of(request)
    assert "outside" not in caught.value.allowed


def test_the_tool_is_not_computed_for_joints_outside_of_their_range() -> None:
    with pytest.raises(InputError, match=r"it is outside by 9[.]9e-09"):
        ik(cell_of(started()), {"joints": REQUEST["start"]["joints"]})


@pytest.mark.parametrize(
    ("key", "value", "most"),
    [("yaw_deg", 57295.79, 57295.7795131), ("at_mm", [100000.01, 0, 0], 100000.0), ("yaw_rad", 1000.0001, 1000.0)],
)
def test_a_bound_of_the_schema_is_printed_with_the_digits_by_which_a_number_is_beyond_it(
    key: str, value: Any, most: float
) -> None:
    request = started()
    pose = {"at_mm": [100, 0, 0], key: value}
    request["bodies"] = [{"name": "post", "shape": {"sphere": {"radius_mm": 9}}, "pose": pose}]
    with pytest.raises(InputError) as caught:
        cell_of(request)
    (bound,) = re.findall(r"at most ([0-9.e+]+)", caught.value.allowed)
    assert float(bound) == pytest.approx(most, rel=1e-12)
    assert float(str(caught.value.value)) > float(bound)


def test_a_range_is_printed_with_the_excess_only_where_it_is_needed() -> None:
    assert between(-1, 1, 2) == "-1 to 1"
    assert between(0, 1 / 3, 0.3333334) == "0 to 0.333333; it is outside by 6.7e-08"
    assert between(-1 / 3, 1 / 3, -0.34) == "-0.333333 to 0.333333"
    assert between(-0.99999999, 1, -1.0) == "-1 to 1; it is outside by 1e-08"
    assert between(-1, 1.0, 1.0) == "-1 to 1; it is outside by less than 1e-12"
