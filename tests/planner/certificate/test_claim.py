"""Claims: what one normal a row amounts to, compared and put together row by row; NaN proves nothing."""

from __future__ import annotations

import numpy as np

from assur.planner.collision.claim import Claim, put, take
from assur.planner.model.clearance import SLACK_M


def claim(least: list[float], required: float = 0.001) -> Claim:
    x = np.array(least)
    n = np.tile(np.array([0.0, 0.0, 1.0]), (len(x), 1)) * (1.0 if required == 0.001 else -1.0)
    none = np.zeros(len(x))
    return Claim(n, x, x, x, none, none, x, np.full(len(x), required))


def test_a_row_is_proved_from_its_requirement_and_the_slack_on_and_never_by_nan() -> None:
    found = claim([0.001 + 2 * SLACK_M, 0.001, 0.001 + SLACK_M / 2, 0.5, np.nan, -np.inf, np.inf]).proved
    assert found.tolist() == [True, False, False, True, False, False, True]


def test_the_better_of_two_is_taken_row_by_row_by_what_is_to_spare() -> None:
    # the second asks for more, so the same gap is worth less
    better = claim([0.010, 0.010, 0.002]).better(claim([0.010, 0.020, 0.003], 0.004))
    assert better.least.tolist() == [0.010, 0.020, 0.002]
    assert better.required.tolist() == [0.001, 0.004, 0.001]
    assert better.normal[:, 2].tolist() == [1.0, -1.0, 1.0]


def test_what_is_not_a_number_gives_way() -> None:
    assert claim([np.nan]).better(claim([0.5])).least.tolist() == [0.5]


def test_rows_are_taken_out_and_put_back() -> None:
    whole = claim([0.1, 0.2, 0.3])
    rows = np.array([2, 0])
    assert take(whole, rows).least.tolist() == [0.3, 0.1]
    changed = put(whole, rows, claim([0.7, 0.8]))
    assert changed.least.tolist() == [0.8, 0.2, 0.7]
    assert whole.least.tolist() == [0.1, 0.2, 0.3]
