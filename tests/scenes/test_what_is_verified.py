"""Every field of a planned answer has one place in the table of `scenes.schema.checked`, which docs/api.md ("The
verdict") repeats, and the checker does with it what the table says: a changed value is refused, whoever made the digest
fit, or not looked at."""

from __future__ import annotations

import copy
import re
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, NotRequired, Required, Union, get_args, get_origin

import pytest
from typing_extensions import get_type_hints, is_typeddict

from assur.scenes.reading.cell import Cell
from assur.scenes.requests import cell_of, check_document, check_plan, plan_cell, plan_document, read_plan, with_options
from assur.scenes.scenarios import shipped
from assur.scenes.schema import answer as document
from assur.scenes.schema.checked import (
    NOT_CHECKED,
    ONE_SIDE,
    PLACES,
    PROVED_AND_RECOMPUTED,
    RECOMPUTED,
    VERIFIED,
    not_checked,
)
from tests.forgeries.test_forgeries import findings, sealed
from tests.scenes.cells.answers import findings_of
from tests.scenes.forged_cells import answered

PAGE = Path(__file__).parents[2] / "docs" / "api.md"
CELLS = (
    "transfer",
    "blended",
    "traced",
    "rv-m1",
    "late",
    "five-bar",
    "waiting",
    "heavy",
    "demo",
    "floating",
    "uncertain",
    "put-down",
)
"""Answers that together have a value in every field: errors, a load, a via that is missed, a trace, pitch and roll, a
neighbour that may be late, a closed chain, a warning."""
KEPT = ("certificate.digest", "request_digest")
"""Fields that are not made to fit again after a change: they are what is changed."""
Path_ = tuple[str | int, ...]


def leaves(kind: Any, path: tuple[str, ...] = ()) -> set[tuple[str, ...]]:
    """Paths of all fields of a TypedDict that have no fields of their own; items of lists have the path of the list."""
    if is_typeddict(kind):
        hints = get_type_hints(kind, include_extras=False)
        return {leaf for name, inner in hints.items() for leaf in leaves(inner, (*path, name))}
    origin, inside = get_origin(kind), [each for each in get_args(kind) if each is not type(None)]
    if origin in (Annotated, Required, NotRequired, list):
        return leaves(inside[0], path)
    if origin in (Union, UnionType):
        return set.union(*(leaves(each, path) for each in inside))
    return {path}


FIELDS = sorted(".".join(leaf) for leaf in leaves(document.PlannedAnswer))


def rows() -> list[list[str]]:
    """The fields in each row of the table of the page."""
    text = PAGE.read_text(encoding="utf-8").split("\n## The verdict\n")[1]
    lines = text.split("| fields | the checker |\n|---|---|\n")[1].split("\n\n")[0].splitlines()
    return [re.findall(r"`([^`]+)`", line.split("|")[1]) for line in lines]


def place(field: str) -> tuple[str, ...]:
    """The place of a field: where its own name stands, or that of the nearest field above it."""
    parts = field.split(".")
    for count in range(len(parts), 0, -1):
        found = [names for names in PLACES if ".".join(parts[:count]) in names]
        if found:
            assert len(found) == 1, f"{field} has two places"
            return found[0]
    raise AssertionError(f"{field} has no place in scenes.schema.checked: is it verified?")


def values(inside: Any, parts: tuple[str, ...], at: Path_ = ()) -> list[Path_]:
    """Where in an answer a field has a value, scalars within lists one by one."""
    if isinstance(inside, list):
        return [found for i, item in enumerate(inside[:40]) for found in values(item, parts, (*at, i))]
    if not parts:
        return [at]
    if not (isinstance(inside, dict) and parts[0] in inside):
        return []
    return values(inside[parts[0]], parts[1:], (*at, parts[0]))


def held(answer: Any, where: Path_) -> Any:
    for key in where:
        answer = answer[key]
    return answer


def changed(value: Any) -> list[Any]:
    """Other values of the same type, on both sides of a number."""
    if isinstance(value, bool):
        return [not value]
    if isinstance(value, int):
        return [value + 1, value - 1]
    if isinstance(value, float):
        by = max(0.1 * abs(value), 1e-3)
        return [value + by, value - by, 10.0 * value + 1.0]
    if value is None:
        return [1.0, "x"]
    return [{**value, "more": 1}] if isinstance(value, dict) else [f"{value}x"]


def verdicts(field: str) -> list[list[str]]:
    """What the checker finds for each change of one value of the field, of a null if there is no other; digests are
    made to fit the change."""
    places = [(name, where) for name in CELLS for where in values(answered(name)[1], tuple(field.split(".")))]
    full = [(name, where) for name, where in places if held(answered(name)[1], where) is not None]
    assert places, f"no answer has the field {field}"
    name, where = (full or places)[0]
    cell, answer = answered(name)
    found = []
    for other in changed(held(answer, where)):
        forged = copy.deepcopy(answer)
        held(forged, where[:-1])[where[-1]] = other
        found.append(findings(cell, forged if field in KEPT else sealed(cell, forged)))
    return found


def test_the_page_has_the_table() -> None:
    assert [sorted(names) for names in rows()] == [sorted(names) for names in PLACES]


def test_only_census_notes_and_timings_are_not_checked() -> None:
    """What may be left unchecked is decided here, too."""
    timings = {"elapsed_s", "first_s", "cut_by_clock"}
    limits, legs = {"margins.binds", "margins.busiest", "margins.helps"}, {"legs.note", "legs.route"}
    assert set(NOT_CHECKED) == {"arrivals.window_left_s", "census", "warnings"} | timings | limits | legs
    assert RECOMPUTED == ("lower_bound_s",)
    assert PROVED_AND_RECOMPUTED == ("arrivals.error",)


def test_the_table_names_only_fields_that_there_are() -> None:
    above = {".".join(field.split(".")[:count]) for field in FIELDS for count in range(1, 9)}
    assert [name for names in PLACES for name in names if name not in above] == []


@pytest.mark.parametrize("field", FIELDS)
def test_the_checker_does_with_a_field_what_the_table_says(field: str) -> None:
    where, found = place(field), verdicts(field)
    if where in (VERIFIED, PROVED_AND_RECOMPUTED):
        assert all(found), "a changed value is not refused"
    elif where in (ONE_SIDE, RECOMPUTED):
        assert any(found), "no changed value is refused"
    else:
        told = [each for verdict in found for each in verdict]
        assert not [each for each in told if "; allowed: " not in each], "it is looked at, after all"


@pytest.mark.parametrize("name", CELLS)
def test_the_verdict_lists_what_is_not_checked(name: str) -> None:
    cell, answer = answered(name)
    verdict = check_plan(cell, *read_plan(cell, answer))
    assert verdict["ok"]
    windows = any(arrival["window_left_s"] is not None for arrival in answer["arrivals"])
    assert verdict["not_checked"] == [name for name in NOT_CHECKED if windows or name != "arrivals.window_left_s"]
    less = {key: value for key, value in answer.items() if key not in ("census", "warnings", "first_s", "margins")}
    less["legs"] = [{key: value for key, value in leg.items() if key not in ("route", "note")} for leg in less["legs"]]
    less["arrivals"] = [{**arrival, "window_left_s": None} for arrival in less["arrivals"]]
    assert not_checked(less) == ("cut_by_clock", "elapsed_s")
    bare = {key: less[key] for key in document.CheckedPlan.__annotations__}
    assert check_plan(cell, *read_plan(cell, sealed(cell, bare)))["not_checked"] == []


NOTES = (
    (("margins", "binds"), "velocity of j1 (98 %)"),
    (("margins", "busiest"), None),
    (("margins", "helps"), "less travel of j1"),
    (("legs", 0, "note"), "straight"),
    (("legs", 0, "route"), {"course": "straight", "vias": 0, "after_wait": True, "later": False}),
    (("arrivals", 0, "window_left_s"), 1000.0),
)
"""Notes, and other values that have their form."""


@pytest.mark.parametrize(("where", "value"), NOTES)
def test_a_note_is_verified_by_nobody_and_the_verdict_lists_it(where: Path_, value: object) -> None:
    cell, answer = answered("demo")
    other = copy.deepcopy(answer)
    assert held(other, where) != value
    held(other, where[:-1])[where[-1]] = value
    verdict = check_plan(cell, *read_plan(cell, sealed(cell, other)))
    assert verdict["findings"] == []
    assert ".".join(str(key) for key in where if isinstance(key, str)) in NOT_CHECKED


@pytest.mark.parametrize(("where", "value"), NOTES)
def test_a_note_must_have_its_form(where: Path_, value: object) -> None:
    cell, answer = answered("demo")
    forged = copy.deepcopy(answer)
    held(forged, where[:-1])[where[-1]] = {"certified": value}
    (told,) = findings(cell, forged)
    assert "; allowed: " in told


@pytest.mark.parametrize(
    ("where", "value"),
    [(("census", "lines", 0, "facts"), {"kind": "none"}), (("warnings", 0), {"kind": "PART_FLOATS"})],
)
def test_what_is_not_checked_must_have_its_form(where: Path_, value: object) -> None:
    cell, answer = answered("floating" if where[0] == "warnings" else "waiting")
    forged = copy.deepcopy(answer)
    held(forged, where[:-1])[where[-1]] = value
    (told,) = findings(cell, forged)
    assert "; allowed: " in told


@pytest.mark.parametrize("field", ["contacts", "margins", "load", "assumptions", "seed", "request_digest", "notice"])
def test_what_is_left_out_is_no_claim(field: str) -> None:
    cell, answer = answered("transfer")
    less = {key: value for key, value in answer.items() if key != field}
    assert check_plan(cell, *read_plan(cell, less))["findings"] == []


@pytest.mark.parametrize("depart_mm", [1e-6, 0.01, 1, 20])
def test_a_leg_of_some_milliseconds_has_its_peak_in_the_answer(depart_mm: float) -> None:
    """What is claimed of the tool point while a part is carried is that of the DEPART alone here."""
    request = {
        "schema": "assur/1",
        "robot": {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_mm": [0, 0, -60]}},
        "start": {"joints": {"j1_deg": 17, "j2_deg": 68, "j3_mm": 250, "j4_deg": 0}},
        "bodies": [
            {"name": "table", "shape": {"box": {"size_mm": [300, 300, 100]}}, "pose": {"at_mm": [300, -150, 50]}},
            {"name": "part", "shape": {"box": {"size_mm": [30, 30, 20]}}, "pose": {"at_mm": [250, -100, 110]}},
        ],
        "task": [{"pick": {"part": "part", "grasp_mm": [0, 0, 10], "approach": {"mm": 20}, "dwell_ms": 50,
                           "depart": {"mm": depart_mm}}}],
        "options": {"stop": "first", "max_candidates": 50, "budget_s": 60},
    }  # fmt: skip
    cell = cell_of(request)
    answer = plan_cell(cell)
    assert answer["status"] == "planned"
    assert check_plan(cell, *read_plan(cell, answer))["findings"] == []


def test_a_point_that_is_on_no_conveyor_is_not_believed_to_be_along_one() -> None:
    request = shipped("transfer").request
    answer: Any = plan_document(request)
    answer["arrivals"][0]["along_m"] = 1.0
    assert "ARRIVAL" in findings_of(request, answer)


def untrue(cell: Cell, answer: dict[str, Any]) -> list[str]:
    """Where an answer claims what is not so, whatever its digest."""
    findings = check_plan(cell, *read_plan(cell, answer))["findings"]
    return [finding["where"] for finding in findings if finding["code"] == "CLAIM"]


@pytest.mark.parametrize("name", ["blended", "dense-flow", "transfer"])
def test_whether_a_velocity_is_matched_is_what_the_task_says(name: str) -> None:
    """Of a via with parabolic blends, which turns back at rest, nothing but the task says that it is not."""
    cell, answer = answered(name)
    for i, arrival in enumerate(answer["arrivals"]):
        forged = copy.deepcopy(answer)
        forged["arrivals"][i]["matched"] = not arrival["matched"]
        assert untrue(cell, forged) == [f"arrivals[{i}].matched"]


def test_how_far_a_point_is_along_its_conveyor_must_be_said() -> None:
    cell, answer = answered("dense-flow")
    on = [i for i, arrival in enumerate(answer["arrivals"]) if arrival["along_m"] is not None]
    assert on
    for i in on:
        forged = copy.deepcopy(answer)
        forged["arrivals"][i]["along_m"] = None
        assert untrue(cell, forged) == [f"arrivals[{i}].along_m"]


def test_an_acceleration_at_a_jump_may_be_told_a_digit_beside_its_knot() -> None:
    """The larger of both sides counts, and a time that is rounded is still that of the jump."""
    request = with_options(shipped("parabolic-blend").request, {"report": "full"})
    answer: Any = plan_document(request)
    tool = answer["margins"]["tool"]
    at = tool["acceleration_at_s"]
    for beside, right in ((0.0, True), (-1e-12, True), (1e-12, True), (-1e-2, False), (1e-2, False)):
        tool["acceleration_at_s"] = at + beside
        assert check_document(request, answer)["ok"] is right
