"""Plans of an arm with pitch and roll: what is asked is met, what is free is chosen, what cannot be is told."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from assur.planner.checked import check
from assur.planner.errors import InputError
from assur.planner.frames.motion import Motion, Pose
from assur.planner.geometry.shapes import box
from assur.planner.laws import conveyor
from assur.planner.legs.tilt import PITCHES, pitch_free, tilt_of, tilts
from assur.planner.model.outcome import NotPlanned, Outcome, Planned
from assur.planner.model.refusal import Reason
from assur.planner.model.scene import Arch, Pick, Place, Scene, Tool
from assur.planner.pipeline import plan
from assur.planner.report.number_format import amount
from tests.planner.cells import amount_of, at, cell, frame, go, stands
from tests.planner.five_axis_cells import DOWN, HEIGHT, REACH, START, aim, five_axis_arm, five_axis_cell, follows, goes

BELT = frame("belt", conveyor(Pose(0.35, -0.3, 0.2, math.pi / 2), 0.15))


def planned(scene: Scene) -> Planned:
    outcome = plan(scene)
    assert isinstance(outcome, Planned), outcome
    assert check(scene, outcome.plan).ok
    return outcome


def refused(scene: Scene) -> NotPlanned:
    outcome = plan(scene)
    assert isinstance(outcome, NotPlanned), outcome
    return outcome


def hand(scene: Scene, outcome: Outcome, t: Any) -> Motion:
    """The flange's motion at times t."""
    assert isinstance(outcome, Planned)
    line = outcome.plan.trajectory
    found = scene.robot.link_motion(5, *(line.evaluate(np.asarray(t), order) for order in range(4)))
    assert found.tilted
    return found


def test_pitch_and_roll_that_are_asked_are_met_and_told() -> None:
    scene = five_axis_cell(goes(aim(0.35, 0.2, 0.25, pitch=-1.2, roll=-0.4)))
    outcome = planned(scene)
    arrival = outcome.plan.arrivals[0]
    assert (arrival.pitch, arrival.roll) == (-1.2, -0.4)
    met = hand(scene, outcome, arrival.time)
    assert met.tilt == pytest.approx([-1.2, -0.4], abs=1e-9)
    assert met.p == pytest.approx([0.35, 0.2, 0.25], abs=1e-9)


def test_a_full_turn_more_is_the_same_attitude() -> None:
    once = planned(five_axis_cell(goes(aim(0.35, 0.2, 0.25, pitch=DOWN, roll=0.4))))
    turned = planned(five_axis_cell(goes(aim(0.35, 0.2, 0.25, pitch=DOWN + 2 * math.pi, roll=0.4 - 2 * math.pi))))
    assert turned.plan.trajectory.q[-1] == pytest.approx(once.plan.trajectory.q[-1], abs=1e-9)


def test_a_free_roll_is_kept_and_a_free_pitch_chosen_once_for_a_whole_follow() -> None:
    scene = five_axis_cell(follows(aim(0.0, 0.0, 0.05, "belt"), 0.4), frames=(BELT,))
    outcome = planned(scene)
    arrival = outcome.plan.arrivals[0]
    choices = tilts(scene, scene.task[0], scene.start.q)
    assert (arrival.pitch, arrival.roll) in choices
    assert arrival.roll == START[4]
    during = hand(scene, outcome, np.linspace(arrival.time, arrival.until, 50))
    assert np.abs(during.tilt - during.tilt[0]).max() < 1e-5
    assert during.tilt[0].tolist() == pytest.approx([arrival.pitch, arrival.roll], abs=1e-9)
    assert np.abs(during.v - [0.0, 0.15, 0.0]).max() < 1e-3
    assert np.ptp(during.yaw) > 0.05  # the heading follows from the position
    assert np.ptp(outcome.plan.trajectory.q[:, 4]) == 0.0


def test_pitches_are_tried_from_the_arms_own_outwards() -> None:
    scene = five_axis_cell(goes(aim(0.35, 0.2, 0.25)))
    step, q = scene.task[0], np.array(START)
    found = [tilt for tilt in tilts(scene, step, q) if tilt is not None]
    assert len(found) == PITCHES + 1
    assert found[0] == tilt_of(scene.robot, q)
    away = [abs(math.remainder(pitch - found[0][0], 2 * math.pi)) for pitch, _ in found]
    assert all(a <= b for a, b in pairwise(away))
    assert {roll for _, roll in found} == {START[4]}
    assert min(abs(pitch - DOWN) for pitch, _ in found) < 1e-12
    # a pitch that the arm has already is not offered twice
    assert len(tilts(scene, step, np.array([0.0, 1.0, -1.0, 0.0, 0.0]))) == PITCHES
    asked = goes(aim(0.35, 0.2, 0.25, pitch=0.1))
    assert tilts(scene, asked, q) == ((0.1, START[4]),)
    assert pitch_free(scene, step)
    assert not pitch_free(scene, asked)


def test_an_arm_without_them_has_nothing_to_choose() -> None:
    scene = cell(go(0.4, 0.1))
    assert tilts(scene, scene.task[0], scene.start.q) == (None,)
    assert tilt_of(scene.robot, scene.start.q) is None
    assert not pitch_free(scene, scene.task[0])
    outcome = plan(scene)
    assert isinstance(outcome, Planned)
    assert (outcome.plan.arrivals[0].pitch, outcome.plan.arrivals[0].roll) == (None, None)


OUT = (0.46, 0.0, HEIGHT)
"""A tool point that a hand which points outwards reaches, and one that points down does not: 460 mm, and 410 + 72."""


def test_a_point_that_one_pitch_does_not_reach_is_refused_with_its_number_and_another_reaches_it() -> None:
    down = five_axis_cell(goes(aim(*OUT, pitch=DOWN)), explain_budget_s=60.0)
    answer = refused(down)
    assert (answer.reason, answer.proved) == (Reason.OUT_OF_REACH, True)
    assert answer.refusal is not None
    # the wrist, above the tool point, would have to be nearer: on the circle of 410 mm
    short = OUT[0] - math.sqrt(0.41**2 - 0.072**2)
    assert amount_of(answer.refusal) == pytest.approx(short, abs=OUT[0] / 400)
    assert "pitch of -90 deg" in answer.sentence
    assert answer.relaxation is not None
    assert (answer.relaxation.what, answer.relaxation.value) == ("pitch", "free")
    met = planned(five_axis_cell(goes(aim(*OUT)))).plan.arrivals[0]
    assert met.pitch is not None
    assert abs(met.pitch) < 1.2
    planned(five_axis_cell(goes(aim(*OUT, pitch=0.0))))


def test_a_point_that_no_pitch_reaches_is_refused_with_the_distance_that_is_missing() -> None:
    x, z = 0.55, 0.5
    answer = refused(five_axis_cell(goes(aim(x, 0.0, z))))
    assert (answer.reason, answer.proved) == (Reason.OUT_OF_REACH, True)
    assert answer.refusal is not None
    short = math.hypot(x, z - HEIGHT) - REACH
    assert amount_of(answer.refusal) == pytest.approx(short, abs=1e-12)
    assert answer.sentence == f"goal: the point is {amount(short, 'm')} out of reach at every pitch of the tool."


def test_a_point_within_reach_of_no_legal_pitch_is_refused_and_not_called_proved() -> None:
    """Only pitches that were looked at can be spoken of."""
    limits = five_axis_arm().limits
    stiff = replace(limits, lower=np.array([-2.6, 1.0, -2.2, -0.6, -3.1]), upper=np.array([2.6, 1.3, -1.5, -0.4, 3.1]))
    answer = refused(five_axis_cell(goes(aim(0.3, 0.0, 0.1)), robot=five_axis_arm(limits=stiff)))
    assert answer.reason in (Reason.JOINT_LIMIT, Reason.OUT_OF_REACH)
    assert not answer.proved
    asked = refused(five_axis_cell(goes(aim(0.3, 0.0, 0.3, pitch=-0.9)), robot=five_axis_arm(limits=stiff)))
    assert (asked.reason, asked.proved) == (Reason.JOINT_LIMIT, True)


def test_a_body_in_the_way_of_one_pitch_makes_the_arm_take_another() -> None:
    """A wall beside the point: the hand comes from above, for from the arm's own pitch it would be in the wall."""
    target = aim(0.38, 0.0, 0.2)
    free = planned(five_axis_cell(goes(target))).plan.arrivals[0]
    wall = stands("wall", box(0.04, 0.3, 0.06), 0.32, 0.0, 0.2)
    other = planned(five_axis_cell(goes(target), bodies=(wall,), max_candidates=2000)).plan.arrivals[0]
    assert free.pitch == pytest.approx(sum(START[1:4]))
    assert other.pitch is not None
    assert other.pitch < -1.2


def test_the_lower_bound_counts_what_is_asked_and_claims_nothing_of_pitches_not_looked_at() -> None:
    asked = planned(five_axis_cell(goes(aim(0.35, 0.2, 0.25, pitch=DOWN))))
    line = asked.plan.trajectory
    assert asked.lower_bound_s is not None
    assert 0.5 * (line.end - line.start) < asked.lower_bound_s <= line.end - line.start
    # of a free pitch the heading alone counts
    free = planned(five_axis_cell(goes(aim(0.35, 0.2, 0.25))))
    assert free.lower_bound_s is not None
    assert free.lower_bound_s < asked.lower_bound_s
    # between two points whose pitch and roll are asked the second way counts, too
    far = aim(0.25, -0.3, 0.3, pitch=-1.0, roll=0.0)
    two = planned(five_axis_cell(goes(aim(0.35, 0.2, 0.25, pitch=DOWN, roll=0.3)), goes(far, "far")))
    assert two.lower_bound_s is not None
    assert asked.lower_bound_s < two.lower_bound_s <= two.plan.trajectory.end
    # a roll in motion could be met at another angle sooner
    rolling = five_axis_cell(goes(aim(0.35, 0.2, 0.25, pitch=DOWN)), qd=(0.0, 0.0, 0.0, 0.0, 1.0))
    moving = planned(rolling)
    assert moving.lower_bound_s is not None
    assert moving.lower_bound_s <= moving.plan.trajectory.end


def test_a_straight_leg_from_a_follow_begins_with_the_attitude_of_the_follow() -> None:
    task = (
        follows(aim(0.0, 0.0, 0.05, "belt", pitch=DOWN, roll=0.3)),
        goes(aim(0.3, 0.2, 0.4, pitch=-1.0, roll=0.0), leg="cartesian"),
    )
    scene = five_axis_cell(*task, frames=(BELT,))
    outcome = planned(scene)
    leg = outcome.plan.legs[-1]
    moved = hand(scene, outcome, np.array([leg.t0, leg.t1]))
    assert moved.tilt[0] == pytest.approx([DOWN, 0.3], abs=1e-9)
    assert moved.tilt[1] == pytest.approx([-1.0, 0.0], abs=1e-9)


def test_a_point_is_flown_by_with_its_pitch_and_the_next_one_met() -> None:
    scene = five_axis_cell(
        goes(aim(0.35, -0.1, 0.35, pitch=-1.2), "by", via=True), goes(aim(0.3, 0.2, 0.25, pitch=DOWN, roll=0.0))
    )
    outcome = planned(scene)
    by, goal = outcome.plan.arrivals
    assert hand(scene, outcome, by.time).tilt == pytest.approx([-1.2, START[4]], abs=1e-9)
    assert hand(scene, outcome, goal.time).tilt == pytest.approx([DOWN, 0.0], abs=1e-9)
    assert np.abs(hand(scene, outcome, by.time).v).max() > 0.01


PICK = Pick("pick", "part", Pose(), 0.03, 0.1, 0.03)
PLACE = Place("place", "part", at(0.3, 0.2), 0.03, 0.1, 0.03)
PART = stands("part", box(0.02, 0.02, 0.02), 0.35, 0.0, 0.2)


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda: five_axis_cell(PICK, PLACE, bodies=(PART,)), "turns and tilts its tool"),
        (lambda: five_axis_cell(goes(aim(0.35, 0.2, 0.25), arch=Arch(0.4))), "no joint that lifts"),
        (lambda: five_axis_cell(goes(aim(0.35, 0.2, 0.25)), tool=Tool(Pose(0.05))), "flange of five tilts"),
        (lambda: five_axis_cell(goes(aim(0.35, 0.2, 0.25, pitch=math.nan))), "a finite angle"),
        (lambda: five_axis_cell(goes(aim(0.35, 0.2, 0.25, roll=math.inf))), "a finite angle"),
        (lambda: cell(goes(aim(0.35, 0.2, 0.1, pitch=0.0))), "no pitch"),
        (lambda: cell(goes(aim(0.35, 0.2, 0.1, roll=0.0))), "no roll"),
    ],
)
def test_what_is_not_for_such_an_arm_or_not_for_others_is_refused_in_words(make: Any, match: str) -> None:
    with pytest.raises(InputError, match=match):
        make()
