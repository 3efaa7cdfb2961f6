"""Every field of a planned answer is in the table of docs/api.md ("The verdict"), and the checker does with it what the
table says: a changed value is refused, or refused by its digest alone, or not looked at."""

from __future__ import annotations

import copy
import re
from functools import cache
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, NotRequired, Required, Union, get_args, get_origin

import numpy as np
import pytest
from typing_extensions import get_type_hints, is_typeddict

from assur.planner.checker.claims.tool import tool
from assur.planner.checker.world import World
from assur.planner.errors import InputError
from assur.planner.model.claims import Claims
from assur.planner.model.outcome import ToolPeaks
from assur.scenes.reading.cell import Cell
from assur.scenes.requests import cell_of, check_document, check_plan, plan_cell, plan_document, read_plan
from assur.scenes.scenarios import shipped
from assur.scenes.schema import answer as document

PAGE = Path(__file__).parents[2] / "docs" / "api.md"
VERIFIED, ONE_SIDE, BY_DIGEST, INFORMATION = range(4)
"""The rows of the table, in their order."""
CELLS = (
    "transfer",
    "parabolic-blend",
    "bead-on-belt",
    "rv-m1",
    "two-robots-late",
    "five-bar",
    "shutter",
    "heavy-casting",
)
"""Answers that together have a value in every field: errors, a load, a via that is missed, a trace, pitch and roll, a
neighbour that may be late, a closed chain."""
EMPTY = frozenset({"warnings.kind", "warnings.bodies", "warnings.amount_m", "warnings.detail"})
"""Fields below a list that is empty in all of these answers; the list itself is changed as a whole."""
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
    """The fields in each row of the table."""
    text = PAGE.read_text(encoding="utf-8").split("\n## The verdict\n")[1]
    lines = text.split("| fields | the checker |\n|---|---|\n")[1].split("\n\n")[0].splitlines()
    return [re.findall(r"`([^`]+)`", line.split("|")[1]) for line in lines]


def place(field: str) -> int:
    """The row of a field: where its own name stands, or that of the nearest field above it."""
    parts = field.split(".")
    for count in range(len(parts), 0, -1):
        found = [k for k, names in enumerate(rows()) if ".".join(parts[:count]) in names]
        if found:
            assert len(found) == 1, f"{field} is in two rows"
            return found[0]
    raise AssertionError(f"{field} is in no row of the table in docs/api.md: is it verified?")


@cache
def answered(name: str) -> tuple[Cell, dict[str, Any]]:
    scenario = shipped(name)
    cell = cell_of(scenario.request, folder=scenario.folder)
    return cell, plan_cell(cell, nearest_pairs=2)


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


def verdicts(field: str) -> list[set[str]]:
    """The codes of what the checker finds for each change of one value of the field, of a null if there is no other;
    what cannot be read is `FORM`."""
    places = [(name, where) for name in CELLS for where in values(answered(name)[1], tuple(field.split(".")))]
    full = [(name, where) for name, where in places if held(answered(name)[1], where) is not None]
    assert places, f"no answer has the field {field}"
    name, where = (full or places)[0]
    cell, answer = answered(name)
    codes = []
    for other in changed(held(answer, where)):
        forged = copy.deepcopy(answer)
        held(forged, where[:-1])[where[-1]] = other
        try:
            codes.append({finding["code"] for finding in check_plan(cell, *read_plan(cell, forged))["findings"]})
        except InputError:
            codes.append({"FORM"})
    return codes


@pytest.mark.parametrize("name", CELLS)
def test_the_answers_themselves_are_right(name: str) -> None:
    cell, answer = answered(name)
    assert answer["status"] == "planned"
    assert check_plan(cell, *read_plan(cell, answer))["findings"] == []


def test_the_table_names_only_fields_that_there_are() -> None:
    above = {".".join(field.split(".")[:count]) for field in FIELDS for count in range(1, 9)}
    assert [name for names in rows() for name in names if name not in above] == []


@pytest.mark.parametrize("field", FIELDS)
def test_the_checker_does_with_a_field_what_the_table_says(field: str) -> None:
    row = place(field)
    if field in EMPTY:
        return
    found = verdicts(field)
    if row == VERIFIED:
        assert all(found), "a changed value is not refused"
    elif row == ONE_SIDE:
        assert any(found), "no changed value is refused"
    elif row == BY_DIGEST:
        assert all(found)
        assert all(codes <= {"DIGEST", "CLAIM", "FORM"} for codes in found)
    else:
        assert row == INFORMATION
        assert not any(found), "it is looked at, after all"


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
    assert "ARRIVAL" in {finding["code"] for finding in check_document(request, answer)["findings"]}


def untrue(cell: Cell, answer: dict[str, Any]) -> list[str]:
    """Where an answer claims what is not so, whatever its digest."""
    findings = check_plan(cell, *read_plan(cell, answer))["findings"]
    return [finding["where"] for finding in findings if finding["code"] == "CLAIM"]


@pytest.mark.parametrize("name", ["parabolic-blend", "dense-flow", "transfer"])
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


def test_what_binds_is_not_believed_without_the_peaks() -> None:
    answer: Any = plan_document(shipped("transfer").request)
    del answer["margins"]["peaks"]
    answer["margins"]["binds"] = "jerk of j9 (999 %)"
    verdict = check_document(shipped("transfer").request, answer)
    assert [(finding["code"], finding["where"]) for finding in verdict["findings"]] == [("CLAIM", "margins.binds")]
    del answer["margins"]["binds"]
    assert check_document(shipped("transfer").request, answer)["ok"]


def acceleration(world: World, t: float) -> float:
    """What the checker takes for the tool point's acceleration at an instant, m/s²: so much a claim of none is off."""
    findings = tool(world, (), Claims(tool=ToolPeaks(0.0, t, 0.0, t)))
    off = [each.amount for each in findings if each.what.startswith("the acceleration of the tool point is not")]
    return off[0] if off and off[0] is not None else 0.0


def test_an_acceleration_at_a_jump_may_be_told_a_digit_beside_its_knot() -> None:
    """The larger of both sides counts, and a time that is rounded is still that of the jump."""
    request = shipped("parabolic-blend").request
    cell = cell_of(request)
    world = World(cell.scene, read_plan(cell, plan_document(request))[0])
    knots = np.unique(world.knots.time)[1:-1].tolist()
    at = [acceleration(world, t) for t in knots]
    between = [acceleration(world, t + 1e-6) for t in knots]
    assert max(abs(one - other) for one, other in zip(at, between, strict=True)) > 1.0  # there are jumps
    for beside in (-1e-12, 1e-12):
        assert [acceleration(world, t + beside) for t in knots] == at
