"""The check of a plan: its claim is filled, and both checkers judge it.

The claim checker shows that what the claim states is true, the statement checker that this is what request and answer
require. Neither trusts the writer of the claim, who is no part of `checker`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from assur.planner.checker.claim.verdict import ClaimFinding, check_claim
from assur.planner.checker.statement import Difference, state_answer, state_cell, state_legs, state_plan
from assur.planner.checker.verdict import Code, Finding, Verdict
from assur.planner.claim.answer import with_answer
from assur.planner.claim.columns import Claim
from assur.planner.claim.filling import SceneClaim, claim_of, with_plan
from assur.planner.claim.labels import labels_of
from assur.planner.errors import InputError
from assur.planner.geometry.containment import nothing
from assur.planner.model.claims import NOTHING, Claims
from assur.planner.model.outcome import Plan, covered
from assur.planner.model.phases import Phase, phases
from assur.planner.model.scene import Scene


@dataclass(eq=False)
class KeptCell:
    """The claim of a scene whose cell is kept. `is_stated`: the statement checker has no difference in what depends on
    the cell alone."""

    base: SceneClaim
    is_stated: bool = False

    def fits(self, scene: Scene) -> bool:
        """Whether the cell of a scene is this one: made of the same objects, and claimed from as early on."""
        own = self.base.scene
        return (
            all(one is other for one, other in zip(_facts(own), _facts(scene), strict=True))
            and scene.start.time >= own.start.time
        )


def _facts(scene: Scene) -> tuple[object, ...]:
    """Objects from which all follows that a claim states of a cell."""
    return scene.robot, scene.tool, scene.frames, scene.bodies, scene.options.clearance, scene.execution


_last: list[KeptCell] = []
"""The cell of the scene that was checked last: a search has many plans for one scene checked."""


def kept_cell(scene: Scene) -> KeptCell:
    """The cell of a scene, kept from the check before if that was of the same cell. Raises `InputError` for what no
    claim can state."""
    kept = _last[0] if _last and _last[0].fits(scene) else None
    if kept is None or kept.base.scene is not scene:
        base = claim_of(scene, None if kept is None else kept.base.cell)
        _last[:] = [KeptCell(base, is_stated=kept is not None and kept.is_stated)]
    return _last[0]


@np.errstate(all="ignore")
def check(scene: Scene, plan: Plan, claims: Claims = NOTHING, between: Callable[[], None] = nothing) -> Verdict:
    """Whether `plan` does what `scene` asks and is proved to, from both alone (docs/guarantees.md), and whether what
    else is stated of it is so (`claims`).

    `between` is called between blocks of work, for a caller who has no time for all of it: what it raises is raised
    here, and there is no verdict then. A plan of another task or robot gets findings, not exceptions. Not checked: that
    the plan is good.
    """
    strange = _strange(scene, plan)
    if strange:
        return Verdict.of(strange)
    different = state_legs(scene, plan)
    if different:  # who holds what follows from the legs: with others than the task's, nothing more can be shown
        return Verdict.of(_found(different))
    between()
    try:
        kept = kept_cell(scene)
        of_plan = phases(scene, plan.legs, plan.arrivals)
        claim = with_plan(kept.base, plan, of_plan)
        if claims is not NOTHING:
            claim = with_answer(kept.base, claim, plan, of_plan, claims)
    except InputError as error:
        return Verdict.of([Finding(Code.FORM, str(error))])
    between()
    findings = _unshown(kept.base, plan, of_plan, claim)
    if any(finding.code == Code.FORM for finding in findings):
        return Verdict.of(findings)  # the statement checker reads the tables of a claim that has its form
    between()
    different = [] if kept.is_stated else state_cell(scene, claim)
    kept.is_stated = not different
    if not different:
        different = state_plan(scene, plan, claim)
    if not different and claims is not NOTHING:
        different = state_answer(scene, plan, claims, claim)
    return Verdict.of(findings + _found(different))


def _unshown(base: SceneClaim, plan: Plan, of_plan: tuple[Phase, ...], claim: Claim) -> list[Finding]:
    """What the claim checker does not show, with names in place of numbers."""
    verdict = check_claim(claim)
    if verdict.accepted:
        return []
    labels: dict[str, Sequence[str]] = labels_of(base, plan, of_plan)._asdict()
    labels["joints"] = [joint.name for joint in base.scene.robot.joints]
    return [_named(each, labels) for each in verdict.findings]


NUMBERS = re.compile(r"(joint|body|phase|number|bodies) (-?\d+)(?: and (-?\d+))?")
"""How the claim checker names rows of a claim."""
NAMED = {
    "joint": "joints",
    "body": "bodies",
    "bodies": "bodies",
    "phase": "phases",
    "POINT": "points",
    "RATE": "rates",
    "DIRECTION": "axes",
}
"""By a word before a number, or a code: the names that are numbered."""
PLANE = "what stands"
"""In place of a second body: the row is about a plane."""


def _named(finding: ClaimFinding, labels: Mapping[str, Sequence[str]]) -> Finding:
    """A finding of the claim checker, with names in place of numbers."""

    def named(match: re.Match[str]) -> str:
        word, *numbers = match.groups()
        names = labels.get(NAMED.get(finding.code if word == "number" else word, ""), ())
        known = [PLANE if k == "-1" else names[int(k)] if int(k) < len(names) else k for k in numbers if k is not None]
        return f"{'' if word in ('number', 'body', 'bodies') else word + ' '}{' and '.join(known)}"

    where = "" if math.isnan(finding.when) else _at(finding.when)
    return Finding(_code(finding.code), NUMBERS.sub(named, finding.what), where=where)


def _found(differences: Iterable[Difference]) -> list[Finding]:
    """What a claim does not state, as findings."""
    found = []
    for each in differences:
        where = ""
        if each.when is not None:
            t0, t1 = each.when
            where = _at(t0) if t0 == t1 else f"{_at(t0)} to {_at(t1)}"
        found.append(Finding(_code(each.topic), each.what, where=where))
    return found


def _at(time: float) -> str:
    return f"{time:.6g} s"


RENAMED = {
    "AXIS": Code.DIRECTION,
    "FAULT": Code.FORM,
    "KNOTS": Code.MOTION,
    "MARGIN": Code.SINGULARITY,
    "MODE": Code.ELBOW,
    "NEARNESS": Code.NEAREST,
    "PARABOLA": Code.BLEND,
    "PHASES": Code.PHASE,
    "SUM": Code.JOINTS,
    "WITHIN": Code.CONTAINMENT,
}
"""What both checkers call otherwise than a verdict does."""


def _code(name: str) -> Code:
    return RENAMED.get(name) or Code(name)


def _strange(scene: Scene, plan: Plan) -> list[Finding]:
    """Findings about a plan that is none for this robot and task, so that nothing after has to ask."""
    findings = []
    knots, n, names = plan.trajectory, len(scene.robot.joints), plan.certificate.names
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
    bodies = {
        *scene.index,
        *(item.body.name for item in scene.robot.bodies),
        *(body.name for body in scene.tool.bodies),
    }
    unknown = [name for name in names if name not in bodies]
    if unknown:
        findings.append(Finding(Code.ROW, f"the certificate names a body that there is not: {unknown[0]!r:.60}"))
    return findings
