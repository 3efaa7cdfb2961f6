"""What lies in a moving carton does not hide the clearance of the arm: it has a line of its own."""

from __future__ import annotations

import copy
from typing import Any

import pytest

from assur.scenes.requests import cell_of, check_document, plan_cell
from assur.scenes.scenarios import shipped
from tests.scenes.forged_cells import SMALL, answered

Document = dict[str, Any]


def margins(request: Document) -> Document:
    """The margins of an answer, which the checker accepts."""
    answer = plan_cell(cell_of(request), unstated={"report": "full"})
    assert answer["status"] == "planned", answer.get("sentence")
    assert check_document(request, answer)["ok"]
    found: Document = answer["margins"]
    return found


def test_the_clearance_of_the_arm_comes_first_and_that_of_a_lid_on_a_moving_floor_apart() -> None:
    found = answered("put-down")[1]["margins"]
    # while it is held the lid comes as near to the bed, at the point, where 2 mm are required
    assert found["nearest"]["phase"] in ("APPROACH", "FOLLOW")
    assert found["placed"]["bodies"] in (["lid", "bed"], ["bed", "lid"])
    assert found["placed"]["gap_m"] == pytest.approx(0.004, abs=5e-5)
    assert found["placed"]["phase"] in ("DEPART", "MOVE", "WAIT", "REST")
    assert [set(pair["bodies"]) for pair in found["travel_pairs"]] == [
        {"lid", "table"},
        {"lid", "floor"},
        {"lid", "bed"},
        {"link-1", "shaft"},
    ]
    assert all(pair["gap_m"] >= 0.008 - 1e-4 for pair in found["travel_pairs"])


def test_a_lid_that_stands_on_a_table_has_no_such_line() -> None:
    request = copy.deepcopy(SMALL["put-down"])
    request["frames"]["out"] = {"fixed": {"at_mm": [100, -350, 40]}}
    assert margins(request)["placed"] is None


def test_a_lid_that_was_never_put_down_has_no_such_line() -> None:
    request = copy.deepcopy(SMALL["put-down"])
    del request["task"][1]
    assert margins(request)["placed"] is None


def test_a_higher_floor_moves_that_line_alone() -> None:
    request = copy.deepcopy(SMALL["put-down"])
    request["bodies"][1]["shape"]["box"]["size_mm"][2] = 12
    request["bodies"][1]["pose"]["at_mm"][2] = 6
    request["task"][1]["place"]["to"]["at_mm"][2] = 22
    found = margins(request)
    assert found["placed"]["gap_m"] == pytest.approx(0.012, abs=5e-5)
    # a post towards which the lid rides when the arm has gone
    post = {"name": "post", "shape": {"box": {"size_mm": [20, 20, 60]}}, "pose": {"at_mm": [166.5, -350, 80]}}
    request["bodies"].append(post)
    request["options"] |= {"clearance_mm": {"travel": 2, "near": 2}, "seed": 1}
    again = margins(request)
    assert set(again["placed"]["bodies"]) == {"lid", "post"}
    assert again["placed"]["gap_m"] < 0.006
    assert again["nearest"]["gap_m"] > again["placed"]["gap_m"] + 0.002


def test_the_shipped_carton_states_both() -> None:
    found = margins(copy.deepcopy(dict(shipped("carton").request)))
    assert found["nearest"] is not None
