"""The one answer of command line, Python and service: an outcome as plain data that JSON can hold.

The trajectory leaves in the maker's convention (names, signs, zeros), in rad and m, so that a controller can take it;
everything else is SI and in the world frame. What has no number is null. Nothing in it is NaN or infinite.
"""

from __future__ import annotations

from typing import Literal, cast

from assur.planner.model.input_warning import InputWarning
from assur.planner.model.load import Carried
from assur.planner.model.outcome import (
    BestCandidate,
    Census,
    Certificate,
    JointPeak,
    Leg,
    Margins,
    Nearest,
    NotPlanned,
    Outcome,
    Plan,
    Planned,
    Route,
)
from assur.planner.model.refusal import Reason
from assur.planner.model.scene import Scene
from assur.planner.report.notes import note, warned
from assur.scenes.numbers import number, optional
from assur.scenes.reading.cell import Cell
from assur.scenes.refusals import refusal_document, refused_document, word
from assur.scenes.schema import answer as document
from assur.scenes.schema.request import RequestDocument
from assur.scenes.written_knots import arrival_document, settled, trajectory_document

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
    return _not_planned(cell, outcome)


def _planned(cell: Cell, outcome: Planned, detail: Detail) -> document.PlannedAnswer:
    plan = settled(cell, outcome.plan)
    return {
        **_motion(cell, plan),
        "contacts": [
            {"bodies": list(contact.bodies), "from_s": number(contact.t0), "to_s": number(contact.t1)}
            for contact in outcome.contacts
        ],
        "margins": _margins(outcome.margins),
        "load": _load(cell.scene, outcome.carried),
        "lower_bound_s": optional(outcome.lower_bound_s),
        "certificate": certificate_document(plan.certificate, detail),
        "census": _census(cell.scene, outcome.census),
        "first_s": optional(outcome.first_s),
        "assumptions": list(outcome.assumptions),
        "warnings": [_warning(each) for each in outcome.warnings],
        "seed": int(outcome.seed),
        "elapsed_s": number(outcome.elapsed_s),
        "cut_by_clock": bool(outcome.cut_by_clock),
        "request_digest": cell.scene.digest,
        "notice": NOTICE,
    }


def proved_document(cell: Cell, plan: Plan) -> document.CheckedPlan:
    """A plan with its proof and nothing else: as much of an answer as the checker judges."""
    plan = settled(cell, plan)
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
        "legs": [_leg(leg) for leg in plan.legs],
    }


def _leg(leg: Leg) -> document.Leg:
    return {
        "kind": leg.kind.value,
        "step": int(leg.step),
        "from_s": number(leg.t0),
        "to_s": number(leg.t1),
        "note": note(leg.route),
        "route": None if leg.route is None else _route(leg.route),
    }


def _not_planned(cell: Cell, outcome: NotPlanned) -> document.NotPlannedAnswer:
    relaxation = outcome.relaxation
    return {
        "schema": "assur/1",
        "status": "not_planned",
        "reason": word(outcome.reason),
        "proved": bool(outcome.proved),
        "sentence": outcome.sentence,
        "refusal": None if outcome.refusal is None else refusal_document(cell.scene, outcome.refusal, outcome.witness),
        "relaxation": None
        if relaxation is None
        else {"what": relaxation.what, "value": relaxation.value, "duration_s": optional(relaxation.duration_s)},
        "tried": list(outcome.tried),
        "best_candidate": None if outcome.best is None else _best(cell, outcome.best),
        "explain_budget_spent": bool(outcome.explain_budget_spent),
        "census": _census(cell.scene, outcome.census),
        "assumptions": list(outcome.assumptions),
        "warnings": [_warning(each) for each in outcome.warnings],
        "seed": int(outcome.seed),
        "elapsed_s": number(outcome.elapsed_s),
        "cut_by_clock": bool(outcome.cut_by_clock),
        "request_digest": cell.scene.digest,
        "notice": NOTICE,
    }


def unbuilt(request: RequestDocument, budget_s: float, elapsed_s: float, during: str = "") -> document.NotPlannedAnswer:
    """The answer to a request whose budget, of so many seconds, was spent before its scene was built; `during`: what
    was done then."""
    advice = "Increase budget_s, or use simpler meshes and fewer bodies."
    if during:
        advice = f"Then {during}. What is found of a mesh is kept: send the request again, or increase budget_s."
    return {
        "schema": "assur/1",
        "status": "not_planned",
        "reason": word(Reason.TIMED_OUT),
        "proved": False,
        "sentence": f"The budget of {budget_s:g} s was spent before the cell was built; nothing was tried. {advice}",
        "refusal": None,
        "relaxation": None,
        "tried": [],
        "best_candidate": None,
        "explain_budget_spent": False,
        "census": {"candidates": 0, "refused": 0, "lines": []},
        "assumptions": [],
        "warnings": [],
        "seed": request.options.seed,
        "elapsed_s": number(elapsed_s),
        "cut_by_clock": True,
        "request_digest": request.digest,
        "notice": NOTICE,
    }


def _best(cell: Cell, best: BestCandidate) -> document.BestCandidate:
    return {
        "trajectory": trajectory_document(cell, best.trajectory),
        "legs": [_leg(leg) for leg in best.legs],
        "arrivals": [arrival_document(cell, best.trajectory, arrival) for arrival in best.arrivals],
        "at_s": None if best.at is None else number(best.at),
        "bodies": None if best.bodies is None else list(best.bodies),
        "gap_m": optional(best.gap_m),
        "required_m": optional(best.required_m),
    }


def _warning(warning: InputWarning) -> document.InputWarning:
    return {
        "kind": word(warning.kind),
        "bodies": list(warning.bodies),
        "amount_m": number(warning.amount_m),
        "detail": warned(warning),
    }


def _route(route: Route) -> document.Route:
    return {
        "course": word(route.course),
        "vias": int(route.vias),
        "after_wait": bool(route.after_wait),
        "later": bool(route.later),
    }


def certificate_document(certificate: Certificate, detail: Detail) -> document.Certificate | document.CertificateDigest:
    """The proof: digest, number of rows, what it covers, and the columns if asked in full."""
    if detail == "digest":
        return {"digest": certificate.digest, "rows": len(certificate), "covers": list(certificate.covers)}
    return {
        "digest": certificate.digest,
        "rows": len(certificate),
        "covers": list(certificate.covers),
        "names": list(certificate.names),
        "t0_s": certificate.t0.tolist(),
        "t1_s": certificate.t1.tolist(),
        "first": certificate.first.tolist(),
        "first_piece": certificate.first_piece.tolist(),
        "second": certificate.second.tolist(),
        "second_piece": certificate.second_piece.tolist(),
        "normal": certificate.normal.tolist(),
        "shift0_s": None if certificate.shift0 is None else certificate.shift0.tolist(),
        "shift1_s": None if certificate.shift1 is None else certificate.shift1.tolist(),
    }


def _margins(margins: Margins) -> document.Margins:
    nearest, placed = margins.nearest, margins.placed
    return {
        "peaks": [_peak(peak) for peak in margins.peaks],
        "binds": margins.binds,
        "busiest": None
        if margins.busiest is None
        else {
            "kind": margins.busiest.kind,
            "step": int(margins.busiest.step),
            "from_s": number(margins.busiest.t0),
            "to_s": number(margins.busiest.t1),
            "at_limit_s": number(margins.busiest.at_limit_s),
        },
        "helps": margins.helps,
        "tool": None
        if margins.tool is None
        else {
            "speed_m_s": number(margins.tool.speed),
            "speed_at_s": number(margins.tool.speed_time),
            "acceleration_m_s2": number(margins.tool.acceleration),
            "acceleration_at_s": number(margins.tool.acceleration_time),
        },
        "nearest": None if nearest is None else nearest_document(nearest),
        "placed": None if placed is None else nearest_document(placed),
        "travel_pairs": [nearest_document(each) for each in margins.travel_pairs],
        "near_pairs": [nearest_document(each) for each in margins.near_pairs],
        "tool_acceleration_m_s2": optional(margins.tool_acceleration),
        "tool_acceleration_limit_m_s2": optional(margins.tool_acceleration_limit),
        "singularity": optional(margins.singularity),
        "parallel": optional(margins.parallel),
        "jerk": margins.jerk,
    }


def _load(scene: Scene, carried: tuple[Carried, ...]) -> document.LoadApplied:
    known = scene.load_limits
    return {
        "rated_kg": known.rated_kg,
        "max_kg": known.max_kg,
        "max_inertia_kgm2": known.max_inertia_kgm2,
        "law": "table" if known.shares else "none" if known.rated_kg is None else "rated_load",
        "carried": [
            {
                "part": load.part,
                "mass_kg": number(load.mass_kg),
                "inertia_kgm2": None if load.inertia_kgm2 is None else number(load.inertia_kgm2),
                "acceleration_share": number(load.share),
                "from_s": number(load.t0),
                "to_s": number(load.t1),
            }
            for load in carried
        ],
    }


def nearest_document(nearest: Nearest) -> document.Nearest:
    """A pair that comes near: how near, m, when, s, and in which phase."""
    return {
        "gap_m": number(nearest.gap_m),
        "time_s": number(nearest.time),
        "bodies": list(nearest.bodies),
        "phase": str(nearest.phase),
    }


def _peak(peak: JointPeak) -> document.Peak:
    return {
        "joint": peak.joint,
        "velocity": number(peak.velocity),
        "velocity_ratio": number(peak.velocity_ratio),
        "acceleration": number(peak.acceleration),
        "acceleration_ratio": number(peak.acceleration_ratio),
        "jerk": None if peak.jerk is None else number(peak.jerk),
        "jerk_ratio": None if peak.jerk_ratio is None else number(peak.jerk_ratio),
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
