"""The story of a check: a plan is right if nothing that was promised can be shown to be missing.

It trusts request and facts (shapes, laws, kinematics and its bounds), and nobody who makes plans.
"""

from __future__ import annotations

import numpy as np

from assur.planner.checker.arch import arches
from assur.planner.checker.blends import blends
from assur.planner.checker.carry import carried
from assur.planner.checker.cover import uncovered
from assur.planner.checker.enclosure import enclosed
from assur.planner.checker.far import planes
from assur.planner.checker.form import form
from assur.planner.checker.glue import glued
from assur.planner.checker.limits import limits
from assur.planner.checker.loop import loops
from assur.planner.checker.meeting import meetings
from assur.planner.checker.order import ends, legs
from assur.planner.checker.ranges import Ranges, ranges
from assur.planner.checker.rows import sorted_out, spare_of
from assur.planner.checker.solids import solids
from assur.planner.checker.spline import spline
from assur.planner.checker.stage import Stage, stage
from assur.planner.checker.targets import targets
from assur.planner.checker.tilt import straight
from assur.planner.checker.verdict import Code, Finding, Verdict
from assur.planner.checker.window import windows
from assur.planner.model.digest import digest
from assur.planner.model.outcome import Plan
from assur.planner.model.phases import Phase, phases
from assur.planner.model.scene import Scene


@np.errstate(all="ignore")
def check(scene: Scene, plan: Plan) -> Verdict:
    """Whether `plan` does what `scene` asks and is proved to, from both alone (docs/guarantees.md).

    A plan that is no plan gets findings, not exceptions. Not checked: that the plan is good; that a Cartesian leg is
    straight (that pitch and roll go along with it is); the working mode and the singularity margin, which are manners
    of planning and endanger nothing here.
    """
    malformed = form(scene, plan)
    if malformed:
        return Verdict.of(malformed)
    knots, certificate = plan.trajectory, plan.certificate
    findings = []
    if digest(scene.digest, knots, plan.legs, plan.arrivals, certificate) != certificate.digest:
        findings.append(Finding(Code.DIGEST, "request, plan and certificate do not belong together"))
    line = spline(knots.time, knots.q, knots.qd, knots.qdd)
    swept = ranges(line, scene.robot.rate_matrix)
    findings += limits(scene, line) + ends(scene, swept)
    broken = loops(scene, swept)
    if broken:
        # Where a chain does not assemble its bodies are nowhere: of them nothing more can be said.
        return Verdict.of(findings + broken)
    disorder = legs(scene, plan.legs, swept)
    if disorder:
        # Who is solid against whom follows from the legs: with others than the task's, nothing more can be said.
        return Verdict.of(findings + disorder)
    goals = targets(scene, plan.arrivals)
    findings += meetings(scene, line, plan.legs, plan.arrivals, goals) + arches(scene, line, plan.legs)
    findings += blends(scene, line, plan.arrivals, goals)
    findings += windows(scene, plan.arrivals, goals) + glued(scene, swept, plan.legs, goals)
    findings += straight(scene, swept, plan.legs, plan.arrivals)
    of_plan = phases(scene, plan.legs, plan.arrivals)
    findings += carried(scene, line, of_plan)
    scenery = stage(scene, solids(scene), of_plan)
    findings += _known(scenery, of_plan) + _apart(scenery, of_plan, plan, swept)
    return Verdict.of(findings)


def _apart(scenery: Stage, of_plan: tuple[Phase, ...], plan: Plan, swept: Ranges) -> list[Finding]:
    """Separation: true rows that prove what is required, for every asked pair, over the whole of every phase."""
    rows, senseless = sorted_out(scenery, of_plan, plan.certificate)
    pairs, alone = rows.some(rows.second >= 0), rows.some(rows.second < 0)
    spare, untrue = spare_of(scenery, of_plan, plan.certificate, pairs, swept)
    least, false = spare_of(scenery, of_plan, plan.certificate, alone, swept)
    behind = planes(of_plan, alone, plan.certificate.normal[alone.number], least)
    holes = uncovered(scenery, of_plan, pairs.some(spare > -np.inf), behind)
    return senseless + untrue + false + holes + enclosed(scenery, of_plan, swept)


def _known(scenery: Stage, of_plan: tuple[Phase, ...]) -> list[Finding]:
    """Every frame that bears a body or guides the tool must be known for as long as it does."""
    scene, findings = scenery.scene, []
    late = scene.execution.start_tolerance_s
    for k, (name, frame) in enumerate(scene.frames.items(), start=scenery.links):
        first, last = frame.law.valid
        for i, phase in enumerate(of_plan):
            needed = (scenery.carrier[scenery.seat[i]] == k).any() or phase.glued == name
            if needed and not (first <= phase.t0 and phase.t1 + late <= last):
                missing = max(first - phase.t0, phase.t1 + late - last)
                what = f"the motion of {name} is not known long enough"
                findings.append(Finding(Code.LAW_ENDS, what, missing, "s", f"{phase.kind} of step {phase.step}"))
                break
    return findings
