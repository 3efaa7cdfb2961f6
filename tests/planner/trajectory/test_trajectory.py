"""Knots and the quintic between them: evaluation against SciPy, what the constructor refuses, joining and cutting."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import BPoly

from assur.planner.errors import FaultError, InputError
from assur.planner.trajectory import Trajectory
from tests.planner.trajectory.splines import REGIMES, bernstein, constant_jerk, spline, splines

SCALE = (1.0, 3.0, 30.0, 300.0)


@pytest.mark.parametrize("regime", REGIMES)
@pytest.mark.parametrize("derivative", range(4))
def test_evaluation_is_scipys_piecewise_polynomial_through_the_same_states(regime: str, derivative: int) -> None:
    path = spline(3, regime)
    second = BPoly.from_derivatives(path.time, np.stack([path.q, path.qd, path.qdd], 1))
    t = np.concatenate([path.time[:-1], np.random.default_rng(0).uniform(path.start, path.end, 500)])
    wanted = second(t) if derivative == 0 else second.derivative(derivative)(t)
    # Both round: a derivative of a piece of length h by the spacing of q over h to its order.
    rounding = 1e-13 * np.abs(path.q).max() / path.steps.min() ** derivative
    assert np.abs(path.evaluate(t, derivative) - wanted).max() <= 1e-12 * SCALE[derivative] * 40 + rounding


@given(splines)
def test_at_its_knots_a_trajectory_is_in_the_states_given_to_the_bit(path: Trajectory) -> None:
    for derivative, states in enumerate((path.q, path.qd)):
        assert np.array_equal(path.evaluate(path.time, derivative), states)
    # The acceleration is stored halved, which is exact too.
    assert np.array_equal(path.evaluate(path.time, 2), path.qdd)
    for k in (0, -1):
        assert all(map(np.array_equal, path.state(float(path.time[k])), (path.q[k], path.qd[k], path.qdd[k])))


def test_at_an_inner_knot_the_jerk_is_that_of_the_piece_to_its_right() -> None:
    jerk = np.array([[6.0], [-3.0], [1.0]])
    path = constant_jerk(np.array([0.0, 0.5, 1.0, 2.0]), jerk, np.zeros((3, 1)))
    assert path.evaluate(np.array([0.0, 0.5, 1.0]), 3) == pytest.approx(jerk, abs=1e-12)
    assert path.evaluate(2.0, 3) == pytest.approx([1.0], abs=1e-12)


def test_outside_its_knots_a_trajectory_is_not_a_number() -> None:
    path = spline(1)
    beside = [np.nextafter(path.start, -np.inf), np.nextafter(path.end, np.inf), np.nan, np.inf, -np.inf]
    for derivative in range(4):
        values = path.evaluate(np.array([beside, [path.start] * 5]), derivative)
        assert np.isnan(values[0]).all()
        assert np.isfinite(values[1]).all()
        assert values.shape == (2, 5, path.n)
    assert np.isnan(path.evaluate(np.nan)).all()


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("time", [0.0, 1.0, 1.0]),
        ("time", [0.0, 2.0, 1.0]),
        ("time", [0.0, 1.0, np.nan]),
        ("time", [0.0, 1.0, np.inf]),
        ("time", [0.0]),
        ("time", [[0.0, 1.0, 2.0]]),
        ("time", "soon"),
        ("q", [[0.0], [1.0], [np.nan]]),
        ("q", [[0.0], [1.0]]),
        ("q", [0.0, 1.0, 2.0]),
        ("qd", [[0.0, 0.0], [1.0, 0.0], [1.0, 0.0]]),
        ("qdd", [[0.0], [np.inf], [0.0]]),
    ],
)
def test_knots_that_are_no_motion_are_refused_by_name(name: str, value: object) -> None:
    good = {"time": [0.0, 1.0, 2.0], "q": [[0.0]] * 3, "qd": [[0.0]] * 3, "qdd": [[0.0]] * 3}
    assert Trajectory(**good).n == 1  # type: ignore[arg-type]
    with pytest.raises(InputError) as refused:
        Trajectory(**{**good, name: value})  # type: ignore[arg-type]
    assert refused.value.field == f"trajectory.{name}"


def test_a_trajectory_of_no_joints_is_refused() -> None:
    with pytest.raises(InputError, match="at least one joint"):
        Trajectory(np.arange(3.0), *np.zeros((3, 3, 0)))


def test_nothing_of_a_trajectory_can_be_changed() -> None:
    q = np.zeros((2, 1))
    path = Trajectory(np.arange(2.0), q, q, q)
    q[0] = 1.0
    assert not path.q.any()
    for array in (path.time, path.q, path.qd, path.qdd):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0
    with pytest.raises(AttributeError):
        path.q = q  # type: ignore[misc]


def test_only_knots_travel_between_processes() -> None:
    path = spline(5)
    before = len(pickle.dumps(path))
    path.extrema(0)
    assert len(pickle.dumps(path)) == before
    other = pickle.loads(pickle.dumps(path))
    assert all(np.array_equal(getattr(path, name), getattr(other, name)) for name in ("time", "q", "qd", "qdd"))


@given(splines)
def test_states_in_one_go_are_those_one_by_one_and_exact_at_the_end(path: Trajectory) -> None:
    t = np.concatenate([np.linspace(path.start, path.end, 50), path.time])
    for derivative, found in enumerate(path.states(t)):
        assert np.abs(found - path.evaluate(t, derivative)).max() <= 1e-12 * np.abs(bernstein(path, derivative)).max()
        assert np.array_equal(found[-1], (path.q, path.qd, path.qdd)[derivative][-1])


def test_rest_at_an_end_is_exact_rest() -> None:
    zero, some = np.zeros((2, 2)), np.array([[0.0, 0.0], [0.0, 1e-300]])
    assert Trajectory(np.arange(2.0), zero, zero, zero).rest_at_end
    for qd, qdd in ((some, zero), (zero, some)):
        path = Trajectory(np.arange(2.0), zero, qd, qdd)
        assert path.rest_at_start
        assert not path.rest_at_end


@given(splines, st.integers(0, 10**6), st.sampled_from([np.nan, np.inf, -np.inf]))
def test_a_table_of_knots_is_taken_as_it_is_and_refused_where_a_number_is_none(
    path: Trajectory, place: int, spoilt: float
) -> None:
    again = Trajectory.of_knots(path.knots.copy())
    assert all(np.array_equal(getattr(path, name), getattr(again, name)) for name in ("time", "q", "qd", "qdd"))
    assert np.array_equal(again.coefficients, path.coefficients)
    bad = path.knots.copy()
    bad.flat[place % bad.size] = spoilt
    with pytest.raises(FaultError):
        Trajectory.of_knots(bad)
    with pytest.raises(FaultError):
        Trajectory.of_knots(path.knots[:1].copy())
    late = path.knots.copy()
    late[-1, 0] = late[-2, 0]
    with pytest.raises(FaultError):
        Trajectory.of_knots(late)
