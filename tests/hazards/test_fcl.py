"""What FCL does wrong, and what it does right: the reasons for the guards around our one door to it.

The planner relies on the boolean `fcl.collide` to refuse candidates, and on nothing else of FCL.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from typing import Any

import fcl
import numpy as np
import pytest
from numpy.typing import NDArray

from assur.planner.collision.fcl_entry import Collider, PlacedShape
from assur.planner.errors import FaultError, InputError
from assur.planner.geometry import shapes
from tests.hazards.known import mended_since

Floats = NDArray[np.float64]
LAST_SEEN = "0.7.0.11"
"""The release of python-fcl in which everything here was reproduced."""
PAIRS = 1500
"""Grid-aligned pairs a kind: the regime in which FCL's distance is wrong once in twenty."""
TOUCHING_M = 1e-9
"""Pairs that touch to rounding have no right answer and are not asked about."""


def _posed(geometry: Any, at: Any = (0.0, 0.0, 0.0), rotation: Floats | None = None) -> Any:
    turned = np.eye(3) if rotation is None else rotation
    return fcl.CollisionObject(geometry, fcl.Transform(turned, np.array(at, dtype=np.float64)))


def _collide(first: Any, second: Any) -> bool:
    return bool(fcl.collide(first, second, fcl.CollisionRequest(), fcl.CollisionResult()))


def _box_box(s1: Floats, s2: Floats, t: Floats) -> tuple[Any, Any, float]:
    gap = np.abs(t) - (s1 + s2) / 2
    return fcl.Box(*s1), fcl.Box(*s2), _beyond(gap)


def _cylinder_cylinder(s1: Floats, s2: Floats, t: Floats) -> tuple[Any, Any, float]:
    gap = np.array([np.hypot(t[0], t[1]) - (s1[0] + s2[0]) / 2, abs(t[2]) - (s1[2] + s2[2]) / 2])
    return fcl.Cylinder(s1[0] / 2, s1[2]), fcl.Cylinder(s2[0] / 2, s2[2]), _beyond(gap)


def _box_cylinder(s1: Floats, s2: Floats, t: Floats) -> tuple[Any, Any, float]:
    plane = _beyond(np.abs(t[:2]) - s1[:2] / 2)
    gap = np.array([plane - s2[0] / 2, abs(t[2]) - (s1[2] + s2[2]) / 2])
    return fcl.Box(*s1), fcl.Cylinder(s2[0] / 2, s2[2]), _beyond(gap)


def _box_sphere(s1: Floats, s2: Floats, t: Floats) -> tuple[Any, Any, float]:
    return fcl.Box(*s1), fcl.Sphere(s2[0] / 2), _beyond(np.abs(t) - s1 / 2) - s2[0] / 2


def _box_capsule(s1: Floats, s2: Floats, t: Floats) -> tuple[Any, Any, float]:
    half = s1 / 2 + np.array([0.0, 0.0, s2[2] / 2])
    return fcl.Box(*s1), fcl.Capsule(s2[0] / 2, s2[2]), _beyond(np.abs(t) - half) - s2[0] / 2


def _beyond(gap: Floats) -> float:
    """How far outside a cuboid-like product of intervals a point is: its distance, or minus its depth inside."""
    outside = float(np.linalg.norm(np.maximum(gap, 0.0)))
    return outside if outside > 0 else float(gap.max())


KINDS = {
    "box-box": _box_box,
    "cylinder-cylinder": _cylinder_cylinder,
    "box-cylinder": _box_cylinder,
    "box-sphere": _box_sphere,
    "box-capsule": _box_capsule,
}
Kind = Callable[[Floats, Floats, Floats], tuple[Any, Any, float]]


def _grid(seed: int) -> Any:
    """Sizes and offsets on a grid of 0.25 m with axes aligned, most offsets zero in some coordinate."""
    rng = np.random.default_rng(seed)
    for _ in range(PAIRS):
        sizes = rng.integers(1, 9, (2, 3)) * 0.25
        yield sizes[0], sizes[1], rng.integers(-8, 9, 3) * 0.25 * rng.integers(0, 2, 3)


@pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS)
def test_boolean_collide_is_right_on_grid_aligned_pairs(kind: Kind) -> None:
    asked = hits = 0
    for s1, s2, t in _grid(3):
        first, second, distance = kind(s1, s2, t)
        if abs(distance) > TOUCHING_M:
            asked += 1
            hits += distance < 0
            assert _collide(_posed(first), _posed(second, t)) == (distance < 0), (s1, s2, t, distance)
    assert asked > PAIRS / 2
    assert 0 < hits < asked


@pytest.mark.parametrize("overlap", [1e-6, -1e-6])
@pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS)
def test_boolean_collide_is_right_a_micrometre_from_touching(kind: Kind, overlap: float) -> None:
    asked = 0
    for s1, s2, t in _grid(5):
        first, second, distance = kind(s1, s2, t)
        if abs(distance) <= TOUCHING_M and t.any():
            # Touching: moved along its offset, each coordinate by the overlap, the pair is just in or just out.
            moved = t - overlap * np.sign(t)
            first, second, distance = kind(s1, s2, moved)
            if abs(distance) > 0.1e-6:
                asked += 1
                assert _collide(_posed(first), _posed(second, moved)) == (distance < 0), (s1, s2, t, distance)
    assert asked > 30


def test_distance_over_estimates_for_aligned_boxes_so_nothing_is_based_on_it() -> None:
    worst = 1.0
    for s1, s2, t in _grid(3):
        first, second, distance = _box_box(s1, s2, t)
        if distance > TOUCHING_M:
            request, result = fcl.DistanceRequest(True, False), fcl.DistanceResult()
            stated = fcl.distance(_posed(first), _posed(second, t), request, result)
            worst = max(worst, stated / distance)
    assert worst > 1.5 or mended_since("python-fcl", LAST_SEEN)


def test_a_pose_that_is_not_a_number_is_free_for_fcl_and_a_fault_for_us() -> None:
    nowhere = (np.nan, 0.0, 0.0)
    assert not _collide(_posed(fcl.Box(1, 1, 1)), _posed(fcl.Box(1, 1, 1), nowhere)) or mended_since(
        "python-fcl", LAST_SEEN
    )
    assert _touch((0.0, 0.0, 0.0), np.eye(3))
    for at, axes in (
        (nowhere, np.eye(3)),
        ((np.inf, 0.0, 0.0), np.eye(3)),
        ((0.0, 0.0, 0.0), np.full((3, 3), np.nan)),
    ):
        with pytest.raises(FaultError, match="pose"):
            _touch(at, axes)


def test_a_scaled_rotation_is_free_for_fcl_and_a_fault_for_us() -> None:
    # Two boxes of one metre that overlap by 0.3 m, whatever a factor of two might mean.
    far = (0.7, 0.0, 0.0)
    scaled = 2 * np.eye(3)
    still, moved = fcl.Box(1, 1, 1), _posed(fcl.Box(1, 1, 1), far)
    assert _collide(_posed(still), moved)
    assert not _collide(_posed(still, rotation=scaled), moved) or mended_since("python-fcl", LAST_SEEN)
    with pytest.raises(FaultError, match="pose"):
        _touch(far, scaled)
    with pytest.raises(InputError, match="orthonormal"):
        shapes.Piece(shapes.box(1, 1, 1), rotation=scaled)


def test_a_negative_size_is_free_for_fcl_and_bad_input_for_us() -> None:
    inside = _posed(fcl.Box(0.5, 0.5, 0.5))
    assert not _collide(_posed(fcl.Box(-1, 1, 1)), inside) or mended_since("python-fcl", LAST_SEEN)
    makers: list[Callable[[], shapes.Primitive]] = [
        lambda: shapes.box(-1.0, 1.0, 1.0),
        lambda: shapes.sphere(-1.0),
        lambda: shapes.cylinder(0.1, -1.0),
        lambda: shapes.capsule(float("nan"), 1.0),
    ]
    for make in makers:
        with pytest.raises(InputError):
            make()


def test_a_used_result_stays_colliding_so_ours_is_fresh_every_time() -> None:
    used = fcl.CollisionResult()
    here, far = _posed(fcl.Box(1, 1, 1)), _posed(fcl.Box(1, 1, 1), (9.0, 0.0, 0.0))
    fcl.collide(here, here, fcl.CollisionRequest(), used)
    assert fcl.collide(here, far, fcl.CollisionRequest(), used) == 0
    assert used.is_collision or mended_since("python-fcl", LAST_SEEN)
    collider = Collider()
    assert [_touch((x, 0.0, 0.0), np.eye(3), collider) for x in (0.5, 9.0, 0.5, 9.0)] == [True, False, True, False]


def test_a_body_inside_a_mesh_is_free_for_fcl_so_meshes_become_solid_hulls() -> None:
    corners, faces = _cube(2.0)
    hollow = fcl.BVHModel()
    hollow.beginModel(len(faces), len(corners))
    hollow.addSubModel(corners, faces)
    hollow.endModel()
    inside = _posed(fcl.Box(0.1, 0.1, 0.1))
    assert not _collide(_posed(hollow), inside) or mended_since("python-fcl", LAST_SEEN)
    assert _touch((0.0, 0.0, 0.0), np.eye(3), first=shapes.Hull(corners, faces), second=shapes.box(0.1, 0.1, 0.1))


def test_a_hull_of_ours_collides_as_the_box_that_it_is() -> None:
    rng = np.random.default_rng(7)
    corners, faces = _cube(0.5)
    hull, box = shapes.Hull(corners, faces), shapes.box(0.5, 0.5, 0.5)
    verdicts = []
    for _ in range(500):
        axes, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        axes *= np.sign(np.linalg.det(axes))
        at = tuple(rng.uniform(-0.6, 0.6, 3))
        verdicts.append([_touch(at, axes, first=first, second=shapes.cylinder(0.1, 0.4)) for first in (hull, box)])
    assert all(one == other for one, other in verdicts)
    assert 50 < sum(one for one, _ in verdicts) < 450


def test_a_face_that_points_nowhere_kills_the_process_so_ours_are_checked_before() -> None:
    program = (
        "import fcl, numpy as np\n"
        "corners = np.array([[x, y, z] for x in (-.5, .5) for y in (-.5, .5) for z in (-.5, .5)])\n"
        "convex = fcl.Convex(corners, 1, np.array([3, 0, 1, 10**6]))\n"
        "a, b = fcl.CollisionObject(convex), fcl.CollisionObject(fcl.Box(1, 1, 1))\n"
        "fcl.collide(a, b, fcl.CollisionRequest(), fcl.CollisionResult())\n"
    )
    died = subprocess.run([sys.executable, "-c", program], capture_output=True, check=False).returncode
    assert died < 0 or mended_since("python-fcl", LAST_SEEN)
    corners, faces = _cube(1.0)
    for index in (-1, 8, 10**6):
        spoilt = faces.copy()
        spoilt[3, 1] = index
        with pytest.raises(InputError, match="indices"):
            shapes.Hull(corners, spoilt)
    with pytest.raises(InputError, match="finite"):
        shapes.Hull(np.where(corners == corners.max(), np.nan, corners), faces)


def test_objects_leak_so_ours_are_made_once_per_shape_and_not_once_per_question() -> None:
    collider = Collider()
    first, second = shapes.box(1, 1, 1), shapes.sphere(0.5)
    for x in np.linspace(0.0, 3.0, 50):
        _touch((float(x), 0.0, 0.0), np.eye(3), collider, first, second)
    assert len(collider._objects) == 2


def _touch(
    at: tuple[float, ...],
    axes: Floats,
    collider: Collider | None = None,
    first: shapes.Primitive | shapes.Hull | None = None,
    second: shapes.Primitive | shapes.Hull | None = None,
) -> bool:
    """Asks our door about `first` at `at`, turned by `axes`, and `second` at the origin; boxes of one metre."""
    here = PlacedShape("first", first or shapes.box(1, 1, 1), np.array(at), axes)
    there = PlacedShape("second", second or shapes.box(1, 1, 1), np.zeros(3), np.eye(3))
    return (collider or Collider()).touch(here, there)


def _cube(edge: float) -> tuple[Floats, NDArray[np.int64]]:
    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]) * edge
    sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return corners, np.array([[side[0], side[k], side[k + 1]] for side in sides for k in (1, 2)])
