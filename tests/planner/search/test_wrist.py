"""The wrist turns no further than it has to: of options of the same duration the one that turns it least."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from assur.planner.bound.duration import least_duration
from assur.planner.collision.proof import Prover
from assur.planner.frames.motion import Pose
from assur.planner.legs.meeting import Meetings
from assur.planner.model.outcome import Planned
from assur.planner.model.phases import yaw_offsets
from assur.planner.model.scene import Clearance, Pick, Scene, Step
from assur.planner.pipeline import plan
from assur.planner.search.beam import Search
from assur.planner.search.meeting_options import options
from assur.planner.search.partial_plan import initial, prepared
from tests.planner.cells import CUP, PART, arm, at, belt_and_dial, cell, go, stands


def wrist(scene: Scene) -> np.ndarray:
    """The last joint's positions at the knots of the plan."""
    outcome = plan(scene)
    assert isinstance(outcome, Planned), outcome.sentence
    return np.asarray(outcome.plan.trajectory.q[:, -1])


def free(x: float, y: float, name: str) -> Step:
    return replace(go(x, y, name=name), target=replace(at(x, y), yaw_free=True))


@pytest.mark.parametrize("elbow", ["keep", "auto"])
def test_a_free_yaw_leaves_the_wrist_as_it_is(elbow: str) -> None:
    scene = cell(free(0.35, -0.2, "a"), free(0.2, 0.4, "b"), free(0.4, 0.1, "c"), elbow=elbow)
    assert np.abs(wrist(scene) - scene.start.q[-1]).max() < 1e-6


@pytest.mark.parametrize("yaw", [0.3, 2.0, 3.0, -2.5])
def test_the_nearest_of_several_full_turns_is_taken(yaw: float) -> None:
    q = wrist(cell(go(0.35, -0.2, yaw=yaw), elbow="keep"))
    assert abs(q[-1] - q[0]) <= math.pi + 1e-9


def test_a_pick_and_a_place_turn_less_than_a_turn() -> None:
    q = wrist(belt_and_dial())
    assert q.max() - q.min() < 2 * math.pi


def test_the_lower_bound_is_of_all_turns_and_not_only_of_those_that_are_tried() -> None:
    """A part that fits in any of sixty turns offers more options than are tried."""
    part = stands("part", PART, 0.3, -0.25, 0.05, yaw_symmetry=60)
    pick = Pick("pick", "part", Pose(z=0.01), 0.0, 0.05, 0.0)
    scene = cell(pick, bodies=(part,), robot=arm(bare=True), tool=CUP, clearance=Clearance(0.0, 0.0))
    search = Search(scene, Prover(scene), 0.0)
    partial = initial(scene)
    tried = search._sampler(partial).options
    met = [each for turn in yaw_offsets(scene, pick) or () for each in prepared(scene, partial, turn, None, (0, 1))]
    every = options(scene, partial, [each for each in met if isinstance(each, Meetings)])
    assert {option.meeting.point.yaw_offset for option in tried} < {option.meeting.point.yaw_offset for option in every}
    assert len({option.meeting.point.yaw_offset for option in every}) == 60
    bound = least_duration(scene)
    assert bound is not None
    least = min(option.least for option in every) + pick.dwell_s
    assert 0.9 * least < bound <= least


def test_blended_motion_leaves_the_wrist_as_it_is_too() -> None:
    scene = cell(free(0.35, -0.2, "a"), free(0.2, 0.4, "b"), elbow="keep", timing="parabolic_blend")
    assert np.abs(wrist(scene) - scene.start.q[-1]).max() < 1e-6
