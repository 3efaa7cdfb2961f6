"""The door to FCL: right about who touches, fresh every time, and deaf to poses that are none."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.collision.fcl_entry import Collider
from assur.planner.errors import FaultError
from assur.planner.geometry.shapes import Piece, box, sphere
from tests.planner.cells import placed, rotation
from tests.planner.convex import KINDS, anywhere, distance, grid_aligned, inside, pairs, shape_of
from tests.planner.second_solids import Placed


def touch(collider: Collider, a: Placed, b: Placed, row: int = 0) -> bool:
    """What the door says of the pair in a row."""
    return collider.touch(a.posed(row), b.posed(row))


DECIDED_M = 1e-5
"""Nearer to touching than this FCL is not asked to be right."""


@given(pairs())
def test_what_is_apart_does_not_touch(both: tuple[Piece, Piece]) -> None:
    if distance(*both) > DECIDED_M:
        assert not touch(Collider(), *placed([both]))


@given(st.one_of(grid_aligned(), anywhere()), st.one_of(grid_aligned(), anywhere()), st.integers(0, 10**6))
def test_what_has_a_common_point_well_inside_touches(one: Piece, other: Piece, seed: int) -> None:
    rng = np.random.default_rng(seed)
    # towards the middle of the solid, so that the common point is not on its surface
    x, y = (0.9 * (inside(piece, rng)[0] - _middle(piece)) + _middle(piece) for piece in (one, other))
    moved = Piece(other.shape, other.position + x - y, other.rotation)
    assert touch(Collider(), *placed([(one, moved)]))


def _middle(piece: Piece) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    vertices = getattr(piece.shape, "vertices", np.zeros((1, 3)))
    return np.asarray(piece.position + piece.rotation @ vertices.mean(0))


def test_all_pairs_of_kinds_agree_with_the_sign_of_the_gap_along_a_line() -> None:
    collider = Collider()
    rng = np.random.default_rng(3)
    for first, second in itertools.product(KINDS, KINDS):
        for turned in (np.eye(3), rotation(rng)):
            a = Piece(shape_of(first, (0.1, 0.1, 0.1), 1), np.zeros(3), turned)
            seen = set()
            for x in np.arange(-0.4, 0.41, 0.05):
                b = Piece(shape_of(second, (0.1, 0.05, 0.1), 1), np.array([x, 0.05, 0.0]))
                gap = distance(a, b)
                if abs(gap) > 1e-4:
                    assert touch(collider, *placed([(a, b)])) == (gap < 0), (first, second, x)
                    seen.add(gap < 0)


@pytest.mark.parametrize("gap", [1e-4, -1e-4])
def test_grid_aligned_boxes_that_face_each_other_are_told_apart_to_a_tenth_of_a_millimetre(gap: float) -> None:
    a = Piece(box(0.1, 0.1, 0.1))
    for axis in range(3):
        for side in (-1.0, 1.0):
            p = np.zeros(3)
            p[axis] = side * (0.1 + gap)
            assert touch(Collider(), *placed([(a, Piece(box(0.1, 0.1, 0.1), p))])) == (gap < 0)


def test_an_answer_never_sticks() -> None:
    shape, other = box(0.1, 0.1, 0.1), sphere(0.05)
    near, far = np.array([0.08, 0.0, 0.0]), np.array([0.3, 0.0, 0.0])
    a, b = placed([(Piece(shape), Piece(other, p)) for p in (near, far, near, far)])
    collider = Collider()
    asked = (0, 1, 2, 3, 1, 0, 0, 1)
    assert [touch(collider, a, b, k) for k in asked] == [k in (0, 2) for k in asked]


def test_a_pose_that_is_none_is_a_fault() -> None:
    a, b = placed([(Piece(box(0.1, 0.1, 0.1)), Piece(sphere(0.05)))])
    collider = Collider()
    assert touch(collider, a, b, 0)
    for bad in (np.nan, np.inf):
        with pytest.raises(FaultError):
            touch(collider, replace(a, centre=a.centre + bad), b, 0)
        with pytest.raises(FaultError):
            touch(collider, a, replace(b, axes=np.full_like(b.axes, bad)), 0)
    for scale in (0.0, 1e-3, 1 + 1e-8, 2.0):
        with pytest.raises(FaultError):
            touch(collider, replace(a, axes=a.axes * scale), b, 0)
    sheared = a.axes.copy()
    sheared[0, 0, 1] = 0.1
    with pytest.raises(FaultError):
        touch(collider, replace(a, axes=sheared), b, 0)
    assert touch(collider, a, b, 0)
