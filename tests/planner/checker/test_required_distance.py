"""Equation C5, row by row against a sentence by sentence reading of docs/guarantees.md."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from assur.planner.checker.required import required
from assur.planner.checker.rows import Rows
from assur.planner.checker.solids import solids
from assur.planner.checker.stage import stage
from assur.planner.frames.law import Uncertainty
from assur.planner.model.phases import Phase, phases
from assur.planner.model.scene import Execution, Scene
from tests.planner.checker.hand_made import belt_case

UP = np.array([0.0, 0.0, 1.0])
SIDE = np.array([0.6, 0.8, 0.0])


def read(scene: Scene, phase: Phase, one: str, other: str, n: np.ndarray, t0: float, t1: float) -> float | None:
    """The distance, or None where nothing is asked."""
    robot = {item.body.name for item in scene.robot.bodies} | {body.name for body in scene.tool.bodies}
    if phase.carried is not None:
        robot.add(phase.carried.part)
    if one not in robot and other not in robot:
        return None
    if tuple(sorted((one, other))) in phase.exempt:
        return -1e-4
    clearance = scene.options.clearance.near_m if phase.near else scene.options.clearance.travel_m
    if one in robot and other in robot:
        return clearance
    world = other if one in robot else one
    frame, pose = scene.index[world].frame, scene.index[world].pose
    for name, on, at in phase.rides:
        if name == world:
            frame, pose = on, at
    wait = scene.execution.start_tolerance_s
    late = t1 + wait

    def u(name: str) -> float:
        known = scene.frames[name].uncertainty
        return known.position_m + known.speed_m_s * (late - scene.start.time)

    if not scene.execution.belt_correction:
        unsure = u(frame)
    elif phase.glued is not None:
        unsure = 0.0 if frame == phase.glued else u(frame) + u(phase.glued)
    else:
        unsure = u(frame) + sum(u(name) for name in phase.beside if name != frame)
    law = scene.frames[frame].law.bounds(np.array([t0]), np.array([late]), n[None])
    table = solids(scene)
    number, place = np.array([table.number[world]]), np.array([[pose.x, pose.y, pose.z, pose.yaw]])
    arm = table.reach(number, place)[1][-1] * np.hypot(n[0], n[1])
    speed = float((law.speed + arm * law.yaw_rate)[0])
    return clearance + scene.execution.tracking_m + wait * speed + unsure


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
    scenery = stage(scene, solids(scene), of_plan)
    many = len(scenery.solids.bodies)
    one, other = (grid.ravel() for grid in np.meshgrid(np.arange(many), np.arange(many)))
    one, other = one[one != other], other[one != other]
    for k, phase in enumerate(of_plan):
        t0 = np.full(len(one), phase.t0 + rng.uniform(0, 0.5) * (phase.t1 - phase.t0))
        t1 = np.full(len(one), phase.t1)
        n = np.tile(UP if rng.random() < 0.3 else SIDE, (len(one), 1))
        whole = np.full(len(one), -1)
        rows = Rows(np.arange(len(one)), np.full(len(one), k), one, other, whole, whole, t0, t1)
        found = required(scenery, of_plan, rows, n)
        for i in range(len(one)):
            a, b = (scenery.solids.bodies[body[i]].name for body in (one, other))
            wanted = read(scene, phase, a, b, n[i], float(t0[i]), float(t1[i]))
            if wanted is None:
                assert found[i] == -np.inf or found[i] == -1e-4
            else:
                assert found[i] == pytest.approx(wanted, abs=1e-12)
