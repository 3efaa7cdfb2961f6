"""What is enclosed by meshes is asked block by block: within the budget, and by the checker for as long as its caller
has time."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.checked import check
from assur.planner.collision import nearest
from assur.planner.collision.nearest import enclosed
from assur.planner.collision.proof import Prover
from assur.planner.frames.motion import Pose
from assur.planner.geometry import containment
from assur.planner.geometry.containment import inside, winding_number
from assur.planner.model.claims import NOTHING
from assur.planner.model.deadline import Deadline, OutOfTimeError
from assur.planner.model.outcome import Plan, Planned
from assur.planner.model.phases import at_start
from assur.planner.model.scene import Scene
from assur.planner.pipeline import plan
from assur.planner.search import census
from tests.planner.cells import Around, cell, go, mesh_box

POINTS = np.array([[0.0, 0.0, 0.0], [0.2, 0.0, 0.0], [0.04, 0.03, -0.01]])


def among_meshes(many: int = 12) -> Scene:
    """One move beside hollow boxes, around nothing."""
    boxes = [Around(mesh_box(f"m{i}", 0.05, 0.05, 0.05), "world", Pose(-0.4, 0.2 + 0.06 * i, 0.1)) for i in range(many)]
    return cell(go(0.33, -0.25), bodies=tuple(boxes), stop="first")


class Counted:
    """Counts calls, and ends the work at one of them."""

    def __init__(self, last: int | None = None) -> None:
        self.calls, self.last = 0, last

    def __call__(self) -> None:
        self.calls += 1
        if self.calls == self.last:
            raise OutOfTimeError


@pytest.fixture
def surface() -> tuple[FloatArray, IntArray]:
    found = mesh_box("box", 0.1, 0.08, 0.06).surface
    assert found is not None
    return found


def test_a_winding_number_is_left_between_blocks_of_triangles(
    surface: tuple[FloatArray, IntArray], monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = winding_number(surface, POINTS)
    assert whole == pytest.approx([1.0, 0.0, 1.0], abs=1e-9)
    monkeypatch.setattr(containment, "BLOCK", 2 * len(POINTS))
    between = Counted()
    assert winding_number(surface, POINTS, between) == pytest.approx(whole, abs=1e-12)
    assert between.calls == len(surface[1]) / 2
    with pytest.raises(OutOfTimeError):
        inside(surface, POINTS, Counted(last=3))


def test_meshes_around_the_arm_are_asked_until_the_deadline_passes() -> None:
    scene = among_meshes()
    prover = Prover(scene)

    def ask() -> object:
        return enclosed(scene, prover, at_start(scene), scene.start.q, 0.0, frozenset())

    assert ask() is None
    with Deadline(time.perf_counter(), -1.0), pytest.raises(OutOfTimeError):
        ask()


def test_a_mesh_that_may_be_around_the_arm_is_left_between_blocks_of_its_triangles(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    around = Around(mesh_box("hall", 3.0, 3.0, 3.0), "world", Pose())
    scene = replace(among_meshes(1), bodies=(around,))
    looks = Counted()
    monkeypatch.setattr(containment, "BLOCK", 1)
    monkeypatch.setattr(nearest, "raise_if_late", looks)
    assert enclosed(scene, Prover(scene), at_start(scene), scene.start.q, 0.0, frozenset())
    assert looks.calls > 10


def test_the_box_round_a_mesh_of_many_bodies_is_found_once() -> None:
    prover = Prover(among_meshes())
    vertices = np.random.default_rng(0).random((9, 3))
    low, high = prover.box(vertices)
    assert np.array_equal([low, high], [vertices.min(0), vertices.max(0)])
    assert prover.box(vertices)[0] is low


@pytest.fixture(scope="module")
def planned() -> tuple[Scene, Plan]:
    scene = among_meshes()
    outcome = plan(scene)
    assert isinstance(outcome, Planned)
    return scene, outcome.plan


def test_the_checker_calls_between_its_blocks_and_each_call_may_end_it(planned: tuple[Scene, Plan]) -> None:
    scene, made = planned
    between = Counted()
    assert check(scene, made, NOTHING, between).ok
    assert between.calls == PARTS
    for last in range(1, between.calls + 1):
        with pytest.raises(OutOfTimeError):
            check(scene, made, NOTHING, Counted(last))


PARTS = 3
"""Calls of a check between its parts: legs, claim, what is shown, what is required."""


def test_a_plan_that_the_checker_has_no_time_for_is_not_given_out(
    planned: tuple[Scene, Plan], monkeypatch: pytest.MonkeyPatch
) -> None:
    scene, _ = planned
    own: Callable[..., object] = check

    def late(*asked: object, **how: object) -> object:
        with Deadline(time.perf_counter(), -1.0):
            return own(*asked, **how)

    monkeypatch.setattr(census, "check", late)
    outcome = plan(replace(scene, options=replace(scene.options, max_candidates=3)))
    assert not isinstance(outcome, Planned)
    assert outcome.cut_by_clock
    assert outcome.reason == "TIMED_OUT"
    assert not outcome.proved
