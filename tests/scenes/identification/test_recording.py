"""What is read off a record before anything is fitted: steps, errors, rests and moves; and records that are refused."""

from __future__ import annotations

import numpy as np
import pytest

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.scenes.identification.recording import JointRecord, fault_of_times
from benchmarks.recorded_motion import Limits, motion, read_by_encoder
from tests.refused import refused_at

LIMITS = Limits(np.array([4.0]), np.array([40.0]), np.array([1600.0]))
STEPS = [2 * np.pi / 2**17 / 50, 2 * np.pi / 2**17 / 100, 2 * np.pi / 2**20 / 50, 1e-4, 3e-5]


def readings(step: float, hz: float = 1000.0) -> tuple[FloatArray, FloatArray]:
    made = motion(np.array([[0.0], [0.8], [0.3], [1.5], [0.0]]), [0.1, 0.0, 0.1, 0.1], LIMITS)
    time = np.arange(0.0, made.end, 1 / hz)
    return time, read_by_encoder(made.at(time), step, np.random.default_rng(0))[:, 0]


@pytest.mark.parametrize("hz", [250.0, 1000.0])
@pytest.mark.parametrize("step", STEPS)
def test_the_step_of_the_encoder_is_found_or_left_open_but_never_wrong(step: float, hz: float) -> None:
    record = JointRecord(*readings(step, hz))
    if hz == 1000:
        assert record.encoder_step == pytest.approx(step, rel=1e-3)
    else:  # there may be too few slow readings
        assert record.encoder_step in (None, pytest.approx(step, rel=1e-3))
    assert record.deviation >= 0.99 * step / np.sqrt(12)


def test_noise_has_no_step_and_its_size_is_known_roughly() -> None:
    time, q = readings(1e-6)
    record = JointRecord(time, q + np.random.default_rng(0).normal(0, 2e-5, len(q)))
    assert record.encoder_step is None
    assert 0.4 * 2e-5 < record.deviation < 1.2 * 2e-5


def test_rests_and_moves_are_cut_out_and_a_stop_for_no_time_is_no_rest() -> None:
    record = JointRecord(*readings(1e-5))
    assert len(record.rests()) == 4  # before, after the first, third and last move
    segments = record.segments()
    assert [len(s.moved) for s in segments] == [1, 2, 1]
    assert [x for s in segments for x in s.moved] == pytest.approx([0.8, -0.5, 1.2, -1.5], abs=1e-2)
    for s in segments:
        assert np.ptp(s.position[s.time < s.begins[0] - 0.01]) <= record.resolution
        assert (s.weight <= 1 / record.deviation).all()


def test_readings_that_repeat_weigh_as_one() -> None:
    (first, *_) = JointRecord(*readings(1e-4)).segments()
    still = first.weight[:10] * first.weight[0] ** -1
    assert still == pytest.approx(np.ones(10))
    assert first.weight.max() > 5 * first.weight[0]


def test_an_error_of_the_times_takes_weight_from_what_is_fast() -> None:
    record = JointRecord(*readings(1e-6))
    sharp, vague = record.segments()[0], record.segments(1e-4)[0]
    fast = int(np.argmax(np.abs(sharp.speed)))
    assert vague.weight[fast] < 0.1 * sharp.weight[fast]
    assert vague.weight[0] == pytest.approx(sharp.weight[0], rel=1e-2)


def test_a_mean_speed_is_never_above_the_speed() -> None:
    assert 3.9 < JointRecord(*readings(1e-5)).fastest() <= 4.0


def test_more_moves_without_a_rest_than_are_fitted_together_are_left_out() -> None:
    points = np.array([[0.0], *([[0.5], [0.0]] * 4)])
    made = motion(points, [0.0] * 8, LIMITS)
    time = np.arange(0.0, made.end, 0.002)
    assert JointRecord(time, made.at(time)[:, 0]).segments() == []


EVEN = np.arange(0.0, 100) * 0.001


def changed(time: FloatArray, row: int, value: float) -> FloatArray:
    found = time.copy()
    found[row] = value
    return found


@pytest.mark.parametrize(
    ("time", "row", "words"),
    [
        (EVEN[:49], 48, "at least 50 rows"),
        (changed(EVEN, 7, EVEN[6]), 7, "later than the row before"),
        (changed(EVEN, 7, -1.0), 7, "later than the row before"),
        (EVEN * 1e-3, 1, "rows 1e-05 to 0.05 s apart"),
        (EVEN * 100, 1, "rows 1e-05 to 0.05 s apart"),
        (np.delete(EVEN, slice(20, 25)), 20, "5e-05 to 0.004 s after the row before"),
        (changed(EVEN, 7, EVEN[6] + 2e-5), 7, "5e-05 to 0.004 s after the row before"),
    ],
)
def test_times_that_are_no_record_are_refused_at_their_row(time: FloatArray, row: int, words: str) -> None:
    found = fault_of_times(time)
    assert found is not None
    assert found[0] == row
    assert words in found[1]
    with refused_at(f"time[{row}]"):
        JointRecord(time, np.zeros(len(time)))


def test_times_may_be_uneven_to_a_degree() -> None:
    uneven = EVEN + np.random.default_rng(0).uniform(0, 3e-4, len(EVEN))
    assert fault_of_times(np.delete(uneven, [20, 21])) is None


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_reading_that_is_no_number_is_refused(value: float) -> None:
    with refused_at("position"):
        JointRecord(EVEN, changed(np.zeros(100), 3, value))
    with pytest.raises(InputError):
        JointRecord(EVEN, np.zeros(99))
