"""Extents of solids: none of their points is farther from the axis that they are carried about."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.geometry.shapes import AXES, Hull, Piece, Primitive, box, capsule, cylinder, sphere, support
from assur.planner.kernels.solids import REACH
from tests.planner.convex import reach, unit_rows
from tests.planner.test_shapes import KINDS, TETRAHEDRON, TRIANGLES, primitives, rotations


@pytest.mark.parametrize("kind", [*KINDS, "hull"])
@given(data=st.data())
def test_the_reach_holds_all_of_the_solid_however_its_frame_turns(kind: str, data: st.DataObject) -> None:
    shape = Hull(TETRAHEDRON, TRIANGLES) if kind == "hull" else data.draw(primitives(kind))
    piece = Piece(shape, np.array(data.draw(st.tuples(*3 * [st.floats(-1, 1)]))), data.draw(rotations()))
    position, rotation = np.array([0.2, -0.1, 0.4]), data.draw(rotations())
    around = np.linspace(-math.pi, math.pi, 181)
    farthest_out = max(
        support(Piece(shape, position + rotation @ piece.position, rotation @ piece.rotation), n)
        for n in np.column_stack([np.cos(around), np.sin(around), np.zeros(181)])
    )
    found = reach(piece, position, rotation)
    assert found >= farthest_out - 1e-15
    # Not needlessly long: by the lying disc of a cylinder at most.
    spare = shape.disc if isinstance(shape, Primitive) else 0.0
    assert found <= farthest_out * (1 + 1e-3) + 2 * spare


@pytest.mark.parametrize("shape", [sphere(0.2), cylinder(0.2, 0.1), capsule(0.2, 0.1)])
def test_a_solid_of_revolution_on_its_frame_s_axis_has_no_reach(shape: Primitive) -> None:
    on_axis = Piece(shape, np.array([0.0, 0.0, 0.3]))
    assert reach(on_axis, np.zeros(3), np.eye(3)) == 0.0
    assert reach(on_axis, np.array([0.0, 1e-3, 0.0]), np.eye(3)) >= 0.2
    lying = reach(Piece(shape, np.zeros(3), AXES["x"]), np.zeros(3), np.eye(3))
    assert lying == 0.0 if shape.kind == "sphere" else lying >= 0.2
    assert reach(Piece(box(0.2, 0.2, 0.2)), np.zeros(3), np.eye(3)) == pytest.approx(math.hypot(0.1, 0.1))


@given(st.lists(st.sampled_from([*KINDS, "hull"]), min_size=1, max_size=6), st.data())
def test_many_solids_have_the_extents_that_each_has_alone(kinds: list[str], data: st.DataObject) -> None:
    shapes = [Hull(TETRAHEDRON, TRIANGLES) if kind == "hull" else data.draw(primitives(kind)) for kind in kinds]
    centre = np.array([data.draw(st.tuples(*3 * [st.sampled_from([0.0, 0.3, -1.0])])) for _ in kinds])
    axes = np.array([data.draw(rotations()) for _ in kinds])
    rows = unit_rows([Piece(shape, c, a) for shape, c, a in zip(shapes, centre, axes, strict=True)])
    reaches = rows[:, REACH]
    for k, shape in enumerate(shapes):
        piece = Piece(shape, centre[k], axes[k])
        assert reaches[k] == reach(piece, np.zeros(3), np.eye(3))
