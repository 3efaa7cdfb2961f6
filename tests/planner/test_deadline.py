"""The deadline in force is the innermost one, work of every kind ends where it has passed, and what is late is left out
of the answer."""

from __future__ import annotations

import copy
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from assur.planner import pipeline
from assur.planner.arrays import FloatArray, IntArray
from assur.planner.checked import check
from assur.planner.collision import nearest
from assur.planner.collision.nearest import enclosed
from assur.planner.collision.proof import Prover
from assur.planner.feasibility.hits import AtStart, touch
from assur.planner.feasibility.input_warnings import smallest_extent, unusual_places
from assur.planner.frames.motion import Pose
from assur.planner.geometry import containment
from assur.planner.geometry.containment import inside, winding_number
from assur.planner.model.attachments import at_start
from assur.planner.model.claims import NOTHING
from assur.planner.model.deadline import Deadline, OutOfTimeError, out_of_time, raise_if_late
from assur.planner.model.outcome import NotPlanned, Plan, Planned
from assur.planner.model.scene import Scene
from assur.planner.pipeline import plan
from assur.planner.search import census
from assur.scenes.reading.cell import cell_of
from assur.scenes.requests import plan_document, shipped, validate
from tests.planner.cells import CUP, Around, cell, go, mesh_box
from tests.planner.test_input_warnings import heap, placed
from tests.planner.test_paths import zigzag
from tests.scenes.test_budgets import ARM


def passed() -> Deadline:
    return Deadline(time.perf_counter(), -1.0)


def test_no_deadline_is_in_force_outside() -> None:
    assert not out_of_time()
    raise_if_late()


def test_the_innermost_deadline_counts_and_the_one_before_it_is_in_force_again() -> None:
    now = time.perf_counter()
    with passed():
        with Deadline(now, 1e6):
            assert not out_of_time()
        assert out_of_time()
    with pytest.raises(KeyError), passed():
        raise KeyError
    assert not out_of_time()


def among_meshes(many: int = 12) -> Scene:
    """One move beside hollow boxes, around nothing."""
    boxes = [Around(mesh_box(f"m{i}", 0.05, 0.05, 0.05), "world", Pose(-0.4, 0.2 + 0.06 * i, 0.1)) for i in range(many)]
    return cell(go(0.33, -0.25), bodies=tuple(boxes), stop="first")


def points_of_a_move() -> Callable[[], object]:
    """A request whose one step goes along a path from where the arm stands is read."""
    move = {"to": {"at_mm": [350, 100, 250], "yaw_deg": 0}, "leg": "cartesian", "path": [{"line": {}}]}
    document: dict[str, Any] = {**copy.deepcopy(ARM), "bodies": [], "task": [{"move": move}]}
    request = validate(document)
    return lambda: cell_of(document, request)


def meshes_around_the_arm() -> Callable[[], object]:
    scene = among_meshes()
    prover = Prover(scene)
    return lambda: enclosed(scene, prover, at_start(scene), scene.start.q, 0.0, frozenset())


def started(scene: Scene) -> AtStart:
    return AtStart(scene, Prover(scene))


def bodies_that_touch() -> Callable[[], object]:
    scene = heap()
    at = started(scene)
    return lambda: touch(at.prover, at.shapes("part"), at.shapes("box-0"))


def widths() -> Callable[[], object]:
    scene = heap()
    return lambda: smallest_extent(scene.index["part"].body)


def places_of_bodies() -> Callable[[], object]:
    scene = heap()
    return lambda: started(scene).near("part", -1.0, 1.0)


def warnings_about_steps() -> Callable[[], object]:
    scene = cell(go(0.33, -0.25), tool=CUP)
    return lambda: unusual_places(scene, started(scene))


def asking_a_path() -> Callable[[], object]:
    made = zigzag().curve
    return lambda: made.at(np.zeros(1))


WORK: dict[str, Callable[[], Callable[[], object]]] = {
    "looking at the clock": lambda: raise_if_late,
    "making a path": lambda: zigzag,
    "asking a path": asking_a_path,
    "reading a path": points_of_a_move,
    "meshes around the arm": meshes_around_the_arm,
    "bodies that touch": bodies_that_touch,
    "places of bodies": places_of_bodies,
    "warnings about steps": warnings_about_steps,
    "widths of bodies": widths,
}
"""What is worked on, made ready before the deadline."""


@pytest.mark.parametrize("name", WORK)
def test_work_ends_where_the_deadline_has_passed(name: str) -> None:
    work = WORK[name]()
    work()
    work = WORK[name]()  # nothing is kept from before
    with passed(), pytest.raises(OutOfTimeError):
        work()


class Counted:
    """Counts calls, and ends the work at one of them."""

    def __init__(self, last: int | None = None) -> None:
        self.calls, self.last = 0, last

    def __call__(self) -> None:
        self.calls += 1
        if self.calls == self.last:
            raise OutOfTimeError


def test_a_winding_number_is_left_between_blocks_of_triangles(monkeypatch: pytest.MonkeyPatch) -> None:
    surface: tuple[FloatArray, IntArray] | None = mesh_box("box", 0.1, 0.08, 0.06).surface
    assert surface is not None
    points = np.array([[0.0, 0.0, 0.0], [0.2, 0.0, 0.0], [0.04, 0.03, -0.01]])
    whole = winding_number(surface, points)
    assert whole == pytest.approx([1.0, 0.0, 1.0], abs=1e-9)
    monkeypatch.setattr(containment, "BLOCK", 2 * len(points))
    between = Counted()
    assert winding_number(surface, points, between) == pytest.approx(whole, abs=1e-12)
    assert between.calls == len(surface[1]) / 2
    with pytest.raises(OutOfTimeError):
        inside(surface, points, Counted(last=3))


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


@pytest.fixture(scope="module")
def planned() -> tuple[Scene, Plan]:
    scene = among_meshes()
    outcome = plan(scene)
    assert isinstance(outcome, Planned)
    return scene, outcome.plan


PARTS = 3
"""Calls of a check between its parts: legs, claim, what is shown, what is required."""


def test_the_checker_calls_between_its_parts_and_each_call_may_end_it(planned: tuple[Scene, Plan]) -> None:
    scene, made = planned
    between = Counted()
    assert check(scene, made, NOTHING, between).ok
    assert between.calls == PARTS
    for last in range(1, between.calls + 1):
        with pytest.raises(OutOfTimeError):
            check(scene, made, NOTHING, Counted(last))


def test_a_plan_that_the_checker_has_no_time_for_is_not_given_out(
    planned: tuple[Scene, Plan], monkeypatch: pytest.MonkeyPatch
) -> None:
    scene, _ = planned
    own: Callable[..., object] = check

    def late(*asked: object, between: Callable[[], None]) -> object:
        with passed():
            return own(*asked, between=between)

    monkeypatch.setattr(census, "check", late)
    outcome = plan(replace(scene, options=replace(scene.options, max_candidates=3)))
    assert not isinstance(outcome, Planned)
    assert outcome.cut_by_clock
    assert outcome.reason == "TIMED_OUT"
    assert not outcome.proved


@pytest.mark.parametrize(("scene_of", "kind"), [(heap, NotPlanned), (lambda: placed(0.01), Planned)])
def test_warnings_that_are_late_are_left_out_and_the_answer_says_so(
    scene_of: Callable[[], Scene], kind: type, monkeypatch: pytest.MonkeyPatch
) -> None:
    told = plan(scene_of())
    assert isinstance(told, kind)
    assert told.warnings
    assert not told.cut_by_clock
    monkeypatch.setattr(pipeline, "MARGINS_S", -1e6)
    late = plan(scene_of())
    assert isinstance(late, kind)
    assert (late.warnings, late.cut_by_clock) == ((), True)
    if isinstance(told, NotPlanned) and isinstance(late, NotPlanned):
        assert (late.reason, late.sentence, late.proved) == (told.reason, told.sentence, told.proved)


def test_a_request_whose_budget_ends_while_its_cell_is_built_is_answered() -> None:
    request = dict(shipped("demo").request)
    # no other test has read this cell: one that has been read is kept, and is not built again
    last = {"name": "last", "shape": {"box": {"size_mm": [10, 10, 10]}}, "pose": {"at_mm": [0, -900, 5]}}
    request |= {"bodies": [*request["bodies"], last], "options": {"budget_s": 0.5, "seed": 7}}
    answer = plan_document(request, folder=shipped("demo").folder, started=time.perf_counter() - 1.0)
    assert (answer["status"], answer["reason"], answer["proved"]) == ("not_planned", "TIMED_OUT", False)
    assert "before the cell was built" in answer["sentence"]
    assert answer["cut_by_clock"] is True
    assert answer["seed"] == 7
    assert answer["elapsed_s"] >= 1.0
