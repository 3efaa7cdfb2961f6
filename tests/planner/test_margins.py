"""What a plan leaves: peaks, what binds, the smallest clearance."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from assur.planner.claim.columns import LINK, LINK_OFFSET
from assur.planner.collision.nearest import nearest
from assur.planner.collision.proof import Prover
from assur.planner.errors import FaultError
from assur.planner.geometry.shapes import box
from assur.planner.kernels.links import CHAIN, LINKS
from assur.planner.kernels.postures import sample_tool_peaks
from assur.planner.legs.limits import least_margins
from assur.planner.legs.tool_motion import tool_peaks as tool_peaks_of
from assur.planner.model.outcome import Clearances, LegKind, Planned
from assur.planner.model.phases import Phase, phases
from assur.planner.model.scene import Scene
from assur.planner.pipeline import plan
from assur.planner.report.margins import contacts
from assur.planner.report.notes import binding_limit
from assur.planner.robots.facts import Limits
from assur.planner.trajectory import Trajectory
from tests.planner.cells import CUP, arm, belt_and_dial, cell, go, stands, table_to_table
from tests.planner.certificate.moving_ball import LAWS, SHAPES, encounter
from tests.planner.robots.five_bars import five_bar


@settings(max_examples=50)
@given(st.integers(0, 10**6), st.sampled_from(SHAPES), st.sampled_from(LAWS), st.integers(1, 3))
def test_the_smallest_clearance_is_below_the_truth_by_no_more_than_a_twentieth_of_a_millimetre(
    seed: int, kind: str, how: str, pieces: int
) -> None:
    case = encounter(seed, kind, how, pieces)
    radius = max(0.002, case.nearest()[0] - 0.003)
    scene = case.scene(radius)
    found = nearest(Prover(scene), case.path, (case.phase(),))
    assert found is not None
    assert found.bodies == ("ball", "thing")
    there = float(case.apart(np.array([found.time]))[0]) - radius
    # what dense sampling finds is never below the truth, and by less than 10 µm above it
    least = max(0.0, case.nearest()[0] - radius)
    assert least - 5e-5 - 1e-5 <= found.gap_m <= least + 1e-9
    assert found.distance_m == pytest.approx(max(0.0, there), abs=1e-6)
    assert 0.0 <= found.distance_m - found.gap_m <= 5e-5


def test_allowed_contacts_are_not_the_smallest_clearance() -> None:
    q = np.array([0.3, 1.2, 0.15, 0.0])
    path = Trajectory(np.array([0.0, 1.0]), np.stack([q, q]), np.zeros((2, 4)), np.zeros((2, 4)))
    plate = stands("plate", box(2.0, 2.0, 0.02), 0.0, 0.0, 0.15 - 0.06 - 0.01)
    scene = cell(go(0.3, 0.0), bodies=(plate,), tool=CUP)
    phase = Phase(0.0, 1.0, LegKind.FOLLOW, 0)
    found = nearest(Prover(scene), path, (phase,))
    assert found is not None
    assert found.bodies == ("cup", "plate")
    assert found.gap_m == pytest.approx(0.0, abs=1e-12)
    touching = replace(phase, contacts=frozenset({("cup", "plate")}))
    found = nearest(Prover(scene), path, (touching,))
    assert found is not None
    assert found.bodies == ("quill", "plate")
    assert found.gap_m == pytest.approx(0.06)
    assert found.phase is LegKind.FOLLOW


def test_with_nothing_around_there_is_no_smallest_clearance() -> None:
    outcome = plan(cell(go(0.35, -0.2)))
    assert isinstance(outcome, Planned)
    assert outcome.margins.nearest is None


def test_what_binds_is_told_with_the_leg_in_which_it_is_used_most() -> None:
    scene = cell(go(0.35, -0.2), go(0.2, 0.4, name="b"))
    outcome = plan(scene)
    assert isinstance(outcome, Planned)
    found, path = outcome.margins.busiest, outcome.plan.trajectory
    assert found is not None
    kind, joint = outcome.margins.binds.rsplit(" (", 1)[0].split(" of ")
    number = [each.name for each in scene.robot.joints].index(joint)
    order = {"velocity": 1, "acceleration": 2, "jerk": 3}[kind]
    t = np.linspace(path.start, path.end, 100001)[:-1]
    used = np.abs(path.evaluate(t, order)[:, number])
    at_peak = used >= 0.99 * used.max()
    long = {
        (leg.kind, leg.step, leg.t0, leg.t1): float(at_peak[(t >= leg.t0) & (t < leg.t1)].sum() * (t[1] - t[0]))
        for leg in outcome.plan.legs
    }
    most = max(long, key=lambda leg: long[leg])
    assert (found.kind, found.step, found.t0, found.t1) == most
    assert found.at_limit_s == pytest.approx(long[most], abs=0.004)
    assert len(long) > 1
    assert joint in outcome.margins.helps


def test_a_short_report_has_the_smallest_clearances_alone_and_none_has_nothing() -> None:
    scene = table_to_table(go(0.3, 0.0, 0.15))
    reports: tuple[Literal["none", "short", "full"], ...] = ("full", "short", "none")
    full, short, none = (plan(replace(scene, options=replace(scene.options, report=word))) for word in reports)
    assert isinstance(full, Planned)
    assert isinstance(short, Planned)
    assert isinstance(none, Planned)
    assert short.reported == Clearances(full.margins.nearest, full.margins.placed)
    assert (short.lower_bound_s, short.warnings, none.reported) == (None, (), None)
    with pytest.raises(FaultError):
        _ = short.margins


def test_contacts_of_phases_in_a_row_are_one() -> None:
    outcome = plan(belt_and_dial(go(0.35, 0.0, 0.12)))
    assert isinstance(outcome, Planned)
    of_plan = phases(belt_and_dial(go(0.35, 0.0, 0.12)), outcome.plan.legs, outcome.plan.arrivals)
    found = contacts(of_plan)
    legs = {(leg.kind, leg.step): leg for leg in outcome.plan.legs}
    by_pair = {contact.bodies: contact for contact in found if contact.t0 < legs[LegKind.MOVE, 1].t0}
    cup = by_pair["cup", "part"]
    assert cup.t0 == legs[LegKind.APPROACH, 0].t0
    assert cup.t1 == legs[LegKind.FOLLOW, 0].t1
    for contact in found:
        assert contact.bodies == tuple(sorted(contact.bodies))
        assert contact.t0 < contact.t1


def test_of_both_sides_of_a_jump_the_larger_counts_unless_it_is_outside() -> None:
    """Joint 1 speeds up at 1 rad/s² for a second, then brakes at 2: the tool point goes round the base."""
    scene = cell(go(0.35, -0.2))
    q, v, a = np.zeros((3, 4, 4))
    q[:, 0], v[:, 0], a[:, 0] = [0.0, 0.5, 0.5, 0.75], [0.0, 1.0, 1.0, 0.0], [1.0, 1.0, -2.0, -2.0]
    path = Trajectory(np.array([0.0, 1.0, 1.0, 1.5]), q, v, a, jumps=True)
    reach = float(np.hypot(*scene.robot.forward(np.zeros(4))[0][:2]))
    for end, pull, least in ((1.5, 5.0, 0.0), (1.5, 5.0, 1.0), (1.0, 2.0, 0.0)):
        found = tool_peaks_of(scene, path, least, end)
        assert (found.speed, found.speed_time) == pytest.approx((reach, 1.0))
        assert (found.acceleration, found.acceleration_time) == pytest.approx((np.sqrt(pull) * reach, 1.0))


def test_a_peak_of_what_is_not_known_is_not_a_number() -> None:
    scene = cell(go(0.35, -0.2))
    row = scene.robot.row.copy()
    row[CHAIN + LINK_OFFSET : CHAIN + LINK * int(row[LINKS]) : LINK] = np.nan
    path = Trajectory(np.array([0.0, 1.0]), *np.zeros((3, 2, 4)))
    peaks = np.zeros(4)
    sample_tool_peaks(row, path.edges, path.coefficients, 0.0, 0.0, 0.0, 1.0, 0.1, 8, peaks)
    assert np.isnan(peaks[[0, 2]]).all()


def test_the_least_margin_is_found_between_instants() -> None:
    """The elbow passes through a straight arm between two instants, or turns round just before one."""
    scene = cell(go(0.35, -0.2))
    for through, least in ((-0.4, 0.0), (0.3, np.sin(0.3))):
        q = np.zeros((3, 4))
        q[:, 1] = 0.8, through, 0.8
        path = Trajectory(np.array([0.0, 0.5003, 1.0]), q, np.zeros((3, 4)), np.zeros((3, 4)))
        serial, parallel = least_margins(scene.robot, path, np.linspace(0.0, 1.0, 101))
        assert serial[0] == pytest.approx(least, abs=1e-6)
        assert scene.robot.margin(path.evaluate(serial[1])) == serial[0]
        assert parallel is None


def test_a_singular_position_that_is_passed_is_found_beside_a_margin_that_is_small_for_longer() -> None:
    scene, q = cell(go(0.35, -0.2)), np.zeros((4, 4))
    q[:, 1] = 0.8, 0.004, 0.8, -0.8
    path = Trajectory(np.array([0.0, 0.5, 1.0, 1.5]), q, np.zeros((4, 4)), np.zeros((4, 4)))
    t = np.linspace(0.0, 1.5, 150)
    sizes = scene.robot.margin(path.evaluate(t))
    assert sizes[:75].min() < sizes[75:].min()
    assert least_margins(scene.robot, path, t)[0][0] == pytest.approx(0.0, abs=1e-6)


def test_a_margin_of_what_is_not_known_is_not_a_number() -> None:
    arm = replace(five_bar("odd"), separation=0.6)
    q = np.zeros((2, 4))
    q[:, :2] = (np.pi / 2, -np.pi / 2)  # the couplers do not reach each other
    path = Trajectory(np.array([0.0, 1.0]), q, np.zeros((2, 4)), np.zeros((2, 4)))
    serial, parallel = least_margins(arm, path, np.linspace(0.0, 1.0, 11))
    assert np.isnan(serial[0])
    assert parallel is not None
    assert np.isnan(parallel[0])


JOINTS = [joint.name for joint in arm().joints]


def bound(rate: float, bend: float, joint: int) -> str:
    """What binds a motion of one joint with this velocity at first and this acceleration, for 0.1 s."""
    t, one = np.linspace(0.0, 0.1, 11), np.eye(4)[joint]
    q = np.array([0.3, 1.2, 0.15, 0.0]) + np.outer(rate * t + 0.5 * bend * t**2, one)
    path = Trajectory(t, q, np.outer(rate + bend * t, one), np.outer(np.full(11, bend), one))
    return binding_limit(cell(go(0.3, 0.0)), path, Phase(0.0, 0.1, LegKind.MOVE, 0))


def test_a_limit_binds_a_motion_that_is_at_it_for_most_of_the_time() -> None:
    assert bound(7.7, 0.0, 0) == "velocity of theta1"
    assert bound(-7.7, 0.0, 0) == "velocity of theta1"
    assert bound(0.0, 79.0, 1) == "acceleration of theta2"
    assert bound(6.8, 0.0, 0) == ""
    assert bound(6.4, 30.0, 1) == ""  # at 0.9 of its limit of velocity for a third of the time


@pytest.mark.parametrize("x", [-0.3, 0.1, 0.35])
def test_a_motion_is_quicker_with_higher_limits_of_the_joint_that_binds_it_and_not_of_the_others(x: float) -> None:
    def planned(*higher: int) -> tuple[Scene, Planned]:
        own, factor = arm().limits, np.where(np.isin(np.arange(4), higher), 1.5, 1.0)
        rates = (own.velocity * factor, own.acceleration * factor, own.jerk * factor)
        scene = cell(go(x, 0.4), robot=replace(arm(), limits=Limits(own.lower, own.upper, *rates)), elbow="keep")
        outcome = plan(scene)
        assert isinstance(outcome, Planned)
        return scene, outcome

    scene, first = planned()
    words = binding_limit(scene, first.plan.trajectory, phases(scene, first.plan.legs, first.plan.arrivals)[0])
    joint, lasts_s = JOINTS.index(words.split(" of ")[1]), first.plan.trajectory.duration
    assert planned(joint)[1].plan.trajectory.duration < 0.98 * lasts_s
    assert planned(*{0, 1, 2, 3} - {joint})[1].plan.trajectory.duration == pytest.approx(lasts_s, rel=1e-3)


def test_the_acceleration_of_a_part_that_is_carried_may_bind() -> None:
    scene = table_to_table(carry=2.0)
    outcome = plan(scene)
    assert isinstance(outcome, Planned)
    found = {
        phase.step: binding_limit(scene, outcome.plan.trajectory, phase)
        for phase in phases(scene, outcome.plan.legs, outcome.plan.arrivals)
        if phase.kind is LegKind.MOVE
    }
    assert found[1] == "acceleration of the carried part"
    assert found[0].split(" of ")[1] in JOINTS
