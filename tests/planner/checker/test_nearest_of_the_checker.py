"""The smallest clearance that an answer states: accepted where it is so, refused where it is not, from either side."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.checked import check
from assur.planner.checker import Code
from assur.planner.checker.motion import JETS
from assur.planner.checker.nearest import WITHIN_M
from assur.planner.checker.separation import HINT, ITEM, NEAR_M, OTHER, OTHER_ON, distance
from assur.planner.checker.solids import BALL, SOLID, TURN, farthest
from assur.planner.collision.nearest import nearest
from assur.planner.collision.proof import Prover
from assur.planner.geometry.shapes import box, capsule, cylinder
from assur.planner.model.claims import Claims
from assur.planner.model.outcome import Nearest, Plan
from assur.planner.model.phases import phases
from assur.planner.model.scene import Scene
from tests.planner.checker.hand_made import belt_case, crossing_case, proved
from tests.planner.checker.test_far import ring
from tests.planner.checker.test_solids_of_the_checker import TABLE
from tests.planner.checker.test_soundness import distance as from_point

CASES = (crossing_case, belt_case, ring)


@cache
def stated(case: Callable[[], tuple[Scene, Plan]]) -> tuple[Scene, Plan, Nearest]:
    """A plan that is right, with the smallest clearance that the planner finds."""
    scene, plan = case()
    found = nearest(Prover(scene), plan.trajectory, phases(scene, plan.legs, plan.arrivals))
    assert found is not None
    return scene, plan, found


def codes(scene: Scene, plan: Plan, said: Nearest | None) -> set[Code]:
    return {finding.code for finding in check(scene, plan, Claims(nearest=(said,))).findings}


@pytest.mark.parametrize("case", CASES)
def test_what_the_planner_finds_is_accepted(case: Callable[[], tuple[Scene, Plan]]) -> None:
    scene, plan, said = stated(case)
    assert check(scene, plan, Claims(nearest=(said,))).findings == ()
    first, second = said.bodies
    assert codes(scene, plan, replace(said, bodies=(second, first))) == set()


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("off", [1e-3, -1e-3, 2.5 * WITHIN_M, -2.5 * WITHIN_M, 0.1, 1e6, -1e6, np.inf, np.nan])
def test_a_clearance_that_is_too_large_or_too_small_is_refused(
    case: Callable[[], tuple[Scene, Plan]], off: float
) -> None:
    scene, plan, said = stated(case)
    assert codes(scene, plan, replace(said, gap_m=said.gap_m + off)) == {Code.NEAREST}


@pytest.mark.parametrize("case", CASES)
def test_another_pair_time_or_phase_is_refused(case: Callable[[], tuple[Scene, Plan]]) -> None:
    scene, plan, said = stated(case)
    of_plan = phases(scene, plan.legs, plan.arrivals)
    names = [item.body.name for item in scene.robot.bodies] + [body.name for body in scene.bodies]
    for name in names:
        if name not in said.bodies:
            for kept in said.bodies:
                assert codes(scene, plan, replace(said, bodies=(kept, name))) == {Code.NEAREST}
    for time in (of_plan[0].t0 - 1.0, of_plan[-1].t1 + 1e-6, np.nan, np.inf):
        assert codes(scene, plan, replace(said, time=time)) == {Code.NEAREST}
    for phase in ("ARCH", "nowhere"):
        assert codes(scene, plan, replace(said, phase=phase)) == {Code.NEAREST}
    for bodies in (("nobody", said.bodies[0]), (said.bodies[0], said.bodies[0])):
        assert codes(scene, plan, replace(said, bodies=bodies)) == {Code.NEAREST}
    assert codes(scene, plan, None) == {Code.NEAREST}


@pytest.mark.parametrize("case", [belt_case, ring])
def test_the_time_at_which_a_pair_is_nearest_counts(case: Callable[[], tuple[Scene, Plan]]) -> None:
    """At other times the pair is farther away."""
    scene, plan, said = stated(case)
    times = [(float(t), leg.kind) for leg in plan.legs for t in np.linspace(leg.t0, leg.t1, 7)]
    refused = [codes(scene, plan, replace(said, time=t, phase=str(kind))) == {Code.NEAREST} for t, kind in times]
    assert sum(refused) >= len(times) // 2


def test_an_allowed_contact_is_not_the_nearest_pair() -> None:
    scene, plan, said = stated(belt_case)
    touching = next(phase for phase in phases(scene, plan.legs, plan.arrivals) if phase.contacts)
    (pair, *_) = sorted(touching.contacts)
    there = Nearest(0.0, touching.t0, pair, str(touching.kind), 0.0)
    assert codes(scene, plan, there) == {Code.NEAREST}
    assert said.gap_m > 0.0


def test_a_plan_among_nothing_has_no_clearance_to_state() -> None:
    scene, plan, said = stated(crossing_case)
    alone = replace(scene, bodies=(), robot=replace(scene.robot, self_pairs=()))  # type: ignore[type-var]
    free = proved(alone, plan.trajectory, plan.legs, plan.arrivals)
    assert codes(alone, free, None) == set()
    assert codes(alone, free, said) == {Code.NEAREST}


def test_boxes_of_bodies_are_opened_to_their_pieces() -> None:
    scene, plan, said = stated(crossing_case)
    boxed = replace(scene, bodies=tuple(body for body in scene.bodies if body.name == "carton"))
    made = proved(boxed, plan.trajectory, plan.legs, plan.arrivals)
    found = nearest(Prover(boxed), made.trajectory, phases(boxed, made.legs, made.arrivals))
    assert found is not None
    assert codes(boxed, made, found) == set()
    assert codes(boxed, made, replace(found, gap_m=found.gap_m + 3 * WITHIN_M)) == {Code.NEAREST}
    assert said.gap_m <= found.gap_m + WITHIN_M


SHAPES = {"box": box(0.1, 0.04, 0.06), "cylinder": cylinder(0.03, 0.2), "capsule": capsule(0.02, 0.15)}


def placed(seed: int) -> FloatArray:
    """Jets (2, JETS, 6) of two carriers somewhere, turned anyhow."""
    rng, found = np.random.default_rng(seed), np.zeros((2, JETS, 6))
    for row in found:
        q, r = np.linalg.qr(rng.normal(size=(3, 3)))
        q = q * np.sign(np.diag(r))
        q = q if np.linalg.det(q) > 0 else q[:, [1, 0, 2]]
        row[:3, :2], row[3:, :2] = rng.normal(size=3)[:, None] * 0.3, q.T.reshape(-1)[:, None]
    return found


def between(first: FloatArray, second: FloatArray, jets: FloatArray) -> tuple[float, float]:
    """The distance of two solids on the two carriers, from below and from above, as near as the search comes."""
    item, none, low = np.zeros(ITEM), np.zeros((0, 1)), -1.0
    item[OTHER], item[OTHER_ON], item[HINT + 2] = 1.0, 1.0, 1.0
    tables = (none, none, none, none, np.stack([first, second]), TABLE.vertices)
    for _ in range(30):  # what is claimed is the lower value of before: it ends as soon as it has most of the rest
        now, high = distance(tables, jets, item, low)
        low = max(low, now)
    return low, high


@given(st.sampled_from(sorted(SHAPES)), st.integers(0, 2**32 - 1))
def test_distances_of_a_ball_are_those_from_its_centre(name: str, seed: int) -> None:
    """Against a closed form; the ball is a point with a radius."""
    jets, ball, other, shape = placed(seed), np.zeros(SOLID), np.zeros(SOLID), SHAPES[name]
    ball[BALL], ball[[TURN, TURN + 4, TURN + 8]], other[[TURN, TURN + 4, TURN + 8]] = 0.02, 1.0, 1.0
    other[12:15], other[15], other[16] = shape.half, shape.disc, shape.ball
    local = (jets[0, :3, 0] - jets[1, :3, 0]) @ jets[1, 3:, 0].reshape(3, 3).T
    true = float(from_point(shape, local[None])[0]) - 0.02
    low, high = between(ball, other, jets)
    if true > 1e-4:
        assert low - 1e-12 <= true <= high + 1e-12
        assert high - low <= NEAR_M


@given(st.integers(0, len(TABLE.table) - 1), st.integers(0, len(TABLE.table) - 1), st.integers(0, 2**32 - 1))
def test_no_points_of_two_solids_are_nearer_than_the_lower_value_and_some_are_no_farther_than_the_upper_one(
    i: int, k: int, seed: int
) -> None:
    jets = placed(seed)
    first, second = TABLE.table[i].copy(), TABLE.table[k].copy()
    low, high = between(first, second, jets)
    assert low <= high + 1e-12
    if low > 0.0:  # of those that overlap nothing more is asked
        assert high - low <= NEAR_M
    for n in np.random.default_rng(seed).normal(size=(50, 3)):
        n /= np.linalg.norm(n)
        one = np.array(farthest(first, jets, 0, TABLE.vertices, tuple(n.tolist()), 1.0))
        other = np.array(farthest(second, jets, 1, TABLE.vertices, tuple((-n).tolist()), 1.0))
        # along any direction the gap of supports is below the distance, and points of both are not nearer than that
        assert n @ (other - one) <= high + 1e-12
        assert np.linalg.norm(other - one) >= low - 1e-12
