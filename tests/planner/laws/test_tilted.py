"""Motions with pitch and roll: what becomes of both when a motion is shifted, cut or stopped."""

from __future__ import annotations

import numpy as np
import pytest

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Motion, Pose
from tests.planner.laws.test_motions_of_laws import PARTS

TILTS = ("tilt", "tilt_d", "tilt_dd", "tilt_ddd")
OFFSET = Pose(0.1, -0.2, 0.3, 0.4)


def upright(times: int = 5) -> Motion:
    rng = np.random.default_rng(3)
    return Motion.of(*rng.normal(size=(4, times, 3)), *rng.normal(size=(4, times)))


def tilted(times: int = 5) -> Motion:
    rates: FloatArray = np.random.default_rng(4).normal(size=(4, times, 2))
    return upright(times).with_tilt(*rates)


def same(one: Motion, other: Motion, names: tuple[str, ...]) -> bool:
    return all(np.array_equal(getattr(one, name), getattr(other, name)) for name in names)


def test_beside_a_hand_a_point_moves_as_it_does_beside_an_upright_frame_and_has_the_hands_pitch_and_roll() -> None:
    beside = tilted().at(OFFSET)
    assert same(beside, upright().at(OFFSET), PARTS)
    assert same(beside, tilted(), TILTS)


def test_some_of_the_times_are_those_of_every_array() -> None:
    whole = tilted()
    for key in (2, slice(1, 4), np.array([4, 0])):
        part = whole[key]
        assert part.tilted
        assert all(np.array_equal(getattr(part, name), getattr(whole, name)[key]) for name in (*PARTS, *TILTS))


def test_a_hand_at_rest_keeps_its_attitude_and_nothing_else() -> None:
    still = tilted().at_rest()
    assert same(still, tilted(), ("p", "yaw", "tilt"))
    assert not any(getattr(still, name).any() for name in ("v", "a", "j", "yaw_d", "yaw_dd", "yaw_ddd", *TILTS[1:]))


def test_one_attitude_without_rates_holds_at_all_times() -> None:
    held = upright().with_tilt(np.array([-1.5, 0.2]))
    assert held.tilt.tolist() == [[-1.5, 0.2]] * 5
    assert not any(getattr(held, name).any() for name in TILTS[1:])


def test_motions_that_stay_upright_have_no_tilt_also_where_they_are_read_at_a_single_time() -> None:
    assert tilted()[3].tilted
    assert not upright().tilted
    assert not upright()[3].at(OFFSET).at_rest().tilted
    with pytest.raises(IndexError):
        _ = upright().tilt
