"""The door to Ruckig: what it refuses, and that it refuses nothing that is legal."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import ruckig
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.errors import FaultError, InputError
from assur.planner.timing import Solver, TimingRefusal
from assur.planner.timing.solver import LONGEST, SHORTEST
from assur.planner.trajectory import Trajectory
from tests.planner.timing.legs import KINDS, ROBOTS, question, time_joints
from tests.planner.trajectory.splines import keeps_limits

ZERO, ONE = np.zeros(2), np.ones(2)
PLAIN: dict[str, Any] = {
    "q0": ZERO,
    "v0": ZERO,
    "a0": ZERO,
    "q1": ONE,
    "v1": ZERO,
    "a1": ZERO,
    "velocity": ONE,
    "acceleration": 2 * ONE,
    "jerk": 50 * ONE,
}


def ask(**changed: Any) -> Trajectory | TimingRefusal:
    asked = {**PLAIN, **changed}
    when = {name: asked.pop(name) for name in ("duration", "begin") if name in asked}
    return time_joints(*(np.asarray(row) for row in asked.values()), **when)


def shortest(**changed: Any) -> float | TimingRefusal:
    """The same question to a solver, as plain numbers, for the duration alone."""
    rows = [np.asarray(row).tolist() for row in {**PLAIN, **changed}.values()]
    return Solver(*rows[6:]).shortest(tuple(rows[:3]), tuple(rows[3:6]))


@pytest.mark.parametrize("name", list(PLAIN))
@pytest.mark.parametrize("value", [[1.0, np.nan], [np.inf, 1.0], [1.0], [1.0, 1.0, 1.0], [], [[1.0, 1.0]], 1.0])
def test_vectors_that_are_not_finite_or_not_of_one_length_are_bad_input(name: str, value: Any) -> None:
    with pytest.raises((InputError, TypeError)):
        ask(**{name: np.array(value)})
    with pytest.raises((InputError, TypeError)):
        shortest(**{name: np.array(value)})


@pytest.mark.parametrize("name", ["velocity", "acceleration", "jerk"])
@pytest.mark.parametrize("value", [0.0, -1.0])
def test_limits_that_are_not_positive_are_bad_input(name: str, value: float) -> None:
    with pytest.raises(InputError, match="positive"):
        ask(**{name: np.array([1.0, value])})


@pytest.mark.parametrize("duration", [math.nan, -1e-9, math.inf, -math.inf])
def test_a_duration_that_is_none_is_bad_input(duration: float) -> None:
    with pytest.raises(InputError, match="duration"):
        ask(duration=duration)


@pytest.mark.parametrize(
    ("changed", "excess"),
    [
        ({"v0": np.array([1.1, 0.0])}, 0.1),
        ({"v1": np.array([0.0, -1.5])}, 0.5),
        ({"a0": np.array([0.0, 2.2])}, 0.1),
        ({"a1": np.array([-3.0, 0.0])}, 0.5),
        # 0.99 m/s and 2 m/s²: 0.04 m/s more before the acceleration is gone at 50 m/s³.
        ({"v0": np.array([0.99, 0.0]), "a0": np.array([2.0, 0.0])}, 0.03),
        ({"v1": np.array([0.0, 0.99]), "a1": np.array([0.0, -2.0])}, 0.03),
    ],
)
def test_a_state_that_is_or_will_be_beyond_a_limit_is_refused_with_its_share(changed: Any, excess: float) -> None:
    refused = ask(**changed)
    assert isinstance(refused, TimingRefusal)
    assert refused.reason == "limits"
    assert refused.excess == pytest.approx(excess, abs=1e-9)
    assert isinstance(shortest(**changed), TimingRefusal)


@pytest.mark.parametrize(
    "changed",
    [
        {"v0": np.array([1.0, 0.0])},
        {"v0": np.array([0.9995, -1.0]), "v1": np.array([-1.0, 0.9999])},
        {"a0": np.array([2.0, -1.999]), "a1": np.array([-2.0, 2.0])},
        {"v0": np.array([0.96, 0.0]), "a0": np.array([2.0, 0.0])},
        {"v1": np.array([0.96, 0.0]), "a1": np.array([-2.0, 0.0])},
        {"v0": np.array([-1.0, 0.0]), "a0": np.array([2.0, 0.0])},
    ],
)
def test_a_state_at_a_limit_is_legal_and_its_motion_keeps_the_limit(changed: Any) -> None:
    profile = ask(**changed)
    assert isinstance(profile, Trajectory)
    assert keeps_limits(profile, -9 * ONE, 9 * ONE, *(PLAIN[k] for k in list(PLAIN)[6:]))


def test_a_duration_that_is_too_short_is_refused_with_the_seconds_missing() -> None:
    profile = ask()
    assert isinstance(profile, Trajectory)
    refused = ask(duration=profile.duration - 0.125)
    assert isinstance(refused, TimingRefusal)
    assert refused.reason == "too short"
    assert refused.excess == pytest.approx(0.125)
    at_last = ask(duration=profile.duration)
    assert isinstance(at_last, Trajectory)
    assert at_last.duration == profile.duration
    assert ask(duration=profile.duration - 2e-11) != at_last


def blocked_question() -> dict[str, Any]:
    """One joint at speed towards a goal just ahead, to arrive at speed: sooner or much later, nothing between."""
    one = np.ones(1)
    return {
        "q0": 0 * one,
        "v0": 0.9 * one,
        "a0": 0 * one,
        "q1": 0.3 * one,
        "v1": 0.9 * one,
        "a1": 0 * one,
        "velocity": one,
        "acceleration": one,
        "jerk": 10 * one,
    }


def test_a_duration_in_a_blocked_interval_is_refused_with_the_seconds_to_its_end() -> None:
    asked = blocked_question()
    shortest = ask(**asked)
    assert isinstance(shortest, Trajectory)
    found = [ask(**asked, duration=shortest.duration + x) for x in np.linspace(0, 5, 101)[1:]]
    refused = [one for one in found if isinstance(one, TimingRefusal)]
    assert refused
    assert {one.reason for one in refused} == {"blocked"}
    for x, one in zip(np.linspace(0, 5, 101)[1:], found, strict=True):
        if isinstance(one, TimingRefusal):
            later = ask(**asked, duration=shortest.duration + x + one.excess)
            assert isinstance(later, Trajectory)


def test_a_motion_of_more_than_ten_minutes_is_refused() -> None:
    for refused in (ask(q1=np.array([700.0, 1.0])), ask(duration=LONGEST * 1.01)):
        assert isinstance(refused, TimingRefusal)
        assert refused.reason == "too long"
        assert refused.excess > 0
    for way in (700.0, 1e4, 1e6):
        assert isinstance(ask(q1=way * ONE), TimingRefusal)
        assert isinstance(shortest(q1=way * ONE), TimingRefusal)
    assert isinstance(ask(duration=LONGEST), Trajectory)


class Broken:
    """Stands in for Ruckig's solver: fails a few times, and then is Ruckig."""

    def __init__(self, failing: int, error: tuple[type[Exception], str] | None, aside: float = 0.0) -> None:
        self.failing, self.error, self.aside = failing, error, aside
        self.asked: list[float] = []
        self.given: Any = None
        self.real = ruckig.Ruckig(2)

    def __call__(self, n: int) -> Broken:
        assert n == 2
        return self

    def validate_input(self, given: Any, *checks: bool) -> bool:
        assert checks == (True, True)
        return bool(self.real.validate_input(given, *checks))

    def calculate(self, given: Any, found: Any) -> Any:
        self.asked.append(given.max_jerk[0])
        self.given = given
        if len(self.asked) <= self.failing:
            if self.error is not None:
                raise self.error[0](self.error[1])
            return ruckig.Result.ErrorSynchronizationCalculation
        given.target_position = [x + self.aside for x in given.target_position]
        return self.real.calculate(given, found)


ERRORS = ((ruckig.RuckigError, "step 2"), (ValueError, "-101 is not a valid Result"), None)
"""What it may raise; made when it is raised, since an exception keeps alive what it went through."""


@pytest.mark.parametrize("error", ERRORS)
@pytest.mark.parametrize("failing", [1, 2, 3])
def test_a_failure_of_the_solver_is_tried_again_with_less_jerk_and_then_a_refusal(
    monkeypatch: pytest.MonkeyPatch, error: tuple[type[Exception], str] | None, failing: int
) -> None:
    broken = Broken(failing, error)
    monkeypatch.setattr(ruckig, "Ruckig", broken)
    answer = ask()
    assert len(broken.asked) == min(failing + 1, 3)
    assert broken.asked == sorted(broken.asked, reverse=True)
    if failing < 3:
        assert isinstance(answer, Trajectory)
    else:
        assert isinstance(answer, TimingRefusal)
        assert answer.reason == "no profile"
        assert math.isnan(answer.excess)
        assert answer.detail


def test_a_profile_that_misses_its_goal_is_refused_as_unsound(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ruckig, "Ruckig", Broken(0, None, aside=1e-6))
    answer = ask()
    assert isinstance(answer, TimingRefusal)
    assert answer.reason == "unsound"
    assert answer.excess == pytest.approx(10, rel=1e-3)


def test_no_waypoint_is_ever_given_to_the_solver(monkeypatch: pytest.MonkeyPatch) -> None:
    watched = Broken(0, None)
    monkeypatch.setattr(ruckig, "Ruckig", watched)
    for duration in (None, 3.0):
        ask(duration=duration)
        assert watched.given.intermediate_positions == []
        assert watched.given.minimum_duration == duration
    assert watched.real.max_number_of_waypoints == 0


@pytest.mark.parametrize("residual", [1e-9 * 0.99, 1e-12, 1e-14, 1e-300])
def test_residual_velocities_are_at_rest_for_the_solver_and_kept_in_the_knots(residual: float) -> None:
    sign = np.array([1.0, -1.0])
    profile = ask(v0=residual * sign, v1=-residual * sign, a0=residual * sign)
    assert isinstance(profile, Trajectory)
    plain = ask()
    assert isinstance(plain, Trajectory)
    assert profile.duration == plain.duration
    assert np.array_equal(profile.qd[0], residual * sign)
    assert np.array_equal(profile.qd[-1], -residual * sign)
    assert np.array_equal(profile.qdd[0], residual * sign)


@pytest.mark.parametrize("way", [0.0, 1e-16, 1e-12, 1e-9, 1e-7, 1e-5, 1e-3])
def test_tiny_moves_take_a_millisecond_at_least_and_keep_their_limits(way: float) -> None:
    q0 = np.array([2.9, -1.7])
    profile = ask(q0=q0, q1=q0 + np.array([way, -way / 3]), begin=4.0)
    assert isinstance(profile, Trajectory)
    assert profile.duration >= SHORTEST
    assert keeps_limits(profile, -9 * ONE, 9 * ONE, *(PLAIN[k] for k in list(PLAIN)[6:]))
    low, high = profile.extrema(0)
    assert (low >= profile.q.min(0) - 1e-12).all()
    assert (high <= profile.q.max(0) + 1e-12).all()


@given(st.integers(0, 10**6), st.sampled_from(ROBOTS), st.sampled_from(KINDS), st.integers(1, 5))
def test_the_shortest_duration_is_that_of_the_profile_and_can_be_asked_for(
    seed: int, robot: str, kind: str, n: int
) -> None:
    asked = question(np.random.default_rng(seed), robot, kind, n)
    profile, least = time_joints(*asked.args), asked.solver.shortest(*asked.states)
    assert isinstance(profile, Trajectory)
    assert isinstance(least, float)
    assert profile.duration == least
    again = time_joints(*asked.args, duration=least)
    assert isinstance(again, Trajectory)
    assert again.duration == least


def test_a_duration_of_zero_is_too_short_for_all_but_an_arm_that_stays_and_then_it_is_no_motion() -> None:
    moving = np.array([0.5, 0.1])
    for refused in (ask(duration=0.0), ask(q1=ZERO, v0=moving, v1=moving, duration=0.0)):
        assert isinstance(refused, TimingRefusal)
        assert refused.reason == "too short"
    with pytest.raises(FaultError):
        ask(q1=ZERO, duration=0.0)
