"""Quaternions against rotation matrices, thinned samples against all of them, and triangles against their shapes."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation, Slerp

from assur.planner.geometry.shapes import AXES, Body, Piece, Primitive, box, capsule, cylinder, sphere
from assur.scenes.view.display_meshes import SAG_M, Mesh, mesh_of
from assur.scenes.view.quaternions import angles_between, interpolated, of_matrices, of_yaws, rotated
from assur.scenes.view.thinning import needed, needed_of_curves

RNG = np.random.default_rng(4)
HALF_TURNS = Rotation.from_rotvec(np.pi * np.concatenate([np.eye(3), [[0.6, 0.8, 0.0], [0.0, 0.6, -0.8]]]))


@pytest.mark.parametrize("turns", [Rotation.random(200, random_state=5), HALF_TURNS, Rotation.identity(1)])
def test_quaternions_of_matrices_turn_points_as_the_matrices_do(turns: Rotation) -> None:
    q, points = of_matrices(turns.as_matrix()), RNG.normal(size=(len(turns), 3))
    assert np.linalg.norm(q, axis=1) == pytest.approx(1.0)
    assert rotated(q, points) == pytest.approx(turns.apply(points), abs=1e-12)


def test_a_yaw_is_a_turn_about_the_vertical() -> None:
    yaw = RNG.uniform(-10, 10, 50)
    there = Rotation.from_rotvec(np.stack([0 * yaw, 0 * yaw, yaw], -1))
    assert angles_between(of_yaws(yaw), there.as_quat()).max() < 1e-7


def test_attitudes_in_between_are_those_of_scipy_on_the_shorter_arc() -> None:
    for _ in range(50):
        both = Rotation.random(2, random_state=RNG.integers(1 << 30))
        share = RNG.uniform(0, 1, 7)
        first, last = both.as_quat()
        for sign in (1.0, -1.0):
            found = interpolated(first, sign * last, share)
            assert angles_between(found, Slerp([0, 1], both)(share).as_quat()).max() < 1e-7


def test_how_far_two_attitudes_are_apart_is_the_angle_between_them() -> None:
    ones, others = Rotation.random(100, random_state=6), Rotation.random(100, random_state=7)
    assert angles_between(ones.as_quat(), others.as_quat()) == pytest.approx(
        (ones.inv() * others).magnitude(), abs=1e-7
    )


def test_samples_that_are_kept_are_enough_and_few() -> None:
    t = np.linspace(0.0, 1.0, 2001)
    curve = np.sin(9 * t)[:, None]
    found = needed_of_curves(t, curve, np.array([1e-3]))
    assert np.abs(np.interp(t, t[found], curve[found, 0]) - curve[:, 0]).max() <= 1e-3
    assert 10 < len(found) < 150
    fewer = found[::2]
    assert np.abs(np.interp(t, t[fewer], curve[fewer, 0]) - curve[:, 0]).max() > 1e-3


def test_both_sides_of_a_jump_are_kept() -> None:
    t = np.array([0.0, 0.5, 0.5, 1.0])
    assert needed_of_curves(t, np.array([[0.0], [0.0], [1.0], [1.0]]), np.array([0.1])).tolist() == [0, 1, 2, 3]


def test_a_straight_line_needs_its_two_ends() -> None:
    t = np.linspace(0.0, 1.0, 50)
    assert needed_of_curves(t, 3 * t[:, None], np.array([1e-9])).tolist() == [0, 49]
    assert needed(2, lambda i, k: np.zeros(k - i + 1)).tolist() == [0, 1]


def volume(mesh: Mesh) -> float:
    """The volume that triangles enclose, m³, negative if they face inwards."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def open_sides(mesh: Mesh) -> int:
    """How many sides of triangles are not that of one other, the other way round."""
    sides = [tuple(side) for face in mesh.faces.tolist() for side in zip(face, face[1:] + face[:1], strict=True)]
    return sum((b, a) not in set(sides) for a, b in sides) + len(sides) - len(set(sides))


@pytest.mark.parametrize(
    ("shape", "true"),
    [
        (box(0.2, 0.3, 0.4), 0.024),
        (cylinder(0.1, 0.3), np.pi * 0.003),
        (sphere(0.1), 4e-3 / 3 * np.pi),
        (capsule(0.05, 0.2), np.pi * (0.0025 * 0.2 + 4 / 3 * 0.05**3)),
    ],
    ids=lambda value: value.kind if isinstance(value, Primitive) else "",
)
def test_triangles_of_a_shape_are_closed_face_outwards_and_fill_it(shape: Primitive, true: float) -> None:
    for axis in AXES:
        mesh = mesh_of(Body("one", (Piece(shape, np.array([0.5, 0.1, 0.0]), AXES[axis]),)))
        assert open_sides(mesh) == 0
        assert 0.97 * true < volume(mesh) <= true * (1 + 1e-9)


def test_round_sides_are_inside_by_little() -> None:
    mesh = mesh_of(Body("one", (Piece(cylinder(0.1, 0.3)),)))
    middles = (mesh.vertices[:-2] + np.roll(mesh.vertices[:-2], 1, 0)) / 2
    radius = np.hypot(middles[1:20, 0], middles[1:20, 1])
    assert (0.1 - radius).max() <= 2 * SAG_M


def test_an_open_mesh_is_found_out() -> None:
    mesh = mesh_of(Body("one", (Piece(box(1, 1, 1)),)))
    assert open_sides(Mesh(mesh.vertices, mesh.faces[1:])) > 0
    assert volume(Mesh(mesh.vertices, mesh.faces[:, ::-1])) < 0
