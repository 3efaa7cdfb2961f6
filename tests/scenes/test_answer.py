"""The answer: everything of an outcome, finite, in the maker's convention, and the same plan when it is read back."""

from __future__ import annotations

import copy
import dataclasses
import json
import math
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from pydantic import TypeAdapter, ValidationError

from assur.planner.errors import FaultError, InputError
from assur.planner.model.input_warning import InputWarning, WarningKind
from assur.planner.model.outcome import Census, CensusLine, Certificate, NotPlanned, Outcome, Plan, Planned, Relaxation
from assur.planner.model.refusal import (
    Bodies,
    FrameName,
    JointName,
    LawEnds,
    MotionLimit,
    Obstacle,
    Quantity,
    Reason,
    Refusal,
    Separation,
    Stage,
)
from assur.planner.model.window_missed import Miss, WindowMissed
from assur.planner.pipeline import plan
from assur.planner.trajectory import Trajectory
from assur.scenes.answer import NOTICE, answer_of
from assur.scenes.reading.cell import Cell
from assur.scenes.reading.plan import plan_of
from assur.scenes.requests import cell_of, check_document, with_options
from assur.scenes.schema import answer as document
from assur.scenes.text.json_text import parse_json
from assur.scenes.written_knots import trajectory_document
from tests.refused import refused_at
from tests.scenes.bad_requests import GOOD_REQUEST

FANUC: dict[str, Any] = {
    "schema": "assur/1",
    "robot": {"model": "fanuc-sr-3ia", "tool": {"tcp_mm": [0, 0, -20]}},
    "start": {"joints": {"j1_deg": 0, "j2_deg": 60, "j3_mm": 20, "j4_deg": 0}},
    "task": [{"move": {"name": "down", "to": {"at_mm": [250, 100, 120], "yaw_deg": 30}}}],
    "options": {"budget_s": 60, "max_candidates": 5, "stop": "first", "report": "full"},
}
"""A move downwards of an arm whose lift counts downwards."""


FULL = with_options(GOOD_REQUEST, {"report": "full"})
"""A request whose answer states all that an answer may state."""


@cache
def good() -> tuple[Cell, Outcome]:
    cell = cell_of(FULL)
    return cell, plan(cell.scene)


@cache
def fanuc() -> tuple[Cell, Planned]:
    cell = cell_of(FANUC)
    outcome = plan(cell.scene)
    assert isinstance(outcome, Planned)
    return cell, outcome


def through_json(document: Any) -> Any:
    return parse_json(json.dumps(document, allow_nan=False).encode())


def test_an_answer_says_all_that_is_promised() -> None:
    answer: Any = answer_of(*good())
    assert answer["status"] == "planned"
    assert {
        "duration_s", "trajectory", "arrivals", "legs", "margins", "certificate", "census", "assumptions", "seed",
        "elapsed_s", "notice", "contacts", "lower_bound_s", "first_s", "cut_by_clock", "request_digest", "start_s",
    } <= set(answer)  # fmt: skip
    assert answer["trajectory"]["joint_names"] == ["j1", "j2", "j3", "j4"]
    assert answer["trajectory"]["joint_units"] == ["rad", "rad", "m", "rad"]
    knots = len(answer["trajectory"]["time_s"])
    for key in ("position", "velocity", "acceleration"):
        assert np.array(answer["trajectory"][key]).shape == (knots, 4)
    assert [arrival["control_point"] for arrival in answer["arrivals"]] == ["pick-1", "place-2", "move-3"]
    assert all(arrival["matched"] for arrival in answer["arrivals"][:2])
    assert answer["duration_s"] == answer["trajectory"]["time_s"][-1] - answer["trajectory"]["time_s"][0]
    assert answer["duration_s"] >= answer["lower_bound_s"] > 0
    assert answer["notice"] == NOTICE
    for words in ("ISO 10218", "ISO 13849", "persons are not in the model", "Proved against the model"):
        assert words in NOTICE


def _refused() -> NotPlanned:
    near = Refusal(
        stage=Stage.SCREENING,
        reason=Reason.BODY_COLLISION,
        step=0,
        subject=Bodies(("bar", "cup")),
        interval=(0.1, math.inf),
        facts=Separation(touching=False, gap_m=None, required_m=0.01),
    )
    late = Refusal(
        stage=Stage.WINDOW,
        reason=Reason.WINDOW_MISSED,
        step=0,
        amount=Quantity(0.034, "s"),
        facts=WindowMissed(miss=Miss.TOO_SHORT, open_s=0.1, needed_s=0.134),
    )
    fast = replace(late, subject=JointName("j1"), facts=MotionLimit(obstacle=Obstacle.RATE, rate="jerk"))
    over = replace(late, subject=FrameName("belt"), facts=LawEnds(known_s=(None, 1.0), needed_s=2.0))
    return NotPlanned(
        reason=Reason.WINDOW_MISSED,
        proved=True,
        sentence="the part passes 34 ms too early",
        refusal=late,
        census=Census(9, 9, (CensusLine(near, 9, 0.02), CensusLine(fast, 1), CensusLine(over, 1))),
        relaxation=Relaxation("window", "+20 mm", 1.25, good()[0].scene),
        tried=("window",),
        assumptions=("x: y",),
        seed=3,
        elapsed_s=0.2,
        cut_by_clock=True,
        explain_budget_spent=True,
        warnings=(InputWarning(WarningKind.PART_FLOATS, ("part", "bed"), 0.003),),
    )


def _described() -> dict[str, Any]:
    """Answers of every form, as they leave, by what they are."""
    cell, refused = fanuc()[0], _refused()
    return {
        "planned": answer_of(*good()),
        "planned, with the digest of the proof": answer_of(*good(), certificate="digest"),
        "downwards": answer_of(*fanuc()),
        "not planned": answer_of(cell, refused),
        "not planned, nothing tried": answer_of(cell, dataclasses.replace(refused, refusal=None, relaxation=None)),
    }


ANSWER: TypeAdapter[Any] = TypeAdapter(document.Answer)
VERDICT: TypeAdapter[Any] = TypeAdapter(document.Verdict)


@pytest.mark.parametrize("name", sorted(_described()))
def test_what_is_written_is_what_the_model_reads(name: str) -> None:
    answer = through_json(_described()[name])
    again = ANSWER.dump_python(ANSWER.validate_json(json.dumps(answer)), mode="json")
    assert again == answer


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("colour",), 1),
        (("status",), "perhaps"),
        (("seed",), "1"),
        (("margins", "binds"), None),
        (("margins", "peaks", 0, "jerk"), math.nan),
        (("census", "lines"), {}),
        (("legs", 0, "kind"), "DANCE"),
        (("certificate", "speed"), []),
    ],
)
def test_what_is_no_answer_the_model_refuses(path: tuple[Any, ...], value: Any) -> None:
    answer = here = copy.deepcopy(_described()["planned"])
    for part in path[:-1]:
        here = here[part]
    here[path[-1]] = value
    with pytest.raises(ValidationError):
        ANSWER.validate_json(json.dumps(answer))


def test_a_verdict_is_what_its_model_reads() -> None:
    answer = through_json(answer_of(*good()))
    spoilt = copy.deepcopy(answer)
    spoilt["duration_s"] += 1.0
    for plan_ in (answer, spoilt):
        verdict = through_json(check_document(FULL, plan_))
        assert VERDICT.validate_python(verdict) == verdict


def test_an_answer_is_plain_json_and_its_plan_is_the_same_plan_again() -> None:
    cell, outcome = good()
    assert isinstance(outcome, Planned)
    again, told = plan_of(through_json(answer_of(cell, outcome)), cell.conventions)
    assert told == ()
    _assert_same(again, outcome.plan)


def test_the_makers_convention_leaves_and_comes_back_to_the_bit() -> None:
    cell, outcome = fanuc()
    answer = through_json(answer_of(cell, outcome))
    q, j3 = outcome.plan.trajectory.q, np.array(answer["trajectory"]["position"])[:, 2]
    assert j3[0] == 0.02
    assert j3[-1] > j3[0]  # down is up in numbers
    np.testing.assert_array_equal(j3, -q[:, 2])
    tool_z = cell.scene.robot.forward(q[-1])[0][2] - 0.02
    assert tool_z == pytest.approx(0.12, abs=1e-6)
    assert j3[-1] == pytest.approx(0.25 - 0.14, abs=1e-6)
    _assert_same(plan_of(answer, cell.conventions)[0], outcome.plan)
    assert check_document(FANUC, answer)["ok"] is True


FINITE = st.floats(-9.0, 9.0)


@given(arrays(np.float64, (3, 4), elements=FINITE), arrays(np.float64, (3, 4), elements=FINITE))
def test_any_knots_survive_the_makers_convention_and_json(q: Any, qd: Any) -> None:
    cell, outcome = fanuc()
    trajectory = Trajectory(np.array([0.0, 0.5, 1.25]), q + 0.0, qd + 0.0, np.zeros((3, 4)))
    changed = dataclasses.replace(outcome.plan, trajectory=trajectory)
    answer = answer_of(cell, dataclasses.replace(outcome, plan=changed))
    found = plan_of(through_json(answer), cell.conventions)[0].trajectory
    assert found.q.tobytes() == trajectory.q.tobytes()
    assert found.qd.tobytes() == trajectory.qd.tobytes()


def test_a_digest_is_enough_to_keep_and_not_enough_to_check() -> None:
    answer: Any = answer_of(*good(), certificate="digest")
    assert set(answer["certificate"]) == {"digest", "rows", "covers"}
    assert answer["certificate"]["rows"] > 0
    with refused_at("plan.certificate"):
        check_document(FULL, answer)


@pytest.mark.parametrize("column", ["t0", "t1", "normal"])
def test_a_certificate_with_a_number_that_is_not_one_cannot_be_made(column: str) -> None:
    values = np.full((2, 3) if column == "normal" else 2, np.nan)
    with pytest.raises(InputError):
        _certificate(**{column: values})


def test_a_trajectory_that_is_not_finite_never_leaves() -> None:
    cell, _ = fanuc()

    class Broken:
        time = np.array([0.0, 1.0])
        q = qd = qdd = np.full((2, 4), np.nan)

    with pytest.raises(FaultError):
        trajectory_document(cell, Broken())  # type: ignore[arg-type]


def test_a_refusal_says_all_that_is_promised_and_its_missing_numbers_are_null() -> None:
    cell, _ = fanuc()
    refused = _refused()
    answer = through_json(answer_of(cell, refused))
    assert (answer["status"], answer["reason"], answer["proved"]) == ("not_planned", "WINDOW_MISSED", True)
    assert (answer["explain_budget_spent"], answer["warnings"][0]["kind"]) == (True, "PART_FLOATS")
    assert answer["relaxation"] == {"what": "window", "value": "+20 mm", "duration_s": 1.25, "set": None}
    assert (answer["refusal"]["amount"], answer["refusal"]["unit"]) == (0.034, "s")
    facts = {key: value for key, value in answer["refusal"]["facts"].items() if value is not None}
    assert facts == {"kind": "window", "miss": "too short", "open_s": 0.1, "needed_s": 0.134}
    told, joint, frame = answer["census"]["lines"]
    assert [(each["bodies"], each["joint"], each["frame"]) for each in (told, joint, frame)] == [
        (["bar", "cup"], None, None),
        ([], "j1", None),
        ([], None, "belt"),
    ]
    assert told["facts"]["gap_m"] is None
    assert frame["facts"]["known_s"] == [None, 1.0]
    assert (told["interval_s"], told["least"], told["most"], told["bodies"]) == (
        [0.1, None],
        None,
        0.02,
        ["bar", "cup"],
    )
    assert answer["notice"] == NOTICE
    bare = through_json(answer_of(cell, dataclasses.replace(refused, refusal=None, relaxation=None)))
    assert (bare["refusal"], bare["relaxation"]) == (None, None)
    verdict = check_document(FANUC, bare)
    # what it repeats is of another request, and it does not say what is proved
    assert [finding["code"] for finding in verdict["findings"]] == ["CLAIM", "CLAIM", "REFUSAL"]


SPOILT: dict[str, tuple[Any, Any, str]] = {
    "not a mapping": (None, [], "plan"),
    "unknown field": (("colour",), 1, "plan.colour"),
    "no trajectory": (("trajectory",), None, "plan.trajectory"),
    "joints of another robot": (("trajectory", "joint_names"), ["a", "b", "c", "d"], "plan.trajectory.joint_names"),
    "times that run back": (("trajectory", "time_s", 1), -5.0, "plan.trajectory.time_s[1]"),
    "a row too short": (("trajectory", "velocity", 1), [0.0], "plan.trajectory.velocity[1]"),
    "text for a number": (("trajectory", "position", 0, 0), "0", "plan.trajectory.position[0][0]"),
    "unknown leg": (("legs", 0, "kind"), "DANCE", "plan.legs[0].kind"),
    "an arrival at no time": (("arrivals", 0, "time_s"), "soon", "plan.arrivals[0].time_s"),
    "columns of different lengths": (("certificate", "t1_s"), [], "plan.certificate.t1_s"),
    "more rows than it says": (("certificate", "rows"), 0, "plan.certificate.t0_s"),
    "a normal of two numbers": (("certificate", "normal", 0), [0.0, 1.0], "plan.certificate.normal[0]"),
    "margins that are text": (("margins",), "anything", "plan.margins"),
    "a gap that is text": (("margins", "nearest", "gap_m"), "wide", "plan.margins.nearest.gap_m"),
    "a load that is text": (("load",), "anything", "plan.load"),
    "contacts that are text": (("contacts",), "anything", "plan.contacts"),
    "a census that is text": (("census",), "anything", "plan.census"),
    "warnings that are text": (("warnings",), "anything", "plan.warnings"),
    "a time that is text": (("elapsed_s",), "1.5", "plan.elapsed_s"),
    "a first time that is text": (("first_s",), "1.5", "plan.first_s"),
    "a truth that is text": (("cut_by_clock",), "true", "plan.cut_by_clock"),
    "an index that is no number": (("certificate", "first", 0), 0.5, "plan.certificate.first[0]"),
}


@pytest.mark.parametrize("name", sorted(SPOILT))
def test_a_plan_that_is_no_plan_is_bad_input_at_its_field(name: str) -> None:
    path, value, field = SPOILT[name]
    answer = through_json(answer_of(*fanuc()))
    if path is None:
        answer = value
    else:
        here = answer
        for part in path[:-1]:
            here = here[part]
        here[path[-1]] = value
    with refused_at(field):
        check_document(FANUC, answer)


def _certificate(**columns: Any) -> Certificate:
    reals = {name: np.zeros(2) for name in ("t0", "t1")}
    whole = {name: np.zeros(2, dtype=np.int64) for name in ("first", "first_piece", "second", "second_piece")}
    return Certificate(**{"names": ("a", "b"), "normal": np.zeros((2, 3)), **reals, **whole, **columns})


def _assert_same(one: Plan, other: Plan) -> None:
    for name in ("time", "q", "qd", "qdd"):
        assert getattr(one.trajectory, name).tobytes() == (getattr(other.trajectory, name) + 0.0).tobytes()
    assert (one.legs, one.arrivals) == (other.legs, other.arrivals)
    for field in dataclasses.fields(Certificate):
        a, b = getattr(one.certificate, field.name), getattr(other.certificate, field.name)
        if isinstance(a, np.ndarray):
            np.testing.assert_array_equal(a, b)
            assert a.dtype.kind == b.dtype.kind
        else:
            assert a == b


@pytest.mark.parametrize("claimed", [1.0, 0.9999, 1e9])
def test_a_lower_bound_that_is_not_proved_is_found(claimed: float) -> None:
    """In shares of the duration: of a plan that goes round something nobody proves that there is no shorter one."""
    cell, outcome = good()
    answer = through_json(answer_of(cell, outcome))
    assert check_document(FULL, answer)["ok"]
    answer["lower_bound_s"] = claimed * answer["duration_s"]
    verdict = check_document(FULL, answer)
    assert [(finding["code"], finding["where"]) for finding in verdict["findings"]] == [("CLAIM", "lower_bound_s")]
    answer["lower_bound_s"] = None
    assert check_document(FULL, answer)["ok"]


@pytest.mark.parametrize(("key", "change"), [("duration_s", 1e-6), ("start_s", -1e-6), ("duration_s", -1.0)])
def test_what_an_answer_says_of_its_own_durations_is_held_to_its_trajectory(key: str, change: float) -> None:
    cell, outcome = good()
    answer = through_json(answer_of(cell, outcome))
    answer[key] += change
    _, told = plan_of(answer, cell.conventions)
    assert [(finding.code, finding.where) for finding in told] == [("FORM", key)]
    assert told[0].amount > 0
    verdict = check_document(FULL, answer)
    assert not verdict["ok"]
    assert verdict["findings"][0]["where"] == key
    del answer[key]
    assert plan_of(answer, cell.conventions)[1] == ()
