"""A problem says what was wrong and repeats nothing that could hurt who reads it."""

from __future__ import annotations

import json
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from assur.api.documents import to_json
from assur.api.problems import STATUS, FieldError, Problem, printable, shown
from assur.planner.errors import InputError
from assur.scenes.faults import NOTHING, DocumentError


@pytest.mark.parametrize("kind", STATUS)
def test_every_kind_of_problem_is_told_as_rfc_9457_has_it(kind: str) -> None:
    document = Problem(kind, "So it is.").document()
    assert set(document) == {"type", "title", "status", "detail"}
    assert document["type"] == f"urn:assur:problem:{kind}"
    assert 400 <= document["status"] <= 599


def test_a_fault_of_the_caller_becomes_a_problem_that_names_field_value_and_what_is_allowed() -> None:
    document = Problem.of_input(InputError("task[0].move", 7, "a mapping")).document()
    assert document["status"] == 422
    assert document["errors"] == [{"field": "task[0].move", "value": 7, "allowed": "a mapping"}]
    assert document["detail"] == "task[0].move: got 7; allowed: a mapping"


def test_a_field_that_is_missing_has_no_value() -> None:
    error = DocumentError(
        "robot.tool", NOTHING, "a mapping", more=[DocumentError("start", 3, "a mapping", 7)], left_out=5
    )
    document = Problem.of_input(error).document()
    assert document["errors"] == [
        {"field": "robot.tool", "allowed": "a mapping"},
        {"field": "start", "value": 3, "allowed": "a mapping", "line": 7},
    ]
    assert document["errors_left_out"] == 5
    assert document["detail"] == "robot.tool: it is missing; allowed: a mapping"


values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text() | st.binary(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner) | st.tuples(inner),
)


@given(field=st.text(), value=values, allowed=st.text())
def test_whatever_a_field_held_the_problem_is_short_strict_json(field: str, value: object, allowed: str) -> None:
    body = to_json(Problem.of_input(InputError(field, value, allowed)).document())
    assert len(body) < 40_000
    assert json.loads(body, parse_constant=_refuse)["status"] == 422
    body.decode("ascii")


def _refuse(name: str) -> None:
    raise AssertionError(f"{name} in a problem")


@given(text=st.text(st.characters(), max_size=400))
def test_a_printed_text_has_no_control_character_and_no_lone_surrogate(text: str) -> None:
    mended = printable(text)
    assert mended.isprintable()
    mended.encode("utf-8")


@pytest.mark.parametrize("value", ["\x1b[31m", "a\nb", "\ud800", "\u202e", "\x00", "a" * 10_000])
def test_what_could_hurt_a_terminal_or_a_log_is_escaped_or_cut(value: str) -> None:
    mended = shown(value)
    assert mended != value
    assert mended.isprintable()
    assert len(mended) <= 200


def test_a_few_numbers_are_told_as_they_are() -> None:
    assert shown([250, -300.5]) == [250, -300.5]
    assert shown([250, float("nan")]) == [250, "a number that is not finite"]
    assert shown([1] * 7) == "a list of 7"
    assert shown({"a": 1}) == "an object with 1 field"


@pytest.mark.parametrize(
    "value", [float("nan"), float("inf"), -float("inf"), 2**60, [1] * 10**6, {"a": 1}, b"x", object()]
)
def test_what_is_not_a_short_scalar_is_told_in_words(value: object) -> None:
    mended = shown(value)
    assert isinstance(mended, str)
    assert len(mended) < 60


def test_a_problem_crosses_the_border_of_a_process_whole() -> None:
    problem = Problem("busy", "Later.", (FieldError("a", NOTHING, "b"),), {"Retry-After": "3"})
    again = pickle.loads(pickle.dumps(problem))
    assert again.document() == problem.document()
    assert again.headers == problem.headers


@pytest.mark.parametrize("number", [float("nan"), float("inf"), -float("inf")])
def test_a_document_of_ours_with_a_number_that_is_not_finite_never_leaves(number: float) -> None:
    with pytest.raises(ValueError, match="JSON"):
        to_json({"duration_s": [number]})


@settings(max_examples=200)
@given(
    st.recursive(
        st.none()
        | st.booleans()
        | st.integers(-(2**53), 2**53)
        | st.floats(allow_nan=False, allow_infinity=False)
        | st.text(st.characters(exclude_categories=())),
        lambda inner: st.lists(inner) | st.dictionaries(st.text(st.characters(exclude_categories=())), inner),
        max_leaves=20,
    )
)
def test_a_document_is_ascii_that_reads_back_the_same_to_the_bit(document: object) -> None:
    body = to_json(document)
    assert body.isascii()
    again = json.loads(body)
    assert again == document
    # 0.0 and −0.0 are equal, True and 1 too: Python's writer tells them apart
    assert json.dumps(again) == json.dumps(document)


@pytest.mark.parametrize("word", ["NaN", "Infinity", "-Infinity", "NaNometre"])
def test_words_that_look_like_no_number_may_be_said(word: str) -> None:
    assert json.loads(to_json({word: [word, 1.5]})) == {word: [word, 1.5]}
    with pytest.raises(ValueError, match="JSON"):
        to_json({word: [word, float("nan")]})


@pytest.mark.parametrize("alien", [np.zeros(2), object()])
def test_what_json_has_no_word_for_is_not_written(alien: object) -> None:
    with pytest.raises(TypeError):
        to_json({"x": alien})
