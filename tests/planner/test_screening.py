"""Screening: quick, and never wrong when it refuses; what it lets pass is still to be proved."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from assur.planner.collision.proof import Prover
from assur.planner.collision.rows import ProofFailure, Rows
from assur.planner.collision.screening import screen
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import box
from assur.planner.kernels.proof import OTHER, UNIT
from assur.planner.model.outcome import LegKind
from assur.planner.model.phases import Phase
from assur.planner.model.refusal import Reason, Separation
from assur.planner.model.scene import Clearance
from assur.planner.trajectory import Trajectory
from tests.planner.cells import CUP, Around, amount_of, arm, block, cell, go, mesh_box, solid, stands
from tests.planner.certificate.moving_ball import LAWS, SHAPES, encounter
from tests.planner.second_solids import units_of


@dataclass(frozen=True)
class Motion:
    """A trajectory in phases, as screening sees it."""

    trajectory: Trajectory
    phases: tuple[Phase, ...]


@settings(max_examples=60)
@given(st.integers(0, 10**6), st.sampled_from(SHAPES), st.sampled_from(LAWS), st.integers(1, 3), st.floats(-0.02, 0.02))
def test_what_screening_refuses_really_is_too_close_where_and_as_it_says(
    seed: int, kind: str, how: str, pieces: int, spare: float
) -> None:
    case = encounter(seed, kind, how, pieces)
    clearance = 0.003
    radius = max(0.002, case.nearest()[0] - clearance - spare)
    scene = case.scene(radius, clearance=Clearance(clearance, 0.0))
    prover = Prover(scene)
    found = screen(prover, Motion(case.path, (case.phase(),)))
    proof = prover.prove(case.phase(), case.path)
    if found.refusal is None:
        return
    assert isinstance(proof, ProofFailure)
    assert found.refusal.reason is Reason.BODY_COLLISION
    assert found.refusal.bodies == ("ball", "thing")
    assert found.refusal.interval is not None
    t, same = found.refusal.interval
    assert t == same
    there = float(case.apart(np.array([t]))[0]) - radius
    assert there < clearance + 1e-8
    told = found.encounters[0].confirmed()
    assert isinstance(told.facts, Separation)
    assert told.facts.touching == (there <= 0)
    if there > 0:
        assert amount_of(found.refusal) == pytest.approx(clearance - there, abs=1e-6)


@settings(max_examples=40)
@given(st.integers(0, 10**6), st.sampled_from(SHAPES), st.sampled_from(LAWS))
def test_what_is_proved_is_never_refused(seed: int, kind: str, how: str) -> None:
    case = encounter(seed, kind, how)
    radius = max(0.002, case.nearest()[0] - 0.0022)
    scene = case.scene(radius, clearance=Clearance(0.002, 0.0))
    prover = Prover(scene)
    if isinstance(prover.prove(case.phase(), case.path), Rows):
        found = screen(prover, Motion(case.path, (case.phase(),)))
        assert found.refusal is None


def still(q: tuple[float, ...], **facts: object) -> Motion:
    """The arm stands at q for a second."""
    both = np.array([q, q])
    path = Trajectory(np.array([0.0, 1.0]), both, np.zeros((2, 4)), np.zeros((2, 4)))
    phase = Phase(t0=0.0, t1=1.0, **{"kind": LegKind.MOVE, "step": 0, **facts})  # type: ignore[arg-type]
    return Motion(path, (phase,))


HERE = (0.3, 1.2, 0.2, 0.0)
THERE = (-0.6, 1.0, 0.2, 0.0)


def test_each_draft_of_a_batch_gets_its_own_answer() -> None:
    p, _ = arm().forward(np.array(HERE))
    post = stands("post", box(0.05, 0.05, 0.6), float(p[0]), float(p[1]), 0.2)
    prover = Prover(cell(go(0.3, 0.0), bodies=(post,), tool=CUP))
    answers = [screen(prover, still(q)) for q in (THERE, HERE, THERE, HERE)]
    assert [answer.refusal is None for answer in answers] == [True, False, True, False]


def test_a_hull_that_is_off_its_origin_is_seen_where_it_is() -> None:
    p, _ = arm().forward(np.array(HERE))
    far = block(0.05, 0.05, 0.6, (float(p[0]) + 1.0, float(p[1]), 0.2))
    prover = Prover(cell(go(0.3, 0.0), bodies=(Around(solid("far", far, -1.0, 0.0, 0.0)),), tool=CUP))
    assert screen(prover, still(HERE)).refusal is not None
    assert screen(prover, still(THERE)).refusal is None


def test_the_arm_inside_the_box_of_a_hollow_body_is_not_refused_for_the_box() -> None:
    p, _ = arm(bare=True).forward(np.array(HERE))
    bin_ = Around(mesh_box("bin", 0.3, 0.3, 0.5), "world", Pose(float(p[0]), float(p[1]), 0.2))
    prover = Prover(cell(go(0.3, 0.0), bodies=(bin_,), tool=CUP, robot=arm(bare=True)))
    assert screen(prover, still(HERE)).refusal is None


def test_pairs_that_may_touch_are_left_to_the_prover() -> None:
    p, _ = arm().forward(np.array(HERE))
    plate = stands("plate", box(0.1, 0.1, 0.02), float(p[0]), float(p[1]), 0.2 - 0.06 - 0.01)
    prover = Prover(cell(go(0.3, 0.0), bodies=(plate,), tool=CUP, clearance=Clearance(0.002, 0.002)))
    assert screen(prover, still(HERE)).refusal is not None
    assert screen(prover, still(HERE, contacts=frozenset({("cup", "plate")}))).refusal is None


def test_a_collision_of_the_arm_with_itself_is_called_so() -> None:
    folded = (0.3, 2.6, 0.1, 0.0)
    prover = Prover(cell(go(0.3, 0.0), robot=arm(column=0.16)))
    found = screen(prover, still(folded)).refusal
    assert found is not None
    assert found.reason is Reason.SELF_COLLISION
    assert set(found.bodies) == {"quill", "column"}


def test_a_collision_while_the_arm_stands_at_the_end_belongs_to_the_last_step() -> None:
    p, _ = arm().forward(np.array(HERE))
    post = stands("post", box(0.05, 0.05, 0.6), float(p[0]), float(p[1]), 0.2)
    prover = Prover(cell(go(0.3, 0.0), go(0.3, 0.1, name="b"), bodies=(post,), tool=CUP))
    found = screen(prover, still(HERE, step=-1, kind=LegKind.WAIT)).refusal
    assert found is not None
    assert found.step == 1


@settings(max_examples=40)
@given(st.integers(0, 10**6), st.sampled_from(SHAPES), st.sampled_from(LAWS), st.integers(1, 3))
def test_what_screening_shows_is_what_a_proof_shows(seed: int, kind: str, how: str, pieces: int) -> None:
    case = encounter(seed, kind, how, pieces)
    scene = case.scene(max(0.002, case.nearest()[0] - 0.0033), clearance=Clearance(0.003, 0.0))
    prover, phase = Prover(scene), case.phase()
    alone = Prover(scene).prove(phase, case.path)
    found = screen(prover, Motion(case.path, (phase,)))
    assert (found.refusal is None) >= isinstance(alone, Rows)
    both = prover.prove(phase, case.path)
    assert isinstance(both, Rows) == isinstance(alone, Rows)
    if isinstance(both, Rows) and isinstance(alone, Rows):
        assert np.array_equal(both.table, alone.table)


def test_what_was_screened_shows_nothing_of_another_motion_or_of_another_phase() -> None:
    p, _ = arm().forward(np.array(HERE))
    post = stands("post", box(0.05, 0.05, 0.6), float(p[0]), float(p[1]), 0.2)
    prover = Prover(cell(go(0.3, 0.0), bodies=(post,), tool=CUP, clearance=Clearance(0.001, 0.6)))
    there, here = still(THERE), still(HERE)
    assert screen(prover, there).refusal is None
    assert isinstance(prover.prove(here.phases[0], here.trajectory), ProofFailure)
    assert screen(prover, there).refusal is None
    assert isinstance(prover.prove(replace(there.phases[0], kind=LegKind.FOLLOW), there.trajectory), ProofFailure)
    assert isinstance(prover.prove(there.phases[0], there.trajectory), Rows)


def test_pairs_that_may_touch_are_proved_after_screening() -> None:
    p, _ = arm().forward(np.array(HERE))
    for depth, proved in ((0.0, True), (0.001, False)):
        plate = stands("plate", box(0.1, 0.1, 0.02), float(p[0]), float(p[1]), 0.2 - 0.06 - 0.01 + depth)
        prover = Prover(cell(go(0.3, 0.0), bodies=(plate,), tool=CUP, clearance=Clearance(0.002, 0.002)))
        way = still(HERE, contacts=frozenset({("cup", "plate")}))
        assert screen(prover, way).refusal is None
        found = prover.prove(way.phases[0], way.trajectory)
        assert isinstance(found, Rows) == proved
        if isinstance(found, Rows):
            solids = found.arrangement
            names = {(solids.names[solids.body[a]], solids.names[solids.body[b]]) for a, b in
                     zip(units_of(found, UNIT), units_of(found, OTHER), strict=True)}  # fmt: skip
            assert {("cup", "plate"), ("quill", "plate")} <= names
