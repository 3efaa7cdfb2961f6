"""Quaternions against rotation matrices, thinned samples against all of them, and triangles against their shapes."""

from __future__ import annotations

import numpy as np
import pytest

from assur.planner.geometry.shapes import AXES, Body, Piece, Primitive, box, capsule, cylinder, sphere
from assur.scenes.view.display_meshes import SAG_M, Mesh, mesh_of
from assur.scenes.view.thinning import needed, needed_of_curves


def test_samples_that_are_kept_are_enough_and_few() -> None:
    t = np.linspace(0.0, 1.0, 2001)
    curve = np.sin(9 * t)[:, None]
    found = needed_of_curves(t, curve, np.array([1e-3]))
    assert np.abs(np.interp(t, t[found], curve[found, 0]) - curve[:, 0]).max() <= 1e-3
    assert 10 < len(found) < 150
    fewer = found[::2]
    assert np.abs(np.interp(t, t[fewer], curve[fewer, 0]) - curve[:, 0]).max() > 1e-3


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
