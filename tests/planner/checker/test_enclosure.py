"""A mesh is hollow to the rows; what begins inside one is found all the same."""

from __future__ import annotations

from assur.planner.checked import check
from assur.planner.checker import Code
from assur.planner.collision.proof import Prover
from assur.planner.collision.rows import ProofFailure, written
from assur.planner.laws import Pose
from assur.planner.model.outcome import Plan
from assur.planner.model.phases import phases
from tests.planner.cells import Around, mesh_box
from tests.planner.checker.hand_made import crossing, crossing_case, sealed


def within(mesh: Around) -> set[str]:
    """Of the plan for a cell without the mesh, with rows for its walls: what is not shown to be outside it."""
    _, plan = crossing_case()
    scene = crossing(bodies=(mesh,))
    proofs = [Prover(scene).prove(phase, plan.trajectory) for phase in phases(scene, plan.legs, plan.arrivals)]
    rows = [each for each in proofs if not isinstance(each, ProofFailure)]
    assert len(rows) == len(proofs)
    certificate = written(scene, plan.trajectory, plan.legs, plan.arrivals, rows)
    findings = check(scene, sealed(scene, Plan(plan.trajectory, plan.legs, plan.arrivals, certificate))).findings
    assert {finding.code for finding in findings} <= {Code.CONTAINMENT}
    return {finding.what.split(" and ")[0].rpartition(", ")[2] for finding in findings}


def test_an_arm_in_a_closed_room_is_inside_its_walls() -> None:
    """The room is solid, and only its surface says so."""
    room = Around(mesh_box("room", 3.0, 3.0, 3.0), "world", Pose())
    assert within(room) == {"column", "upper arm", "forearm", "quill", "cup"}


def test_an_arm_next_to_a_block_is_outside() -> None:
    block = Around(mesh_box("block", 0.12, 0.12, 0.12), "world", Pose(0.5, -0.1, 0.08, 0.3))
    assert within(block) == set()
