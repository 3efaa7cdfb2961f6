"""A change of a request, and a thing that was moved in the drawing, are written in the text that has them."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.scenes.proposals.files import values_of_task
from assur.scenes.proposals.texts import Texts, with_request_values, with_shift
from assur.scenes.requests import cell_of, plan_scenario, request_digest
from assur.scenes.scenario import Scenario
from assur.scenes.scenarios import load_scenario, scenario_in
from assur.scenes.set_values import with_values
from assur.scenes.tasks.joining import joined
from assur.scenes.tasks.task_file import TaskScenario, scenario_of_texts
from tests.scenes.tasks.test_joining import BY_HAND, CELL, TASK, documents, written

EXPLICIT = TASK.split("steps:")[0] + (
    "steps:\n"
    "  - pick: {part: a, window_mm: [-300, 250]} # from the belt\n"
    "  - place: {part: a, to: box}\n"
    "  - move: {to: home}\n"
    "options: {seed: 1}\n"
    "set: {frames.belt.conveyor.speed_mm_s: 200}\n"
)
"""The task with steps of its own, and a value that it sets in its cell."""
PAIR = {"cell": CELL, "text": EXPLICIT}


def again(texts: Texts) -> Scenario:
    path = Path("text.yaml")
    if "cell" not in texts:
        return scenario_in(texts["text"].encode(), path)
    text = texts.get("text")
    return scenario_of_texts(None if text is None else text.encode(), texts["cell"].encode(), path)


# Of a proposed change of the request: what of the task or the cell is it, in which text, before and after.
WRITTEN = [
    (
        "task.0.pick.approach.mm", 20, "text",
        "-300, 250]}", "-300, 250], approach: {mm: 20}}", "steps.0.pick.approach.mm",
    ),
    ("task.0.pick.window_mm", [-300, 260], "text", "[-300, 250]", "[-300, 260]", "steps.0.pick.window_mm"),
    ("task.1.place.dwell_ms", 30, "text", "to: box}", "to: box, dwell_ms: 30}", "steps.1.place.dwell_ms"),
    ("task.2.move.to.at_mm.2", 160, "cell", "350, 0, 150", "350, 0, 160", "positions.home.at_mm.2"),
    ("options.seed", 7, "text", "seed: 1", "seed: 7", "options.seed"),
    ("options.elbow", "auto", "text", "seed: 1", "seed: 1, elbow: auto", "options.elbow"),
    ("options.clearance_mm", {"travel": 2, "near": 1}, "cell", "travel: 5", "travel: 2", "options.clearance_mm"),
    (
        "frames.belt.conveyor.speed_mm_s", 125, "text",
        "speed_mm_s: 200", "speed_mm_s: 125", "frames.belt.conveyor.speed_mm_s",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("path", "value", "name", "before", "after", "own"), WRITTEN)
def test_a_change_of_the_request_is_one_of_its_task_or_its_cell(
    path: str, value: object, name: str, before: str, after: str, own: str
) -> None:
    scenario = again(PAIR)
    assert isinstance(scenario, TaskScenario)
    made = with_request_values(scenario, PAIR, {path: value}, again)
    assert made == {**PAIR, name: PAIR[name].replace(before, after)}
    wanted = request_digest(with_values(scenario.request, {path: value}))
    assert request_digest(again(made).request) == wanted
    found = values_of_task(scenario.joined, {path: value}, scenario.files.joined)
    assert found is not None
    assert list(found) == [own]
    assert request_digest(scenario.with_values(found).request) == wanted


def test_a_window_in_lines_of_its_own_keeps_its_comments() -> None:
    own = "window_mm:   # from the light barrier\n      - -300\n      - {}  # end of the reach\n"
    texts = {
        **PAIR,
        "text": EXPLICIT.replace(
            "{part: a, window_mm: [-300, 250]} # from the belt\n", "\n      part: a\n      " + own
        ),
    }
    given = {**texts, "text": texts["text"].replace("{}", "250")}
    made = with_request_values(again(given), given, {"task.0.pick.window_mm": [-300, 260]}, again)
    assert made == {**texts, "text": texts["text"].replace("{}", "260")}


@pytest.mark.parametrize(
    "values",
    [
        {"task.0.pick.approach.mm": 20},  # of the kind of both parts
        {"task.1.place.to.at_mm": [0, 300, 60]},  # of the slots
        {"task.0.pick.window_mm": [-300, 260]},  # of the picks of both parts
    ],
)
def test_a_change_that_would_change_more_is_none_of_the_task(values: dict[str, Any]) -> None:
    cell, task = documents()
    made = joined(cell, task)
    assert values_of_task(made, values, lambda given: joined(cell, task, given)) is None
    texts = {"cell": CELL, "text": TASK}
    with pytest.raises(InputError) as refused:
        with_request_values(again(texts), texts, values, again)
    assert (refused.value.field, refused.value.value) == ("set", values)


def test_a_transfer_of_one_part_has_the_window_of_its_pick() -> None:
    cell, task = documents()
    task["steps"][0]["transfer"]["parts"] = ["a"]
    found = values_of_task(
        joined(cell, task), {"task.0.pick.window_mm": [-300, 260]}, lambda given: joined(cell, task, given)
    )
    assert found == {"steps.0.transfer.window_mm": [-300, 260]}


def test_the_answer_to_a_task_proposes_values_that_make_it_planned(tmp_path: Path) -> None:
    """20 ms in the window are too few for the dwell; what is set on the command line is kept."""
    task = EXPLICIT.replace("[-300, 250]", "[-300, -298]").replace(
        "{seed: 1}", "{seed: 1, explain_budget_s: 60, budget_s: 60, max_candidates: 40, stop: first}"
    )
    scenario = load_scenario(written(tmp_path, task=task)).with_values({"steps.2.move.to": "home"})
    found = plan_scenario(scenario)["relaxation"]
    assert found["what"] == "window"
    assert list(found["set"]) == ["steps.0.pick.window_mm"]
    assert plan_scenario(load_scenario(tmp_path / "task.yaml").with_values(found["set"]))["status"] == "planned"


def pose_of(scenario: Scenario, name: str) -> Pose:
    return cell_of(scenario.request).scene.index[name].pose


TURNED = BY_HAND.replace("at_mm: [0, 350, 50], speed", "at_mm: [0, 350, 50], yaw_deg: 90, speed")
MOVES: list[tuple[dict[str, str], dict[str, Any], str, str, str]] = [
    ({"text": BY_HAND}, {"kind": "body", "name": "table", "by_mm": [12.4, -3.6]}, "text",
     "at_mm: [350, -200, 25]", "at_mm: [362, -204, 25]"),
    ({"text": BY_HAND}, {"kind": "body", "name": "table", "by_mm": [12.44, 0.02], "grid_mm": 0.1}, "text",
     "at_mm: [350, -200, 25]", "at_mm: [362.4, -200, 25]"),
    ({"text": BY_HAND.replace("at_mm: [350, -200, 25]", "at_m: [0.35, -0.2, 0.025]")},
     {"kind": "body", "name": "table", "by_m": [0.0124, 0]}, "text", "[0.35, -0.2, 0.025]", "[0.362, -0.2, 0.025]"),
    ({"text": BY_HAND.replace(", pose: {at_mm: [350, -200, 25]}", ", pose: {yaw_deg: 3}")},
     {"kind": "body", "name": "table", "by_mm": [400, 5]}, "text",
     "{yaw_deg: 3}", "{yaw_deg: 3, at_mm: [400, 5, 0]}"),
    ({"text": TURNED}, {"kind": "body", "name": "a", "by_mm": [5, 7]}, "text", "[-450, 0, 10]", "[-445, 7, 10]"),
    ({"text": BY_HAND.replace("{at_mm: [380, -250, 60], yaw_deg: 90}", "{body: table, at_mm: [30, -50, 35]}").replace(
        "at_mm: [350, -200, 25]", "at_mm: [350, -200, 25], yaw_deg: 90")},
     {"kind": "body", "name": "c", "by_mm": [5, 7]}, "text", "[30, -50, 35]", "[37, -55, 35]"),
    ({"text": BY_HAND}, {"kind": "step", "name": "4", "by_mm": [-5, 7]}, "text", "[350, 0, 150]", "[345, 7, 150]"),
    (PAIR, {"kind": "body", "name": "a", "by_mm": [5, 7]}, "text", "[-450, 0, 10]", "[-445, 7, 10]"),
    (PAIR, {"kind": "body", "name": "c", "by_mm": [5, 7]}, "cell", "[300, -250, 60]", "[305, -243, 60]"),
    (PAIR, {"kind": "step", "name": "1", "by_mm": [5, 7]}, "cell", "[300, -250, 60]", "[305, -243, 60]"),
    (PAIR, {"kind": "step", "name": "2", "by_mm": [5, 7]}, "cell", "[350, 0, 150]", "[355, 7, 150]"),
    ({"cell": CELL}, {"kind": "step", "name": "0", "by_mm": [5, 7]}, "cell", "[350, 0, 150]", "[355, 7, 150]"),
    ({"cell": CELL}, {"kind": "body", "name": "table", "by_mm": [5, 7]}, "cell", "[350, -200, 25]", "[355, -193, 25]"),
]  # fmt: skip


@pytest.mark.parametrize(("texts", "move", "name", "before", "after"), MOVES)
def test_a_move_changes_the_numbers_of_the_place(
    texts: Texts, move: dict[str, Any], name: str, before: str, after: str
) -> None:
    scenario = again(texts)
    made = with_shift(scenario, texts, cell_of(scenario.request), move, again)
    assert texts[name].count(before) == 1
    assert made == {**texts, name: texts[name].replace(before, after)}


def test_a_thing_goes_where_it_was_drawn() -> None:
    """On a frame that is turned by 37 degrees in one that is turned by 20, beside a body that is turned, too."""
    text = BY_HAND.replace(
        "speed_mm_s: 250}}}\n  bodies:\n",
        "speed_mm_s: 250}},\n"
        "    plate: {fixed: {at_mm: [100, 0, 0], yaw_deg: 20}},\n"
        "    jig: {fixed: {frame: plate, at_mm: [50, 9, 0], yaw_deg: 37}}}\n"
        "  bodies:\n"
        "    - {name: pin, shape: {sphere: {radius_mm: 3}}, pose: {frame: jig, at_mm: [200, 1.5, 9], yaw_deg: 8}}\n"
        "    - {name: cap, shape: {sphere: {radius_mm: 3}}, pose: {body: pin, at_mm: [20, -0.5, 9]}}\n",
    )
    scenario = again({"text": text})
    for name in ("pin", "cap"):
        before = pose_of(scenario, name)
        move = {"kind": "body", "name": name, "by_mm": [30.0, -20.0], "grid_mm": 0.1}
        made = again(with_shift(scenario, {"text": text}, cell_of(scenario.request), move, again))
        after = pose_of(made, name)
        assert math.hypot(after.x - before.x - 0.03, after.y - before.y + 0.02) < 1e-4
        assert (after.z, after.yaw) == (before.z, before.yaw)


REFUSED: list[tuple[dict[str, str], Any, str]] = [
    ({"text": BY_HAND}, {"kind": "body", "name": "tabel", "by_mm": [1, 2]}, "move.name"),
    ({"text": BY_HAND}, {"kind": "step", "name": "0", "by_mm": [1, 2]}, "move.name"),  # a pick
    ({"text": BY_HAND}, {"kind": "step", "name": "5", "by_mm": [1, 2]}, "move.name"),
    ({"text": BY_HAND}, {"kind": "step", "name": "-1", "by_mm": [1, 2]}, "move.name"),
    ({"text": BY_HAND}, {"kind": "frame", "name": "belt", "by_mm": [1, 2]}, "move.kind"),
    ({"text": BY_HAND}, {"kind": "body", "name": "table", "by_mm": [1, 2, 3]}, "move.by_mm"),
    ({"text": BY_HAND}, {"kind": "body", "name": "table", "by_mm": [1, math.nan]}, "move.by_mm[1]"),
    ({"text": BY_HAND}, {"kind": "body", "name": "table", "by_mm": [1, math.inf]}, "move.by_mm[1]"),
    ({"text": BY_HAND}, {"kind": "body", "name": "table", "by_mm": [1, 1e9]}, "move.by_mm[1]"),
    ({"text": BY_HAND}, {"kind": "body", "name": "table", "by_mm": [1, 2], "grid_mm": 0}, "move.grid_mm"),
    ({"text": BY_HAND}, {"kind": "body", "name": "table", "by_mm": [1, 2], "far": 0}, "move.far"),
    ({"text": BY_HAND}, {"kind": "body", "name": "table"}, "move.by_m"),
    ({"text": BY_HAND}, [], "move"),
    ({"text": BY_HAND.replace(
        "[350, 0, 150]}", "[0, 350, 150]}, leg: cartesian, path: [{arc: {via_mm: [9, 300, 150]}}]")},
     {"kind": "step", "name": "4", "by_mm": [1, 2]}, "move.name"),
]  # fmt: skip


@pytest.mark.parametrize(("texts", "move", "field"), REFUSED)
def test_what_cannot_be_moved_is_refused(texts: Texts, move: object, field: str) -> None:
    scenario = again(texts)
    with pytest.raises(InputError) as refused:
        with_shift(scenario, texts, cell_of(scenario.request), move, again)
    assert refused.value.field == field


def test_a_move_to_a_place_that_no_cell_may_have_is_refused() -> None:
    scenario = again({"text": BY_HAND})
    move = {"kind": "body", "name": "table", "by_mm": [99_900, 0]}
    with pytest.raises(InputError, match="bodies"):
        with_shift(scenario, {"text": BY_HAND}, cell_of(scenario.request), move, again)
