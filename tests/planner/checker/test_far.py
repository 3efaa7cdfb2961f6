"""Rows of one body alone: what they say is true, pairs that they part need no others, and forged ones are refused."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from assur.planner.arrays import BoolArray
from assur.planner.checked import check
from assur.planner.checker import Code
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import box, cylinder
from assur.planner.laws import fixed, linear
from assur.planner.model.outcome import Plan, Planned
from assur.planner.model.scene import Clearance, Scene, WorldBody
from assur.planner.pipeline import plan
from tests.planner.cells import CUP, arm, cell, frame, go, stands
from tests.planner.checker.hand_made import carton, with_rows, without

FAR_M = 1.3
"""From the shoulder to the ring of posts: out of reach of the arm, which is 0.6 m long."""


@cache
def ring() -> tuple[Scene, Plan]:
    """An arm with a cup among three posts and a carton in reach, in a ring of sixty that are not."""
    angles = np.linspace(0.0, 2 * np.pi, 60, endpoint=False)
    posts = [
        stands(f"post-{i}", cylinder(0.03, 0.5), FAR_M * np.cos(x), FAR_M * np.sin(x), 0.25)
        for i, x in enumerate(angles)
    ]
    near = [
        stands(f"stub-{i}", box(0.05, 0.05, 0.04), x, y, 0.02) for i, (x, y) in enumerate([(0.3, 0.3), (0.4, -0.3)])
    ]
    scene = cell(
        go(0.35, -0.25, 0.15, leg="joint"),
        bodies=(*posts, *near, WorldBody(carton(), "world", Pose(0.45, 0.1, 0.03))),
        robot=arm(column=0.05),
        tool=CUP,
        stay_safe_s=0.3,
    )
    outcome = plan(scene)
    assert isinstance(outcome, Planned)
    return scene, outcome.plan


def alone(made: Plan) -> BoolArray:
    return np.asarray(made.certificate.second == -1)


def codes(scene: Scene, made: Plan) -> set[Code]:
    return {finding.code for finding in check(scene, made).findings}


def test_a_few_rows_of_bodies_alone_do_for_a_ring_of_sixty_posts() -> None:
    scene, made = ring()
    c = made.certificate
    assert check(scene, made).findings == ()
    assert alone(made).any()
    assert not any(name.startswith("post") for name in c.names)
    assert len(c) < 200  # for the posts alone there would be 600: 2 phases, 5 bodies, 60 posts
    assert set(c.second_piece[alone(made)]) == {-1}


def of_one_body(made: Plan) -> list[BoolArray]:
    """Which rows are of a body alone, body by body: of its planes one may do for what another was made for."""
    c = made.certificate
    return [alone(made) & (c.first == body) for body in np.unique(c.first[alone(made)])]


def test_without_those_of_any_one_body_a_pair_is_not_covered() -> None:
    scene, made = ring()
    for rows in of_one_body(made):
        assert codes(scene, without(scene, made, rows)) == {Code.COVER}


def test_a_normal_of_a_body_alone_is_a_unit_vector() -> None:
    scene, made = ring()
    for row in np.flatnonzero(alone(made)):
        normal = made.certificate.normal.copy()
        normal[row] *= 1.001
        assert codes(scene, with_rows(scene, made, normal=normal)) == {Code.ROW}


def test_planes_that_look_elsewhere_part_less() -> None:
    """Turned round they are true rows still; but what was before such a plane is not before that one."""
    scene, made = ring()
    for rows in of_one_body(made):
        normal = np.where(rows[:, None], [0.0, 0.0, 1.0], made.certificate.normal)
        assert codes(scene, with_rows(scene, made, normal=normal)) == {Code.COVER}


def test_rows_that_leave_out_an_ulp_of_time_count_for_nothing() -> None:
    scene, made = ring()
    c = made.certificate
    for rows in of_one_body(made):
        for name, towards in (("t0", np.inf), ("t1", -np.inf)):
            times = getattr(c, name)
            times = np.where(rows & (c.t1 > c.t0), np.nextafter(times, towards), times)
            assert Code.COVER in codes(scene, with_rows(scene, made, **{name: times}))


def test_a_body_that_stands_before_no_plane_is_not_covered() -> None:
    """The same plan in a cell where a post of the ring stands where the arm comes: nothing is said about it."""
    scene, made = ring()
    for index, x, y in ((0, 0.25, 0.0), (20, 0.35, -0.25)):
        bodies = list(scene.bodies)
        bodies[index] = replace(bodies[index], pose=Pose(x, y, 0.25))
        wrong = replace(scene, bodies=tuple(bodies))
        assert Code.COVER in codes(wrong, with_rows(wrong, made))


def test_a_body_on_a_frame_that_moves_or_is_not_known_throughout_needs_rows_of_its_own() -> None:
    scene, made = ring()
    end = made.trajectory.end
    crawls, ends = linear(Pose(), (1e-9, 0.0, 0.0)), fixed(Pose(), (0.0, end + 0.1))
    for law, found in ((fixed(Pose()), set()), (crawls, {Code.COVER}), (ends, {Code.LAW})):
        bodies = (replace(scene.bodies[0], frame="other"), *scene.bodies[1:])
        asked = replace(scene, frames={**scene.frames, "other": frame("other", law)}, bodies=bodies)
        assert codes(asked, with_rows(asked, made)) == found


def test_planes_keep_the_distance_that_is_asked() -> None:
    """The ring is a hand's breadth too near for a clearance of 0.9 m."""
    scene, made = ring()
    wide = replace(scene, options=replace(scene.options, clearance=Clearance(0.9, 0.9)))
    assert codes(wide, with_rows(wide, made)) & {Code.COVER, Code.ROW}


def test_a_row_alone_is_of_a_whole_body_and_names_no_second_piece() -> None:
    scene, made = ring()
    c, row = made.certificate, int(np.flatnonzero(alone(made))[0])
    for column, value in (("second_piece", 0), ("second", -2), ("first", -1), ("first_piece", 3), ("first_piece", -2)):
        values = getattr(c, column).copy()
        values[row] = value
        found = codes(scene, with_rows(scene, made, **{column: values}))
        assert found
        assert found <= {Code.FORM, Code.ROW, Code.COVER}


def test_a_row_alone_of_something_around_the_arm_is_true_and_of_no_use() -> None:
    """What the arm stays behind counts, not what something else is behind."""
    scene, made = ring()
    c, row = made.certificate, int(np.flatnonzero(alone(made))[0])
    first = c.first.copy()
    first[row] = len(c.names)
    assert codes(scene, with_rows(scene, made, names=(*c.names, "stub-0"), first=first)) == {Code.COVER}
