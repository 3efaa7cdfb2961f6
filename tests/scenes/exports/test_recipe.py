"""Recipes say the points, speeds and arches of the plan, and that nobody has run them."""

from __future__ import annotations

import math
import re

import pytest

from assur.planner.errors import InputError
from assur.scenes.exports.doors import export_document
from tests.scenes.exports.plans import planned, request_of

POINT = re.compile(r"^P(\d+) ?= ?(?:XY)?\(([^)]*)\)", re.MULTILINE)


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


def test_recipes_are_for_scaras_and_have_no_ticks() -> None:
    with pytest.raises(InputError, match="no SCARA with a wrist") as caught:
        export_document(request_of("rv-m1"), planned("rv-m1"), {"format": "melfa"})
    assert caught.value.field == "format"
    with pytest.raises(InputError, match="is a recipe"):
        export_document(request_of("demo"), planned("demo"), {"format": "spel", "tick_ms": 1})
