"""Another robot in the cell: its links are frames that move as its trajectory says, its bodies bodies of the cell."""

from __future__ import annotations

import copy
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from assur.scenes.requests import check_document, load_scenario, plan_document, request_digest, scene_of
from tests.refused import refused_at
from tests.scenes.bad_requests import GOOD_REQUEST


def with_neighbour(**changes: Any) -> dict[str, Any]:
    """A cell with a Fanuc 800 mm away, turned by 180 degrees, whose lift counts downwards."""
    request = copy.deepcopy(GOOD_REQUEST)
    rest = [[0.0] * 4] * 2
    neighbour = {
        "name": "other",
        "robot": {
            "model": "fanuc-sr-3ia",
            "base": {"at_mm": [800, 0, 0], "yaw_deg": 180},
            "tool": {
                "tcp_mm": [0, 0, -50],
                "bodies": [
                    {"name": "cup", "shape": {"cylinder": {"radius_mm": 10, "height_mm": 50}}, "at_mm": [0, 0, -25]}
                ],
            },
        },
        "trajectory": {
            "joint_names": ["j1", "j2", "j3", "j4"],
            "joint_units": ["rad", "rad", "m", "rad"],
            "time_s": [1.0, 2.0],
            "position": [[0.0, 0.0, 0.0, 0.0], [math.pi / 2, 0.0, 0.1, 0.0]],
            "velocity": rest,
            "acceleration": rest,
        },
    }
    neighbour.update(changes)
    request["neighbours"] = [neighbour]
    return request


def test_its_links_are_frames_and_its_bodies_ride_on_them() -> None:
    scene = scene_of(with_neighbour())
    names = {"other/base", "other/link1", "other/link2", "other/quill", "other/flange"}
    assert names <= set(scene.frames)
    rides = {body.name: body.frame for body in scene.bodies if body.name.startswith("other/")}
    assert rides == {
        "other/base-column": "other/base",
        "other/link-1": "other/link1",
        "other/link-2": "other/link2",
        "other/shaft": "other/quill",
        "other/cup": "other/flange",
    }


def test_its_flange_moves_as_its_trajectory_says_and_stands_still_around_it() -> None:
    law = scene_of(with_neighbour()).frames["other/flange"].law
    reach, top = 0.4, 0.25
    before, after = law.motion(np.array([0.0, 1.0])), law.motion(np.array([2.0, 50.0]))
    np.testing.assert_allclose(before.p, [[0.8 - reach, 0.0, top]] * 2, atol=1e-12)
    np.testing.assert_allclose(after.p, [[0.8, -reach, top - 0.1]] * 2, atol=1e-12)
    middle = law.motion(np.array(1.5))  # half way, by the symmetry of a quintic from rest to rest
    angle = math.pi + math.pi / 4
    np.testing.assert_allclose(
        middle.p, [0.8 + reach * math.cos(angle), reach * math.sin(angle), top - 0.05], atol=1e-12
    )
    assert np.linalg.norm(middle.v) > 0.1


def test_a_task_may_name_its_frames_and_bodies() -> None:
    request = with_neighbour()
    request["task"] = [{"move": {"to": {"frame": "other/flange", "at_mm": [0, 0, -200]}}}]
    assert getattr(scene_of(request).task[0], "target").frame == "other/flange"  # noqa: B009
    request["task"] = [{"move": {"to": {"body": "other/cup", "at_mm": [0, 0, -200]}}}]
    assert getattr(scene_of(request).task[0], "target").frame == "other/flange"  # noqa: B009


def test_two_neighbours_need_two_names() -> None:
    request = with_neighbour()
    request["neighbours"].append(copy.deepcopy(request["neighbours"][0]))
    with refused_at("neighbours[1].name"):
        scene_of(request)
    request["neighbours"][1]["name"] = "third"
    assert len(scene_of(request).bodies) == len(GOOD_REQUEST["bodies"]) + 10


def by_file(folder: Path, document: Any, **beside: Any) -> dict[str, Any]:
    """The same cell, with the neighbour's trajectory in the answer in a file."""
    request = with_neighbour(**beside)
    del request["neighbours"][0]["trajectory"]
    request["neighbours"][0]["plan"] = {"file": "plans/other.json"}
    (folder / "plans").mkdir(exist_ok=True)
    text = document if isinstance(document, str) else json.dumps(document)
    (folder / "plans" / "other.json").write_text(text)
    return request


def planned(trajectory: Any) -> dict[str, Any]:
    """As much of an answer as is read."""
    return {"schema": "assur/1", "status": "planned", "duration_s": 1.0, "trajectory": trajectory}


KNOTS: Any = with_neighbour()["neighbours"][0]["trajectory"]


def test_a_neighbour_is_given_by_the_file_of_its_plan(tmp_path: Path) -> None:
    request = by_file(tmp_path, planned(KNOTS))
    inline, scene = scene_of(with_neighbour()), scene_of(request, folder=tmp_path)
    assert scene.digest == inline.digest
    t = np.linspace(0.0, 3.0, 31)
    for name in ("other/link1", "other/flange"):
        np.testing.assert_array_equal(scene.frames[name].law.motion(t).p, inline.frames[name].law.motion(t).p)


def test_the_plan_of_one_robot_is_an_obstacle_in_the_plan_of_the_next(tmp_path: Path) -> None:
    """As `assur plan --out` writes it, with the whole certificate, and a scenario file that names it."""
    alone = {**with_neighbour(), "frames": {}, "bodies": [], "neighbours": []}
    alone["task"] = [{"move": {"to": {"at_mm": [350, 0, 120]}}}]
    first = plan_document(alone)
    request = {**alone, "start": {"joints": {"j1_deg": 0, "j2_deg": 60, "j3_mm": 300, "j4_deg": 0}}}
    request["robot"] = {**alone["robot"], "base": {"at_mm": [1150, 0, 0], "yaw_deg": 180}}
    request["task"] = [{"move": {"to": {"at_mm": [800, 100, 120]}}}]
    request["neighbours"] = [{"name": "other", "robot": alone["robot"], "plan": {"file": "first.json"}}]
    (tmp_path / "first.json").write_text(json.dumps(first))
    (tmp_path / "cell.yaml").write_text(json.dumps({"about": "two robots", "request": request}))
    scenario = load_scenario(tmp_path / "cell.yaml")
    second = plan_document(scenario.request, folder=scenario.folder)
    assert second["status"] == "planned"
    assert any(name.startswith("other/") for name in second["certificate"]["names"])
    assert check_document(scenario.request, second, folder=scenario.folder)["ok"]
    # another plan in the file is another request, for which this one is no proof
    late = {**first, "trajectory": {**first["trajectory"], "time_s": [t + 1 for t in first["trajectory"]["time_s"]]}}
    (tmp_path / "first.json").write_text(json.dumps(late))
    found = check_document(scenario.request, second, folder=scenario.folder)["findings"]
    assert "DIGEST" in {finding["code"] for finding in found}


def test_a_neighbour_starts_when_it_is_said(tmp_path: Path) -> None:
    knots = {**KNOTS, "time_s": [41.5, 42.5]}
    request = by_file(tmp_path, planned(knots), starts_at_s=1.0)
    shifted, inline = scene_of(request, folder=tmp_path), scene_of(with_neighbour())
    t = np.linspace(0.0, 3.0, 31)
    np.testing.assert_allclose(
        shifted.frames["other/flange"].law.motion(t).p, inline.frames["other/flange"].law.motion(t).p, atol=1e-12
    )
    assert request_digest(with_neighbour(starts_at_s=2.0)) != request_digest(with_neighbour())
    early = scene_of(with_neighbour(starts_at_ms=-500)).frames["other/flange"].law
    np.testing.assert_allclose(early.motion(np.array([-0.5, 0.5])).p, [[0.4, 0, 0.25], [0.8, -0.4, 0.15]], atol=1e-12)


@pytest.mark.parametrize("key", ["start_uncertainty_s", "start_uncertainty_ms"])
def test_an_uncertain_start_shifts_the_whole_motion_either_way(key: str) -> None:
    amount = 0.05 if key.endswith("_s") and not key.endswith("_ms") else 50
    assert scene_of(with_neighbour(**{key: amount})).frames["other/flange"].uncertainty.shift_s == (-0.05, 0.05)
    assert scene_of(with_neighbour(**{key: 0.0})).frames["other/flange"].uncertainty.shift_s == (0.0, 0.0)
    for wrong in (-0.1, math.nan, "soon"):
        with refused_at(f"neighbours[0].{key}"):
            scene_of(with_neighbour(**{key: wrong}))


@pytest.mark.parametrize(
    ("document", "said"),
    [
        ("{", "other.json: got 'a text that ends before its value is complete"),
        ([], "status: got nothing; allowed: planned"),
        ({"status": "not_planned"}, "status: got 'not_planned'; allowed: planned"),
        ({"status": "planned"}, "trajectory: got nothing"),
        (planned([]), "trajectory: got []"),
        (planned({**KNOTS, "time_s": [1.0, "two"]}), "trajectory.time_s[1]: got 'two'; allowed: a number"),
        (planned({**KNOTS, "extra": 1}), "trajectory.extra: got 1"),
        ('{"status": "planned", "trajectory": {"time_s": [0.0, NaN]}}', "trajectory.time_s[1]: got"),
    ],
)
def test_a_file_that_holds_no_plan_is_told_by_its_name(tmp_path: Path, document: Any, said: str) -> None:
    with refused_at(
        "neighbours[0].plan.file",
        f"a file with a planned answer, as assur plan --out writes it; in this one {said}",
        value="plans/other.json",
    ):
        scene_of(by_file(tmp_path, document), folder=tmp_path)


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"plan": {"file": "plans/other.json"}}, "neighbours[0].plan"),
        ({"plan": "plans/other.json", "trajectory": None}, "neighbours[0].plan"),
        ({"plan": {"file": "plans/other.json", "time": 1}, "trajectory": None}, "neighbours[0].plan.time"),
        ({"plan": {}, "trajectory": None}, "neighbours[0].plan.file"),
        ({"plan": {"file": 7}, "trajectory": None}, "neighbours[0].plan.file"),
        ({"trajectory": None}, "neighbours[0]"),
        ({"starts_at_s": math.inf}, "neighbours[0].starts_at_s"),
    ],
)
def test_a_neighbour_has_either_a_trajectory_or_a_plan(tmp_path: Path, change: dict[str, Any], field: str) -> None:
    by_file(tmp_path, planned(KNOTS))
    request = with_neighbour(**change)
    if change.get("trajectory", 0) is None:
        del request["neighbours"][0]["trajectory"]
    with refused_at(field):
        scene_of(request, folder=tmp_path)
