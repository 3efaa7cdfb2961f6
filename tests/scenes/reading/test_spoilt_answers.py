"""Answers with something else in place of one of their values: each reader says where, or answers all the same."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

import pytest

from assur.api.workers.jobs import FIRST_PLAN
from assur.planner.errors import InputError
from assur.scenes.exports.documents import check_trajectory_cell, export_cell
from assur.scenes.reading.cell import Cell
from assur.scenes.requests import cell_of, check_plan, plan_cell, read_plan, report_page, verdict_on
from assur.scenes.view.document import view_of
from tests.refused import refused_at

Place = tuple[str | int, ...]


@cache
def cell() -> Cell:
    return cell_of(FIRST_PLAN)


@cache
def answer() -> Any:
    return json.loads(json.dumps(plan_cell(cell(), unstated={"report": "full"})))


def places(value: Any, path: Place = ()) -> Iterator[Place]:
    """The way to each value; of the items of a list to those of the first."""
    if path:
        yield path
    if isinstance(value, dict):
        for key, item in value.items():
            yield from places(item, (*path, key))
    elif isinstance(value, list) and value:
        yield from places(value[0], (*path, 0))


def spoilt(path: Place, value: object) -> Any:
    """The answer with `value` at `path`; whatever is not on the way is shared."""
    top: Any = dict(answer())
    here = top
    for part in path[:-1]:
        here[part] = copy.copy(here[part])
        here = here[part]
    here[path[-1]] = value
    return top


def checked(given: Any) -> Any:
    return check_plan(cell(), *read_plan(cell(), given))


def reported(given: Any) -> Any:
    return report_page(cell(), given, title="t", verdict=verdict_on(cell(), given), version="1")


def exported(given: Any) -> Any:
    return export_cell(cell(), FIRST_PLAN, given, {"format": "csv"})


def shown(given: Any) -> Any:
    return view_of(cell(), given)


@pytest.mark.parametrize("value", [None, {}, [], "x"], ids=repr)
@pytest.mark.parametrize("reader", [checked, exported, shown])
def test_each_reader_refuses_or_answers_whatever_stands_in_an_answer(
    reader: Callable[[Any], Any], value: object
) -> None:
    refused = 0
    for path in places(answer()):
        try:
            reader(spoilt(path, value))
        except InputError as error:
            refused += error.field.startswith("plan")
    assert refused > 40


@pytest.mark.parametrize("path", [("status",), ("contacts",), ("margins",), ("legs", 0), ("trajectory", "time_s", 0)])
@pytest.mark.parametrize("value", [None, {}, [], "x"], ids=repr)
def test_a_report_refuses_what_is_no_answer(path: Place, value: object) -> None:
    if (path, value) == (("contacts",), []):
        assert reported(spoilt(path, value))
        return
    with pytest.raises(InputError, match=str(path[0])):
        reported(spoilt(path, value))


def test_what_is_in_a_list_is_told_with_its_number() -> None:
    contact = {"bodies": ["a", "b"], "from_s": 0.0, "to_s": 0.1}
    others: list[object] = [None, {}, [], "x"]
    for value in others:
        with pytest.raises(InputError) as caught:
            checked(spoilt(("contacts",), [contact, value]))
        assert caught.value.field.startswith("plan.contacts[1]")


def test_a_plan_without_legs_is_not_exported_and_gives_its_legs_to_no_trajectory() -> None:
    given = spoilt(("legs",), [])
    file = exported(answer())["file"]
    for refused in (
        lambda: exported(given),
        lambda: check_trajectory_cell(cell(), FIRST_PLAN, {"format": "csv", "file": file}, given),
    ):
        with pytest.raises(InputError, match="at least one leg"):
            refused()


@pytest.mark.parametrize("step", [5e-324, 1e-300, 1e-12, 0.9e-9])
def test_knots_that_are_closer_than_a_nanosecond_are_refused(step: float) -> None:
    time = list(answer()["trajectory"]["time_s"])
    with refused_at("plan.trajectory.time_s[1]", match="1e-09 s at least later than"):
        checked(spoilt(("trajectory", "time_s"), [time[0], time[0] + step, *time[2:]]))
    apart = checked(spoilt(("trajectory", "time_s"), [time[0], time[0] + 1e-9, *time[2:]]))
    assert apart["ok"] is False
