"""How near two bodies are, and how much mass a body has where, as proofs of refusals have it: against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from assur.planner.checker.refusals.nearest import depth, distance, points_between
from assur.planner.checker.statement.limits import integrals
from assur.planner.geometry.shapes import Body, Piece, box, capsule, cylinder, sphere
from tests.planner.cells import Shape, block, mesh_box, rotation

SHAPES: tuple[Shape, ...] = (
    box(0.05, 0.08, 0.02),
    cylinder(0.03, 0.06),
    capsule(0.02, 0.05),
    sphere(0.04),
    block(0.05, 0.03, 0.07),
)


def some_piece(rng: np.random.Generator, far: float) -> Piece:
    shape = SHAPES[int(rng.integers(len(SHAPES)))]
    return Piece(shape, rng.uniform(-far, far, 3), rotation(rng))


def test_the_distance_of_balls_is_that_of_their_middles_less_their_radii() -> None:
    rng = np.random.default_rng(3)
    for _ in range(50):
        a, b = rng.uniform(-0.3, 0.3, (2, 3))
        true = max(float(np.linalg.norm(a - b)) - 0.07, 0.0)
        low, high = distance([Piece(sphere(0.04), a)], [Piece(sphere(0.03), b)])
        assert low <= true + 1e-12
        assert high >= true - 1e-12
        assert high - low <= 1e-6


def test_the_distance_of_a_block_and_a_box_is_that_of_their_faces() -> None:
    low, high = distance([Piece(block(0.1, 0.1, 0.1))], [Piece(box(0.1, 0.1, 0.1), np.array([0.0, 0.03, 0.15]))])
    assert [low, high] == pytest.approx([0.05, 0.05], abs=1e-9)
    assert low <= high


def test_bodies_of_many_pieces_are_as_near_as_their_nearest_pieces() -> None:
    rng = np.random.default_rng(4)
    for _ in range(20):
        ones, others = ([some_piece(rng, 0.2) for _ in range(3)] for _ in range(2))
        each = [distance([a], [b]) for a in ones for b in others]
        low, high = distance(ones, others)
        assert low == pytest.approx(min(a for a, _ in each), abs=1e-9)
        assert high == pytest.approx(min(b for _, b in each), abs=1e-9)


def test_points_between_two_pieces_are_in_them_and_as_near_as_the_pieces() -> None:
    rng, apart, together = np.random.default_rng(5), 0, 0
    for _ in range(100):
        one, other = some_piece(rng, 0.06), some_piece(rng, 0.06)
        low, high = distance([one], [other])
        x, y = points_between(one, other)
        assert high - low <= 1e-6
        if low > 0.0:
            assert min(depth(one, x)[0], depth(other, y)[0]) >= -1e-9
            assert np.linalg.norm(x - y) == pytest.approx(high, abs=1e-9)
        elif high < 1e-12:
            assert (x == y).all()
            assert depth(one, x)[0] + depth(other, x)[0] >= -1e-9
        apart, together = apart + (low > 0.0), together + (high < 1e-12)
    assert min(apart, together) > 20


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: type(shape).__name__ + getattr(shape, "kind", ""))
def test_the_spread_of_a_body_is_the_same_by_both_derivations(shape: Shape) -> None:
    rng = np.random.default_rng(6)
    body = Body("part", (Piece(shape, rng.uniform(-0.1, 0.1, 3), rotation(rng)),))
    volume, x, y, square = integrals(body)
    own = body.spread
    assert volume == pytest.approx(own.volume)
    assert [x / volume, y / volume] == pytest.approx(own.centroid[:2])
    assert square / volume == pytest.approx(own.square + own.centroid[0] ** 2 + own.centroid[1] ** 2)


def test_the_spread_of_a_mesh_is_that_of_the_solid_that_it_encloses() -> None:
    volume, x, y, square = integrals(mesh_box("lid", 0.2, 0.1, 0.05))
    assert [volume, x, y] == pytest.approx([0.001, 0.0, 0.0], abs=1e-12)
    assert square == pytest.approx(0.001 * (0.2**2 + 0.1**2) / 12.0)
