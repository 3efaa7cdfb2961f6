"""Equation C5, row by row against a sentence by sentence reading of docs/guarantees.md."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from assur.planner.checker.cover import SPARED, VERDICT, resolve
from assur.planner.checker.rows import Apart
from assur.planner.checker.separation import DRIFT, ITEM, LATE, NEED
from assur.planner.checker.solids import solids
from assur.planner.checker.world import World
from assur.planner.frames.law import Uncertainty
from assur.planner.model.outcome import Certificate
from assur.planner.model.phases import Phase, phases
from assur.planner.model.scene import Execution, Scene
from tests.planner.checker.hand_made import belt_case
from tests.planner.frames.bounded import bounded

UP = np.array([0.0, 0.0, 1.0])
SIDE = np.array([0.6, 0.8, 0.0])


def read(scene: Scene, phase: Phase, one: str, other: str, t1: float) -> float | None:
    """The distance without the term of a late start, or None where nothing is asked."""
    robot = {item.body.name for item in scene.robot.bodies} | {body.name for body in scene.tool.bodies}
    if phase.attached.held is not None:
        robot.add(phase.attached.held.part)
    if one not in robot and other not in robot:
        return None
    if tuple(sorted((one, other))) in phase.contacts:
        return -1e-4
    clearance = scene.options.clearance.near_m if phase.near else scene.options.clearance.travel_m
    if one in robot and other in robot:
        return clearance
    world = other if one in robot else one
    frame = scene.index[world].frame
    for name, on, _ in phase.attached.placed:
        if name == world:
            frame = on
    wait = scene.execution.start_tolerance_s
    late = t1 + wait

    def u(name: str) -> float:
        known = scene.frames[name].uncertainty
        return known.position_m + known.speed_m_s * (late - scene.start.time)

    if not scene.execution.belt_correction:
        unsure = u(frame)
    elif phase.tracked is not None:
        unsure = 0.0 if frame == phase.tracked else u(frame) + u(phase.tracked)
    else:
        unsure = u(frame) + sum(u(name) for name in phase.corrected if name != frame)
    return clearance + scene.execution.tracking_m + unsure


@settings(max_examples=20)
@given(st.integers(0, 2**32 - 1), st.booleans(), st.sampled_from([0.0, 0.05]))
def test_the_required_distance_is_what_the_guarantees_say(seed: int, corrected: bool, wait: float) -> None:
    rng = np.random.default_rng(seed)
    scene, plan = belt_case()
    unsure = {
        name: replace(frame, uncertainty=Uncertainty(*rng.choice([0.0, 1e-3, 5e-3], 2)))
        for name, frame in scene.frames.items()
    }
    scene = replace(scene, frames=unsure, execution=Execution(float(rng.choice([0.0, 2e-3])), wait, corrected))
    of_plan = phases(scene, plan.legs, plan.arrivals)
    apart = Apart.of(scene, of_plan, solids(scene, of_plan), World(scene, plan).tables)
    names = [body.name for body in apart.table.bodies]
    for k, phase in enumerate(of_plan):
        for one in names:
            for other in names:
                if one == other:
                    continue
                item = resolved(apart, one, other, phase.t0, phase.t1)
                if phase.t0 == phase.t1:
                    continue
                found = item[NEED] + item[DRIFT] * (phase.t1 + wait)
                wanted = read(scene, phase, one, other, phase.t1)
                if wanted is None:
                    assert found == -np.inf or found == -1e-4
                else:
                    assert found == pytest.approx(wanted, abs=1e-12)
                    robots = all(apart.table.of_robot[k, apart.table.number[name]] for name in (one, other))
                    assert item[LATE] == (0.0 if robots or wanted < 0 else wait)


def resolved(apart: Apart, one: str, other: str, t0: float, t1: float, n: np.ndarray = UP) -> np.ndarray:
    """A row of two boxes as the checker sees it."""
    row, item = np.array([t0, t1, 0.0, -1.0, 1.0, -1.0, *n]), np.zeros(ITEM)
    numbers = np.array([apart.table.number[name] for name in (one, other)])
    assert resolve(apart.cell, apart.marks, numbers, row, item, np.zeros(VERDICT))
    return item


@pytest.mark.parametrize("wait", [0.01, 0.05])
def test_a_late_start_asks_for_the_way_that_a_body_may_have_gone(wait: float) -> None:
    """The term V of C5 at instants: no less than what points of the body are seen to do, and no more than the law's
    own bound."""
    scene, plan = belt_case()
    of_plan = phases(scene, plan.legs, plan.arrivals)
    i = next(i for i, p in enumerate(of_plan) if p.attached.held is None and p.t1 > p.t0)
    late = replace(scene, execution=Execution(start_tolerance_s=wait))
    aparts = [Apart.of(s, of_plan, solids(s, of_plan), World(s, plan).tables) for s in (scene, late)]
    t0 = of_plan[i].t0
    for n in (UP, SIDE, np.array([1.0, 0.0, 0.0])):
        for name in ("neighbour", "plate", "peg", "bed"):
            spared = [proves(apart, "cup", name, t0, n) for apart in aparts]
            item = scene.index[name]
            t = np.linspace(t0, t0 + wait, 50)
            motion = scene.frames[item.frame].law.motion(t).at(item.pose)
            seen = np.abs(motion.v @ n).max()
            law = bounded(scene.frames[item.frame].law, t[:1], t[-1:], n[None])
            most = float(law.speed[0] + 0.2 * law.yaw_rate[0])
            assert wait * seen - 1e-12 <= spared[0] - spared[1] <= wait * most + 1e-12


def proves(apart: Apart, one: str, other: str, t: float, n: np.ndarray) -> float:
    """What a row of an instant proves beyond what is required; the bodies may be far apart or through each other."""
    at, zero, one_, box = np.array([t]), np.array([0]), np.array([1]), np.array([-1])
    c = Certificate((one, other), at, at, zero, box, one_, box, n[None].copy())
    return float(apart.judged(c)[0][0, SPARED])
