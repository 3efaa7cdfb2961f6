"""A refusal states what is shown, or one thing in it is different."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from assur.planner.checker.refusals.stated import Proof, same, states
from assur.planner.model.refusal import (
    BeyondRange,
    Bodies,
    ForbiddenYaw,
    JointName,
    OutOfReach,
    Quantity,
    Reason,
    Refusal,
    Stage,
)

FACTS = BeyondRange(mode="left", above_m=0.05, value=0.3, limit=0.25, path_at_m=(0.1, 0.2, 0.3))
SHOWN = Proof(Reason.JOINT_LIMIT, FACTS, Quantity(0.05, "m"), JointName("j3"))
TRUE = SHOWN.refusal(Stage.CONTROL_POINT, 2)


def test_a_refusal_states_itself_and_may_leave_out_what_is_optional() -> None:
    for given in (TRUE, replace(TRUE, facts=replace(FACTS, mode=None, path_at_m=None))):
        assert states(given, SHOWN)
    assert (TRUE.stage, TRUE.step) == (Stage.CONTROL_POINT, 2)
    assert states(TRUE, SHOWN._replace(interval=(1.0, 2.0)))
    assert states(replace(TRUE, amount=Quantity(0.05 + 1e-6, "m")), SHOWN._replace(within=5e-6))


@pytest.mark.parametrize(
    "lie",
    [
        replace(TRUE, reason=Reason.OUT_OF_REACH),
        replace(TRUE, subject=JointName("j2")),
        replace(TRUE, subject=Bodies(("j3",))),
        replace(TRUE, subject=None),
        replace(TRUE, interval=(0.0, 0.0)),
        replace(TRUE, amount=None),
        replace(TRUE, amount=Quantity(0.05, "rad")),
        replace(TRUE, amount=Quantity(0.06, "m")),
        replace(TRUE, amount=Quantity(math.nan, "m")),
        replace(TRUE, facts=OutOfReach()),
        replace(TRUE, facts=replace(FACTS, mode="right")),
        replace(TRUE, facts=replace(FACTS, value=None)),
        replace(TRUE, facts=replace(FACTS, value=math.nan)),
        replace(TRUE, facts=replace(FACTS, limit=0.2500001)),
        replace(TRUE, facts=replace(FACTS, arch_top_m=0.0)),
        replace(TRUE, facts=replace(FACTS, path_at_m=(0.1, 0.2, 0.4))),
        replace(TRUE, facts=replace(FACTS, path_m=0.0)),
    ],
)
def test_no_refusal_states_what_is_shown_with_one_thing_that_differs(lie: Refusal) -> None:
    assert not states(lie, SHOWN)


def test_full_turns_of_a_yaw_do_not_count_and_those_of_a_range_do() -> None:
    facts = ForbiddenYaw(first_rad=0.0, last_rad=1.0, yaw_rad=0.5)
    true = SHOWN._replace(facts=facts)
    assert states(replace(TRUE, facts=replace(facts, yaw_rad=0.5 - math.tau)), true)
    assert not states(replace(TRUE, facts=replace(facts, first_rad=math.tau)), true)
    assert not states(replace(TRUE, facts=replace(facts, on_the_way=True)), true)


def test_nothing_is_the_same_as_no_number() -> None:
    assert same(None, None)
    assert same(math.inf, math.inf)
    assert not same(None, 0.0)
    assert not same(0.0, None)
    assert not same(math.nan, math.nan)
    assert not same(1.0, math.inf)
