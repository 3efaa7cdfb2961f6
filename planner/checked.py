"""The check of a plan: its claim is filled, and both checkers judge it.

The claim checker shows that what the claim states is true, the statement checker that this is what request and answer
require. Neither trusts the writer of the claim, who is no part of `checker`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from assur.planner.checker.claim.verdict import ClaimFinding, check_claim
from assur.planner.checker.statement import Given, Handling, state_cell, state_legs, state_plan
from assur.planner.checker.statement.differences import at
from assur.planner.checker.verdict import Code, Finding, Verdict
from assur.planner.claim import columns as c
from assur.planner.claim.answer import with_answer
from assur.planner.claim.columns import Claim
from assur.planner.claim.document import labels_of
from assur.planner.claim.filling import SceneClaim, claim_of, with_plan
from assur.planner.claim.frames import early_of
from assur.planner.errors import InputError
from assur.planner.geometry.containment import nothing
from assur.planner.model.claims import NOTHING, Claims
from assur.planner.model.outcome import Arrival, Leg, Plan, covered
from assur.planner.model.phases import Phase, phases
from assur.planner.model.scene import Scene


@dataclass(eq=False)
class StatedScene:
    """The claim of a scene. `given`: what the statement checker derives of the cell alone; `is_stated`: it has no
    difference in that."""

    base: SceneClaim
    given: Given
    is_stated: bool = False


def _none_yet(_: Scene) -> list[StatedScene]:
    """The scene of a cell that was checked last: a search has many plans for one scene checked."""
    return []


def stated_scene(scene: Scene) -> StatedScene:
    """The claim of a scene; what it states of its cell is kept from the scene before, if that had the same cell, and
    the same distances and execution. Raises `InputError` for what no claim can state."""
    kept = scene.kept.of(_none_yet, scene, scene.options.clearance, scene.execution)
    last = next(iter(kept), None)  # once: another thread may keep another one meanwhile
    if last is not None and last.base.scene is scene:
        return last
    known = last if last is not None and early_of(scene) >= last.base.cell.early else None
    if known is None:
        stated = StatedScene(claim_of(scene), Given(scene))
    else:
        stated = StatedScene(claim_of(scene, known.base.cell), known.given, known.is_stated)
    kept[:] = [stated]
    return stated


@np.errstate(all="ignore")
def check(scene: Scene, plan: Plan, claims: Claims = NOTHING, between: Callable[[], None] = nothing) -> Verdict:
    """Whether `plan` does what `scene` asks and is proved to, from both alone (docs/guarantees.md), and whether what
    else is stated of it is so (`claims`).

    `between` is called between blocks of work, for a caller who has no time for all of it: what it raises is raised
    here, and there is no verdict then. A plan of another task or robot gets findings, not exceptions. Not checked: that
    the plan is good.
    """
    try:
        stated = stated_scene(scene)
    except InputError as error:
        return Verdict.of([Finding(Code.FORM, str(error))])
    handling = Handling(scene, plan, stated.given)
    strange = _strange(scene, plan, handling.bodies)
    if strange:
        return Verdict.of(strange)
    of_legs = state_legs(handling)
    if any(each.code is not Code.DIGEST for each in of_legs):
        return Verdict.of(of_legs)  # who holds what follows from the legs: with others, nothing can be shown
    between()
    of_plan = phases(scene, plan.legs, plan.arrivals)
    return Verdict.of(of_legs + _judged(stated, handling, of_plan, claims, between, has_task=True))


def check_motion(scene: Scene, plan: Plan, of_motion: tuple[Phase, ...]) -> Verdict:
    """Whether a motion that has no task keeps limits and keeps everything apart. `plan` has one leg, in travel, and no
    arrivals; `of_motion`: its phases."""
    try:
        stated = stated_scene(scene)
    except InputError as error:
        return Verdict.of([Finding(Code.FORM, str(error))])
    handling = Handling(scene, plan, stated.given)
    return Verdict.of(_judged(stated, handling, of_motion, NOTHING, nothing, has_task=False))


def _judged(
    stated: StatedScene,
    handling: Handling,
    of_plan: tuple[Phase, ...],
    claims: Claims,
    between: Callable[[], None],
    *,
    has_task: bool,
) -> list[Finding]:
    """What both checkers find in the claim of a plan with these phases, and of an answer."""
    base, plan = stated.base, handling.plan
    try:
        claim = with_plan(base, plan, of_plan)
        if claims is not NOTHING:
            claim = with_answer(base, claim, plan, of_plan, claims)
    except InputError as error:
        return [Finding(Code.FORM, str(error))]
    between()
    findings = _unshown(base, plan, of_plan, claims, claim)
    if any(finding.code == Code.FORM for finding in findings):
        return findings  # the statement checker reads only tables that are those of a claim
    between()
    different = [] if stated.is_stated else state_cell(base.scene, claim)
    stated.is_stated = not different
    return findings + (different or state_plan(handling, claim, claims, has_task=has_task))


def _unshown(base: SceneClaim, plan: Plan, of_plan: tuple[Phase, ...], claims: Claims, claim: Claim) -> list[Finding]:
    """What the claim checker does not show, with names in place of numbers."""
    verdict, scene = check_claim(claim), base.scene
    if verdict.accepted:
        return []
    names: dict[str, Sequence[str]] = labels_of(base, plan, of_plan, claims)._asdict()
    names["joints"] = [f"joint {joint.name}" for joint in scene.robot.joints]
    names["phases"] = [f"phase {kind}" for kind in names["phases"]]
    steps = [(leg.t0, leg.t1, scene.task[leg.step].name) for leg in plan.legs if leg.step < len(scene.task)]
    found = [_named(each, names, steps) for each in verdict.findings]
    end = max([phase.t1 for phase in of_plan])
    if end > c.LATEST_S:
        until = f"is stated until {c.LATEST_S:,.0f} s only, and the plan ends at {end:,.1f} s"
        ends = (claim.frames[:, c.FRAME_ARM] >= 0.0) | (claim.frames[:, c.FRAME_PIECES] > 0.0)
        ends &= claim.frames[:, c.FRAME_PERIOD] == 0.0
        late = [Finding(Code.LAW, f"the motion of {names['frames'][f]} {until}") for f in np.flatnonzero(ends).tolist()]
        found = late[:1] + found
    return found


PLANE = "what never moves"
"""In place of a second body: the row is about a plane."""
UNIT = 1e-9
"""By how much the length of a normal may differ from 1: rounding."""


def _named(
    finding: ClaimFinding, names: Mapping[str, Sequence[str]], steps: Sequence[tuple[float, float, str]]
) -> Finding:
    """A finding of the claim checker, with names of its row and its bodies. A row that has no name is called after the
    step to which its time belongs. `steps`: from when to when, s, and the name."""
    own, row, when = names.get(finding.table, ()), "", finding.when
    if finding.table in ("rows", "gap_rows"):
        row = f"row {finding.row}"
    elif 0 <= finding.row < len(own):
        row = own[finding.row]
    elif finding.table and finding.table not in names:
        row = next((name for t0, t1, name in steps if t0 <= when <= t1), "")
    bodies = " and ".join(names["bodies"][k] if k >= 0 else PLANE for k in finding.bodies)
    about = ", ".join(filter(None, (row, bodies)))
    what, amount = f"{about}: {finding.what}" if about else finding.what, finding.amount
    where = "" if math.isnan(when) else at(when)
    return Finding(finding.code, what, amount, "" if math.isnan(amount) else "m", where)


def _strange(scene: Scene, plan: Plan, bodies: Collection[str]) -> list[Finding]:
    """Findings about a plan that is none for this robot and task, so that nothing after has to ask. `bodies`: the names
    of all bodies."""
    findings = []
    knots, n, names = plan.trajectory, len(scene.robot.joints), plan.certificate.names
    if knots.n != n:
        findings.append(Finding(Code.FORM, f"knots of {knots.n} joints, the robot has {n}"))
    if knots.jumps is not (not scene.options.jerk_limited):
        what = f"jumps in acceleration are stated as {knots.jumps}, the timing is {scene.options.timing}"
        findings.append(Finding(Code.FORM, what))
    if plan.certificate.covers != covered(knots):
        what = f"the certificate must say that it covers {', '.join(covered(knots))}"
        findings.append(Finding(Code.FORM, what))
    for arrival in plan.arrivals:
        if arrival.missed_by is not None and len(arrival.missed_by.joints) != n:
            findings.append(Finding(Code.FORM, f"the miss of {arrival.control_point} must be of {n} joints"))
    parts: tuple[Leg | Arrival, ...] = (*plan.legs, *plan.arrivals)
    for part in parts:
        if not part.step < len(scene.task):
            what = f"a plan with {type(part).__name__.lower()}s of step {part.step}, which the task has not"
            findings.append(Finding(Code.FORM, what))
    unknown = [name for name in names if name not in bodies]
    if unknown:
        findings.append(Finding(Code.ROW, f"the certificate names a body that there is not: {unknown[0]!r:.60}"))
    found, named = plan.certificate, {*range(len(names))}
    for column, numbers in ((found.first, named), (found.second, named | {-1})):
        if not numbers.issuperset(column.tolist()):
            row = int(np.argmin(np.isin(column, list(numbers))))
            findings.append(Finding(Code.ROW, f"row {row} of the certificate is about a body that it does not name"))
    units = np.abs(np.sqrt(np.vecdot(found.normal, found.normal)) - 1.0) <= UNIT
    if not units.all():
        row = int(np.argmin(units))
        findings.append(Finding(Code.ROW, f"the normal of row {row} of the certificate is no unit vector"))
    return findings
