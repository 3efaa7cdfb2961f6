"""The smallest clearance that an answer states: accepted where it is so, refused where it is not, from either side."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from assur.planner.checked import check
from assur.planner.checker import Code
from assur.planner.checker.statement.phases import WITHIN_M
from assur.planner.collision.nearest import nearest
from assur.planner.collision.proof import Prover
from assur.planner.model.claims import Claims
from assur.planner.model.outcome import Nearest, Plan
from assur.planner.model.phases import phases
from assur.planner.model.scene import Scene
from tests.planner.checker.hand_made import belt_case, crossing_case, proved
from tests.planner.checker.test_far import ring

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
    found = codes(scene, plan, replace(said, gap_m=said.gap_m + off))
    assert found == ({Code.FORM} if off == np.inf else {Code.NEAREST})


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
    alone = replace(scene, bodies=(), robot=replace(scene.robot, self_pairs=()))
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
