"""What runs inside a worker process. Plain data in, bytes or a problem out; nothing is raised across the border."""

from __future__ import annotations

import errno
import gc
import hashlib
import json
import os
import time
from collections.abc import Callable, Collection
from dataclasses import asdict, dataclass, field
from functools import wraps
from typing import Any

from assur.api.checked_report import checked_report
from assur.api.documents import to_json
from assur.api.logs import where
from assur.api.problems import FieldError, Problem, shown
from assur.api.workers.end import Tell
from assur.api.workers.worker_process import CalledOffError, Line
from assur.planner.errors import FaultError, InputError
from assur.planner.model.deadline import Progress, Stopwatch
from assur.scenes.exports.documents import check_trajectory_document, export_document
from assur.scenes.faults import NOTHING, raised_as
from assur.scenes.meshes import covered, use_folder
from assur.scenes.meshes.folder import MeshFolder
from assur.scenes.plan_file import FORM, TEXTS
from assur.scenes.requests import (
    Detail,
    cell_of,
    check_document,
    ik_document,
    parse_json,
    plan_document,
    plan_scenario,
    shipped,
    view_document,
    with_options,
)
from assur.scenes.schema.read import read
from assur.scenes.schema.request import OptionsDocument
from assur.scenes.schema.shapes import MeshDocument
from assur.scenes.tasks.origins import within_document

FIRST_PLAN: dict[str, Any] = {
    "schema": "assur/1",
    "robot": {
        "model": "mitsubishi-rh-6frh5520",
        "tool": {
            "tcp_m": [0, 0, 0],
            "bodies": [{"name": "cup", "shape": {"sphere": {"radius_m": 0.01}}, "at_m": [0, 0, 0]}],
        },
    },
    "start": {"joints": {"j1_deg": 0, "j2_deg": 60, "j3_mm": 250, "j4_deg": 0}},
    "bodies": [
        {"name": "post", "shape": {"box": {"size_m": [0.05, 0.05, 0.2]}}, "pose": {"at_m": [0.3, 0.25, 0.1]}},
        {"name": "part", "shape": {"mesh": {"asset": "bracket", "unit": "mm"}}, "pose": {"at_m": [0.4, -0.2, 0.02]}},
    ],
    "task": [{"move": {"to": {"at_m": [0.4, 0.0, 0.25]}}}],
    "options": {"budget_s": 10.0, "max_candidates": 20, "stop": "first", "elbow": "auto"},
}
"""The request that a new worker plans first: small, and it passes through every library, that for meshes too."""


@dataclass(frozen=True)  # with slots, Python code would pickle it
class Answer:
    """A document as JSON, a page or a file, and in a word what it says, for the log.

    `reason`: of a refusal, one of `assur.planner.model.refusal.Reason`; else empty. `stages`: seconds by stage.
    `repeatable`: no clock ended the search, so that the same request would get the same answer again. `media_type`,
    `status`, `headers`: of its response. `page`: a page of HTML about it, if there is one.
    """

    body: bytes
    outcome: str
    reason: str = ""
    stages: dict[str, float] = field(default_factory=dict)
    repeatable: bool = False
    media_type: str = "application/json"
    status: int = 200
    headers: dict[str, str] = field(default_factory=dict)
    page: bytes = b""


@dataclass(frozen=True, slots=True)
class Fault:
    """An exception that should not have been: its type and the frames it came through, no value of the request."""

    name: str
    where: tuple[str, ...]


PROGRESS_S = 0.1
"""The progress of a search is reported this often, s."""
Reply = Answer | Problem | Fault


def warm(meshes: MeshFolder | None = None) -> str:
    """Plans and checks `FIRST_PLAN`, so that libraries are loaded and the first request is as fast as the next.
    `meshes`: the folder for meshes of this worker.

    Raises `FaultError` when it is not planned: this machine cannot serve.
    """
    use_folder(meshes)
    answer = plan_document(FIRST_PLAN)
    if answer["status"] != "planned" or not check_document(FIRST_PLAN, answer)["ok"]:
        raise FaultError(f"the first plan of a worker came out as {answer['status']}")
    gc.collect()
    gc.freeze()  # what is here now stays: no collection needs to look at the libraries again
    return "planned"


def plan(body: bytes, certificate: Detail, most_budget_s: float, line: Line) -> Reply:
    """The answer to the request in `body`; reading it counts in its budget, as it does in the wall's. A budget that it
    does not state is at most `most_budget_s`. `line` takes how far the search has come, as a document."""
    given = how_planned(certificate, most_budget_s, line)
    return _guarded(lambda: plan_document(request_in(body), **given), "status", given["laps"])


def plan_shipped(name: str, options: dict[str, Any], certificate: Detail, most_budget_s: float, line: Line) -> Reply:
    """The answer to the request of the shipped scenario `name`, with the files that ship with it, and with `options`
    in place of its own. The rest as `plan`."""
    given = how_planned(certificate, most_budget_s, line)

    def work() -> dict[str, Any]:
        scenario = shipped(name)
        if not options:
            return plan_scenario(scenario, **given)
        request = with_options(scenario.request, options)  # its faults are the caller's, and in no line of the file
        return plan_document(request, folder=scenario.folder, **given)

    return _guarded(work, "status", given["laps"])


def how_planned(certificate: Detail, most_budget_s: float, line: Line) -> dict[str, Any]:
    """How every request is planned here. Its meaning is reported as soon as it is known to be valid, before meshes and
    kernels work on it."""
    return {
        "certificate": certificate,
        "started": time.perf_counter(),
        "most_budget_s": most_budget_s,
        "watch": _watch(line.tell),
        "valid": lambda valid: line.means(lambda: f"plan {certificate} {valid.meaning}"),
        "laps": Stopwatch(),
    }


def _watch(tell: Tell) -> Callable[[Progress], None]:
    """Reports every `PROGRESS_S`, and of each better plan; whether the job is called off is read each time."""
    last: Progress | None = None

    def watch(progress: Progress) -> None:
        nonlocal last
        better = last is None or (progress.stage, progress.duration_s) != (last.stage, last.duration_s)
        if better or last is None or progress.elapsed_s - last.elapsed_s >= PROGRESS_S:
            last = progress
            tell(asdict(progress))
        else:
            tell(None)

    return watch


def of_body(
    allowed: str, stage: str, says: str = "", fields: Collection[str] = (), left_out: Collection[str] | None = None
) -> Callable[[Callable[[dict[str, Any]], dict[str, Any] | str]], Callable[[bytes, Line], Reply]]:
    """Makes a job of what is done with the document in a body.

    `allowed`: what the body is, in words; `fields`: those that it has, and no others (none: the work itself looks).
    `left_out`: the body may be a plan file, whose mark and these fields do not count; None: it may not. `stage` is what
    the time of the work counts as, `says` the field of its document that says in a word how it ended; a text is a page.
    """

    def made(work: Callable[[dict[str, Any]], dict[str, Any] | str]) -> Callable[[bytes, Line], Reply]:
        @wraps(work)
        def job(body: bytes, line: Line) -> Reply:
            laps = Stopwatch()

            def answered() -> dict[str, Any] | str:
                document = _parsed(body, allowed, line, work.__name__)
                if left_out is not None:
                    document = _unmarked(document, *left_out)
                laps.lap("read")
                if fields and document.keys() != set(fields):
                    raise not_allowed(document, allowed)
                return work(document)

            return _guarded(answered, says, laps, stage)

        return job

    return made


BOTH = 'an object with the fields "request" and "plan" and no others, or a plan file'
REPORTED = 'an object with the fields "request" and "plan", and, if it likes, "title" and "about"'
EXPORTED = 'an object with the fields "request" and "plan" and how to export it'
"""What bodies are."""
LONGEST_TEXT = 2000
"""Longest title of a report, characters."""


@of_body(BOTH, "check", "ok", ("request", "plan"), TEXTS)
def check(document: dict[str, Any]) -> dict[str, Any]:
    """The checker's verdict on the plan in {"request": ..., "plan": ...}."""
    return check_document(**document)


@of_body(BOTH, "draw", "status", ("request", "plan"), TEXTS)
def view(document: dict[str, Any]) -> dict[str, Any]:
    """What a viewer plays of the plan in {"request": ..., "plan": ...}."""
    return view_document(**document)


@of_body(REPORTED, "draw", left_out=())
def report(document: dict[str, Any]) -> str:
    """The page that plays the plan in {"request": ..., "plan": ...}, which may have a title and say what it is
    about."""
    document = {"title": "plan", "about": "", **document}
    if document.keys() != {"request", "plan", "title", "about"}:
        raise not_allowed(document, REPORTED)
    for name in ("title", "about"):
        if not (isinstance(document[name], str) and len(document[name]) <= LONGEST_TEXT):
            raise InputError(name, document[name], f"a text of up to {LONGEST_TEXT} characters")
    if not isinstance(document["plan"], dict):
        raise InputError("plan", document["plan"], "an answer")
    page, _ = checked_report(cell_of(document["request"]), document["plan"], document["title"], document["about"])
    return page


def cover(digest: str, form: str, unit: str, line: Line) -> Reply:
    """How the mesh with this digest in the folder is covered: its cover is found, and its cuts are kept."""

    def work() -> dict[str, Any]:
        line.means(lambda: f"cover {digest} {form} {unit}")
        found = covered(MeshDocument.model_validate({"sha256": digest, "format": form, "unit": unit}))
        return {"status": "covered", "pieces": len(found.pieces), "excess_m": found.excess_m}

    return _guarded(work, "status", Stopwatch(), "build")


@of_body("a pose or joints, with a request or a robot", "ik", "status")
def ik(question: dict[str, Any]) -> dict[str, Any]:
    """The answer to a question, {"request": ..., "pose": ...} and the like."""
    # null is left for the question to refuse
    request = question.pop("request") if question.get("request") is not None else None
    return ik_document(request, question)


@of_body(EXPORTED, "export", "format", left_out=TEXTS)
def export(question: dict[str, Any]) -> dict[str, Any]:
    """The export of the plan in {"request": ..., "plan": ..., "format": ...}."""
    request, plan = _taken(question, "request"), _taken(question, "plan")
    return export_document(request, plan, question)


@of_body("a request, a file and its format", "check", "ok")
def check_trajectory(question: dict[str, Any]) -> dict[str, Any]:
    """The verdict on the trajectory in {"request": ..., "file": ..., "format": ...}."""
    request, plan = _taken(question, "request"), question.pop("plan", None)
    return check_trajectory_document(request, question, plan)


def _unmarked(document: dict[str, Any], *fields: str) -> dict[str, Any]:
    """What a body says: of a plan file without its mark, and without `fields`. Raises `InputError` for another mark."""
    if "schema" not in document:
        return document
    if document["schema"] != FORM:
        raise InputError("schema", document["schema"], f"{FORM}, the mark of a plan file, or none")
    return {key: value for key, value in document.items() if key not in ("schema", *fields)}


def _taken(document: dict[str, Any], field: str) -> Any:
    """The value of a field, taken out of a document. Raises `InputError` where it is missing."""
    if field not in document:
        raise InputError(field, NOTHING, f"a {field}, which must be given")
    return document.pop(field)


def request_in(body: bytes) -> dict[str, Any]:
    """The document in `body`, parsed and not validated. Raises `Problem` where there is none."""
    return _parsed(body, 'a request, or {"scenario": NAME}')


TASK = "a task without its cell: an object with start, parts, steps, options and set"


def document_in(body: bytes, allowed: str, line: Line | None = None, kind: str = "") -> dict[str, Any]:
    """The object in `body`, which is `allowed`; `line`, `kind`: as `_parsed`. Raises `Problem`."""
    return _parsed(body, allowed, line, kind)


def options_in(body: bytes) -> dict[str, Any]:
    """The options in `body`, {"options": ...} or nothing, as they are written; they are read once, to see whether they
    can be. Raises `Problem`."""
    document = _parsed(body, 'nothing, or an object with the field "options" and no others') if body else {}
    for name, value in document.items():
        if name != "options":
            raise Problem.of_input(InputError(name, value, 'no field beside "options"'))
    options = document.get("options", {})
    with raised_as(Problem.of_input), within_document("options"):
        read(OptionsDocument, options)
    return dict(options)


def _parsed(body: bytes, allowed: str, line: Line | None = None, kind: str = "") -> dict[str, Any]:
    """The object in `body`. What it means is written to `line`: the `kind` of work, and a digest that is the same for
    bodies that differ in blanks and in the order of fields. Raises `Problem`."""
    with raised_as(lambda error: Problem.of_input(error, "bad-syntax")):
        document = parse_json(body)
    if not isinstance(document, dict):
        raise not_allowed(document, allowed)
    if line is not None:
        line.means(lambda: f"{kind} {hashlib.sha256(json.dumps(document, sort_keys=True).encode()).hexdigest()}")
    return document


def not_allowed(document: object, allowed: str) -> Problem:
    """The problem of a body that is not what is allowed."""
    found = FieldError("body", shown(document), allowed)
    return Problem("bad-input", str(found), (found,))


def _guarded(work: Callable[[], dict[str, Any] | str], says: str, laps: Stopwatch, stage: str = "write") -> Reply:
    """What `work` finds: a document, or a page. `stage`: what the time of it counts as that `work` has not given to
    another stage."""

    def answered() -> Answer:
        document = work()
        laps.lap(stage)
        if isinstance(document, str):
            return Answer(document.encode(), "reported", stages=laps.seconds, media_type="text/html")
        body = to_json(document)
        laps.lap("write")
        reason = document.get("reason", "") if document.get("status") == "not_planned" else ""
        return Answer(body, _word(document[says]), str(reason), laps.seconds, repeatable(document))

    return bordered(answered)


def _word(outcome: object) -> str:
    """What a document says, in a word: a status as it is, a verdict as `right` or `wrong`."""
    return {True: "right", False: "wrong"}[outcome] if isinstance(outcome, bool) else str(outcome)


def repeatable(document: dict[str, Any]) -> bool:
    """Whether an answer is a plan, or a refusal of one, that no clock had a say in. Changes that would help a refused
    request are searched until their budget is spent: the result is not stated to be repeatable."""
    helped = document.get("explain_budget_spent") or document.get("tried") or document.get("relaxation")
    return document.get("cut_by_clock") is False and not helped


def bordered(work: Callable[[], Answer]) -> Reply:
    """What `work` returns, or what it raises as a value: nothing but `CalledOffError` leaves a job."""
    try:
        return work()
    except Problem as problem:
        return problem
    except CalledOffError:
        raise
    except InputError as error:
        return Problem.of_input(error)
    except MemoryError:
        os._exit(errno.ENOMEM)  # nothing that was allocated meanwhile can be trusted to be whole
    except Exception as error:  # noqa: BLE001 - the border of the process: reported to the web process, logged there
        return Fault(type(error).__name__, tuple(where(error.__traceback__)))
