"""Warnings about picks that may miss their part: told from half of its smallest horizontal extent on, and not below."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from assur.planner.feasibility.input_warnings import smallest_extent, unusual_arrivals
from assur.planner.geometry.shapes import Body, Piece, Primitive, box, capsule, cylinder
from assur.planner.laws.law import PoseUncertainty
from assur.planner.model.input_warning import Odd
from assur.planner.model.outcome import Planned
from assur.planner.model.scene import Pick, Scene
from assur.planner.model.task import Tolerance
from assur.planner.pipeline import plan
from assur.planner.report.notes import warned
from tests.planner.cells import block, table_to_table


def lying(by_m: float, tolerance: Tolerance | None = None) -> Scene:
    """`table_to_table` with a part of 60 mm x 30 mm that may lie so far beside its place."""
    scene = table_to_table(shape=box(0.06, 0.03, 0.02))
    known = PoseUncertainty(position_m=by_m)
    bodies = [replace(body, uncertainty=known) if body.name == "part" else body for body in scene.bodies]
    pick = scene.task[0]
    assert isinstance(pick, Pick)
    task = pick if tolerance is None else replace(pick, tolerance=tolerance)
    options = replace(scene.options, stop="first", budget_s=60.0, max_candidates=200)
    return replace(scene, bodies=tuple(bodies), task=(task,), options=options)


def test_a_pick_that_may_miss_its_part_is_told_with_step_and_cause() -> None:
    told = plan(lying(0.0152))
    assert isinstance(told, Planned)
    (warning,) = told.warnings
    assert (warning.kind, warning.bodies) == (Odd.MAY_MISS, ("cup", "part"))
    assert warning.amount_m == pytest.approx(0.0152, abs=1e-5)
    expected = "the tool may miss part by 15.2 mm, mainly due to: part; state tolerance_mm for step pick"
    assert warned(warning) == f"{expected} to have it refused"


@pytest.mark.parametrize("scene", [lying(0.0148), lying(0.0152, Tolerance(0.02))], ids=["smaller", "tolerance"])
def test_a_smaller_error_and_one_that_is_allowed_are_not_told(scene: Scene) -> None:
    told = plan(scene)
    assert isinstance(told, Planned)
    assert told.warnings == ()


def test_a_tolerance_of_the_yaw_alone_allows_no_distance() -> None:
    scene = lying(0.0152, Tolerance(yaw_rad=1.0))
    told = plan(scene)
    assert isinstance(told, Planned)
    assert [each.kind for each in unusual_arrivals(scene, told.plan.arrivals)] == [Odd.MAY_MISS]


@pytest.mark.parametrize(
    ("shape", "extent"),
    [
        (box(0.06, 0.03, 0.02), 0.03),
        (cylinder(0.02, 0.1), 0.04),
        (capsule(0.01, 0.1), 0.02),
        (block(0.05, 0.08, 1), 0.05),
    ],
)
def test_the_smallest_extent_is_that_of_the_shape_whatever_its_place(shape: Primitive, extent: float) -> None:
    assert smallest_extent(Body("one", (Piece(shape, np.array([1.0, -2.0, 3.0])),))) == pytest.approx(extent)
    c, s = math.cos(0.3), math.sin(0.3)
    turned = Piece(shape, np.zeros(3), np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))
    assert extent - 1e-12 <= smallest_extent(Body("one", (turned,))) <= 1.02 * extent
