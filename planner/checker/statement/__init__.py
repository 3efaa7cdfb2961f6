"""The statement checker: does a claim state what the request asks?

The claim checker shows that what a claim states is true. It cannot know whether that is what was asked. This program
reads the facts of the request (robot, frames with the numbers of their laws, bodies, task, options) and the legs, the
arrivals and the knots of the plan. From them it derives a second time what the claim has to state: who holds what, what
may touch, which distance each pair needs, what is uncertain, order, windows, limits, loads and points. It compares laws
with their formulas, links with the forward kinematics of textbooks, and solids with the numbers of the request.

It computes no distance, and imports nothing from which the planner or the writer of the claim get the same facts
(an import rule holds that). A claim may state more than the request asks: a larger distance, a smaller contact, a
narrower limit. It may not state less. All entry points return differences as plain sentences; there is none if the
claim states what is asked. The form of the claim must be right: the claim checker has to see to that first.
"""

from __future__ import annotations

from assur.planner.checker.statement.arches import arches_agree
from assur.planner.checker.statement.arms import links_agree, motion_agrees
from assur.planner.checker.statement.arrivals import arrivals_agree
from assur.planner.checker.statement.differences import Difference, Topic
from assur.planner.checker.statement.distances import distances_agree, execution_agrees
from assur.planner.checker.statement.errors import errors_agree
from assur.planner.checker.statement.frames import frames_agree, laws_known
from assur.planner.checker.statement.guides import guides_agree
from assur.planner.checker.statement.holding import Handling
from assur.planner.checker.statement.joints import hands_agree, joints_agree
from assur.planner.checker.statement.limits import limits_agree, rates_agree, yaws_agree
from assur.planner.checker.statement.loads import loads_agree, loads_of
from assur.planner.checker.statement.nearness import Nearness
from assur.planner.checker.statement.order import order_agrees
from assur.planner.checker.statement.passed import parabolas_agree
from assur.planner.checker.statement.peaks import peaks_agree, tool_agrees
from assur.planner.checker.statement.phases import Stage, phases_agree, stages_of
from assur.planner.checker.statement.points import points_agree
from assur.planner.checker.statement.postures import margins_agree, modes_agree, postures_agree
from assur.planner.checker.statement.solids import solids_agree
from assur.planner.claim.columns import Claim
from assur.planner.model.claims import Claims
from assur.planner.model.digest import digest
from assur.planner.model.outcome import Plan
from assur.planner.model.scene import Scene

__all__ = ["Difference", "Topic", "state_answer", "state_cell", "state_legs", "state_motion", "state_plan"]


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


def state_legs(scene: Scene, plan: Plan) -> list[Difference]:
    """Differences of the digest, and of legs and arrivals, which need no claim."""
    found = []
    if plan.certificate.digest != digest(scene.digest, plan.trajectory, plan.legs, plan.arrivals, plan.certificate):
        found.append(Difference(Topic.DIGEST, "request, plan and certificate do not belong together"))
    return found + list(order_agrees(Handling(scene, plan)))


def state_plan(scene: Scene, plan: Plan, claim: Claim) -> list[Difference]:
    """Differences of what depends on the task and the plan, for a claim whose cell has no difference and a plan whose
    legs have none."""
    handling = Handling(scene, plan)
    stages = stages_of(handling)
    found = _motion(handling, stages, claim)
    found += points_agree(handling, claim)
    found += arrivals_agree(handling, claim)
    found += hands_agree(handling, claim)
    found += joints_agree(handling, claim)
    found += arches_agree(handling, claim)
    found += guides_agree(handling, claim)
    found += parabolas_agree(handling)
    found += errors_agree(handling, claim)
    found += modes_agree(handling, claim)
    found += margins_agree(handling, claim)
    found += Nearness(handling, stages, claim).touching_agrees()
    return found


def state_motion(scene: Scene, plan: Plan, claim: Claim) -> list[Difference]:
    """Differences of a motion that has no task: `plan` has one leg, in travel, and no arrivals."""
    handling = Handling(scene, plan)
    return _motion(handling, stages_of(handling), claim)


def _motion(handling: Handling, stages: list[Stage], claim: Claim) -> list[Difference]:
    """Differences of the motion, of what has to keep apart in which phase, and of limits."""
    scene = handling.scene
    found = list(motion_agrees(scene, handling.plan, claim))
    found += execution_agrees(scene, claim, stages[-1].when[1])
    found += phases_agree(handling, stages, claim)
    found += laws_known(scene, claim)
    found += limits_agree(handling, stages, claim)
    found += rates_agree(handling, stages, claim)
    found += yaws_agree(handling, claim)
    return found


def state_answer(scene: Scene, plan: Plan, claims: Claims, claim: Claim) -> list[Difference]:
    """Differences of what an answer states beside its plan, for a claim whose cell and plan have none."""
    handling = Handling(scene, plan)
    stages = stages_of(handling)
    loads, nearness = loads_of(handling, stages), Nearness(handling, stages, claim)
    found = [*loads_agree(loads, claims.carried), *peaks_agree(handling, loads, claims.peaks, claim)]
    found += tool_agrees(handling, stages, claims, claim)
    found += postures_agree(handling, claims, claim)
    found += nearness.stated_agrees(claims)
    found += nearness.contacts_agree(claims.contacts)
    return found
