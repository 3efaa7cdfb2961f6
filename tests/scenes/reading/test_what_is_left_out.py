"""What a request leaves open and nobody proves is among the assumptions of its answer; and a request in which rounding
would count is refused at its frame."""

from __future__ import annotations

import copy
from typing import Any

import pytest

from assur.scenes.catalogue import shipped_robot
from assur.scenes.reading.cell import NO_LAG, NO_PAIRS
from assur.scenes.requests import cell_of
from assur.scenes.scenarios import shipped
from tests.refused import refused_at
from tests.scenes.bad_requests import GOOD_REQUEST


def with_pairs(pairs: list[list[str]]) -> Any:
    """The good request, for an arm of its own that has these pairs of links."""
    request = copy.deepcopy(GOOD_REQUEST)
    arm = copy.deepcopy(dict(shipped_robot("benchmark-scara").document["scara"]))
    request["robot"] = {"scara": {**arm, "self_pairs": pairs}, "tool": request["robot"]["tool"]}
    request["start"]["joints"] = {"q1_deg": 17.2, "q2_deg": 68.8, "z_mm": 200, "q4_deg": 0}
    return request


@pytest.mark.parametrize(("pairs", "told"), [([], True), ([["link1", "quill"]], True), ([["link1", "flange"]], False)])
def test_a_tool_that_nothing_keeps_clear_of_its_own_arm_is_an_assumption(pairs: list[list[str]], told: bool) -> None:
    assert (NO_PAIRS in cell_of(with_pairs(pairs)).scene.assumptions) == told


def test_that_no_lag_of_another_robot_is_known_is_an_assumption() -> None:
    scenario = shipped("two-robots-late")
    found = cell_of(scenario.request, folder=scenario.folder).scene.assumptions
    names = [other["name"] for other in scenario.request["neighbours"]]
    assert [line for line in found if "lag" in line] == [NO_LAG.format(name) for name in names]
    assert not [line for line in cell_of(GOOD_REQUEST).scene.assumptions if "lag" in line]


def test_a_dial_that_is_fast_and_was_stated_long_ago_is_refused_with_what_is_allowed() -> None:
    request = copy.deepcopy(GOOD_REQUEST)
    request["frames"]["dial"]["turntable"] |= {"rate_deg_s": 50_000, "at_s": -99_000}
    with refused_at("frames.dial", match=r"a way of at most 200000 m, speed times time .* stated at -99000 s"):
        cell_of(request)
    request["frames"]["dial"]["turntable"]["at_s"] = -500
    cell_of(request)
