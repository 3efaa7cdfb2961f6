"""Equation C5, row by row against a sentence by sentence reading of docs/guarantees.md."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.checker.cover import SPARED, VERDICT, resolve
from assur.planner.checker.motion import JETS, all_jets
from assur.planner.checker.rows import Apart
from assur.planner.checker.separation import ITEM, NEED, PLACES, required_of
from assur.planner.checker.solids import solids
from assur.planner.checker.world import World
from assur.planner.laws.law import Uncertainty
from assur.planner.model.outcome import Certificate
from assur.planner.model.phases import Phase, phases
from assur.planner.model.scene import Execution, Scene
from assur.planner.robots.scara import FLANGE, QUILL
from tests.planner.checker.hand_made import belt_case

UP = np.array([0.0, 0.0, 1.0])
SIDE = np.array([0.6, 0.8, 0.0])


def read(scene: Scene, phase: Phase, one: str, other: str, t1: float, n: FloatArray) -> float | None:
    """What docs/guarantees.md asks of two bodies along n (C5, U1); None: nothing. Nothing of it is the checker's."""
    links = {item.body.name: item.link for item in scene.robot.bodies} | {
        body.name: FLANGE for body in scene.tool.bodies
    }
    held = phase.attached.held
    if held is not None:
        links[held.part] = FLANGE
    if one not in links and other not in links:
        return None
    if tuple(sorted((one, other))) in phase.contacts:
        found = -1e-4
    else:
        found = scene.options.clearance.near_m if phase.near else scene.options.clearance.travel_m
    late = t1 + scene.execution.start_tolerance_s - scene.start.time
    shares = []
    for name in (one, other):
        own = dict.fromkeys(scene.frames, (0.0, 0.0))
        if name not in links:
            own[phase.attached.pose_of(scene, name)[0]] = (1.0, 1.0)
        elif links[name] in (FLANGE, QUILL) and scene.execution.belt_correction:
            tracked = scene.frames[phase.tracked or "world"].law.kind == "conveyor"
            for followed in phase.corrected if phase.tracked is None else (phase.tracked,) * tracked:
                own[followed] = (0.0 if phase.tracked is None else 1.0, 1.0)
        shares.append(own)
    both = one in links and other in links and all(links[name] in (FLANGE, QUILL) for name in (one, other))
    level = math.hypot(n[0], n[1])
    for name, frame in scene.frames.items():
        known, (a, b) = frame.uncertainty, (own[name] for own in shares)
        most = 0.0 if both else max(abs(x - y) for x in a for y in b)
        size = most * (known.position_m + known.speed_m_s * late)
        if frame.law.kind == "conveyor":
            found += size * abs(
                n[0] * math.cos(frame.law.numbers.pose.yaw) + n[1] * math.sin(frame.law.numbers.pose.yaw)
            )
        else:
            found += size * level
    for name in (one, other):
        if name in links:
            continue
        on, pose = phase.attached.pose_of(scene, name)
        known, law = scene.frames[on].uncertainty, scene.frames[on].law
        if law.kind == "conveyor":
            found += known.lateral_m * abs(
                n[1] * math.cos(law.numbers.pose.yaw) - n[0] * math.sin(law.numbers.pose.yaw)
            )
        far = math.hypot(pose.x, pose.y) + scene.index[name].body.radius
        found += known.vertical_m * abs(n[2]) + known.yaw_rad * far * level
    return found


@settings(max_examples=20)
@given(st.integers(0, 2**32 - 1), st.booleans(), st.sampled_from([0.0, 0.05]))
def test_the_required_distance_is_what_the_guarantees_say(seed: int, corrected: bool, wait: float) -> None:
    rng = np.random.default_rng(seed)
    scene, plan = belt_case()
    unsure = {}
    for name, frame in scene.frames.items():
        numbers = rng.choice([0.0, 1e-3, 5e-3], 5)
        numbers[2] *= frame.law.kind == "conveyor"
        unsure[name] = replace(frame, uncertainty=Uncertainty(*numbers.tolist()))
    scene = replace(scene, frames=unsure, execution=Execution((), wait, corrected))
    of_plan = phases(scene, plan.legs, plan.arrivals)
    world = World(scene, plan)
    apart = Apart.of(scene, of_plan, solids(scene, of_plan), world.tables)
    names = [body.name for body in apart.table.bodies]
    arms = {"upper arm", "forearm"} if corrected else set()
    n = rng.normal(size=3)
    n /= np.sqrt((n**2).sum())
    for k, phase in enumerate(of_plan):
        for one in names:
            for other in names:
                if one == other or phase.t0 == phase.t1 or arms & {one, other}:
                    continue
                item = resolved(apart, one, other, phase.t0, phase.t1, n)
                wanted = read(scene, phase, one, other, phase.t1, n)
                asked = apart.required(k, apart.table.number[one], apart.table.number[other])
                if item[NEED] == -np.inf:
                    assert not asked
                    continue
                jets = np.zeros((PLACES, len(all_jets(apart.tables)), JETS, 6))
                found = required_of(apart.tables, apart.doubt, jets, item, phase.t1, phase.t1, tuple(n.tolist()))
                if wanted is not None:
                    assert found == pytest.approx(wanted, abs=1e-12)


def resolved(apart: Apart, one: str, other: str, t0: float, t1: float, n: np.ndarray = UP) -> np.ndarray:
    """A row of two boxes as the checker sees it."""
    row, item = np.array([t0, t1, 0.0, -1.0, 1.0, -1.0, *n, 0.0, 0.0]), np.zeros(ITEM)
    numbers = np.array([apart.table.number[name] for name in (one, other)])
    assert resolve(apart.cell, apart.marks, numbers, row, item, np.zeros(VERDICT))
    return item


@pytest.mark.parametrize("share", [0.0, 1.0])
def test_a_late_start_asks_for_where_a_body_has_gone(share: float) -> None:
    """A row of an instant, whose second body is ahead of the clock, proves the gap to where that body is then (C8)."""
    wait = 0.05
    scene, plan = belt_case()
    scene = replace(scene, execution=Execution(start_tolerance_s=wait))
    of_plan = phases(scene, plan.legs, plan.arrivals)
    apart = Apart.of(scene, of_plan, solids(scene, of_plan), World(scene, plan).tables)
    i = next(i for i, p in enumerate(of_plan) if p.attached.held is None and p.t1 > p.t0)
    t0 = of_plan[i].t0
    for n in (UP, SIDE, np.array([1.0, 0.0, 0.0])):
        for name in ("neighbour", "plate", "peg"):
            law, pose = scene.frames[scene.index[name].frame].law, scene.index[name].pose
            here, there = (law.motion(np.array(t)).at(pose) for t in (t0, t0 + share * wait))
            now, then = proves(apart, "cup", name, t0, n), proves(apart, "cup", name, t0, n, share * wait)
            turned = abs(float(there.yaw - here.yaw)) * scene.index[name].body.radius
            assert abs(then - now - float((there.p - here.p) @ n)) <= turned + 1e-12


def proves(apart: Apart, one: str, other: str, t: float, n: np.ndarray, ahead: float = 0.0) -> float:
    """What a row of an instant proves beyond what is required; the bodies may be far apart or through each other."""
    at, zero, one_, box = np.array([t]), np.array([0]), np.array([1]), np.array([-1])
    shift = np.array([ahead])
    c = Certificate((one, other), at, at, zero, box, one_, box, n[None].copy(), shift, shift)
    return float(apart.judged(c)[0][0, SPARED])
