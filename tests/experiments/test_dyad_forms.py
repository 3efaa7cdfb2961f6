"""The formulations that `dyad-timing` compares solve the same dyad: else their times say nothing."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from assur.experiments import dyad_forms as forms
from assur.experiments import dyad_race as race
from assur.experiments.dyad import RRR
from assur.planner.arrays import FloatArray
from tests.experiments.results import result

DYADS = race.dyads(500)
L1, L2 = race.L1, race.L2
Way = Callable[[forms.Given[float], int], forms.Found[float] | None]


def same(found: forms.Found[float] | forms.Found[FloatArray], wanted: FloatArray, within: float) -> None:
    """Asserts nine numbers alike, relative to the larger of 1 and themselves, the angle up to whole turns."""
    rows = np.array(found)
    rows[0] = wanted[0] + np.remainder(rows[0] - wanted[0] + np.pi, 2 * np.pi) - np.pi
    assert (np.abs(rows - wanted) <= within * np.maximum(1.0, np.abs(wanted))).all()


def by_planner(sigma: int) -> FloatArray:
    """φ, φ̇, φ̈ and C with derivatives (9, N) by the planner's kernel and K12."""
    d = DYADS[6:] - DYADS[:6]
    found = RRR(L1, L2).solve(sigma, (d[0], d[1]), (d[2], d[3]), (d[4], d[5]))
    (ux, uy), w, a = found.u, found.rates[0][0], found.rates[1][0]
    x, y, xd, yd, xdd, ydd = DYADS[:6]
    return np.array(
        [
            np.arctan2(uy, ux),
            w,
            a,
            x + ux,
            y + uy,
            xd - w * uy,
            yd + w * ux,
            xdd - a * uy - w * w * ux,
            ydd + a * ux - w * w * uy,
        ]
    )


@pytest.mark.parametrize("sigma", [1, -1])
def test_arrays_agree_with_the_planner_in_both_modes(sigma: int) -> None:
    given = race.columns(DYADS)
    wanted = by_planner(sigma)
    same(forms.vector(given, L1, L2, sigma, forms.ARRAYS), wanted, 1e-12)
    same(forms.relative(given, L1, L2, sigma, forms.ARRAYS), wanted, 1e-11)


@pytest.mark.parametrize("sigma", [1, -1])
@pytest.mark.parametrize("functions", [forms.FLOATS, forms.FLOATS_GENERAL], ids=["cramer", "general"])
def test_floats_agree_with_the_planner_in_both_modes(sigma: int, functions: forms.Functions[float]) -> None:
    wanted = by_planner(sigma)
    for i in range(100):
        given = race.single(DYADS, i)
        same(forms.vector(given, L1, L2, sigma, functions), wanted[:, i], 1e-12)
        same(forms.relative(given, L1, L2, sigma, functions), wanted[:, i], 1e-11)
        same(forms.printed_single(given, L1, L2, sigma), wanted[:, i], 1e-11)
        landed = forms.natural(given, L1, L2, (wanted[3, i] + 1e-4, wanted[4, i] - 1e-4), functions)
        assert landed is not None
        same(landed, wanted[:, i], 1e-8)


@pytest.mark.parametrize(("x", "y"), [(0.0, 0.07), (0.0, -0.07), (-0.07, 0.02), (-0.07, -0.02)])
def test_the_printed_form_for_floats_knows_the_cases_of_figure_2(x: float, y: float) -> None:
    given = (0.0, 0.0, 0.1, -0.2, 0.3, 0.4, x, y, -0.3, 0.2, 0.5, -0.1)
    wanted = np.array(forms.vector(given, L1, L2, 1, forms.FLOATS))
    same(forms.printed_single(given, L1, L2, 1), wanted, 1e-12)


def test_newton_lands_on_the_other_assembly_from_its_side_and_nowhere_from_the_line_between() -> None:
    given = race.single(DYADS, 0)
    other = forms.vector(given, L1, L2, -race.SIGMA, forms.FLOATS)
    landed = forms.natural(given, L1, L2, (other[3], other[4]), forms.FLOATS)
    assert landed is not None
    same(landed, np.array(other), 1e-9)
    between = (given[0] + given[6]) / 2, (given[1] + given[7]) / 2
    exact = (0.0, 0.0, *given[2:6], 0.1, 0.0, *given[8:])
    assert forms.natural(exact, L1, L2, (0.05, 0.0), forms.FLOATS) is None
    assert race.restarted(given, (other[3] + 1.0, other[4]), [between, (other[3], other[4])], forms.FLOATS) is None


def test_natural_coordinates_in_arrays_restart_until_all_land_on_the_wanted_assembly() -> None:
    wanted = by_planner(race.SIGMA)
    random = np.random.default_rng(5)
    c = wanted[3], wanted[4]
    guesses = np.stack(c) + random.normal(0.0, 1.0 * L1, (race.STARTS, 2, DYADS.shape[1]))
    found, starts = forms.natural_batch(race.columns(DYADS), L1, L2, guesses, c, race.NEAR)
    same(found, wanted, 1e-8)
    assert starts > 1.2 * DYADS.shape[1]
    none, _ = forms.natural_batch(race.columns(DYADS), L1, L2, guesses[:3], (c[0] + 1.0, c[1]), race.NEAR)
    assert np.isnan(np.array(none)[3:5]).all()


def test_the_experiment_compares_solutions_that_are_the_same() -> None:
    numbers = result("dyad-timing").numbers
    assert numbers["largest_relative_difference_from_vector_form"]["printed"] <= 1e-12
    assert numbers["largest_relative_difference_from_vector_form"]["relative"] <= 1e-12
    assert numbers["largest_relative_difference_from_vector_form"]["natural"] <= 1e-9
    assert numbers["starts_until_same_solution_most"] < race.STARTS
    mean = numbers["starts_mean_by_spread"]
    assert mean[0] == 1.0
    assert mean == sorted(mean)
    assert mean[-1] > 1.5
    assert numbers["claimed_share_of_time"] == {"relative": 0.45, "natural": 0.17}
