"""A refusal states the end of the range that the joint is beyond, not the other one."""

from __future__ import annotations

from dataclasses import replace

import pytest

from assur.planner.checker.refusals.judging import check_refusal
from assur.planner.model.refusal import BeyondRange, Stage
from tests.planner.cells import cell, go
from tests.planner.checker.refusals.test_starts import refused


@pytest.mark.parametrize(
    ("place", "joint", "by"),
    [
        ((0.4, 0.1, 0.02), 2, -0.03),
        ((0.4, 0.1, 0.3), 2, 0.05),
        ((-0.4, -0.02, 0.1), 0, -0.0374),
        ((-0.4, 0.02, 0.1), 0, 0.0374),
    ],
)
def test_a_joint_is_beyond_the_end_of_its_range_that_is_nearer(
    place: tuple[float, float, float], joint: int, by: float
) -> None:
    scene = cell(go(*place))
    outcome = refused(scene)
    refusal, ends = outcome.refusal, scene.robot.limits
    assert refusal is not None
    assert (refusal.stage, type(refusal.facts)) == (Stage.CONTROL_POINT, BeyondRange)
    assert isinstance(refusal.facts, BeyondRange)
    low, high = float(ends.lower[joint]), float(ends.upper[joint])
    value, limit = refusal.facts.value, refusal.facts.limit
    assert value is not None
    assert limit == (low if by < 0.0 else high)
    assert value - limit == pytest.approx(by, abs=1e-4)
    assert check_refusal(scene, refusal, outcome.witness).ok
    other = replace(refusal.facts, value=low + high - value, limit=low + high - limit)
    assert not check_refusal(scene, replace(refusal, facts=other), outcome.witness).ok
