"""A start that is a pose of the tool: every family is put where its own joints put the tool, and nowhere else."""

from __future__ import annotations

import copy
import math
from typing import Any

import numpy as np
import pytest

from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.model.scene import Scene
from assur.planner.robots.facts import principal
from assur.scenes.requests import check_document, plan_document, scene_of
from tests.scenes.cells.answers import findings_of
from tests.scenes.robots_of_every_family import (
    ROBOTS,
    built,
    in_words_of_the_maker,
    pose_document,
    positions,
    robot_document,
    tool_at,
)

AT_S = 0.7
FRAMES: dict[str, Any] = {
    "table": {"fixed": {"at_mm": [30, -40, 5], "yaw_deg": 70}},
    "tray": {"fixed": {"frame": "dial", "at_mm": [1, 2, 3], "yaw_deg": -20}},
    "dial": {"turntable": {"at_mm": [100, 50, 0], "yaw_deg": 15, "rate_deg_s": 60, "rise_mm_s": 2}},
    "late": {"keyframes": {"points": [{"time_s": 3, "at_mm": [0, 0, 0]}, {"time_s": 4, "at_mm": [9, 0, 0]}]}},
}
TRAY = Pose(0.1, 0.05, 2e-3 * AT_S, math.radians(15 + 60 * AT_S)).then(Pose(1e-3, 2e-3, 3e-3, math.radians(-20)))
"""Where the tray is at the start, by hand."""


def scene(robot: dict[str, Any], start: dict[str, Any]) -> Scene:
    document: dict[str, Any] = {"schema": "assur/1", "robot": robot, "start": {"at_s": AT_S, **start}}
    document["frames"] = FRAMES
    document["bodies"] = [{"name": "plate", "shape": {"sphere": {"radius_mm": 9}}, "pose": {"at_mm": [0, 900, 0]}}]
    document["task"] = [{"move": {"to": {"at_mm": [300, 0, 200]}}}]
    return scene_of(document)


@pytest.mark.parametrize("name", ROBOTS)
def test_the_pose_that_joints_give_is_taken_with_these_joints(name: str) -> None:
    given, robot = built(name), robot_document(name)
    sign = given.conventions[-1].sign
    for q in positions(given, 20, seed=3):
        tool = pose_document(tool_at(q, given), given)
        elbow = given.robot.modes[int(given.robot.mode_of(q))]
        start: dict[str, Any] = {"tool": tool, "elbow": elbow}
        if {"yaw", "roll"} & set(given.robot.coordinates):
            start["turn"] = math.ceil((sign * q[-1] - math.pi) / (2 * math.pi))
        found = scene(robot, start).start
        assert not found.moving
        assert found.time == AT_S
        assert (given.robot.limits.lower <= found.q).all()
        assert (found.q <= given.robot.limits.upper).all()
        turning = np.array([joint.kind == "revolute" for joint in given.robot.joints])
        off = np.where(turning, principal(found.q - q), found.q - q)
        assert np.abs(off).max() < 1e-9
        # the wrist is in the turn that was asked; of the other joints those near their zeros
        assert abs(found.q[-1] - q[-1]) < 1e-9 or "turn" not in start
        zero = given.conventions.zeros
        assert (np.abs(found.q - zero)[:-1] <= np.abs(q - zero)[:-1] + 1e-9).all()


@pytest.mark.parametrize("name", ["mitsubishi-rh-6frh5520", "mitsubishi-rv-m1", "five-bar of four axes", "polar arm"])
def test_the_pose_may_be_in_a_frame_that_moves_and_is_that_at_the_start(name: str) -> None:
    given, robot = built(name), robot_document(name)
    (q,) = positions(given, 1, seed=4)
    tool = tool_at(q, given)
    away = tool.p - TRAY.position
    c, s = math.cos(TRAY.yaw), math.sin(TRAY.yaw)
    pose = pose_document(tool, given) | {
        "frame": "tray",
        "at_m": [c * away[0] + s * away[1], c * away[1] - s * away[0], away[2]],
    }
    if "yaw_rad" in pose:
        pose["yaw_rad"] -= TRAY.yaw
    elbow = given.robot.modes[int(given.robot.mode_of(q))]
    there = tool_at(scene(robot, {"tool": pose, "elbow": elbow}).start.q, given)
    assert there.p == pytest.approx(tool.p, abs=1e-12)
    assert principal(there.yaw - tool.yaw) == pytest.approx(0.0, abs=1e-12)


GOOD: dict[str, Any] = {
    "model": "mitsubishi-rh-6frh5520",
    "tool": {"tcp_mm": [0, 0, -100]},
    "limits": {"j4_deg": [-270, 270]},
}
REACHED: dict[str, Any] = {"at_mm": [350, 100, 150], "yaw_deg": 90}
LEFT = {"tool": REACHED, "elbow": "left"}


def refused(start: dict[str, Any], robot: dict[str, Any] = GOOD) -> InputError:
    with pytest.raises(InputError) as caught:
        scene(robot, start)
    return caught.value


def test_the_wrist_is_turned_least_unless_another_turn_is_asked() -> None:
    j4 = [math.degrees(scene(GOOD, {**LEFT, **turn}).start.q[3]) for turn in ({}, {"turn": 0}, {"turn": -1})]
    assert j4[0] == j4[1] == pytest.approx(j4[2] + 360)
    assert -180 < j4[0] <= 180


def test_a_turn_that_is_outside_the_range_is_told_those_that_are_inside() -> None:
    error = refused({**LEFT, "turn": 1})
    assert (error.field, error.value) == ("start.turn", 1)
    (q4,) = (math.degrees(scene(GOOD, LEFT).start.q[3]),)
    assert error.allowed == f"-1 (j4 at {q4 - 360:.6g} deg) or 0 (j4 at {q4:.6g} deg)"
    assert refused({**LEFT, "turn": 65}).field == "start.turn"
    assert refused({**LEFT, "turn": 0.5}).allowed == "a whole number"


def test_a_wrist_that_its_maker_counts_the_other_way_round_has_its_makers_turns() -> None:
    robot = {"model": "olier-scara", "tool": {"tcp_mm": [0, 0, 0]}}
    tool = {"at_mm": [300, 100, 200], "yaw_deg": 0}
    for turn in (0, 1):
        j4 = -math.degrees(scene(robot, {"tool": tool, "elbow": "left", "turn": turn}).start.q[3])
        assert 360 * turn - 180 < j4 <= 360 * turn + 180


def test_an_elbow_is_asked_for_where_both_sides_reach_and_the_solutions_are_listed() -> None:
    error = refused({"tool": REACHED})
    assert error.field == "start.elbow"
    assert error.allowed.startswith("left (j1 ")
    assert " or right (j1 " in error.allowed
    assert error.allowed.endswith(", which must be given")
    for elbow in ("left", "right"):
        q = scene(GOOD, {"tool": REACHED, "elbow": elbow}).start.q
        assert f"{elbow} (j1 {math.degrees(q[0]):.6g} deg, j2 {math.degrees(q[1]):.6g} deg, " in error.allowed
    assert refused({**LEFT, "elbow": "up"}).allowed == "one of left, right"


def test_an_elbow_need_not_be_said_where_one_side_reaches_and_the_other_is_refused_with_its_reason() -> None:
    behind = {"at_mm": [-480, 180, 150], "yaw_deg": 90}
    q = scene(GOOD, {"tool": behind}).start.q
    assert q[1] > 0.0
    error = refused({"tool": behind, "elbow": "left"})
    assert (error.field, error.value) == ("start.elbow", "left")
    assert error.allowed.startswith("right (left: j1 would be at ")
    assert error.allowed.endswith(" deg beyond its range of -170 to 170 deg)")


ELBOW = {"model": "elbow-arm", "tool": {"tcp_mm": [0, 0, 0]}}
FIVE_AXES = {"model": "mitsubishi-rv-m1", "tool": {"tcp_mm": [0, 0, 0]}}
BARS = {"model": "mitsubishi-rp-5ah", "tool": {"tcp_mm": [0, 0, 0]}}
FLAT = {"yaw_deg": 0}


@pytest.mark.parametrize(
    ("robot", "at_mm", "more", "said"),
    [
        (GOOD, [900, 0, 150], FLAT, "(350 mm out of reach)"),  # the arm is 550 mm long
        (GOOD, [553.2, 0, 150], FLAT, "(3.2 mm out of reach)"),
        (GOOD, [0, 40, 150], FLAT, "(60 mm out of reach)"),  # its links are 325 and 225 mm long
        (GOOD, [550, 0, 150], FLAT, "(the arm would be stretched)"),
        (GOOD, [0, 100, 150], FLAT, "(the arm would be folded)"),
        (GOOD, [350, 100, 350], FLAT, "(j3 would be at 450 mm, 117 mm beyond its range of 133 to 333 mm)"),
        (GOOD, [110, 0, 150], FLAT, "j2 would be at "),
        (GOOD, [110, 0, 150], FLAT, " deg beyond its range of -145 to 145 deg; right: j2 would be at "),
        (ELBOW, [0, 0, 500], {}, "the tool would be over the base axis"),
        (ELBOW, [0, 900, 300], {}, " mm out of reach"),
        (FIVE_AXES, [300, 0, 900], {"pitch_deg": 90, "roll_deg": 0}, " mm out of reach"),
        (FIVE_AXES, [300, 0, 300], {"pitch_deg": 0, "roll_deg": 900}, "up: j"),
        (BARS, [460, 0, 100], FLAT, " mm out of reach"),
        (BARS, [-200, 0, 100], FLAT, "only the other assembly of the arm comes there"),
    ],
)
def test_a_pose_that_an_arm_cannot_take_is_told_what_is_missing(
    robot: dict[str, Any], at_mm: list[float], more: dict[str, float], said: str
) -> None:
    error = refused({"tool": {"at_mm": at_mm, **more}}, robot)
    assert (error.field, error.value) == ("start.tool.at_mm", at_mm)
    assert error.allowed.startswith("a pose that the arm can take (")
    assert said in error.allowed


def test_a_five_bar_whose_couplers_would_be_too_near_to_one_line_says_how_near() -> None:
    given, robot = built("five-bar of four axes"), robot_document("five-bar of four axes")
    limits = given.robot.limits
    q = np.random.default_rng(8).uniform(limits.lower, limits.upper, (20_000, 4))
    margin = given.robot.parallel_margin(q)
    near = (margin > 0.01) & (margin < 0.09) & (given.robot.margin(q) > 0.05)
    assert near.sum() > 10
    for one, least in zip(q[near][:10], margin[near], strict=False):
        elbow = given.robot.modes[int(given.robot.mode_of(one))]
        error = refused({"tool": pose_document(tool_at(one, given), given), "elbow": elbow}, robot)
        assert f"near to one line (parallel margin {least:.3f}, required 0.1)" in error.allowed


def test_a_five_bar_without_a_lift_is_at_one_height() -> None:
    given, robot = built("five-bar of two axes"), robot_document("five-bar of two axes")
    (q,) = positions(given, 1, seed=5)
    motion = tool_at(q, given)
    higher = motion.at(Pose(z=0.004))
    error = refused({"tool": pose_document(higher, given)}, robot)
    assert "(4 mm out of reach)" in error.allowed


@pytest.mark.parametrize(
    ("start", "robot", "field", "said"),
    [
        ({"tool": {"at_mm": [350, 100, 150]}}, GOOD, "start.tool.yaw_rad", "yaw_rad or yaw_deg, which must be given"),
        ({"tool": {**REACHED, "pitch_deg": 0}}, GOOD, "start.tool.pitch_deg", "only arms with five axes"),
        ({"tool": {**REACHED, "yaw_deg": "free"}}, GOOD, "start.tool.yaw_deg", "a number"),
        ({"tool": {**REACHED, "yaw_deg": math.nan}}, GOOD, "start.tool.yaw_deg", "a finite number"),
        ({"tool": {**REACHED, "at_mm": [350, 100]}}, GOOD, "start.tool.at_mm", "at least 3 items, not 2"),
        ({"tool": {**REACHED, "at_mm": [350, 100, math.inf]}}, GOOD, "start.tool.at_mm[2]", "a finite number"),
        ({"tool": {**REACHED, "at_mm": [3e6, 1, 1]}}, GOOD, "start.tool.at_mm[0]", "at most 100000 (mm)"),
        ({"tool": REACHED | {"at_m": [0, 0, 0]}}, GOOD, "start.tool.at_mm", "not both"),
        ({"tool": {**REACHED, "frame": "dail"}}, GOOD, "start.tool.frame", "did you mean dial?"),
        ({"tool": {**REACHED, "frame": "late"}}, GOOD, "start.tool.frame", "late is known from 3 s to 4 s"),
        ({"tool": {**REACHED, "body": "plat"}}, GOOD, "start.tool.body", "did you mean plate?"),
        ({"tool": {**REACHED, "frame": "dial", "body": "plate"}}, GOOD, "start.tool.body", "at most one of"),
        ({**LEFT, "velocity": {"j1_deg_s": 1}}, GOOD, "start.velocity", "at most one of tool, velocity"),
        ({**LEFT, "acceleration": {}}, GOOD, "start.acceleration", "at most one of tool, acceleration"),
        ({**LEFT, "joints": {"j1_deg": 1}}, GOOD, "start.tool", "exactly one of joints, tool"),
        ({"elbow": "left", "joints": {"j1_deg": 1}}, GOOD, "start.elbow", "at most one of joints, elbow"),
        ({}, GOOD, "start", "exactly one of joints, tool"),
        ({"tool": {"at_mm": [300, 0, 300], "yaw_deg": 0}}, ELBOW, "start.tool.yaw_deg", "has no wrist"),
        ({"tool": {"at_mm": [300, 0, 300], "yaw_deg": 0}}, FIVE_AXES, "start.tool.yaw_deg", "heading follows"),
        ({"tool": {"at_mm": [300, 0, 300], "pitch_deg": "free"}}, FIVE_AXES, "start.tool.pitch_deg", "a number"),
        ({"tool": {"at_mm": [300, 0, 300], "pitch_deg": 0}}, FIVE_AXES, "start.tool.roll_rad", "roll_rad or roll_deg"),
        ({"tool": {"at_mm": [300, 0, 400]}, "elbow": "up", "turn": 0}, ELBOW, "start.turn", "has no wrist"),
        (
            {"tool": {"at_mm": [300, 0, 300]}},
            {**ELBOW, "tool": {"tcp_mm": [0, 0, 9]}},
            "robot.tool.tcp_mm",
            "the flange of elbow-arm tilts",
        ),
    ],
)
def test_what_is_wrong_is_told_at_its_field(
    start: dict[str, Any], robot: dict[str, Any], field: str, said: str
) -> None:
    error = refused(start, robot)
    assert error.field == field
    assert said in error.allowed


def test_a_start_beside_a_body_is_measured_from_the_body() -> None:
    beside = {"body": "plate", "at_mm": [350, -800, 150], "yaw_deg": 90}
    found = scene(GOOD, {"tool": beside, "elbow": "left"}).start.q
    assert found == pytest.approx(scene(GOOD, LEFT).start.q, abs=1e-12)


def test_a_position_at_the_end_of_a_range_is_not_lost_by_rounding() -> None:
    given, robot = built("mitsubishi-rh-6frh5520"), robot_document("mitsubishi-rh-6frh5520")
    limits = given.robot.limits
    for ends in (limits.lower, limits.upper):
        q = np.array([ends[0], ends[1], ends[2], ends[3]])
        pose = pose_document(tool_at(q, given), given)
        turn = -1 if ends[3] < 0 else 1
        found = scene(robot, {"tool": pose, "elbow": given.robot.modes[int(ends[1] > 0)], "turn": turn})
        assert found.start.q == pytest.approx(q, abs=1e-9)
        assert given.robot.limits.holds(found.start.q)
        assert (limits.lower <= found.start.q).all()


def test_a_plan_from_a_pose_is_that_from_its_joints_and_the_checker_accepts_it() -> None:
    base = {
        "schema": "assur/1",
        "robot": GOOD,
        "start": LEFT,
        "task": [{"move": {"to": {"at_mm": [300, -200, 120], "yaw_deg": 0}}}],
        "options": {"stop": "first", "max_candidates": 200, "budget_s": 60},
    }
    answer = plan_document(base)
    assert answer["status"] == "planned"
    assert check_document(base, answer)["ok"]
    joints = in_words_of_the_maker(scene_of(base).start.q, built("mitsubishi-rh-6frh5520"))
    other = plan_document({**base, "start": {"joints": joints}})
    assert other["trajectory"] == answer["trajectory"]
    moved = copy.deepcopy(answer)
    moved["trajectory"]["position"][0][3] += 2 * math.pi
    assert findings_of(base, moved) >= {"START"}
