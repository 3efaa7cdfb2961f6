"""`assur.plan` and what it answers: a mapping over the document, and the motion as arrays."""

from __future__ import annotations

import copy
import json
import pickle
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest

import assur
from assur.api.workers.jobs import FIRST_PLAN
from assur.planner import Scene
from assur.scenes.requests import cell_of, read_plan
from tests.refused import refused_at


@pytest.fixture(scope="module")
def request_() -> dict[str, Any]:
    return copy.deepcopy(FIRST_PLAN)


@pytest.fixture(scope="module")
def answer(request_: dict[str, Any]) -> assur.Answer:
    return assur.plan(request_)


@pytest.fixture(scope="module")
def refused() -> assur.Answer:
    request = copy.deepcopy(FIRST_PLAN)
    request["task"] = [{"move": {"to": {"at_mm": [1500, 0, 250]}}}]
    return assur.plan(request)


def test_an_answer_is_its_document_to_read(answer: assur.Answer) -> None:
    assert answer.planned
    assert answer["duration_s"] == answer.document["duration_s"] == answer.duration_s > 0
    assert dict(answer) == answer.document == answer
    assert list(answer) == list(answer.document)
    assert len(answer) == len(answer.document)
    assert answer.get("reason") is None
    assert json.loads(json.dumps(answer.document)) == answer
    with pytest.raises(TypeError, match="does not support item assignment"):
        answer["duration_s"] = 0.0  # type: ignore[index]


def test_what_is_in_an_answer_is_its_own_and_a_deep_copy_is_changed(answer: assur.Answer) -> None:
    assert answer.arrivals is answer.document["arrivals"]
    mine = copy.deepcopy(answer)
    mine.arrivals[0]["time_s"] = 99.0
    assert mine != answer
    for name in ("document", "planned", "arrivals"):
        with pytest.raises(AttributeError):
            setattr(answer, name, None)


@pytest.mark.parametrize(
    "step",
    [
        *("a", "0.1", None, [0.1], True, 10**400, -(10**400), 1j, np.complex128(1)),
        *(float("nan"), float("inf"), 0.0, -0.004, 1e-12),
    ],
)
def test_a_step_that_is_no_number_is_refused_by_name(answer: assur.Answer, step: Any) -> None:
    with refused_at("dt", match=r"^dt: got .*; allowed: a step in s, a number of at least"):
        answer.trajectory.sample(step)
    taken: list[Any] = [1, np.float32(1), np.int64(1), np.array(1.0)]
    lengths = {len(answer.trajectory.sample(each).times) for each in taken}
    assert lengths == {len(answer.trajectory.sample(1.0).times)}


def test_attributes_hold_what_the_document_holds(answer: assur.Answer) -> None:
    assert answer.arrivals == answer["arrivals"]
    assert answer.margins == answer["margins"]
    assert answer.legs == answer["legs"]
    assert answer.assumptions == answer["assumptions"]
    with pytest.raises(assur.InputError, match=r"answer\.warnings: got 'nothing'.*report: full"):
        _ = answer.warnings
    full = assur.plan({**FIRST_PLAN, "options": {**FIRST_PLAN["options"], "report": "full"}})
    assert full.warnings == full["warnings"] == []
    assert answer.start_s == answer["start_s"]
    assert answer.sentence == ""
    assert f"planned, {answer.duration_s:.3f} s" in repr(answer)


def test_an_answer_with_some_fields_is_shown_and_names_the_others(answer: assur.Answer, refused: assur.Answer) -> None:
    whole = repr(answer)
    assert repr(assur.Answer({key: answer[key] for key in ("status", "duration_s", "arrivals")})) == whole
    assert repr(assur.Answer({key: answer[key] for key in ("status", "duration_s")})) == f"{whole.rsplit(',', 1)[0]}>"
    some = assur.Answer({"status": "planned"})
    assert repr(some) == "<Answer: planned>"
    assert repr(assur.Answer({"status": "not_planned"})) == "<Answer: not planned.>"
    assert repr(assur.Answer(dict(refused))) == repr(refused)
    with pytest.raises(assur.InputError, match=r"answer\.arrivals: got 'nothing'.*`fields`"):
        _ = some.arrivals


def test_a_refusal_says_why_and_has_no_plan(refused: assur.Answer) -> None:
    assert not refused.planned
    assert refused.sentence == refused["sentence"] != ""
    assert refused.sentence in repr(refused)
    for name in ("trajectory", "arrivals", "legs", "margins", "duration_s", "start_s"):
        with pytest.raises(assur.NotPlannedError) as caught:
            getattr(refused, name)
        assert refused.sentence in str(caught.value)


def test_the_checker_takes_the_answer_and_its_document(request_: dict[str, Any], answer: assur.Answer) -> None:
    assert assur.check(request_, answer)["ok"]
    assert assur.check(request_, answer.document)["ok"]
    assert assur.check(MappingProxyType(request_), MappingProxyType(answer.document))["ok"]
    slower = copy.deepcopy(answer.document)
    slower["arrivals"] = slower["arrivals"][1:]
    assert not assur.check(request_, assur.Answer(slower))["ok"]


def test_an_answer_that_was_saved_is_read_again(answer: assur.Answer) -> None:
    again = assur.Answer(json.loads(json.dumps(answer.document)))
    assert (again.trajectory.positions == answer.trajectory.positions).all()
    assert pickle.loads(pickle.dumps(again)) == answer


@pytest.mark.parametrize("document", [{}, {"status": "done"}, {"schema": "assur/1", "task": []}, "planned"])
def test_what_is_no_answer_is_refused(document: Any) -> None:
    with pytest.raises(assur.InputError, match="answer"):
        assur.Answer(document)


def test_knots_are_those_of_the_document_and_read_only(answer: assur.Answer) -> None:
    trajectory, written = answer.trajectory, answer["trajectory"]
    assert trajectory.joint_names == tuple(written["joint_names"])
    assert trajectory.joint_units == ("rad", "rad", "m", "rad")
    assert trajectory.times.tolist() == written["time_s"]
    assert trajectory.positions.tolist() == written["position"]
    assert trajectory.velocities.tolist() == written["velocity"]
    assert trajectory.accelerations.tolist() == written["acceleration"]
    assert trajectory.duration_s == answer.duration_s
    assert trajectory is answer.trajectory
    with pytest.raises(ValueError, match="read-only"):
        trajectory.positions[0, 0] = 1.0


def test_samples_are_the_motion_that_is_proved(request_: dict[str, Any], answer: assur.Answer) -> None:
    cell = cell_of(request_)
    assert isinstance(cell.scene, Scene)
    plan, _, _ = read_plan(cell, answer.document)
    times = np.linspace(answer.start_s, answer.trajectory.end_s, 997)
    samples = answer.trajectory.at(times)
    signs = np.array([float(joint.sign) for joint in cell.conventions])
    for derivative, found in enumerate((samples.positions, samples.velocities, samples.accelerations, samples.jerks)):
        assert np.allclose(found, signs * plan.trajectory.evaluate(times, derivative), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("parts", [1, 3, 100, 375, 1000])
def test_a_step_that_divides_the_duration_ends_with_the_end(answer: assur.Answer, parts: int) -> None:
    trajectory = answer.trajectory
    samples = trajectory.sample(trajectory.duration_s / parts)
    assert samples.times.shape == (parts + 1,)
    assert samples.positions.shape == samples.jerks.shape == (parts + 1, 4)
    assert samples.times[0] == trajectory.start_s
    assert samples.times[-1] == trajectory.end_s
    assert (samples.positions[[0, -1]] == trajectory.positions[[0, -1]]).all()
    assert (samples.velocities[-1] == trajectory.velocities[-1]).all()


def test_a_step_that_does_not_divide_the_duration_ends_with_the_end_too(answer: assur.Answer) -> None:
    trajectory = answer.trajectory
    for dt in (0.004, 0.9 * trajectory.duration_s, 2 * trajectory.duration_s):
        times = trajectory.sample(dt).times
        assert times[-1] == trajectory.end_s
        assert np.allclose(np.diff(times)[:-1], dt)
        assert 0 < np.diff(times)[-1] <= dt * (1 + 1e-6)


@pytest.mark.parametrize("times", [-1.0, [0.0, 1e3], float("nan"), [[0.0]]])
def test_a_time_of_which_nothing_is_known_is_refused(answer: assur.Answer, times: Any) -> None:
    with pytest.raises(assur.InputError, match="times: got"):
        answer.trajectory.at(times)


def test_one_time_is_a_list_of_one(answer: assur.Answer) -> None:
    assert answer.trajectory.at(answer.start_s).positions.shape == (1, 4)


def test_where_the_acceleration_jumps_what_begins_counts() -> None:
    states = [[0.0], [0.5], [2.0]]
    trajectory = assur.Trajectory(
        {
            "joint_names": ["j1"],
            "joint_units": ["rad"],
            "time_s": [0.0, 1.0, 1.0, 2.0],
            "position": [states[0], states[1], states[1], states[1]],
            "velocity": [[0.0], [0.0], [0.0], [0.0]],
            "acceleration": [[1.0], [1.0], [-1.0], [0.0]],
            "acceleration_jumps": True,
        }
    )
    assert trajectory.at(1.0).accelerations.tolist() == [[-1.0]]


@pytest.mark.parametrize(
    ("key", "value"), [("time_s", [0.0, 0.0]), ("joint_names", ["j1"]), ("position", [[1.0]]), ("velocity", "x")]
)
def test_knots_that_are_none_are_refused(answer: assur.Answer, key: str, value: Any) -> None:
    with pytest.raises(assur.InputError, match=r"trajectory\."):
        assur.Trajectory({**answer["trajectory"], key: value})
    left_out = {name: each for name, each in answer["trajectory"].items() if name != key}
    with pytest.raises(assur.InputError, match=rf"trajectory\.{key}"):
        assur.Trajectory(left_out)


def test_the_other_calls_are_those_of_scenes() -> None:
    from assur.scenes import ik, load
    from assur.scenes.requests import robots, shipped_scenarios

    assert assur.load("demo") == load("demo")
    assert assur.robots() == robots()
    assert assur.scenarios() == shipped_scenarios()
    pose = {"at_mm": [350, 0, 150], "yaw_deg": 0}
    assert assur.ik(FIRST_PLAN, pose=pose) == ik(FIRST_PLAN, pose=pose)


def test_a_request_that_is_not_right_is_refused_at_its_field() -> None:
    request = copy.deepcopy(FIRST_PLAN)
    request["start"] = {"joints": {"j1_deg": "-40"}}
    with refused_at("start.joints.j1_deg"):
        assur.plan(request)


@pytest.mark.parametrize("status", [None, "done", np.array(["planned", "not_planned"]), ["planned"]], ids=str)
def test_an_answer_of_another_status_is_none(answer: assur.Answer, status: object) -> None:
    with pytest.raises(assur.InputError, match=r"answer\.status: .*planned or not_planned"):
        assur.Answer({**answer.document, "status": status})
