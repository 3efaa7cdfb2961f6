"""Recipes say the points, speeds and arches of the plan, and that nobody has run them."""

from __future__ import annotations

import copy
import math
import re

import numpy as np
import pytest

from assur.planner.errors import InputError
from assur.scenes.exports.documents import export_document
from tests.refused import refused_at
from tests.scenes.exports.plans import planned, request_of

POINT = re.compile(r"^P(\d+) ?= ?(?:XY)?\(([^)]*)\)", re.MULTILINE)


def recipe(name: str, form: str) -> str:
    """The recipe of the plan of a shipped scenario."""
    text: str = export_document(request_of(name), planned(name), {"format": form})["file"]
    return text


@pytest.mark.parametrize("form", ["spel", "melfa"])
def test_points_are_where_the_plan_meets_them_and_each_leg_goes_to_its_own(form: str) -> None:
    export = export_document(request_of("demo"), planned("demo"), {"format": form})
    text, legs = export["file"], planned("demo")["legs"]
    assert "NOT EXECUTED AND NOT PROVED HERE" in text.splitlines()[0]
    assert "NOT EXECUTED AND NOT PROVED HERE" in export["statement"][0]
    points = {int(n): [float(x) for x in numbers.split(",")] for n, numbers in POINT.findall(text)}
    assert sorted(points) == list(range(len(legs) + 1))
    for arrival in planned("demo")["arrivals"]:
        number = next(k for k, leg in enumerate(legs, start=1) if leg["to_s"] == arrival["time_s"])
        assert points[number][:3] == pytest.approx([1e3 * x for x in arrival["at_m"]], abs=1e-3)
        turned = math.radians(points[number][-1]) - arrival["yaw_rad"]
        assert abs(math.remainder(turned, math.tau)) < 1e-4
    for number in range(1, len(legs) + 1):
        assert re.search(rf"^(Go|Move|Mov|Mvs|Jump) P{number}\b", text, re.MULTILINE)
    assert text.count("the controller must track its frame here") == 6


@pytest.mark.parametrize(("form", "word"), [("spel", "Jump P"), ("melfa", "straight up")])
def test_an_arch_is_told_with_its_straight_parts(form: str, word: str) -> None:
    text = export_document(request_of("standard-cycle"), planned("standard-cycle"), {"format": form})["file"]
    assert any(leg["kind"] == "ARCH" for leg in planned("standard-cycle")["legs"])
    assert word in text


def test_an_arch_is_written_as_each_language_has_it() -> None:
    text = {form: recipe("standard-cycle", form) for form in ("spel", "melfa")}
    # the arch number stands before the highest height
    assert re.search(r"^Arch 0, \d+\.\d, \d+\.\d\nJump P1 C0 LimZ \d+\.\d$", text["spel"], re.MULTILINE)
    # up from where it is, across, down: never across at first
    ways = re.findall(
        r"^PTOP=P0\nPTOP\.Z=(.*)\nMvs PTOP\nPTOP=P1\nPTOP\.Z=(.*)\nMov PTOP\nMvs P1$", text["melfa"], re.M
    )
    assert len(ways) == 1
    assert ways[0][0] == ways[0][1]


def test_no_line_is_longer_than_the_controller_takes() -> None:
    for name in ("demo", "standard-cycle", "scan-on-dial"):
        assert max(map(len, recipe(name, "melfa").splitlines())) <= 127


def test_turns_of_the_wrist_are_written_as_each_language_counts_them() -> None:
    spel, melfa = recipe("demo", "spel"), recipe("demo", "melfa")
    points = list(zip(POINT.findall(spel), re.findall(r"^P\d+=\(.*\)\(\d+,(\d+)\)$", melfa, re.M), strict=True))
    beyond = 0
    for (number, numbers), flag in points:
        stands = re.search(rf"^' P{number}: .*j1 (.*) deg, j2 (.*) deg, j3 .* mm, j4 (.*) deg$", spel, re.MULTILINE)
        assert stands is not None
        j1, j2, j4 = map(float, stands.groups())
        assert float(numbers.split(",")[3]) == pytest.approx(j1 + j2 + j4, abs=2e-3)
        assert int(flag) == (4096 if j4 > 180.0 else 0)
        beyond += j4 > 180.0
    assert beyond > 0


def test_flags_of_turns_have_four_bits_for_each_joint() -> None:
    from assur.scenes.exports.export import motion_for
    from assur.scenes.exports.recipe import _turns
    from assur.scenes.requests import cell_of, read_plan

    cell = cell_of(request_of("demo"))
    motion = motion_for(cell, request_of("demo"), read_plan(cell, planned("demo"))[0], "spel", None)
    for degrees, flag in ((0, 0), (179, 0), (181, 0x1000), (-181, 0xF000), (541, 0x2000), (-541, 0xE000)):
        assert _turns(motion, np.array([0.0, 0.0, 5.0, math.radians(degrees)])) == flag


def test_rates_are_in_the_units_and_ranges_of_the_controller() -> None:
    spel, melfa = recipe("demo", "spel"), recipe("demo", "melfa")
    straight = [tuple(map(int, each)) for each in re.findall(r"^SpeedS (\d+): AccelS (\d+), (\d+)$", spel, re.M)]
    assert len(straight) == 6
    assert all(0 < speed <= 2000 and 0 < up == down <= 25000 for speed, up, down in straight)
    assert "more than the controller takes" in spel
    # in motion from its begin: what reaches 250 mm/s in 80 ms
    assert (250, 3125, 3125) in straight
    joints = [tuple(map(int, each)) for each in re.findall(r"^Speed (\d+): Accel (\d+), (\d+)$", spel, re.M)]
    assert all(1 <= speed <= 100 and up == down for speed, up, down in joints)
    # the demo leaves 60 % of the robot's acceleration, and its moves use all of that: 59 or 60 per cent, rounded down
    assert request_of("demo")["robot"]["limits"]["acceleration"] == 0.6
    assert {up for _, up, _ in joints} <= {59, 60}
    assert len(joints) == 3
    assert len(re.findall(r"^(?:Spd|JOvrd) \d+\nAccel \d+,\d+$", melfa, re.M)) == len(planned("demo")["legs"])
    assert "Accel 1,1" not in melfa


def test_a_path_is_not_said_to_be_straight() -> None:
    for name, times in (("bead-on-belt", 1), ("circular-legs", 2)):
        assert recipe(name, "spel").count("the plan goes along the path of the step here") == times
    assert "the plan goes along the path" not in recipe("demo", "spel")


@pytest.mark.parametrize("name", ["circular-legs", "demo", "standard-cycle"])
def test_a_recipe_is_made_from_the_task_and_not_from_routes_which_nobody_verifies(name: str) -> None:
    answer = copy.deepcopy(planned(name))
    for leg in answer["legs"]:
        leg.pop("route"), leg.pop("note")
    for form in ("spel", "melfa"):
        assert export_document(request_of(name), answer, {"format": form})["file"] == recipe(name, form)


def test_recipes_are_for_scaras_and_have_no_ticks() -> None:
    with refused_at("format", match="no SCARA with a wrist"):
        export_document(request_of("rv-m1"), planned("rv-m1"), {"format": "melfa"})
    with pytest.raises(InputError, match="is a recipe"):
        export_document(request_of("demo"), planned("demo"), {"format": "spel", "tick_ms": 1})
