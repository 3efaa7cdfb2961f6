"""Pitch and roll under the checker: its own reading of them, and plans that break what they promise of them."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from assur.planner.checked import check
from assur.planner.checker import Code
from assur.planner.frames.motion import Pose
from assur.planner.laws import conveyor
from assur.planner.model.outcome import LegKind, Plan, Planned
from assur.planner.model.scene import Scene, Step
from assur.planner.pipeline import plan
from assur.planner.trajectory import Trajectory
from tests.planner.cells import frame
from tests.planner.checker.hand_made import sealed
from tests.planner.five_axis_cells import DOWN, START, aim, five_axis_arm, five_axis_cell, follows, goes

BELT = frame("belt", conveyor(Pose(0.35, -0.3, 0.2, math.pi / 2), 0.15))
OFF = 1e-4
"""rad: far below what anyone sees, a hundred times what is allowed."""


def scene_with(*task: Step) -> Scene:
    return five_axis_cell(*task, frames=(BELT,))


@cache
def honest(asked: bool) -> tuple[Scene, Plan]:
    """A follow and a move, pitch and roll asked or free."""
    first, second = ((DOWN, 0.2), (-1.0, 0.1)) if asked else ((None, None), (None, None))
    scene = scene_with(follows(aim(0.0, 0.0, 0.05, "belt", *first), 0.3), goes(aim(0.3, 0.2, 0.35, "world", *second)))
    return scene, made(scene)


def made(scene: Scene) -> Plan:
    outcome = plan(scene)
    assert isinstance(outcome, Planned), outcome
    return outcome.plan


def found(scene: Scene, plan: Plan) -> dict[Code, list[str]]:
    texts: dict[Code, list[str]] = {}
    for finding in check(scene, sealed(scene, plan)).findings:
        texts.setdefault(finding.code, []).append(finding.what)
    return texts


@pytest.mark.parametrize("asked", [True, False])
def test_honest_plans_are_right(asked: bool) -> None:
    scene, plan = honest(asked)
    assert check(scene, plan).ok


@pytest.mark.parametrize(("pitch", "roll"), [(OFF, 0.0), (-OFF, 0.0), (0.0, OFF), (0.0, -OFF)])
def test_a_plan_for_another_pitch_or_roll_than_the_one_asked_is_refused(pitch: float, roll: float) -> None:
    """Everything else of it is true: it is an honest plan of a request that differs in nothing else."""
    scene, _ = honest(True)
    steps: list[Any] = list(scene.task)
    for step in (0, 1):
        target = steps[step].target
        other = replace(target, pitch=target.pitch + pitch, roll=target.roll + roll)
        task = [*steps]
        task[step] = replace(steps[step], target=other)
        wrong = found(scene, made(scene_with(*task)))
        assert wrong == {Code.ARRIVAL: [f"{steps[step].name} is met with another pitch or roll"]}


def bumped(plan: Plan, kind: LegKind, joint: int, amount: float) -> Plan:
    """The same plan, but that a joint goes aside by `amount` at one knot inside the leg of a kind."""
    leg = next(leg for leg in plan.legs if leg.kind is kind)
    line = plan.trajectory
    inside = np.flatnonzero((line.time > leg.t0 + 0.02) & (line.time < leg.t1 - 0.02))
    assert len(inside) > 2
    q = line.q.copy()
    q[inside[len(inside) // 2], joint] += amount
    return replace(plan, trajectory=Trajectory(line.time, q, line.qd, line.qdd))


@pytest.mark.parametrize("asked", [True, False])
def test_a_hand_that_rolls_in_the_middle_of_a_follow_is_found(asked: bool) -> None:
    """The roll moves no tool point, and is right at both ends."""
    scene, plan = honest(asked)
    wrong = found(scene, bumped(plan, LegKind.FOLLOW, 4, 3 * OFF))
    assert Code.JOINTS in wrong
    assert Code.ARRIVAL not in wrong
    assert Code.JOINTS not in found(scene, bumped(plan, LegKind.FOLLOW, 4, 0.1 * OFF))


def test_a_hand_that_leaves_the_way_of_pitch_and_roll_on_a_straight_leg_is_found() -> None:
    scene = five_axis_cell(goes(aim(0.3, 0.15, 0.35, pitch=DOWN, roll=1.2), leg="cartesian"))
    plan = made(scene)
    wrong = found(scene, bumped(plan, LegKind.MOVE, 4, 5 * OFF))
    assert Code.JOINTS in wrong
    assert Code.ARRIVAL not in wrong
    assert Code.JOINTS not in found(scene, bumped(plan, LegKind.MOVE, 4, 0.1 * OFF))
    # cut into two legs at the knot where it is off its way, one of them called by another name, it is found as well
    aside = bumped(plan, LegKind.MOVE, 4, 5 * OFF)
    moved = np.flatnonzero(aside.trajectory.q[:, 4] != plan.trajectory.q[:, 4])[0]
    t, leg = float(aside.trajectory.time[moved]), aside.legs[0]
    halves = (replace(leg, t1=t), replace(leg, t0=t, kind=LegKind.ARCH))
    assert {Code.JOINTS, Code.LEGS} & set(found(scene, replace(aside, legs=halves)))
    # by a joint leg it may go as it likes
    loose = five_axis_cell(goes(aim(0.3, 0.15, 0.35, pitch=DOWN, roll=1.2)))
    assert Code.JOINTS not in found(loose, bumped(plan, LegKind.MOVE, 4, 5 * OFF))


def test_half_a_turn_of_roll_on_a_straight_leg_may_go_either_way() -> None:
    """Where the short way round is in doubt, the checker takes the one that was gone."""
    limits = five_axis_arm().limits
    wide = np.array([0.0, 0.0, 0.0, 0.0, 4.0])
    robot = five_axis_arm(limits=replace(limits, lower=limits.lower - wide, upper=limits.upper + wide))
    for half in (math.pi, -math.pi):
        for beside in (-1e-3, -1e-15, 0.0, 1e-15, 1e-3):
            target = aim(0.3, 0.0, 0.35, pitch=-1.0, roll=START[4] + half + beside)
            scene = five_axis_cell(goes(target, leg="cartesian"), robot=robot)
            plan = made(scene)
            assert check(scene, plan).ok
            assert abs(np.ptp(plan.trajectory.q[:, 4]) - math.pi) < 2e-3


def test_a_hand_in_motion_does_not_match_a_point_to_which_it_keeps_its_attitude() -> None:
    scene, plan = honest(True)
    line, arrival = plan.trajectory, plan.arrivals[0]
    knot = int(np.argmin(np.abs(line.time - arrival.time)))
    qd = line.qd.copy()
    qd[knot, 4] += 1e-4
    wrong = found(scene, replace(plan, trajectory=Trajectory(line.time, line.q, qd, line.qdd)))
    assert Code.JOINTS in wrong
