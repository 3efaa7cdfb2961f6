"""What a pose means that states less than all of its numbers."""

from __future__ import annotations

import copy
from typing import Any

import pytest

from assur.planner.errors import InputError
from assur.scenes.requests import request_digest, scene_of
from tests.scenes.bad_requests import GOOD_REQUEST

ORIGIN_MM = {"at_mm": [0, 0, 0]}


def changed(where: str, pose: dict[str, Any]) -> dict[str, Any]:
    """The good request with this pose at one of its places."""
    request = copy.deepcopy(GOOD_REQUEST)
    if where == "frame":
        request["frames"]["dial"]["turntable"] = {"rate_deg_s": 60, **pose}
    elif where == "base":
        request["robot"]["base"] = pose
    elif where == "tool body":
        request["robot"]["tool"]["bodies"] = [{"name": "cup", "shape": {"sphere": {"radius_mm": 5}}, **pose}]
    elif where == "body":
        request["bodies"][0]["pose"] = pose
    elif where == "step":
        request["task"][2]["move"]["to"] = pose
    elif where == "start":
        request["start"] = {"tool": {"frame": "dial", "yaw_deg": 0, **pose}, "elbow": "right"}
    return request


@pytest.mark.parametrize("where", ["frame", "base", "tool body", "body", "step", "start"])
def test_a_pose_without_a_place_is_at_the_origin(where: str) -> None:
    silent, stated = (request_digest(changed(where, pose)) for pose in ({}, ORIGIN_MM))
    assert silent == stated


@pytest.mark.parametrize("at", [[0, 0], None, "origin", [0, 0, float("nan")]])
def test_a_place_that_is_stated_is_three_numbers(at: Any) -> None:
    with pytest.raises(InputError) as refused:
        scene_of(changed("body", {"at_mm": at}))
    assert refused.value.field.startswith("bodies[0].pose.at_mm")
