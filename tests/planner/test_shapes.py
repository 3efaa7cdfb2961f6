"""Solids: support functions against points of the solids, and what is refused."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.geometry.shapes import (
    AXES,
    LARGEST_M,
    SMALLEST_M,
    Body,
    Hull,
    Piece,
    Primitive,
    box,
    capsule,
    corners,
    cylinder,
    sphere,
    support,
)

KINDS = ("box", "sphere", "cylinder", "capsule")
sizes = st.one_of(st.sampled_from([0.01, 0.1, 1.0]), st.floats(1e-3, 2.0))
angles = st.one_of(st.sampled_from([0.0, math.pi / 2, math.pi, -math.pi / 2]), st.floats(-4, 4))
TETRAHEDRON = np.array([[0.0, 0, 0], [0.3, 0, 0], [0, 0.2, 0], [0, 0, 0.1]])
TRIANGLES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])


@st.composite
def primitives(draw: st.DrawFn, kind: str) -> Primitive:
    if kind == "box":
        return box(draw(sizes), draw(sizes), draw(sizes))
    if kind == "sphere":
        return sphere(draw(sizes))
    return (cylinder if kind == "cylinder" else capsule)(draw(sizes), draw(sizes))


@st.composite
def units(draw: st.DrawFn) -> FloatArray:
    """A unit vector (3,), often along an axis."""
    around, up = draw(angles), draw(st.one_of(st.sampled_from([0.0, 1.0, -1.0]), st.floats(-1, 1)))
    flat = math.sqrt(1 - up**2)
    return np.array([flat * math.cos(around), flat * math.sin(around), up])


@st.composite
def rotations(draw: st.DrawFn) -> FloatArray:
    """A rotation (3, 3), often by quarter turns."""
    made = np.eye(3)
    for axis in ("x", "y", "z"):
        angle = draw(angles)
        i, k = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
        turn = np.eye(3)
        turn[i, i] = turn[k, k] = math.cos(angle)
        turn[k, i], turn[i, k] = math.sin(angle), -math.sin(angle)
        made = made @ turn
    return made


def inside(shape: Primitive, x: FloatArray) -> FloatArray:
    """By how much points x (m, 3) are outside of the solid, m; negative inside. From the definition of each solid."""
    hx, hy, hz = shape.half
    x, y, z = x.T
    outside: dict[str, FloatArray] = {
        "box": np.maximum(np.maximum(np.abs(x) - hx, np.abs(y) - hy), np.abs(z) - hz),
        "sphere": np.hypot(np.hypot(x, y), z) - shape.ball,
        "cylinder": np.maximum(np.hypot(x, y) - shape.disc, np.abs(z) - hz),
        "capsule": np.hypot(np.hypot(x, y), z - np.clip(z, -hz, hz)) - shape.ball,
    }
    return outside[shape.kind]


def farthest(shape: Primitive, n: FloatArray) -> FloatArray:
    """A point (3,) of the solid that is farthest along n, from the definition of each solid."""
    hx, hy, hz = shape.half
    flat = np.array([n[0], n[1], 0.0])
    length = float(np.linalg.norm(flat))
    end = np.array([0.0, 0.0, math.copysign(hz, n[2])])
    points: dict[str, FloatArray] = {
        "box": np.copysign(np.array([hx, hy, hz]), n),
        "sphere": shape.ball * n,
        "cylinder": end + (shape.disc / length * flat if length > 0 else flat),
        "capsule": end + shape.ball * n,
    }
    return points[shape.kind]


@pytest.mark.parametrize("kind", KINDS)
@given(data=st.data())
def test_the_support_is_that_of_the_farthest_point_of_the_solid(kind: str, data: st.DataObject) -> None:
    shape, n = data.draw(primitives(kind)), data.draw(units())
    found = support(Piece(shape), n)
    point = farthest(shape, n)
    assert inside(shape, point[None])[0] <= 1e-15
    assert found == pytest.approx(point @ n, rel=1e-12)
    # ... and no point of the solid is farther: a cloud that fills the box about it, cut down to the solid.
    grown = np.array([shape.disc + shape.ball, shape.disc + shape.ball, shape.ball])
    cloud = np.random.default_rng(1).uniform(-1, 1, (4000, 3)) * (np.array(shape.half) + grown)
    solid = cloud[inside(shape, cloud) <= 0]
    assert len(solid) > 100
    assert (solid @ n).max() <= found + 1e-15


@given(st.lists(st.tuples(*3 * [st.floats(-1, 1)]), min_size=4, max_size=12), units())
def test_the_support_of_a_hull_is_the_farthest_vertex(
    vertices: list[tuple[float, float, float]], n: FloatArray
) -> None:
    assert support(Piece(Hull(np.array(vertices), TRIANGLES)), n) == pytest.approx(
        max(sum(a * b for a, b in zip(vertex, n.tolist(), strict=True)) for vertex in vertices), abs=1e-15
    )


@pytest.mark.parametrize("kind", [*KINDS, "hull"])
@given(data=st.data())
def test_the_support_moves_and_turns_with_the_solid(kind: str, data: st.DataObject) -> None:
    shape = Hull(TETRAHEDRON, TRIANGLES) if kind == "hull" else data.draw(primitives(kind))
    n, rotation = data.draw(units()), data.draw(rotations())
    position = np.array(data.draw(st.tuples(*3 * [st.floats(-2, 2)])))
    posed = support(Piece(shape, position, rotation), n)
    assert posed == pytest.approx(support(Piece(shape), rotation.T @ n) + n @ position, abs=1e-12)
    # Turned and looked at from a turned direction, nothing has changed.
    turn = data.draw(rotations())
    assert support(Piece(shape, turn @ position, turn @ rotation), turn @ n) == pytest.approx(posed, abs=1e-12)


def test_full_lengths_become_the_half_extents_of_the_solid() -> None:
    x, z = np.array([1.0, 0, 0]), np.array([0, 0, 1.0])
    for shape, across, up in (
        (box(0.4, 0.2, 0.6), 0.2, 0.3),
        (sphere(0.1), 0.1, 0.1),
        (cylinder(0.1, 0.6), 0.1, 0.3),
        (capsule(0.1, 0.6), 0.1, 0.4),
    ):
        assert (support(Piece(shape), x), support(Piece(shape), z)) == pytest.approx((across, up), rel=1e-15)


@pytest.mark.parametrize("axis", AXES)
def test_axes_lay_the_local_z_along_a_body_axis(axis: str) -> None:
    np.testing.assert_array_equal(AXES[axis] @ [0, 0, 1], np.eye(3)["xyz".index(axis)])
    assert Piece(cylinder(0.1, 1.0), np.zeros(3), AXES[axis]).shape == cylinder(0.1, 1.0)


@given(primitives("box"))
def test_corners_of_a_box_are_its_eight_extremes(shape: Primitive) -> None:
    found = corners(shape)
    assert len(np.unique(found, axis=0)) == 8
    np.testing.assert_array_equal(np.abs(found), np.tile(shape.half, (8, 1)))


MAKERS: list[tuple[str, Callable[[float], Primitive]]] = [
    ("box.size[0]", lambda x: box(x, 1.0, 1.0)),
    ("box.size[1]", lambda x: box(1.0, x, 1.0)),
    ("box.size[2]", lambda x: box(1.0, 1.0, x)),
    ("sphere.radius", sphere),
    ("cylinder.radius", lambda x: cylinder(x, 1.0)),
    ("cylinder.height", lambda x: cylinder(1.0, x)),
    ("capsule.radius", lambda x: capsule(x, 1.0)),
    ("capsule.length", lambda x: capsule(1.0, x)),
]
BAD = (0.0, -0.1, -0.0, math.nan, math.inf, -math.inf, 9e-6, 51.0, "wide", None)


@pytest.mark.parametrize(("field", "make"), MAKERS)
@pytest.mark.parametrize("size", BAD)
def test_a_size_that_is_none_is_refused_by_its_name(
    field: str, make: Callable[[object], Primitive], size: object
) -> None:
    with pytest.raises(InputError) as refused:
        make(size)
    assert refused.value.field == field
    for allowed in (SMALLEST_M, LARGEST_M):
        make(allowed)


@pytest.mark.parametrize(
    ("kind", "half", "disc", "ball"),
    [
        ("cone", (0.1, 0.1, 0.1), 0.0, 0.0),
        ("box", (0.1, -0.1, 0.1), 0.0, 0.0),
        ("box", (0.1, 0.1), 0.0, 0.0),
        ("box", (0.1, 0.1, 0.1), 0.0, 0.1),
        ("box", (0.1, 0.1, math.nan), 0.0, 0.0),
        ("sphere", (0.0, 0.0, 0.0), 0.0, -0.1),
        ("sphere", (0.0, 0.0, 0.0), math.nan, 0.1),
        ("cylinder", (0.0, 0.0, 0.1), 0.0, 0.0),
        ("capsule", (0.0, 0.0, 0.1), 0.0, math.inf),
        ("capsule", (0.1, 0.0, 0.1), 0.0, 0.1),
    ],
)
def test_terms_that_make_no_solid_of_the_kind_are_refused(
    kind: str, half: tuple[float, float, float], disc: float, ball: float
) -> None:
    with pytest.raises(InputError, match=kind):
        Primitive(kind, half, disc, ball)


@pytest.mark.parametrize(
    ("field", "vertices", "faces"),
    [
        ("hull.vertices", TETRAHEDRON[:3], TRIANGLES),
        ("hull.vertices", TETRAHEDRON * [1, 1, math.nan], TRIANGLES),
        ("hull.vertices", TETRAHEDRON * 1000, TRIANGLES),
        ("hull.vertices", TETRAHEDRON[:, :2], TRIANGLES),
        ("hull.faces", TETRAHEDRON, TRIANGLES[:3]),
        ("hull.faces", TETRAHEDRON, TRIANGLES[:, :2]),
        ("hull.faces", TETRAHEDRON, TRIANGLES + 1),
        ("hull.faces", TETRAHEDRON, TRIANGLES - 1),
        ("hull.faces", TETRAHEDRON, TRIANGLES * 0.5),
        ("hull.faces", TETRAHEDRON, TRIANGLES * math.nan),
        ("hull.faces", TETRAHEDRON, "all"),
    ],
)
def test_a_hull_that_is_no_polyhedron_is_refused(field: str, vertices: FloatArray, faces: FloatArray) -> None:
    with pytest.raises(InputError) as refused:
        Hull(vertices, faces)  # type: ignore[arg-type]
    assert refused.value.field == field


def test_a_hull_keeps_copies_that_cannot_be_written_to() -> None:
    vertices = TETRAHEDRON.copy()
    hull = Hull(vertices, TRIANGLES)
    vertices[0] = 9.0
    assert hull.vertices[0].tolist() == [0.0, 0.0, 0.0]
    for array in (hull.vertices, hull.faces):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1


@pytest.mark.parametrize(
    "rotation",
    [
        np.diag([1.0, 1.0, -1.0]),
        np.diag([2.0, 1.0, 0.5]),
        np.eye(3) * (1 + 1e-8),
        np.eye(3) + 1e-8 * np.eye(3, k=1),
        np.eye(3) * math.nan,
        np.zeros((3, 3)),
        np.eye(2),
    ],
)
def test_a_piece_refuses_what_does_not_rotate(rotation: FloatArray) -> None:
    with pytest.raises(InputError) as refused:
        Piece(sphere(0.1), np.zeros(3), rotation)
    assert refused.value.field == "piece.rotation"


@pytest.mark.parametrize("position", [(math.nan, 0, 0), (math.inf, 0, 0), (0, 0), "here"])
def test_a_piece_refuses_what_is_no_position(position: object) -> None:
    with pytest.raises(InputError) as refused:
        Piece(sphere(0.1), position)  # type: ignore[arg-type]
    assert refused.value.field == "piece.position"


@given(rotations())
def test_a_piece_takes_every_rotation_up_to_rounding(rotation: FloatArray) -> None:
    np.testing.assert_array_equal(Piece(sphere(0.1), np.zeros(3), rotation).rotation, rotation)


def test_a_body_of_no_pieces_is_refused_by_its_name() -> None:
    with pytest.raises(InputError, match="bed"):
        Body("bed", ())


def test_a_surface_that_is_none_or_could_change_is_refused() -> None:
    piece = Piece(Hull(TETRAHEDRON, TRIANGLES))
    still, loose = Hull(TETRAHEDRON, TRIANGLES), TETRAHEDRON.copy()
    assert Body("mesh", (piece,), (still.vertices, still.faces)).surface is not None
    for surface in ((loose, still.faces), (still.vertices[:, :2], still.faces), (still.vertices, still.faces[0])):
        with pytest.raises(InputError, match="mesh"):
            Body("mesh", (piece,), surface)
