"""Shapes, axes and places: where the corners of bodies come to be, by hand."""

from __future__ import annotations

import copy
import math
from typing import Any

import numpy as np
import pytest

from assur.planner.geometry.shapes import Body, Primitive, support
from assur.planner.model.scene import Scene, WorldBody
from assur.scenes.requests import scene_of
from tests.scenes.bad_requests import GOOD_REQUEST


def cell(*bodies: dict[str, Any], tool: list[dict[str, Any]] | None = None) -> Scene:
    """A cell with these bodies besides the good request's."""
    request = copy.deepcopy(GOOD_REQUEST)
    request["bodies"] += bodies
    if tool is not None:
        request["robot"]["tool"]["bodies"] = tool
    return scene_of(request)


def body(shape: dict[str, Any], **pose: Any) -> WorldBody:
    """A body of this shape in a cell."""
    item = {"name": "tested", "shape": shape, "pose": {"at_m": [0, 0, 0], **pose}}
    return cell(item).index["tested"]


def extents(solid: Body) -> list[tuple[float, float]]:
    """Lowest and highest coordinate along each axis, mm."""
    found = []
    for n in np.eye(3):
        low, high = (max(support(piece, s * n) for piece in solid.pieces) for s in (-1, 1))
        found.append((round(-1000 * low, 6), round(1000 * high, 6)))
    return found


@pytest.mark.parametrize(
    ("shape", "sizes"),
    [
        ({"box": {"size_mm": [10, 20, 30]}}, (10, 20, 30)),
        ({"sphere": {"radius_mm": 5}}, (10, 10, 10)),
        ({"cylinder": {"radius_mm": 5, "height_mm": 40}}, (10, 10, 40)),
        ({"cylinder": {"radius_mm": 5, "height_mm": 40, "axis": "x"}}, (40, 10, 10)),
        ({"cylinder": {"radius_mm": 5, "height_mm": 40, "axis": "y"}}, (10, 40, 10)),
        ({"capsule": {"radius_mm": 5, "length_mm": 40}}, (10, 10, 50)),
        ({"capsule": {"radius_mm": 5, "length_mm": 40, "axis": "x"}}, (50, 10, 10)),
        ({"mesh": {"asset": "bracket", "unit": "mm"}}, (60, 40, 20)),
        ({"mesh": {"asset": "tray", "unit": "mm"}}, (200, 150, 60)),
        ({"mesh": {"asset": "bracket", "unit": "cm"}}, (600, 400, 200)),
        ({"mesh": {"asset": "bracket", "unit": "in"}}, (60 * 25.4, 40 * 25.4, 20 * 25.4)),
    ],
)
def test_a_shape_is_centred_and_as_large_as_it_says(shape: dict[str, Any], sizes: tuple[float, ...]) -> None:
    for (low, high), size in zip(extents(body(shape).body), sizes, strict=True):
        assert (low, high) == pytest.approx((-size / 2, size / 2), abs=2e-4)


def test_a_convex_mesh_is_solid_and_a_hollow_one_keeps_its_surface() -> None:
    housing = body({"mesh": {"asset": "housing", "unit": "mm"}}).body
    assert housing.surface is not None
    assert housing.surface[1].shape == (24, 3)
    assert body({"box": {"size_mm": [1, 1, 1]}}).body.surface is None


def test_a_place_on_a_body_is_a_place_in_that_bodys_frame() -> None:
    tray = {
        "name": "tray",
        "shape": {"box": {"size_mm": [90, 90, 4]}},
        "pose": {"frame": "belt", "at_mm": [100, 10, 2], "yaw_deg": 90},
    }
    screw = {
        "name": "screw",
        "shape": {"sphere": {"radius_mm": 2}},
        "pose": {"body": "tray", "at_mm": [30, 0, 4], "yaw_deg": 10},
    }
    placed = cell(tray, screw).index["screw"]
    assert placed.frame == "belt"
    assert (placed.pose.x, placed.pose.y, placed.pose.z) == pytest.approx((0.1, 0.04, 0.006))
    assert placed.pose.yaw == pytest.approx(math.radians(100))


def test_mass_and_symmetry_of_a_part_are_kept() -> None:
    part = scene_of(GOOD_REQUEST).index["part"]
    assert (part.mass_kg, part.yaw_symmetry) == (0.12, 2)


def test_bodies_of_the_tool_sit_in_the_flange() -> None:
    finger = {"name": "finger", "shape": {"box": {"size_mm": [40, 4, 10]}}, "at_mm": [0, 30, -20], "yaw_deg": 90}
    found = cell(tool=[finger]).tool.bodies[0]
    assert extents(found) == [(-2, 2), (10, 50), (-25, -15)]


def test_a_mesh_on_the_tool_is_moved_with_its_surface() -> None:
    shell = {"name": "shell", "shape": {"mesh": {"asset": "tray", "unit": "mm"}}, "at_mm": [0, 0, -30], "yaw_deg": 90}
    found = cell(tool=[shell]).tool.bodies[0]
    assert extents(found) == [(-75, 75), (-100, 100), (-60, 0)]
    assert found.surface is not None
    low, high = found.surface[0].min(0), found.surface[0].max(0)
    np.testing.assert_allclose([low, high], [[-0.075, -0.1, -0.06], [0.075, 0.1, 0.0]], atol=1e-7)


def test_equal_meshes_share_their_pieces() -> None:
    one = {"name": "one", "shape": {"mesh": {"asset": "flange", "unit": "mm"}}, "pose": {"at_mm": [0, -500, 7]}}
    other = {**one, "name": "other", "pose": {"at_mm": [0, -700, 7]}}
    scene = cell(one, other)
    assert scene.index["one"].body.pieces is scene.index["other"].body.pieces


def test_a_thousand_bodies_are_taken() -> None:
    items = [
        {"name": f"b{i}", "shape": {"box": {"size_mm": [1, 1, 1]}}, "pose": {"at_mm": [i, -900, 0]}} for i in range(996)
    ]
    scene = cell(*items)
    assert len(scene.bodies) == 1000
    assert isinstance(scene.bodies[-1].body.pieces[0].shape, Primitive)
