"""Vias are flown by with the mean velocity of the way through them, and not by a joint that turns round there."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.legs.passing import VIA_VELOCITY, passing_velocities, passing_velocity
from tests.planner.cells import limits

V, A = limits().velocity, limits().acceleration


@given(st.integers(0, 10**6), st.floats(0.0, 3.0))
def test_no_joint_passes_where_it_turns_round_and_none_too_fast(seed: int, pace: float) -> None:
    before, at, behind = np.random.default_rng(seed).uniform(limits().lower, limits().upper, (3, 50, 4))
    found = passing_velocities(before, at, behind, np.full(50, pace), V, A)
    turns = (at - before) * (behind - at) <= 0
    assert (found[turns] == 0).all()
    assert (np.abs(found) <= VIA_VELOCITY * V).all()
    on = ~turns & (found != 0)
    assert (np.sign(found[on]) == np.sign((behind - before)[on])).all()


def test_many_at_once_are_each_by_itself() -> None:
    rng = np.random.default_rng(3)
    before, at, behind = rng.uniform(limits().lower, limits().upper, (3, 7, 4))
    pace = rng.uniform(0.0, 1.2, 7)
    before[0] = at[0] = behind[0]
    together = passing_velocities(before, at, behind, pace, V, A)
    rates = V.tolist(), A.tolist()
    ways = [(before[i].tolist(), at[i].tolist(), behind[i].tolist()) for i in range(7)]
    alone = [passing_velocity(a, b, c, float(pace[i]), *rates) for i, (a, b, c) in enumerate(ways)]
    np.testing.assert_allclose(together, alone, rtol=1e-14, atol=0)


def test_halfway_the_pace_is_times_the_mean_velocity() -> None:
    start, end = np.zeros(4), np.array([1.0, 0.0, 0.0, 0.0])
    duration = 1.0 / V[0] + np.sqrt(1.0 / A[0])
    found = passing_velocity(start.tolist(), (end / 2).tolist(), end.tolist(), 0.5, V.tolist(), A.tolist())
    np.testing.assert_allclose(found, [0.5 / duration, 0.0, 0.0, 0.0])
