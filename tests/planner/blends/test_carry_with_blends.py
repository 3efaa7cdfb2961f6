"""A part that is held through parabolic blends: the tool point keeps the limit of its acceleration, on both sides of
every jump, and the checker refuses what does not."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from assur.planner.checker import Code, check
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import box
from assur.planner.model.outcome import NotPlanned, Planned
from assur.planner.model.refusal import Carrying, Reason
from assur.planner.model.scene import Holding, Scene, WorldBody
from assur.planner.pipeline import plan
from assur.planner.trajectory import Trajectory
from tests.planner.cells import CUP, cell, go, solid

LID = WorldBody(solid("lid", box(0.04, 0.04, 0.02)))


def holding(carry: float | None, given: float | None = None, **options: Any) -> Scene:
    """A lid is carried past a via to a stop."""
    task = (go(0.4, 0.0, 0.15, name="over", via=True), go(0.3, -0.25, 0.12, name="there"))
    scene = cell(*task, bodies=(LID,), tool=CUP, carry=carry, timing="parabolic_blend", max_candidates=40)
    start = replace(scene.start, holding=Holding("lid", Pose(z=0.01)))
    options = {"acceleration_time_s": given, **options}
    return replace(scene, start=start, options=replace(scene.options, **options))


def peak(scene: Scene, path: Trajectory) -> float:
    """The largest acceleration of the tool point, m/s², by differences of positions within each piece."""
    largest, h = 0.0, 1e-5
    for one, other in zip(path.edges[:-1], path.edges[1:], strict=True):
        if other - one < 4 * h:
            continue
        t = np.linspace(one + h, other - h, 400)
        p = [scene.robot.forward(path.evaluate(t + k * h))[0] for k in (-1, 0, 1)]
        largest = max(largest, float(np.linalg.norm(p[0] - 2 * p[1] + p[2], axis=-1).max()) / h**2)
    return largest


@pytest.mark.parametrize("given", [None, 0.15, 0.3])
@pytest.mark.parametrize("limit", [20.0, 3.0])
def test_the_limit_is_kept_by_a_slower_motion(given: float | None, limit: float) -> None:
    free = plan(holding(None, given))
    scene = holding(limit, given)
    found = plan(scene)
    assert isinstance(free, Planned)
    assert isinstance(found, Planned), found.sentence
    told = found.margins.tool_acceleration
    assert peak(scene, found.plan.trajectory) == pytest.approx(told, rel=5e-3)
    assert told <= limit
    if peak(scene, free.plan.trajectory) > limit:
        assert found.plan.trajectory.duration > free.plan.trajectory.duration
        assert told > 0.7 * limit  # no slower than it has to be
        # the checker, too, refuses the motion that pulls harder
        fast = check(scene, free.plan)
        assert {finding.code for finding in fast.findings} == {Code.CARRY}


def test_the_checker_bounds_each_side_of_a_jump_by_itself_and_no_more() -> None:
    """It accepts a limit that is just above the peak, and refuses one that is just below."""
    scene = holding(5.0)
    found = plan(scene)
    assert isinstance(found, Planned)
    true = peak(scene, found.plan.trajectory)
    for share, refused in ((1.002, False), (0.998, True)):
        findings = check(replace(scene, carry_acceleration=share * true), found.plan).findings
        assert (Code.CARRY in {finding.code for finding in findings}) is refused


def test_where_no_slower_motion_is_in_time_the_limit_is_told() -> None:
    scene = holding(1.0, latest_end_s=0.8)
    assert isinstance(plan(replace(scene, carry_acceleration=None)), Planned)
    found = plan(scene)
    assert isinstance(found, NotPlanned)
    lines = [line.refusal for line in found.census.lines if line.refusal.reason is Reason.CARRY_LIMIT]
    assert lines
    assert isinstance(lines[0].facts, Carrying)
    assert lines[0].facts.limit == 1.0
    assert not any(line.refusal.stage == "checker" for line in found.census.lines)
