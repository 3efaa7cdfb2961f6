"""Every law's derivatives are those of its pose, and nothing jumps that may not."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import example, given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.laws import Change, Law, Motion, Pose, conveyor
from tests.planner.laws.laws import Case, cases

PARTS = ("p", "v", "a", "j", "yaw", "yaw_d", "yaw_dd", "yaw_ddd")
"""Arrays of a motion."""
STEP_S = 2e-4
"""Step of the differences, which are of fourth order."""
SNAP = 1e7
"""Above the fourth derivative of any law that is drawn, SI."""


def stacked(motion: Motion) -> FloatArray:
    """(4 orders, ..., 4 coordinates)."""
    yaws = (motion.yaw, motion.yaw_d, motion.yaw_dd, motion.yaw_ddd)
    vectors = (motion.p, motion.v, motion.a, motion.j)
    return np.stack([np.concatenate([p, y[..., None]], axis=-1) for p, y in zip(vectors, yaws, strict=True)])


def differences(law: Law, t: FloatArray) -> FloatArray:
    """Central differences of orders 0 to 2, (3, T, 4)."""
    before2, before, after, after2 = (stacked(law.motion(t + k * STEP_S))[:3] for k in (-2, -1, 1, 2))
    return (before2 - 8 * before + 8 * after - after2) / (12 * STEP_S)


@given(cases(), st.lists(st.floats(0, 1), min_size=1, max_size=20))
@example(Case(conveyor(Pose(), 0.0, (Change(0.0, 1.0, 2.0, 8.0),)), (-1.0, 2.0), (0.0, 0.25, 0.5, 0.75), 3), [0.4])
def test_each_derivative_is_the_difference_quotient_of_the_one_below(case: Case, where: list[float]) -> None:
    low, high = case.window[0] + 3 * STEP_S, case.window[1] - 3 * STEP_S
    t = low + np.array(where) * (high - low)
    switches = np.array([*case.switches, math.inf])
    smooth = np.abs(t[:, None] - switches).min(axis=1) > 3 * STEP_S
    exact = stacked(case.law.motion(t))
    scale = 1 + np.abs(stacked(case.law.motion(np.linspace(*case.window, 400)))).max(axis=(1, 2))
    for order in range(3):
        wrong = np.abs(differences(case.law, t) - exact[1:])[order]
        assert (wrong.max(axis=1)[smooth] <= 1e-6 * scale[order + 1]).all()


@given(cases())
def test_nothing_below_the_allowed_order_jumps_at_a_switch(case: Case) -> None:
    for time in case.switches:
        if case.window[0] < time < case.window[1]:
            step = 1e-9
            both = stacked(case.law.motion(np.array([time - step, np.nextafter(time, -9), time, time + step])))
            for order in range(min(case.jumps, 4)):
                slope = np.abs(both[order + 1]).max() if order < 3 else SNAP
                assert np.ptp(both[order], axis=0).max() <= 2 * step * slope + 1e-11 * (1 + np.abs(both[order]).max())


@given(cases())
def test_a_motion_has_the_shape_of_its_times_and_each_row_is_that_of_its_time(case: Case) -> None:
    t = np.linspace(*case.window, 6)
    row, table = case.law.motion(t), case.law.motion(t.reshape(2, 3))
    for name in PARTS:
        tail = (3,) if name in "pvaj" else ()
        assert getattr(table, name).shape == (2, 3, *tail)
        np.testing.assert_array_equal(getattr(table, name).reshape(6, *tail), getattr(row, name))
        single = getattr(case.law.motion(np.array(t[2])), name)
        assert single.shape == tail
        np.testing.assert_array_equal(single, getattr(row, name)[2])
