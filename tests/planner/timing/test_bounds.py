"""Lower bounds of durations: the closed form is the solver's own minimum, and no bound is above it."""

from __future__ import annotations

import numpy as np
import pytest
import ruckig

from tests.planner.timing.least import least_duration
from tests.planner.timing.legs import KINDS, ROBOTS, Question, question


def true_minimum(asked: Question) -> float:
    """The solver's shortest duration at the whole limits."""
    n = asked.n
    solver, given_, found = ruckig.Ruckig(n), ruckig.InputParameter(n), ruckig.Trajectory(n)
    for which, states in (("current", asked.start), ("target", asked.goal)):
        for name, value in zip(("position", "velocity", "acceleration"), states, strict=True):
            setattr(given_, f"{which}_{name}", value.tolist())
    given_.max_velocity, given_.max_acceleration, given_.max_jerk = (limit.tolist() for limit in asked.limits)
    solver.calculate(given_, found)
    return float(found.duration)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("robot", ROBOTS)
def test_no_bound_is_above_the_solvers_minimum_at_the_whole_limits(kind: str, robot: str) -> None:
    rng, shares = np.random.default_rng(3), []
    for _ in range(250):
        asked = question(rng, robot, kind, n=int(rng.integers(1, 5)))
        bound, minimum = float(least_duration(*asked.args)), true_minimum(asked)
        # Below the solver's own precision of 1e-8 in position there is nothing to compare.
        assert 0 < bound <= minimum * (1 + 1e-9) + 1e-9
        shares.append(bound / minimum)
    assert np.median(shares) > (0.99 if kind == "rest" else 0.6)
