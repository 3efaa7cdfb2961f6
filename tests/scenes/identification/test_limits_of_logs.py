"""Limits that are found in made logs: right, with an error that covers the truth, or not said to be limits.

The broad set, of hundreds of logs, is `python -m docs.decisions.measure limits`; here are a few of each kind.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pytest

from assur.planner.arrays import FloatArray
from assur.scenes.identification.limits import (
    ACCEPTED_ACCELERATION,
    ACCEPTED_JERK,
    Estimate,
    JointLimits,
    joint_limits,
)
from assur.scenes.identification.recording import JointRecord
from benchmarks.recorded_motion import Limits, behind, motion, read_by_encoder

POINTS = (0.0, 1.1, 0.2, 1.9, 0.0)
FINE, COARSE = 2 * np.pi / 2**17 / 80, 1e-4


@dataclass(frozen=True)
class Log:
    """A joint from rest to rest, as it is recorded: its limits, the rate and the encoder's step, the servo's transfer
    function, errors of times and readings."""

    acceleration: float = 40.0
    jerk: float = 1600.0
    velocity: float = 4.0
    points: Sequence[float] = POINTS
    hz: float = 250.0
    step: float = FINE
    servo: tuple[Sequence[float], Sequence[float]] | None = None
    time_error: float = 0.0
    noise: float = 0.0

    def record(self) -> JointRecord:
        random = np.random.default_rng(7)
        limits = Limits(*(np.array([x]) for x in (self.velocity, self.acceleration, self.jerk)))
        made = motion(np.array(self.points)[:, None], random.uniform(0.08, 0.15, len(self.points) - 1), limits)
        time = np.arange(0.0, made.end, 1 / self.hz)
        q = made.at(time) if self.servo is None else behind(made, time, *self.servo)
        q = read_by_encoder(q + random.normal(0.0, self.noise, q.shape), self.step, random)
        return JointRecord(time + random.normal(0.0, self.time_error, len(time)), q[:, 0])


def right(estimate: Estimate, truth: float, accepted: float) -> None:
    """An identified limit is near the truth, and its error says so."""
    assert estimate.status == "identified", estimate
    assert estimate.value is not None
    assert estimate.error is not None
    assert abs(estimate.value - truth) <= estimate.error <= accepted * estimate.value


def never_wrong(found: JointLimits, log: Log) -> None:
    """What is said is true, whatever it is."""
    for estimate, truth, accepted in (
        (found.acceleration, log.acceleration, ACCEPTED_ACCELERATION),
        (found.jerk, log.jerk, ACCEPTED_JERK),
    ):
        if estimate.status == "identified":
            right(estimate, truth, accepted)
        elif estimate.status == "lower_bound":
            assert estimate.value is not None
            assert 0 < estimate.value <= truth, estimate
        else:
            assert (estimate.value, estimate.error) == (None, None)
            assert estimate.reason is not None


@pytest.mark.parametrize(
    "log",
    [
        Log(),
        Log(hz=1000.0, acceleration=120.0, jerk=20_000.0, velocity=6.0),
        Log(step=COARSE, acceleration=15.0, jerk=500.0),
        Log(time_error=2e-5),
        Log(noise=5e-6),
        Log(servo=([1.0], [0.002, 1.0])),
        Log(points=(0.0, 1.1, 0.2, 1.9, 0.0), acceleration=10.0, jerk=700.0, velocity=2.0),
    ],
    ids=["fine", "fast", "coarse", "times", "noise", "lag", "slow"],
)
def test_plateaus_of_acceleration_and_jerk_are_identified(log: Log) -> None:
    record = log.record()
    found = joint_limits(record)
    right(found.acceleration, log.acceleration, ACCEPTED_ACCELERATION)
    right(found.jerk, log.jerk, ACCEPTED_JERK)
    assert found.velocity == pytest.approx(log.velocity, rel=2e-3)
    assert found.lag_s is not None
    lag = 0.0 if log.servo is None else log.servo[1][0]
    assert found.lag_s[0] <= lag <= found.lag_s[1]
    assert found.time_error_s == pytest.approx(log.time_error, rel=0.2, abs=2 * record.deviation / log.velocity)


def test_an_acceleration_that_was_only_touched_is_a_lower_bound() -> None:
    log = Log(points=(0.0, 0.03, 0.01, 0.045, 0.0))
    found = joint_limits(log.record())
    right(found.jerk, log.jerk, ACCEPTED_JERK)
    assert (found.acceleration.status, found.acceleration.reason) == ("lower_bound", "NO_PLATEAU")
    reached = (0.045 / 2 * log.jerk**2) ** (1 / 3)  # of the longest move: v = A²/J, and it is 2 v A/J long
    assert found.acceleration.value == pytest.approx(reached, rel=0.05)
    never_wrong(found, log)


def test_ramps_that_are_too_short_for_the_sampling_give_a_lower_bound_of_the_jerk() -> None:
    log = Log(jerk=30_000.0, step=COARSE)
    found = joint_limits(log.record())
    right(found.acceleration, log.acceleration, ACCEPTED_ACCELERATION)
    assert (found.jerk.status, found.jerk.reason) == ("lower_bound", "UNCERTAIN")
    never_wrong(found, log)


def test_a_lag_that_might_be_a_ramp_is_told_and_costs_precision() -> None:
    """Behind a lag of 10 ms ramps of 5 ms can hardly be seen; of commanded positions they can."""
    lagging = Log(servo=([1.0], [0.01, 1.0]), jerk=8000.0, step=1e-5)
    found = joint_limits(lagging.record())
    assert found.jerk.status == "lower_bound"
    assert found.lag_s is not None
    assert found.lag_s[0] <= 0.01 <= found.lag_s[1]
    never_wrong(found, lagging)
    commanded = Log(jerk=8000.0, step=1e-5)
    right(joint_limits(commanded.record(), lags=False).jerk, 8000.0, ACCEPTED_JERK)


def test_a_servo_that_swings_is_no_lag_of_first_order_and_its_jerk_is_not_told() -> None:
    w = 2 * np.pi * 12
    log = Log(servo=([w * w], [1.0, 1.2 * w, w * w]))
    found = joint_limits(log.record())
    assert (found.jerk.status, found.jerk.reason) == ("not_identifiable", "MISFIT")
    assert found.explained == 0
    never_wrong(found, log)


def test_moves_of_one_length_show_no_limit() -> None:
    log = Log(points=(0.0, 1.1, 0.0, 1.1, 0.0))
    found = joint_limits(log.record())
    for estimate, truth in ((found.acceleration, log.acceleration), (found.jerk, log.jerk)):
        assert (estimate.status, estimate.reason) == ("lower_bound", "ONE_LENGTH")
        assert estimate.value == pytest.approx(truth, rel=0.01)
    never_wrong(found, log)


def together(points: FloatArray, synchronization: str) -> tuple[list[JointRecord], Limits]:
    limits = Limits(np.array([4.0, 4.0]), np.array([40.0, 60.0]), np.array([1600.0, 3000.0]))
    made = motion(points, [0.1] * (len(points) - 1), limits, synchronization)
    time = np.arange(0.0, made.end, 0.004)
    q = read_by_encoder(made.at(time), FINE, np.random.default_rng(0))
    return [JointRecord(time, q[:, i]) for i in range(2)], limits


def test_joints_that_move_in_proportion_show_no_limit_of_either() -> None:
    """The second joint follows the first with a part of what it could do, and looks like a joint at its limit."""
    points = np.array([0.0, 1.1, 0.2, 1.9, 0.0])[:, None] * np.array([1.0, 0.9])
    records, limits = together(points, "Phase")
    alone = joint_limits(records[1])
    assert alone.acceleration.status == "identified"  # and wrong: nothing in its own record shows that
    assert alone.acceleration.value == pytest.approx(0.9 * 40, rel=1e-3)
    for i, j in ((0, 1), (1, 0)):
        found = joint_limits(records[i], [records[j]])
        assert (found.acceleration.reason, found.jerk.reason) == ("IN_PROPORTION", "IN_PROPORTION")
        assert found.acceleration.value is not None
        assert found.acceleration.value <= limits.acceleration[i]


def test_joints_that_arrive_together_but_not_in_proportion_show_their_own_limits() -> None:
    points = np.array([[0.0, 0.0], [1.1, -0.7], [0.2, 1.2], [1.9, 0.1], [0.0, 0.0]])
    records, limits = together(points, "Time")
    for i, j in ((0, 1), (1, 0)):
        found = joint_limits(records[i], [records[j]])
        right(found.acceleration, float(limits.acceleration[i]), ACCEPTED_ACCELERATION)
        right(found.jerk, float(limits.jerk[i]), ACCEPTED_JERK)


def test_braking_that_differs_from_speeding_up_gives_the_smaller_of_both_as_a_bound() -> None:
    q = np.concatenate([_asymmetric(a, b, up=40.0, down=25.0) for a, b in pairwise((0.0, 1.1, 0.2, 1.9))])
    record = JointRecord(np.arange(0.0, len(q)) * 0.004, np.round(q / FINE) * FINE)
    found = joint_limits(record)
    assert (found.acceleration.status, found.acceleration.reason) == ("lower_bound", "ASYMMETRIC")
    assert found.acceleration.value is not None
    assert 0.99 * 25 < found.acceleration.value <= 25.0


def _asymmetric(start: float, goal: float, up: float, down: float, v: float = 4.0, jerk: float = 1600.0) -> FloatArray:
    """A rest, a move that speeds up with `up` and brakes with `down`, a rest; every 4 ms."""
    durations = [0.1, up / jerk, v / up - up / jerk, up / jerk]
    brake = [down / jerk, v / down - down / jerk, down / jerk]
    way = v * (sum(durations[1:]) + sum(brake)) / 2
    durations += [(abs(goal - start) - way) / v, *brake, 0.1]
    jerks = [0, jerk, 0, -jerk, 0, -jerk, 0, jerk, 0]
    t = np.arange(0.0, sum(durations), 0.004)
    state, begin, q = np.array([0.0, 0.0, 0.0]), 0.0, np.zeros(len(t))
    for duration, j in zip(durations, jerks, strict=True):
        u = np.clip(t - begin, 0.0, duration)
        q = np.where(t >= begin, state[0] + u * (state[1] + u * (state[2] / 2 + u * j / 6)), q)
        d = duration
        state = np.array(
            [
                state[0] + d * (state[1] + d * (state[2] / 2 + d * j / 6)),
                state[1] + d * (state[2] + d * j / 2),
                state[2] + d * j,
            ]
        )
        begin += duration
    moved: FloatArray = start + np.sign(goal - start) * q
    return moved


@pytest.mark.parametrize(
    ("position", "reason"),
    [
        (np.zeros(400), "STILL"),
        (1e-4 * np.round(np.linspace(0, 10, 400)), "STILL"),
        (np.sin(np.linspace(0, 40, 400)), "NO_MOVES"),
        (np.linspace(0, 1, 400), "NO_MOVES"),
    ],
    ids=["still", "hardly", "restless", "steady"],
)
def test_a_record_without_moves_says_so(position: FloatArray, reason: str) -> None:
    found = joint_limits(JointRecord(np.arange(0.0, 400) * 0.004, position))
    assert [e.reason for e in (found.acceleration, found.jerk)] == [reason, reason]
    assert found.acceleration.status == found.jerk.status == "not_identifiable"


def test_the_same_record_gives_the_same_limits() -> None:
    log = Log(points=(0.0, 1.1, 0.2))
    assert joint_limits(log.record()) == joint_limits(log.record())
