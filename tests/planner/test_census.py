"""Refusals are counted by stage, reason, step, subject and unit, with the span of their times and amounts."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial

import pytest

from assur.planner.collision.rows import ProofFailure
from assur.planner.collision.screening import Encounter
from assur.planner.model.refusal import (
    Bodies,
    FrameName,
    JointName,
    Quantity,
    Reason,
    Refusal,
    Separation,
    Stage,
    Subject,
)
from assur.planner.search.census import Counter, refused_proof


def refusal(
    amount: float, t: float | None = None, subject: Subject | None = Bodies(("cup", "gate")), step: int = 0
) -> Refusal:
    return Refusal(
        stage=Stage.SCREENING,
        reason=Reason.BODY_COLLISION,
        step=step,
        subject=subject,
        interval=None if t is None else (t, t),
        amount=Quantity.of(amount, "m"),
        facts=Separation(touching=False, gap_m=-amount, required_m=0.0),
    )


def test_refusals_of_one_kind_are_one_line_with_their_spans() -> None:
    counter = Counter()
    for amount, t in ((0.02, 1.0), (0.005, 0.4), (0.01, 2.0)):
        counter.add(refusal(amount, t))
    census = counter.census()
    assert census.refused == 3
    assert len(census.lines) == 1
    line = census.lines[0]
    assert line.count == 3
    assert line.refusal == replace(refusal(0.005), interval=(0.4, 2.0))
    assert (line.least, line.most) == (0.005, 0.02)


def test_fcl_is_asked_about_the_refusal_that_is_told_and_its_answer_is_told() -> None:
    for touching in (True, False):
        asked: list[float] = []

        def touches(amount: float, answer: bool = touching, asked: list[float] = asked) -> bool:
            asked.append(amount)
            return answer

        counter = Counter()
        for amount in (0.02, 0.005, 0.01):
            counter.add_all((Encounter(refusal(amount), partial(touches, amount)),))
        facts = counter.census().lines[0].refusal.facts
        assert isinstance(facts, Separation)
        assert facts.touching is touching
        assert asked == [0.005]


def test_what_differs_in_subject_step_or_unit_is_a_line_of_its_own_and_the_most_frequent_comes_first() -> None:
    counter = Counter()
    counter.add(refusal(0.01))
    for _ in range(3):
        counter.add(refusal(0.01, subject=Bodies(("cup", "post"))))
    counter.add(refusal(0.01, step=1))
    counter.add(refusal(math.nan))
    for subject in (JointName("gate"), FrameName("gate"), Bodies(("gate",))):
        counter.add(refusal(0.01, subject=subject))
    census = counter.census()
    assert [line.count for line in census.lines] == [3, 1, 1, 1, 1, 1, 1]
    assert census.lines[0].refusal.bodies == ("cup", "post")


def test_the_order_of_lines_does_not_depend_on_the_order_of_refusals() -> None:
    some = [
        refusal(amount, subject=Bodies(names))
        for amount, names in ((0.01, ("a", "b")), (0.02, ("a", "c")), (0.03, ("b", "c")))
    ]
    first, second = Counter(), Counter()
    for each in some:
        first.add(each)
    for each in reversed(some):
        second.add(each)
    assert first.census() == second.census()


def test_a_note_is_no_candidate() -> None:
    counter = Counter()
    counter.note(refusal(0.01))
    counter.candidates += 2
    census = counter.census()
    assert (census.candidates, census.refused, len(census.lines)) == (2, 0, 1)


def test_without_numbers_a_line_has_none() -> None:
    counter = Counter()
    for amount in (math.nan, math.inf):
        counter.add(refusal(amount))
    (line,) = counter.census().lines
    assert (line.count, line.least, line.most, line.refusal.interval) == (2, None, None, None)


@pytest.mark.parametrize(
    ("gap", "touching", "of_robot", "reason"),
    [
        (-0.01, True, False, Reason.BODY_COLLISION),
        (0.001, False, False, Reason.BODY_COLLISION),
        (0.001, False, True, Reason.SELF_COLLISION),
        (0.003, False, False, Reason.NOT_CERTIFIED),
        (math.nan, False, False, Reason.NOT_CERTIFIED),
    ],
)
def test_a_failed_proof_is_a_collision_unless_the_bodies_are_apart(
    gap: float, touching: bool, of_robot: bool, reason: Reason
) -> None:
    found = refused_proof(ProofFailure(("cup", "gate"), 1.5, gap, 0.002, touching, of_robot), 3, ("near", 0.0015))
    assert (found.reason, found.bodies, found.step, found.interval) == (reason, ("cup", "gate"), 3, (1.5, 1.5))
    assert isinstance(found.facts, Separation)
    assert (found.facts.touching, found.facts.required_m) == (touching, 0.002)
