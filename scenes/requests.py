"""The entry points of this package: what the service, the command line and Python call.

A request is a plain document (dict, list, str, float, int, bool; NumPy's numbers and arrays count as such). Whatever is
wrong with it is an `InputError` that names the field as it was written. Reading and building load no native library;
planning does.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal, get_args

from assur.planner.errors import InputError
from assur.planner.model.deadline import Deadline, OutOfTimeError
from assur.scenes.budgets import BUDGETS, silent, stated_budgets
from assur.scenes.catalogue import RobotFile, load_robot, models, robots, shipped_robot, with_robots
from assur.scenes.faults import DocumentError, located, together, written_key
from assur.scenes.files import with_meshes, with_plans
from assur.scenes.json_schemas import KINDS, Kind, ik_schema, request_schema, schema_of
from assur.scenes.not_requests import refuse_other
from assur.scenes.scenario import Scenario
from assur.scenes.scenarios import load_scenario, shipped, shipped_scenarios, unmet
from assur.scenes.schema.answer import Verdict
from assur.scenes.schema.normal import plain
from assur.scenes.schema.read import read, read_fields
from assur.scenes.schema.request import AROUND, RequestDocument
from assur.scenes.text.json_text import parse_json
from assur.scenes.units import si_key

if TYPE_CHECKING:
    from assur.planner.checker.verdict import Finding
    from assur.planner.model.claims import Claims
    from assur.planner.model.deadline import Stopwatch, Watch
    from assur.planner.model.outcome import Plan
    from assur.planner.model.scene import Scene
    from assur.scenes.reading.cell import Cell, Kept
    from assur.scenes.tasks.kept_cell import TaskOfCell

__all__ = [
    "BUDGETS",
    "KINDS",
    "Kind",
    "RobotFile",
    "Scenario",
    "assumptions_of",
    "cell_of",
    "check_cell",
    "check_document",
    "check_plan",
    "ik_cell",
    "ik_document",
    "ik_schema",
    "load_robot",
    "load_scenario",
    "models",
    "parse_json",
    "plan_cell",
    "plan_document",
    "plan_scenario",
    "read_plan",
    "report_page",
    "request_digest",
    "request_schema",
    "robots",
    "scene_of",
    "schema_of",
    "shipped",
    "shipped_robot",
    "shipped_scenarios",
    "stated_budgets",
    "unmet",
    "validate",
    "view_document",
    "with_options",
]

Valid = Callable[[RequestDocument], None]
Detail = Literal["full", "digest"]
"""How much of its certificate an answer has: the whole table of the proof, or its digest and size."""


def validate(document: object) -> RequestDocument:
    """The request in SI, its shape and units checked. Names are looked up, and meshes read, when a scene is built."""
    refuse_other(document)
    request: RequestDocument = read(RequestDocument, document)
    return request


def request_digest(document: object) -> str:
    """SHA-256 of the request in SI with every default written out: the same for requests that mean the same."""
    return validate(document).digest


def cell_of(
    document: object,
    *,
    folder: Path | None = None,
    valid: Valid | None = None,
    laps: Stopwatch | None = None,
    task: TaskOfCell | None = None,
) -> Cell:
    """Scene and joint conventions of a request. `folder`: below which it may name files (never over HTTP). `valid` is
    given the request before it is built; what it raises is raised here. `laps` measures the stages `read` and `build`.
    `task`: the request is that of this task in a cell that is kept."""
    from assur.scenes.reading.cell import cell_of as build

    written, request = _accepted(document, folder, valid, laps, task)
    cell = build(written, request, None if task is None else task.around(request))
    if laps is not None:
        laps.lap("build")
    return cell


def changed_cell(document: dict[str, Any], request: RequestDocument, changes: dict[str, Any], own: Kept) -> Cell:
    """The cell of a valid request whose document has the fields of `changes` in place of its own. Only these are read
    again; `own` keeps robot and surroundings, if these are not among them. Raises `InputError` naming the field."""
    from assur.scenes.reading.cell import cell_of as build

    written = {**document, **changes}
    if not changes.keys() <= RequestDocument.model_fields.keys():
        return build(written, validate(written))
    changed = request.changed(read_fields(RequestDocument, changes))
    return build(written, changed, own if AROUND.isdisjoint(changes) else None)


def _accepted(
    document: object, folder: Path | None, valid: Valid | None, laps: Stopwatch | None, task: TaskOfCell | None
) -> tuple[object, RequestDocument]:
    """A request as it was written, with the files that it names in place of their names, and the same in SI."""
    from assur.scenes.reading.partly import other_faults

    # Errors quote the document as it was written: a mesh's file, not the bytes that took its place.
    written = document if folder is None else with_plans(with_robots(document, folder), folder)
    request = None if task is None else task.read()
    if request is None:
        try:
            request = validate(written if folder is None else with_meshes(written, folder))
        except DocumentError as error:
            raise together([error, *other_faults(written, folder)]) from error
    if laps is not None:
        laps.lap("read")
    if valid is not None:
        valid(request)
    return written, request


def scene_of(document: object, *, folder: Path | None = None) -> Scene:
    """The planner's scene of a request. Raises `InputError` naming the field."""
    return cell_of(document, folder=folder).scene


def assumptions_of(document: object) -> list[str]:
    """Every number of a request that is estimated or second hand, in words, as its answer states it. Raises
    `InputError` naming the field."""
    from assur.planner.report.straight_parts import assumed

    return list(assumed(scene_of(document)))


def plan_document(
    document: object,
    *,
    folder: Path | None = None,
    certificate: Detail = "full",
    started: float | None = None,
    most_budget_s: float | None = None,
    watch: Watch | None = None,
    valid: Valid | None = None,
    laps: Stopwatch | None = None,
    task: TaskOfCell | None = None,
) -> dict[str, Any]:
    """The answer to a request: planned, or not planned and why. Raises `InputError` naming the field.

    `started`: the reading of `time.perf_counter` from which the budget counts. A service gives the time at which it
    took the request up, so that reading it and building the scene count, too, and a budget that ends there is an
    answer; None: the budget is for the search alone. `most_budget_s`: largest budget of either kind, to which a larger
    one is cut; None: there is none. `watch` gets the progress of the search; what it raises ends the planning and
    is raised here. `valid`, `task`: as `cell_of`; `laps` measures the stages.
    """
    if started is None:
        cell = cell_of(document, folder=folder, valid=valid, laps=laps, task=task)
        return plan_cell(cell, certificate=certificate, most_budget_s=most_budget_s, watch=watch, laps=laps)
    from assur.scenes.answer import unbuilt
    from assur.scenes.reading.cell import cell_of as build

    written, request = _accepted(document, folder, valid, laps, task)
    budget_s = request.options.budget_s if most_budget_s is None else min(request.options.budget_s, most_budget_s)
    try:
        with Deadline(started, budget_s):
            cell = build(written, request, None if task is None else task.around(request))
    except OutOfTimeError as late:
        return dict(unbuilt(request, budget_s, time.perf_counter() - started, str(late)))
    finally:
        if laps is not None:
            laps.lap("build")
    return plan_cell(
        cell, certificate=certificate, started=started, most_budget_s=most_budget_s, watch=watch, laps=laps
    )


def plan_cell(
    cell: Cell,
    *,
    certificate: Detail = "full",
    started: float | None = None,
    unstated: Mapping[str, object] = MappingProxyType({}),
    most_budget_s: float | None = None,
    watch: Watch | None = None,
    laps: Stopwatch | None = None,
) -> dict[str, Any]:
    """The answer for a cell that has been read; as `plan_document`.

    `unstated`: values of options in SI, by their names, for a request that does not state them, in place of the
    defaults of requests.
    """
    if certificate not in get_args(Detail):
        raise InputError("certificate", certificate, " or ".join(get_args(Detail)))
    from assur.planner.pipeline import plan
    from assur.scenes.answer import answer_of

    changed: dict[str, Any] = {name: value for name, value in unstated.items() if silent(cell.document, name)}
    if most_budget_s is not None:
        for name in BUDGETS:
            changed[name] = min(changed.get(name, getattr(cell.scene.options, name)), most_budget_s)
    if changed:
        cell = replace(cell, scene=replace(cell.scene, options=replace(cell.scene.options, **changed)))
    with located(cell.document):
        outcome = plan(cell.scene, started=started, watch=watch, laps=laps)
    return dict(answer_of(cell, outcome, certificate))


def plan_scenario(
    scenario: Scenario,
    *,
    certificate: Detail = "full",
    started: float | None = None,
    most_budget_s: float | None = None,
    watch: Watch | None = None,
    valid: Valid | None = None,
    laps: Stopwatch | None = None,
) -> dict[str, Any]:
    """The answer to a scenario's request; as `plan_document`. Raises `InputError` with the line in the file."""
    with scenario.located():
        answer = plan_document(
            scenario.request,
            folder=scenario.folder,
            certificate=certificate,
            started=started,
            most_budget_s=most_budget_s,
            watch=watch,
            valid=valid,
            laps=laps,
        )
    return scenario.answered(answer)


def with_options(request: dict[str, Any], options: dict[str, Any]) -> dict[str, Any]:
    """A request whose options are `options`, and its own where these are silent, in whichever unit."""
    own = request.get("options") or {}
    kept = {key: value for key, value in own.items() if written_key(options, _in_si(key)) is None}
    return {**request, "options": {**kept, **options}}


def _in_si(key: str) -> str:
    twin = si_key(key)
    return key if twin is None else twin[0]


def check_document(request: object, plan: object, *, folder: Path | None = None) -> dict[str, Any]:
    """The checker's verdict on an answer: on a plan with its certificate in full, or on a refusal. Raises `InputError`
    naming the field."""
    return check_cell(cell_of(request, folder=folder), plan)


def check_cell(cell: Cell, answer: object) -> dict[str, Any]:
    """The verdict on an answer to the request of a cell; as `check_document`."""
    return _check_refusal(cell, answer) if refused(answer) else check_plan(cell, *read_plan(cell, answer))


def refused(answer: object) -> bool:
    """Whether an answer says that there is no plan."""
    status = answer.get("status") if isinstance(answer, dict) else None
    return isinstance(status, str) and status == "not_planned"


def _check_refusal(cell: Cell, answer: object) -> dict[str, Any]:
    """The verdict on an answer without a plan: whether what it calls proved is proved, and what it repeats is true."""
    from assur.planner.checker.refusals.judging import check_refusal
    from assur.scenes.reading.refusal import refusal_of

    given = refusal_of(plain(answer), cell.scene)
    findings = given.findings
    if given.refusal is not None and given.proved:
        findings += check_refusal(cell.scene, given.refusal, given.witness).findings
    return _verdict(cell, findings, given.not_checked)


def view_document(request: object, plan: object, *, folder: Path | None = None) -> dict[str, Any]:
    """What a viewer plays of an answer: poses over time, meshes, curves (`docs/viewer.md`). What the answer says is not
    checked. Raises `InputError` naming the field."""
    from assur.scenes.view.document import view_of

    return dict(view_of(cell_of(request, folder=folder), plan))


def verdict_on(cell: Cell, answer: dict[str, Any]) -> dict[str, Any] | None:
    """What the checker says of an answer; None where there is nothing to check: a plan with the digest of its
    certificate. Raises `InputError` naming the field."""
    certificate = answer.get("certificate")
    if not refused(answer) and not (isinstance(certificate, dict) and "normal" in certificate):
        return None
    return check_cell(cell, answer)


def report_page(
    cell: Cell, answer: dict[str, Any], *, title: str, about: str = "", verdict: dict[str, Any] | None, version: str
) -> str:
    """The report of an answer to the request of a cell, a page of HTML that needs no network. `verdict`: of the checker
    (None: there is none). Raises `InputError` naming the field."""
    from assur.scenes.report.report import report_of

    return report_of(cell, answer, title=title, about=about, verdict=verdict, version=version)


def ik_document(request: object | None, question: object, *, folder: Path | None = None) -> dict[str, Any]:
    """The joint positions at a pose of the tool, or the pose at joints, as `question` asks (`docs/api.md`).

    `request`: the request whose robot, frames and bodies count; None: the question brings its robot.
    Raises `InputError` naming the field, of the request or of the question.
    """
    return ik_cell(None if request is None else cell_of(request, folder=folder), question)


def ik_cell(cell: Cell | None, question: object) -> dict[str, Any]:
    """The answer to a question about a cell that has been read; as `ik_document`."""
    from assur.scenes.inverse_kinematics import ik

    return dict(ik(cell, question))


def read_plan(cell: Cell, plan: object, *, proved_anew: bool = False) -> tuple[Plan, tuple[Finding, ...], Claims]:
    """The plan in a planned answer with a full certificate, what the answer says that is not so and needs no checker to
    see (what it repeats of the request among it), and what else it claims of the plan. `proved_anew`: as `plan_of`.

    Raises `InputError` naming the field.
    """
    from assur.scenes.reading.claims import claimed_in, claims_of, untrue_arrivals, untrue_repeats
    from assur.scenes.reading.plan import check_lengths, plan_of

    answer = plain(plan)
    claimed = claimed_in(answer)
    made, findings = plan_of(answer, cell.conventions, proved_anew=proved_anew)
    check_lengths(answer, made, cell.scene)
    findings += untrue_repeats(claimed, cell.scene) + untrue_arrivals(made.arrivals, cell.scene)
    return made, findings, claims_of(answer, claimed)


def check_plan(
    cell: Cell, made: Plan, findings: tuple[Finding, ...] = (), claims: Claims | None = None
) -> dict[str, Any]:
    """The checker's verdict on a plan that has been read, and on what is claimed of it (None: nothing is), with the
    lower bound computed again. `findings`: those that were made before, of the document."""
    from assur.planner.checked import check
    from assur.planner.model.claims import NOTHING
    from assur.scenes.reading.claims import untrue_bound, untrue_errors

    claims = claims or NOTHING
    verdict = check(cell.scene, made, claims)
    findings += verdict.findings + untrue_bound(claims.lower_bound, cell.scene, made.trajectory.duration)
    if verdict.ok:  # errors are those of a motion and of legs that are right
        findings += untrue_errors(made, cell.scene)
    return _verdict(cell, findings, claims.not_checked)


def _verdict(cell: Cell, found: tuple[Finding, ...], not_checked: Iterable[str]) -> dict[str, Any]:
    """A verdict with these findings, and the fields of the answer that were not checked."""
    from assur.scenes.answer import NOTICE
    from assur.scenes.answer_facts import written

    verdict: Verdict = {
        "schema": "assur/1",
        "ok": not found,
        "findings": written(found),
        "not_checked": list(not_checked),
        "request_digest": cell.scene.digest,
        "notice": NOTICE,
    }
    return dict(verdict)
