"""Support gaps are lower bounds of distances, along any normal, for all kinds of solids."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.geometry.shapes import Hull, Piece, box
from assur.planner.kernels.solids import RADIUS, spheres_apart
from assur.planner.kernels.solids import unit_support as kernel_support
from tests.planner.cells import block, placed
from tests.planner.convex import KINDS, anywhere, distance, grid_aligned, inside, pairs, shape_of
from tests.planner.second_solids import Placed, gaps, kernel_gaps, likely, tables

ROUNDING_M = 1e-12


def normals(seed: int, count: int = 200) -> FloatArray:
    """Unit vectors (count, 3), the axes and diagonals of the world among them."""
    grid = np.array([[x, y, z] for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if x or y or z], dtype=float)
    n = np.concatenate([grid, np.random.default_rng(seed).normal(size=(count, 3))])
    unit: FloatArray = n / np.linalg.norm(n, axis=1, keepdims=True)
    return unit


def supports(a: Placed, n: FloatArray) -> FloatArray:
    """max of n·(x − centre) by the kernel, for directions n (N, 3)."""
    units, unit, _ = tables(a, a, 0)
    return np.array([kernel_support(units, 0, unit, tuple(normal)) for normal in n.tolist()])


@given(pairs(), st.integers(0, 10**6))
def test_a_gap_along_any_normal_never_exceeds_the_distance(both: tuple[Piece, Piece], seed: int) -> None:
    a, b = placed([both])
    found = kernel_gaps(a, b, normals(seed)[None])
    # the other way finds two points of the solids: their distance is the true one or more
    assert found.max() <= max(0.0, distance(*both)) + ROUNDING_M


@given(pairs(), st.integers(0, 10**6))
def test_no_two_points_of_two_solids_are_nearer_along_a_normal_than_the_gap(
    both: tuple[Piece, Piece], seed: int
) -> None:
    rng = np.random.default_rng(seed)
    n = normals(seed, 40)
    x, y = inside(both[0], rng, 60), inside(both[1], rng, 60)
    a, b = placed([both])
    ahead = (n @ y.T).min(1) - (n @ x.T).max(1)
    assert (kernel_gaps(a, b, n[None])[0] <= ahead + ROUNDING_M).all()


@given(st.one_of(grid_aligned(), anywhere()), st.integers(0, 10**6))
def test_support_is_reached_by_a_point_of_the_solid_and_never_passed(piece: Piece, seed: int) -> None:
    a, _ = placed([(piece, piece)])
    n = normals(seed, 10)
    reached = supports(a, n) + n @ a.centre[0]
    points = inside(piece, np.random.default_rng(seed), 4000)
    ahead = (n @ points.T).max(1)
    assert (ahead <= reached + ROUNDING_M).all()
    # 4000 points come within a share of the size of any support plane
    assert (reached - ahead <= 0.35 * 0.4).all()


@given(pairs(), st.integers(0, 10**6))
def test_the_kernel_and_numpy_agree_on_gaps(both: tuple[Piece, Piece], seed: int) -> None:
    a, b = placed([both])
    n = normals(seed, 20)[None]
    assert np.abs(kernel_gaps(a, b, n) - gaps(a, b, n)).max() <= ROUNDING_M


@given(pairs(), st.sampled_from([-np.inf, 0.0, 0.01, np.inf]))
def test_a_likely_gap_is_a_lower_bound_along_its_own_unit_normal(both: tuple[Piece, Piece], enough: float) -> None:
    a, b = placed([both])
    found, normal = likely(a, b, 0, enough)
    assert abs(np.linalg.norm(normal) - 1.0) <= 1e-12
    assert found <= gaps(a, b, normal[None, None])[0, 0] + ROUNDING_M
    assert found <= max(0.0, distance(*both)) + ROUNDING_M


@given(pairs(), st.floats(-0.05, 0.3))
def test_spheres_that_are_apart_hold_solids_that_are(both: tuple[Piece, Piece], required: float) -> None:
    a, b = placed([both])
    units, i, j = tables(a, b, 0)
    if spheres_apart(units, 0, i, j, required):
        assert distance(*both) > required - ROUNDING_M


@given(st.one_of(grid_aligned(), anywhere()), st.integers(0, 10**6))
def test_no_point_of_a_solid_is_outside_the_sphere_around_it(piece: Piece, seed: int) -> None:
    a, _ = placed([(piece, piece)])
    points = inside(piece, np.random.default_rng(seed), 500)
    radius = a.arrangement.rows[int(a.unit[0]), RADIUS]
    assert np.linalg.norm(points - a.centre[0], axis=1).max() <= radius + ROUNDING_M


@pytest.mark.parametrize("where", ["centre", "axes", "both"])
def test_unknown_places_give_no_gap(where: str) -> None:
    a, b = placed(
        [(Piece(shape_of(first, (0.1, 0.1, 0.1), 1)), Piece(box(0.1, 0.1, 0.1), np.ones(3))) for first in KINDS]
    )
    for row in range(len(KINDS)):
        units, i, j = tables(a, b, row)
        at = units[2]
        at[0, i, {"centre": slice(3), "axes": slice(3, 12), "both": slice(12)}[where]] = np.nan
        lost = Placed(
            a.arrangement, a.unit, at[:, i, :3].repeat(len(KINDS), 0), at[:, i, 3:].reshape(-1, 3, 3).repeat(5, 0)
        )
        assert not likely(lost, b, row)[0] > -np.inf
        assert not (kernel_gaps(lost, b, normals(1)[None].repeat(len(KINDS), 0))[row] > -np.inf).any()
        assert not spheres_apart(units, 0, i, j, 0.0) or where == "axes"


@given(st.tuples(*[st.integers(1, 4)] * 6), st.tuples(*[st.integers(-9, 9)] * 3))
def test_upright_boxes_on_a_grid_are_parted_exactly_by_a_likely_normal(
    sizes: tuple[int, ...], where: tuple[int, ...]
) -> None:
    half = 0.025 * np.array(sizes).reshape(2, 3)
    centre = 0.05 * np.array(where)
    one, other = (Piece(box(*(2 * h).tolist()), p) for h, p in zip(half, (np.zeros(3), centre), strict=True))
    ways = np.abs(centre) - half.sum(0)
    found, _ = likely(*placed([(one, other)]))
    if (ways > 0).sum() == 1:  # they face each other
        assert found == pytest.approx(ways.max(), abs=1e-12)
    assert (found > 1e-12) == bool((ways > 1e-12).any())


@pytest.mark.parametrize("kind", KINDS)
def test_a_gap_of_a_solid_grown_by_a_nanometre_too_little_would_be_noticed(kind: str) -> None:
    """The guard itself: what overstates a gap by 1 µm exceeds the distance that the other way finds."""
    piece = Piece(shape_of(kind, (0.1, 0.1, 0.1), 1))
    lower = Piece(box(0.5, 0.5, 0.02), np.array([0.0, 0.0, -0.5]))
    a, b = placed([(piece, lower)])
    best = kernel_gaps(a, b, np.array([[[0.0, 0.0, -1.0]]]))[0, 0]
    assert best == pytest.approx(distance(piece, lower), abs=1e-8)
    assert best + 1e-6 > distance(piece, lower) + ROUNDING_M


def test_a_hull_is_its_vertices_wherever_its_origin_is() -> None:
    here = Piece(block(0.1, 0.1, 0.1))
    there = Piece(block(0.1, 0.1, 0.1, (3.0, 2.0, 1.0)), np.array([-3.0, -2.0, -1.0]))
    assert isinstance(there.shape, Hull)
    a, b = placed([(here, there)])
    n = normals(1, 20)
    first, second = supports(a, n) + n @ a.centre[0], supports(b, n) + n @ b.centre[0]
    assert np.abs(first - second).max() <= 1e-12
