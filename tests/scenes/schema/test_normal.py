"""What models read: SI, no null, and numbers of NumPy as the numbers that they are, or an error at the field."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from decimal import Decimal
from enum import IntEnum
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from assur.planner.errors import InputError
from assur.scenes import check, load, plan
from assur.scenes.bounds import MAX_DEPTH
from assur.scenes.faults import DocumentError
from assur.scenes.requests import cell_of, request_digest, request_schema, stated_budgets, validate
from assur.scenes.scenarios import shipped
from assur.scenes.schema.normal import ALLOWED, normal, plain
from assur.scenes.units import si_key
from tests.scenes.bad_requests import GOOD_REQUEST


class Grade(IntEnum):
    """A whole number that is not quite an int."""

    SEVEN = 7


def with_joint(value: object) -> dict[str, Any]:
    """The good request with another first joint, in degrees."""
    request = copy.deepcopy(GOOD_REQUEST)
    request["start"]["joints"]["j1_deg"] = value
    return request


@pytest.mark.parametrize(
    "value",
    [
        *(kind(7) for kind in (np.float64, np.float32, np.float16, np.longdouble, np.int64, np.uint8, np.array)),
        np.array(7.0),
        Grade.SEVEN,
    ],
    ids=repr,
)
def test_a_number_of_numpy_means_what_the_same_number_means(value: object) -> None:
    """In millimetres and degrees above all: units are converted by type, and these were once taken for metres."""
    assert request_digest(with_joint(value)) == request_digest(with_joint(7.0))


@pytest.mark.parametrize("type_", [np.float64, np.float32, np.float16])
def test_every_float_of_numpy_is_taken_exactly(type_: Callable[[float], Any]) -> None:
    for value in (0.1, -1.5, 3e-5):
        found = plain(type_(value))
        assert type(found) is float
        assert found == type_(value)
    assert type(plain(np.int64(2**62 + 1))) is int
    assert plain(np.int64(2**62 + 1)) == 2**62 + 1
    assert plain(np.bool_(True)) is True


def test_arrays_are_lists_and_the_caller_s_document_is_left_alone() -> None:
    request = copy.deepcopy(GOOD_REQUEST)
    pose = request["bodies"][0]["pose"]
    pose["at_mm"] = np.array(pose["at_mm"], dtype=float)
    assert request_digest(request) == request_digest(GOOD_REQUEST)
    assert isinstance(pose["at_mm"], np.ndarray)
    assert plain(np.arange(6).reshape(2, 3)) == [[0, 1, 2], [3, 4, 5]]


@pytest.mark.parametrize(
    ("value", "allowed"),
    [
        (np.float64("nan"), "a finite number"),
        (np.float32("inf"), "a finite number"),
        (np.bool_(True), "a number"),
        (np.array([7.0]), "a number"),
        (np.complex128(7.0), ALLOWED),
        (np.timedelta64(7, "ms"), ALLOWED),
        (Decimal(7), ALLOWED),
        (Fraction(7, 2), ALLOWED),
        (slice(7), "a number"),
        (np.float64(1000.0), "-170 to 170"),
    ],
    ids=repr,
)
def test_what_is_no_finite_real_number_is_refused_at_its_field(value: object, allowed: str) -> None:
    with pytest.raises(DocumentError) as caught:
        plan(with_joint(value))
    assert caught.value.field == "start.joints.j1_deg"
    assert caught.value.allowed == allowed


def test_an_extended_float_between_two_floats_is_refused() -> None:
    between = np.longdouble(7) + 4 * np.finfo(np.longdouble).eps
    if float(between) != between:  # on some machines it is a float like any other
        with pytest.raises(DocumentError, match="is exactly"):
            validate(with_joint(between))
    assert plain(np.longdouble(0.1)) == 0.1


def test_a_whole_number_and_a_truth_stay_what_they_are() -> None:
    request = copy.deepcopy(GOOD_REQUEST)
    request["options"] = {"seed": np.int64(3)}
    request["execution"] = {"belt_correction": np.bool_(False)}
    read = validate(request)
    assert read.options.seed == 3
    for key, value, allowed in (("seed", np.float64(3.5), "a whole number"), ("seed", np.True_, "a whole number")):
        request["options"] = {key: value}
        with pytest.raises(DocumentError) as caught:
            validate(request)
        assert (caught.value.field, caught.value.allowed) == (f"options.{key}", allowed)
    request["options"], request["execution"] = {}, {"belt_correction": np.int64(1)}
    with pytest.raises(DocumentError, match=r"belt_correction.*true or false"):
        validate(request)


def test_a_request_and_an_answer_with_numpy_in_them_are_planned_and_checked() -> None:
    request = load("demo")
    request["options"] = {**request.get("options", {}), "stop": "first", "seed": np.int64(1)}
    answer = plan(request)
    answer["trajectory"]["time_s"] = np.array(answer["trajectory"]["time_s"])
    assert check(request, answer)["ok"] is True


def test_nesting_without_end_is_refused() -> None:
    endless: list[Any] = []
    endless.append(endless)
    for request, field in ((endless, r"\[0\]"), (with_joint(endless), "start")):
        with pytest.raises(DocumentError, match=f"^{field}.*deeper nesting"):
            validate(request)


@pytest.mark.parametrize("inner", [[], [1], [1.5], [True, "a"], [[2.0], [3]]], ids=str)
def test_lists_are_nested_as_deep_as_is_allowed_and_no_deeper(inner: list[object]) -> None:
    deep: list[object] = inner
    while len(deepest(deep)) < MAX_DEPTH:
        deep = [deep]
    assert plain(deep) == normal(deep) == deep
    for read in (plain, normal):
        with pytest.raises(DocumentError, match="deeper nesting"):
            read([deep])


def deepest(document: object) -> list[object]:
    """The lists within each other, one a level, where there are most."""
    within = max((deepest(each) for each in document), key=len, default=[]) if isinstance(document, list) else []
    return [document, *within] if isinstance(document, list) else []


def test_keys_and_values_are_in_si_wherever_they_are_and_the_document_is_left_alone() -> None:
    written = {"a": {"at_mm": [1000, 0, 5], "b": [{"yaw_deg": 180}, {"clearance_mm": {"near": 2, "far": 4}}]}}
    before = copy.deepcopy(written)
    assert normal(written) == {
        "a": {"at_m": [1.0, 0.0, 0.005], "b": [{"yaw_rad": math.pi}, {"clearance_m": {"near": 0.002, "far": 0.004}}]}
    }
    assert written == before


def test_names_that_the_document_gives_are_no_quantities() -> None:
    frames = {"belt_mm": {"fixed": {"at_mm": [0, 0, 1000]}}, "s": {"fixed": {"at_m": [0, 0, 0]}}}
    assert normal({"frames": frames})["frames"] == {
        "belt_mm": {"fixed": {"at_m": [0.0, 0.0, 1.0]}},
        "s": {"fixed": {"at_m": [0, 0, 0]}},
    }


@pytest.mark.parametrize("alien", [slice(7), object(), b"7", (7,), {7}, bytearray(b"7")], ids=type)
def test_what_is_no_plain_data_is_refused_inside_a_robot_too(alien: object) -> None:
    for tool in (alien, {"tcp_mm": alien}):
        request = {**GOOD_REQUEST, "robot": {**GOOD_REQUEST["robot"], "tool": tool}}
        with pytest.raises(DocumentError, match=r"^robot\.tool.*a (list|mapping)"):
            validate(request)


@pytest.mark.parametrize(
    ("document", "field"),
    [
        ({"a": [{"b": None}]}, "a[0].b"),
        ({"a": {"at_m": [0, 0, 0], "at_mm": [0, 0, 0]}}, "a.at_mm"),
        ({"at_mm": None}, "at_mm"),
    ],
)
def test_a_null_and_a_quantity_that_is_given_twice_are_refused_where_they_are(document: Any, field: str) -> None:
    with pytest.raises(DocumentError) as caught:
        normal(document)
    assert caught.value.field == field


def test_no_field_of_a_request_ends_in_a_unit_that_is_converted() -> None:
    """A field that did would never be found: every key in a twin unit becomes its SI key."""
    parts = [request_schema(), *request_schema()["$defs"].values()]
    written = [name for part in parts for name in part.get("properties", {})]
    fields = {name for name in written if si_key(name) is None}
    assert {si_key(name)[0] for name in set(written) - fields} <= fields  # type: ignore[index]


@pytest.mark.parametrize(
    ("options", "budgets"),
    [
        (None, (1.0, 0.0)),
        ({}, (1.0, 0.0)),
        ([], (1.0, 0.0)),
        ({"budget_s": 2, "explain_budget_s": 0.5}, (2.0, 0.5)),
        ({"budget_ms": 1500, "explain_budget_ms": 250.0}, (1.5, 0.25)),
        ({"budget_s": "2", "explain_budget_s": None}, (1.0, 0.0)),
        ({"budget_s": -1}, (1.0, 0.0)),
    ],
)
def test_budgets_are_read_before_anything_is_validated(options: Any, budgets: tuple[float, float]) -> None:
    document = {} if options is None else {"options": options}
    assert tuple(stated_budgets(document).values()) == budgets


LONG = 10**5000
"""More digits than Python writes."""


@pytest.mark.parametrize("place", ["whole", "list", "rows", "mapping", "negative"])
def test_a_whole_number_that_no_json_of_ours_has_is_refused_in_an_answer(place: str) -> None:
    for number in (2**53 + 1, 10**400, LONG):
        places = {"whole": number, "list": [1, number], "rows": [[1.0, 2.0], [3, -number]]}
        answer = {**places, "mapping": {"a": [{"b": number}]}, "negative": -number}[place]
        with pytest.raises(DocumentError, match="a whole number up to") as caught:
            plain({"seed": 2**53, "x": answer})
        assert caught.value.field.startswith("x")
        assert len(str(caught.value)) < 100


@pytest.mark.parametrize("value", [LONG, -LONG, [LONG], {"a": LONG}, 10**400], ids=lambda value: type(value).__name__)
def test_a_number_that_python_does_not_write_is_refused_in_words(value: object) -> None:
    told = str(InputError("options.seed", value, "a number"))
    assert "whole number of more than" in told
    assert len(told) < 120
    assert str(InputError("a", 10**19, "less")) == "a: got 10000000000000000000; allowed: less"


@pytest.mark.parametrize("key", ["seed", "unknown"])
def test_a_request_of_python_with_such_a_number_is_refused_at_its_field(key: str) -> None:
    request = dict(shipped("demo").request)
    request["options"] = {**request.get("options", {}), key: LONG}
    with pytest.raises(InputError, match=rf"options\.{key}: got a whole number of more than 20 digits; allowed: "):
        cell_of(request)
