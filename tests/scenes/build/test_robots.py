"""Robots of a document: narrower limits, inline arms, joint values in the maker's words."""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from planner.errors import InputError
from planner.robots.scara import Scara
from scenes.requests import cell_of, scene_of
from tests.scenes.bad_requests import GOOD_REQUEST


def request(model: str, joints: Mapping[str, float], **limits: Any) -> dict[str, Any]:
    """A move with a robot of the catalogue, from these joints."""
    found = copy.deepcopy(GOOD_REQUEST)
    found["robot"] = {"model": model, "tool": {"tcp_mm": [0, 0, 0]}, "limits": limits}
    found["start"] = {"joints": joints}
    found["frames"], found["bodies"], found["task"] = {}, [], [{"move": {"to": {"at_mm": [300, 0, 100]}}}]
    return found


FANUC = {"j1_deg": 10, "j2_deg": 20, "j3_mm": 50, "j4_deg": 30}
MITSUBISHI = {"j1_deg": 10, "j2_deg": 20, "j3_mm": 250, "j4_deg": 30}


def test_limits_are_scaled_and_ranges_narrowed_and_nothing_else_changes() -> None:
    plain = scene_of(request("mitsubishi-rh-6frh5520", MITSUBISHI)).robot.limits
    narrow = scene_of(
        request(
            "mitsubishi-rh-6frh5520", MITSUBISHI, acceleration=0.6, velocity=0.5, j4_deg=[-270, 180], j3_mm=[133, 300]
        )
    ).robot.limits
    np.testing.assert_allclose(narrow.velocity, 0.5 * plain.velocity)
    np.testing.assert_allclose(narrow.acceleration, 0.6 * plain.acceleration)
    np.testing.assert_array_equal(narrow.jerk, plain.jerk)
    np.testing.assert_allclose(narrow.lower, [*plain.lower[:2], 0.133, math.radians(-270)])
    np.testing.assert_allclose(narrow.upper, [*plain.upper[:2], 0.3, math.radians(180)])


def test_the_whole_range_is_not_wider_than_itself() -> None:
    for model, ranges in (("mitsubishi-rh-6frh5520", {"j1_deg": [-170, 170]}), ("fanuc-sr-3ia", {"j3_mm": [0, 200]})):
        joints = FANUC if model.startswith("fanuc") else MITSUBISHI
        scene_of(request(model, joints, **ranges))


def test_a_range_of_a_joint_that_counts_downwards_is_turned_over() -> None:
    limits = scene_of(request("fanuc-sr-3ia", FANUC, j3_mm=[20, 150])).robot.limits
    assert (limits.lower[2], limits.upper[2]) == pytest.approx((-0.15, -0.02))
    with pytest.raises(InputError, match=r"0 to 0\.2 m"):
        scene_of(request("fanuc-sr-3ia", FANUC, j3_mm=[-20, 150]))


def test_the_start_of_a_joint_that_counts_downwards() -> None:
    start = scene_of(request("fanuc-sr-3ia", FANUC)).start
    assert start.q == pytest.approx([math.radians(10), math.radians(20), -0.05, math.radians(30)])
    assert not start.moving


def test_a_start_in_motion() -> None:
    document = request("fanuc-sr-3ia", FANUC)
    document["start"] |= {
        "at_ms": 500,
        "velocity": {"j1_deg_s": 10, "j2_rad_s": 0.1, "j3_mm_s": 40, "j4_deg_s": 0},
        "acceleration": {"j1_deg_s2": 0, "j2_rad_s2": 0, "j3_m_s2": 0.5, "j4_deg_s2": 0},
    }
    start = scene_of(document).start
    assert start.time == 0.5
    assert start.qd == pytest.approx([math.radians(10), 0.1, -0.04, 0])
    assert start.qdd == pytest.approx([0, 0, -0.5, 0])
    assert start.moving


def inline(axes: int = 4, **changes: Any) -> dict[str, Any]:
    """A move of an inline arm whose lift counts downwards from 400 mm."""
    turn = {"range_deg": [-150, 150], "velocity_deg_s": 300, "acceleration_deg_s2": 3000, "jerk_deg_s3": 60000}
    lift = {"range_mm": [0, 200], "velocity_mm_s": 900, "acceleration_mm_s2": 9000, "jerk_mm_s3": 90000}
    joints = [
        {"name": "A", **turn, "sign": -1},
        {"name": "B", **turn},
        {"name": "Z", **lift, "sign": -1, "zero_mm": 400},
        {"name": "C", **turn},
    ][:axes]
    solids = [
        {
            "name": "post",
            "link": "base",
            "shape": {"cylinder": {"radius_mm": 50, "height_mm": 400}},
            "at_mm": [0, 0, 200],
        },
        {
            "name": "rod",
            "link": "quill",
            "shape": {"cylinder": {"radius_mm": 9, "height_mm": 300}},
            "at_mm": [0, 0, 150],
        },
    ]
    found = request("benchmark-scara", {})
    found["robot"] = {
        "scara": {"l1_mm": 300, "l2_mm": 250, "joints": joints, "bodies": solids, "self_pairs": [["base", "quill"]]},
        "tool": {"tcp_mm": [0, 0, 0]},
        "base": {"at_mm": [100, 0, 50], "yaw_deg": 90},
    }
    values = {"A_deg": 10, "B_deg": 60, "Z_mm": 150, "C_deg": 5}
    found["start"] = {"joints": dict(list(values.items())[:axes])}
    found.update(changes)
    return found


def test_an_inline_arm_is_where_its_conventions_put_it() -> None:
    cell = cell_of(inline())
    robot, q = cell.scene.robot, cell.scene.start.q
    assert isinstance(robot, Scara)
    assert q == pytest.approx([math.radians(-10), math.radians(60), -0.15, math.radians(5)])
    point, yaw = robot.forward(q)
    phi1, phi2 = math.radians(90 - 10), math.radians(90 - 10 + 60)
    expected = [0.1 + 0.3 * math.cos(phi1) + 0.25 * math.cos(phi2), 0.3 * math.sin(phi1) + 0.25 * math.sin(phi2), 0.3]
    np.testing.assert_allclose(point, expected, atol=1e-15)
    assert float(yaw) == pytest.approx(math.radians(90 - 10 + 60 + 5))
    np.testing.assert_allclose(robot.limits.lower, [-math.radians(150)] * 2 + [-0.2, -math.radians(150)])
    post = next(body for body in robot.bodies if body.body.name == "post")
    height = robot.placements(q)[0][post.link][2] + post.body.pieces[0].position[2]
    assert height == pytest.approx(0.05 + 0.2)
    assert robot.self_pairs == (("base", "quill"),)
    assert cell.scene.assumptions


def test_three_axes_have_no_yaw_to_ask_for() -> None:
    assert scene_of(inline(3)).robot.coordinates == ("x", "y", "z")
    for yaw in ({"yaw_deg": 3},):
        task = [{"move": {"to": {"at_mm": [300, 0, 300], **yaw}}}]
        with pytest.raises(InputError) as caught:
            scene_of(inline(3, task=task))
        assert caught.value.field == "task[0].move.to.yaw_deg"
    follow = [{"follow": {"to": {"at_mm": [300, 0, 300]}, "duration_s": 1}}]
    step = scene_of(inline(3, task=follow)).task[0]
    assert getattr(step, "target").yaw_free  # noqa: B009
    assert scene_of(request("oviedo-scara", {"theta1_deg": 0, "theta2_deg": 30, "l3_mm": 70})).start.q == pytest.approx(
        [0, -math.radians(30), -0.07]
    )
