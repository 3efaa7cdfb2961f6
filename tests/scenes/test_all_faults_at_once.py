"""All faults of a request are reported at once, each with its value; none that only follows from another."""

from __future__ import annotations

import copy
import json
import pickle
import re
from pathlib import Path
from typing import Any

import pytest
import yaml
from typer.testing import CliRunner

import assur
from assur.api.cli.border import BAD_INPUT
from assur.api.command_line import app
from assur.api.problems import Problem
from assur.scenes.faults import MOST_FAULTS, NOTHING, DocumentError
from assur.scenes.requests import cell_of
from assur.scenes.scenarios import load_scenario
from tests.scenes.bad_requests import GOOD_REQUEST


def spoilt(*changes: tuple[str, Any]) -> dict[str, Any]:
    """The good request with each value at its dotted path."""
    request = copy.deepcopy(GOOD_REQUEST)
    for path, value in changes:
        *above, last = [int(part) if part.isdigit() else part for part in path.split(".")]
        here: Any = request
        for part in above:
            here = here[part]
        here[last] = value
    return request


def faults_of(request: dict[str, Any]) -> dict[str, Any]:
    """Field → value of each fault that is reported."""
    with pytest.raises(DocumentError) as caught:
        cell_of(request)
    return {each["field"]: each.get("value", NOTHING) for each in caught.value.errors}


WRONG_NAMES = [
    ("robot.model", "mitsubishi"),
    ("bodies.1.pose.frame", "blet"),
    ("task.1.place.contact_with", ["plat"]),
]


def test_three_wrong_names_are_three_faults() -> None:
    assert faults_of(spoilt(*WRONG_NAMES)) == {
        "robot.model": "mitsubishi",
        "bodies[1].pose.frame": "blet",
        "task[1].place.contact_with[0]": "plat",
    }


def test_frame_and_yaw_of_one_target_are_two_faults() -> None:
    target = {"frame": "blet", "at_mm": [0, 0, 30]}
    request = spoilt(("task.2", {"follow": {"to": target, "duration_ms": 50}}))
    assert faults_of(request) == {"task[2].follow.to.yaw_rad": NOTHING, "task[2].follow.to.frame": "blet"}


def test_faults_of_form_are_reported_with_their_values() -> None:
    request = spoilt(
        ("start.joints.j1_deg", "17"),
        ("start.joints.j2_deg", None),
        ("frames.belt.conveyor.speed_m_s", 0.25),
        ("bodies.0.shape.box.size_mm", [1400, 300]),
        ("options.optoin", {"a": 1}),
        ("options.budget_s", 0),
    )
    del request["task"][2]["move"]["to"]
    assert faults_of(request) == {
        "start.joints.j1_deg": "17",
        "start.joints.j2_deg": None,
        "frames.belt.conveyor.speed_mm_s": 250,
        "bodies[0].shape.box.size_mm": [1400, 300],
        "options.optoin": {"a": 1},
        "options.budget_s": 0,
        "task[2].move.to": NOTHING,
    }


def test_wrong_names_within_one_step_and_one_list_are_all_reported() -> None:
    place = GOOD_REQUEST["task"][1]["place"]
    wrong = {**place, "part": "prat", "contact_with": ["plate", "plat", "bde"], "to": {**place["to"], "frame": "dail"}}
    found = faults_of(spoilt(("task.1.place", wrong), ("options.elbow", "keeep"), ("task.2.move.to.frame", "wrold")))
    assert found == {
        "task[1].place.part": "prat",
        "task[1].place.to.frame": "dail",
        "task[1].place.contact_with[1]": "plat",
        "task[1].place.contact_with[2]": "bde",
        "task[2].move.to.frame": "wrold",
        "options.elbow": "keeep",
    }


def test_all_joints_that_are_missing_unknown_or_out_of_range_are_reported() -> None:
    joints = {"j1_deg": 17, "j5_deg": 0, "j3_mm": 250}
    assert faults_of(spoilt(("start.joints", joints), ("execution", {"lag": {"j7_deg": 1, "j8_deg": 2}}))) == {
        "start.joints.j5_deg": 0,
        "start.joints.j2_rad": NOTHING,
        "start.joints.j4_rad": NOTHING,
        "execution.lag.j7_deg": 1,
        "execution.lag.j8_deg": 2,
    }
    beyond = {"j1_deg": 500, "j2_deg": 68, "j3_mm": -3, "j4_deg": 0}
    assert faults_of(spoilt(("start.joints", beyond))) == {"start.joints.j1_deg": 500, "start.joints.j3_mm": -3}


@pytest.mark.parametrize(
    ("changes", "fields"),
    [
        # a body of a wrong frame is there for those who name it
        ([("bodies.1.pose.frame", "blet")], ["bodies[1].pose.frame"]),
        # what is on a frame that has a fault cannot be read, and has none of its own
        ([("frames.dial.turntable.rate_deg_s", 1e5)], ["frames.dial.turntable.rate_deg_s"]),
        ([("frames.dial", {"fixed": {"frame": "dail", "at_mm": [0, 0, 0]}})], ["frames.dial.fixed.frame"]),
        # the part that is placed is the one that a pick with another name was to take
        ([("task.0.pick.part", "prat")], ["task[0].pick.part"]),
        # the arm is unknown, and so are its joints, its yaw and its bodies
        ([("robot.model", "nobody")], ["robot.model"]),
        ([("bodies.3.name", "cup")], ["bodies[3].name", "task[1].place.contact_with[0]"]),
    ],
)
def test_what_only_follows_from_a_fault_is_none(changes: list[tuple[str, Any]], fields: list[str]) -> None:
    assert list(faults_of(spoilt(*changes))) == fields


def test_a_step_after_one_with_a_fault_is_read_all_the_same() -> None:
    changes = [("task.0.pick.part", "prat"), ("task.1.place.to.frame", "dail"), ("task.2.move.to.frame", "wrold")]
    assert list(faults_of(spoilt(*changes))) == ["task[0].pick.part", "task[1].place.to.frame", "task[2].move.to.frame"]


def test_a_neighbour_with_a_fault_hides_only_what_names_it() -> None:
    other = {
        "name": "other",
        "robot": {"model": "nobody", "tool": {"tcp_mm": [0, 0, 0]}},
        "trajectory": {
            "joint_names": ["j1"],
            "joint_units": ["rad"],
            "time_s": [0.0, 1.0],
            **{key: [[0.0], [0.0]] for key in ("position", "velocity", "acceleration")},
        },
    }
    request = spoilt(
        ("neighbours", [other]),
        ("bodies.0.pose", {"frame": "other/link1", "at_mm": [0, 0, 0]}),
        ("bodies.2.pose.frame", "gaet"),
        ("task.1.place.contact_with", ["other/link-1", "plat"]),
    )
    assert list(faults_of(request)) == [
        "neighbours[0].robot.model",
        "bodies[2].pose.frame",
        "task[1].place.contact_with[1]",
    ]


@pytest.mark.parametrize("too_many", [1, 30])
def test_their_number_is_bounded_and_those_left_out_are_counted(too_many: int) -> None:
    many = MOST_FAULTS + too_many
    exceptions = [{"between": [f"no{i}"], "clearance_mm": {"travel": 0, "near": 0}} for i in range(many)]
    bodies = [{**GOOD_REQUEST["bodies"][0], "name": f"body-{i}", "mass_kg": str(i)} for i in range(many)]
    for change in (("options.clearance_exceptions", exceptions), ("bodies", bodies)):
        with pytest.raises(DocumentError) as caught:
            cell_of(spoilt(change))
        assert (len(caught.value.errors), caught.value.left_out) == (MOST_FAULTS, too_many)
    assert Problem.of_input(caught.value).document()["errors_left_out"] == too_many
    again = pickle.loads(pickle.dumps(caught.value))
    assert (again.errors, again.left_out) == (caught.value.errors, too_many)


def test_python_shows_all_of_them_and_has_them_as_a_list() -> None:
    request = spoilt(("task.0.pick.part", "prat"), ("task.2.move.to.frame", "wrold"))
    with pytest.raises(assur.InputError) as caught:
        assur.plan(request)
    assert [each["field"] for each in caught.value.errors] == ["task[0].pick.part", "task[2].move.to.frame"]
    assert [each["value"] for each in caught.value.errors] == ["prat", "wrold"]
    assert caught.value.__notes__ == [str(caught.value.more[0])]  # type: ignore[attr-defined]
    assert assur.InputError("field", 1, "2").errors == [{"field": "field", "value": 1, "allowed": "2"}]


def test_in_a_file_each_fault_has_its_line(tmp_path: Path) -> None:
    path = tmp_path / "cell.yaml"
    path.write_text(yaml.safe_dump({"about": "a cell", "request": spoilt(*WRONG_NAMES)}), encoding="utf-8")
    scenario = load_scenario(path)
    with pytest.raises(DocumentError) as caught, scenario.located():
        cell_of(scenario.request)
    lines = path.read_text(encoding="utf-8").splitlines()
    found = {each["field"]: lines[each["line"] - 1].strip() for each in caught.value.errors}
    assert found == {
        "request.robot.model": "model: mitsubishi",
        "request.bodies[1].pose.frame": "frame: blet",
        "request.task[1].place.contact_with[0]": "- plat",
    }


def test_the_command_line_reports_them_all_with_their_lines(tmp_path: Path) -> None:
    path = tmp_path / "cell.yaml"
    path.write_text(yaml.safe_dump({"about": "a cell", "request": spoilt(*WRONG_NAMES)}), encoding="utf-8")
    result = CliRunner().invoke(app, ["plan", str(path)])
    assert (result.exit_code, result.stdout) == (BAD_INPUT, "")
    told = re.findall(r'^assur: line \d+: (\S+): got "(\w+)"; allowed: ', result.stderr, re.MULTILINE)
    assert (len(told), result.stderr.count("\n")) == (3, 3)
    assert [value for _, value in told] == ["mitsubishi", "blet", "plat"]
    path.write_text(path.read_text().replace("name: b", "nmae: b").replace("speed_mm_s: 250", "speed_mm_s: fast"))
    result = CliRunner().invoke(app, ["plan", str(path)])
    assert result.stderr.count("nmae") == 2
    assert 'speed_mm_s: got "fast"' in result.stderr
    cut = [{**GOOD_REQUEST["bodies"][0], "name": f"body-{i}", "mass_kg": str(i)} for i in range(MOST_FAULTS + 7)]
    document = json.loads(json.dumps({"about": "a cell", "request": spoilt(("bodies", cut))}))
    path.write_text(yaml.safe_dump(document), encoding="utf-8")
    told = CliRunner().invoke(app, ["plan", str(path)]).stderr.splitlines()
    assert len(told) == MOST_FAULTS + 1
    assert told[-1].startswith("assur: and 7 more faults")
