"""The record of what must not change: the same sources record the same, and what differs is seen."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from benchmarks.record import (
    Durations,
    change,
    compare,
    differences,
    largest_difference,
    record_cells,
    record_scenarios,
    record_sets,
    without_readings,
    write,
)

SCENARIOS = ("transfer", "heavy-casting-refused")
RECORDED = Path(__file__).parents[2] / "benchmarks" / "recorded" / "durations.json"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small record."""
    folder = tmp_path_factory.mktemp("record")
    durations = {"scenarios": record_scenarios(folder, SCENARIOS), **dict(record_sets(1, every=50))}
    durations["random cells"], digests = record_cells(range(6))
    write(folder / "cells.json", digests)
    write(folder / "durations.json", durations)
    return folder


def test_a_plan_has_a_duration_and_a_bundle_and_a_refusal_has_a_reason(folder: Path) -> None:
    durations = json.loads((folder / "durations.json").read_bytes())
    assert {name: type(value) for name, value in durations["scenarios"].items()} == {
        "transfer": float,
        "heavy-casting-refused": str,
    }
    assert [path.name for path in (folder / "bundles").iterdir()] == ["transfer.json"]
    assert len(list((folder / "answers").iterdir())) == len(SCENARIOS)
    assert [len(durations[f"{name}, seed 0"]) for name in ("static", "moving bodies", "moving goal")] == [2, 2, 2]
    assert durations["random cells"].keys() == json.loads((folder / "cells.json").read_bytes()).keys()


def test_the_same_sources_record_the_same_bytes(folder: Path, tmp_path: Path) -> None:
    assert record_scenarios(tmp_path, SCENARIOS) == json.loads((folder / "durations.json").read_bytes())["scenarios"]
    assert differences(folder / "answers", tmp_path / "answers") == {}
    assert differences(folder / "bundles", tmp_path / "bundles") == {}
    assert compare(folder, folder) == (True, True)


def test_no_reading_of_the_clock_is_recorded() -> None:
    assert without_readings({"a": [{"elapsed_s": 1.0, "b": 2}], "first_s": 3.0}) == {"a": [{"b": 2}]}


def test_a_number_of_a_bundle_that_differs_is_named_with_its_table(folder: Path, tmp_path: Path) -> None:
    bundle = json.loads((folder / "bundles" / "transfer.json").read_bytes())
    bundle["arms"][0]["q"][0][0] += 2e-6
    write(tmp_path / "transfer.json", bundle)
    assert differences(folder / "bundles", tmp_path) == {"transfer.json": "arms 2e-06"}
    (tmp_path / "transfer.json").unlink()
    assert differences(folder / "bundles", tmp_path) == {"transfer.json": "only before"}


@pytest.mark.parametrize(
    ("before", "now", "most"),
    [
        ({"a": [1, 2.0]}, {"a": [1, 2.5]}, 0.5),
        ({"a": [1]}, {"a": [1, 2]}, float("inf")),
        ({"a": 1}, {"b": 1}, float("inf")),
        ({"a": "x"}, {"a": "y"}, float("inf")),
        ({"a": True}, {"a": 1}, 0.0),
        ([None], [None], 0.0),
    ],
)
def test_the_largest_difference_of_two_documents(before: object, now: object, most: float) -> None:
    assert largest_difference(before, now) == most


def many() -> Durations:
    """A group of a hundred items, two of which have no plan."""
    return {str(i): 1.0 + 0.01 * i for i in range(98)} | {"98": "OUT_OF_REACH", "99": "BODY_COLLISION"}


def edited(items: range, edit: Callable[[float], float | str]) -> Durations:
    """The group with other outcomes of some plans."""
    durations = many()
    for i in items:
        durations[str(i)] = edit(1.0 + 0.01 * i)
    return durations


@pytest.mark.parametrize(
    ("now", "within"),
    [
        (edited(range(98), lambda s: s + 5e-10), True),
        (edited(range(4), lambda s: s + 1e-6), True),
        (edited(range(6), lambda s: s + 1e-6), False),
        (edited(range(1), lambda _: "BODY_COLLISION"), True),
        (edited(range(50, 52), lambda _: "BODY_COLLISION"), False),
        (edited(range(48, 50), lambda s: s + 0.1), False),
        (edited(range(88, 92), lambda s: s + 5.0), False),
        ({**many(), "98": 1.2, "99": 1.2}, False),
        ({}, False),
        (edited(range(1), lambda _: float("nan")), False),
    ],
)
def test_a_group_is_within_the_gates_or_not(now: Durations, within: bool) -> None:
    assert change(many(), many()).within
    assert change(many(), now).within is within


def test_another_reason_differs_but_is_no_other_duration() -> None:
    found = change(many(), {**many(), "98": "WINDOW_MISSED"})
    assert (found.differing, found.equal, found.plans, found.within) == (["98"], 98, 98, True)


def test_two_records_that_share_nothing_are_not_within_the_gates(folder: Path, tmp_path: Path) -> None:
    write(tmp_path / "durations.json", {"other": {}})
    assert compare(folder, tmp_path) == (False, True)


def test_the_committed_record_has_every_scenario_and_problem_of_the_sets(folder: Path) -> None:
    recorded = json.loads(RECORDED.read_bytes())
    assert len(recorded) == 1 + 4 * 3
    assert {len(group) for name, group in recorded.items() if name != "scenarios"} == {100}
    assert recorded["scenarios"].keys() >= set(SCENARIOS)
    assert RECORDED.stat().st_size < 100_000
