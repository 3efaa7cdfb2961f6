"""The statement checker: does a claim state what the request asks?

The claim checker shows that what a claim states is true. It cannot know whether that is what was asked. This program
reads the facts of the request (robot, frames with the numbers of their laws, bodies, task, options) and the legs, the
arrivals and the knots of the plan. From them it derives a second time what the claim has to state: who holds what, what
may touch, which distance each pair needs, what is uncertain, order, windows, limits, loads and points. It compares laws
with their formulas, links with the forward kinematics of textbooks, and solids with the numbers of the request.

It computes no distance, and imports nothing from which the planner or the writer of the claim get the same facts
(an import rule holds that). A claim may state more than the request asks: a larger distance, a smaller contact, a
narrower limit. It may not state less. Both entry points return differences as plain sentences; there is none if the
claim states what is asked. The form of the claim must be right: the claim checker has to see to that first.

What no claim can state yet is not compared: working modes and the margin to singular positions, inertia, peaks and
smallest distances that an answer states.
"""

from __future__ import annotations

from assur.planner.checker.statement.arches import arches_agree
from assur.planner.checker.statement.arms import links_agree, motions_agree
from assur.planner.checker.statement.arrivals import arrivals_agree
from assur.planner.checker.statement.differences import Difference, Topic
from assur.planner.checker.statement.distances import distances_agree, execution_agrees
from assur.planner.checker.statement.errors import errors_agree
from assur.planner.checker.statement.frames import frames_agree
from assur.planner.checker.statement.guides import guides_agree
from assur.planner.checker.statement.holding import Handling
from assur.planner.checker.statement.joints import hands_agree, joints_agree
from assur.planner.checker.statement.limits import laws_last, limits_agree, rates_agree, yaws_agree
from assur.planner.checker.statement.order import order_agrees
from assur.planner.checker.statement.passed import parabolas_agree
from assur.planner.checker.statement.phases import phases_agree, stages_of
from assur.planner.checker.statement.points import points_agree
from assur.planner.checker.statement.solids import solids_agree
from assur.planner.claim.columns import Claim
from assur.planner.model.digest import digest
from assur.planner.model.outcome import Plan
from assur.planner.model.scene import Scene

__all__ = ["Difference", "Topic", "state_cell", "state_plan"]


def state_cell(scene: Scene, claim: Claim) -> list[Difference]:
    """Differences of what depends on the cell alone: motions of frames, links, solids and distances.

    A kept cell needs this once. `claim`: the claim of the scene, with or without a plan.
    """
    found = list(solids_agree(scene, claim))
    found += frames_agree(scene.frames, claim)
    if not found:  # else rows may be those of other bodies and frames
        found += links_agree(scene, claim)
        found += distances_agree(scene, claim)
    return found


def state_plan(scene: Scene, plan: Plan, claim: Claim) -> list[Difference]:
    """Differences of what depends on the task and the plan, for a claim whose cell has no difference."""
    found = []
    if plan.certificate.digest != digest(scene.digest, plan.trajectory, plan.legs, plan.arrivals, plan.certificate):
        found.append(Difference(Topic.DIGEST, "request, plan and certificate do not belong together"))
    handling = Handling(scene, plan)
    found += order_agrees(handling)
    if found:  # who holds what follows from the legs
        return found
    stages = stages_of(handling)
    found += motions_agree(scene, plan, claim)
    found += execution_agrees(scene, claim, stages[-1].when[1])
    found += phases_agree(handling, stages, claim)
    found += laws_last(handling, stages, claim)
    found += limits_agree(handling, stages, claim)
    found += points_agree(handling, claim)
    found += arrivals_agree(handling, claim)
    found += hands_agree(handling, claim)
    found += joints_agree(handling, claim)
    found += arches_agree(handling, claim)
    found += guides_agree(handling, claim)
    found += parabolas_agree(handling)
    found += errors_agree(handling, claim)
    found += rates_agree(handling, stages, claim)
    found += yaws_agree(handling, claim)
    return found
