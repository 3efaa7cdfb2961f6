"""What a closed surface encloses, against formulas and against counting crossings of a ray."""

from __future__ import annotations

import numpy as np
import pytest

from assur.planner.arrays import FloatArray
from assur.planner.geometry.containment import inside, winding_number
from assur.scenes.meshes.surface import Surface
from tests.scenes.meshes.solids import CUBE, SOLIDS, surface

CUBE_100 = surface(CUBE)


def pair(solid: Surface) -> tuple[FloatArray, np.ndarray[tuple[int, ...], np.dtype[np.int64]]]:
    return solid.vertices, solid.faces


def crossings(solid: Surface, points: FloatArray) -> FloatArray:
    """The second method: triangles that a slanted ray from each point meets, counted."""
    direction = np.array([0.3241, 0.5177, 0.7917])
    a = solid.corners[:, 0]
    e1, e2 = solid.corners[:, 1] - a, solid.corners[:, 2] - a
    matrix = np.stack([e1, e2, np.broadcast_to(-direction, e1.shape)], -1)
    found = np.zeros(len(points))
    for i, point in enumerate(points):
        u, v, t = np.linalg.solve(matrix, (point - a)[..., None])[..., 0].T
        found[i] = np.count_nonzero((u > 0) & (v > 0) & (u + v < 1) & (t > 0))
    return found


@pytest.mark.parametrize("name", sorted(SOLIDS))
def test_it_agrees_with_the_parity_of_crossings(name: str) -> None:
    solid = surface(SOLIDS[name], 0.4, -0.7)
    rng = np.random.default_rng(3)
    points = rng.uniform(solid.vertices.min(0) - 0.01, solid.vertices.max(0) + 0.01, (600, 3))
    expected = crossings(solid, points) % 2 == 1
    assert 10 < expected.sum() < 590
    assert (inside(pair(solid), points) == expected).all()


def test_a_cavity_is_outside_and_its_walls_are_inside() -> None:
    housing = pair(surface(SOLIDS["housing"]))
    points = np.array([[0.0, 0.0, 0.0], [0.054, 0.0, 0.0], [0.0, 0.039, 0.0], [0.0, 0.0, 0.029], [0.2, 0.0, 0.0]])
    assert inside(housing, points).tolist() == [False, True, True, True, False]
    assert winding_number(housing, points).tolist() == pytest.approx([0, 1, 1, 1, 0], abs=1e-12)


def test_on_the_surface_the_share_of_the_solid_counts_and_faces_are_inside() -> None:
    face, edge = np.array([[0.05, 0.013, 0.007]]), np.array([[0.05, 0.05, 0.007]])
    assert winding_number(pair(CUBE_100), face)[0] == pytest.approx(0.5, abs=1e-9)
    assert winding_number(pair(CUBE_100), edge)[0] == pytest.approx(0.25, abs=1e-9)
    assert inside(pair(CUBE_100), np.concatenate([face, edge, [[0.05, 0.05, 0.05]]])).all()
    assert not inside(pair(CUBE_100), face + np.array([1e-9, 0.0, 0.0]))[0]


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_a_point_that_is_not_finite_is_inside(bad: float) -> None:
    points = np.array([[0.3, 0.0, 0.0], [0.3, bad, 0.0]])
    assert inside(pair(CUBE_100), points).tolist() == [False, True]


def test_a_surface_inside_out_encloses_the_same() -> None:
    vertices, faces = pair(CUBE_100)
    points = np.array([[0.0, 0.0, 0.0], [0.06, 0.0, 0.0]])
    assert winding_number((vertices, faces[:, ::-1]), points).tolist() == pytest.approx([-1.0, 0.0], abs=1e-12)
    assert inside((vertices, faces[:, ::-1]), points).tolist() == [True, False]


def test_many_triangles_are_worked_on_in_blocks_with_the_same_result(monkeypatch: pytest.MonkeyPatch) -> None:
    import assur.planner.geometry.containment as containment

    solid = pair(surface(SOLIDS["torus"]))
    points = np.random.default_rng(4).uniform(-0.15, 0.15, (50, 3))
    whole = winding_number(solid, points)
    monkeypatch.setattr(containment, "BLOCK", 64)
    np.testing.assert_allclose(winding_number(solid, points), whole, atol=1e-12)
    assert inside(solid, points[:0]).shape == (0,)


def test_no_points_and_far_points() -> None:
    assert winding_number(pair(CUBE_100), np.array([[50.0, 50.0, 50.0]]))[0] == pytest.approx(0.0, abs=1e-9)
