"""What a request does not know, from the request to the verdict: cells in which an earlier version did damage that it
had proved away, and answers that say less than is true."""

from __future__ import annotations

import copy
import math
from typing import Any

import pytest

from assur.planner.errors import InputError
from assur.scenes.requests import check_document, plan_document, shipped
from tests.scenes.cells.answers import Document, findings_of, not_planned, planned

CUP = {"name": "cup", "shape": {"cylinder": {"radius_mm": 12, "height_mm": 100}}, "at_mm": [0, 0, -50]}
ROBOT = {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_mm": [0, 0, -100], "bodies": [CUP]}}
START = {"joints": {"j1_rad": -0.23, "j2_rad": 1.87, "j3_m": 0.3, "j4_rad": 0.0}}
PART = {"box": {"size_mm": [50, 50, 50]}}
OPTIONS: dict[str, Any] = {
    "stop": "first",
    "budget_s": 60,
    "max_candidates": 80,
    "clearance_mm": {"travel": 4, "near": 4},
    "singularity_margin": 0.1,
}


def cell(**facts: object) -> Document:
    return {"schema": "assur/1", "robot": ROBOT, "start": START, "options": OPTIONS, **copy.deepcopy(facts)}


def fingers(uncertainty: Document, execution: Document, **of_pick: object) -> Document:
    """Two fingers, 0.5 mm beside the part that they take from a belt."""
    request = copy.deepcopy(dict(shipped("dense-flow-uncorrected").request))
    request["bodies"] = [body for body in request["bodies"] if body["name"] not in ("before", "behind")]
    request["frames"]["belt"]["uncertainty"], request["execution"] = uncertainty, execution
    request["options"] = {**request["options"], "stop": "first", "max_candidates": 60}
    request["task"][0]["pick"].update(of_pick)
    return request


@pytest.mark.parametrize(
    ("uncertainty", "execution"), [({"speed_mm_s": 5}, {}), ({}, {"start_tolerance_ms": 40}), ({"position_mm": 5}, {})]
)
def test_fingers_are_not_driven_into_their_part(uncertainty: Document, execution: Document) -> None:
    answer = not_planned(fingers(uncertainty, execution))
    assert any("part" in line["bodies"] for line in answer["census"]["lines"])
    # what gripper and part give way, they may be pressed
    given = fingers(uncertainty, execution, contact_tolerance_mm=16, held_within={"position_mm": 0.5})
    assert planned(given)["arrivals"][0]["error"]["position_m"] > 0.004
    # an error across the belt, where there is room, drives no finger into anything
    assert planned(fingers({"lateral_mm": 5}, {}, held_within={}))["arrivals"][0]["error"]["position_m"] > 0.0049


WALLS: list[Document] = [
    {"name": "bed", "shape": {"box": {"size_mm": [2200, 200, 50]}}, "pose": {"at_mm": [0, 380, 25]}},
    {"name": "part", "shape": PART, "pose": {"frame": "belt", "at_mm": [-900, 0, 25]}},
    {"name": "table", "shape": {"box": {"size_mm": [300, 300, 80]}}, "pose": {"at_mm": [330, -250, 40]}},
    {"name": "wall-a", "shape": {"box": {"size_mm": [10, 80, 60]}}, "pose": {"at_mm": [363, -250, 110]}},
    {"name": "wall-b", "shape": {"box": {"size_mm": [10, 80, 60]}}, "pose": {"at_mm": [297, -250, 110]}},
]


def between_walls(uncertainty: Document, execution: Document, **of_pick: object) -> Document:
    """A part from a belt is put down between two walls, 3 mm from each."""
    pick = {"part": "part", "grasp_mm": [0, 0, 25], "approach": {"mm": 60}, "dwell_ms": 80, "depart": {"mm": 80}}
    place = {"part": "part", "to": {"at_mm": [330, -250, 105], "yaw_deg": 0}, "approach": {"mm": 70}, "dwell_ms": 50}
    return cell(
        frames={"belt": {"conveyor": {"at_mm": [0, 380, 50], "speed_mm_s": 250}, "uncertainty": uncertainty}},
        bodies=WALLS,
        task=[
            {"pick": {**pick, "window_mm": [-200, 150], **of_pick}},
            {"place": {**place, "depart": {"mm": 70}, "contact_with": ["table"]}},
            {"move": {"to": {"at_mm": [300, 0, 200]}}},
        ],
        options={**OPTIONS, "clearance_mm": {"travel": 5, "near": 1.5}, "singularity_margin": 0.15},
        execution=execution,
    )


@pytest.mark.parametrize(("uncertainty", "execution"), [({"speed_mm_s": 5}, {}), ({}, {"start_tolerance_ms": 40})])
def test_what_is_not_known_of_a_part_when_it_is_gripped_stays_in_the_hand(
    uncertainty: Document, execution: Document
) -> None:
    answer = not_planned(between_walls(uncertainty, execution))
    assert any(set(line["bodies"]) & {"wall-a", "wall-b"} for line in answer["census"]["lines"])
    # a gripper that centres the part, and says how well, may put it down there
    centred = planned(between_walls(uncertainty, execution, held_within={"position_mm": 1, "yaw_deg": 0.1}))
    place = centred["arrivals"][1]["error"]
    assert place["horizontal_m"] == pytest.approx(0.001, abs=1e-5)
    assert place["yaw_rad"] == pytest.approx(math.radians(0.1), abs=1e-5)
    assert [share["cause"] for share in place["causes"]] == ["grip"]


def corrected(body: Document, uncertainty: Document) -> Document:
    """A follow on a belt for whose error the controller corrects, beside a post."""
    return cell(
        frames={"belt": {"conveyor": {"at_mm": [0, 380, 50], "speed_mm_s": 250}, "uncertainty": uncertainty}},
        bodies=[{"name": "post", "shape": {"cylinder": {"radius_mm": 15, "height_mm": 500}}, **body}],
        task=[
            {
                "follow": {
                    "to": {"frame": "belt", "at_mm": [-500, 0, 120], "yaw_free": True},
                    "duration_s": 1.0,
                    "window_mm": [-350, 200],
                }
            }
        ],
        options={**OPTIONS, "end": "moving"},
        execution={"belt_correction": True},
    )


def test_a_belt_correction_moves_the_tool_and_not_the_base() -> None:
    """A post on the belt comes within 20 mm of the base column, and the belt may be 8 mm or 18 mm off."""
    near = {"pose": {"frame": "belt", "at_mm": [-526, -347, 250]}}
    planned(corrected(near, {"position_mm": 8}))
    answer = not_planned(corrected(near, {"position_mm": 18}))
    assert any(line["bodies"] == ["base-column", "post"] for line in answer["census"]["lines"])


def test_the_elbow_is_moved_by_more_than_the_tool() -> None:
    """The arm is almost stretched: 6 mm at the tool are more than 17 mm at the elbow."""
    request = corrected({"pose": {"at_mm": [297.79, -189.39, 450]}}, {"position_mm": 6})
    request["bodies"][0]["shape"] = {"cylinder": {"radius_mm": 15, "height_mm": 100}}
    request["start"] = {"joints": {"j1_rad": 0.2, "j2_rad": 0.8, "j3_m": 0.3, "j4_rad": 0.0}}
    request["frames"]["belt"]["conveyor"] = {"at_mm": [535, -1000, 50], "yaw_deg": 90, "speed_mm_s": 250}
    request["task"][0]["follow"].update(
        to={"frame": "belt", "at_mm": [900, 0, 120], "yaw_free": True}, duration_s=0.25, window_mm=[940, 1060]
    )
    request["options"] = {**OPTIONS, "end": "moving", "singularity_margin": 0.05}
    assert any("link-2" in line["bodies"] for line in not_planned(request)["census"]["lines"])
    request["frames"]["belt"]["uncertainty"] = {"position_mm": 0.2}
    planned(request)


@pytest.mark.parametrize(
    ("lag", "accepted"), [({}, True), ({"j1_deg": 0.2}, True), ({"j2_deg": 5}, True), ({"j1_deg": 0.5}, False)]
)
def test_a_joint_that_lags_moves_the_links_behind_it_and_no_other(lag: Document, accepted: bool) -> None:
    """A post is 2 mm farther from the side of link 1 than asked. It is beside the far end of the link, 370 mm from the
    axis: 0.5 degrees of joint 1 are 3.2 mm there, 0.2 degrees 1.3 mm; joint 2 moves what is behind the elbow."""
    post = {"box": {"size_mm": [20, 20, 100]}}
    request = cell(
        start={"joints": {"j1_deg": 0, "j2_deg": 90, "j3_mm": 300, "j4_deg": 0}},
        bodies=[{"name": "post", "shape": post, "pose": {"at_mm": [360, -70 - 4 - 2 - 10, 325]}}],
        task=[{"move": {"to": {"at_mm": [325, 275, 200], "yaw_free": True}}}],
        execution={"lag": lag},
    )
    if accepted:
        planned(request)
    else:
        assert "link-1" in not_planned(request)["sentence"]


@pytest.mark.parametrize("lag_deg", [0.1, 0.4, 2.0])
def test_a_wrist_that_lags_turns_a_tool_on_its_axis_and_does_not_move_it(lag_deg: float) -> None:
    """However far the point is below the flange, which stays upright."""
    task = [{"move": {"to": {"at_mm": [300, 50, 150], "yaw_deg": 20}}}]
    request = cell(task=task, execution={"lag": {"j4_deg": lag_deg}})
    error = planned(request)["arrivals"][0]["error"]
    assert error["yaw_rad"] == pytest.approx(math.radians(lag_deg), abs=1e-5)
    assert error["position_m"] < 1e-5


def on_the_way(speed_mm_s: float = 250) -> Document:
    """A point on a belt that the controller corrects for, a move, and a point in a nest that nobody measures."""
    return cell(
        frames={
            "belt": {"conveyor": {"at_mm": [0, 380, 50], "speed_mm_s": speed_mm_s}, "uncertainty": {"position_mm": 3}},
            "nest": {"fixed": {"at_mm": [330, -250, 100]}, "uncertainty": {"position_mm": 2}},
        },
        task=[
            {"follow": {"to": {"frame": "belt", "at_mm": [-500, 0, 120], "yaw_free": True}, "duration_s": 0.1}},
            {"move": {"to": {"at_mm": [380, 0, 180]}}},
            {"follow": {"to": {"frame": "nest", "at_mm": [0, 0, 20], "yaw_free": True}, "duration_s": 0.1}},
        ],
        execution={"belt_correction": True},
    )


def test_a_correction_is_for_belts_and_shifts_the_tool_on_its_way() -> None:
    """No encoder tells where a nest stands; and a tool that was shifted by 3 mm may still be when it passes a point."""
    plan = planned(on_the_way())
    errors = [arrival["error"]["position_m"] for arrival in plan["arrivals"]]
    assert errors == pytest.approx([0.0, 0.003, 0.002], abs=1e-5)


def test_what_stands_in_a_nest_is_not_where_a_correction_brings_the_tool() -> None:
    """A post 5.5 mm beside the tool must be 4 mm away from it, and its nest may be 2 mm off."""
    post = {"name": "post", "shape": {"cylinder": {"radius_mm": 10, "height_mm": 80}}}
    request = on_the_way()
    request["bodies"] = [{**post, "pose": {"frame": "nest", "at_mm": [27.5, 0, 0]}}]
    request["options"], request["task"] = {**OPTIONS, "max_candidates": 40}, request["task"][2:]
    assert any(set(line["bodies"]) == {"cup", "post"} for line in not_planned(request)["census"]["lines"])
    request["frames"]["nest"]["uncertainty"] = {"position_mm": 1}
    assert planned(request)["margins"]["nearest"]["gap_m"] == pytest.approx(0.0055, abs=1e-4)


def on_a_standing_belt(**changes: Any) -> Document:
    """A point on a conveyor that never runs, 3 mm along which are not known, with belt correction."""
    return cell(
        frames={"belt": {"conveyor": {"at_mm": [380, 0, 50], "speed_mm_s": 0}, "uncertainty": {"position_mm": 3}}},
        task=[{"follow": {"to": {"frame": "belt", "at_mm": [0, 0, 120], "yaw_free": True}, "duration_s": 0.1}}],
        execution={"belt_correction": True},
        options={**OPTIONS, "max_candidates": 40},
        **changes,
    )


def test_a_conveyor_that_never_runs_is_not_told_to_be_corrected_for() -> None:
    """Its encoder counts nothing, so the tool may miss a point on it by all that is not known of where it stands. One
    that will run is a belt."""
    plan = planned(on_a_standing_belt())
    assert plan["arrivals"][0]["error"]["position_m"] == pytest.approx(0.003, abs=1e-5)
    starts = on_a_standing_belt()
    starts["frames"]["belt"]["conveyor"]["changes"] = [
        {"at_s": 50, "speed_mm_s": 100, "acceleration_mm_s2": 500, "jerk_mm_s3": 5000}
    ]
    assert planned(starts)["arrivals"][0]["error"]["position_m"] == pytest.approx(0.0, abs=1e-5)


@pytest.mark.parametrize("place", [{"at_mm": [380 + 27, 0, 150]}, {"frame": "belt", "at_mm": [27, 0, 100]}])
@pytest.mark.parametrize(("unknown_mm", "found"), [(3, False), (0.5, True)])
def test_beside_a_conveyor_that_never_runs_the_tool_may_be_shifted_or_not(
    place: Document, unknown_mm: float, found: bool
) -> None:
    """A post is 5 mm beside the tool, and 4 mm is asked: one in the world is nearer if the tool is shifted, one on the
    belt if it is not."""
    post = {"name": "post", "shape": {"cylinder": {"radius_mm": 10, "height_mm": 80}}, "pose": place}
    request = on_a_standing_belt(bodies=[post])
    request["frames"]["belt"]["uncertainty"] = {"position_mm": unknown_mm}
    if found:
        planned(request)
    else:
        assert any(set(line["bodies"]) == {"cup", "post"} for line in not_planned(request)["census"]["lines"])


def test_signs_of_the_worst_error_are_those_of_the_makers_joints() -> None:
    """The Fanuc counts its lift downwards: a nest that is off upwards is worst for a lift that is too low."""
    request = cell(
        robot={"model": "fanuc-sr-3ia", "tool": {"tcp_mm": [0, 0, -50]}},
        start={"joints": {"j1_deg": 0, "j2_deg": 60, "j3_mm": 20, "j4_deg": 0}},
        frames={"nest": {"fixed": {"at_mm": [250, 150, 100]}, "uncertainty": {"vertical_mm": 1}}},
        task=[{"follow": {"to": {"frame": "nest", "at_mm": [0, 0, 20], "yaw_free": True}, "duration_s": 0.1}}],
        execution={"lag": {"j3_mm": 0.5}},
    )
    plan = planned(request)
    error = plan["arrivals"][0]["error"]
    worst = {each["what"]: each["value"] for each in error["worst"]}
    assert error["vertical_m"] == pytest.approx(0.0015, abs=1e-5)
    assert worst["j3"] == worst["nest up"]


def set_down(amplitude_deg: float, **options: object) -> Document:
    """A part is put down where a bar swings by."""
    pick = {"part": "part", "grasp_mm": [0, 0, 25], "approach": {"mm": 60}, "dwell_ms": 80, "depart": {"mm": 80}}
    place = {"part": "part", "to": {"at_mm": [300, 200, 100], "yaw_deg": 0}, "approach": {"mm": 70}, "dwell_ms": 50}
    return cell(
        frames={"gate": {"swing": {"pivot_mm": [300, 350, 120], "amplitude_deg": amplitude_deg, "period_s": 1.0}}},
        bodies=[
            {
                "name": "bar",
                "shape": {"box": {"size_mm": [500, 20, 20]}},
                "pose": {"frame": "gate", "at_mm": [0, -50, 0]},
            },
            {"name": "part", "shape": PART, "pose": {"at_mm": [300, -200, 100]}},
        ],
        task=[{"pick": pick}, {"place": {**place, "depart": {"mm": 70}}}, {"move": {"to": {"at_mm": [300, 0, 200]}}}],
        options={**OPTIONS, "clearance_mm": {"travel": 2, "near": 1}, **options},
    )


def test_a_part_that_was_put_down_is_kept_clear_of_what_passes_by() -> None:
    answer = not_planned(set_down(69, stay_safe_s=2))
    assert any(line["bodies"] == ["part", "bar"] for line in answer["census"]["lines"])
    planned(set_down(11, stay_safe_s=2))


def test_a_step_that_must_be_exact_is_refused_with_the_cause_that_adds_most() -> None:
    request = between_walls({"speed_mm_s": 5}, {"start_tolerance_ms": 4}, held_within={}, tolerance_mm=16)
    request["execution"]["lag"] = {"j1_deg": 0.02, "j2_deg": 0.02}
    error = planned(request)["arrivals"][0]["error"]
    shares = {share["cause"]: share["position_m"] for share in error["causes"]}
    assert list(shares) == ["frame", "late start", "servo lag"]
    assert shares["late start"] == pytest.approx(0.001, abs=1e-6)  # 250 mm/s for 4 ms
    assert max(shares.values()) < error["position_m"] <= sum(shares.values()) + 1e-5
    request["task"][0]["pick"]["tolerance_mm"] = 8
    answer = not_planned(request)
    assert answer["reason"] == "TOLERANCE"
    assert "only 8 mm are allowed" in answer["sentence"]
    assert "is due to: frame" in answer["sentence"]
    tight = copy.deepcopy(request)
    tight["task"][0]["pick"].pop("tolerance_mm")
    tight["task"][0]["pick"]["tolerance_deg"] = 0.01
    assert not_planned(tight)["reason"] == "TOLERANCE"


def test_a_plan_that_drops_what_is_not_known_of_the_held_part_is_found() -> None:
    """The plan for a gripper that centres its part exactly, against requests in which the part may be off by more."""
    uncertainty, exact = {"speed_mm_s": 5}, {"position_mm": 0, "yaw_deg": 0}
    request = between_walls(uncertainty, {}, held_within=exact)
    plan = planned(request)
    assert check_document(request, plan)["ok"]
    for within in ({"position_mm": 12, "yaw_deg": 0}, None):
        of_pick = {} if within is None else {"held_within": within}
        findings = check_document(between_walls(uncertainty, {}, **of_pick), plan)["findings"]
        rows = [finding for finding in findings if finding["code"] == "ROW"]
        assert rows
        assert "wall-" in rows[0]["what"]


def beside_a_neighbour(tolerance_ms: float) -> Document:
    request = copy.deepcopy(dict(shipped("two-robots").request))
    request["execution"] = {"start_tolerance_ms": tolerance_ms}
    request["options"] = {**request["options"], "stop": "first"}
    return request


def test_rows_that_leave_out_a_late_start_are_found() -> None:
    plan, on_time = planned(beside_a_neighbour(5)), planned(beside_a_neighbour(0))
    assert on_time["certificate"]["shift0_s"] is None
    assert max(plan["certificate"]["shift1_s"]) == 0.005
    forged = copy.deepcopy(plan)
    forged["certificate"]["shift1_s"] = [0.9 * shift for shift in plan["certificate"]["shift1_s"]]
    codes = findings_of(beside_a_neighbour(5), forged)
    assert codes == {"COVER", "DIGEST"}
    turned = copy.deepcopy(plan)
    for one, other in (("first", "second"), ("first_piece", "second_piece")):
        turned["certificate"][one], turned["certificate"][other] = plan["certificate"][other], plan["certificate"][one]
    turned["certificate"]["normal"] = [[-x for x in n] for n in plan["certificate"]["normal"]]
    assert "COVER" in findings_of(beside_a_neighbour(5), turned)


def test_a_plan_goes_on_with_the_part_in_the_gripper() -> None:
    place = {"part": "part", "to": {"at_mm": [330, -250, 105], "yaw_deg": 0}, "approach": {"mm": 70}, "dwell_ms": 50}
    bodies = [body for body in WALLS if body["name"] in ("table", "wall-a", "wall-b")]

    def holding(within: Document) -> Document:
        return cell(
            start={**START, "holding": {"part": "part", "grasp_mm": [0, 0, 25], "within": within}},
            bodies=[*bodies, {"name": "part", "shape": PART}],
            task=[{"place": {**place, "depart": {"mm": 60}, "contact_with": ["table"]}}],
            options={**OPTIONS, "clearance_mm": {"travel": 2, "near": 1.5}, "max_candidates": 200},
        )

    plan = planned(holding({"position_mm": 0.9}))
    assert plan["arrivals"][0]["error"]["causes"] == [{"cause": "grip", "position_m": 0.0009, "yaw_rad": 0.0}]
    walls = {"wall-a", "wall-b"}
    assert any(set(line["bodies"]) & walls for line in not_planned(holding({"position_mm": 2}))["census"]["lines"])


def test_a_clearance_may_be_another_for_some_bodies() -> None:
    request = between_walls({}, {}, held_within={})
    request["options"]["clearance_mm"] = {"travel": 6, "near": 4}
    assert any("part" in line["bodies"] for line in not_planned(request)["census"]["lines"])
    exception = {"between": ["part"], "and": ["wall-a", "wall-b"], "clearance_mm": {"travel": 3, "near": 2}}
    request["options"]["clearance_exceptions"] = [exception]
    plan = planned(request)
    # the answer to the request with the exception is none to the one without, and not to one that asks for more
    del request["options"]["clearance_exceptions"]
    assert "ROW" in findings_of(request, plan)
    wider = {"between": ["cup"], "clearance_mm": {"travel": 300, "near": 300}}
    request["options"].update(clearance_mm={"travel": 2, "near": 1}, clearance_exceptions=[wider])
    not_planned(request)


@pytest.mark.parametrize("rises", [0, 20])
def test_a_correction_upwards_is_refused_for_the_range_of_the_lift_is_not_proved_for_it(rises: int) -> None:
    law = {"at_mm": [350, 0, 100], "velocity_mm_s": [100, 0, rises]}
    frames = {"ramp": {"linear": law, "uncertainty": {"position_mm": 1}}}
    task = [{"follow": {"to": {"frame": "ramp", "at_mm": [0, 0, 0], "yaw_free": True}, "duration_ms": 50}}]
    request = cell(frames=frames, task=task, execution={"belt_correction": True})
    if not rises:
        planned(request)
        return
    with pytest.raises(InputError, match="ramp rises"):
        plan_document(request)
    # a body that rises, and that no step follows, is not corrected for
    request["frames"]["level"] = {"linear": {"at_mm": [350, 0, 100], "velocity_mm_s": [100, 0, 0]}}
    request["task"][0]["follow"]["to"]["frame"] = "level"
    planned(request)
