"""Every quantity has one value in SI, however it was written, and one digest."""

from __future__ import annotations

import copy
import hashlib
import json
import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.errors import InputError
from assur.scenes.requests import request_digest, shipped, validate
from assur.scenes.schema.frames import ConveyorDocument
from assur.scenes.schema.read import read
from assur.scenes.units import SI_UNITS, TWIN_UNITS, from_si, si_key, to_si, twin_of
from tests.scenes.bad_requests import GOOD_REQUEST


@pytest.mark.parametrize(
    ("key", "twin"),
    [
        ("at_m", "at_mm"),
        ("m", "mm"),
        ("yaw_rad", "yaw_deg"),
        ("dwell_s", "dwell_ms"),
        ("speed_m_s", "speed_mm_s"),
        ("rate_rad_s", "rate_deg_s"),
        ("acceleration_m_s2", "acceleration_mm_s2"),
        ("jerk_rad_s3", "jerk_deg_s3"),
        ("mass_kg", None),
        ("velocity", None),
        ("frames", None),
        ("seed", None),
        ("at_mm", None),
    ],
)
def test_each_si_key_has_its_twin_and_no_other_key_has_one(key: str, twin: str | None) -> None:
    assert twin_of(key) == twin
    if twin is not None:
        assert si_key(twin) == (key, next(unit for unit in TWIN_UNITS if twin.endswith(unit)))


def test_every_si_unit_has_exactly_one_twin() -> None:
    assert sorted(TWIN_UNITS.values()) == sorted(SI_UNITS)


@given(st.integers(-10_000_000, 10_000_000))
def test_millimetres_become_the_float_nearest_to_their_metres(micrometres: int) -> None:
    millimetres = micrometres / 1000
    assert to_si(millimetres, "mm") == pytest.approx(micrometres / 1_000_000, rel=1e-15, abs=0)


@given(st.integers(-99_999, 99_999))
def test_whole_millimetres_and_their_metres_are_the_same_float(millimetres: int) -> None:
    assert to_si(millimetres, "mm") == float(f"{millimetres}e-3")


@given(st.floats(-1e4, 1e4))
def test_units_go_there_and_back(value: float) -> None:
    for unit in TWIN_UNITS:
        si = to_si(value, unit)
        assert isinstance(si, float)
        assert from_si(si, unit) == pytest.approx(value, rel=1e-14, abs=1e-300)


@pytest.mark.parametrize("value", ["250", True, None, [True], 10**400])
def test_what_is_no_number_is_left_for_the_model_to_refuse(value: object) -> None:
    assert to_si(value, "mm") == value


def in_si(value: Any) -> Any:
    """The document with SI keys: a second reading, for documents without joint names that end in a unit."""
    if isinstance(value, list):
        return [in_si(item) for item in value]
    if not isinstance(value, dict):
        return value
    found: dict[str, Any] = {}
    for key, item in value.items():
        for ending, si, factor in (
            ("_deg_s", "_rad_s", math.pi / 180),
            ("_mm_s", "_m_s", 1e-3),
            ("_deg", "_rad", math.pi / 180),
        ):
            if key.endswith(ending):
                found[key.removesuffix(ending) + si] = _scaled(item, factor)
                break
        else:
            if key == "mm" or key.endswith("_mm"):
                found[key[:-2] + "m"] = _scaled(item, 1e-3)
            elif key.endswith("_ms"):
                found[key[:-2] + "s"] = _scaled(item, 1e-3)
            else:
                found[key] = in_si(item)
    return found


def _scaled(value: Any, factor: float) -> Any:
    if isinstance(value, list):
        return [_scaled(item, factor) for item in value]
    if isinstance(value, dict):
        return {key: _scaled(item, factor) for key, item in value.items()}
    return round(value * 1e6) / 1e6 * factor if factor != 1e-3 else round(value * 1e6) / 1e9


def test_a_request_in_si_has_the_digest_of_its_twin_in_millimetres() -> None:
    twin = in_si(GOOD_REQUEST)
    assert "_mm" not in str(twin)
    assert validate(twin).canonical() == validate(GOOD_REQUEST).canonical()
    assert request_digest(twin) == request_digest(GOOD_REQUEST)


def test_defaults_written_out_and_keys_in_another_order_do_not_change_the_digest() -> None:
    longer = copy.deepcopy(GOOD_REQUEST)
    for names in ((), ("frames",), ("start", "joints"), ("robot", "limits")):
        mapping = longer
        for name in names:
            mapping = mapping[name]
        items = list(mapping.items())
        mapping.clear()
        mapping.update(reversed(items))
    longer["execution"] = {"belt_correction": False}
    longer["frames"]["belt"]["conveyor"]["yaw_deg"] = 0
    longer["task"][2]["move"]["match"] = "velocity"
    assert request_digest(longer) == request_digest(GOOD_REQUEST)


@pytest.mark.parametrize("name", ["demo", "two-robots", "inside-a-mesh", "shut-gate"])
def test_a_digest_is_that_of_the_whole_request_as_json(name: str) -> None:
    for request in (shipped(name).request, {**shipped(name).request, "frames": {}, "bodies": []}):
        read = validate(request)
        text = read.model_dump_json(by_alias=True, exclude_none=True)
        assert json.loads(text) == read.canonical()
        assert read.digest == "sha256:" + hashlib.sha256(text.encode()).hexdigest()


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("options", "seed"), 2),
        (("options", "clearance_mm", "near"), 1.6),
        (("frames", "belt", "conveyor", "speed_mm_s"), 250.0001),
        (("robot", "limits", "j4_deg"), [-269, 270]),
        (("bodies", 0, "name"), "table"),
    ],
)
def test_any_other_meaning_is_another_digest(path: tuple[str | int, ...], value: object) -> None:
    changed: Any = copy.deepcopy(GOOD_REQUEST)
    here = changed
    for part in path[:-1]:
        here = here[part]
    here[path[-1]] = value
    assert request_digest(changed) != request_digest(GOOD_REQUEST)


def test_a_limit_is_told_in_the_unit_that_was_written() -> None:
    with pytest.raises(InputError) as caught:
        read(ConveyorDocument, {"at_mm": [0, 0, 0], "speed_mm_s": 1e6})
    assert (caught.value.field, caught.value.value) == ("speed_mm_s", 1e6)
    assert caught.value.allowed == "at most 100000 (mm_s)"


@pytest.mark.parametrize(
    ("key", "value", "allowed"),
    [
        ("bodies", [{}] * 1001, "at most 1000 items, not 1001"),
        ("task", [], "at least 1 item, not 0"),
        ("task", [{}] * 65, "at most 64 items, not 65"),
    ],
)
def test_a_list_that_is_too_long_or_too_short_is_told_with_its_length(key: str, value: object, allowed: str) -> None:
    with pytest.raises(InputError) as caught:
        validate({**GOOD_REQUEST, key: value})
    assert (caught.value.field, caught.value.allowed) == (key, allowed)


def test_a_key_that_is_no_text_is_told_by_its_name() -> None:
    number: Any = 7
    for spoilt, field in (({**GOOD_REQUEST, number: 1}, "7"), ({**GOOD_REQUEST, "frames": {number: {}}}, "frames.7")):
        with pytest.raises(InputError) as caught:
            validate(spoilt)
        assert (caught.value.field, caught.value.allowed) == (field, "keys that are text" if field == "7" else "text")
    documents: tuple[object, ...] = ([], None, 7)
    for document in documents:
        with pytest.raises(InputError) as caught:
            validate(document)
        assert (caught.value.field, caught.value.allowed) == ("request", "a mapping of fields")


def test_a_misspelt_key_is_told_before_the_one_that_is_missing_and_the_likeliest_is_named() -> None:
    with pytest.raises(InputError) as caught:
        read(ConveyorDocument, {"at_mm": [0, 0, 0], "sped_mm_s": 10})
    assert caught.value.field == "sped_mm_s"
    assert "did you mean speed_m_s or speed_mm_s?" in caught.value.allowed
    assert [each["field"] for each in caught.value.errors] == ["sped_mm_s", "speed_m_s"]
