"""Numbers of `five-bar`: the printed group in a parallel arm, its workspace by another method, its singularities."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from assur.experiments import five_bar
from assur.experiments.five_bar import elbows, on_curve
from assur.experiments.five_bar_workspace import workspace
from assur.planner.robots.five_bar import FiveBar
from tests.experiments.results import result

GRID_M = 0.005
"""Of the areas that are counted here, m."""


def of(distal: str) -> dict[str, Any]:
    found: dict[str, Any] = result("five-bar").numbers["distal_mm"][distal]
    return found


@pytest.mark.parametrize("distal", ["260", "160"])
def test_the_printed_group_solves_the_five_bar_as_the_planner_does(distal: str) -> None:
    group = of(distal)["printed_group"]
    assert group["states"] == 10_000
    assert max(group["cranks_rad"], group["direct_m"]) <= 1e-13
    assert max(group["crank_rates"], group["crank_accelerations"], group["direct_m_s"]) <= 1e-10
    assert group["direct_m_s2"] <= 1e-8


@pytest.mark.parametrize("distal", ["260", "160"])
def test_the_determinants_vanish_on_their_curves(distal: str) -> None:
    for key in ("at_type_1", "at_type_2"):
        assert of(distal)[key]["points"] > 1_000
        assert of(distal)[key]["largest_determinant"] <= 1e-10


def test_a_curve_that_is_off_by_a_millimetre_is_nobodys() -> None:
    robot = five_bar.robot_of(0.16)
    for of_type, curves in ((1, robot_curves()[0]), (2, robot_curves()[1])):
        kept = [np.isfinite(on_curve(robot, c, m, of_type)).all(1).sum() for c in curves for m in range(4)]
        off = [np.isfinite(on_curve(robot, c * 0.99, m, of_type)).all(1).sum() for c in curves for m in range(4)]
        assert sum(kept) > 100
        assert sum(off) <= 0.02 * sum(kept)


def robot_curves() -> tuple[Any, Any]:
    seen = workspace(five_bar.robot_of(0.16), 0.05, 181)
    return seen.type_1, seen.type_2


@pytest.mark.parametrize("distal", [0.26, 0.16])
def test_the_areas_are_those_of_triangles(distal: float) -> None:
    """Every place in reach of both sides, its elbows by the law of cosines, and in front of their line or behind."""
    robot = five_bar.robot_of(distal)
    a, half = robot.proximal[0], robot.separation / 2
    line = np.arange(-0.6, 0.6, GRID_M) + GRID_M / 2
    x, y = (each.ravel() for each in np.meshgrid(line, line))
    sides = []
    for shift in (half, -half):
        far = np.hypot(x, y - shift)
        with np.errstate(invalid="ignore"):
            inner = np.arccos((a**2 + far**2 - distal**2) / (2 * a * far))
        sides.append((np.arctan2(y - shift, x), inner))
    areas = of(f"{1e3 * distal:.0f}")["area_cm2"]
    for name in FiveBar.modes:
        p = []
        for (turn, inner), bend, shift in zip(sides, name.split("-"), (half, -half), strict=True):
            crank = turn + (inner if bend == "left" else -inner)
            p.append((a * np.cos(crank), shift + a * np.sin(crank)))
        (x1, y1), (x2, y2) = p
        sine = ((x2 - x1) * (y - y1) - (y2 - y1) * (x - x1)) / distal**2  # of the couplers' angle; NaN out of reach
        cell = 1e4 * GRID_M**2
        reached = np.isfinite(sine)
        front = reached & (sine >= robot.parallel_least)
        assert areas[name]["front"] == pytest.approx(cell * front.sum(), abs=0.01 * cell * reached.sum())
        assert areas[name]["refused"] == pytest.approx(cell * (reached & ~front).sum(), abs=0.01 * cell * reached.sum())
        assert 0 < areas[name]["within"] <= areas[name]["front"]


def test_left_left_and_right_right_are_mirrored_and_the_usual_mode_has_most_room() -> None:
    for distal in ("260", "160"):
        areas = of(distal)["area_cm2"]
        assert areas["left-left"] == pytest.approx(areas["right-right"])
        assert max(areas, key=lambda mode: areas[mode]["within"]) == "left-right"


def test_which_couplers_can_be_in_one_line_follows_from_the_lengths() -> None:
    """485 mm between elbows at most: 520 mm of couplers never stretch, 320 mm do; equal ones can always fold."""
    assert of("260")["type_2_couplers"] == {"stretched": False, "folded": True}
    assert of("160")["type_2_couplers"] == {"stretched": True, "folded": True}


def test_the_printed_indicator_sees_stretched_couplers_and_not_folded_ones() -> None:
    wide, short = (of(distal)["printed_ratio_near_type_2"] for distal in ("260", "160"))
    # equal couplers with |sin| of their angle s: folded A/B = sin(asin(s)/2), stretched cos(asin(s)/2)
    half = np.arcsin(five_bar.KEPT) / 2
    assert wide["most"] == pytest.approx(np.sin(half), rel=1e-2)
    assert short["most"] == pytest.approx(1.0, abs=1e-4)
    assert min(wide["places"], short["places"]) > 1_000


def test_the_planner_refuses_the_line_with_its_margin_and_goes_around() -> None:
    planner = result("five-bar").numbers["planner"]
    assert planner["straight"]["answer"] == "NEAR_PARALLEL_SINGULARITY"
    assert planner["straight"]["parallel_margin"] < -0.5
    assert planner["joint_legs"]["answer"] == "planned"
    assert planner["joint_legs"]["parallel_margin"] >= planner["straight"]["parallel_margin_required"] == 0.1


def test_elbows_are_a_cranks_length_from_their_axes() -> None:
    robot = five_bar.robot_of(0.26)
    left, right = elbows(robot, np.array([[0.3, -1.0, 0.1, 0.0]]))
    assert np.hypot(*(left[0] - [0.0, 0.0425])) == pytest.approx(0.2)
    assert np.hypot(*(right[0] + [0.0, 0.0425])) == pytest.approx(0.2)
    assert right[0].tolist() == pytest.approx([0.2 * np.cos(-1.0), -0.0425 + 0.2 * np.sin(-1.0)])
