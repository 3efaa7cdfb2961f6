"""Ways from a chain: what is kept with it is what would be made anew, and an outline goes where its draft goes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from assur.planner.legs.arched import Hop
from assur.planner.legs.joint import Shape, Via
from assur.planner.legs.meeting import Meetings
from assur.planner.model.attachments import Attachments
from assur.planner.model.scene import Scene
from assur.planner.search.extension import finished, outline, straight_draft
from assur.planner.search.partial_plan import Chain, Draft, Outline, Sample, initial, paced, prepared
from tests.planner.cells import cell, go, table_to_table


def met(scene: Scene, chain: Chain) -> Meetings:
    found = prepared(scene, chain, 0.0, None, (chain.mode,))
    assert isinstance(found, Meetings)
    return found


def line(scene: Scene, chain: Chain, branch: int, wait: float = 0.0) -> Draft:
    meeting = met(scene, chain)
    sample = Sample(0.0, meeting.branches[branch], Shape(wait=wait))
    made = straight_draft(scene, chain, meeting, sample)
    assert isinstance(made, Draft), made
    return made


def test_full_turns_of_a_meeting_share_one_straight_leg_and_a_wait_has_its_own() -> None:
    scene = cell(go(0.35, -0.2, leg="cartesian"), elbow="keep")
    chain = initial(scene)
    assert len(met(scene, chain).branches) > 1
    first, second, later = line(scene, chain, 0), line(scene, chain, 1), line(scene, chain, 0, wait=0.5)
    assert len(chain.lines) == 2
    assert np.array_equal(first.knots.q, second.knots.q)
    anew = line(scene, initial(scene), 1)
    assert all(np.array_equal(getattr(first.knots, x), getattr(anew.knots, x)) for x in ("time", "q", "qd", "qdd"))
    assert later.end == pytest.approx(first.end + 0.5, abs=1e-9)


SHAPES = {
    "direct": Shape(),
    "via": Shape(vias=(Via(np.array([0.1, 0.9, 0.22, 0.4]), 0.8),)),
    "two vias after a wait": Shape(
        wait=0.2, vias=(Via(np.array([0.1, 0.9, 0.22, 0.4]), 0.8), Via(np.array([0.0, 1.2, 0.2, 0.0]), 0.0))
    ),
    "arch": Shape(hop=Hop(0.24, 0.3, 0.6)),
    "half the effort": Shape(effort=0.5),
}


@pytest.mark.parametrize("name", sorted(SHAPES))
def test_an_outline_is_where_its_draft_is_to_ten_micrometres_at_times_in_any_order(name: str) -> None:
    scene = cell(go(0.35, -0.2))
    chain, shape = initial(scene), SHAPES[name]
    meeting = met(scene, chain)
    way = outline(scene, chain, meeting, Sample(0.0, meeting.branches[0], shape), None)
    assert isinstance(way, Outline), way
    draft = finished(scene, way)
    assert isinstance(draft, Draft), draft
    t = np.random.default_rng(1).permutation(np.linspace(-0.1, way.end + 0.1, 200))
    assert np.abs(way.at(t) - draft.at(t)).max() <= 1e-5
    # asked for one by one, all together, or after others were made: the same
    assert np.array_equal(way.at(t), np.concatenate([way.at(t[k : k + 1]) for k in range(len(t))]))
    before = way.at(t)
    outline(scene, chain, meeting, Sample(0.0, meeting.branches[0], Shape()), None)
    assert np.array_equal(way.at(t), before)
    anew = outline(scene, initial(scene), meeting, Sample(0.0, meeting.branches[0], shape), None)
    assert isinstance(anew, Outline)
    assert np.array_equal(anew.at(t), before)


def test_each_effort_has_one_pace_with_its_own_limits() -> None:
    scene = cell(go(0.35, -0.2))
    chain = initial(scene)
    whole, half = paced(scene, chain, 1.0), paced(scene, chain, 0.25)
    assert paced(scene, chain, 1.0) is whole
    limits = scene.robot.limits
    for mine, own, power in zip(half.rates, whole.rates, (0.5, 1.0, 1.5), strict=True):
        assert mine == pytest.approx([0.25**power * x for x in own], rel=1e-12)
    assert whole.rates == (limits.velocity.tolist(), limits.acceleration.tolist(), limits.jerk.tolist())


def test_a_way_after_a_place_says_where_the_part_rides_now_and_one_before_does_not() -> None:
    scene = table_to_table(go(0.3, 0.0))
    chain = initial(scene)
    part, target = scene.task[1].part, scene.task[1].target
    assert part is not None
    assert target is not None
    moved = ((part, target.frame, target.pose),)
    behind = replace(chain, step=2, attached=Attachments(None, moved))
    for at, expected in ((replace(chain, step=2), ()), (behind, moved)):
        meeting = met(scene, at)
        way = outline(scene, at, meeting, Sample(0.0, meeting.branches[0], Shape()), None)
        assert isinstance(way, Outline), way
        assert way.phases[0].attached.placed == expected
