"""The leading refusal and its sentence, in the words of the shop."""

from __future__ import annotations

import math
from typing import Any

import pytest

from assur.planner.model.outcome import Census, CensusLine, Reason, Refusal
from assur.planner.model.scene import Window
from assur.planner.report.sentence import leading, sentence
from tests.planner.cells import cell, go

SCENE = cell(go(0.35, 0.2, name="drop"), go(0.3, 0.0, name="home"))
NONE = Census(0, 0)


def line(
    count: int, stage: str = "screening", reason: Reason = Reason.BODY_COLLISION, step: int = 0, **more: Any
) -> CensusLine:
    facts: dict[str, Any] = {"bodies": ("cup", "gate"), "interval": (1.0, 2.0), "detail": ""}
    facts |= {"least": 0.012, "most": 0.03, "unit": "m"}
    return CensusLine(stage, reason, step, count=count, **{**facts, **more})


def test_the_most_frequent_refusal_of_the_step_that_was_never_passed_leads() -> None:
    census = Census(40, 40, (line(30, step=0), line(6, step=1), line(4, step=1, bodies=("cup", "post"))))
    first, second = leading(census, 0), leading(census, 1)
    assert first is not None
    assert first.count == 30
    assert second is not None
    assert second.count == 6


def test_a_mode_that_is_not_reached_leads_only_where_nothing_else_was_tried() -> None:
    once = line(1, "inverse", Reason.OUT_OF_REACH, bodies=(), detail="left: no joint position reaches it")
    assert leading(Census(20, 20, (line(20), once)), 0) == line(20)
    assert leading(Census(0, 0, (once,)), 0) == once
    assert leading(NONE, 0) is None


def said(refusal: Refusal | CensusLine | None, census: Census = NONE, *, cut: bool = False) -> str:
    return sentence(SCENE, refusal, census, cut=cut, budget=0.2)


def test_a_sentence_names_the_step_the_bodies_the_count_and_the_time() -> None:
    found = said(line(30), Census(40, 40, (line(30),)))
    assert found == "drop: cup would hit gate (30 of 40 candidates, between 1.00 s and 2.00 s)."
    at_once = said(line(30, interval=(1.0, 1.001)), Census(40, 40, (line(30),)))
    assert "at 1.00 s" in at_once
    assert "the budget of 0.2 s was spent" in said(line(30), Census(40, 40, (line(30),)), cut=True)


def test_what_no_candidate_refused_is_not_counted() -> None:
    refusal = line(1, "window", Reason.WINDOW_MISSED, bodies=(), least=0.034, unit="s", detail="too late")
    assert said(refusal) == "drop: the window is missed by at least 34 ms: too late."


def test_a_step_without_a_window_misses_the_end_of_the_plan() -> None:
    late = Refusal("timing", Reason.WINDOW_MISSED, 0, amount=0.037, unit="s", detail="no meeting time is left")
    ends = {"end": "latest_end_s", "window": "the window"}
    scenes = {
        "end": cell(go(0.35, 0.2, name="drop"), latest_end_s=1.0),
        "window": cell(go(0.35, 0.2, name="drop", window=Window(time=(0.0, 0.1))), latest_end_s=1.0),
    }
    for name, scene in scenes.items():
        told = sentence(scene, late, NONE, cut=False, budget=0.2)
        assert told == f"drop: {ends[name]} is missed by at least 37 ms: no meeting time is left."


@pytest.mark.parametrize(
    ("reason", "amount", "unit", "words"),
    [
        (Reason.OUT_OF_REACH, math.nan, "", "out of reach"),
        (Reason.JOINT_LIMIT, 0.02, "m", "20.0 mm beyond its limit"),
        (Reason.JOINT_LIMIT, math.radians(3), "rad", "3.0° beyond its limit"),
        (Reason.NEAR_SINGULARITY, 0.1, "1", "too near a singular position"),
        (Reason.SELF_COLLISION, 0.01, "m", "hit itself"),
        (Reason.BODY_COLLISION, 0.01, "m", "would hit"),
        (Reason.START_IN_COLLISION, 0.01, "m", "at the start"),
        (Reason.CONTROL_POINT_IN_COLLISION, 0.01, "m", "can never be met"),
        (Reason.MOTION_LIMIT, math.nan, "", "faster than it can be"),
        (Reason.CARRY_LIMIT, 1.0, "m/s²", "too much"),
        (Reason.WINDOW_MISSED, 0.034, "s", "34 ms"),
        (Reason.LAW_ENDS, 0.5, "s", "not known for long enough"),
        (Reason.NOT_CERTIFIED, math.nan, "m", "could not be proved"),
        (Reason.TIMED_OUT, math.nan, "", "budget"),
    ],
)
def test_every_reason_has_its_sentence(reason: Reason, amount: float, unit: str, words: str) -> None:
    found = said(Refusal("x", reason, 1, ("cup", "gate"), None, amount, unit, "because"))
    assert found.startswith("home: ")
    assert found.endswith(".")
    assert words in found
    assert "nan" not in found


@pytest.mark.parametrize(
    ("unit", "words"),
    [
        ("rad/s", "be faster than it can be"),
        ("m/s²", "accelerate more than it can"),
        ("rad/s³", "change its acceleration faster than it may"),
    ],
)
def test_a_motion_limit_names_the_joint_and_which_of_its_rates(unit: str, words: str) -> None:
    refusal = Refusal("glued", Reason.MOTION_LIMIT, 1, ("j1",), None, 1.0, unit, "the belt is too fast")
    assert said(refusal) == f"home: j1 would have to {words}: the belt is too fast."


def test_a_height_that_is_not_that_of_the_point_is_told() -> None:
    facts = Reason.JOINT_LIMIT, 1, ("j3",), None, 0.04, "m"
    above = said(Refusal("inverse", *facts, "right: j3 is beyond its limit, 30 mm above the point"))
    assert above == "home: 30 mm above the point j3 would have to go 40.0 mm beyond its limit."
    here = said(Refusal("inverse", *facts, "right: j3 is beyond its limit"))
    assert here == "home: j3 would have to go 40.0 mm beyond its limit."


def test_every_reason_is_tried_above() -> None:
    """A reason without a sentence would be a fault in the middle of an answer."""
    for reason in Reason:
        assert said(Refusal("x", reason, 0, ("cup", "gate"))).endswith(".")


def test_too_close_is_not_a_hit() -> None:
    assert "too close to" in said(line(3, detail="too close"))


def test_with_nothing_tried_the_sentence_says_so() -> None:
    assert said(None) == "No plan was found in 0.2 s; nothing was tried."
    assert "among 70 candidates" in said(None, Census(70, 60))
