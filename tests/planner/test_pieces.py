"""The flat table of pieces says of each what the piece itself says."""

from __future__ import annotations

import numpy as np
import pytest

from assur.planner.collision.bodies import COVER, Bodies
from assur.planner.geometry.shapes import Hull, Primitive, box, cylinder, pieces, sphere
from assur.planner.kernels.solids import HALF
from assur.planner.model.attachments import AT_START
from tests.planner.cells import CUP, Around, arm, block, cell, go, mesh_box, solid, stands


def test_the_table_of_a_scene_has_the_pieces_of_arm_tool_and_surroundings_in_order() -> None:
    wedge = Around(solid("wedge", block(0.1, 0.05, 0.05, (0.05, 0.0, 0.0))))
    around = (stands("ball", sphere(0.02), 0.3), Around(mesh_box("bin", 0.2, 0.2, 0.1)), wedge)
    scene = cell(go(0.3, 0.0), bodies=around, robot=arm(column=0.05), tool=CUP)
    bodies = [each.body for each in scene.robot.bodies] + list(CUP.bodies) + [each.body for each in around]
    table = scene.pieces
    every = [piece for body in bodies for piece in body.pieces]
    assert table.count.tolist() == [len(body.pieces) for body in bodies]
    assert table.first.tolist() == [sum(len(b.pieces) for b in bodies[:k]) for k in range(len(bodies))]
    assert table.shapes == tuple(piece.shape for piece in every)
    for k, piece in enumerate(every):
        assert np.array_equal(table.position[k], piece.position)
        assert np.array_equal(table.rotation[k], piece.rotation)
        if isinstance(piece.shape, Hull):
            assert table.hulls[table.hull[k]] is piece.shape
            assert not table.half[k].any()
            assert table.disc[k] == table.ball[k] == 0.0
        else:
            assert isinstance(piece.shape, Primitive)
            assert table.hull[k] == -1
            assert (tuple(table.half[k]), table.disc[k], table.ball[k]) == (
                piece.shape.half,
                piece.shape.disc,
                piece.shape.ball,
            )
    with pytest.raises(ValueError, match="read-only"):
        table.half[0] = 1.0


def test_no_bodies_have_no_pieces() -> None:
    table = pieces([])
    assert table.position.shape == (0, 3)
    assert table.rotation.shape == (0, 3, 3)


def test_units_are_primitives_themselves_and_boxes_before_everything_else() -> None:
    bodies = [solid("post", cylinder(0.1, 0.2)), mesh_box("bin", 0.2, 0.2, 0.1), solid("cube", box(0.1, 0.1, 0.1))]
    many = len(bodies[1].pieces)
    scene = cell(go(0.3, 0.0), bodies=tuple(Around(body) for body in bodies), robot=arm(bare=True))
    found = Bodies(scene)(AT_START)
    post, bin_, cube = (found.number[body.name] for body in bodies)
    first = int(found.roots[post])
    assert found.piece[first:].tolist() == [0, COVER, *range(many), 0]
    assert found.roots[post:].tolist() == [first, first + 1, first + many + 2]
    assert found.shape(first) is bodies[0].pieces[0].shape
    # box and pieces of the bin, then the cube: nothing of one is given to another
    assert [found.shape(unit) for unit in found.pieces(bin_)] == [piece.shape for piece in bodies[1].pieces]
    half = found.rows[:, HALF : HALF + 3]
    assert half[int(found.roots[cube])].tolist() == [0.05, 0.05, 0.05]
    assert np.abs(half[int(found.roots[bin_])] - [0.1, 0.1, 0.05]).max() <= 2e-9
