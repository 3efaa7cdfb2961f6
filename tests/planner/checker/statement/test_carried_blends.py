"""A parabolic blend with a part that it may not accelerate too hard: the acceleration jumps within legs."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import assur
from assur.planner.checker.claim.verdict import check_claim
from assur.planner.checker.verdict import Code
from assur.planner.claim import columns as c
from assur.planner.claim.frames import knots_of
from assur.planner.claim.points import rates_of
from assur.planner.legs.tool_motion import tool_accelerations
from assur.planner.model.attachments import at_start
from assur.planner.model.outcome import LegKind
from assur.planner.model.phases import Phase
from assur.planner.trajectory import Trajectory
from tests.planner.checker.statement.cases import Case, Document, copied, differences, planned

BESIDE_S, NEAR_S = 1e-9, 1e-6


def request(most: float) -> Document:
    """The scenario with a part in the gripper, whose acceleration may be `most`, m/s²."""
    found: Document = assur.load("parabolic-blend")
    found["bodies"].append({"name": "part", "shape": {"sphere": {"radius_mm": 4}}})
    found["start"]["holding"] = {"part": "part", "grasp_mm": [0, 0, 0]}
    found["options"]["report"] = "full"
    found["carry"] = {"acceleration_m_s2": most}
    return found


@cache
def case() -> Case:
    """Its plan, whose greatest acceleration is all that it may be."""
    free = assur.plan(request(100.0))
    found = planned(request(float(free["margins"]["tool_acceleration_m_s2"]) * (1.0 + 1e-9)))
    assert found is not None
    return found


def test_a_blend_that_accelerates_its_part_as_hard_as_it_may_is_shown_and_stated() -> None:
    own, path = case().claim.rates, case().plan.trajectory
    assert path.jumps
    assert len(own) > 1
    for row in own:
        assert not ((path.time > row[c.RATE_T0]) & (path.time < row[c.RATE_T1])).any()
    assert check_claim(case().claim).findings == ()
    assert differences(case()) == []


def turned() -> Trajectory:
    """First one joint accelerates, then another, which moves the tool across."""
    h, q, none = 0.1, case().plan.trajectory.q[0], np.zeros(4)
    first, second = 10.0 * np.eye(4)[0], -20.0 * np.eye(4)[1]
    middle = [q + first * h**2 / 2.0, first * h]
    end = [q + first * 1.5 * h**2 + second * h**2 / 2.0, (first + second) * h]
    knots = [[[0.0], q, none, first], [[h], *middle, first], [[h], *middle, second], [[2.0 * h], *end, second]]
    return Trajectory.of_knots(np.array([np.hstack(knot) for knot in knots]), jumps=True)


def test_rows_beside_a_jump_and_over_it_are_shown_with_what_both_sides_have_and_with_no_less() -> None:
    path, own, scene = turned(), case().claim, case().scene
    jump = float(path.edges[1])
    sides = tool_accelerations(scene, path, np.array([jump - BESIDE_S, jump + BESIDE_S]))
    held = Phase(path.start, path.end, LegKind.MOVE, 0, at_start(scene))
    both = c.table("rates", [row for _, row in rates_of(scene, replace(case().plan, trajectory=path), [held])])
    assert both[:, c.RATE_T0 : c.RATE_LINK].tolist() == [[path.start, jump], [jump, path.end]]
    both[:, c.RATE_T0 : c.RATE_LINK] = [(jump - NEAR_S, jump), (jump, jump + NEAR_S)]
    over = both[:1].copy()
    over[0, c.RATE_T1] = jump + NEAR_S
    arms, knots = own.arms.copy(), knots_of(path, path.start, path.end)
    arms[0, c.ARM_KNOTS] = len(knots)
    for rows, sizes in ((both, sides), (over, sides.max(keepdims=True))):
        for share, shown in ((1.0 + 1e-4, True), (1.0 - 1e-4, False)):
            rows[:, c.RATE_MOST] = sizes * share
            verdict = check_claim(own._replace(arms=arms, knots=knots, rates=rows))
            assert (Code.RATE not in {finding.code for finding in verdict.findings}) is shown


@pytest.mark.parametrize("fault", ["a row left out", "a row with more", "a row of the velocity"])
def test_a_part_of_the_motion_whose_acceleration_is_not_stated_is_a_difference(fault: str) -> None:
    claim = copied(case().claim)
    middle = len(claim.rates) // 2
    if fault == "a row left out":
        claim = claim._replace(rates=np.delete(claim.rates, middle, axis=0))
    elif fault == "a row with more":
        claim.rates[middle, c.RATE_MOST] *= 1.01
    else:
        claim.rates[middle, c.RATE_ORDER] = 1.0
    assert {each.code for each in differences(case(), claim)} == {Code.RATE}
