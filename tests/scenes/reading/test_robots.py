"""Robots of a document: narrower limits, inline arms, joint values in the maker's words."""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from assur.planner.errors import InputError
from assur.scenes.catalogue import arm_named, shipped_robot
from assur.scenes.reading.arms import turned_over
from assur.scenes.requests import cell_of, scene_of
from tests.refused import refused_at
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


def plainly(document: Any) -> Any:
    """A robot's document with every fact as a plain number, without status and source."""
    if isinstance(document, dict):
        return plainly(document["value"]) if "value" in document else {k: plainly(v) for k, v in document.items()}
    return [plainly(item) for item in document] if isinstance(document, list) else document


def written_out(model: str) -> dict[str, Any]:
    """A request whose robot is a shipped arm, written out in plain numbers."""
    shipped = shipped_robot(model)
    arm = plainly(shipped.document)[shipped.family]
    middle = {}
    for joint in arm["joints"]:
        (key,) = (key for key in joint if key.startswith("range_"))
        middle[f"{joint['name']}_{key.removeprefix('range_')}"] = sum(joint[key]) / 2 + 1
    found = request(model, middle)
    found["robot"] = {
        shipped.family: arm,
        "tool": {"tcp_mm": [0, 0, 0]},
        "base": {"at_mm": [100, 0, 50], "yaw_deg": 30},
    }
    return found


@pytest.mark.parametrize(
    "model", ["elbow-arm", "polar-arm", "mitsubishi-rv-m1", "lab-scara", "olier-scara", "fanuc-sr-3ia"]
)
def test_an_arm_of_the_catalogue_that_is_written_out_is_the_same_arm(model: str) -> None:
    document = written_out(model)
    inline_cell = cell_of(document)
    named = copy.deepcopy(document)
    named["robot"] = {**document["robot"], "model": model}
    del named["robot"][shipped_robot(model).family]
    named_cell = cell_of(named)
    here, there = inline_cell.scene.robot, named_cell.scene.robot
    assert type(here) is type(there)
    assert inline_cell.conventions == named_cell.conventions == arm_named(model).conventions
    assert here.joints == there.joints
    assert here.self_pairs == there.self_pairs
    assert np.array_equal(inline_cell.scene.start.q, named_cell.scene.start.q)
    for name in ("lower", "upper", "velocity", "acceleration", "jerk"):
        assert np.array_equal(getattr(here.limits, name), getattr(there.limits, name))
    q = inline_cell.scene.start.q
    for mine, other in zip(here.placements(q), there.placements(q), strict=True):
        assert np.array_equal(mine, other)
    assert [(b.link, b.body.name) for b in here.bodies] == [(b.link, b.body.name) for b in there.bodies]
    for mine_, other_ in zip(here.bodies, there.bodies, strict=True):
        for a, b in zip(mine_.body.pieces, other_.body.pieces, strict=True):
            assert a.shape == b.shape
            assert np.array_equal(a.position, b.position)
    assert inline_cell.scene.load_limits == named_cell.scene.load_limits
    own, *of_load = inline_cell.scene.assumptions
    assert own == "the robot's data are the request's own"
    assert of_load == list(named_cell.scene.assumptions[-len(of_load) :])
    assert of_load[0].startswith(f"{model}: not known ")
    # ... and its joints are in the planner's order: what lifts is third
    if model == "lab-scara":
        assert [joint.name for joint in here.joints] == ["j1", "j3", "j2", "j4"]
        assert q == pytest.approx([math.radians(1), math.radians(1), 0.241, math.radians(1)])


def test_a_range_is_narrowed_by_the_makers_name_wherever_the_joint_stands() -> None:
    document = written_out("lab-scara")
    document["robot"]["limits"] = {"j2_mm": [100, 300], "j3_deg": [-90, 100]}
    limits = scene_of(document).robot.limits
    assert (limits.lower[2], limits.upper[2]) == pytest.approx((0.1, 0.3))
    assert (limits.lower[1], limits.upper[1]) == pytest.approx((-math.pi / 2, math.radians(100)))


def test_a_tool_in_a_frame_whose_z_points_down_hangs_below_the_flange() -> None:
    document = request("olier-scara", {"theta1_deg": 0, "theta2_deg": 90, "d3_mm": 50, "theta4_deg": 0})
    solid = {"name": "tip", "shape": {"box": {"size_mm": [10, 20, 80]}}, "at_mm": [5, 7, 40], "yaw_deg": 30}
    document["robot"]["tool"] = {"tcp_mm": [3, 4, 80], "tcp_yaw_deg": 20, "bodies": [solid]}
    tool = scene_of(document).tool
    assert (tool.tcp.x, tool.tcp.y, tool.tcp.z) == pytest.approx((0.003, -0.004, -0.08))
    assert tool.tcp.yaw == pytest.approx(-math.radians(20))
    piece = tool.bodies[0].pieces[0]
    assert piece.position == pytest.approx([0.005, -0.007, -0.04])
    c, s = math.cos(math.radians(30)), math.sin(math.radians(30))
    assert piece.rotation == pytest.approx(np.array([[c, -s, 0], [-s, -c, 0], [0, 0, -1]]))
    # twice is not at all
    again = turned_over(turned_over(tool.bodies[0])).pieces[0]
    assert np.array_equal(again.position, piece.position)
    assert np.array_equal(again.rotation, piece.rotation)


@pytest.mark.parametrize(
    ("model", "change", "field"),
    [
        ("elbow-arm", lambda arm: arm["bodies"][0].update(link="quill"), r"elbow_arm\.bodies\[0\]\.link"),
        ("elbow-arm", lambda arm: arm["self_pairs"].append(["base", "quill"]), r"elbow_arm\.self_pairs\[5\]"),
        ("elbow-arm", lambda arm: arm["joints"][1].update(zero_mm=3), r"joints\[1\]\.zero_m"),
        ("polar-arm", lambda arm: arm["joints"][2].update(zero_mm=3), r"joints\[2\]\.zero_m"),
        ("polar-arm", lambda arm: arm["joints"][2].update(range_mm=[-100, 300]), "robot"),
        ("polar-arm", lambda arm: arm.update(l1_mm=3), r"polar_arm\.l1_m"),
        ("elbow-arm", lambda arm: arm["joints"].pop(), r"elbow_arm\.joints"),
        ("elbow-arm", lambda arm: arm["bodies"][0].update(link="link4"), r"elbow_arm\.bodies\[0\]\.link"),
        ("mitsubishi-rv-m1", lambda arm: arm.pop("l3_mm"), r"five_axis_arm\.l3_m"),
        ("mitsubishi-rv-m1", lambda arm: arm["bodies"][0].update(link="quill"), r"five_axis_arm\.bodies\[0\]\.link"),
        ("mitsubishi-rv-m1", lambda arm: arm["joints"].pop(), r"five_axis_arm\.joints"),
        ("mitsubishi-rv-m1", lambda arm: arm["joints"][4].update(zero_mm=3), r"joints\[4\]\.zero_m"),
        ("lab-scara", lambda arm: arm["bodies"][1].update(link="link3"), r"scara\.bodies\[1\]\.link"),
        ("lab-scara", lambda arm: arm["joints"][1].update(zero_deg=3), r"joints\[1\]\.zero_deg"),
        ("lab-scara", lambda arm: arm["joints"][0].update(zero_deg=361), r"joints\[0\]\.zero_deg"),
        ("lab-scara", lambda arm: arm.update(base_offset_mm=[1, 2, 3]), r"scara\.base_offset_mm"),
        ("lab-scara", lambda arm: arm.update(axis_order="rrrp", joints=arm["joints"][:3]), r"scara\.axis_order"),
        ("lab-scara", lambda arm: arm.update(axis_order="rrpr"), r"scara\.joints\[1\]\.range_m"),
    ],
)
def test_what_a_written_out_arm_of_a_family_has_not_is_refused_where_it_stands(
    model: str, change: Any, field: str
) -> None:
    document = written_out(model)
    cell_of(document)
    change(document["robot"][shipped_robot(model).family])
    with pytest.raises(InputError, match=field):
        cell_of(document)


def test_three_axes_have_no_yaw_to_ask_for() -> None:
    assert scene_of(inline(3)).robot.coordinates == ("x", "y", "z")
    for yaw in ({"yaw_deg": 3},):
        task = [{"move": {"to": {"at_mm": [300, 0, 300], **yaw}}}]
        with refused_at("task[0].move.to.yaw_deg"):
            scene_of(inline(3, task=task))
    follow = [{"follow": {"to": {"at_mm": [300, 0, 300]}, "duration_s": 1}}]
    step = scene_of(inline(3, task=follow)).task[0]
    assert getattr(step, "target").yaw_free  # noqa: B009
    assert scene_of(request("oviedo-scara", {"theta1_deg": 0, "theta2_deg": 30, "l3_mm": 70})).start.q == pytest.approx(
        [0, -math.radians(30), -0.07]
    )


def test_a_body_on_a_link_is_turned_by_roll_pitch_and_yaw_in_this_order() -> None:
    document = inline()
    box = {"name": "bar", "link": "link2", "shape": {"box": {"size_mm": [100, 20, 10]}}, "at_mm": [10, 0, 0]}
    document["robot"]["scara"]["bodies"] = [{**box, "roll_deg": 90, "pitch_deg": 0, "yaw_deg": 90}]
    (rider,) = scene_of(document).robot.bodies
    assert np.allclose(rider.body.pieces[0].rotation, [[0, 0, 1], [1, 0, 0], [0, 1, 0]], atol=1e-15)
    document["robot"]["scara"]["bodies"] = [{**box, "pitch_deg": 90}]
    (rider,) = scene_of(document).robot.bodies
    assert np.allclose(rider.body.pieces[0].rotation @ [1, 0, 0], [0, 0, -1], atol=1e-15)
