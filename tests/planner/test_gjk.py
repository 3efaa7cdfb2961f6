"""GJK against closed forms and against another method, for all pairs of kinds."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.geometry.shapes import Piece, box, capsule, sphere
from assur.planner.kernels.gjk import nearest_to_origin
from tests.planner.cells import placed, rotation
from tests.planner.convex import KINDS, anywhere, distance, grid_aligned, inside, pairs, shape_of
from tests.planner.second_solids import Placed, distance_by_gjk, gaps

EXACT_M = 1e-6


def separate(a: Placed, b: Placed, row: int = 0) -> tuple[float, FloatArray | None]:
    """Distance and the normal that shows it; 0 and None where the two meet."""
    gap, normal, above = distance_by_gjk(a, b, row)
    assert gap <= above + 1e-9
    return (max(0.0, gap), normal) if above > 0.0 else (0.0, None)


@given(pairs())
def test_the_distance_is_that_of_another_method(both: tuple[Piece, Piece]) -> None:
    found, normal = separate(*placed([both]), 0)
    true = distance(*both)
    if true > EXACT_M:
        assert found == pytest.approx(true, abs=EXACT_M)
        assert normal is not None
    else:
        assert found <= EXACT_M


def test_every_pair_of_kinds_apart_and_near_is_measured() -> None:
    rng = np.random.default_rng(5)
    for first, second in itertools.product(KINDS, KINDS):
        for scale in (0.4, 0.13):
            a = Piece(shape_of(first, (0.1, 0.05, 0.1), 4), np.zeros(3), rotation(rng))
            way = rng.normal(size=3)
            b = Piece(shape_of(second, (0.05, 0.1, 0.02), 8), scale * way / np.linalg.norm(way), rotation(rng))
            found, _n = separate(*placed([(a, b)]), 0)
            assert found == pytest.approx(max(0.0, distance(a, b)), abs=EXACT_M), (first, second, scale)


@given(pairs())
def test_the_normal_shows_the_distance(both: tuple[Piece, Piece]) -> None:
    a, b = placed([both])
    found, normal = separate(a, b, 0)
    if normal is None:
        assert found == 0.0
        return
    assert np.linalg.norm(normal) == pytest.approx(1.0, abs=1e-12)
    gap = gaps(a, b, normal[None, None])[0, 0]
    assert max(0.0, gap) == pytest.approx(found, abs=1e-12 + 1e-9 * found)


@given(st.one_of(grid_aligned(), anywhere()), st.one_of(grid_aligned(), anywhere()), st.integers(0, 10**6))
def test_solids_with_a_common_point_have_no_distance(one: Piece, other: Piece, seed: int) -> None:
    rng = np.random.default_rng(seed)
    x, y = inside(one, rng)[0], inside(other, rng)[0]
    moved = Piece(other.shape, other.position + x - y, other.rotation)
    found, _ = separate(*placed([(one, moved)]), 0)
    assert found <= 1e-9


@pytest.mark.parametrize("kind", KINDS)
def test_a_solid_meets_itself(kind: str) -> None:
    piece = Piece(shape_of(kind, (0.1, 0.05, 0.02), 1))
    assert separate(*placed([(piece, piece)]), 0) == (0.0, None)


@given(st.tuples(*[st.integers(1, 4)] * 6), st.tuples(*[st.integers(-9, 9)] * 3))
def test_boxes_on_a_grid_have_the_distance_of_their_intervals(sizes: tuple[int, ...], where: tuple[int, ...]) -> None:
    half, centre = 0.025 * np.array(sizes).reshape(2, 3), 0.05 * np.array(where)
    one, other = (Piece(box(*(2 * h).tolist()), p) for h, p in zip(half, (np.zeros(3), centre), strict=True))
    true = float(np.linalg.norm(np.maximum(0.0, np.abs(centre) - half.sum(0))))
    found, normal = separate(*placed([(one, other)]), 0)
    assert found == pytest.approx(true, abs=1e-9)
    if true > 1e-9:
        assert normal is not None
        assert normal @ centre > 0


@given(st.integers(0, 10**6))
def test_spheres_capsules_and_boxes_have_their_closed_forms(seed: int) -> None:
    rng = np.random.default_rng(seed)
    p, r = rng.uniform(-0.3, 0.3, 3), rotation(rng)
    ball = Piece(sphere(0.03), p)
    centre = rng.uniform(-0.3, 0.3, 3)
    brick = Piece(box(0.1, 0.2, 0.05), centre, r)
    local = r.T @ (p - centre)
    half = np.array([0.05, 0.1, 0.025])
    to_brick = float(np.linalg.norm(local - np.clip(local, -half, half))) - 0.03
    rod = Piece(capsule(0.02, 0.2), centre, r)
    to_rod = float(np.linalg.norm(local - np.array([0, 0, np.clip(local[2], -0.1, 0.1)]))) - 0.05
    other = Piece(sphere(0.05), centre)
    to_ball = float(np.linalg.norm(p - centre)) - 0.08
    for piece, true in ((brick, to_brick), (rod, to_rod), (other, to_ball)):
        found, _ = separate(*placed([(ball, piece)]), 0)
        assert found == pytest.approx(max(0.0, true), abs=1e-7)


def test_a_flat_tetrahedron_has_no_inside() -> None:
    """Four points of one plane: rounding says of each face on which side of it the fourth point is."""
    rng, work = np.random.default_rng(3), np.empty((3, 4))

    def away(points: FloatArray) -> float:
        assert nearest_to_origin(points, len(points), work)
        return float(np.linalg.norm(work[0, : len(points)] @ points))

    for _ in range(100):
        corners = rng.uniform(-0.1, 0.1, (4, 2)) @ rng.normal(size=(2, 3)) + rng.uniform(-0.1, 0.1, 3)
        faces = [away(np.delete(corners, corner, axis=0)) for corner in range(4)]
        assert away(corners) == pytest.approx(min(faces), abs=1e-12)
