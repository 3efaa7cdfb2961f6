"""Volumes, centroids and moments of inertia: by hand, by trimesh, and by sums over a fine grid."""

from __future__ import annotations

import math

import numpy as np
import pytest

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import AXES, Body, Piece, box, capsule, cylinder, sphere
from assur.planner.geometry.surface import spread
from assur.planner.model.load import Tool, greatest_inertia, held_inertia
from tests.planner.cells import block, rotation, solid

RNG = np.random.default_rng(7)
TURNED = rotation(RNG)
SOLIDS = {
    "box": solid("box", box(0.2, 0.1, 0.05), 0.03, -0.02, 0.01),
    "box, turned in space": Body("box", (Piece(box(0.2, 0.1, 0.05), np.array([0.03, -0.02, 0.01]), TURNED),)),
    "cylinder": solid("cylinder", cylinder(0.04, 0.12), 0.01),
    "cylinder that lies": solid("cylinder", cylinder(0.04, 0.12), 0.01, 0.02, along="y"),
    "sphere": solid("sphere", sphere(0.05), 0.02),
    "capsule": solid("capsule", capsule(0.03, 0.1), -0.01),
    "capsule that lies": solid("capsule", capsule(0.03, 0.1), -0.01, 0.03, along="x"),
    "hull": Body("hull", (Piece(block(0.1, 0.2, 0.3, (0.05, 0.0, 0.0)), np.array([0.0, 0.1, 0.0]), AXES["x"]),)),
    "two pieces": Body("two", (Piece(box(0.1, 0.1, 0.1)), Piece(sphere(0.03), np.array([0.2, 0.0, 0.0])))),
}


def inside(piece: Piece, points: FloatArray) -> BoolArray:
    """Which points (.., 3) are in a primitive: another way to describe it than by its moments."""
    local = (points - piece.position) @ piece.rotation
    shape = piece.shape
    (x, y, h), disc, ball = shape.half, shape.disc, shape.ball  # type: ignore[union-attr]
    if disc > 0.0:
        return np.asarray((np.hypot(local[:, 0], local[:, 1]) <= disc) & (np.abs(local[:, 2]) <= h))
    nearest = np.clip(local, [-x, -y, -h], [x, y, h])
    return np.asarray(np.linalg.norm(local - nearest, axis=1) <= ball + 1e-12)


def by_grid(body: Body) -> tuple[float, FloatArray, float]:
    """Volume, centroid and mean square distance from the vertical through it, by a point in each of 10⁶ cells."""
    total, rng = np.zeros(5), np.random.default_rng(1)
    for piece in body.pieces:
        edges = np.linspace(-0.25, 0.25, 101)
        middle = (edges[1:] + edges[:-1]) / 2
        points = np.stack(np.meshgrid(middle, middle, middle, indexing="ij"), -1).reshape(-1, 3)
        points += 0.005 * (rng.random(points.shape) - 0.5)
        size = 0.13 / 0.25  # the solids are no larger than this about their own middles
        own = piece.position + points * size
        hit = own[inside(piece, own)]
        cell = (0.005 * size) ** 3
        total += cell * np.array([len(hit), *hit.sum(0), (hit[:, 0] ** 2 + hit[:, 1] ** 2).sum()])
    centroid = total[1:4] / total[0]
    return float(total[0]), centroid, float(total[4] / total[0] - centroid[0] ** 2 - centroid[1] ** 2)


@pytest.mark.parametrize("name", [name for name in SOLIDS if name != "hull"])
def test_moments_are_those_of_a_fine_grid(name: str) -> None:
    found, (volume, centroid, square) = spread(SOLIDS[name]), by_grid(SOLIDS[name])
    assert found.volume == pytest.approx(volume, rel=4e-3)
    assert np.abs(np.array(found.centroid) - centroid).max() <= 3e-4
    assert found.square == pytest.approx(square, rel=4e-3)


def test_a_surface_that_is_inside_out_encloses_nothing() -> None:
    hull = block(0.1, 0.1, 0.1)
    vertices, faces = hull.vertices.copy(), hull.faces[:, ::-1].copy()
    vertices.flags.writeable = faces.flags.writeable = False
    with pytest.raises(InputError, match=r"body shell.*a solid with a volume"):
        spread(Body("shell", (Piece(box(0.1, 0.1, 0.1)),), (vertices, faces)))


def test_a_box_beside_the_axis_has_its_inertia_by_hand() -> None:
    """1.2 kg, 200 x 100 mm, gripped 30 mm beside its middle by a tool point 50 mm beside the axis: 20 mm remain."""
    part, tcp, grasp = solid("part", box(0.2, 0.1, 0.05)), Pose(0.05, 0.0, -0.1), Pose(0.03, 0.0, 0.025)
    held = tcp.then(grasp.inverse())
    assert (held.x, held.y) == pytest.approx((0.02, 0.0), abs=1e-17)
    assert held_inertia(part, 1.2, held) == pytest.approx(1.2 * ((0.2**2 + 0.1**2) / 12 + 0.02**2), rel=1e-13)
    # turned by 90° in the gripper its middle is 50 mm ahead of the axis and 30 mm beside it
    across = tcp.then(Pose(0.03, 0.0, 0.025, math.pi / 2).inverse())
    assert held_inertia(part, 1.2, across) == pytest.approx(1.2 * (0.05 / 12 + 0.05**2 + 0.03**2), rel=1e-13)
    assert held_inertia(part, 0.0, across) == 0.0


def test_the_greatest_inertia_is_that_of_the_worst_turn_that_a_symmetry_leaves() -> None:
    """The middle of the part is 40 mm beside its origin, about which it may be gripped in any of two or of all turns;
    the origin is 20 mm beside the axis."""
    part, tcp, grasp = solid("part", box(0.2, 0.1, 0.05), 0.04), Pose(0.05), Pose(0.03)
    own = (0.2**2 + 0.1**2) / 12
    assert greatest_inertia(part, 2.0, tcp, grasp, 1) == pytest.approx(2 * (own + 0.06**2), rel=1e-12)
    assert greatest_inertia(part, 2.0, tcp, Pose(0.03, yaw=math.pi), 1) == pytest.approx(2 * (own + 0.04**2), rel=1e-12)
    assert greatest_inertia(part, 2.0, tcp, Pose(-0.03), 2) == pytest.approx(2 * (own + 0.12**2), rel=1e-12)
    assert greatest_inertia(part, 2.0, tcp, Pose(yaw=math.pi), 2) == pytest.approx(2 * (own + 0.09**2), rel=1e-12)
    assert greatest_inertia(part, 2.0, tcp, grasp, 0) == pytest.approx(2 * (own + 0.06**2), rel=1e-12)
    angles = np.linspace(0, 2 * math.pi, 99).tolist()
    turns = [held_inertia(part, 2.0, tcp.then(Pose(yaw=angle).then(grasp).inverse())) for angle in angles]
    assert max(turns) == pytest.approx(greatest_inertia(part, 2.0, tcp, grasp, 0), rel=1e-9)


def test_a_tools_mass_is_spread_over_its_bodies_by_volume_unless_its_inertia_is_stated() -> None:
    jaws = solid("left", box(0.02, 0.02, 0.06), 0.0, 0.05), solid("right", box(0.02, 0.02, 0.03), 0.0, -0.05)
    own = 2 * 0.02**2 / 12 + 0.05**2
    assert Tool(Pose(), jaws, 0.9).inertia == pytest.approx(0.9 * own, rel=1e-12)
    beside = solid("block", box(0.02, 0.02, 0.09), 0.1)
    both = (0.9 * own + 0.9 * (2 * 0.02**2 / 12 + 0.1**2)) / 2  # as large as both jaws together
    assert Tool(Pose(), (*jaws, beside), 0.9).inertia == pytest.approx(both, rel=1e-12)
    assert Tool(Pose(), jaws, 0.9, 0.004).inertia == 0.004
    assert Tool(Pose(0.03, 0.04), (), 2.0).inertia == pytest.approx(2.0 * 0.05**2, rel=1e-12)
    assert Tool(Pose(0.03, 0.04), jaws).inertia == 0.0
