"""The closed forms of source 002: right by themselves, the dyads' solutions, and wrong as printed where it is said."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from assur.experiments import closed_forms as forms
from assur.experiments import elbow, polar
from assur.experiments import printed_forms as printed
from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from tests.experiments.results import result

STENCIL = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
"""Weights of the central first difference of order 8, over steps −4 … 4."""
ARMS = {"elbow": elbow, "polar": polar}
every_arm = pytest.mark.parametrize("name", list(ARMS))


@every_arm
def test_a_closed_form_meets_its_targets_with_the_joints_of_the_dyads(name: str) -> None:
    numbers = result(name).numbers
    assert numbers["targets"] == 10_000
    assert tuple(numbers["modes"]) == ARMS[name].arm().robot.modes
    assert numbers["closed_form_by_transforms_off_target_m"] <= 1e-14
    assert numbers["closed_form_minus_dyads_where_margin_above_0.05_rad_m"] <= 1e-12
    assert numbers["closed_form_minus_dyads_times_margin_rad_m"] <= 1e-14
    assert numbers["inverse_jacobian_minus_dyads_relative_where_margin_above_0.05"] <= 1e-11
    assert numbers["inverse_jacobian_minus_dyads_relative_times_margin_squared"] <= 1e-13
    assert numbers["determinant_by_transforms_and_by_planner_minus_product"] <= 1e-14


def test_the_polar_arm_loses_nothing_near_its_singular_positions() -> None:
    assert result("polar").numbers["closed_form_minus_dyads_rad_m"] <= 1e-14


@every_arm
def test_the_singular_positions_have_no_determinant_and_their_names(name: str) -> None:
    cases = result(name).numbers["singular"]
    names = {case: found["code"] for case, found in cases.items()}
    inside = "interior alignment: flange over the base axis"
    assert (
        names
        == {
            "elbow": {"edge outside: stretched": "STRETCHED", "edge inside: folded": "FOLDED", inside: "ALIGNED"},
            "polar": {"edge inside: nothing of the ram is out": "FOLDED", inside: "ALIGNED"},
        }[name]
    )
    for found in cases.values():
        assert abs(found["determinant"]) <= 1e-17
        assert found["margin"] <= 1e-15


@every_arm
def test_the_jacobian_by_transforms_is_the_difference_of_the_position(name: str) -> None:
    arm = ARMS[name].arm()
    q = np.random.default_rng(1).uniform(0.2, 0.6, (200, 3))
    found = printed.jacobian(arm.frames(q), arm.slides)
    for joint in range(3):
        step = 1e-3 * np.eye(3)[joint]
        tips = [arm.frames(q + k * step)[-1][:, :3, 3] for k in range(-4, 5)]
        assert np.abs(np.tensordot(STENCIL, np.stack(tips), 1) / 1e-3 - found[..., joint]).max() <= 1e-11


@every_arm
def test_a_closed_form_with_a_sign_wrong_is_noticed(name: str) -> None:
    arm, p = ARMS[name].arm(), ARMS[name].targets()[:100]

    def crossed(q: FloatArray, mode: str) -> FloatArray:
        return np.asarray(arm.closed(q, mode) * np.array([1.0, -1.0, 1.0]))

    numbers = forms.compare(dataclasses.replace(arm, closed=crossed), p, np.ones_like(p)).numbers
    assert numbers["closed_form_by_transforms_off_target_m"] > 0.1
    assert numbers["closed_form_minus_dyads_where_margin_above_0.05_rad_m"] > 0.1
    with pytest.raises(FaultError, match="out of reach"):
        forms.compare(arm, np.full_like(p, np.nan), np.ones_like(p))


def test_a_right_angle_at_the_elbow_is_known() -> None:
    p = np.array([0.25, 0.0, 0.16])
    assert printed.elbow_joints(p, 0.25, 0.16, 1, 1) == pytest.approx([0.0, 0.0, np.pi / 2])
    assert printed.polar_joints(np.array([0.0, 0.3, 0.8]), 0.4, 1) == pytest.approx(
        [np.pi / 2, np.arctan2(0.4, 0.3) - np.pi / 2, 0.5]
    )


def test_the_elbow_arm_as_printed_misses_what_is_behind_it_and_what_bends_it_by_more_than_a_right_angle() -> None:
    arm, p = elbow.arm(), elbow.targets()
    above = p - np.array([0.0, 0.0, elbow.HEIGHT])
    off = forms.missed(arm, printed.printed_elbow_joints(above, elbow.L2, elbow.L3, 1, -1), p)
    bent = (above**2).sum(-1) < elbow.L2**2 + elbow.L3**2
    behind = p[:, 0] < 0
    assert off[~bent & ~behind].max() <= 1e-14
    flat = np.hypot(p[:, 0], p[:, 1])
    # Behind, a straight elbow's flange comes to the opposite side of the base axis.
    assert off[behind & ~bent] == pytest.approx(2 * flat[behind & ~bent], rel=1e-9)
    assert off[bent & ~behind].min() > 0
    numbers = result("elbow").numbers
    assert numbers["as_printed_up_missed_where_ahead_and_bent_below_a_quarter_turn_m"] <= 1e-14
    assert 0.5 < numbers["as_printed_missed_in_every_mode_share"] <= (bent | behind).mean()


def test_the_polar_arm_as_printed_meets_every_target_but_below_the_shoulder_with_a_negative_ram() -> None:
    numbers = result("polar").numbers
    assert numbers["as_printed_off_target_m"] <= 1e-14
    assert numbers["as_printed_negative_d3_below_the_shoulder_share"] == 1.0
    assert numbers["as_printed_negative_d3_above_the_shoulder_share"] == 0.0


def test_the_printed_matrices_are_products_but_for_one_entry_of_the_third() -> None:
    numbers = result("polar").numbers
    assert numbers["printed_matrices_minus_table_of_parameters"] <= 1e-15
    assert numbers["closed_tool_matrix_minus_product"] <= 1e-15
    assert numbers["product_iii_mended_minus_a3"] <= 1e-14
    assert numbers["product_iii_as_printed_minus_a3_median"] > 0.5
