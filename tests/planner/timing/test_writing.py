"""Profiles written as knots where switches crowd, and why the merge is as narrow as it is."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from assur.planner.timing import Profile, time_joints, writing
from assur.planner.timing.ends import Cubics
from assur.planner.timing.profile import finished
from assur.planner.timing.writing import MERGE, _excess, _write, clusters, written
from assur.planner.trajectory import Trajectory
from tests.planner.timing.legs import ROBOTS, question

A, J = 30.0, 600.0


def two_joints(apart: float, beside: float = 0.05) -> Profile:
    """Two joints from rest to rest near 3 rad, the second switching `apart` later, with pieces `beside` long."""
    joints, ends = [], []
    for number, shift in enumerate((0.0, apart)):
        lengths = np.array([beside + shift, 0.05 - shift, 0.1, 0.05, 0.05])
        jerks = np.array([J, 0.0, -J, J / 2, 0.0]) * (1 - 2 * number)
        t, states = [0.0], [np.array([3.0, 0.5, 0.0])]
        for h, j in zip(lengths.tolist(), jerks.tolist(), strict=True):
            p, v, a = states[-1]
            states.append(np.array([p + h * (v + h * (a / 2 + h * j / 6)), v + h * (a + h * j / 2), a + h * j]))
            t.append(t[-1] + h)
        p, v, a = ([float(state[k]) for state in states] for k in range(3))
        joints.append(Cubics(t, p, v, a, [*jerks.tolist(), 0.0], 2 * A, J))
        ends.append([*states[0], *states[-1]])
    rows = [list(row) for row in zip(*ends, strict=True)]
    return finished(joints, rows, t[-1])


@pytest.mark.parametrize("apart", [0.0, 1e-13, 1e-9, 1e-7, 9e-7, 1.1e-6, 3e-6, 1e-5, 1e-4])
def test_two_joints_that_switch_almost_together_keep_their_jerk(apart: float) -> None:
    profile = two_joints(apart)
    for offset in (0.0, 0.1, 3.7, 599.0):
        path = Trajectory(*profile.knots(offset))
        assert np.abs(path.bernstein(3)).max() <= J * 1.01


def test_a_merge_of_ten_microseconds_would_break_the_reserves_where_one_does_not() -> None:
    rng, narrow, wide = np.random.default_rng(6), [], []
    for robot, manner in itertools.product(ROBOTS, ("rest", "accelerating")):
        for _ in range(150):
            profile = time_joints(*question(rng, robot, manner, least=1e-3).args)
            assert isinstance(profile, Profile)
            narrow.append(_excess(profile, _write(profile, 1.3, MERGE)))
            wide.append(_excess(profile, _write(profile, 1.3, 1e-5)))
    assert max(narrow) <= 1
    assert max(wide) > 1


def test_knots_that_were_only_rounded_would_break_it_too(monkeypatch: pytest.MonkeyPatch) -> None:
    profile = two_joints(2e-6)
    good = _excess(profile, _write(profile, 3.7, MERGE))
    monkeypatch.setattr(writing, "settled", lambda _h, qd, qdd, _left_over: (qd, qdd))
    assert good <= writing.ENOUGH < 1 < _excess(profile, _write(profile, 3.7, MERGE))


def crowded() -> Profile:
    """Four joints with a dozen switches within 60 µs, near 3 rad."""
    joints: list[tuple[list[float], list[list[float]], list[float]]] = []
    ends: list[list[float]] = []
    for number in range(4):
        lengths = [0.02 + 3e-6 * number, 4e-6 + 1e-6 * number, 0.02, 2e-6 + 3e-6 * number, 0.02]
        jerks = [J, 0.0, -J, 0.0, J / 2]
        t, states = [0.0], [(3.0 - number, 0.2, 0.0)]
        for h, j in zip(lengths, jerks, strict=True):
            p, v, a = states[-1]
            states.append((p + h * (v + h * (a / 2 + h * j / 6)), v + h * (a + h * j / 2), a + h * j))
            t.append(t[-1] + h)
        joints.append((t, [[state[k] for state in states] for k in range(3)], jerks))
        ends.append([*states[0], *states[-1]])
    duration = max(t[-1] for t, _, _ in joints)
    made = []
    for (t, columns, jerks), end in zip(joints, ends, strict=True):
        made.append(Cubics(t, columns[0], columns[1], columns[2], [*jerks, 0.0], A, J))
        # Each goes on at constant acceleration until the last is there.
        end[3:] = list(made[-1].at(-1, duration - t[-1]))
    return finished(made, [list(row) for row in zip(*ends, strict=True)], duration)


def test_where_switches_crowd_the_best_of_several_ways_to_write_is_taken() -> None:
    profile = crowded()
    plain = _excess(profile, _write(profile, 4.0, MERGE))
    best = _excess(profile, written(profile, 4.0))
    assert plain > writing.ENOUGH
    assert best <= 1
    for width in writing.WIDTHS:
        assert best <= _excess(profile, _write(profile, 4.0, width, relax=True))


def test_least_squares_do_not_change_what_is_good_already() -> None:
    rng = np.random.default_rng(5)
    for _ in range(20):
        profile = time_joints(*question(rng, "problems", "moving", least=0.1).args)
        assert isinstance(profile, Profile)
        plain, relaxed = (_write(profile, 1.0, MERGE, relax=relax) for relax in (False, True))
        assert np.array_equal(plain[0], relaxed[0])
        assert np.array_equal(plain[1], relaxed[1])
        assert np.abs(plain[2] - relaxed[2]).max() <= 1e-8
        assert np.abs(plain[3] - relaxed[3]).max() <= 1e-3
        assert _excess(profile, relaxed) <= 1


def test_clusters_begin_and_end_with_the_motion_and_hold_every_switch() -> None:
    profile = crowded()
    for width in (1e-9, 1e-6, 1e-5, 1e-3):
        low, high = clusters(profile, width)
        assert low[0] == 0
        assert high[-1] == profile.duration
        assert (high - low <= width).all()
        assert (low[1:] > high[:-1]).all()
        inside = (profile.time[..., None] >= low) & (profile.time[..., None] <= high)
        assert inside.any(-1).all()
