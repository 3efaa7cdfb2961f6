"""Parts on the floor of a mesh tray: where they may touch it, and how deep."""

from __future__ import annotations

import copy
from typing import Any

import pytest

from assur.scenes.requests import check_document, plan_document, shipped

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
@pytest.mark.parametrize("above_mm", [-0.3, -2.0])
def test_a_part_that_would_stand_in_the_floor_is_refused(shape: str, above_mm: float) -> None:
    answer: Any = plan_document(placed(shape, above_mm))
    assert answer["status"] == "not_planned"
    assert "tray" in answer["sentence"]


@pytest.mark.parametrize("shape", SHAPES)
def test_a_tray_that_is_not_said_to_be_rested_on_has_to_be_kept_clear_of(shape: str) -> None:
    """Its walls could be met as well: nobody says that they are not."""
    request = placed(shape)
    del request["task"][1]["place"]["contact_with"]
    answer: Any = plan_document(request)
    assert answer["status"] == "not_planned"
    assert "tray" in answer["sentence"]
