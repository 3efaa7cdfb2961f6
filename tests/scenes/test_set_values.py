"""Values that are set in a document by their paths."""

from __future__ import annotations

import copy
import math
from typing import Any

import pytest

from assur.planner.errors import InputError
from assur.scenes.set_values import with_values

DOCUMENT: dict[str, Any] = {
    "options": {"budget_ms": 500, "clearance_mm": {"travel": 8, "near": 1}},
    "streams": {"goods": {}},
    "frames": {"belt.1": {"conveyor": {"at_mm": [0, 350, 50], "speed_mm_s": 250}}, "belt": {"fixed": {}}},
    "bodies": [{"name": "table", "mass_kg": 1.0}, {"name": "fence.left", "mass_kg": 2.0}],
    "task": [{"move": {"name": "home", "to": {"at_mm": [1, 2, 3]}}}],
}


@pytest.mark.parametrize(
    ("path", "value", "where"),
    [
        ("options.seed", 3, ("options", "seed")),
        ("options.budget_s", 2, ("options", "budget_s")),
        ("options.clearance_mm.near", 2, ("options", "clearance_mm", "near")),
        ("frames.belt.1.conveyor.speed_mm_s", 90, ("frames", "belt.1", "conveyor", "speed_mm_s")),
        ("frames.belt.fixed.yaw_deg", 90, ("frames", "belt", "fixed", "yaw_deg")),
        ("bodies.table.mass_kg", 4, ("bodies", 0, "mass_kg")),
        ("bodies.fence.left.mass_kg", 4, ("bodies", 1, "mass_kg")),
        ("bodies.1.mass_kg", 4, ("bodies", 1, "mass_kg")),
        ("bodies.1", {"name": "other"}, ("bodies", 1)),
        ("task.0.move.to.at_mm.2", 9, ("task", 0, "move", "to", "at_mm", 2)),
        ("task[0].move.to.at_mm[2]", 9, ("task", 0, "move", "to", "at_mm", 2)),
        ("task.home.move.to.at_mm.2", 9, ("task", 0, "move", "to", "at_mm", 2)),
        ("carry.acceleration_m_s2", 30, ("carry", "acceleration_m_s2")),
        ("task", [], ("task",)),
    ],
)
def test_a_value_is_set_where_its_path_leads_and_nowhere_else(path: str, value: object, where: tuple[Any, ...]) -> None:
    before, kept = copy.deepcopy(DOCUMENT), DOCUMENT["frames"]
    found: Any = with_values(DOCUMENT, {path: value})
    assert before == DOCUMENT
    if where[0] != "frames":
        assert found["frames"] is kept
    node = found
    for key in where[:-1]:
        node = node[key]
    assert node[where[-1]] == value
    # all else is as it was, but for the other unit of the field
    expected = copy.deepcopy(DOCUMENT)
    inner: Any = expected
    for key in where[:-1]:
        inner = inner[key] if isinstance(inner, list) else inner.setdefault(key, {})
    inner[where[-1]] = value
    if path == "options.budget_s":
        del expected["options"]["budget_ms"]
    assert found == expected


@pytest.mark.parametrize(
    ("path", "value", "where", "expected"),
    [
        ("task.0.move.to.at_m.2", 0.5, ("task", 0, "move", "to"), {"at_m": [0.001, 0.002, 0.5]}),
        ("options.clearance_m.near", 0.5, ("options", "clearance_m"), {"travel": 0.008, "near": 0.5}),
        ("turn.at_mm.0", 7, ("turn",), {"at_mm": [7, 200.0, 300.0], "yaw_rad": math.pi}),
        ("turn.yaw_deg", 7, ("turn",), {"at_m": [0.1, 0.2, 0.3], "yaw_deg": 7}),
    ],
)
def test_a_part_of_a_value_is_set_in_the_unit_of_its_path(
    path: str, value: object, where: tuple[Any, ...], expected: dict[str, Any]
) -> None:
    node: Any = with_values({**DOCUMENT, "turn": {"at_m": [0.1, 0.2, 0.3], "yaw_rad": math.pi}}, {path: value})
    for key in where:
        node = node[key]
    assert node == expected


def test_of_values_for_one_field_the_last_counts() -> None:
    found = with_values(
        DOCUMENT, {"options": {"seed": 1}, "options.seed": 2, "options.budget_ms": 1, "options.budget_s": 3}
    )
    assert found["options"] == {"seed": 2, "budget_s": 3}


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"bodies.tabel.mass_kg": 1}, r"bodies\.tabel: got 'tabel'.*fence\.left, table; did you mean table\?"),
        ({"bodies.2": 1}, r"bodies\.2: got '2'; allowed: a number from 0 to 1, or the name of an entry"),
        ({"frames.belts.conveyor.speed_mm_s": 1}, r"frames\.belts: got 'belts'; .*did you mean belt"),
        ({"streams.good.mean_s": 1}, r"streams\.good: got 'good'; .*did you mean goods"),
        ({"task.homer.move.via": True}, r"task\.homer: got 'homer'; .*entry: home; did you mean home\?"),
        ({"bodies.-1": 1}, r"bodies\.-1"),
        ({"bodies.": 1}, r"bodies"),
        ({"task.0.move.to.at_mm.2.x": 1}, r"task\[0\]\.move\.to\.at_mm\[2\]\.x: got 3; allowed: a mapping or a list"),
        ({"a." * 20_000 + "b": 1}, "set: got 'a.a.*at most 32 keys"),
        ({"": 1}, "set: got"),
        ({3: 1}, "set: got"),
        ([("options.seed", 1)], "set: got"),
        (None, "set: got"),
    ],
)
def test_a_path_that_leads_nowhere_is_refused(values: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        with_values(DOCUMENT, values)
