"""Rows for what an answer states are true where motions are sampled, and peaks and margins are reached."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from assur.planner.arrays import FloatArray
from assur.planner.claim import columns as c
from assur.planner.claim import filling
from assur.planner.claim.answer import with_answer
from assur.planner.claim.distances import WITHIN_M
from assur.planner.model.phases import phases
from assur.planner.robots.facts import AHEAD
from assur.planner.robots.robot import Robot
from tests.planner.checker.statement.cases import case_of
from tests.planner.robots.families import NAMES, robot_named


def product(robot: Robot, row: FloatArray, q: FloatArray) -> FloatArray:
    """The scalar product (T,) that a row of `axes` is about, for joints q (T, n)."""
    p, r = robot.placements(q)
    link, other = (int(row[k]) for k in (c.AXIS_LINK, c.AXIS_OTHER))
    way = np.einsum("tij,j->ti", r[:, link], row[c.AXIS_ON : c.AXIS_OTHER])
    if row[c.AXIS_PLACE] == 1.0:
        way = way + p[:, link] - p[:, other]
    along = np.einsum("tij,j->ti", r[:, other], row[c.AXIS_DIRECTION : c.AXIS_LOW])
    return np.asarray((way * along).sum(-1))


@pytest.mark.parametrize("name", NAMES)
def test_the_bends_of_an_arm_are_its_margin_and_their_signs_its_mode(name: str) -> None:
    robot, rng = robot_named(name), np.random.default_rng(1)
    chain, seen = robot.chain, set[int]()
    q = rng.uniform(robot.limits.lower, robot.limits.upper, (2000, len(robot.joints)))
    mode, margin = robot.mode_of(q), robot.margin(q)
    q, mode, margin = q[mode >= 0], mode[mode >= 0], margin[mode >= 0]
    on = [(0.0, 0.0, 0.0) if b.length > 0.0 else AHEAD for b in chain.bends]
    rows = [(0.0, 0.0, b.link, float(b.length > 0.0), *axis, b.other, *b.along, 0.0, 0.0)
            for b, axis in zip(chain.bends, on, strict=True)]  # fmt: skip
    found = [product(robot, np.array(row, dtype=float), q) / (b.length or 1.0)
             for row, b in zip(rows, chain.bends, strict=True)]  # fmt: skip
    assert np.min(np.abs(found), axis=0) == pytest.approx(margin, abs=1e-9)
    for k in range(len(q)):
        if margin[k] > 1e-6:
            assert tuple(np.sign([each[k] for each in found]).astype(int)) == chain.signs[mode[k]]
            seen.add(int(mode[k]))
    assert seen == set(range(len(robot.modes)))


def test_a_clearance_that_is_not_kept_has_no_rows_for_its_phase() -> None:
    case = case_of("demo")
    said = case.claims.nearest
    assert said is not None
    assert said[0] is not None
    too_large = replace(case.claims, nearest=(replace(said[0], gap_m=said[0].gap_m + 0.01),))
    base, of_plan = filling.claim_of(case.scene), phases(case.scene, case.plan.legs, case.plan.arrivals)
    claim = with_answer(base, case.claim, case.plan, of_plan, too_large)
    then = next(phase for phase in of_plan if phase.t0 <= said[0].time <= phase.t1)
    assert claim.required[0, c.REQUIRED_NEAREST] == said[0].gap_m + 0.01 - WITHIN_M
    assert not ((claim.gap_rows[:, 0] < then.t1) & (claim.gap_rows[:, 1] > then.t0)).any()
    assert len(claim.gap_rows)
