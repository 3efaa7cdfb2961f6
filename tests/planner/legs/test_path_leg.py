"""Cartesian legs along a path: on it within 0.01 mm from end to end, without a stop, corners within what is stated."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from assur.planner.arrays import FloatArray
from assur.planner.checked import check
from assur.planner.checker import Code
from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.laws import conveyor, fixed
from assur.planner.model.outcome import Course, NotPlanned, Plan, Planned
from assur.planner.model.path import ArcTo, LineTo, PathPart
from assur.planner.model.refusal import BeyondRange, MotionLimit, Obstacle, OutOfReach, Reason
from assur.planner.model.scene import Arch, Move, Scene, Target
from assur.planner.pipeline import plan
from tests.planner.cells import BARE, CRANKED, CUP, cell, frame
from tests.planner.checker.hand_made import sealed

ON_PATH_M = 1e-5
GOAL = (0.3, 0.2, 0.12)
ARC: tuple[PathPart, ...] = (ArcTo((0.36, 0.05, 0.16), GOAL),)
CORNERS: tuple[PathPart, ...] = (LineTo((0.4, 0.0, 0.1)), LineTo((0.4, 0.12, 0.1)), LineTo(GOAL))


def first(x: float, y: float, z: float, frame: str = "world") -> Move:
    return Move("first", Target(frame, Pose(x, y, z)))


def going(parts: tuple[PathPart, ...], blend: float = 0.0, yaw: float = 0.4, **more: Any) -> Scene:
    """From (300, −100, 100) mm along parts to GOAL, in the world."""
    move = Move("way", Target("world", Pose(*GOAL, yaw)), leg="cartesian", path=parts, blend_m=blend)
    return cell(first(0.3, -0.1, 0.1), move, **{"tool": CUP, **more})


def planned(scene: Scene) -> Planned:
    found = plan(scene)
    assert isinstance(found, Planned), found.sentence
    assert check(scene, found.plan).findings == ()
    return found


def refused(scene: Scene) -> NotPlanned:
    # few candidates: why the first of them is refused does not change
    found = plan(replace(scene, options=replace(scene.options, max_candidates=24)))
    assert isinstance(found, NotPlanned)
    assert found.refusal is not None
    return found


def tool(scene: Scene, made: Plan, number: int, many: int = 20_001) -> tuple[FloatArray, FloatArray]:
    """Times of the legs of a step, and the tool point (T, 3) in the world."""
    own = [leg for leg in made.legs if leg.step == number]
    t = np.linspace(own[0].t0, own[-1].t1, many)
    p, yaw = scene.robot.forward(made.trajectory.evaluate(t))
    tcp = scene.tool.tcp
    x = p[:, 0] + np.cos(yaw) * tcp.x - np.sin(yaw) * tcp.y
    y = p[:, 1] + np.sin(yaw) * tcp.x + np.cos(yaw) * tcp.y
    return t, np.stack([x, y, p[:, 2] + tcp.z], -1)


@pytest.mark.parametrize("hand", [BARE, CUP, CRANKED], ids=["bare", "cup", "cranked"])
def test_a_circular_leg_goes_through_its_via_on_one_circle_without_a_stop(hand: Any) -> None:
    scene = going(ARC, tool=hand)
    made = planned(scene)
    _, w = tool(scene, made.plan, 1)
    a, v, b = np.array([0.3, -0.1, 0.1]), np.array(ARC[0].via), np.array(GOAL)  # type: ignore[union-attr]
    # the circle by its bisectors, not by the planner's formula
    normal = np.cross(v - a, b - a)
    rows = np.array([v - a, b - a, normal])
    centre = np.linalg.solve(rows, [(v - a) @ (v + a) / 2, (b - a) @ (b + a) / 2, normal @ a])
    radius = np.linalg.norm(a - centre)
    assert np.abs(np.linalg.norm(w - centre, axis=1) - radius).max() < ON_PATH_M
    assert np.abs((w - centre) @ (normal / np.linalg.norm(normal))).max() < ON_PATH_M
    assert np.linalg.norm(w - v, axis=1).min() < 5e-5
    angle = np.arctan2(np.cross(a - centre, w - centre) @ normal / np.linalg.norm(normal), (w - centre) @ (a - centre))
    assert (np.diff(np.unwrap(angle)) > -1e-7).all()
    speed = np.linalg.norm(np.diff(w, axis=0), axis=1)
    assert speed[200:-200].min() > 0.0
    assert next(leg.route for leg in made.plan.legs if leg.step == 1 and leg.route).course is Course.PATH


def test_corners_are_passed_within_what_is_stated_and_not_stopped_at() -> None:
    stopped = planned(cell(*_stops(), tool=CUP)).plan.trajectory.duration
    scene = going(CORNERS, 8e-3)
    made = planned(scene)
    t, w = tool(scene, made.plan, 1)
    speed = np.linalg.norm(np.gradient(w, t, axis=0), axis=1)
    for corner in ((0.4, 0.0, 0.1), (0.4, 0.12, 0.1)):
        off = np.linalg.norm(w - np.array(corner), axis=1)
        assert off.min() <= 8e-3 + ON_PATH_M
        assert speed[off.argmin()] > 0.1
    wider = planned(going(CORNERS, 2e-2))
    assert wider.plan.trajectory.duration < min(made.plan.trajectory.duration, stopped)


def _stops() -> tuple[Move, ...]:
    """The same points, with a stop at each."""
    every = [part.to for part in CORNERS if isinstance(part, LineTo)]
    moves = [Move(f"to-{k}", Target("world", Pose(*to, 0.4)), leg="cartesian") for k, to in enumerate(every)]
    return first(0.3, -0.1, 0.1), *moves


def test_a_leg_from_another_frame_is_refused() -> None:
    law = conveyor(Pose(0.0, 0.3, 0.06), 0.1)
    end = (0.06, 0.0, 0.06)
    move = Move("round", Target("moving", Pose(*end)), leg="cartesian", path=(ArcTo((0.03, 0.02, 0.06), end),))
    found = refused(cell(first(0.3, -0.1, 0.1), move, frames=(frame("moving", law),), tool=CUP)).refusal
    assert found is not None
    assert isinstance(found.facts, MotionLimit)
    assert found.facts.obstacle is Obstacle.OTHER_FRAME


@pytest.mark.parametrize(
    "parts",
    [
        (ArcTo((0.3, 0.05, 0.11), GOAL),),  # on the line from (300, −100, 100)
        (ArcTo((0.3, -0.1, 0.1), GOAL),),
        (LineTo((0.3, -0.1, 0.1)), LineTo(GOAL)),
        (LineTo((0.4, 0.0, 0.1)), LineTo(GOAL)),  # a corner without a blend
    ],
)
def test_from_where_the_leg_begins_there_may_be_no_path(parts: tuple[PathPart, ...]) -> None:
    found = refused(going(parts))
    assert found.refusal is not None
    assert isinstance(found.refusal.facts, MotionLimit)
    assert found.refusal.facts.obstacle is Obstacle.NO_PATH
    assert "no such path" in found.sentence


def test_where_on_its_path_a_leg_is_lost_is_told() -> None:
    found = refused(going((LineTo((0.3, 0.6, 0.1)), LineTo((0.2, 0.6, 0.1)), LineTo(GOAL)), 1e-2))
    assert found.refusal is not None
    assert found.refusal.reason is Reason.OUT_OF_REACH
    assert isinstance(found.refusal.facts, OutOfReach)
    # links of 325 and 275 mm: the line from (300, −100) to (300, 600) leaves their reach at y = 519.6 mm
    assert found.refusal.facts.path_m == pytest.approx(math.sqrt(0.6**2 - 0.3**2) + 0.1, abs=1e-4)
    assert found.refusal.facts.path_at_m == pytest.approx((0.3, math.sqrt(0.6**2 - 0.3**2), 0.1), abs=1e-4)


def test_where_on_its_path_a_joint_ends_is_told() -> None:
    found = refused(going((LineTo((0.35, 0.1, 0.3)), LineTo(GOAL)), 1e-2)).refusal
    assert found is not None
    assert isinstance(found.facts, BeyondRange)
    assert found.facts.path_m is not None
    assert 0.1 < found.facts.path_m < 0.3


@pytest.mark.parametrize(
    "wrong",
    [{"leg": "joint"}, {"leg": "cartesian", "via": True}, {"leg": "cartesian", "arch": Arch(0.2)}],
)
def test_only_a_cartesian_leg_has_a_path(wrong: dict[str, Any]) -> None:
    with pytest.raises(InputError, match="only a cartesian leg"):
        Move("way", Target("world", Pose(*GOAL)), path=ARC, **wrong)


def test_a_path_must_end_at_the_target() -> None:
    with pytest.raises(InputError, match="ends at the target"):
        Move("way", Target("world", Pose(0.3, 0.2, 0.13)), leg="cartesian", path=ARC)


def leaves(scene: Scene, changed: Plan) -> bool:
    """Whether the tool is not shown to keep to its path."""
    found = {each.code for each in check(scene, sealed(scene, changed)).findings}
    return Code.GUIDE in found or Code.FORM in found  # no row can be made for a leg that is far off its path


def test_a_fixed_frame_that_is_not_the_world_is_a_frame_for_paths() -> None:
    end = (0.05, 0.1, 0.06)
    move = Move("way", Target("moving", Pose(*end)), leg="cartesian", path=(ArcTo((0.06, 0.03, 0.06), end),))
    scene = cell(first(0.3, -0.1, 0.1), move, frames=(frame("moving", fixed(Pose(0.3, 0.05, 0.05, 0.7))),), tool=CUP)
    planned(scene)
