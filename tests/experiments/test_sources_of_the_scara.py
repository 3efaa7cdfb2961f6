"""Numbers of the experiments on the SCARA: what the papers claim, and what holds as mended and fails as printed."""

from __future__ import annotations

import numpy as np
import pytest

from assur.experiments import modes, printed_dh, printed_triangles
from assur.experiments import oblique_triangles as triangles
from assur.experiments.printed_joint_move import ParabolicBlend, inverse
from tests.experiments.results import result


def test_the_spiral_is_the_same_by_the_paper_by_the_dyad_and_as_a_plan_that_dwells_on_it() -> None:
    numbers = result("spiral").numbers
    assert max(numbers["printed_minus_planner_rad_m"]) <= 1e-13
    assert numbers["singular_samples"] == 0
    assert numbers["range_l3_mm"] == pytest.approx([20.0, 100.0], abs=1e-9)
    # Nearest and farthest: 80 and 120 mm, by the law of cosines.
    stretched, folded = (np.degrees(np.arccos((d**2 - 80**2 - 50**2) / 8000)) for d in (120, 80))
    assert numbers["range_theta2_deg"] == pytest.approx([-folded, -stretched], abs=1e-3)
    assert numbers["margin_least"] == pytest.approx(np.sin(np.radians(stretched)), abs=1e-6)
    # Two turns in 8 s: the arm ends as it began, 80 mm higher.
    start, _ = printed_angles(100.0, -20.0)
    assert numbers["end_theta1_theta2_deg_l3_mm"][0] == pytest.approx(start, abs=1e-9)
    assert numbers["end_theta1_theta2_deg_l3_mm"][2] == pytest.approx(20.0, abs=1e-9)
    plan = numbers["plan"]
    assert (plan["met_at_s"], plan["left_at_s"]) == pytest.approx((1.0, 9.0), abs=1e-9)
    assert plan["tool_off_the_spiral_m"] <= 1e-6
    assert plan["velocity_off_the_spiral_m_s"] <= 1e-5
    assert max(plan["accelerations_off_rad_s2_m_s2"]) <= 1e-2
    assert plan["certificate_rows"] > 0


def printed_angles(x_mm: float, y_mm: float) -> tuple[float, float]:
    """θ1 and θ2, degrees, of the paper's arm in `right` at a point, by the law of cosines."""
    d = np.hypot(x_mm, y_mm)
    theta2 = np.arccos((d**2 - 80**2 - 50**2) / 8000)
    theta1 = np.arctan2(y_mm, x_mm) - np.arctan2(50 * np.sin(theta2), 80 + 50 * np.cos(theta2))
    return float(np.degrees(theta1)), float(np.degrees(theta2))


def test_all_formulations_have_the_planner_s_solutions_in_the_modes_of_one_table() -> None:
    numbers = result("modes").numbers
    for mode in ("left", "right"):
        for source, worst in numbers["largest_difference_from_planner_rad"][mode].items():
            assert worst <= 1e-12, (mode, source)
    assert numbers["convention"]["right"] == {"theta2": "positive", "000": 2, "001": 1, "004": 1}
    assert numbers["theta2_left_plus_theta2_right_rad"] <= 1e-12


def test_a_wrong_row_of_the_table_of_modes_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(modes.CONVENTION, "left", (1, +1, -1))
    found = modes.formulations(np.array([[0.3, 0.2, 0.0]]), modes.L1, modes.L2, "left")
    assert np.abs(found["001"] - found["planner"]).max() > 0.1
    assert np.abs(found["004"] - found["planner"]).max() <= 1e-12


def test_the_chain_of_matrices_is_the_printed_matrix_and_gives_its_joint_angles_back() -> None:
    numbers = result("dh-chain").numbers
    assert numbers["product_minus_printed_matrix"] <= 1e-15
    assert numbers["product_minus_planner_position_m"] <= 1e-15
    assert numbers["product_minus_planner_yaw_rad"] <= 1e-14
    assert numbers["round_trip_angle_times_margin_rad"] <= 1e-14
    assert numbers["round_trip_matrix"] <= 1e-14
    assert numbers["d3_back_m"] <= 1e-15


def test_the_chain_as_printed_is_no_rotation_and_forgets_two_angles() -> None:
    numbers = result("dh-chain").numbers
    low, high = numbers["printed_rot_z_determinant"]
    assert low < -0.99
    assert high < 1
    assert numbers["printed_rot_z_matrix_error_median"] > 0.5
    assert numbers["printed_theta4_error_minus_theta1_plus_theta2_rad"] <= 1e-12
    assert numbers["printed_theta4_error_median_rad"] > 1.0
    assert np.linalg.det(printed_dh.rotation_z(np.array(0.7))) == pytest.approx(1.0)


def test_joint_speed_past_the_base_axis_grows_as_one_over_the_distance() -> None:
    numbers = result("line-through-singularity").numbers
    assert numbers["theta1_peak_over_v_by_h"][2:] == pytest.approx([1.0] * 6, rel=0.01)
    power = numbers["exponents_below_10_mm"]
    assert power["theta1"] == pytest.approx(-1.0, abs=0.01)
    assert power["theta1_acceleration"] == pytest.approx(-2.0, abs=0.02)
    assert power["theta2"] == pytest.approx(0.0, abs=0.01)
    # The hole of unequal links: speeds stay bounded, accelerations do not.
    assert power["hole_theta2"] == pytest.approx(0.0, abs=0.02)
    assert power["hole_theta2_acceleration"] == pytest.approx(-0.5, abs=0.05)
    r0, near = 0.05, np.array(numbers["distance_mm"][4:]) / 1e3
    wanted = numbers["speed_m_s"] ** 2 / np.sqrt(0.225 * 0.175 * (2 * r0 * near + near**2))
    assert numbers["peak_rad_s2"]["hole_theta2_acceleration"][4:] == pytest.approx(wanted.tolist(), rel=0.02)
    # |sin θ2| at distance h: ρ = 2 l cos(θ2/2).
    h = np.array(numbers["distance_mm"]) / 400
    assert numbers["least_margin"] == pytest.approx((2 * h * np.sqrt(1 - h**2)).tolist(), rel=1e-3)


def test_the_planner_plans_the_line_far_from_the_axis_and_refuses_it_with_the_margin_near() -> None:
    numbers = result("line-through-singularity").numbers
    margins = dict(zip(numbers["distance_mm"], numbers["least_margin"], strict=True))
    for kind, answers in numbers["planner"].items():
        for mm, answer in zip(numbers["distance_mm"], answers, strict=True):
            if margins[mm] < 0.05:
                assert answer["answer"] == "NEAR_SINGULARITY", (kind, mm)
                assert answer["margin_required"] == 0.05
                # The margin is that of the worst knot. Half of the line is a knot of a straight leg. Tracking is met
                # at any time in the window, which is 1 ms longer than the line takes, and has its knots from there on.
                late_mm = 1e3 * numbers["speed_m_s"] * (1e-3 if kind == "constant speed" else 0.0)
                off = np.hypot(mm, late_mm) / 400
                assert margins[mm] * (1 - 1e-9) <= answer["margin"] <= 2 * off * np.sqrt(1 - off**2) * (1 + 1e-9)
            elif kind == "constant speed" and np.degrees(numbers["speed_m_s"] / (mm / 1e3)) > numbers["limit_deg_s"]:
                assert answer["answer"] == "MOTION_LIMIT", (kind, mm)
            else:
                assert answer["answer"] == "planned", (kind, mm)
                assert answer["peak_deg_s"] <= numbers["limit_deg_s"]
                assert answer["margin"] >= 0.05
    at_speed = numbers["planner"]["constant speed"][0]
    assert at_speed["leg_s"] == pytest.approx(1.6)


def test_the_mended_half_angle_formulas_are_the_dyad_and_the_printed_one_depends_on_the_unit() -> None:
    numbers = result("oblique-triangles").numbers
    assert numbers["solved_by_both"] == numbers["targets"]
    assert numbers["mended_minus_dyad_times_margin_rad"] <= 1e-13
    assert numbers["mended_minus_dyad_times_margin_flat_lower_triangle_rad"] <= 1e-11
    assert numbers["printed_eq_1_in_m_error_deg"][0] > 5
    assert numbers["printed_eq_1_in_mm_error_deg"][0] > 45


def test_half_angle_formulas_know_a_triangle_and_the_printed_one_does_not() -> None:
    five, four, three = (np.array(side) for side in (5.0, 4.0, 3.0))
    assert printed_triangles.angle(five, four, three) == pytest.approx(np.pi / 2)
    assert printed_triangles.angle(three, four, five) == pytest.approx(np.arccos(0.8))
    assert abs(printed_triangles.printed_angle(five, four, three) - np.pi / 2) > 0.2
    assert np.isnan(printed_triangles.angle(np.array(8.0), four, three))
    corner = triangles.LINK1, triangles.HEIGHT + triangles.LINK2
    r, z = (np.array(x) for x in corner)
    up = printed_triangles.joints(r, z, triangles.HEIGHT, triangles.LINK1, triangles.LINK2)
    reached = triangles.LINK1 * np.exp(1j * up[0]) + triangles.LINK2 * np.exp(1j * up.sum())
    assert reached == pytest.approx(complex(corner[0], triangles.LINK2))
    assert up[1] < 0


def test_the_joint_move_is_that_of_the_paper_with_its_missed_pose_and_its_way_out_to_283_mm() -> None:
    numbers = result("joint-move").numbers
    assert numbers["pose1_deg_mm"] == pytest.approx([0, 90, -100, -90])
    assert numbers["pose2_deg_mm"] == pytest.approx([90, -90, -200, 0])
    assert numbers["duration_s"] == pytest.approx(1.0)
    assert numbers["farthest_x_mm"] == pytest.approx(400 / np.sqrt(2), abs=1e-6)
    assert numbers["farthest_at_s"] == pytest.approx([0.3, 0.7])
    assert numbers["off_the_diagonal_mm"] <= 1e-9
    assert numbers["missed_by_deg_mm"] == pytest.approx([-11.25, 22.5, 12.5, -11.25])
    assert numbers["missed_by_formula_deg_mm"] == pytest.approx([-11.25, 22.5, 12.5, -11.25])
    assert numbers["tool_at_the_middle_mm"][:2] == pytest.approx([400 * np.cos(np.radians(33.75)) / np.sqrt(2)] * 2)
    assert numbers["theta1_rate_minus_theta4_rate_rad_s"] <= 1e-14
    assert numbers["end_misses_pose1_by"] <= 1e-14


def test_ruckig_meets_the_middle_pose_with_the_same_speeds_and_takes_longer() -> None:
    numbers = result("joint-move").numbers
    assert numbers["ruckig_misses_pose2_by"] == 0.0
    # Per segment: way at full speed, and the ramps of speed and acceleration.
    assert numbers["ruckig_duration_s"] == pytest.approx(2 * (0.4 + 0.2 + 0.02), rel=0.005)
    limit = np.array(numbers["peak_rate_deg_s_mm_s"])
    assert (np.array(numbers["ruckig_peak_rate_deg_s_mm_s"]) <= limit).all()
    assert numbers["ruckig_farthest_x_mm"] == pytest.approx(400 / np.sqrt(2), abs=1e-2)


def test_a_parabolic_blend_is_smooth_in_speed_and_jumps_in_acceleration() -> None:
    move = ParabolicBlend(np.array([[0.0, 1.0], [2.0, 0.5], [1.0, 1.0], [1.5, -1.0]]), 0.5, 0.1)
    assert move.duration == pytest.approx(1.7)
    t = np.linspace(0, move.duration, 1701)
    q, qd, qdd = (move.evaluate(t, order) for order in range(3))
    assert q[0] == pytest.approx(move.poses[0])
    assert q[-1] == pytest.approx(move.poses[-1])
    assert qd[[0, -1]] == pytest.approx(np.zeros((2, 2)), abs=1e-12)
    step = t[1] - t[0]
    assert np.abs(np.diff(q, axis=0) / step - (qd[1:] + qd[:-1]) / 2).max() < 1e-2
    assert np.abs(np.diff(qd, axis=0)).max() <= np.abs(qdd).max() * step * 1.01
    inside = np.abs(t[:, None] - move.passed).min(1) > 0.1001
    assert (qdd[inside] == 0).all()
    assert move.evaluate(move.passed[1:3]) - move.poses[1:3] == pytest.approx(move.missed_by[1:3])


def test_the_inverse_of_004_knows_two_indices_only_and_has_no_angle_out_of_reach() -> None:
    with pytest.raises(ValueError, match="index 0"):
        inverse(np.array([0.2, 0.2, 0.0]), np.array(0.0), 0.2, 0.2, 0)
    with pytest.raises(ValueError, match="root 2"):
        printed_dh.inverse(np.eye(4), 0.2, 0.2, 0.0, 2)
    with np.errstate(invalid="ignore"):
        assert np.isnan(inverse(np.array([0.5, 0.2, 0.0]), np.array(0.0), 0.2, 0.2, 1)[:2]).all()
