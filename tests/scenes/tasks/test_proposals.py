"""What a refusal of a task proposes: it names the part of a transfer, and nothing is offered that fails."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

from assur.api.cli.console_report import not_planned
from assur.planner.errors import InputError
from assur.scenes.proposals.texts import with_request_values
from assur.scenes.requests import check_document, plan_document, plan_scenario
from assur.scenes.scenario import Scenario
from assur.scenes.tasks.task_file import TaskScenario, scenario_of_texts
from tests.scenes.tasks.test_joining import CELL, TASK

APART = CELL.replace("step_mm: [80, 60, 20]", "step_mm: [80, 90, 20]")
LATE = (
    TASK.replace("[-620, 0, 10]", "[-320, 60, 10]")
    .replace("[-300, 250]", "[-280, -100]")
    .replace("{seed: 1}", "{seed: 1, max_candidates: 60, budget_s: 30, stop: first}")
)
"""The second part passes the end of the window while the first is carried."""
EXPLAINED = LATE.replace("{seed: 1", "{seed: 1, explain_budget_s: 60")
PART = ", for the pick of b in step 1, transfer; the others keep their values"


def scenario(task: str, cell: str = APART) -> Scenario:
    return scenario_of_texts(task.encode(), cell.encode(), Path("task.yaml"))


def printed(answer: dict[str, Any]) -> str:
    return "\n".join(str(each) for each in not_planned(answer))


@pytest.mark.parametrize(
    ("parts", "task"),
    [
        ("[a, b]", EXPLAINED),
        ("[a, b]", EXPLAINED.replace("[-280, -100]", "[-280, -270]")),
        ("[a, b]", EXPLAINED.replace("window_mm: [-280, -100]", "window_s: [0.3, 0.5]")),
        ("[b]", EXPLAINED.replace("[-320, 60, 10]", "[-90, 60, 10]")),
    ],
    ids=["one part is late", "too short for each part", "in seconds", "one part"],
)
def test_a_window_of_a_transfer_is_proposed_for_all_its_parts(parts: str, task: str) -> None:
    """What is proposed can be set in the task, is what the texts are changed to, and has a plan."""
    made = scenario(task.replace("[a, b]", parts))
    answer = plan_scenario(made)
    proposed = answer["relaxation"]
    assert proposed["what"] == "window"
    assert proposed["value"].endswith(", all 2 picks of this window") is (parts == "[a, b]")
    ((path, window),) = proposed["set"].items()
    assert path in ("steps.0.transfer.window_mm", "steps.0.transfer.window_s")
    assert f"--set '{path}={window}'" in printed(answer)
    changed = made.with_values(proposed["set"])
    again = plan_scenario(changed)
    assert again["status"] == "planned"
    assert again["duration_s"] == pytest.approx(proposed["duration_s"])
    of_request = plan_document(made.request)["relaxation"]["set"]
    key = path.rpartition(".")[2]
    assert list(of_request) == [f"task.pick-{part}.pick.{key}" for part in parts.strip("[]").split(", ")]
    texts = {"text": task.replace("[a, b]", parts), "cell": APART}
    written = with_request_values(made, texts, of_request, lambda given: scenario(given["text"], given["cell"]))
    assert written == {"text": re.sub(rf"{key}: \[[^]]*\]", f"{key}: {window}", texts["text"]), "cell": APART}
    assert scenario(written["text"]).request == changed.request


@pytest.mark.parametrize("window", ["window_mm: [550, 600]", "window_ms: [8000, 9000]"])
def test_a_window_that_opens_when_the_point_is_out_of_reach_is_proposed_to_open_earlier(window: str) -> None:
    task = EXPLAINED.replace("[a, b]", "[a]").replace("window_mm: [-280, -100]", window)
    made = scenario(task)
    answer = plan_scenario(made)
    assert answer["reason"] == "OUT_OF_REACH"
    proposed = answer["relaxation"]
    assert (proposed["what"], proposed["value"].split()[0]) == ("window", "from")
    ((path, (first, last)),) = proposed["set"].items()
    key, _, before = window.partition(": ")
    opens, closes = json.loads(before)
    assert (path, last) == (f"steps.0.transfer.{key}", closes)
    assert first < opens
    assert plan_scenario(made.with_values(proposed["set"]))["status"] == "planned"


TWO = EXPLAINED.replace(
    "transfer: {parts: [a, b], to: box, window_mm: [-280, -100]}",
    "transfer: {parts: [a], to: box, window_mm: [-280, -270]}\n"
    "  - transfer: {parts: [b], to: box, window_mm: [-280, -271]}",
).replace("[-320, 60, 10]", "[-620, 0, 10]")


def test_two_windows_that_are_too_narrow_are_proposed_as_wide_as_both_are_used() -> None:
    made = scenario(TWO)
    answer = plan_scenario(made)
    proposed = answer["relaxation"]
    assert proposed["what"] == "window"
    assert re.fullmatch(r"pick-a .*(sooner|farther); pick-b .*(sooner|farther)", proposed["value"])
    assert list(proposed["set"]) == ["steps.0.transfer.window_mm", "steps.1.transfer.window_mm"]
    for (first, last), end in zip(proposed["set"].values(), (-270, -271), strict=True):
        assert -1000 < first <= -280 < end <= last < 1000
    assert all(f"--set '{path}={window}'" in printed(answer) for path, window in proposed["set"].items())
    again = plan_scenario(made.with_values(proposed["set"]))
    assert again["duration_s"] == pytest.approx(proposed["duration_s"])


@pytest.mark.parametrize("parts", ["a", "ab"])
def test_windows_that_are_removed_are_left_out_of_their_transfers(parts: str) -> None:
    """As where the time ends before a window was found that suffices."""
    made = scenario(TWO)
    assert isinstance(made, TaskScenario)
    steps = {part: made.request["task"][number]["pick"] for part, number in (("a", 0), ("b", 2))}
    given = {
        f"task.pick-{part}.pick": {key: value for key, value in steps[part].items() if key != "window_mm"}
        for part in parts
    }
    answer = made.answered({"relaxation": {"what": "window", "value": "removed", "set": given}})
    found = answer["relaxation"]["set"]
    assert found == {f"steps.{'ab'.index(part)}.transfer": {"parts": [part], "to": "box"} for part in parts}
    after = made.with_values(found).request["task"]
    assert ["window_mm" in after[number]["pick"] for number in (0, 2)] == [False, "b" not in parts]
    written = with_request_values(
        made, {"text": TWO, "cell": APART}, given, lambda texts: scenario(texts["text"], texts["cell"])
    )
    assert scenario(written["text"]).request == made.with_values(found).request
    assert written["text"].count("window_mm") == 2 - len(parts)


@pytest.mark.parametrize(
    ("speed", "carried"), [(-250, ", and the conveyor carries it farther away, at -250 mm/s"), (0, "")]
)
def test_a_point_that_a_belt_carries_away_from_its_window_is_refused_as_such(speed: float, carried: str) -> None:
    made = scenario(LATE, APART.replace("speed_mm_s: 250", f"speed_mm_s: {speed}"))
    answer = plan_scenario(made)
    assert (answer["reason"], answer["proved"]) == ("WINDOW_MISSED", True)
    away = "pick-a: the point never enters its window along the conveyor: it stays 170 mm away"
    assert answer["sentence"] == f"{away}{carried}."
    assert check_document(made.request, answer)["ok"]


def test_of_a_belt_whose_speed_has_changed_no_speed_is_stated() -> None:
    """It has turned back before the start: the speed that is stated first is not that with which the point leaves."""
    belt = APART.replace("speed_mm_s: 250", "speed_mm_s: 250, changes: [{at_s: 1, speed_mm_s: -100}]")
    answer = plan_scenario(scenario(LATE.replace("start: {", "start: {at_s: 20, "), belt))
    assert answer["reason"] == "WINDOW_MISSED"
    assert re.fullmatch(r"pick-a: the point never enters its window .*: it stays [\d,]+ mm away\.", answer["sentence"])


HIGH = APART.replace("approach: {mm: 40}", "approach: {mm: 130}").replace(
    "dwell_ms: 60}", "dwell_ms: 60, approach: {mm: 30}}"
)
HIGHER = EXPLAINED.replace("[-320, 60, 10]", "[-620, 0, 110]").replace("[-280, -100]", "[-300, 250]")
"""The second part is too high on the belt for the approach of its kind."""


def test_a_straight_part_of_a_kind_is_proposed_for_all_its_picks() -> None:
    """Of one pick of a transfer it cannot be written."""
    made = scenario(HIGHER, HIGH)
    answer = plan_scenario(made)
    proposed = answer["relaxation"]
    assert (proposed["what"], proposed["value"]) == ("heights", "approach 26 mm, all 2 alike")
    assert proposed["set"] == {"kinds.bracket.approach.mm": 26}
    assert "--set kinds.bracket.approach.mm=26" in printed(answer)
    assert plan_scenario(made.with_values(proposed["set"]))["status"] == "planned"


def test_a_change_of_one_part_of_a_transfer_names_it_and_is_not_offered_as_values() -> None:
    made, given = scenario(HIGHER, HIGH), {"task.pick-b.pick.dwell_ms": 20}
    assert isinstance(made, TaskScenario)
    relaxation = {"what": "dwell", "value": "20 ms", "set": given}
    answer = made.answered(plan_scenario(made) | {"relaxation": relaxation})
    assert answer["relaxation"] == {"what": "dwell", "value": f"20 ms{PART}", "set": None}
    texts = {"text": HIGHER, "cell": HIGH}
    with pytest.raises(InputError, match=f"these are{PART[1:]}"):
        with_request_values(made, texts, given, lambda given: scenario(given["text"], given["cell"]))
    moved = scenario(HIGHER.replace("steps:\n", "steps:\n  - move: {to: {at_mm: [350, 0, 180]}, via: true}\n"), HIGH)
    answer = moved.answered(answer | {"relaxation": relaxation})
    assert ", for the pick of b in step 2, transfer;" in answer["relaxation"]["value"]


LOW = APART.replace("[300, -250, 60]", "[300, -250, 55]")
EARLY = EXPLAINED.replace("[-320, 60, 10]", "[-620, 0, 10]").replace("[-280, -100]", "[-300, 250]")
ALONE = EARLY.replace("  - {name: c, kind: bracket, slot: {box: 2}}\n", "")


@pytest.mark.parametrize(("parts", "what"), [("[a]", "point height"), ("[a, b]", "place heights")])
def test_slots_that_are_too_low_are_proposed_higher(parts: str, what: str) -> None:
    """Slots 5 mm in the table, on which the parts are to rest. The values that are proposed are those of the cell."""
    task = ALONE.replace("[a, b]", parts)
    made = scenario(task, LOW)
    answer = plan_scenario(made)
    assert "would be pressed 5 mm into table" in answer["sentence"]
    proposed = answer["relaxation"]
    assert (proposed["what"], proposed["set"]) == (what, {"slots.box.at_mm.2": 60})
    assert proposed["value"].startswith("5 mm higher")
    assert "--set slots.box.at_mm.2=60" in printed(answer)
    assert plan_scenario(scenario(task, APART))["duration_s"] == pytest.approx(proposed["duration_s"])
    of_request = plan_document(made.request)["relaxation"]["set"]
    texts = with_request_values(
        made, {"text": task, "cell": LOW}, of_request, lambda given: scenario(given["text"], given["cell"])
    )
    assert texts == {"text": task, "cell": APART}


def test_slots_in_which_a_part_lies_are_raised_by_no_values() -> None:
    """The part that lies there would be elsewhere, which was not tried."""
    proposed = plan_scenario(scenario(EARLY, LOW))["relaxation"]
    assert (proposed["what"], proposed["set"]) == ("place heights", None)
