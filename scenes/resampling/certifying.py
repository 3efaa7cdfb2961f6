"""The same legs on other knots, proved and checked again: the exported motion is the proved motion."""

from __future__ import annotations

from dataclasses import dataclass

from assur.planner.checked import check
from assur.planner.checker.verdict import Code, Finding
from assur.planner.collision.proof import Prover
from assur.planner.collision.rows import ProofFailure, Rows, written
from assur.planner.model.outcome import Arrival, Leg, Plan
from assur.planner.model.phases import phases
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory
from assur.scenes.resampling.grid import arrivals_on, legs_on


@dataclass(frozen=True)
class Refutation:
    """Why a motion is not proved: findings of the checker, or the first pair whose clearance could not be proved."""

    findings: tuple[Finding, ...]


def recertified(scene: Scene, plan: Plan, trajectory: Trajectory) -> Plan | Refutation:
    """A plan with the legs and arrivals of `plan` on another trajectory, with its own certificate, checked."""
    legs, arrivals = kept_legs(plan, trajectory)
    prover, proofs = Prover(scene), list[Rows]()
    for phase in phases(scene, legs, arrivals):
        rows = prover.prove(phase, trajectory)
        if isinstance(rows, ProofFailure):
            return Refutation((unproved(rows, phase.kind),))
        proofs.append(rows)
    certificate = written(scene, trajectory, legs, arrivals, proofs)
    made = Plan(trajectory, legs, arrivals, certificate)
    verdict = check(scene, made)
    return made if verdict.ok else Refutation(verdict.findings)


def unproved(found: ProofFailure, where: str) -> Finding:
    """A pair that resists a proof, as a finding."""
    one, other = found.bodies
    place = f"{where}, {found.time:.6g} s"
    if found.gap > found.required:  # far enough at this instant, and not provably so around it: there is no amount
        return Finding(Code.SEPARATION, f"{one} and {other} are not shown to stay apart", unit="m", where=place)
    what = f"{one} and {other} " + ("touch" if found.touching else "come nearer than is required")
    return Finding(Code.SEPARATION, what, found.required - found.gap, "m", place)


def kept_legs(plan: Plan, trajectory: Trajectory) -> tuple[tuple[Leg, ...], tuple[Arrival, ...]]:
    """Legs and arrivals of a plan on another trajectory of the same course."""
    return legs_on(plan, trajectory), arrivals_on(plan, trajectory)
