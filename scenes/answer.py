"""The one answer of command line, Python and service: an outcome as plain data that JSON can hold.

The trajectory leaves in the maker's convention (names, signs, zeros), in rad and m, so that a controller can take it;
everything else is SI and in the world frame. What has no number is null. Nothing in it is NaN or infinite.
"""

from __future__ import annotations

from typing import Any, Literal, cast

from assur.planner.model.load import Carried
from assur.planner.model.outcome import (
    Arrival,
    BestCandidate,
    Census,
    Certificate,
    Leg,
    NotPlanned,
    Outcome,
    Plan,
    Planned,
)
from assur.planner.model.phases import phases
from assur.planner.model.refusal import Reason
from assur.planner.model.scene import Scene
from assur.planner.report.notes import leg_note, warned
from assur.planner.report.straight_parts import assumed
from assur.scenes.answer_facts import document_of, refusal_document, refused_document, written
from assur.scenes.numbers import number, optional
from assur.scenes.proposals.values import values_of
from assur.scenes.reading.cell import Cell
from assur.scenes.schema import answer as document
from assur.scenes.schema.request import RequestDocument
from assur.scenes.written_knots import arrival_document, trajectory_document, with_rounded_knots

Detail = Literal["full", "digest"]

NOTICE = (
    "Proved against the model: robot data, time laws, shapes and uncertainties as requested and as listed under "
    "assumptions. Not a safety function under ISO 10218 or ISO 13849; persons are not in the model."
)
"""What every answer says."""


def answer_of(
    cell: Cell, outcome: Outcome, certificate: Detail = "full"
) -> document.PlannedAnswer | document.NotPlannedAnswer:
    """The answer. `certificate`: all its columns, or its digest and length only."""
    if isinstance(outcome, Planned):
        return _planned(cell, outcome, certificate)
    change = outcome.relaxation
    return _not_planned(
        outcome,
        _common(outcome, cell.scene.digest, full=_is_full(cell.scene)),
        _census(cell.scene, outcome.census),
        None if outcome.refusal is None else refusal_document(cell.scene, outcome.refusal, outcome.witness),
        None if outcome.best is None else _best(cell, outcome.best),
        None if change is None else document_of(change, set=values_of(cell, change.scene)),
    )


def _planned(cell: Cell, outcome: Planned, detail: Detail) -> document.PlannedAnswer:
    from assur.planner.report.margins import carried, contacts

    plan = with_rounded_knots(cell, outcome.plan)
    of_plan = phases(cell.scene, plan.legs, plan.arrivals)
    return cast(
        document.PlannedAnswer,
        {
            **_motion(cell, plan),
            "contacts": written(contacts(of_plan)),
            **({} if outcome.reported is None else {"margins": written(outcome.reported)}),
            "load": load_document(cell.scene, carried(cell.scene, of_plan)),
            **({"lower_bound_s": optional(outcome.lower_bound_s)} if _is_full(cell.scene) else {}),
            "certificate": certificate_document(plan.certificate, detail),
            "census": _census(cell.scene, outcome.census),
            "first_s": optional(outcome.first_s),
            **_common(outcome, cell.scene.digest, full=_is_full(cell.scene)),
        },
    )


def _is_full(scene: Scene) -> bool:
    """Whether an answer states its lower bound and warnings."""
    return scene.options.report == "full"


def proved_document(cell: Cell, plan: Plan) -> document.CheckedPlan:
    """A plan with its proof and nothing else: as much of an answer as the checker judges."""
    plan = with_rounded_knots(cell, plan)
    proof = {"certificate": certificate_document(plan.certificate, "full"), "request_digest": cell.scene.digest}
    return cast(document.CheckedPlan, {**_motion(cell, plan), **proof})


def _motion(cell: Cell, plan: Plan) -> document.PlannedMotion:
    """What an answer says of the motion of a settled plan."""
    return {
        "schema": "assur/1",
        "status": "planned",
        "duration_s": number(plan.trajectory.end - plan.trajectory.start),
        "start_s": number(plan.trajectory.start),
        "trajectory": trajectory_document(cell, plan.trajectory),
        "arrivals": [arrival_document(cell, plan.trajectory, arrival) for arrival in plan.arrivals],
        "legs": [_leg(cell, leg, plan.arrivals) for leg in plan.legs],
    }


def _leg(cell: Cell, leg: Leg, arrivals: tuple[Arrival, ...]) -> document.Leg:
    return cast(document.Leg, document_of(leg, note=leg_note(cell.scene, leg, arrivals)))


def _not_planned(
    outcome: NotPlanned,
    common: dict[str, Any],
    census: document.Census,
    refusal: document.Refusal | None = None,
    best: document.BestCandidate | None = None,
    relaxation: document.Relaxation | None = None,
) -> document.NotPlannedAnswer:
    return cast(
        document.NotPlannedAnswer,
        {
            "schema": "assur/1",
            "status": "not_planned",
            "reason": written(outcome.reason),
            "proved": bool(outcome.proved),
            "sentence": outcome.sentence,
            "refusal": refusal,
            "relaxation": relaxation,
            "tried": list(outcome.tried),
            "best_candidate": best,
            "explain_budget_spent": bool(outcome.explain_budget_spent),
            "census": census,
            **common,
        },
    )


def _common(outcome: Outcome, digest: str, *, full: bool) -> dict[str, Any]:
    """What every answer ends with. `digest`: of the request; `full`: with warnings."""
    return {
        "assumptions": list(outcome.assumptions),
        **({"warnings": [document_of(each, detail=warned(each)) for each in outcome.warnings]} if full else {}),
        "seed": int(outcome.seed),
        "elapsed_s": number(outcome.elapsed_s),
        "cut_by_clock": bool(outcome.cut_by_clock),
        "request_digest": digest,
        "notice": NOTICE,
    }


def unbuilt(request: RequestDocument, budget_s: float, elapsed_s: float, during: str = "") -> document.NotPlannedAnswer:
    """The answer to a request whose budget, of so many seconds, was spent before its scene was built; `during`: what
    was done then."""
    advice = "Increase budget_s, or use simpler meshes and fewer bodies."
    if during:
        advice = f"Then {during}. What is found of a mesh is kept: send the request again, or increase budget_s."
    outcome = NotPlanned(
        reason=Reason.TIMED_OUT,
        proved=False,
        sentence=f"The budget of {budget_s:g} s was spent before the cell was built; nothing was tried. {advice}",
        refusal=None,
        census=Census(0, 0),
        relaxation=None,
        tried=(),
        explain_budget_spent=False,
        assumptions=(),
        seed=request.options.seed,
        elapsed_s=elapsed_s,
        cut_by_clock=True,
    )
    none: document.Census = {"candidates": 0, "refused": 0, "lines": []}
    return _not_planned(outcome, _common(outcome, request.digest, full=request.options.report == "full"), none)


def _best(cell: Cell, best: BestCandidate) -> document.BestCandidate:
    motion = {
        "trajectory": trajectory_document(cell, best.trajectory),
        "legs": [_leg(cell, leg, best.arrivals) for leg in best.legs],
        "arrivals": [arrival_document(cell, best.trajectory, arrival) for arrival in best.arrivals],
    }
    return cast(document.BestCandidate, document_of(best, **motion))


def certificate_document(certificate: Certificate, detail: Detail) -> document.Certificate | document.CertificateDigest:
    """The proof: digest, number of rows, what it covers, and the columns if they are required in full."""
    brief: document.CertificateDigest = {
        "digest": certificate.digest,
        "rows": len(certificate),
        "covers": list(certificate.covers),
    }
    return brief if detail == "digest" else cast(document.Certificate, document_of(certificate, **brief))


def load_document(scene: Scene, carried: tuple[Carried, ...]) -> document.LoadApplied:
    """What the robot of a scene may carry, and what it carries."""
    known = scene.load_limits
    return {
        "rated_kg": known.rated_kg,
        "max_kg": known.max_kg,
        "max_inertia_kgm2": known.max_inertia_kgm2,
        "law": "table" if known.shares else "none" if known.rated_kg is None else "rated_load",
        "carried": written(carried),
    }


def repeated(scene: Scene) -> dict[str, object]:
    """What every planned answer repeats of the request of a scene, by the paths of its fields."""
    load = {f"load.{key}": value for key, value in load_document(scene, ()).items() if key != "carried"}
    return {
        "request_digest": scene.digest,
        "seed": scene.options.seed,
        "assumptions": list(assumed(scene)),
        "notice": NOTICE,
        **load,
        "margins.tool_acceleration_limit_m_s2": scene.carry_acceleration,
        "margins.jerk": "limited" if scene.options.jerk_limited else "unbounded",
    }


def _census(scene: Scene, census: Census) -> document.Census:
    return {
        "candidates": int(census.candidates),
        "refused": int(census.refused),
        "lines": [
            {**refused_document(scene, line.refusal), "count": int(line.count), "least": line.least, "most": line.most}
            for line in census.lines
        ],
    }
