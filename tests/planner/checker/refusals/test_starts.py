"""Refusals of the state at the start, which no document can have: proved by their facts, and by nothing else."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from assur.planner.checker.refusals.judging import check_refusal
from assur.planner.checker.verdict import Code
from assur.planner.model.outcome import NotPlanned
from assur.planner.model.refusal import (
    BeyondRange,
    JointName,
    LawEnds,
    MotionLimit,
    Quantity,
    Reason,
    Refusal,
    Stage,
)
from assur.planner.model.scene import Follow, Scene, Window
from assur.planner.model.window_missed import Miss, WindowMissed
from assur.planner.model.witness import PROVED_S, PROVED_SHARE, OpenIntervals
from assur.planner.pipeline import plan
from tests.planner.cells import at, cell, go


def refused(scene: Scene) -> NotPlanned:
    outcome = plan(scene)
    assert isinstance(outcome, NotPlanned)
    return outcome


def lies(refusal: Refusal) -> list[Refusal]:
    """The same with one thing that is not so."""
    facts = refusal.facts
    assert isinstance(facts, BeyondRange | MotionLimit)
    assert refusal.amount is not None
    assert facts.value is not None
    assert facts.limit is not None
    return [
        replace(refusal, amount=Quantity(2.0 * refusal.amount.value, refusal.amount.unit)),
        replace(refusal, amount=Quantity(refusal.amount.value, "s")),
        replace(refusal, amount=Quantity(float("nan"), refusal.amount.unit)),
        replace(refusal, amount=None),
        replace(refusal, subject=JointName("theta4")),
        replace(refusal, subject=None),
        replace(refusal, facts=replace(facts, value=facts.value + 0.01)),
        replace(refusal, facts=replace(facts, limit=facts.limit + 0.01)),
        replace(refusal, facts=replace(facts, mode="left")),
        replace(refusal, facts=replace(facts, path_m=0.0)),
        replace(refusal, stage=Stage.INVERSE),
        replace(refusal, reason=Reason.OUT_OF_REACH),
        replace(refusal, interval=(0.0, 1.0)),
        replace(refusal, step=1),
        replace(refusal, step=-1),
    ]


BEYOND = {
    "a lift beyond its range": ((0.3, 1.2, 0.3, 0.0), (0.0,) * 4, Reason.JOINT_LIMIT),
    "a joint that is too fast": ((0.3, 1.2, 0.2, 0.0), (9.0, 0.0, 0.0, 0.0), Reason.MOTION_LIMIT),
}


@pytest.mark.parametrize("name", BEYOND)
def test_a_start_beyond_a_limit_is_proved_by_its_facts_alone(name: str) -> None:
    q, qd, reason = BEYOND[name]
    scene = cell(go(0.35, 0.2), q=q, qd=qd)
    outcome = refused(scene)
    assert (outcome.reason, outcome.proved, outcome.witness) == (reason, True, None)
    assert outcome.refusal is not None
    assert check_refusal(scene, outcome.refusal, None).ok
    for lie in lies(outcome.refusal):
        verdict = check_refusal(scene, lie, None)
        assert [finding.code for finding in verdict.findings] == [Code.REFUSAL], lie
    assert not check_refusal(scene, outcome.refusal, OpenIntervals(spans_s=())).ok
    assert not check_refusal(cell(go(0.35, 0.2)), outcome.refusal, None).ok


def test_a_start_that_is_beyond_a_limit_by_rounding_is_not_proved_to_be() -> None:
    upper = float(cell(go(0.35, 0.2)).robot.limits.upper[2])
    lower = float(cell(go(0.35, 0.2)).robot.limits.lower[2])
    over = 0.5 * PROVED_SHARE * (upper - lower)
    scene = cell(go(0.35, 0.2), q=(0.3, 1.2, upper + over, 0.0))
    assert not refused(scene).proved
    refusal = refused(cell(go(0.35, 0.2), q=(0.3, 1.2, upper + 4.0 * over, 0.0))).refusal
    assert refusal is not None
    assert not check_refusal(scene, refusal, None).ok


@pytest.mark.parametrize(("parts", "proved"), [(2.5, False), (3.5, True)])
def test_a_window_that_is_too_short_by_rounding_is_not_proved_to_be(parts: float, proved: bool) -> None:
    """Both of its ends and the time that is needed may be off."""
    short = Window(time=(1.0, 1.3 - parts * PROVED_S))
    assert refused(cell(Follow("f", at(0.35, 0.2), 0.3, window=short))).proved is proved


@pytest.mark.parametrize("miss", list(Miss))
def test_no_window_is_missed_by_a_point_that_has_none(miss: Miss) -> None:
    """A point that stands still, without a window: it can be met at all times, whatever is said."""
    scene = cell(go(0.35, 0.2))
    for amount in (None, Quantity(0.1, "s")):
        for facts in (
            WindowMissed(miss=miss),
            LawEnds(needed_s=1.0),
            WindowMissed(miss=miss, open_s=0.1, needed_s=0.2),
        ):
            reason = Reason.LAW_ENDS if isinstance(facts, LawEnds) else Reason.WINDOW_MISSED
            refusal = Refusal(stage=Stage.WINDOW, reason=reason, step=0, amount=amount, facts=facts)
            for spans in ((), ((0.0, 0.1),), ((0.0, 2e6),)):
                assert not check_refusal(scene, refusal, OpenIntervals(spans_s=spans)).ok


def test_what_no_code_can_show_is_refused() -> None:
    scene = cell(go(0.35, 0.2))
    for stage in Stage:
        for reason in Reason:
            for value in (np.nan, np.inf, 1.0):
                facts = BeyondRange(value=value, limit=0.0)
                amount = Quantity(value, "rad")
                refusal = Refusal(
                    stage=stage, reason=reason, step=0, amount=amount, subject=JointName("theta1"), facts=facts
                )
                assert not check_refusal(scene, refusal, None).ok
