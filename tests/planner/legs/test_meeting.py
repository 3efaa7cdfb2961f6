"""Branches of a control point: every way in which the arm can be there, and why others are not."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.experiments.differential import jacobian
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import box
from assur.planner.laws import Change, conveyor, fixed, linear, turntable
from assur.planner.laws.belt_window import HORIZON_S
from assur.planner.legs.control_point import control_point
from assur.planner.legs.meeting import LOOK_AHEAD_S, Meetings, meeting_times, meetings
from assur.planner.legs.missed import holds_for_all_times
from assur.planner.model.attachments import AT_START
from assur.planner.model.outcome import NotPlanned
from assur.planner.model.refusal import BeyondRange, LawEnds, Reason, Stage
from assur.planner.model.scene import Follow, Pick, Scene, Step, Window
from assur.planner.model.scene import WorldBody as Around
from assur.planner.model.window_missed import FOR_ALL_TIMES, Miss, WindowMissed
from assur.planner.pipeline import plan
from tests.planner.cells import amount_of, arm, at, cell, frame, go, solid, unit_of


def met(scene: Scene, modes: tuple[int, ...] = (0, 1), earliest: float = 0.0, lead: float = 0.0) -> Meetings:
    point = control_point(scene, 0, AT_START, 0.0)
    return meetings(scene, point, earliest, lead, modes)


DIAL = frame("dial", turntable(Pose(0.35, 0.1, 0.05, 0.3), 1.0))


@given(st.floats(0.0, 0.25), st.floats(-3, 3))
def test_every_legal_row_of_every_branch_puts_the_flange_at_the_point(r: float, yaw: float) -> None:
    scene = cell(go(r, 0.0, 0.06, yaw, "dial"), frames=(DIAL,), singularity_margin=0.0)
    found = met(scene)
    for branch in found.branches:
        rows = np.arange(len(branch.time))[::37]
        p, turn = scene.robot.forward(branch.q[rows])
        wanted = DIAL.law.motion(branch.time[rows]).at(Pose(r, 0.0, 0.06, yaw))
        assert np.abs(p - wanted.p).max() <= 1e-9
        assert np.abs(np.sin((turn - wanted.yaw) / 2)).max() <= 1e-9
        assert scene.robot.within(branch.q[rows]).all()
        assert (scene.robot.mode_of(branch.q[rows]) == branch.mode).all()
        # velocities by the Jacobian, not by the inverse
        rates = (jacobian(scene.robot, branch.q[rows]) @ branch.qd[rows][..., None])[..., 0]
        assert np.abs(rates[:, :3] - wanted.v).max() <= 1e-8
        assert np.abs(rates[:, 3] - wanted.yaw_d).max() <= 1e-8


def test_all_modes_and_turns_within_the_range_are_branches() -> None:
    for j4, turns in ((2 * math.pi, 2), (math.pi, 1), (4 * math.pi, 4)):
        found = met(cell(go(0.35, 0.2, 0.1, 0.5), robot=arm(j4=j4)))
        assert sorted(branch.mode for branch in found.branches) == [0] * turns + [1] * turns
        q = np.array([branch.q[0] for branch in found.branches if branch.mode == 0])
        assert len({round(float(x) / 1e-6) for x in q[:, 3]}) == turns
        assert np.abs(np.diff(np.sort(q[:, 3])) - 2 * math.pi).max(initial=0.0) <= 1e-9


def test_what_is_out_of_reach_beyond_a_limit_or_near_singular_says_so_with_a_number() -> None:
    far = met(cell(go(0.7, 0.0)))
    assert [refusal.reason for refusal in far.refusals] == [Reason.OUT_OF_REACH] * 2
    assert amount_of(far.refusals[0]) == pytest.approx(0.1, abs=1e-9)  # beyond 325 and 275 mm
    high = met(cell(go(0.35, 0.2, 0.27)))
    assert {refusal.reason for refusal in high.refusals} == {Reason.JOINT_LIMIT}
    assert high.refusals[0].joint == "z"
    assert amount_of(high.refusals[0]) == pytest.approx(0.02)
    assert unit_of(high.refusals[0]) == "m"
    behind = met(cell(go(-0.5, -0.0, 0.1)))
    assert Reason.JOINT_LIMIT in {refusal.reason for refusal in behind.refusals}
    near = met(cell(Follow("f", at(0.599, 0.0), 0.1), singularity_margin=0.2))
    assert {refusal.reason for refusal in near.refusals} == {Reason.NEAR_SINGULARITY}
    theta2 = math.acos((0.599**2 - 0.325**2 - 0.275**2) / (2 * 0.325 * 0.275))
    assert amount_of(near.refusals[0]) == pytest.approx(0.2 - math.sin(theta2), abs=1e-9)


@pytest.mark.parametrize(
    ("z", "missing", "above"),
    [(-0.03, 0.08, 0.0), (0.26, 0.04, 0.03)],
)
def test_a_height_that_is_missing_is_that_of_the_point_or_of_its_approach_whichever_is_more(
    z: float, missing: float, above: float
) -> None:
    """From 50 to 250 mm is the lift's; also where the point moves."""
    for law in (conveyor(Pose(0.3, 0.2, z), 0.1), conveyor(Pose(0.3, 0.2, z), 0.0), fixed(Pose(0.3, 0.2, z))):
        scene = cell(
            Pick("take", "part", Pose(), 0.03, 0.0, 0.0),
            bodies=(Around(solid("part", box(0.02, 0.02, 0.02)), "tray"),),
            frames=(frame("tray", law),),
            singularity_margin=0.0,
        )
        refusals = met(scene, lead=0.1).refusals
        assert len(refusals) == 2
        for refusal in refusals:
            assert (refusal.reason, refusal.joint) == (Reason.JOINT_LIMIT, "z")
            assert amount_of(refusal) == pytest.approx(missing)
            assert isinstance(refusal.facts, BeyondRange)
            assert refusal.facts.above_m == above


def test_a_point_met_at_rest_does_not_ask_for_a_margin() -> None:
    assert met(cell(go(0.599, 0.0), singularity_margin=0.2)).branches


def test_a_window_that_opens_long_after_the_start_is_not_missed() -> None:
    late = 2 * LOOK_AHEAD_S
    scene = cell(go(0.1, 0.0, 0.06, 0.0, "dial", window=Window(time=(late, late + 1.0))), frames=(DIAL,))
    found = met(scene)
    assert found.branches, found.refusals
    assert late <= found.branches[0].time[0]
    assert found.branches[0].time[-1] <= late + 1.0


def test_a_part_that_comes_late_on_a_slow_belt_is_not_missed() -> None:
    belt = frame("belt", conveyor(Pose(-0.5, 0.35, 0.05), 0.01))
    scene = cell(go(0.0, 0.0, 0.05, 0.0, "belt", window=Window(along=(0.4, 0.6))), frames=(belt,))
    found = met(scene)
    assert found.branches, found.refusals
    assert meeting_times(found.point, 0.0, 0.0)[0] == pytest.approx(40.0, abs=1e-6)
    assert found.branches[0].time[0] >= 40.0


def test_tracking_begins_a_lead_after_the_meeting() -> None:
    scene = cell(Follow("f", at(0.1, 0.0, 0.06, 0.0, "dial"), 0.1, Window(time=(1.0, 2.0))), frames=(DIAL,))
    found = met(scene, lead=0.3)
    time = found.branches[0].time
    assert time[0] == pytest.approx(0.7)
    assert time[-1] == pytest.approx(1.6)


def test_a_window_that_is_over_or_too_short_says_by_how_much() -> None:
    over = met(cell(go(0.1, 0.0, 0.06, 0.0, "dial", window=Window(time=(0.0, 1.0))), frames=(DIAL,)), earliest=1.4)
    assert over.refusals[0].reason is Reason.WINDOW_MISSED
    assert amount_of(over.refusals[0]) == pytest.approx(0.4)
    belt = frame("belt", conveyor(Pose(-0.3, 0.35, 0.05), 0.5))
    short = met(cell(Follow("f", at(0.0, 0.0, 0.05, 0.0, "belt"), 0.5, Window(along=(0.2, 0.3))), frames=(belt,)))
    assert short.refusals[0].reason is Reason.WINDOW_MISSED
    assert amount_of(short.refusals[0]) == pytest.approx(0.3)
    facts = short.refusals[0].facts
    assert isinstance(facts, WindowMissed)
    assert facts.miss is Miss.TOO_SHORT
    assert (facts.open_s, facts.needed_s, facts.belt_m) == pytest.approx((0.2, 0.5, 0.15))


BELT = frame("belt", conveyor(Pose(-0.3, 0.35, 0.05), 0.2))
"""A point at its origin is between 0.1 and 0.6 m from 0.5 to 3 s."""


@pytest.mark.parametrize(
    ("window", "latest", "missing", "miss"),
    [
        (Window(time=(0.0, 0.3), along=(0.1, 0.6)), None, 0.2, Miss.NO_COMMON_INSTANT),
        (Window(time=(4.0, 4.5), along=(0.1, 0.6)), None, 1.0, Miss.NO_COMMON_INSTANT),
        (Window(time=(0.0, 4.0), along=(0.1, 0.6)), 0.4, 0.1, Miss.ENTERS_AFTER_LATEST_END),
        (Window(time=(4.0, 5.0)), 3.0, 1.0, Miss.OPENS_AFTER_LATEST_END),
        (Window(time=(-3.0, -1.0)), None, 1.0, Miss.OVER_BEFORE_START),
        (Window(along=(-0.2, -0.1)), None, 0.1, Miss.NEVER_INSIDE),
        # what cannot be said for all times has no number
        (Window(time=(60.5, 70.0), along=(0.1, 0.6)), None, math.nan, Miss.NOT_INSIDE_SOON),
    ],
)
def test_windows_that_never_open_say_how_far_they_are_from_it(
    window: Window, latest: float | None, missing: float, miss: Miss
) -> None:
    scene = cell(go(0.0, 0.0, 0.05, 0.0, "belt", window=window), frames=(BELT,), latest_end_s=latest)
    (refusal,) = met(scene).refusals
    assert refusal.reason is Reason.WINDOW_MISSED
    assert amount_of(refusal) == pytest.approx(missing, nan_ok=True)
    assert isinstance(refusal.facts, WindowMissed)
    assert refusal.facts.miss is miss
    assert (miss in FOR_ALL_TIMES) == math.isfinite(missing)


def test_a_window_that_may_open_when_the_law_has_ended_has_no_number() -> None:
    ends = frame("belt", linear(Pose(-0.3, 0.35, 0.05), (0.2, 0.0, 0.0), valid=(0.0, 5.0)))
    window = Window(time=(4.0, 7.0), along=(0.1, 0.6))
    (refusal,) = met(cell(go(0.0, 0.0, 0.05, 0.0, "belt", window=window), frames=(ends,))).refusals
    assert math.isnan(amount_of(refusal))
    assert isinstance(refusal.facts, WindowMissed)
    assert refusal.facts.miss not in FOR_ALL_TIMES


TOO_SOON = frame("belt", linear(Pose(-0.3, 0.35, 0.05), (0.2, 0.0, 0.0), valid=(0.0, 5.0)))


@pytest.mark.parametrize(
    ("step", "needed"),
    [
        (go(0.0, 0.0, 0.05, 0.0, "belt", window=Window(time=(6.0, 7.0))), 6.0),
        (go(0.0, 0.0, 0.05, 0.0, "belt", window=Window(along=(1.1, 1.5))), 5.5),
        (Follow("f", at(0.0, 0.0, 0.05, 0.0, "belt"), 0.5, Window(along=(0.9, 1.5))), 5.0),
        (Follow("f", at(0.0, 0.0, 0.05, 0.0, "belt"), 0.6, Window(along=(0.9, 1.5))), 5.1),
        (Follow("f", at(0.0, 0.0, 0.05, 0.0, "belt"), 5.5), 5.5),
    ],
)
def test_a_law_that_ends_too_soon_is_what_refuses(step: Step, needed: float) -> None:
    """... and not the window, which would be open for long enough; at the very end of the law nothing is refused."""
    (*refusals,) = met(cell(step, frames=(TOO_SOON,))).refusals
    if needed == 5.0:
        assert all(refusal.stage is not Stage.WINDOW for refusal in refusals)
        return
    (refusal,) = refusals
    assert (refusal.reason, refusal.frame) == (Reason.LAW_ENDS, "belt")
    assert isinstance(refusal.facts, LawEnds)
    assert refusal.facts.known_s == (0.0, 5.0)
    assert refusal.facts.needed_s == pytest.approx(needed)
    assert refusal.facts.tracked_s == step.dwell_s
    assert holds_for_all_times(refusal)


def test_a_window_that_is_too_short_is_not_put_down_to_a_law_that_ends() -> None:
    short = Follow("f", at(0.0, 0.0, 0.05, 0.0, "belt"), 3.0, Window(time=(4.0, 5.5)))
    (refusal,) = met(cell(short, frames=(TOO_SOON,))).refusals
    assert (refusal.reason, refusal.facts) == (Reason.WINDOW_MISSED, refusal.facts)
    assert isinstance(refusal.facts, WindowMissed)
    assert refusal.facts.miss is Miss.TOO_SHORT


def test_an_arm_that_comes_too_late_for_a_law_that_ends_proves_nothing() -> None:
    late = met(cell(Follow("f", at(0.0, 0.0, 0.05, 0.0, "belt"), 4.0), frames=(TOO_SOON,)), earliest=1.5)
    (refusal,) = late.refusals
    assert (refusal.reason, refusal.frame) == (Reason.LAW_ENDS, "belt")
    assert isinstance(refusal.facts, LawEnds)
    assert refusal.facts.on_arrival
    assert refusal.facts.needed_s == pytest.approx(5.5)
    assert not holds_for_all_times(refusal)


def test_an_arm_that_comes_too_late_for_the_latest_end_is_refused_for_that_and_not_for_a_window() -> None:
    (late,) = met(cell(go(0.0, 0.0, 0.05, 0.0, "belt"), frames=(BELT,), latest_end_s=1.0), earliest=1.4).refusals
    assert isinstance(late.facts, WindowMissed)
    assert late.facts.miss is Miss.LATEST_END_ON_ARRIVAL
    assert amount_of(late) == pytest.approx(0.4)


LATER = (Change(70.0, -0.25, 1.0, 100.0),)
"""The belt comes back, but only after all times that are searched."""


@pytest.mark.parametrize(
    ("changes", "step", "miss"),
    [
        (LATER, Follow("f", at(0.5, 0.0, 0.05, 0.0, "belt"), 0.2, Window(along=(-0.3, 0.3))), Miss.NOT_INSIDE_SOON),
        (LATER, Follow("f", at(0.0, 0.0, 0.05, 0.0, "belt"), 1.0, Window(along=(0.2, 0.3))), Miss.TOO_SHORT),
    ],
)
def test_what_is_searched_for_a_minute_only_is_proved_of_no_longer_time(
    changes: tuple[Change, ...], step: Follow, miss: Miss
) -> None:
    moves = frame("belt", conveyor(Pose(-0.3, 0.35, 0.05), 0.2, changes=changes))
    (refusal,) = met(cell(step, frames=(moves,))).refusals
    assert isinstance(refusal.facts, WindowMissed)
    assert (refusal.facts.miss, refusal.facts.searched_s) == (miss, HORIZON_S)
    outcome = plan(cell(step, frames=(moves,)))
    assert isinstance(outcome, NotPlanned)
    assert not outcome.proved
    steady = frame("belt", conveyor(Pose(-0.3, 0.35, 0.05), 0.2))
    known = plan(cell(step, frames=(steady,)))
    assert isinstance(known, NotPlanned)
    assert known.proved
