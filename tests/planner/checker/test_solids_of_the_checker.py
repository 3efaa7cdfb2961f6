"""Supports, boxes and points that count of the checker's own table, against one solid at a time and against points."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from assur.planner.arrays import FloatArray
from assur.planner.checker.motion import JETS
from assur.planner.checker.solids import ARM, ARM_FLAT, CENTRE, FIRST, HALF, TURN, farthest, solids
from assur.planner.geometry.shapes import AXES, Body, Hull, Piece, Primitive, box, capsule, cylinder, sphere
from assur.planner.geometry.shapes import support as support_of
from assur.planner.model.phases import phases
from assur.planner.model.scene import WorldBody
from tests.planner.checker.hand_made import box_of, carton, crossing, crossing_case, wedge


def turned(yaw: float) -> FloatArray:
    c, s = math.cos(yaw), math.sin(yaw)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def tilted(seed: int) -> FloatArray:
    rng = np.random.default_rng(seed)
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return np.asarray(q if np.linalg.det(q) > 0 else q[:, [1, 0, 2]])


SHAPES = {
    "box": box(0.1, 0.04, 0.06),
    "sphere": sphere(0.05),
    "cylinder": cylinder(0.03, 0.2),
    "capsule": capsule(0.02, 0.15),
    "hull": wedge().pieces[0].shape,
}
POSES = {"upright": np.eye(3), "along x": AXES["x"], "along y": AXES["y"], "tilted": tilted(3)}
SINGLE = [
    Body(f"{name} {how}", (Piece(shape, np.array([0.07, -0.02, 0.01]), rotation),))
    for name, shape in SHAPES.items()
    for how, rotation in POSES.items()
]
LYING = (Piece(cylinder(0.01, 0.2), np.zeros(3), AXES["x"]), Piece(sphere(0.01), np.array([0.0, 0.1, 0.0])))
BODIES = (*SINGLE, carton(), Body("pin", (Piece(cylinder(0.03, 0.2)),)), Body("lying", LYING))
SCENE = crossing(bodies=tuple(WorldBody(body) for body in BODIES if body.name != "carton"))
TABLE = solids(SCENE, phases(SCENE, crossing_case()[1].legs, ()))
NAMES = [body.name for body in BODIES]
STANDS = np.zeros((1, JETS, 6))
STANDS[0, [3, 7, 11], :2] = 1.0


def rows_of(name: str, yaw: float = 0.0) -> FloatArray:
    """The solids of a body, its box behind its pieces, in the body's axes turned by `yaw`."""
    body = TABLE.number[name]
    seat = int(TABLE.seat[0, body])
    first = TABLE.seats[seat, FIRST]
    found = TABLE.table[first : first + TABLE.count[body] + 1].copy()
    turn = turned(yaw - float(TABLE.offset[seat, 3]))
    found[:, CENTRE:TURN] = (found[:, CENTRE:TURN] - TABLE.offset[seat, :3]) @ turn.T
    found[:, TURN:HALF] = (found[:, TURN:HALF].reshape(-1, 3, 3) @ turn.T).reshape(-1, 9)
    return found


def reach_along(row: FloatArray, n: FloatArray) -> float:
    return float(n @ farthest(row, STANDS, 0, TABLE.vertices, (float(n[0]), float(n[1]), float(n[2])), 1.0))


def points(piece: Piece, rng: np.random.Generator) -> FloatArray:
    """Points (m, 3) of a solid, its outermost among them, in its body."""
    shape = piece.shape
    if isinstance(shape, Hull):
        local = shape.vertices
    else:
        assert isinstance(shape, Primitive)
        signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=np.float64)
        angle = np.linspace(0, 2 * np.pi, 73)
        ring = shape.disc * np.stack([np.cos(angle), np.sin(angle), np.zeros(73)], -1)
        rays = rng.normal(size=(200, 3))
        rays = shape.ball * rays / np.sqrt((rays**2).sum(1))[:, None]
        local = ((signs * np.array(shape.half))[:, None] + ring).reshape(-1, 3)
        local = (local[:, None] + rays[rng.choice(200, 20)]).reshape(-1, 3)
    return np.asarray(piece.position + local @ piece.rotation.T)


@given(st.sampled_from(NAMES), st.integers(0, 2**32 - 1), st.sampled_from(["any", "grid"]))
def test_supports_are_those_of_the_shapes(name: str, seed: int, regime: str) -> None:
    rng = np.random.default_rng(seed)
    n = rng.normal(size=3) if regime == "any" else rng.integers(-1, 2, 3).astype(np.float64)
    if not n.any():
        n = np.array([0.0, 0.0, 1.0])
    n /= np.linalg.norm(n)
    rows, pieces = rows_of(name), TABLE.bodies[TABLE.number[name]].pieces
    for row, piece in zip(rows, pieces, strict=False):
        assert reach_along(row, n) == pytest.approx(support_of(piece, n), abs=1e-15)
    whole = reach_along(rows[-1], n)
    assert whole == pytest.approx(support_of(box_of(TABLE.bodies[TABLE.number[name]]), n), abs=1e-15)
    assert all(whole >= support_of(piece, n) - 1e-15 for piece in pieces)


@given(st.sampled_from(NAMES), st.integers(0, 2**32 - 1), st.sampled_from([0.0, 1.0]), st.floats(1e-3, 1.0))
def test_turning_about_the_centre_moves_no_support_faster_than_the_points_that_count(
    name: str, seed: int, yaw: float, turn: float
) -> None:
    """About the vertical, and about any axis: the support grows by at most the distance of those points a radian."""
    rng = np.random.default_rng(seed)
    n, axis = rng.normal(size=(2, 3))
    n, axis = n / np.linalg.norm(n), axis / np.linalg.norm(axis)
    tilt = Rotation.from_rotvec(turn * axis).as_matrix()
    pieces = TABLE.bodies[TABLE.number[name]].pieces
    for k, row in enumerate(rows_of(name, yaw)):
        about = row.copy()
        about[CENTRE:TURN] = 0.0
        across = math.hypot(n[0], n[1])
        assert (
            abs(reach_along(about, turned(turn).T @ n) - reach_along(about, n)) <= row[ARM_FLAT] * across * turn + 1e-14
        )
        assert abs(reach_along(about, tilt.T @ n) - reach_along(about, n)) <= row[ARM] * turn + 1e-14
        if k < len(pieces):
            # ... and they are not far too large: no farther than the outermost point, but for a disc that is tilted
            outermost = points(pieces[k], rng) @ turned(yaw).T - row[CENTRE:TURN]
            grown = 0.0 if isinstance(pieces[k].shape, Hull) else pieces[k].shape.disc  # type: ignore[union-attr]
            assert row[ARM_FLAT] <= np.hypot(outermost[:, 0], outermost[:, 1]).max() + grown + 1e-12
            assert row[ARM] <= np.sqrt((outermost**2).sum(1)).max() + grown + 1e-12


def test_what_looks_the_same_however_it_turns_counts_with_its_centre() -> None:
    assert rows_of("pin")[0, ARM_FLAT] == 0.0
    assert (rows_of("sphere upright")[0, [ARM_FLAT, ARM]] == 0.0).all()
    assert rows_of("cylinder along x")[0, ARM_FLAT] > 0.1


def test_a_seat_puts_a_body_at_its_pose() -> None:
    scene = crossing()
    item = next(body for body in scene.bodies if body.name == "carton")
    table = solids(scene, phases(scene, crossing_case()[1].legs, ()))
    seat = int(table.seat[0, table.number["carton"]])
    for k, piece in enumerate(item.body.pieces):
        row = table.table[table.seats[seat, FIRST] + k]
        at = item.pose.position + turned(item.pose.yaw) @ piece.position
        assert row[CENTRE:TURN] == pytest.approx(at, abs=1e-15)
        assert np.abs(row[TURN:HALF].reshape(3, 3).T - turned(item.pose.yaw) @ piece.rotation).max() <= 1e-15
