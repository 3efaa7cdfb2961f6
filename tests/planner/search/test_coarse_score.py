"""The coarse score of many candidates: rough motions meet their ends, and what the score missed it evaluates next."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.collision.proof import Prover
from assur.planner.collision.screening import screen
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import box
from assur.planner.kernels.candidates import (
    BEGIN,
    DURATIONS,
    EFFORT,
    END,
    FIRST_VIA,
    LATE,
    MOST_VIAS,
    OPTION,
    PACES,
    VIAS,
    WAIT,
)
from assur.planner.laws import Frame, linear
from assur.planner.legs.joint import Shape
from assur.planner.legs.meeting import Meetings
from assur.planner.legs.missed import ArchForm
from assur.planner.model.scene import Scene
from assur.planner.search.beam import Search
from assur.planner.search.candidates import Population
from assur.planner.search.extension import timed
from assur.planner.search.meeting_options import options
from assur.planner.search.partial_plan import Candidate, Option, TimedCandidate, initial, prepared
from assur.planner.search.rough_score import CoarseScore, RoughMotions
from assur.planner.search.tuning import APART_S, FREE, LATER, NEARLY_FREE, REMEMBERED
from assur.planner.search.via_batch import Freedom, shape_of
from tests.planner.cells import Around, arm, belt_and_dial, cell, go, solid, stands
from tests.planner.search.test_search import narrow


def asked(scene: Scene) -> tuple[Prover, tuple[Option, ...], Population]:
    """The prover, the options of the first step and the population of its ways."""
    chain, prover = initial(scene), Prover(scene)
    meeting = prepared(scene, chain, 0.0, None, (0, 1))[-1]
    assert isinstance(meeting, Meetings)
    found = options(scene, chain, [meeting])
    rng = np.random.default_rng(1)
    return prover, found, Population(scene, chain, found, CoarseScore(prover, chain, found), rng)


def drawn(population: Population, count: int, seed: int = 0) -> FloatArray:
    return population.freedom.drawn(np.random.default_rng(seed), count, population.shares)


def walled() -> Scene:
    """A wall moves across the direct way, and a shelf stands beside it."""
    frames = (Frame("wall", linear(Pose(0.45, -0.3, 0.08), (0.0, 0.4, 0.0))),)
    bodies = (
        Around(solid("wall", box(0.3, 0.02, 0.16)), "wall", Pose()),
        stands("shelf", box(0.2, 0.2, 0.02), 0.3, -0.38, 0.16),
    )
    return cell(go(0.33, 0.25, 0.1), bodies=bodies, frames=frames, q=(-0.9, 0.6, 0.2, 0.0))


def every(rows: FloatArray) -> IntArray:
    return np.arange(len(rows))


def test_rough_motions_begin_at_the_start_wait_as_told_pass_their_vias_and_end_at_the_goal() -> None:
    scene = walled()
    _, found, population = asked(scene)
    chain, rows = initial(scene), drawn(population, 60)
    motions = RoughMotions(scene.robot.limits, chain, found)
    rough = motions(rows)
    start = np.broadcast_to(chain.state.q, (60, 4))
    for t in (np.full((60, 1), chain.state.time), (chain.state.time + rows[:, WAIT])[:, None]):
        np.testing.assert_allclose(motions.at(rough, every(rows), t)[:, 0], start, atol=1e-12)
    goals = np.array([found[int(k)].branch.q[0] for k in rows[:, OPTION]])
    met = np.isfinite(rough[:, END])
    assert met.mean() > 0.5
    which = np.flatnonzero(met)
    np.testing.assert_allclose(motions.at(rough, which, rough[which, END, None])[:, 0], goals[which], atol=1e-6)
    assert set(rows[:, VIAS]) == {0, 1, 2}
    for i in which:
        vias = rows[i, FIRST_VIA:].reshape(MOST_VIAS, -1)
        for k in range(int(rows[i, VIAS])):
            when = rough[i, BEGIN] + rough[i, DURATIONS : DURATIONS + k + 1].sum()
            there = motions.at(rough, np.array([i]), np.array([[when]]))[0, 0]
            np.testing.assert_allclose(there, vias[k], atol=1e-6)


def test_a_point_that_moves_is_met_where_it_is_at_the_end_of_the_motion() -> None:
    scene = belt_and_dial(go(0.35, 0.0, 0.12))
    _, found, population = asked(scene)
    rows = drawn(population, 80)
    motions = RoughMotions(scene.robot.limits, initial(scene), found)
    rough = motions(rows)
    meets = np.flatnonzero(np.isfinite(rough[:, END]))
    assert len(meets)
    for i in meets:
        branch = found[int(rows[i, OPTION])].branch
        if branch.still:
            continue
        row = int(np.argmin(np.abs(branch.time - rough[i, END])))
        assert branch.time[row] == pytest.approx(rough[i, END], abs=0.01)
        off = np.abs(motions.at(rough, np.array([i]), rough[i : i + 1, END, None])[0, 0] - branch.q[row])
        assert (off <= 0.05 * np.abs(branch.qd[row]) + 2e-3).all()


def test_a_later_candidate_reaches_a_moving_point_later() -> None:
    scene = belt_and_dial(go(0.35, 0.0, 0.12))
    _, found, population = asked(scene)
    rows = drawn(population, 40)
    rows[:, LATE] = 0.0
    later = rows.copy()
    later[:, LATE] = 0.2
    motions = RoughMotions(scene.robot.limits, initial(scene), found)
    first, second = motions(rows)[:, END], motions(later)[:, END]
    both = np.isfinite(first) & np.isfinite(second)
    assert both.any()
    assert (second[both] >= first[both] + 0.05).all()


def test_a_motion_that_turns_round_beyond_a_limit_is_not_possible() -> None:
    scene = narrow()
    _, found, population = asked(scene)
    chain, row = initial(scene), population.freedom.direct()[:1]
    middle = (chain.state.q + found[0].branch.q[0]) / 2
    row[0, VIAS], row[0, PACES] = 1, 0.0
    row[0, FIRST_VIA : FIRST_VIA + 4] = middle
    motions = RoughMotions(scene.robot.limits, chain, found)
    assert np.isfinite(motions(row)[:, END]).all()
    upper = scene.robot.limits.upper[2]
    row[0, FIRST_VIA + 2] = upper
    assert np.isfinite(motions(row)[:, END]).all()
    # set out upwards from just below the top: the lift comes to rest only beyond it
    state = replace(chain.state, q=np.append(chain.state.q[:2], [upper - 1e-4, 0.0]), qd=np.array([0.0, 0.0, 0.5, 0.0]))
    over = RoughMotions(scene.robot.limits, replace(chain, state=state), found)
    assert not np.isfinite(over(row)[:, END]).any()


def test_a_time_at_which_something_was_missed_is_looked_at_from_then_on() -> None:
    """A body that comes by for 10 ms is nearly always missed by the looks of one way, and never once its time is
    known."""
    q = (-0.9, 0.6, 0.2, 0.0)
    tool, _ = arm().forward(np.array(q))
    law = linear(Pose(float(tool[0]), float(tool[1]) - 12.0, 0.2), (0.0, 20.0, 0.0))
    bodies = (Around(solid("bullet", box(0.05, 0.05, 0.05)), "bullet", Pose()),)
    scene = cell(go(0.33, 0.25, 0.1), bodies=bodies, frames=(Frame("bullet", law),), q=q)
    _, _, population = asked(scene)
    ways = drawn(population, 100)
    ways[:, WAIT] = 1.0
    score, rng = population.score, np.random.default_rng(0)
    before, _ = score(ways, rng)
    score.remember(0.6)
    after, _ = score(ways, rng)
    possible = before < 1.0
    assert possible.sum() > 50
    assert (before[possible] == 0).mean() > 0.05
    assert (after[possible] > 0).all()


def test_few_times_are_remembered_the_latest_and_none_twice() -> None:
    _, _, population = asked(narrow())
    for k in range(REMEMBERED + 3):
        population.score.remember(0.1 * k)
        population.score.remember(0.1 * k + APART_S / 2)
    assert population.score.times == pytest.approx([0.1 * k for k in range(3, REMEMBERED + 3)])


def test_a_population_tries_nothing_twice_and_nothing_that_ends_too_late() -> None:
    scene = narrow()
    _, _, population = asked(scene)
    seen: list[str] = []
    ends = []
    for _ in range(6):
        for sample in population.batch(np.inf):
            seen.append(repr(([(via.q, via.pace) for via in sample.shape.vias], sample.branch.q.tolist())))
            ends.append(population.end[population.number[sample]])
    assert len(set(seen)) == len(seen) > 15
    early = float(np.median(ends))
    for _ in range(4):
        assert all(population.end[population.number[sample]] < early for sample in population.batch(early))


def test_what_was_refused_counts_as_screening_says_and_its_time_is_remembered_if_it_seemed_free() -> None:
    _, _, population = asked(narrow())
    batch = population.batch(np.inf)
    first, last = batch[0], batch[-1]
    i = population.number[first]
    assert population.bad[i] <= NEARLY_FREE
    population.learn(first, 0.4, 0.123)
    assert population.bad[i] == 0.4
    assert population.score.times == [0.123]
    population.learn(first, 0.4, 0.3)  # known to be bad by now
    assert population.score.times == [0.123]
    j = population.number[last]
    population.learn(last, 1.0, None)
    assert population.bad[j] == 1.0


def free_of(scene: Scene) -> Freedom:
    return asked(scene)[2].freedom


def test_vias_are_within_limits_and_the_wrist_only_turns_with_the_motion() -> None:
    scene = narrow()
    freedom = free_of(scene)
    rows = freedom.drawn(np.random.default_rng(2), 400, np.array([0.0, 1.0, 1.0]))
    for some in (rows, freedom.varied(np.random.default_rng(3), rows)):
        via = some[:, FIRST_VIA:].reshape(400, MOST_VIAS, 4)
        assert scene.robot.within(via).all()
        assert set(some[:, VIAS]) == {1, 2}
        assert (some[:, WAIT] == 0).all()  # nothing moves: waiting changes nothing
        start, goal = freedom.start[3], freedom.goals[some[:, OPTION].astype(int), 3]
        low, high = np.minimum(start, goal)[:, None], np.maximum(start, goal)[:, None]
        assert ((via[..., 3] >= low - 1e-12) & (via[..., 3] <= high + 1e-12)).all()


def test_a_direct_candidate_is_drawn_only_with_a_wait() -> None:
    rows = free_of(walled()).drawn(np.random.default_rng(2), 400, np.array([1.0, 1.0, 1.0]))
    direct = rows[:, VIAS] == 0
    assert direct.any()
    assert (rows[direct, WAIT] > 0).all()


def test_a_row_is_timed_as_the_shape_that_it_describes() -> None:
    row = free_of(walled()).drawn(np.random.default_rng(2), 1, np.array([0.0, 0.0, 1.0]))[0]
    shape = shape_of(row)
    assert (shape.wait, shape.late, shape.effort, len(shape.vias)) == (row[WAIT], row[LATE], row[EFFORT], 2)
    for k, via in enumerate(shape.vias):
        assert np.array_equal(via.q, row[FIRST_VIA + 4 * k : FIRST_VIA + 4 * (k + 1)])
        assert via.pace == row[PACES + k]


def really_free(scene: Scene, prover: Prover, candidate: Candidate) -> bool:
    """Whether screening finds nothing in the way of a candidate, once it is timed."""
    motion = timed(scene, initial(scene), candidate, None)
    return isinstance(motion, TimedCandidate) and screen(prover, motion).refusal is None


def test_what_is_free_at_many_instants_is_free_and_few_instants_miss_more() -> None:
    scene = walled()
    prover, found, population = asked(scene)
    ways = drawn(population, 400)
    few, _ = population.score(ways, np.random.default_rng(0))
    seems = ways[few <= FREE]
    many, _ = population.score.finely(seems)
    free = np.array([really_free(scene, prover, Candidate(found[int(row[OPTION])], shape_of(row))) for row in seems])
    assert 0.1 < (many > FREE).mean() < 0.9
    assert free[many <= FREE].mean() > 0.85
    assert free[many > FREE].mean() < 0.25


def test_arches_are_scored_with_the_overlap_of_their_corners() -> None:
    """A wall stands in the way: corners that overlap much go through it, and some that overlap less go over it."""
    wall = stands("wall", box(0.5, 0.02, 0.24), 0.45, 0.0, 0.12)
    scene = cell(go(0.33, 0.25, 0.1), bodies=(wall,), q=(-0.9, 0.6, 0.1, 0.0))
    prover, found, population = asked(scene)
    top, corners = float(scene.robot.limits.upper[2]), np.linspace(0.0, 1.0, 7).tolist()
    arches = [Candidate(found[0], Shape(form=ArchForm(top, rise, fall))) for rise in corners for fall in corners]
    seems = population.free_arches(arches)
    free = [really_free(scene, prover, each) for each in arches]
    agree = [(each in seems) is one for each, one in zip(arches, free, strict=True)]
    assert 5 <= sum(free) <= len(arches) - 5
    assert np.mean(agree) > 0.95


@pytest.mark.parametrize("bars", [False, True])
def test_direct_ways_and_arches_that_are_not_free_come_after_candidates_by_vias(bars: bool) -> None:
    """A wall higher than the lift goes bars the direct ways and the arches; without it a direct way is first."""
    wall = stands("wall", box(0.2, 0.02, 0.6), 0.45, 0.0, 0.3)
    scene = cell(go(0.4, 0.25, 0.1), bodies=(wall,) if bars else (), q=(-0.9, 0.6, 0.2, 0.0))
    sampler = Search(scene, Prover(scene), 0.0)._sampler(initial(scene))

    def simple(batch: list[Candidate]) -> list[bool]:
        return [not each.shape.vias and each.shape.wait == each.shape.late == 0.0 for each in batch]

    first = [simple(sampler.batch()) for _ in range(1 + LATER)]
    if not bars:
        assert first[0]
        assert all(first[0])
        return
    assert not any(any(batch[:3]) for batch in first[:LATER])
    assert first[LATER]
    assert all(first[LATER])
