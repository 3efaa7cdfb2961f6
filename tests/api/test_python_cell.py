"""`assur.Cell`: a cell is read once and planned many times, with the answers of `assur.plan`."""

from __future__ import annotations

import copy
import json
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

import assur
from assur.api.workers.jobs import FIRST_PLAN
from assur.scenes.reading import bodies
from assur.scenes.reading import cell as reading
from assur.scenes.requests import cell_of

TIMES = ("elapsed_s", "first_s")


@pytest.fixture
def request_() -> dict[str, Any]:
    document = copy.deepcopy(FIRST_PLAN)
    document["bodies"] = [
        {"name": "table", "shape": {"box": {"size_mm": [300, 300, 40]}}, "pose": {"at_mm": [400, 300, -30]}},
        {"name": "post", "shape": {"cylinder": {"radius_mm": 20, "height_mm": 300}}, "pose": {"at_mm": [0, -450, 150]}},
    ]
    document["options"] = {**document.get("options", {}), "stop": "first", "max_candidates": 200, "budget_s": 60}
    return document


def timeless(answer: Any) -> dict[str, Any]:
    return {key: value for key, value in answer.items() if key not in TIMES}


STARTS = (
    {"j1_deg": 10, "j2_deg": 60, "j3_mm": 200, "j4_deg": 0},
    {"j1_deg": -20, "j2_deg": 80, "j3_mm": 240, "j4_deg": 30},
)
TASKS = ([{"move": {"to": {"at_mm": [400, 250, 160]}}}], [{"move": {"to": {"at_mm": [380, -150, 150]}}}])


def test_a_kept_cell_answers_as_a_new_one(request_: dict[str, Any]) -> None:
    cell = assur.Cell(request_)
    for start in STARTS:
        for task in TASKS:
            kept = cell.plan(start={"joints": start}, task=task, set={"options.seed": 2})
            new = assur.plan(cell.request(start={"joints": start}, task=task, set={"options.seed": 2}))
            assert timeless(kept) == timeless(new)
            assert kept.planned
            assert kept.request is not None
            assert kept.request["start"] == {"joints": start}
            assert assur.check(kept.request, kept)["ok"]
    assert timeless(cell.plan()) == timeless(assur.plan(request_))


def test_a_cell_and_its_bodies_are_read_once(request_: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    made, solid = list[str](), bodies.solid

    def counted(name: str, shape: Any) -> Any:
        made.append(name)
        return solid(name, shape)

    reading._kept.clear()
    monkeypatch.setattr(bodies, "solid", counted)
    cell = assur.Cell(request_)
    for start in STARTS:
        cell.plan(start={"joints": start})
    assert made == ["table", "post"]
    # what is written in another unit, or in another order of the frames, means the same
    request_["bodies"][0]["pose"] = {"at_m": [0.4, 0.3, -0.03]}
    one, other = cell_of(request_), cell_of(request_)
    assert made == ["table", "post"]
    assert one.scene.bodies is other.scene.bodies
    assert one.scene.kept is other.scene.kept
    # another place is another cell
    moved = cell.plan(set={"bodies.table.pose.at_mm": [400, 300, -60]})
    assert made == ["table", "post"] * 2
    assert moved["request_digest"] != cell.plan()["request_digest"]
    # a body that the gripper holds has no pose, so that what is held decides what is kept
    held = copy.deepcopy(request_)
    held["bodies"][1] = {"name": "post", "shape": {"box": {"size_mm": [20, 20, 20]}}}
    held["start"]["holding"] = {"part": "post", "grasp_mm": [0, 0, 10]}
    assert cell_of(held).scene.bodies is not one.scene.bodies


def test_a_cell_with_a_fault_is_not_kept(request_: dict[str, Any]) -> None:
    request_["bodies"].append(copy.deepcopy(request_["bodies"][0]))
    before = len(reading._kept)
    for _ in range(2):
        with pytest.raises(assur.InputError, match=r"bodies\[2\]\.name"):
            cell_of(request_)
    assert len(reading._kept) == before


def test_no_more_cells_are_kept_than_is_said(request_: dict[str, Any]) -> None:
    first = cell_of(request_).scene
    for number in range(reading.MOST_CELLS):
        assert cell_of(request_).scene.bodies is first.bodies
        other = copy.deepcopy(request_)
        other["bodies"][0]["pose"]["at_mm"][0] = 401 + number
        cell_of(other)
    assert len(reading._kept) <= reading.MOST_CELLS
    for number in range(reading.MOST_CELLS):
        other["bodies"][0]["pose"]["at_mm"][0] = 501 + number
        cell_of(other)
    assert cell_of(request_).scene.bodies is not first.bodies


def test_triangles_of_kept_cells_are_bounded(request_: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    request = assur.load("inside-a-mesh")
    many = sum(len(body.body.surface[1]) for body in cell_of(request).scene.bodies if body.body.surface is not None)
    assert many > 0
    reading._kept.clear()
    monkeypatch.setattr(reading, "MOST_TRIANGLES", many)
    small, first = cell_of(request_).scene, cell_of(request).scene
    assert cell_of(request).scene.bodies is first.bodies
    assert cell_of(request_).scene.bodies is small.bodies
    request["bodies"].append({**request_["bodies"][0], "name": "another"})
    cell_of(request)
    assert [each.bodies is first.bodies for each in reading._kept.values()].count(True) == 0
    monkeypatch.setattr(reading, "MOST_TRIANGLES", many - 1)
    reading._kept.clear()
    cell_of(request)
    assert not reading._kept


def test_threads_may_plan_with_one_cell(request_: dict[str, Any]) -> None:
    cell = assur.Cell(request_)
    every = [({"joints": start}, task) for start in STARTS for task in TASKS] * 3
    expected = [timeless(assur.plan(cell.request(start=start, task=task))) for start, task in every[:4]] * 3
    with ThreadPoolExecutor(4) as pool:
        answers = list(pool.map(lambda each: cell.plan(start=each[0], task=each[1]), every))
    assert [timeless(answer) for answer in answers] == expected


def test_numbers_of_numpy_and_what_is_built_count_as_plain_values(request_: dict[str, Any]) -> None:
    cell = assur.Cell(request_)
    start = assur.request.Start(joints=assur.request.Joints(**STARTS[0]))
    built = cell.plan(start=start, set={"task.0.move.to.at_mm": np.array([400, 250, 160])})
    assert timeless(built) == timeless(cell.plan(start={"joints": STARTS[0]}, task=TASKS[0])) | {
        "request_digest": built["request_digest"]
    }
    assert json.loads(json.dumps(built.request)) == built.request


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"start": {"joints": {"j1_deg": 10}}}, r"start\.joints\.j2"),
        ({"start": {"joints": STARTS[0], "velocty": {}}}, r"start\.velocty"),
        ({"task": []}, "task"),
        ({"task": [{"move": {"to": {"frame": "belt", "at_mm": [0, 0, 0]}}}]}, r"task\[0\]\.move\.to\.frame"),
        ({"set": {"options.sed": 1}}, r"options\.sed.*did you mean seed"),
        ({"set": {"options.seed": float("nan")}}, r"options\.seed"),
        ({"set": {"bodies.tabel": {}}}, "did you mean table"),
        ({"set": {"frame": {}}}, "frame"),
        ({"set": 3}, "set: got 3"),
        ({"certificate": "half"}, "certificate: got 'half'; allowed: full or digest"),
    ],
)
def test_a_change_that_is_wrong_is_refused_by_its_field(
    request_: dict[str, Any], changes: dict[str, Any], message: str
) -> None:
    cell = assur.Cell(request_)
    with pytest.raises(assur.InputError, match=message):
        cell.plan(**changes)
    assert cell.plan().planned


@pytest.mark.parametrize(
    "changes",
    [
        {"bodies.post.pose.at_mm": [30, -480, 150]},
        {"frames": {"nest": {"fixed": {"at_mm": [0, 0, 0]}}}},
        {"robot.tool.tcp_mm": [0, 0, -5], "options.seed": 4},
        {"neighbours": []},
    ],
)
def test_what_stands_around_may_change_as_well(request_: dict[str, Any], changes: dict[str, Any]) -> None:
    cell = assur.Cell(request_)
    before = timeless(cell.plan())
    changed = cell.plan(set=changes)
    assert timeless(changed) == timeless(assur.plan(cell.request(set=changes)))
    assert timeless(cell.plan()) == before


def test_a_cell_keeps_its_surroundings_itself(request_: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    cell = assur.Cell(request_)
    before = timeless(cell.plan())
    reading._kept.clear()  # as other cells would, which were read since

    def anew(*_: Any) -> Any:
        raise AssertionError("the surroundings are made again")

    monkeypatch.setattr(reading, "_surroundings", anew)
    assert timeless(cell.plan()) == before
    with pytest.raises(AssertionError, match="made again"):
        cell.plan(set={"bodies.table.pose.at_mm": [400, 300, -60]})
