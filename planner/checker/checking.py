"""The story of a check: a plan is right only if everything that was promised is shown to hold.

It trusts request and facts (shapes, numbers of robots and laws), and nobody who makes plans.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from assur.planner.checker.accuracy import accuracies
from assur.planner.checker.claims.joints import peaks
from assur.planner.checker.claims.options import modes, options
from assur.planner.checker.claims.singular import singular
from assur.planner.checker.claims.tool import tool
from assur.planner.checker.claims.touching import distances
from assur.planner.checker.enclosure import enclosed
from assur.planner.checker.laws import rounding
from assur.planner.checker.legs import TIME_S, ends, order
from assur.planner.checker.limits import corrected, limits, loads
from assur.planner.checker.meeting import meetings
from assur.planner.checker.nearest import claimed, nearest, pairs
from assur.planner.checker.passed import passed
from assur.planner.checker.paths.following import traced
from assur.planner.checker.paths.straight_way import straight_ways
from assur.planner.checker.rows import Apart
from assur.planner.checker.separation import SLACK_M
from assur.planner.checker.solids import ARM_FLAT, BODY, CARRIER, CENTRE, FIRST, Solids, solids
from assur.planner.checker.targets import targets
from assur.planner.checker.tracking import arches, assembled, pulled, straight, tracked, turned_into
from assur.planner.checker.verdict import Code, Finding, Verdict
from assur.planner.checker.world import World
from assur.planner.geometry.containment import nothing
from assur.planner.laws import ALWAYS
from assur.planner.model.claims import NOTHING, Claims
from assur.planner.model.digest import digest
from assur.planner.model.outcome import Contact, Plan, covered
from assur.planner.model.phases import Phase, phases
from assur.planner.model.scene import Scene

ROUNDED_M = 0.4 * SLACK_M
"""What rounding of a frame's law may add to a place, m: two frames may meet, and gaps and links round by 1e-13 m."""


@np.errstate(all="ignore")
def check(scene: Scene, plan: Plan, claims: Claims = NOTHING, between: Callable[[], None] = nothing) -> Verdict:
    """Whether `plan` does what `scene` asks and is proved to, from both alone (docs/guarantees.md), and whether what
    else is said of it is so (`claims`).

    `between` is called between blocks of work, for a caller who has no time for all of it: what it raises is raised
    here, and there is no verdict then.

    A plan of another task or robot gets findings, not exceptions. Not checked: that the plan is good.
    """
    knots, certificate = plan.trajectory, plan.certificate
    strange = _strange(scene, plan)
    if strange:
        return Verdict.of(strange)
    findings = []
    if digest(scene.digest, knots, plan.legs, plan.arrivals, certificate) != certificate.digest:
        findings.append(Finding(Code.DIGEST, "request, plan and certificate do not belong together"))
    world = World(scene, plan)
    between()
    findings += limits(world) + ends(world)
    broken = assembled(world)
    if broken:
        # Where a chain does not assemble its bodies are nowhere: of them nothing more can be said.
        return Verdict.of(findings + broken)
    disorder = order(world, plan.legs)
    if disorder:
        # Who is solid against whom follows from the legs: with others than the task's, nothing more can be said.
        return Verdict.of(findings + disorder)
    between()
    goals = targets(scene, plan.arrivals)
    findings += meetings(world, plan.legs, plan.arrivals, goals) + arches(world, plan.legs)
    findings += passed(world, plan.arrivals, goals) + tracked(world, plan.legs, goals)
    between()
    findings += traced(world, plan.legs, plan.arrivals, goals)
    findings += straight(world, plan.legs, plan.arrivals) + straight_ways(world, plan.legs, plan.arrivals, goals)
    findings += options(world, plan.legs, plan.arrivals, goals)
    of_plan = phases(scene, plan.legs, plan.arrivals)
    findings += loads(world, of_plan, claims.carried)
    findings += accuracies(world, plan.arrivals, goals, of_plan)
    findings += pulled(world, of_plan) + turned_into(world)
    between()
    table = solids(scene, of_plan)
    findings += corrected(world, of_plan, table)
    apart = Apart.of(scene, of_plan, table, world.tables)
    unknown = [name for name in certificate.names if name not in table.number]
    if unknown:
        findings.append(Finding(Code.ROW, f"the certificate names a body that there is not: {unknown[0]!r:.60}"))
    between()
    apart_findings, against = apart.found(certificate, claimed(claims), between)
    findings += _known(world, table, of_plan) + apart_findings + enclosed(world, apart, between)
    findings += nearest(apart, claims, against) + pairs(apart, claims.pairs) + _touching(of_plan, claims.contacts)
    between()
    findings += distances(apart, scene, plan.arrivals)
    findings += peaks(world, of_plan, claims.peaks) + tool(world, of_plan, claims) + singular(world, claims)
    return Verdict.of(findings + modes(world, plan.arrivals, claims.modes))


def _touching(phases: tuple[Phase, ...], said: tuple[Contact, ...] | None) -> list[Finding]:
    """A finding if the contacts that are said are not those that the legs allow, each for as long as it lasts."""
    if said is None:
        return []
    own: dict[tuple[str, ...], list[list[float]]] = {}
    for phase in phases:
        for bodies in phase.contacts:
            spans = own.setdefault(tuple(sorted(bodies)), [])
            if spans and phase.t0 - spans[-1][1] <= TIME_S:
                spans[-1][1] = phase.t1
            else:
                spans.append([phase.t0, phase.t1])
    true = sorted((bodies, t0, t1) for bodies, spans in own.items() for t0, t1 in spans)
    told = sorted((tuple(sorted(each.bodies)), each.t0, each.t1) for each in said)
    if [each[0] for each in true] == [each[0] for each in told]:
        times = [(one[1:], other[1:]) for one, other in zip(true, told, strict=True)]
        off = max((abs(a - b) for one, other in times for a, b in zip(one, other, strict=True)), default=0.0)
        if off <= TIME_S:
            return []
    allowed = "; ".join(f"{' and '.join(bodies)} from {t0:.6g} s to {t1:.6g} s" for bodies, t0, t1 in true) or "none"
    return [Finding(Code.CLAIM, f"the contacts are not those that the legs allow: {allowed}", where="contacts")]


def _strange(scene: Scene, plan: Plan) -> list[Finding]:
    """Findings about a plan that is none for this robot and task, so that nothing after has to ask."""
    findings = []
    knots, n = plan.trajectory, len(scene.robot.joints)
    if knots.n != n:
        findings.append(Finding(Code.FORM, f"knots of {knots.n} joints, the robot has {n}"))
    if knots.jumps is not (not scene.options.jerk_limited):
        what = f"jumps in acceleration are said to be {knots.jumps}, the timing is {scene.options.timing}"
        findings.append(Finding(Code.FORM, what))
    if plan.certificate.covers != covered(knots):
        what = f"the certificate must say that it covers {', '.join(covered(knots))}"
        findings.append(Finding(Code.FORM, what))
    for arrival in plan.arrivals:
        if arrival.missed_by is not None and len(arrival.missed_by.joints) != n:
            findings.append(Finding(Code.FORM, f"the miss of {arrival.control_point} must be of {n} joints"))
    steps = [("leg", leg.step) for leg in plan.legs] + [("arrival", arrival.step) for arrival in plan.arrivals]
    for what, step in steps:
        if not step < len(scene.task):
            findings.append(Finding(Code.FORM, f"a plan with {what}s of step {step}, which the task has not"))
    return findings


def _rounded(world: World, table: Solids) -> list[Finding]:
    """Every frame that bears a body must be known so well that rounding is within what is kept for it (`SLACK_M`)."""
    reaches = np.zeros(world.links + len(world.frame))
    boxes = table.table[table.seats[:, FIRST] + table.count[table.seats[:, BODY]]]
    far = np.hypot(boxes[:, CENTRE], boxes[:, CENTRE + 1]) + boxes[:, ARM_FLAT]
    np.maximum.at(reaches, table.seats[:, CARRIER], far)
    bears = np.isin(np.arange(len(reaches)), table.seats[:, CARRIER])[world.links :]
    found = np.where(bears, rounding(world.tables, reaches[world.links :], world.start, world.until), 0.0)
    return [
        Finding(Code.LAW_ENDS, f"places on {name} round by more than is kept for it", float(amount), "m", "rounding")
        for name, amount in zip(world.frame, found.tolist(), strict=True)
        if not amount <= ROUNDED_M
    ]


def _known(world: World, table: Solids, of_plan: tuple[Phase, ...]) -> list[Finding]:
    """Every frame that bears a body or guides the tool must be known for as long as it does."""
    scene = world.scene
    findings, late = _rounded(world, table), scene.execution.start_tolerance_s
    carriers = table.seats[table.seat, CARRIER]
    for k, (name, frame) in enumerate(scene.frames.items(), start=table.links):
        first, last = frame.law.valid
        if (first, last) == ALWAYS:
            continue
        for i, phase in enumerate(of_plan):
            needed = phase.tracked == name or (carriers[i] == k).any()
            if needed and not (first <= phase.t0 and phase.t1 + late <= last):
                missing = max(first - phase.t0, phase.t1 + late - last)
                what = f"the motion of {name} is not known long enough"
                findings.append(Finding(Code.LAW_ENDS, what, missing, "s", f"{phase.kind}, {phase.t0:.6g} s"))
                break
    return findings
