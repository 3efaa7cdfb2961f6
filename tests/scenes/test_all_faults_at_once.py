"""All faults of a request are reported at once, each with its value; none that only follows from another."""

from __future__ import annotations

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
from assur.scenes.reading import partly
from assur.scenes.requests import cell_of
from assur.scenes.scenarios import load_scenario
from tests.changed import GONE, changed
from tests.scenes.bad_requests import GOOD_REQUEST, NEIGHBOUR


def faults_of(changes: dict[str, Any]) -> dict[str, Any]:
    """Field → value of each fault that is reported of the good request with these changes."""
    with pytest.raises(DocumentError) as caught:
        cell_of(changed(GOOD_REQUEST, changes))
    return {each["field"]: each.get("value", NOTHING) for each in caught.value.errors}


WRONG_NAMES = {"robot.model": "mitsubishi", "bodies[1].pose.frame": "blet", "task[1].place.contact_with[0]": "plat"}
SAID: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "frame and yaw of one target": (
        {"task[2]": {"follow": {"to": {"frame": "blet", "at_mm": [0, 0, 30]}, "duration_ms": 50}}},
        {"task[2].follow.to.yaw_rad": NOTHING, "task[2].follow.to.frame": "blet"},
    ),
    "a unit twice and a target left out": (
        {"frames.belt.conveyor.speed_m_s": 0.25, "task[2].move.to": GONE},
        {"frames.belt.conveyor.speed_mm_s": 250, "task[2].move.to": NOTHING},
    ),
    "names within one list": (
        {"task[1].place.contact_with": ["plate", "plat", "bde"]},
        {"task[1].place.contact_with[1]": "plat", "task[1].place.contact_with[2]": "bde"},
    ),
    "joints that are missing or unknown": (
        {
            "start.joints": {"j1_deg": 17, "j5_deg": 0, "j3_mm": 250},
            "execution": {"lag": {"j7_deg": 1, "j8_deg": 2}},
        },
        {
            "start.joints.j5_deg": 0,
            "start.joints.j2_rad": NOTHING,
            "start.joints.j4_rad": NOTHING,
            "execution.lag.j7_deg": 1,
            "execution.lag.j8_deg": 2,
        },
    ),
}


@pytest.mark.parametrize("name", SAID)
def test_faults_are_reported_together_where_they_are(name: str) -> None:
    changes, expected = SAID[name]
    assert faults_of(changes) == expected


@pytest.mark.parametrize(
    "wrong",
    [
        WRONG_NAMES,
        # of form
        {
            "start.joints.j1_deg": "17",
            "start.joints.j2_deg": None,
            "bodies[0].shape.box.size_mm": [1400, 300],
            "options.optoin": {"a": 1},
            "options.budget_s": 0,
        },
        # within one step, and in the steps after it
        {"task[0].pick.part": "prat", "task[1].place.to.frame": "dail", "task[2].move.to.frame": "wrold"},
        {"task[1].place.part": "prat", "task[1].place.to.frame": "dail", "options.elbow": "keeep"},
        {"start.joints.j1_deg": 500, "start.joints.j3_mm": -3},
        # of form, and beside them names, joints and options without a meaning
        {"options.budget_s": 0, "task[0].pick.part": "prat", "start.joints.j1_deg": 500},
        {"frames.belt.conveyor.speed_mm_s": "fast", "bodies[1].pose.frame": "blet", "options.elbow": "keeep"},
        {"bodies[0].mass_kg": -1, "robot.model": "nobody", "task[1].place.contact_with[0]": "plat"},
        {"robot.tool.tcp_mm": [0, 0], "task[2].move.to.frame": "wrold"},
        {"start.joints.j1_deg": "17", "bodies[2].pose.frame": "gaet"},
        # what is in the gripper after a step with a fault is not known
        {"task[0].pick.dwell_ms": -1, "task[2].move.to.frame": "wrold"},
        {"task[1].place.dwell_ms": -1, "task[2].move.to.frame": "wrold"},
        # what only follows from a fault is none: a body of a wrong frame is there for those who name it
        {"bodies[1].pose.frame": "blet"},
        # what is on a frame that has a fault cannot be read, and has none of its own
        {"frames.dial.turntable.rate_deg_s": 1e5},
        # the part that is placed is the one that a pick with another name was to take
        {"task[0].pick.part": "prat"},
        # the arm is unknown, and so are its joints, its yaw and its bodies
        {"robot.model": "nobody"},
    ],
    ids=" ".join,
)
def test_every_wrong_value_is_reported_with_its_field_and_nothing_else_is(wrong: dict[str, Any]) -> None:
    assert faults_of(wrong) == wrong


@pytest.mark.parametrize(
    ("changes", "fields"),
    [
        ({"frames.dial": {"fixed": {"frame": "dail", "at_mm": [0, 0, 0]}}}, ["frames.dial.fixed.frame"]),
        ({"bodies[3].name": "cup"}, ["bodies[3].name", "task[1].place.contact_with[0]"]),
        (
            {
                "neighbours": changed(NEIGHBOUR["neighbours"], {"[0].robot.model": "nobody"}),
                "bodies[0].pose": {"frame": "other/link1", "at_mm": [0, 0, 0]},
                "bodies[2].pose.frame": "gaet",
                "task[1].place.contact_with": ["other/link-1", "plat"],
            },
            ["neighbours[0].robot.model", "bodies[2].pose.frame", "task[1].place.contact_with[1]"],
        ),
        (
            {
                "start.holding": {"part": "paart", "grasp_m": [0, 0, 0]},
                "bodies[1].pose": GONE,
                "task": [{"move": {"to": {"at_mm": [300, 200, 100]}}}],
            },
            ["start.holding.part"],
        ),
        (
            {
                "frames.dial": {"keyframes": {"points": [{"time_s": 0}, {"time_s": 1, "at_mm": [0, 0]}]}},
                "task": [{"move": {"to": {"at_mm": [300, 200, 100]}}}],
            },
            ["frames.dial.keyframes.points[1].at_mm"],
        ),
    ],
    ids=[
        "a frame on no frame",
        "a name that is taken",
        "a neighbour that is unknown",
        "a held part that is misspelt",
        "a pose of a keyframe, on which a default depends",
    ],
)
def test_a_fault_hides_only_what_names_it(changes: dict[str, Any], fields: list[str]) -> None:
    assert list(faults_of(changes)) == fields


@pytest.mark.parametrize("too_many", [1, 30])
def test_their_number_is_bounded_and_those_left_out_are_counted(too_many: int) -> None:
    many = MOST_FAULTS + too_many
    exceptions = [{"between": [f"no{i}"], "clearance_mm": {"travel": 0, "near": 0}} for i in range(many)]
    bodies = [{**GOOD_REQUEST["bodies"][0], "name": f"body-{i}", "mass_kg": str(i)} for i in range(many)]
    for change in ({"options.clearance_exceptions": exceptions}, {"bodies": GOOD_REQUEST["bodies"] + bodies}):
        with pytest.raises(DocumentError) as caught:
            cell_of(changed(GOOD_REQUEST, change))
        assert (len(caught.value.errors), caught.value.left_out) == (MOST_FAULTS, too_many)
    assert Problem.of_input(caught.value).document()["errors_left_out"] == too_many
    again = pickle.loads(pickle.dumps(caught.value))
    assert (again.errors, again.left_out) == (caught.value.errors, too_many)


def test_a_request_that_is_refused_anyway_is_read_for_a_bounded_time(monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = {"options.budget_s": 0, "task[2].move.to.frame": "wrold"}
    assert faults_of(wrong) == wrong
    monkeypatch.setattr(partly, "LONGEST_S", 0.0)
    assert faults_of(wrong) == {"options.budget_s": 0}


def test_python_shows_all_of_them_and_has_them_as_a_list() -> None:
    wrong = {"task[0].pick.part": "prat", "task[2].move.to.frame": "wrold"}
    with pytest.raises(assur.InputError) as caught:
        assur.plan(changed(GOOD_REQUEST, wrong))
    assert {each["field"]: each["value"] for each in caught.value.errors} == wrong
    assert caught.value.__notes__ == [str(caught.value.more[0])]  # type: ignore[attr-defined]
    assert assur.InputError("field", 1, "2").errors == [{"field": "field", "value": 1, "allowed": "2"}]


def written(path: Path, changes: dict[str, Any]) -> Path:
    """A scenario's file with the good request with these changes."""
    document = {"about": "a cell", "request": changed(GOOD_REQUEST, changes)}
    path.write_text(yaml.safe_dump(document), encoding="utf-8")
    return path


def test_in_a_file_each_fault_has_its_line(tmp_path: Path) -> None:
    path = written(tmp_path / "cell.yaml", WRONG_NAMES)
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
    path = written(tmp_path / "cell.yaml", WRONG_NAMES)
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
    many = written(path, {"bodies": GOOD_REQUEST["bodies"] + cut})
    told = CliRunner().invoke(app, ["plan", str(many)]).stderr.splitlines()
    assert len(told) == MOST_FAULTS + 1
    assert told[-1].startswith("assur: and 7 more faults")


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("demo", {"frames": GONE, "framse": {}}),
        ("demo", {"bodies": GONE, "bodeis": []}),
        ("round-the-base", {"start": "home"}),
        ("round-the-base", {"start.holding": GONE, "start.holdng": {"part": "box"}}),
    ],
)
def test_of_a_key_that_is_no_field_nothing_else_follows(name: str, changes: dict[str, Any]) -> None:
    request = changed(assur.load(name), changes)
    with pytest.raises(assur.InputError) as caught:
        assur.plan(request)
    assert [each["field"] for each in caught.value.errors] == [list(changes)[-1]]
