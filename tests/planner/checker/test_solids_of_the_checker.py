"""Supports, boxes and reaches of the checker's own table, against one solid at a time and against points."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from assur.planner.arrays import FloatArray
from assur.planner.checker.solids import solids
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import AXES, Body, Hull, Piece, Primitive, box, capsule, cylinder, sphere, support
from assur.planner.model.scene import WorldBody
from tests.planner.checker.hand_made import box_of, carton, crossing, wedge
from tests.planner.convex import distance_from_origin


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
TABLE = solids(SCENE)
NAMES = [body.name for body in BODIES]


def reach_of(body: int, offset: FloatArray) -> FloatArray:
    return TABLE.reach(np.array([body]), offset[None])[1]


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
    body = TABLE.number[name]
    for k, piece in enumerate(TABLE.bodies[body].pieces):
        found = TABLE.support(TABLE.of(np.array([body]), np.array([k])), n[None])[0]
        assert found == pytest.approx(support(piece, n), abs=1e-15)
    whole = TABLE.support(TABLE.of(np.array([body]), np.array([-1])), n[None])[0]
    assert whole == pytest.approx(support(box_of(TABLE.bodies[body]), n), abs=1e-15)
    assert all(whole >= support(piece, n) - 1e-15 for piece in TABLE.bodies[body].pieces)


@given(
    st.sampled_from(NAMES),
    st.integers(0, 2**32 - 1),
    st.tuples(*[st.sampled_from([0.0, 0.1, -0.3]) | st.floats(-1, 1)] * 3),
    st.sampled_from([0.0, np.pi / 2, 1.0]),
    st.floats(1e-3, 1.0),
)
def test_turning_moves_no_support_faster_than_the_reach(
    name: str, seed: int, place: tuple[float, float, float], yaw: float, turn: float
) -> None:
    """What the reach is for: when the carrier turns, the support along n grows by at most reach |n_xy| a radian."""
    rng = np.random.default_rng(seed)
    n = rng.normal(size=3)
    n /= np.linalg.norm(n)
    body = TABLE.number[name]
    offset = Pose(*place, yaw)
    reaches = reach_of(body, np.array([*place, yaw]))
    across = math.hypot(n[0], n[1])
    for k, piece in enumerate(TABLE.bodies[body].pieces):
        centre = offset.position

        def along(angle: float, piece: Piece = piece, centre: FloatArray = centre) -> float:
            local = turned(angle).T @ n
            return float(local @ centre) + support(piece, turned(yaw).T @ local)

        assert abs(along(turn) - along(0.0)) <= reaches[k] * across * turn + 1e-14
        # ... and it is not far too large: no larger than the outermost point, but for a disc that is tilted.
        outermost = centre + points(piece, rng) @ turned(yaw).T
        grown = 0.0 if isinstance(piece.shape, Hull) else piece.shape.disc + piece.shape.ball
        assert reaches[k] <= np.hypot(outermost[:, 0], outermost[:, 1]).max() + grown + 1e-12
    assert reaches[-1] <= max(reaches[:-1])
    assert len(reaches) == len(TABLE.bodies[body].pieces) + 1


@given(
    st.sampled_from(NAMES),
    st.integers(0, 2**32 - 1),
    st.tuples(*[st.sampled_from([0.0, 0.1, -0.3]) | st.floats(-1, 1)] * 3),
    st.sampled_from([0.0, np.pi / 2, 1.0]),
    st.floats(1e-3, 1.0),
)
def test_tilting_moves_no_support_faster_than_the_distance_and_the_makers_is_no_smaller(
    name: str, seed: int, place: tuple[float, float, float], yaw: float, turn: float
) -> None:
    """The carrier turns about any axis through its origin: the support along n grows by at most distance a radian."""
    rng = np.random.default_rng(seed)
    n, axis = rng.normal(size=(2, 3))
    n, axis = n / np.linalg.norm(n), axis / np.linalg.norm(axis)
    rotation = Rotation.from_rotvec(turn * axis).as_matrix()
    body, position = TABLE.number[name], np.array(place)
    distances = TABLE.reach(np.array([body]), np.array([[*place, yaw]]))[2]
    for k, piece in enumerate(TABLE.bodies[body].pieces):

        def along(direction: FloatArray, piece: Piece = piece) -> float:
            return float(direction @ position) + support(piece, turned(yaw).T @ direction)

        assert abs(along(rotation.T @ n) - along(n)) <= distances[k] * turn + 1e-14
        assert distances[k] <= distance_from_origin(piece, position, turned(yaw)) + 1e-15
        outermost = position + points(piece, rng) @ turned(yaw).T
        grown = 0.0 if isinstance(piece.shape, Hull) else piece.shape.disc + piece.shape.ball
        assert distances[k] <= np.sqrt((outermost**2).sum(1)).max() + grown + 1e-12
    assert distances[-1] <= max(distances[:-1])


def test_a_pin_on_the_axis_does_not_move_when_it_turns() -> None:
    pin = TABLE.number["pin"]
    assert (reach_of(pin, np.zeros(4)) == 0).all()
    assert reach_of(pin, np.array([0.3, 0.4, 1.0, 2.0])) == pytest.approx([0.5, 0.5])


def test_many_bodies_are_measured_as_one_at_a_time() -> None:
    rng = np.random.default_rng(0)
    bodies = rng.choice(len(TABLE.count), 40)
    offsets = rng.normal(size=(40, 4))
    start, *found = TABLE.reach(bodies, offsets)
    for k, body in enumerate(bodies):
        alone = TABLE.reach(np.array([body]), offsets[k][None])[1:]
        for many, one in zip(found, alone, strict=True):
            assert (many[start[k] : start[k] + TABLE.count[body] + 1] == one).all()
