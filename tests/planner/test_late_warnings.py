"""Warnings cost what is left of the budget, and a little: each body is posed once, and what is late is left out."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from assur.planner import pipeline
from assur.planner.collision.fcl_entry import PlacedShape
from assur.planner.collision.proof import Prover
from assur.planner.feasibility.hits import AtStart, touch
from assur.planner.feasibility.input_warnings import MOST_OVERLAPS, smallest_extent, unusual_bodies, unusual_places
from assur.planner.geometry.shapes import box
from assur.planner.model.deadline import Deadline, OutOfTimeError
from assur.planner.model.input_warning import Odd
from assur.planner.model.outcome import NotPlanned, Planned
from assur.planner.model.scene import Place, Scene
from assur.planner.pipeline import plan
from tests.planner.cells import CUP, cell, go, stands, table_to_table

MANY = 40


def heap(apart: float = 0.0, **changes: Any) -> Scene:
    """`table_to_table`, with many boxes where its part is, each so much further along y, m."""
    scene = table_to_table(**changes)
    part = scene.index["part"]
    around = [stands(f"box-{i}", box(0.03, 0.03, 0.03), 0.0, 0.0, 0.0) for i in range(MANY)]
    places = [replace(part.pose, y=part.pose.y + (i + 1) * apart) for i in range(MANY)]
    boxes = tuple(replace(each, frame=part.frame, pose=at) for each, at in zip(around, places, strict=True))
    return replace(scene, bodies=(*scene.bodies, *boxes))


def started(scene: Scene) -> AtStart:
    return AtStart(scene, Prover(scene))


def passed() -> Deadline:
    return Deadline(time.perf_counter(), -1.0)


@pytest.fixture
def posed(monkeypatch: pytest.MonkeyPatch) -> Counter[str]:
    """How often each body was posed."""
    count, own = Counter[str](), Prover.posed

    def counted(*asked: Any) -> list[PlacedShape]:
        made = own(*asked)
        count.update({each.name for each in made})
        return made

    monkeypatch.setattr(Prover, "posed", counted)
    return count


def test_each_body_is_posed_once_in_each_of_its_places_for_all_warnings(posed: Counter[str]) -> None:
    scene = heap(apart=2e-3)
    at = started(scene)
    unusual_bodies(scene, at)
    unusual_places(scene, at)
    counts = {name: count for name, count in posed.items() if name in scene.index}
    assert counts.pop("part") == 2  # where it is picked, and where it is put down
    assert set(counts.values()) == {1}


def test_bodies_that_cannot_touch_are_not_posed(posed: Counter[str]) -> None:
    scene = heap(apart=0.2)
    warnings = unusual_places(scene, started(scene))
    assert [each for each in warnings if each.kind is Odd.BODIES_OVERLAP] == []
    assert not [name for name in posed if name.startswith("box-")]


def test_overlaps_beyond_those_that_are_told_are_not_looked_for(posed: Counter[str]) -> None:
    scene = heap()
    warnings = unusual_places(scene, started(scene))
    overlaps = [each.bodies for each in warnings if each.kind is Odd.BODIES_OVERLAP]
    assert overlaps == [("part", f"box-{i}") for i in range(MOST_OVERLAPS)]
    assert len([name for name in posed if name.startswith("box-")]) == MOST_OVERLAPS


def _touching(scene: Scene) -> object:
    at = started(scene)
    return touch(at.prover, at.shapes("part"), at.shapes("box-0"))


MOVE = cell(go(0.33, -0.25), tool=CUP)
WORK: dict[str, Callable[[Scene], object]] = {
    "touch": _touching,
    "places of bodies": lambda scene: started(scene).near("part", -1.0, 1.0),
    "steps": lambda _: unusual_places(MOVE, started(MOVE)),
    "widths": lambda scene: smallest_extent(scene.index["part"].body),
}


@pytest.mark.parametrize("name", sorted(WORK))
def test_work_for_warnings_ends_where_the_deadline_has_passed(name: str) -> None:
    scene = heap()
    WORK[name](scene)
    with passed(), pytest.raises(OutOfTimeError):
        WORK[name](scene)


def in_the_air() -> Scene:
    """`table_to_table`, with the part put down 10 mm above its table."""
    scene = table_to_table(stop="first")
    pick, place = scene.task
    assert isinstance(place, Place)
    pose = place.to.pose
    there = replace(place.to, pose=replace(pose, z=pose.z + 0.01))
    return replace(scene, task=(pick, replace(place, to=there)))


@pytest.mark.parametrize(("scene_of", "kind"), [(heap, NotPlanned), (in_the_air, Planned)])
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
