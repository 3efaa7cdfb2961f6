"""What Ruckig answers to questions that should not have been asked: the reasons for the guards in
`assur.planner.timing`."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import numpy as np
import pytest
import ruckig
from numpy.typing import NDArray

from assur.planner.errors import InputError
from assur.planner.timing import TimingRefusal
from assur.planner.trajectory import Trajectory
from tests.hazards.known import mended_since
from tests.planner.timing.legs import time_joints

Floats = NDArray[np.float64]
LAST_SEEN = "0.19.4"
"""The release of ruckig in which everything here was reproduced."""
LIMITS = {"velocity": [1.0], "acceleration": [2.0], "jerk": [5.0]}


def _input(**changed: Any) -> Any:
    """One joint from rest at 0 to rest at 1."""
    asked = ruckig.InputParameter(1)
    asked.current_position, asked.target_position = [0.0], [1.0]
    asked.max_velocity, asked.max_acceleration, asked.max_jerk = (
        LIMITS["velocity"],
        LIMITS["acceleration"],
        LIMITS["jerk"],
    )
    for name, value in changed.items():
        setattr(asked, name, value)
    return asked


def _duration(**changed: Any) -> float:
    found = ruckig.Trajectory(1)
    result = ruckig.Ruckig(1).calculate(_input(**changed), found)
    assert result in (ruckig.Result.Working, ruckig.Result.Finished)
    return float(found.duration)


def _timed(*, duration: Any = None, **changed: Any) -> Trajectory | TimingRefusal:
    """The same question to our door."""
    states = {"q0": [0.0], "v0": [0.0], "a0": [0.0], "q1": [1.0], "v1": [0.0], "a1": [0.0], **LIMITS, **changed}
    arguments: dict[str, Any] = {name: np.array(value, dtype=np.float64) for name, value in states.items()}
    return time_joints(*arguments.values(), duration=duration)


def test_a_duration_that_is_not_a_number_is_ignored_by_ruckig_and_bad_input_for_us() -> None:
    assert _duration(minimum_duration=float("nan")) == _duration() or mended_since("ruckig", LAST_SEEN)
    with pytest.raises(InputError):
        _timed(duration=float("nan"))


def test_a_duration_that_is_too_short_is_replaced_by_ruckig_and_refused_by_us_with_the_time_missing() -> None:
    shortest = _duration()
    assert _duration(minimum_duration=0.1) == shortest
    refused = _timed(duration=0.1)
    assert isinstance(refused, TimingRefusal)
    assert refused.reason in ("too short", "blocked")
    assert refused.excess >= shortest - 0.1


def test_a_start_beyond_a_limit_is_planned_by_ruckig_and_refused_by_us() -> None:
    assert _duration(current_velocity=[1.5]) > 0 or mended_since("ruckig", LAST_SEEN)
    refused = _timed(v0=[1.5])
    assert isinstance(refused, TimingRefusal)
    assert refused.reason == "limits"


def test_a_motion_longer_than_ruckig_can_state_is_answered_by_ruckig_and_not_by_us() -> None:
    assert _duration(target_position=[1e6]) > 7e3 or mended_since("ruckig", LAST_SEEN)
    assert isinstance(_timed(q1=[1e6]), TimingRefusal)


def test_limits_without_end_are_taken_by_ruckig_and_bad_input_for_us() -> None:
    assert _duration(max_jerk=[float("inf")]) > 0 or mended_since("ruckig", LAST_SEEN)
    for name in LIMITS:
        for value in (float("inf"), float("nan")):
            with pytest.raises(InputError):
                _timed(**{name: [value]})


def test_lists_of_different_length_are_bad_input_before_ruckig_reads_beyond_them() -> None:
    for name in ("q0", "v1", "velocity", "jerk"):
        with pytest.raises(InputError):
            _timed(**{name: [1.0, 1.0]})


def test_a_time_that_is_not_a_number_kills_ruckig_or_is_foreign_memory_and_we_ask_for_no_state_at_all(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    program = (
        "import ruckig as r; i = r.InputParameter(1); i.target_position = i.max_velocity = i.max_acceleration = [1.0];"
        "i.max_jerk = [5.0]; t = r.Trajectory(1); r.Ruckig(1).calculate(i, t); print(t.at_time(float('nan')))"
    )
    asked = subprocess.run([sys.executable, "-c", program], capture_output=True, check=False, text=True)
    assert asked.returncode < 0 or "nan" in asked.stdout or mended_since("ruckig", LAST_SEEN)

    def refuse(*_: Any) -> Any:
        raise AssertionError("a state was asked for")

    monkeypatch.setattr(ruckig.Trajectory, "at_time", refuse)
    assert isinstance(_timed(), Trajectory)


def test_in_metres_radians_and_seconds_ruckig_finds_every_motion_that_we_ask_for() -> None:
    rng = np.random.default_rng(4)
    limits = {
        "velocity": [7.8, 9.4, 2.0, 40.0],
        "acceleration": [50.0, 80.0, 25.0, 300.0],
        "jerk": [1000.0, 1600.0, 500.0, 6000.0],
    }
    speed = np.array(limits["velocity"])
    for _ in range(300):
        states = {name: rng.uniform(-2, 2, 4) for name in ("q0", "q1")}
        states |= {name: rng.uniform(-0.5, 0.5, 4) * speed for name in ("v0", "v1")}
        states |= {name: np.zeros(4) for name in ("a0", "a1")}
        found = _timed(**states, **limits)
        assert isinstance(found, Trajectory), found
        for reached, name in ((found.q[-1], "q1"), (found.qd[-1], "v1"), (found.qdd[-1], "a1")):
            assert np.array_equal(reached, states[name])
