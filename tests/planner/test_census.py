"""Refusals are counted by stage, reason, step and bodies, with the span of their times and amounts."""

from __future__ import annotations

import math

import pytest

from assur.planner.collision.rows import Unproved
from assur.planner.model.outcome import Reason, Refusal
from assur.planner.search.census import Counter, refused_proof


def refusal(amount: float, t: float | None = None, bodies: tuple[str, ...] = ("cup", "gate"), step: int = 0) -> Refusal:
    span = None if t is None else (t, t)
    return Refusal("screening", Reason.BODY_COLLISION, step, bodies, span, amount, "m", f"{amount:g}")


def test_refusals_of_one_kind_are_one_line_with_their_spans() -> None:
    counter = Counter()
    for amount, t in ((0.02, 1.0), (0.005, 0.4), (math.nan, None), (0.01, 2.0)):
        counter.add(refusal(amount, t))
    census = counter.census()
    assert census.refused == 4
    assert len(census.lines) == 1
    line = census.lines[0]
    assert line.count == 4
    assert line.interval == (0.4, 2.0)
    assert (line.least, line.most) == (0.005, 0.02)
    assert line.detail == "0.005"


def test_what_differs_in_bodies_step_or_unit_is_a_line_of_its_own_and_the_most_frequent_comes_first() -> None:
    counter = Counter()
    counter.add(refusal(0.01))
    for _ in range(3):
        counter.add(refusal(0.01, bodies=("cup", "post")))
    counter.add(refusal(0.01, step=1))
    census = counter.census()
    assert [line.count for line in census.lines] == [3, 1, 1]
    assert census.lines[0].bodies == ("cup", "post")


def test_the_order_of_lines_does_not_depend_on_the_order_of_refusals() -> None:
    some = [refusal(0.01, bodies=("a", "b")), refusal(0.02, bodies=("a", "c")), refusal(0.03, bodies=("b", "c"))]
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
    counter.add(refusal(math.nan))
    line = counter.census().lines[0]
    assert math.isnan(line.least)
    assert math.isnan(line.most)
    assert line.interval is None


@pytest.mark.parametrize(
    ("gap", "touching", "of_robot", "reason", "detail"),
    [
        (-0.01, True, False, Reason.BODY_COLLISION, "touch"),
        (0.001, False, False, Reason.BODY_COLLISION, "too close"),
        (0.001, False, True, Reason.SELF_COLLISION, "too close"),
        (0.003, False, False, Reason.NOT_CERTIFIED, "not proved"),
        (math.nan, False, False, Reason.NOT_CERTIFIED, "not proved"),
    ],
)
def test_a_failed_proof_is_a_collision_unless_the_bodies_are_apart(
    gap: float, touching: bool, of_robot: bool, reason: Reason, detail: str
) -> None:
    found = refused_proof(Unproved(("cup", "gate"), 1.5, gap, 0.002, touching, of_robot), 3)
    assert (found.reason, found.detail, found.step, found.interval) == (reason, detail, 3, (1.5, 1.5))
