"""The statement checker: does a claim state what the request requires?

The claim checker shows that what a claim states is true. It cannot know whether that is what is required. This program
reads the facts of the request (robot, frames with the numbers of their laws, bodies, task, options) and the legs, the
arrivals and the knots of the plan. From them it derives a second time what the claim has to state: who holds what, what
may touch, which distance each pair needs, what is uncertain, order, windows, limits, loads and points. It compares laws
with their formulas, arms with the chains of textbooks, and solids with the numbers of the request.

It computes no distance, and imports nothing from which the planner or the writer of the claim get the same facts
(an import rule holds that). A claim may state more than the request requires: a larger distance, a smaller contact, a
narrower limit. It may not state less. All entry points return findings, which are plain sentences; there is none if the
claim states what is required. The form of the claim must be right: the claim checker has to see to that first.
"""

from __future__ import annotations

from assur.planner.checker.statement.arms import require_knots, require_links
from assur.planner.checker.statement.differences import Requirements
from assur.planner.checker.statement.distances import require_distances, require_execution
from assur.planner.checker.statement.frames import require_frames, require_known
from assur.planner.checker.statement.guides import require_guides
from assur.planner.checker.statement.holding import Given, Handling
from assur.planner.checker.statement.joints import (
    require_arches,
    require_hands,
    require_joints,
    require_margins,
    require_modes,
    require_postures,
)
from assur.planner.checker.statement.limits import require_limits, require_loads, require_rates, require_yaws
from assur.planner.checker.statement.order import require_order, require_parabolas
from assur.planner.checker.statement.peaks import require_peaks, require_tool
from assur.planner.checker.statement.phases import (
    require_nearness,
    require_phases,
    require_stated_contacts,
    require_touching,
)
from assur.planner.checker.statement.points import require_arrivals, require_points
from assur.planner.checker.statement.solids import require_solids
from assur.planner.checker.statement.statement import Statement
from assur.planner.checker.verdict import Code, Finding
from assur.planner.claim.columns import Claim
from assur.planner.model.claims import NOTHING, Claims
from assur.planner.model.digest import digest
from assur.planner.model.scene import Scene

__all__ = ["Given", "Handling", "state_answer", "state_cell", "state_legs", "state_plan"]

OF_MOTIONS = (require_execution, require_phases, require_known, require_limits, require_rates, require_yaws)
"""What is required of every motion, with a task or without."""
OF_TASKS = (
    require_points,
    require_arrivals,
    require_hands,
    require_joints,
    require_arches,
    require_guides,
    require_parabolas,
    require_modes,
    require_margins,
    require_touching,
)
"""What is required of a plan for a task in addition."""


def state_cell(scene: Scene, claim: Claim) -> list[Finding]:
    """Findings about what depends on the cell alone: motions of frames, links, solids and distances.

    A kept cell needs this once. `claim`: the claim of the scene, with or without a plan.
    """
    report = Requirements()
    require_solids(report, scene, claim)
    require_frames(report, scene.frames, claim)
    if not report.findings:  # else rows may be those of other bodies and frames
        require_links(report, scene, claim)
        require_distances(report, scene, claim)
    return report.findings


def state_legs(handling: Handling) -> list[Finding]:
    """Findings about the digest, and about legs and arrivals, which need no claim. `handling`: of the plan."""
    plan = handling.plan
    own = digest(handling.scene.digest, plan.trajectory, plan.legs, plan.arrivals, plan.certificate)
    what = "request, plan and certificate do not belong together"
    handling.require(plan.certificate.digest == own, Code.DIGEST, what)
    require_order(handling)
    return handling.findings


def state_plan(handling: Handling, claim: Claim, claims: Claims = NOTHING, *, has_task: bool = True) -> list[Finding]:
    """Findings about what depends on the task and the plan, and then on the answer, for a claim with whose cell nothing
    is wrong, and a plan with whose legs nothing is wrong. A plan of a motion that has no task has one leg, in travel,
    and no arrivals."""
    statement = Statement(handling, claim)
    require_knots(statement, statement.scene.robot, statement.plan.trajectory, claim, 0)
    for require in OF_MOTIONS + (OF_TASKS if has_task else ()):
        require(statement)
    return statement.findings if statement.findings or claims is NOTHING else state_answer(handling, claims, claim)


def state_answer(handling: Handling, claims: Claims, claim: Claim) -> list[Finding]:
    """Findings about what an answer states in addition to its plan, for a claim with whose cell and plan nothing is
    wrong."""
    statement = Statement(handling, claim)
    require_loads(statement, claims.carried)
    if claims.peaks is not None:
        require_peaks(statement, claims.peaks)
    require_tool(statement, claims)
    require_postures(statement, claims)
    require_nearness(statement, claims)
    if claims.contacts is not None:
        require_stated_contacts(statement, claims.contacts)
    return statement.findings
