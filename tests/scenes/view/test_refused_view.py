"""A refusal that is proved of a control point is shown there: the arm at the point, both bodies where they meet."""

from __future__ import annotations

import copy
import json
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from assur.scenes.requests import cell_of, load_scenario, plan_document
from assur.scenes.view.document import view_of
from tests.docs.pages import ROOT
from tests.scenes.refused_cells import BELT, BLOCK, PROVED, cell, follow, options
from tests.scenes.view.shown import drawn

Document = dict[str, Any]
Array = NDArray[np.float64]


def tutorial(put_mm: float) -> Document:
    """The cell of the tutorial, with the box put down so high above the floor of the robot."""
    request = copy.deepcopy(load_scenario(ROOT / "docs" / "first-belt-cell.yaml").request)
    request["task"][1]["place"]["to"]["at_mm"][2] = put_mm
    request["options"]["explain_budget_s"] = 0
    return request


def shown(request: Document) -> tuple[Document, Document]:
    """The answer to a request that is refused, and its view."""
    answer = json.loads(json.dumps(plan_document(request)))
    assert (answer["reason"], answer["proved"]) == ("CONTROL_POINT_IN_COLLISION", True), answer["sentence"]
    return answer, dict(view_of(cell_of(request), answer))


def body(view: Document, name: str) -> Array:
    """The corners (V, 3) of a body when the view begins."""
    return drawn(view, next(each for each in view["bodies"] if each["name"] == name), 0.0)


def deep(view: Document, one: str, other: str) -> float:
    """How deep the boxes around two bodies are in each other, m, along the axis along which that is least."""
    a, b = body(view, one), body(view, other)
    return float(np.minimum(a.max(0) - b.min(0), b.max(0) - a.min(0)).min())


@pytest.mark.parametrize("low", [10.0, 4.0])
def test_the_box_of_the_tutorial_is_drawn_in_the_floor_of_the_tray(low: float) -> None:
    answer, view = shown(tutorial(60 - low))
    assert view["refusal"]["met"] == answer["refusal"]["bodies"] == ["box", "tray-floor"]
    assert not view["moves"]
    assert deep(view, "box", "tray-floor") == pytest.approx(low / 1e3, abs=2e-4)
    # the sentence, the facts and the picture have the same number; the floor must be 2 mm away from what passes it
    assert answer["refusal"]["facts"]["gap_m"] == pytest.approx(-low / 1e3, abs=1e-9)
    assert f"they would overlap by up to {low:g} mm, and the required distance is 2 mm" in answer["sentence"]
    # the cup is on the box
    assert body(view, "cup")[:, 2].min() == pytest.approx(body(view, "box")[:, 2].max(), abs=2e-4)


def test_a_part_that_was_put_down_before_is_where_it_was_put() -> None:
    """The second box is put down where the first one is."""
    request = tutorial(60)
    again = {"name": "box-2", "shape": {"box": {"size_mm": [60, 40, 20]}}, "pose": {"at_mm": [300, 100, 60]}}
    request["bodies"].append({**again, "mass_kg": 0.2})
    take = {"name": "take-2", "part": "box-2", "grasp_mm": [0, 0, 10], "approach": {"mm": 20}, "depart": {"mm": 30}}
    put = copy.deepcopy(request["task"][1]["place"]) | {"name": "put-2", "part": "box-2", "contact_with": []}
    put["to"]["at_mm"][2] += 5
    request["task"][2:] = [{"pick": {**take, "dwell_ms": 50}}, {"place": put}]
    answer, view = shown(request)
    assert (answer["refusal"]["step"], answer["refusal"]["bodies"]) == (3, ["box-2", "box"])
    assert deep(view, "box-2", "box") == pytest.approx(0.015, abs=2e-4)


def test_a_point_on_a_frame_that_moves_is_shown_where_the_frame_is_at_the_start() -> None:
    block = {**BLOCK, "pose": {"frame": "belt", "at_mm": [300, 0, 60]}}
    step = follow(300, 0, 60, "belt", duration_ms=100, window_mm=[-200, 400])
    _, view = shown(cell(step, frames={"belt": BELT}, bodies=[block], options=options()))
    tip = body(view, "cup")[:, 2].min()
    assert body(view, "cup")[:, :2].mean(0) == pytest.approx(body(view, "block")[:, :2].mean(0), abs=2e-4)
    assert tip == pytest.approx(0.11, abs=2e-4)


@pytest.mark.parametrize("name", [name for name, (*_, kind) in PROVED.items() if kind == "met"])
def test_bodies_that_are_proved_to_meet_are_near_each_other_in_the_picture(name: str) -> None:
    request = PROVED[name][0]
    answer = json.loads(json.dumps(plan_document(request)))
    view = dict(view_of(cell_of(request), answer))
    first, second = answer["refusal"]["bodies"]
    gap = answer["refusal"]["facts"].get("gap_m", 0.0)
    assert -deep(view, first, second) <= max(gap, 0.0) + 2e-4


def test_a_witness_that_names_no_place_is_shown_at_the_start() -> None:
    """What an answer says is shown, not checked: nothing of it ends the showing."""
    request = tutorial(50)
    answer, _ = shown(request)
    at_start = body(dict(view_of(cell_of(request), {**answer, "refusal": None})), "cup")
    for key, value in (("mode", "upside-down"), ("turn_rad", 0.7), ("place", "approach"), ("bodies", ["box", "fence"])):
        forged = copy.deepcopy(answer)
        for way in forged["refusal"]["witness"]["ways"]:
            way[key] = value
        drawn_at = body(dict(view_of(cell_of(request), forged)), "cup")
        assert np.abs(drawn_at - at_start).max() < 1e-3 or key == "place"
    forged = copy.deepcopy(answer)
    forged["refusal"]["step"] = 63
    assert np.abs(body(dict(view_of(cell_of(request), forged)), "cup") - at_start).max() < 1e-3
