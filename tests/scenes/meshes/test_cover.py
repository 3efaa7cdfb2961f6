"""Covers of meshes: every triangle inside the union of the hulls, hulls convex and outward, and as few as need be."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from assur.planner.geometry.shapes import Hull
from assur.scenes.meshes.clip import clip
from assur.scenes.meshes.cover import MAX_PIECES, TIGHT_M, TIGHT_SHARE, Cover, cover
from assur.scenes.meshes.hull import COVER_SLACK_M, MAX_CORNERS, THICKNESS_M, hull_of
from assur.scenes.meshes.surface import Surface, volume_of
from tests.scenes.meshes.solids import CUBE, SOLIDS, on_triangles, star, surface, torus

WITHIN_M = 2 * COVER_SLACK_M
"""What the oracle allows: the hulls' own slack, and its own rounding."""


def hulls(found: Cover) -> list[Hull]:
    return [piece.shape for piece in found.pieces if isinstance(piece.shape, Hull)]


def outside(found: Cover, points: FloatArray) -> float:
    """How far the worst of the points is outside the union of the hulls, by Qhull's planes of their corners."""
    depth = np.full(len(points), np.inf)
    for hull in hulls(found):
        planes = ConvexHull(hull.vertices).equations
        depth = np.minimum(depth, (points @ planes[:, :3].T + planes[:, 3]).max(1))
    return float(depth.max())


def volume(found: Cover) -> float:
    return float(sum(ConvexHull(hull.vertices).volume for hull in hulls(found)))


def check_hull(hull: Hull) -> None:
    """Closed, convex, outward by the right-hand rule: each face has all corners behind it."""
    corners = hull.vertices[hull.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    ahead = np.einsum("fi,mi->fm", normals, hull.vertices) - (corners[:, 0] * normals).sum(1)[:, None]
    assert ahead.max() <= 1e-7 * float(np.ptp(hull.vertices, axis=0).max())
    edges = np.concatenate([hull.faces[:, [0, 1]], hull.faces[:, [1, 2]], hull.faces[:, [2, 0]]])
    assert sorted(map(tuple, edges.tolist())) == sorted((b, a) for a, b in edges.tolist())
    assert len(hull.vertices) <= MAX_CORNERS
    assert set(hull.faces.ravel().tolist()) == set(range(len(hull.vertices)))
    assert volume_of(corners) > 0


@pytest.mark.parametrize("name", sorted(SOLIDS))
def test_every_triangle_is_in_the_union_and_every_hull_is_a_hull(name: str) -> None:
    solid = surface(SOLIDS[name])
    found = cover(solid)
    assert 1 < len(found.pieces) <= MAX_PIECES
    assert outside(found, on_triangles(solid.corners, 4_000, seed=5)) <= WITHIN_M
    for hull in hulls(found):
        check_hull(hull)


@settings(max_examples=8)
@given(
    st.sampled_from(sorted(SOLIDS)),
    st.floats(-3.0, 3.0),
    st.floats(-3.0, 3.0),
    st.sampled_from([1e-4, 1e-3, 1e-2]),
)
def test_it_holds_for_any_attitude_and_size(name: str, turn: float, tilt: float, scale: float) -> None:
    solid = surface(SOLIDS[name], turn, tilt, scale)
    found = cover(solid)
    assert outside(found, on_triangles(solid.corners, 1_000, seed=6)) <= WITHIN_M


@pytest.mark.parametrize(("name", "pieces"), [("bracket", 2), ("housing", 6), ("tray", 5)])
def test_what_is_made_of_boxes_is_covered_by_those_boxes(name: str, pieces: int) -> None:
    solid = surface(SOLIDS[name])
    found = cover(solid)
    assert len(found.pieces) == pieces
    assert volume(found) == pytest.approx(volume_of(solid.corners), rel=1e-9)
    assert found.surface is not None


@pytest.mark.parametrize("name", ["flange", "star", "torus"])
def test_a_round_or_slanted_solid_is_covered_within_what_is_named(name: str) -> None:
    solid = surface(SOLIDS[name])
    found = cover(solid)
    tight = max(TIGHT_M, TIGHT_SHARE * float(np.ptp(solid.vertices, axis=0).max()))
    assert found.excess_m <= tight
    assert volume(found) <= 1.1 * volume_of(solid.corners)


def test_hollows_stay_open() -> None:
    ring = cover(surface(SOLIDS["flange"]))
    shell = cover(surface(SOLIDS["housing"]))
    bowl = cover(surface(SOLIDS["tray"]))
    for found, inside in ((ring, [0, 0, 0]), (shell, [0, 0, 0]), (bowl, [0, 0, 0.02]), (shell, [0.045, 0.03, 0.02])):
        assert outside(found, np.array([inside], dtype=np.float64)) > 1e-3


@pytest.mark.parametrize(("turn", "tilt"), [(0.0, 0.0), (0.3, -1.1)])
def test_a_convex_mesh_is_one_hull_the_solid_itself(turn: float, tilt: float) -> None:
    found = cover(surface(CUBE, turn, tilt))
    assert len(found.pieces) == 1
    assert found.surface is None
    assert found.excess_m == 0.0
    (hull,) = hulls(found)
    assert len(hull.vertices) == 8
    check_hull(hull)


def test_a_round_convex_mesh_is_one_hull_of_few_corners_around_it() -> None:
    u, v = np.meshgrid(np.linspace(0, 2 * np.pi, 49)[:-1], np.linspace(0, np.pi, 25)[1:-1], indexing="ij")
    points = 0.1 * np.stack([np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)], -1).reshape(-1, 3)
    hull = hull_of(points)
    check_hull(hull)
    assert len(points) > MAX_CORNERS
    planes = ConvexHull(hull.vertices).equations
    assert (points @ planes[:, :3].T + planes[:, 3]).max() <= WITHIN_M
    assert ConvexHull(hull.vertices).volume <= 1.05 * 4 / 3 * np.pi * 0.1**3


def test_a_cover_is_the_same_each_time() -> None:
    first, second = cover(surface(SOLIDS["star"])), cover(surface(SOLIDS["star"]))
    assert [h.vertices.tobytes() for h in hulls(first)] == [h.vertices.tobytes() for h in hulls(second)]


FLAT = np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.1, 0.1, 0.0]])


@pytest.mark.parametrize(
    "points",
    [
        FLAT,
        FLAT[:3],
        FLAT[:2],
        FLAT[:1],
        np.repeat(FLAT[:1], 5, axis=0),
        FLAT @ np.array([[0.6, 0, 0.8], [0, 1, 0], [0, 0, 1]]),
    ],
    ids=["square", "triangle", "edge", "point", "points", "slanted"],
)
def test_flat_points_get_a_hull_of_the_named_thickness(points: FloatArray) -> None:
    hull = hull_of(points)
    check_hull(hull)
    planes = ConvexHull(hull.vertices).equations
    assert (points @ planes[:, :3].T + planes[:, 3]).max() <= 0
    _, axes = np.linalg.eigh(np.cov((hull.vertices - hull.vertices.mean(0)).T))
    assert np.ptp(hull.vertices @ axes, axis=0).min() >= THICKNESS_M * 0.999
    grown = max(float(np.linalg.norm(points - v, axis=1).min()) for v in hull.vertices)
    assert grown <= THICKNESS_M


def test_a_hull_that_rounding_broke_is_replaced_by_a_box(monkeypatch: pytest.MonkeyPatch) -> None:
    import assur.scenes.meshes.hull as module

    verdicts = [False, True]
    monkeypatch.setattr(module, "_contains", lambda *_: verdicts.pop(0))
    points = surface(SOLIDS["star"]).vertices
    hull = hull_of(points)
    check_hull(hull)
    assert len(hull.vertices) == 8
    assert (points >= hull.vertices.min(0)).all()
    assert (points <= hull.vertices.max(0)).all()
    verdicts.extend([False, False])
    with pytest.raises(FaultError):
        hull_of(points)


COORDINATES = st.integers(-6, 6).map(lambda k: k * 0.01)
TRIANGLES = st.lists(
    st.lists(st.tuples(COORDINATES, COORDINATES, COORDINATES), min_size=3, max_size=3), min_size=1, max_size=6
)


@given(TRIANGLES, st.integers(0, 2), st.integers(-13, 13).map(lambda k: k * 0.005))
def test_both_sides_of_a_cut_together_are_what_was_cut(
    triangles: list[list[tuple[float, float, float]]], axis: int, at: float
) -> None:
    whole = np.array(triangles)
    below, above = clip(whole, axis, at)
    parts = np.concatenate([below, above])
    for normal, weight in ((np.eye(3)[k], k) for k in range(3)):
        del weight
        assert _vector_area(parts) @ normal == pytest.approx(float(_vector_area(whole) @ normal), abs=1e-12)
    assert _area(parts) == pytest.approx(_area(whole), abs=1e-12)
    assert (below[:, :, axis] <= at + 1e-12).all()
    assert (above[:, :, axis] >= at - 1e-12).all()


def _area(triangles: FloatArray) -> float:
    edges = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return float(np.linalg.norm(edges, axis=1).sum() / 2)


def _vector_area(triangles: FloatArray) -> FloatArray:
    edges: FloatArray = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]).sum(0) / 2
    return edges


def test_faces_in_the_cut_go_to_the_side_of_their_solid() -> None:
    lid = np.array([[[0, 0, 0.1], [1, 0, 0.1], [0, 1, 0.1]]])
    below, above = clip(lid, 2, 0.1)
    assert (len(below), len(above)) == (1, 0)
    below, above = clip(lid[:, ::-1], 2, 0.1)
    assert (len(below), len(above)) == (0, 1)


def test_a_large_mesh_is_covered_too() -> None:
    solid: Surface = surface(torus(64, 32))
    found = cover(solid)
    assert outside(found, on_triangles(solid.corners, 2_000, seed=7)) <= WITHIN_M
    assert len(found.pieces) <= MAX_PIECES
    assert volume(found) <= 1.2 * volume_of(solid.corners)


def test_a_comb_needs_more_pieces_than_there_are_and_is_covered_all_the_same() -> None:
    solid = surface(star(40, 100.0, 60.0))
    found = cover(solid)
    assert len(found.pieces) <= MAX_PIECES
    assert outside(found, on_triangles(solid.corners, 3_000, seed=8)) <= WITHIN_M
