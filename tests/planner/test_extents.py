"""Extents of solids: none of their points is farther from the axis that they are carried about."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.geometry.shapes import Hull, Piece, Primitive, box, radius, support
from tests.planner.test_shapes import KINDS, TETRAHEDRON, TRIANGLES, primitives, rotations


@pytest.mark.parametrize("kind", [*KINDS, "hull"])
@given(data=st.data())
def test_the_radius_holds_all_of_the_solid_however_its_frame_turns(kind: str, data: st.DataObject) -> None:
    shape = Hull(TETRAHEDRON, TRIANGLES) if kind == "hull" else data.draw(primitives(kind))
    piece = Piece(shape, np.array(data.draw(st.tuples(*3 * [st.floats(-1, 1)]))), data.draw(rotations()))
    around = np.linspace(-math.pi, math.pi, 181)
    directions = np.column_stack([np.cos(around), np.sin(around), np.zeros(181)])
    farthest_out = max(support(piece, n) for n in directions)
    found = radius(piece)
    assert found >= farthest_out - 1e-15
    # Not needlessly long: by the lying disc of a cylinder at most.
    spare = shape.disc if isinstance(shape, Primitive) else 0.0
    assert found <= farthest_out * (1 + 1e-3) + 2 * spare


def test_the_radius_of_a_box_is_that_of_its_corners() -> None:
    assert radius(Piece(box(0.2, 0.2, 0.2))) == pytest.approx(math.hypot(0.1, 0.1))
