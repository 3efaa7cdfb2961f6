"""Profiles laid over one another: arches, standing still in between, and what does not fit together."""

from __future__ import annotations

import numpy as np
import pytest

from assur.planner.errors import FaultError
from assur.planner.timing import Profile, combine, time_joints, to_trajectory
from assur.planner.trajectory import keeps_limits

VELOCITY, ACCELERATION, JERK = np.array([6.98, 11.69, 2.4]), np.array([125.0, 210.0, 43.0]), np.array([6e3, 1e4, 2e3])


def across(v1: float = 0.0) -> Profile:
    """Joints 0 and 1 from rest; joint 1 may arrive in motion."""
    zero = np.zeros(2)
    found = time_joints(
        np.array([0.3, 1.2]), zero, zero, np.array([-0.5, 0.4]), np.array([0.0, v1]), zero,
        VELOCITY[:2], ACCELERATION[:2], JERK[:2],
    )  # fmt: skip
    assert isinstance(found, Profile)
    return found


def lift(low: float, high: float, v0: float = 0.0, v1: float = 0.0) -> Profile:
    zero = np.zeros(1)
    ends = (np.array([low]), np.array([v0]), zero, np.array([high]), np.array([v1]), zero)
    found = time_joints(*ends, VELOCITY[2:], ACCELERATION[2:], JERK[2:])
    assert isinstance(found, Profile)
    return found


def arch() -> tuple[Profile, list[Profile], list[float]]:
    parts = [lift(0.0, 0.05), across(), lift(0.05, 0.01)]
    offsets = [0.0, 0.4 * parts[0].duration, 0.0]
    offsets[2] = offsets[1] + parts[1].duration - 0.5 * parts[2].duration
    return combine(parts, offsets, joints=[[2], [0, 1], [2]]), parts, offsets


def test_an_arch_is_each_of_its_profiles_in_its_time_and_stands_still_otherwise() -> None:
    whole, (up, flat, down), offsets = arch()
    assert whole.n == 3
    assert whole.duration == pytest.approx(offsets[2] + down.duration)
    t = np.linspace(0, whole.duration, 997)
    for derivative in range(3):
        values = whole.evaluate(t, derivative)
        wanted = np.zeros((len(t), 3))
        for profile, offset, joints in zip((up, flat, down), offsets, ([2], [0, 1], [2]), strict=True):
            late = np.clip(t - offset, 0.0, profile.duration)
            values_of_part = profile.evaluate(late, derivative)
            for column, joint in enumerate(joints):
                # The way down begins where the way up has ended: before its time it has no say.
                rows = t >= offset if profile is down else np.ones(len(t), dtype=bool)
                wanted[rows, joint] = values_of_part[rows, column]
        assert np.abs(values - wanted).max() <= 1e-9


def test_an_arch_as_knots_keeps_the_limits_of_its_joints() -> None:
    whole, parts, _ = arch()
    path = to_trajectory(whole, 2.7)
    assert np.array_equal(path.q[0], [0.3, 1.2, 0.0])
    assert np.array_equal(path.q[-1], [-0.5, 0.4, 0.01])
    assert path.rest_at_start
    assert path.rest_at_end
    wide = np.full(3, 9.0)
    assert keeps_limits(path, -wide, wide, VELOCITY, ACCELERATION, JERK)
    assert whole.limits[:, 2] == pytest.approx(parts[0].limits[:, 0])


def test_profiles_of_different_joints_take_them_one_after_another() -> None:
    whole = combine([across(), lift(0.0, 0.1)], [0.0, 0.01])
    assert whole.n == 3
    assert np.array_equal(whole.end[0], [-0.5, 0.4, 0.1])
    assert np.isfinite(to_trajectory(whole).qdd).all()


def test_a_whole_may_last_longer_than_its_parts() -> None:
    whole = combine([lift(0.0, 0.1)], [0.25], duration=2.0)
    assert whole.duration == 2.0
    assert whole.evaluate(np.array([0.0, 0.2, 1.9, 2.0]))[:, 0] == pytest.approx([0.0, 0.0, 0.1, 0.1])
    assert to_trajectory(whole).end == 2.0


def test_a_profile_in_motion_at_an_end_may_be_the_first_or_the_last_but_nothing_may_stand_still_there() -> None:
    moving = lift(0.0, 0.2, v1=0.3)
    alone = combine([moving], [0.1])
    assert alone.end[1][0] == 0.3
    assert to_trajectory(alone).qd[-1, 0] == 0.3
    with pytest.raises(FaultError, match="stands still from"):
        combine([moving], [0.0], duration=moving.duration + 0.1)
    with pytest.raises(FaultError, match="stands still until"):
        combine([lift(0.0, 0.2, v0=0.3)], [0.1])
    with pytest.raises(FaultError, match="stands still until"):
        combine([moving, lift(0.2, 0.0)], [0.0, moving.duration], joints=[[0], [0]])


@pytest.mark.parametrize(
    ("profiles", "offsets", "duration", "joints", "message"),
    [
        ([], [], None, None, "0 profiles"),
        ([1], [0.0, 1.0], None, None, "1 profiles and 2 offsets"),
        ([1], [-1e-3], None, None, "do not fit"),
        ([1], [np.nan], None, None, "do not fit"),
        ([1], [1.0], 0.9, None, "do not fit"),
        ([1], [0.0], None, [[0, 1]], "a profile of 1 joints"),
        ([1], [0.0], None, [[1]], "only"),
        ([1, 1], [0.0, 0.01], None, [[0], [0]], "ends at"),
        ([1, 1], [0.0, 5.0], None, [[0], [0]], "begins at"),
    ],
)
def test_what_does_not_fit_together_is_a_fault(
    profiles: list[int], offsets: list[float], duration: float | None, joints: list[list[int]] | None, message: str
) -> None:
    with pytest.raises(FaultError, match=message):
        combine([lift(0.0, 0.1) for _ in profiles], offsets, duration, joints)
