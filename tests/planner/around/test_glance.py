"""Looking at many ways at once: what it sees is what Ruckig and screening find, and what it missed it looks at next."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from assur.planner.arrays import BoolArray
from assur.planner.collision.proof import Prover
from assur.planner.frames import Frame, Linear
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import box
from assur.planner.legs.meeting import Meetings
from assur.planner.model.scene import Scene
from assur.planner.search.meeting_options import Option, options
from assur.planner.search.partial_plan import initial, prepared
from assur.planner.search.population import NEARLY_FREE, Population
from assur.planner.search.rough_motion import RoughMotions
from assur.planner.search.rough_score import APART_S, REMEMBERED, Glance
from assur.planner.search.via_batch import MOST_VIAS, Freedom, Prospects, together
from assur.planner.timing.trapezoids import Trapezoids
from tests.planner.cells import Around, arm, belt_and_dial, cell, go, solid, stands
from tests.planner.test_search import narrow


def asked(scene: Scene) -> tuple[Prover, tuple[Option, ...], Population]:
    """The prover, the options of the first step and the population of its ways."""
    chain, prover = initial(scene), Prover(scene)
    meeting = prepared(scene, chain, 0.0, None, (0, 1))
    assert isinstance(meeting, Meetings)
    found = options(scene, chain, [(0.0, meeting)], 12)
    rng = np.random.default_rng(1)
    return prover, found, Population(scene, chain, found, Glance(prover, chain, found), rng, adaptive=True)


def drawn(population: Population, count: int, seed: int = 0) -> Prospects:
    return population.freedom.drawn(np.random.default_rng(seed), count, population.shares)


def walled() -> Scene:
    """A wall moves across the direct way, and a shelf stands beside it."""
    frames = (Frame("wall", Linear(Pose(0.45, -0.3, 0.08), (0.0, 0.4, 0.0))),)
    bodies = (
        Around(solid("wall", box(0.3, 0.02, 0.16)), "wall", Pose()),
        stands("shelf", box(0.2, 0.2, 0.02), 0.3, -0.38, 0.16),
    )
    return cell(go(0.33, 0.25, 0.1), bodies=bodies, frames=frames, q=(-0.9, 0.6, 0.2, 0.0))


def test_rough_motions_begin_at_the_start_wait_as_told_pass_their_vias_and_end_at_the_goal() -> None:
    scene = walled()
    _, found, population = asked(scene)
    chain, ways = initial(scene), drawn(population, 60)
    rough = RoughMotions(scene.robot, chain, found)(ways)
    start = np.broadcast_to(chain.state.q, (60, 4))
    np.testing.assert_allclose(rough.at(np.full((60, 1), chain.state.time))[:, 0], start, atol=1e-12)
    np.testing.assert_allclose(rough.at((chain.state.time + ways.wait)[:, None])[:, 0], start, atol=1e-12)
    goals = np.array([found[k].branch.q[0] for k in ways.option])
    met = rough.segments.meets().all((1, 2))
    assert met.mean() > 0.9
    np.testing.assert_allclose(rough.at(rough.end[:, None])[met, 0], goals[met], atol=1e-6)
    assert {0, 1, 2} == set(ways.count.tolist())
    for i in range(60):
        for k in range(int(ways.count[i])):
            segment = MOST_VIAS - int(ways.count[i]) + k
            when = rough.begin[i] + rough.segments.duration[i, : segment + 1].sum()
            there = rough.some(np.array([i])).at(np.array([[when]]))[0, 0]
            np.testing.assert_allclose(there, ways.via[i, k], atol=1e-6)
    assert (rough.segments.duration[ways.count == 0][:, :-1] == 0).all()


def test_a_point_that_moves_is_met_where_it_is_at_the_end_of_the_way() -> None:
    scene = belt_and_dial(go(0.35, 0.0, 0.12))
    _, found, population = asked(scene)
    ways = drawn(population, 80)
    rough = RoughMotions(scene.robot, initial(scene), found)(ways)
    meets = np.isfinite(rough.end)
    assert meets.any()
    for i in np.flatnonzero(meets):
        branch = found[int(ways.option[i])].branch
        if branch.still:
            continue
        row = int(np.argmin(np.abs(branch.time - rough.end[i])))
        assert branch.time[row] == pytest.approx(rough.end[i], abs=0.01)
        assert branch.legal[row]
        off = np.abs(rough.at(rough.end[:, None])[i, 0] - branch.q[row])
        assert (off <= 0.03 * np.abs(branch.qd[row]) + 1e-6).all()


def test_a_way_that_turns_round_beyond_a_limit_cannot_be() -> None:
    scene = narrow()
    _, found, population = asked(scene)
    ways = drawn(population, 1)
    upper = scene.robot.limits.upper
    via = np.broadcast_to((initial(scene).state.q + found[0].branch.q[0]) / 2, ways.via.shape).copy()
    via[..., 2] = upper[2]
    one = np.zeros(1, dtype=np.int64)
    inside = replace(ways, option=one, count=one + 1, via=via, pace=np.zeros((1, MOST_VIAS)))
    motions = RoughMotions(scene.robot, initial(scene), found)
    assert motions(inside).possible(scene.robot).all()
    motion = motions(inside)
    v1 = motion.segments.v1.copy()
    v1[:, -2, 2] = 0.5  # upwards, at the top
    v0 = motion.segments.v0.copy()
    v0[:, -1] = v1[:, -2]
    parts = (motion.segments.q0, v0, motion.segments.q1, v1)
    over = replace(motion, segments=Trapezoids.of(*parts, motion.segments.acceleration, motion.segments.duration + 1.0))
    assert over.segments.meets().all()
    assert not over.possible(scene.robot).any()


def test_a_time_at_which_something_was_missed_is_looked_at_from_then_on() -> None:
    """A body that comes by for 10 ms is nearly always missed by the looks of one way, and never once its time is
    known."""
    q = (-0.9, 0.6, 0.2, 0.0)
    tool, _ = arm().forward(np.array(q))
    law = Linear(Pose(float(tool[0]), float(tool[1]) - 12.0, 0.2), (0.0, 20.0, 0.0))
    bodies = (Around(solid("bullet", box(0.05, 0.05, 0.05)), "bullet", Pose()),)
    scene = cell(go(0.33, 0.25, 0.1), bodies=bodies, frames=(Frame("bullet", law),), q=q)
    _, _, population = asked(scene)
    ways = drawn(population, 100)
    waiting = replace(ways, wait=np.full(100, 1.0))
    glance, rng = population.glance, np.random.default_rng(0)
    before, _ = glance(waiting, rng)
    glance.remember(0.6)
    after, _ = glance(waiting, rng)
    possible = before < 1.0
    assert possible.sum() > 50
    assert (before[possible] == 0).mean() > 0.05
    assert (after[possible] > 0).all()


def test_few_times_are_remembered_the_latest_and_none_twice() -> None:
    _, _, population = asked(narrow())
    for k in range(REMEMBERED + 3):
        population.glance.remember(0.1 * k)
        population.glance.remember(0.1 * k + APART_S / 2)
    assert population.glance.times == pytest.approx([0.1 * k for k in range(3, REMEMBERED + 3)])


def test_a_population_tries_nothing_twice_and_nothing_that_ends_too_late() -> None:
    scene = narrow()
    _, _, population = asked(scene)
    seen: list[str] = []
    ends = []
    for _ in range(6):
        for _, sample in population.batch(np.inf):
            seen.append(repr(([(via.q.tolist(), via.pace) for via in sample.shape.vias], sample.branch.q.tolist())))
            ends.append(population.end[population.number[id(sample)]])
    assert len(set(seen)) == len(seen) > 15
    early = float(np.median(ends))
    for _ in range(4):
        assert all(population.end[population.number[id(sample)]] < early for _, sample in population.batch(early))


def test_what_was_refused_counts_as_screening_says_and_its_time_is_remembered_if_it_seemed_free() -> None:
    _, _, population = asked(narrow())
    batch = population.batch(np.inf)
    (_, first), (_, last) = batch[0], batch[-1]
    i = population.number[id(first)]
    assert population.bad[i] <= NEARLY_FREE
    population.learn(first, 0.4, 0.123)
    assert population.bad[i] == 0.4
    assert population.glance.times == [0.123]
    population.learn(first, 0.4, 0.3)  # known to be bad by now
    assert population.glance.times == [0.123]
    j = population.number[id(last)]
    population.learn(last, 1.0, None)
    assert population.bad[j] == 1.0


def free_of(scene: Scene) -> Freedom:
    return asked(scene)[2].freedom


def test_vias_are_within_limits_and_the_wrist_only_turns_with_the_way() -> None:
    scene = narrow()
    freedom = free_of(scene)
    ways = freedom.drawn(np.random.default_rng(2), 400, np.array([0.0, 1.0, 1.0]))
    for some in (ways, freedom.varied(np.random.default_rng(3), ways)):
        assert scene.robot.within(some.via).all()
        assert set(some.count.tolist()) == {1, 2}
        assert (some.wait == 0).all()  # nothing moves: waiting changes nothing
        start, goal = freedom.start[3], freedom.goals[some.option, 3]
        low, high = np.minimum(start, goal)[:, None], np.maximum(start, goal)[:, None]
        assert ((some.via[..., 3] >= low - 1e-12) & (some.via[..., 3] <= high + 1e-12)).all()


def test_a_direct_way_is_drawn_only_with_a_wait() -> None:
    freedom = free_of(walled())
    ways = freedom.drawn(np.random.default_rng(2), 400, np.array([1.0, 1.0, 1.0]))
    direct: BoolArray = ways.count == 0
    assert direct.any()
    assert (ways.wait[direct] > 0).all()


def test_some_of_a_few_together_are_those() -> None:
    freedom = free_of(walled())
    ways = freedom.drawn(np.random.default_rng(2), 9, np.array([1.0, 1.0, 1.0]))
    again = together([ways.some(slice(0, 4)), ways.some(np.arange(4, 9))])
    for field in fields(Prospects):
        assert np.array_equal(getattr(ways, field.name), getattr(again, field.name))
