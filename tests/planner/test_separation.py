"""Support gaps are lower bounds of distances, along any normal, for all kinds of solids."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import assur.planner.collision.support_gaps
from assur.planner.arrays import FloatArray
from assur.planner.collision.arrangement import COVER, SolidsMaker, asked_pairs, carriers
from assur.planner.collision.support_gaps import (
    centre_normals,
    face_normals,
    gaps,
    likely_gaps,
    meet,
    place,
    rough_gaps,
    support,
    swept_gaps,
)
from assur.planner.frames import Turntable
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import Body, Hull, Piece, box, cylinder, sphere
from tests.planner.cells import Around, arm, block, cell, frame, go, mesh_box, placed, rotation, solid
from tests.planner.convex import KINDS, anywhere, distance, grid_aligned, inside, pairs, shape_of

ROUNDING_M = 1e-12


def normals(seed: int, count: int = 200) -> FloatArray:
    """Unit vectors (count, 3), the axes and diagonals of the world among them."""
    grid = np.array([[x, y, z] for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if x or y or z], dtype=float)
    n = np.concatenate([grid, np.random.default_rng(seed).normal(size=(count, 3))])
    unit: FloatArray = n / np.linalg.norm(n, axis=1, keepdims=True)
    return unit


@given(pairs(), st.integers(0, 10**6))
def test_a_gap_along_any_normal_never_exceeds_the_distance(both: tuple[Piece, Piece], seed: int) -> None:
    a, b = placed([both])
    found = gaps(a, b, normals(seed)[None])
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
    assert (gaps(a, b, n[None])[0] <= ahead + ROUNDING_M).all()


@given(st.one_of(grid_aligned(), anywhere()), st.integers(0, 10**6))
def test_support_is_reached_by_a_point_of_the_solid_and_never_passed(piece: Piece, seed: int) -> None:
    a, _ = placed([(piece, piece)])
    n = normals(seed, 10)
    reached = support(a, n[None])[0] + n @ piece.position
    points = inside(piece, np.random.default_rng(seed), 4000)
    ahead = (n @ points.T).max(1)
    assert (ahead <= reached + ROUNDING_M).all()
    # 4000 points come within a share of the size of any support plane
    assert (reached - ahead <= 0.35 * 0.4).all()


@given(pairs())
def test_likely_and_rough_gaps_are_lower_bounds(both: tuple[Piece, Piece]) -> None:
    bodies = tuple(Around(Body(name, (piece,))) for name, piece in zip("ab", both, strict=True))
    scene = cell(go(0.3, 0.0), bodies=bodies, robot=arm(bare=True))
    solids = SolidsMaker(scene)(None, ())
    where = carriers(scene, np.zeros((1, 4)), np.zeros(1))
    a, b = np.array([solids.pieces[0][-1]]), np.array([solids.pieces[1][-1]])
    row = np.zeros(1, dtype=np.int64)
    true = max(0.0, distance(*both))
    assert likely_gaps(place(solids, where, row, a), place(solids, where, row, b))[0] <= true + ROUNDING_M
    assert rough_gaps(solids, where, a, b)[0, 0] <= true + ROUNDING_M


@given(st.integers(0, 10**6), st.floats(-np.pi, np.pi), st.floats(0.0, 0.3))
def test_rough_gaps_of_hulls_that_are_off_their_origin_are_lower_bounds_at_all_turns(
    seed: int, yaw: float, off: float
) -> None:
    rng = np.random.default_rng(seed)
    hull = block(0.02, 0.04, 0.03, (off, -0.5 * off, rng.uniform(-0.1, 0.1)))
    a, b = Piece(hull), Piece(sphere(0.02), rng.uniform(-0.3, 0.3, 3))
    dial = frame("dial", Turntable(Pose(0.05, 0.0, 0.02, yaw), 2.0))
    bodies = (Around(Body("a", (a,)), "dial", Pose(yaw=0.3)), Around(Body("b", (b,))))
    scene = cell(go(0.3, 0.0), bodies=bodies, frames=(dial,), robot=arm(bare=True))
    solids = SolidsMaker(scene)(None, ())
    t = np.linspace(0.0, 3.0, 9)
    where = carriers(scene, np.zeros((9, 4)), t)
    # against the hull itself and against its bounding box
    rough = [rough_gaps(solids, where, np.array([u]), np.array([solids.pieces[1][-1]]))[:, 0] for u in (0, 1)]
    for i, now in enumerate(t):
        turn = yaw + 2.0 * now + 0.3
        c, s = np.cos(turn), np.sin(turn)
        r = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        true = max(0.0, distance(Piece(hull, np.array([0.05, 0.0, 0.02]), r), b))
        assert rough[0][i] <= true + 1e-8
        assert rough[1][i] <= true + 1e-8


@pytest.mark.parametrize("moving", [False, True])
def test_swept_gaps_are_below_rough_ones_at_all_times_and_tight_where_nothing_moves(
    moving: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(assur.planner.collision.support_gaps, "FEW", 0)
    rng = np.random.default_rng(5)
    dial = frame("dial", Turntable(Pose(0.1, -0.2, 0.0, 0.3), 1.5))
    shapes = [shape_of(kind, (0.1, 0.07, 0.05), k) for k, kind in enumerate(KINDS * 12)]
    at = [Pose(x, y, z, yaw) for x, y, z, yaw in rng.uniform(-1.0, 1.0, (len(shapes), 4)).tolist()]
    bodies = tuple(
        Around(Body(f"b{k}", (Piece(shape),)), "dial" if moving else "world", pose)
        for k, (shape, pose) in enumerate(zip(shapes, at, strict=True))
    )
    scene = cell(go(0.3, 0.0), bodies=bodies, frames=(dial,))
    solids = SolidsMaker(scene)(None, ())
    t = np.linspace(0.0, 1.0, 50)
    q = np.array([0.3, 1.2, 0.1, 0.0]) + np.outer(t if moving else 0 * t, [1.0, -0.8, 0.05, 2.0])
    where = carriers(scene, q, t)
    a, b = asked_pairs(scene, solids)
    assert len(a) > 100
    swept, rough = swept_gaps(solids, where, a, b), rough_gaps(solids, where, a, b).min(0)
    assert (swept <= rough + ROUNDING_M).all()
    assert (swept > 0.05).any()
    if not moving:
        # circles against boxes about them: at most by the diagonal
        assert (swept >= rough / np.sqrt(2) - 0.42 * 0.5).all()


def test_few_pairs_and_unknown_places_are_never_ruled_out_over_all_times(monkeypatch: pytest.MonkeyPatch) -> None:
    law = Turntable(Pose(0.3, 0.0, 0.1), 1.0, valid=(0.0, 1.0))
    bodies = (Around(Body("a", (Piece(box(0.1, 0.1, 0.1)),)), "dial"), Around(Body("b", (Piece(sphere(0.1)),))))
    scene = cell(go(0.3, 0.0), bodies=bodies, frames=(frame("dial", law),), robot=arm(bare=True))
    solids = SolidsMaker(scene)(None, ())
    where = carriers(scene, np.zeros((2, 4)), np.array([0.5, 2.0]))
    a, b = np.array([0]), np.array([1])
    assert swept_gaps(solids, where, a, b)[0] == -np.inf
    monkeypatch.setattr(assur.planner.collision.support_gaps, "FEW", 0)
    assert not swept_gaps(solids, where, a, b)[0] > -1e9


def test_unknown_places_give_no_gap() -> None:
    law = Turntable(Pose(0.3, 0.0, 0.1), 1.0, valid=(0.0, 1.0))
    bodies = (Around(Body("a", (Piece(box(0.1, 0.1, 0.1)),)), "dial"), Around(Body("b", (Piece(sphere(0.1)),))))
    scene = cell(go(0.3, 0.0), bodies=bodies, frames=(frame("dial", law),), robot=arm(bare=True))
    solids = SolidsMaker(scene)(None, ())
    where = carriers(scene, np.zeros((1, 4)), np.array([2.0]))
    row, a, b = np.zeros(1, dtype=np.int64), np.array([0]), np.array([1])
    assert not rough_gaps(solids, where, a, b)[0, 0] > -1e9
    assert likely_gaps(place(solids, where, row, a), place(solids, where, row, b))[0] == -np.inf


@given(pairs())
def test_likely_normals_are_unit_vectors_and_point_from_the_one_to_the_other(both: tuple[Piece, Piece]) -> None:
    a, b = placed([both])
    n = np.concatenate([centre_normals(a, b), face_normals(a, b)], axis=1)
    assert np.abs(np.linalg.norm(n, axis=-1) - 1.0).max() <= 1e-12
    towards = (face_normals(a, b) @ (b.centre - a.centre)[:, :, None])[..., 0]
    assert (towards >= 0).all()


@given(st.tuples(*[st.integers(1, 4)] * 6), st.tuples(*[st.integers(-9, 9)] * 3))
def test_upright_boxes_on_a_grid_are_parted_exactly_by_a_likely_normal(
    sizes: tuple[int, ...], where: tuple[int, ...]
) -> None:
    half = 0.025 * np.array(sizes).reshape(2, 3)
    centre = 0.05 * np.array(where)
    one, other = (Piece(box(*(2 * h).tolist()), p) for h, p in zip(half, (np.zeros(3), centre), strict=True))
    ways = np.abs(centre) - half.sum(0)
    a, b = placed([(one, other)])
    found = likely_gaps(a, b)[0]
    if (ways > 0).sum() == 1:  # they face each other
        assert found == pytest.approx(ways.max(), abs=1e-12)
    assert (found > 1e-12) == bool((ways > 1e-12).any())


@pytest.mark.parametrize("kind", KINDS)
def test_a_gap_of_a_solid_grown_by_a_nanometre_too_little_would_be_noticed(kind: str) -> None:
    """The guard itself: what overstates a gap by 1 µm exceeds the distance that the other way finds."""
    piece = Piece(shape_of(kind, (0.1, 0.1, 0.1), 1))
    lower = Piece(box(0.5, 0.5, 0.02), np.array([0.0, 0.0, -0.5]))
    a, b = placed([(piece, lower)])
    best = gaps(a, b, np.array([[[0.0, 0.0, -1.0]]]))[0, 0]
    assert best == pytest.approx(distance(piece, lower), abs=1e-8)
    assert best + 1e-6 > distance(piece, lower) + ROUNDING_M


def test_a_hull_is_its_vertices_wherever_its_origin_is() -> None:
    here = Piece(block(0.1, 0.1, 0.1))
    there = Piece(block(0.1, 0.1, 0.1, (3.0, 2.0, 1.0)), np.array([-3.0, -2.0, -1.0]))
    assert isinstance(there.shape, Hull)
    a, b = placed([(here, there)])
    n = normals(1, 20)[None]
    first = support(a, n) + (n @ a.centre[:, :, None])[..., 0]
    second = support(b, n) + (n @ b.centre[:, :, None])[..., 0]
    assert np.abs(first - second).max() <= 1e-12


@given(pairs())
def test_what_is_said_to_have_a_common_point_does_touch(both: tuple[Piece, Piece]) -> None:
    a, b = placed([both])
    if meet(a, b)[0]:
        assert distance(*both) <= ROUNDING_M


@pytest.mark.parametrize("first", KINDS)
@pytest.mark.parametrize("second", KINDS)
def test_a_common_point_of_solids_that_are_deep_in_each_other_is_found(first: str, second: str) -> None:
    rng = np.random.default_rng(2)
    both = [
        (
            Piece(shape_of(first, (0.1, 0.08, 0.12), k), np.zeros(3), rotation(rng)),
            Piece(shape_of(second, (0.1, 0.08, 0.12), k), rng.uniform(-0.01, 0.01, 3), rotation(rng)),
        )
        for k in range(20)
    ]
    # a hull's core is only a box about it: nothing is said of it
    assert meet(*placed(both)).tolist() == ["hull" not in (first, second)] * 20


def test_no_common_point_is_claimed_of_the_box_about_several_pieces() -> None:
    scene = cell(go(0.3, 0.0), bodies=(Around(mesh_box("bin", 0.3, 0.3, 0.3)), Around(solid("ball", sphere(0.02)))))
    solids = SolidsMaker(scene)(None, ())
    where, row = carriers(scene, np.zeros((1, 4)), np.zeros(1)), np.zeros(1, dtype=np.int64)
    bin_, ball = (np.array([solids.roots[solids.names.index(name)]]) for name in ("bin", "ball"))
    assert solids.piece[bin_[0]] == COVER
    assert not meet(place(solids, where, row, bin_), place(solids, where, row, ball))[0]
    assert meet(place(solids, where, row, ball), place(solids, where, row, ball))[0]


@pytest.mark.parametrize("yaw", [0.0, 0.7, -2.0])
def test_upright_solids_beside_each_other_are_roughly_as_far_apart_as_they_are(yaw: float) -> None:
    """A post beside a long bar, at all places round it: at the most its roundness from above is lost."""
    around = np.linspace(0.0, 2 * np.pi, 33)
    bar = Around(solid("bar", box(0.4, 0.08, 0.06)), "world", Pose(0.1, 0.2, 0.0, yaw))
    posts = tuple(
        Around(solid(f"post-{k}", cylinder(0.02, 0.5)), "world", Pose(0.1 + 0.3 * np.cos(x), 0.2 + 0.3 * np.sin(x)))
        for k, x in enumerate(around)
    )
    solids = SolidsMaker(cell(go(0.3, 0.0), bodies=(bar, *posts), robot=arm(bare=True)))(None, ())
    where = carriers(cell(go(0.3, 0.0)), np.zeros((1, 4)), np.zeros(1))
    a, b = np.zeros(len(posts), dtype=np.int64), np.arange(1, len(posts) + 1)
    x, y = 0.3 * np.cos(around - yaw), 0.3 * np.sin(around - yaw)
    true = np.hypot(np.maximum(np.abs(x) - 0.2, 0), np.maximum(np.abs(y) - 0.04, 0)) - 0.02
    assert np.abs(rough_gaps(solids, where, a, b)[0] - true).max() <= ROUNDING_M
