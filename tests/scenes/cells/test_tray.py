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


def test_a_tool_that_goes_down_between_the_walls_of_a_tray_is_verified() -> None:
    """At an end of an interval the cup is exactly as far from the box of the tray as the smallest clearance that is
    stated, and from no wall of it: neither more nor fewer halvings tell, the walls have to be looked at one by one."""
    request = copy.deepcopy(dict(shipped("tray").request))
    tool = request["robot"]["tool"]
    tool.update(tcp_mm=[0, 0, -110], mass_kg=0.4)
    tool["bodies"] = [{"name": "cup", "shape": {"cylinder": {"radius_mm": 8, "height_mm": 110}}, "at_mm": [0, 0, -55]}]
    request["start"]["joints"] = {"j1_deg": -30, "j2_deg": 70, "j3_mm": 300, "j4_deg": 0}
    request["bodies"] = [
        {"name": "table", "shape": {"box": {"size_mm": [300, 700, 40]}}, "pose": {"at_mm": [320, 0, 20]}},
        {
            "name": "tray",
            "shape": {"mesh": {"asset": "tray", "unit": "mm"}},
            "pose": {"body": "table", "at_mm": [0, 180, 20], "yaw_deg": 10},
        },
        {
            "name": "part",
            "shape": {"box": {"size_mm": [40, 30, 20]}},
            "pose": {"body": "table", "at_mm": [0, -180, 30]},
            "mass_kg": 0.1,
        },
    ]
    pick, place = (step[kind] for step, kind in zip(request["task"], ("pick", "place"), strict=True))
    place["to"] = {"body": "tray", "at_mm": [20, 10, 18], "yaw_deg": 0}
    del place["contact_with"]
    for step in (pick, place):
        step["approach"] = step["depart"] = {"mm": 6}
    request["options"].update(clearance_mm={"travel": 4, "near": 1})
    answer: Any = plan_document(request)
    assert answer["status"] == "planned", answer["sentence"]
    assert check_document(request, answer)["ok"]
