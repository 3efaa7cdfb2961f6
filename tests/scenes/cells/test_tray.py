"""Parts on the floor of a mesh tray: what a part rests on is found, and how deep it may stand in it is kept."""

from __future__ import annotations

import copy
from typing import Any

import pytest

from assur.scenes.requests import cell_of, check_document, plan_document, shipped

Document = dict[str, Any]
SHAPES: dict[str, Document] = {
    "box": {"box": {"size_mm": [30, 20, 20]}},
    "cylinder": {"cylinder": {"radius_mm": 12, "height_mm": 20}},
    "mesh": {"mesh": {"asset": "bracket", "unit": "mm"}},
}
FLOOR_MM, PART_MM = 56.0, 20.0


def placed(shape: str, above_mm: float = 0.0) -> Document:
    request = copy.deepcopy(dict(shipped("tray").request))
    part = next(body for body in request["bodies"] if body["name"] == "part")
    part["shape"] = SHAPES[shape]
    request["task"][1]["place"]["to"]["at_mm"][2] = FLOOR_MM + PART_MM / 2 + above_mm
    return request


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("above_mm", [0.0, 1e-4, -0.05, 0.09])
def test_a_part_is_placed_on_the_floor_of_a_mesh_tray(shape: str, above_mm: float) -> None:
    request = placed(shape, above_mm)
    answer: Any = plan_document(request)
    assert answer["status"] == "planned", answer["sentence"]
    assert check_document(request, answer)["ok"]
    assert ["part", "tray"] in [contact["bodies"] for contact in answer["contacts"]]


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("above_mm", [-0.3, 0.3, -2.0])
def test_a_part_that_would_stand_in_the_floor_or_float_above_it_is_refused(shape: str, above_mm: float) -> None:
    answer: Any = plan_document(placed(shape, above_mm))
    assert answer["status"] == "not_planned"
    assert "tray" in answer["sentence"]


def test_the_levels_of_a_mesh_on_which_something_can_stand() -> None:
    """The floor of the tray, 24 mm below its middle, and its rim; of a solid body its top alone."""
    bodies = {body.name: body.body for body in cell_of(placed("box")).scene.bodies}
    assert bodies["tray"].tops == pytest.approx((-0.024, 0.03, 0.03), abs=1e-9)
    assert bodies["table"].tops == pytest.approx((0.02,))
