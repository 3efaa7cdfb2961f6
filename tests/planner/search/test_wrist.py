"""The wrist turns no further than it has to: of options of the same duration the one that turns it least."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from assur.planner.model.outcome import Planned
from assur.planner.model.scene import Scene, Step
from assur.planner.pipeline import plan
from tests.planner.cells import at, belt_and_dial, cell, go


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
