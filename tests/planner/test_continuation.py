"""Continuations of a partial plan: what is kept with it is what would be made anew; a timed candidate and its extension
go the same way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from assur.planner.legs.control_point import control_point
from assur.planner.legs.joint import Shape, Via
from assur.planner.legs.meeting import Meetings
from assur.planner.legs.missed import ArchForm
from assur.planner.model.attachments import AT_START, Attachments
from assur.planner.model.scene import Scene
from assur.planner.search.extension import extended, straight_extension, timed
from assur.planner.search.partial_plan import (
    Candidate,
    Extension,
    Option,
    PartialPlan,
    TimedCandidate,
    initial,
    prepared,
    scaled_limits,
)
from tests.planner.cells import cell, go, table_to_table
from tests.planner.second_solids import standing


def met(scene: Scene, partial: PartialPlan) -> Meetings:
    found = prepared(scene, partial, 0.0, None, (partial.mode,))[-1]
    assert isinstance(found, Meetings)
    return found


def line(scene: Scene, partial: PartialPlan, branch: int, wait: float = 0.0) -> Extension:
    meeting = met(scene, partial)
    sample = Candidate(Option(meeting, meeting.branches[branch]), Shape(wait=wait))
    made = straight_extension(scene, partial, sample)
    assert isinstance(made, Extension), made
    return made


def test_full_turns_of_a_meeting_share_one_straight_leg_and_a_wait_has_its_own() -> None:
    scene = cell(go(0.35, -0.2, leg="cartesian"), elbow="keep")
    partial = initial(scene)
    assert len(met(scene, partial).branches) > 1
    first, second, later = line(scene, partial, 0), line(scene, partial, 1), line(scene, partial, 0, wait=0.5)
    assert len(partial.lines) == 2
    assert np.array_equal(first.trajectory.q, second.trajectory.q)
    anew = line(scene, initial(scene), 1)
    assert all(
        np.array_equal(getattr(first.trajectory, x), getattr(anew.trajectory, x)) for x in ("time", "q", "qd", "qdd")
    )
    assert later.end == pytest.approx(first.end + 0.5, abs=1e-9)


SHAPES = {
    "direct": Shape(),
    "via": Shape(vias=(Via([0.1, 0.9, 0.22, 0.4], 0.8),)),
    "two vias after a wait": Shape(wait=0.2, vias=(Via([0.1, 0.9, 0.22, 0.4], 0.8), Via([0.0, 1.2, 0.2, 0.0], 0.0))),
    "arch": Shape(form=ArchForm(0.24, 0.3, 0.6)),
    "half the effort": Shape(effort=0.5),
}


@pytest.mark.parametrize("name", sorted(SHAPES))
def test_a_timed_candidate_is_where_its_extension_is_to_ten_micrometres_at_times_in_any_order(name: str) -> None:
    scene = cell(go(0.35, -0.2))
    partial, shape = initial(scene), SHAPES[name]
    meeting = met(scene, partial)
    way = timed(scene, partial, Candidate(Option(meeting, meeting.branches[0]), shape), None)
    assert isinstance(way, TimedCandidate), way
    extension = extended(scene, way)
    assert isinstance(extension, Extension), extension
    t = np.random.default_rng(1).permutation(np.linspace(-0.1, way.end + 0.1, 200))
    before = standing(way.trajectory, t)
    assert np.abs(before - standing(extension.trajectory, t)).max() <= 1e-5
    anew = timed(scene, initial(scene), Candidate(Option(meeting, meeting.branches[0]), shape), None)
    assert isinstance(anew, TimedCandidate)
    assert np.array_equal(standing(anew.trajectory, t), before)


def test_each_effort_has_one_pace_with_its_own_limits() -> None:
    scene = cell(go(0.35, -0.2))
    partial = initial(scene)
    point = control_point(scene, 0, AT_START, 0.0)
    whole, half = (scaled_limits(scene, partial, shape, point) for shape in (Shape(), Shape(effort=0.25)))
    assert scaled_limits(scene, partial, Shape(), point) is whole
    limits = scene.robot.limits
    for mine, own, power in zip(half.rates, whole.rates, (0.5, 1.0, 1.5), strict=True):
        assert mine == pytest.approx([0.25**power * x for x in own], rel=1e-12)
    assert whole.rates == (limits.velocity.tolist(), limits.acceleration.tolist(), limits.jerk.tolist())


def test_a_way_after_a_place_says_where_the_part_rides_now_and_one_before_does_not() -> None:
    scene = table_to_table(go(0.3, 0.0))
    partial = initial(scene)
    part, target = scene.task[1].part, scene.task[1].target
    assert part is not None
    assert target is not None
    moved = ((part, target.frame, target.pose),)
    behind = replace(partial, step=2, attached=Attachments(None, moved))
    for at, expected in ((replace(partial, step=2), ()), (behind, moved)):
        meeting = met(scene, at)
        way = timed(scene, at, Candidate(Option(meeting, meeting.branches[0]), Shape()), None)
        assert isinstance(way, TimedCandidate), way
        assert way.phases[0].attached.placed == expected
