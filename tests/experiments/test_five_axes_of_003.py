"""Source 003, section 5: its five-axis solution, mended, and what was wrong with it."""

from __future__ import annotations

import numpy as np
import pytest

from assur.experiments import printed_five_axes, rv_m1
from tests.experiments.results import result


def test_the_mended_solution_is_the_planners_and_the_printed_one_sees_no_wrist_behind_the_base_axis() -> None:
    numbers = result("rv-m1").numbers
    assert numbers["solved_by_both"] == numbers["targets"]
    assert numbers["mended_minus_planner_times_sine_rad"] <= 1e-13
    assert numbers["as_printed_equals_mended_wrist_in_front"]
    assert 0 < numbers["wrist_behind_the_base_axis"] < numbers["targets"] / 5
    assert numbers["as_printed_error_deg_wrist_behind"][0] > 0
    assert numbers["as_printed_error_deg_wrist_behind"][1] > 90


def test_the_family_of_pitches_ends_where_the_wrist_leaves_the_reach_of_the_dyad() -> None:
    numbers, robot = result("rv-m1").numbers, rv_m1.arm()
    rho, h = rv_m1.SHOWN[0], rv_m1.SHOWN[1] - robot.height
    # the wrist at a distance of l1 + l2: the law of cosines at the tool point
    cosine = (rho**2 + h**2 + robot.l3**2 - (robot.l1 + robot.l2) ** 2) / (2 * robot.l3 * np.hypot(rho, h))
    middle, half = np.degrees(np.arctan2(h, rho)), np.degrees(np.arccos(cosine))
    assert numbers["family_pitches_in_reach_deg"] == pytest.approx([middle - half, middle + half], abs=0.25)
    low, high = numbers["family_pitches_within_limits_elbow_up_deg"]
    assert middle - half < low < high < middle + half
    assert numbers["family_pitches_within_limits_elbow_down"] == 0


def test_a_hand_that_points_straight_down_has_its_wrist_above_the_tool_point() -> None:
    x, y, z, pitch = (np.array([value]) for value in (0.3, 0.1, 0.2, -np.pi / 2))
    base, r, height = printed_five_axes.wrist(x, y, z, pitch, 0.072)
    assert base == pytest.approx(np.arctan2(0.1, 0.3))
    assert r == pytest.approx(np.hypot(0.3, 0.1))
    assert height == pytest.approx(0.272)
    solved = printed_five_axes.joints(base, r, height, pitch, np.array([0.4]), (0.3, 0.25, 0.16))[0]
    reached = 0.25 * np.exp(1j * solved[1]) + 0.16 * np.exp(1j * solved[1:3].sum())
    reached += 0.072 * np.exp(1j * solved[1:4].sum())
    assert reached == pytest.approx(complex(np.hypot(0.3, 0.1), 0.2 - 0.3))
    assert solved[1:4].sum() == pytest.approx(-np.pi / 2)
    assert solved[4] == 0.4


def test_behind_the_base_axis_only_the_mended_radius_has_a_sign() -> None:
    x, pitch = np.array([0.03]), np.array([0.0])
    zero = np.zeros(1)
    assert printed_five_axes.wrist(x, zero, zero, pitch, 0.072)[1] == pytest.approx(-0.042)
    assert printed_five_axes.printed_radius(x, zero, pitch, 0.072) == pytest.approx(0.042)
