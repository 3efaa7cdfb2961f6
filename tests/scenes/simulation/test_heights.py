"""Parts that lie in the air are noted before a run, with how far it is; and parts that are inside a body."""

from __future__ import annotations

import copy
from typing import Any

import pytest

from assur.scenes.simulation.cell import simulated
from assur.scenes.simulation.simulate import Simulation
from benchmarks.flows import FLOWS, flow
from tests.refused import refused_at
from tests.scenes.simulation import test_carriers as on_trays
from tests.scenes.simulation.test_simulation import cell

Document = dict[str, Any]
RIM: Document = {
    "name": "rim",
    "shape": {"box": {"size_mm": [20, 160, 30]}},
    "pose": {"at_mm": [180, -200, 65]},
}


def of_box(z_mm: float, **changes: Any) -> Document:
    """The shipped cell with slots at another height."""
    grid = {**cell()["slots"]["box"], "at_mm": [255, -235, z_mm], **changes}
    return cell(slots={"box": {key: value for key, value in grid.items() if value is not None}})


def comes(z_mm: float) -> Document:
    """The shipped cell with parts that come at another height."""
    return cell({"at_mm": [-900, 0, z_mm]})


def heights(document: Document) -> tuple[str, ...]:
    """The notes about heights."""
    return simulated(document).heights


@pytest.mark.parametrize("name", FLOWS)
def test_parts_that_lie_where_they_should_have_no_note(name: str) -> None:
    assert heights(flow(name)) == heights(on_trays.cell()) == heights(cell()) == ()


@pytest.mark.parametrize(
    ("document", "note"),
    [
        (comes(18), "streams.soap.at_mm: soap is 3 mm from belt-bed, and rests on nothing"),
        (comes(65), "streams.soap.at_mm: soap is 50 mm from belt-bed, and rests on nothing"),
        (of_box(68), "slots.box.at_mm: soap is 3 mm from box-bottom, and rests on nothing"),
        (of_box(80, contact_with=None), "slots.box.at_mm: soap is 15 mm from box-bottom, and rests on nothing"),
        (
            on_trays.cell(**{"slots__on-tray__at_mm": [42, -30, 26]}),
            "slots.on-tray.at_mm: soap is 5 mm from tray-1, and rests on nothing",
        ),
        (
            on_trays.cell(streams__tray__at_mm=[-510, 0, 9]),
            "streams.tray.at_mm: tray is 3 mm from out-belt-bed, and rests on nothing",
        ),
    ],
)
def test_a_part_in_the_air_is_noted(document: Document, note: str) -> None:
    assert heights(document) == (note,)
    assert note in Simulation(document, 0.2, 1, 1, 20.0).document["notes"]


def test_a_part_above_the_floor_of_a_box_and_below_its_rim_is_noted() -> None:
    found = of_box(69, contact_with=None)
    found["bodies"] = [*found["bodies"], RIM]
    assert heights(found) == ("slots.box.at_mm: soap is 4 mm from box-bottom, and rests on nothing",)


@pytest.mark.parametrize(
    ("document", "field", "note"),
    [
        (
            comes(12),
            "streams.soap.at_mm",
            "inside belt-bed, where no motion can take it or put it down: its lowest point is at z 47 mm",
        ),
        (of_box(61), "slots.box.at_mm", "soap is more than 1 mm inside box-bottom"),
        (of_box(61, contact_with=None), "slots.box.at_mm", "and the highest of box-bottom at 50 mm"),
        (on_trays.cell(**{"slots__on-tray__at_mm": [42, -30, 15]}), "slots.on-tray.at_mm", "inside tray-1"),
        (on_trays.cell(streams__tray__at_mm=[-510, 0, 2]), "streams.tray.at_mm", "inside out-belt-bed"),
    ],
)
def test_a_part_inside_a_body_is_noted(document: Document, field: str, note: str) -> None:
    (found,) = heights(document)
    assert found.startswith(f"{field}: ")
    assert note in found


@pytest.mark.parametrize("own", [{"lanes_mm": [-50, 50], "lane_mm": None}, {"lanes_mm": [50], "lane_mm": None}])
def test_a_rail_between_two_lanes_is_where_no_part_lies(own: Document) -> None:
    rail = {"name": "rail", "shape": {"box": {"size_mm": [2000, 10, 25]}}, "pose": {"at_mm": [0, 350, 62.5]}}
    found = cell({**own, "yaw_deg": [-5, 5], "every_s": 1.5, "mean_s": None})
    assert heights({**found, "bodies": [*found["bodies"], rail]}) == ()


def test_what_no_slot_can_rest_on_is_refused_at_its_field() -> None:
    with refused_at("slots.box.contact_with[0]", "the name of a body"):
        simulated(of_box(65, contact_with=["box-botom"]))


def test_heights_are_those_of_each_kind() -> None:
    """A flat kind hangs in the air where a high one lies."""
    kinds = copy.deepcopy(cell()["kinds"])
    kinds["chip"] = {**kinds["soap"], "shape": {"box": {"size_mm": [40, 40, 20]}}}
    found = heights(cell({"kind": None, "kinds": {"soap": 1, "chip": 1}}, kinds=kinds))
    assert found == tuple(
        f"{field}: chip is 5 mm from {body}, and rests on nothing"
        for field, body in (("streams.soap.at_mm", "belt-bed"), ("slots.box.at_mm", "box-bottom"))
    )
