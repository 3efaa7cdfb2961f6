"""Another robot in the cell: its links are frames that move as its trajectory says, its bodies bodies of the cell."""

from __future__ import annotations

import copy
import math
from typing import Any

import numpy as np
import pytest

from assur.planner.errors import InputError
from assur.scenes.requests import scene_of
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
    with pytest.raises(InputError) as caught:
        scene_of(request)
    assert caught.value.field == "neighbours[1].name"
    request["neighbours"][1]["name"] = "third"
    assert len(scene_of(request).bodies) == len(GOOD_REQUEST["bodies"]) + 10
