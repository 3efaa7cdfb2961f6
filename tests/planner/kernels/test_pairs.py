"""Pairs of bodies of a phase, from tables that are written by hand: shifts in time, and what a part stands on."""

from __future__ import annotations

import numpy as np
import pytest

from assur.planner.claim import columns as c
from assur.planner.kernels.pairs import CONTACT, NEAR, TRAVEL, pairs_of_phase
from assur.planner.kernels.solids import EARLY, FIRST, LATE, REQUIRED, SECOND, SET

ARM, TABLE, PART, CART = range(4)
WORLD, BELT = 0, 1
LATE_S = 0.2


def pairs(supported: bool = False, contact: bool = False) -> dict[tuple[int, int], tuple[float, ...]]:
    """Of an arm, a table that stands still, a part that was put down on it, and a cart on a belt that may be early by
    100 ms or late by 300 ms: required distance, set, shifts in time, and what requires the distance, by both bodies."""
    seats = np.zeros((4, c.SEAT_POSE + 4))
    seats[:, c.SEAT_BODY], seats[:, c.SEAT_LINK] = range(4), (0, -1, -1, -1)
    seats[:, c.SEAT_FRAME] = -1, WORLD, WORLD, BELT
    required = np.zeros(c.REQUIRED)
    required[c.REQUIRED_TRAVEL], required[c.REQUIRED_NEAR], required[c.REQUIRED_LATE] = 0.02, 0.005, LATE_S
    frames = np.array([1, 0]), np.zeros(2), np.array([[0.0, -0.1], [0.0, 0.3]])
    distances = np.zeros((1, 1)), required, np.zeros((0, c.RULE_SIDE + 8)), np.zeros((0, c.DISPLACED_SHARED + 1))
    contacts = np.array([[0.0, ARM, TABLE, 0.001]]) if contact else np.zeros((0, c.CONTACT))
    supports = np.zeros((1, 4))
    supports[0, CART] = supported
    story = np.zeros(8), np.zeros(4), contacts, np.array([[0.0, PART]]), supports
    rows, kinds, sets, across, own = pairs_of_phase(
        (seats, np.arange(4), np.zeros(4)), frames, distances, story, False, True
    )
    assert (across, own, len(sets)) == (3, 3, 0)
    columns = rows[:, [REQUIRED, SET, EARLY, LATE]].tolist()
    return {
        (int(row[FIRST]), int(row[SECOND])): (*found, float(kind))
        for row, found, kind in zip(rows, columns, kinds, strict=True)
    }


def test_what_moves_is_shifted_in_time_against_the_arm_and_against_a_part() -> None:
    found = pairs()
    assert found.keys() == {(ARM, TABLE), (ARM, PART), (ARM, CART), (PART, CART)}
    assert found[ARM, TABLE] == found[ARM, PART] == (0.02, -1.0, 0.0, 0.0, TRAVEL)
    assert found[ARM, CART] == pytest.approx((0.02, -1.0, -0.3, LATE_S + 0.1, TRAVEL))
    assert found[PART, CART] == pytest.approx((0.005, -1.0, -0.3, 0.1, NEAR))


def test_a_part_need_not_keep_clear_of_what_it_stands_on() -> None:
    assert (PART, CART) not in pairs(supported=True)


def test_a_pair_that_may_touch_may_be_as_deep_as_its_contact() -> None:
    assert pairs(contact=True)[ARM, TABLE] == (-0.001, -1.0, 0.0, 0.0, CONTACT)
