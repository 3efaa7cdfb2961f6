"""Steps of a document become the planner's steps, field by field; nothing is lost and nothing is guessed."""

from __future__ import annotations

import copy
import math
from typing import Any

import pytest

from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.model.scene import Arch, Follow, Move, Pick, Place, Scene, Target, Window
from assur.scenes.requests import scene_of
from tests.refused import refused_at
from tests.scenes.bad_requests import GOOD_REQUEST


def scene(*steps: dict[str, Any], **changes: Any) -> Scene:
    """The good cell with these steps."""
    request = copy.deepcopy(GOOD_REQUEST)
    request.update(changes)
    if steps:
        request["task"] = list(steps)
    return scene_of(request)


def test_the_steps_of_the_good_request() -> None:
    pick, place, move = scene().task
    assert pick == Pick(
        "pick-1", "part", Pose(0, 0, 0.01), 0.03, 0.08, 0.04, "velocity", Window(along=(-0.3, 0.25)), None
    )
    assert place == Place(
        "place-2", "part", Target("dial", Pose(0.15, 0, 0.01, 0)), 0.02, 0.06, 0.03, "velocity", Window(), ("plate",)
    )
    assert move == Move("move-3", Target("world", Pose(0.35, 0, 0.12), yaw_free=True))


def test_every_field_of_a_move() -> None:
    (step,) = scene(
        {
            "move": {
                "name": "over",
                "to": {"frame": "belt", "at_mm": [1, 2, 3], "yaw_deg": 90},
                "match": "position",
                "via": True,
                "arch": {"top_mm": 200},
                "window_ms": [500, 1500],
                "window_mm": [10, 20],
            }
        }
    ).task
    assert step == Move(
        "over",
        Target("belt", Pose(0.001, 0.002, 0.003, math.pi / 2)),
        "position",
        True,
        Arch(0.2),
        Window((0.5, 1.5), (0.01, 0.02)),
    )


def test_a_straight_leg_meets_a_moving_frame_with_its_velocity_only() -> None:
    move: dict[str, Any] = {"to": {"frame": "belt", "at_mm": [1, 2, 3], "yaw_deg": 90}, "leg": "cartesian"}
    (step,) = scene({"move": move}).task
    assert isinstance(step, Move)
    assert (step.leg, step.match) == ("cartesian", "velocity")
    with pytest.raises(InputError, match="a straight leg meets a moving frame with its velocity"):
        scene({"move": {**move, "match": "position"}})


def test_every_field_of_a_follow() -> None:
    to = {"frame": "dial", "at_mm": [100, 0, 30], "yaw_free": True}
    (step,) = scene({"follow": {"to": to, "duration_ms": 250, "window_s": [1, 2]}}).task
    assert step == Follow("follow-1", Target("dial", Pose(0.1, 0, 0.03), True), 0.25, Window((1.0, 2.0)))


def test_a_target_on_a_body_is_a_target_in_that_bodys_frame() -> None:
    (step,) = scene({"move": {"to": {"body": "plate", "at_mm": [0, 150, 30], "yaw_deg": 0}}}).task
    assert isinstance(step, Move)
    assert (step.target.frame, step.target.yaw_free) == ("dial", False)
    pose = step.target.pose
    assert (pose.x, pose.y, pose.z, pose.yaw) == pytest.approx((0, 0.15, 0.02, 0))


def test_a_part_may_be_picked_again_where_it_was_placed() -> None:
    again = {"pick": {**GOOD_REQUEST["task"][0]["pick"], "name": "again"}}
    again["pick"].pop("window_mm")
    back = {
        "place": {
            **GOOD_REQUEST["task"][1]["place"],
            "to": {"frame": "belt", "at_mm": [0, 0, 10], "yaw_deg": 0},
            "window_mm": [-100, 100],
        }
    }
    steps = scene(*GOOD_REQUEST["task"][:2], again, back).task
    assert [step.name for step in steps] == ["pick-1", "place-2", "again", "place-4"]
    windowed = {"pick": {**GOOD_REQUEST["task"][0]["pick"], "name": "again"}}
    with refused_at("task[2].pick.window_mm"):
        scene(*GOOD_REQUEST["task"][:2], windowed)


def test_options_execution_and_carry() -> None:
    found = scene(
        options={
            "seed": 7,
            "budget_ms": 300,
            "max_candidates": 50,
            "stop": "first",
            "explain_budget_s": 0.5,
            "clearance_mm": {"travel": 8, "near": 1.5},
            "singularity_margin": 0.2,
            "elbow": "auto",
            "end": "moving",
            "stay_safe_s": 2,
            "latest_end_s": 9,
        },
        execution={"lag": {"j1_rad": 0.001, "j3_mm": 0.3}, "start_tolerance_ms": 4, "belt_correction": True},
        carry={"acceleration_m_s2": 15},
    )
    options = found.options
    assert (options.seed, options.budget_s, options.max_candidates, options.stop) == (7, 0.3, 50, "first")
    assert (options.clearance.travel_m, options.clearance.near_m) == (0.008, 0.0015)
    assert (options.explain_budget_s, options.singularity_margin, options.elbow) == (0.5, 0.2, "auto")
    assert (options.end, options.stay_safe_s, options.latest_end_s) == ("moving", 2.0, 9.0)
    assert (found.execution.lag, found.execution.start_tolerance_s) == ((0.001, 0.0, 0.0003, 0.0), 0.004)
    assert found.execution.belt_correction
    assert found.carry_acceleration == 15.0


def test_what_is_silent_is_safe() -> None:
    found = scene(options={})
    assert (found.options.elbow, found.options.end) == ("keep", "rest")
    assert all(getattr(step, "match", "velocity") == "velocity" for step in found.task)
    assert not found.execution.belt_correction
