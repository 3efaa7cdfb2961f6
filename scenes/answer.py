"""The one answer of command line, Python and service: an outcome as plain data that JSON can hold.

The trajectory leaves in the maker's convention (names, signs, zeros), in rad and m, so that a controller can take it;
everything else is SI and in the world frame. What has no number is null. Nothing in it is NaN or infinite.
"""

from __future__ import annotations

import math
from typing import Any, Literal

import numpy as np

from assur.planner.errors import FaultError
from assur.planner.model.leeway import JointPeak, Margins
from assur.planner.model.outcome import (
    Arrival,
    Census,
    CensusLine,
    Certificate,
    NotPlanned,
    Outcome,
    Plan,
    Planned,
    Refusal,
)
from assur.scenes.build.cell import Cell
from assur.scenes.conventions import as_maker
from assur.scenes.documents.request import SCHEMA
from assur.scenes.numbers import interval, number, optional

Detail = Literal["full", "digest"]

NOTICE = (
    "Proved against the model: robot data, time laws, shapes and uncertainties as requested and as listed under "
    "assumptions. Not a safety function under ISO 10218 or ISO 13849; persons are not in the model."
)
"""What every answer says."""

REALS = {"t0": "t0_s", "t1": "t1_s", "normal": "normal"}
"""Columns of a certificate that hold numbers, and their keys."""
INDICES = ("first", "first_piece", "second", "second_piece")
"""Columns that hold whole numbers; their keys are the same."""


def answer_of(cell: Cell, outcome: Outcome, certificate: Detail = "full") -> dict[str, Any]:
    """The answer. `certificate`: all its columns, or its digest and length only."""
    if isinstance(outcome, Planned):
        return _planned(cell, outcome, certificate)
    return _not_planned(cell, outcome)


def _planned(cell: Cell, outcome: Planned, detail: Detail) -> dict[str, Any]:
    plan = outcome.plan
    return {
        "schema": SCHEMA,
        "status": "planned",
        "duration_s": number(plan.trajectory.end - plan.trajectory.start),
        "start_s": number(plan.trajectory.start),
        "trajectory": trajectory_document(cell, plan),
        "arrivals": [_arrival(cell, arrival) for arrival in plan.arrivals],
        "legs": [
            {
                "kind": str(leg.kind),
                "step": int(leg.step),
                "from_s": number(leg.t0),
                "to_s": number(leg.t1),
                "note": leg.note,
            }
            for leg in plan.legs
        ],
        "contacts": [
            {"bodies": list(contact.bodies), "from_s": number(contact.t0), "to_s": number(contact.t1)}
            for contact in outcome.contacts
        ],
        "margins": _margins(outcome.margins),
        "lower_bound_s": optional(outcome.lower_bound_s),
        "certificate": certificate_document(plan.certificate, detail),
        "census": _census(outcome.census),
        "first_s": optional(outcome.first_s),
        **_common(cell, outcome),
    }


def _not_planned(cell: Cell, outcome: NotPlanned) -> dict[str, Any]:
    relaxation = outcome.relaxation
    return {
        "schema": SCHEMA,
        "status": "not_planned",
        "reason": str(outcome.reason),
        "proved": bool(outcome.proved),
        "sentence": outcome.sentence,
        "refusal": None if outcome.refusal is None else _refusal(outcome.refusal),
        "relaxation": None
        if relaxation is None
        else {"what": relaxation.what, "value": relaxation.value, "duration_s": optional(relaxation.duration_s)},
        "tried": list(outcome.tried),
        "details": {key: optional(value) for key, value in outcome.details.items()},
        "census": _census(outcome.census),
        **_common(cell, outcome),
    }


def _common(cell: Cell, outcome: Outcome) -> dict[str, Any]:
    return {
        "assumptions": list(outcome.assumptions),
        "seed": int(outcome.seed),
        "elapsed_s": number(outcome.elapsed_s),
        "cut_by_clock": bool(outcome.cut_by_clock),
        "request_digest": cell.scene.digest,
        "notice": NOTICE,
    }


def trajectory_document(cell: Cell, plan: Plan) -> dict[str, Any]:
    """The knots in the maker's convention. Reading them back gives the planner's knots, bit by bit."""
    trajectory = plan.trajectory
    written = {
        key: as_maker(values, cell.conventions)
        for key, values in (("position", trajectory.q), ("velocity", trajectory.qd), ("acceleration", trajectory.qdd))
    }
    for key, values in written.items():
        if not all(map(math.isfinite, values.ravel().tolist())):
            raise FaultError(f"a trajectory's {key} is not finite")
    return {
        "joint_names": [joint.name for joint in cell.conventions],
        "joint_units": [joint.unit for joint in cell.conventions],
        "time_s": trajectory.time.tolist(),
        **{key: values.tolist() for key, values in written.items()},
        "acceleration_jumps": bool(trajectory.jumps),
    }


def certificate_document(certificate: Certificate, detail: Detail) -> dict[str, Any]:
    """The proof: digest, number of rows, what it covers, and the columns if asked in full."""
    head = {"digest": certificate.digest, "rows": len(certificate), "covers": list(certificate.covers)}
    if detail == "digest":
        return head
    columns: dict[str, Any] = {"names": list(certificate.names)}
    for name in INDICES:
        columns[name] = getattr(certificate, name).tolist()
    for name, key in REALS.items():
        columns[key] = getattr(certificate, name).tolist()
    return {**head, **columns}


def _arrival(cell: Cell, arrival: Arrival) -> dict[str, Any]:
    missed, tilt = arrival.missed_by, {"pitch_rad": arrival.pitch, "roll_rad": arrival.roll}
    return {
        "control_point": arrival.control_point,
        "step": int(arrival.step),
        "time_s": number(arrival.time),
        "until_s": number(arrival.until),
        "at_m": [number(x) for x in (arrival.pose.x, arrival.pose.y, arrival.pose.z)],
        "yaw_rad": number(arrival.pose.yaw),
        "yaw_offset_rad": number(arrival.yaw_offset),
        "matched": bool(arrival.matched),
        "along_m": None if arrival.along_m is None else number(arrival.along_m),
        "window_left_s": None if arrival.window_left_s is None else number(arrival.window_left_s),
        "missed_by": None
        if missed is None
        else {
            "joints": [number(x) for x in as_maker(np.array(missed.joints), cell.conventions).tolist()],
            "distance_m": number(missed.distance_m),
        },
        **{key: number(angle) for key, angle in tilt.items() if angle is not None},
    }


def _margins(margins: Margins) -> dict[str, Any]:
    nearest = margins.nearest
    return {
        "peaks": [_peak(peak) for peak in margins.peaks],
        "binds": margins.binds,
        "nearest": None
        if nearest is None
        else {
            "gap_m": number(nearest.gap_m),
            "time_s": number(nearest.time),
            "bodies": list(nearest.bodies),
            "phase": str(nearest.phase),
        },
        "tool_acceleration_m_s2": optional(margins.tool_acceleration),
        "tool_acceleration_limit_m_s2": optional(margins.tool_acceleration_limit),
        "singularity": optional(margins.singularity),
        "parallel": optional(margins.parallel),
        "jerk": margins.jerk,
    }


def _peak(peak: JointPeak) -> dict[str, Any]:
    found: dict[str, Any] = {"joint": peak.joint}
    for name in ("velocity", "acceleration", "jerk"):
        for key in (name, f"{name}_ratio"):
            value = getattr(peak, key)
            found[key] = None if value is None else number(value)
    return found


def _census(census: Census) -> dict[str, Any]:
    return {
        "candidates": int(census.candidates),
        "refused": int(census.refused),
        "lines": [_line(line) for line in census.lines],
    }


def _line(line: CensusLine) -> dict[str, Any]:
    return {
        "stage": line.stage,
        "reason": str(line.reason),
        "step": int(line.step),
        "bodies": list(line.bodies),
        "count": int(line.count),
        "interval_s": interval(line.interval),
        "least": optional(line.least),
        "most": optional(line.most),
        "unit": line.unit,
        "detail": line.detail,
    }


def _refusal(refusal: Refusal) -> dict[str, Any]:
    return {
        "stage": refusal.stage,
        "reason": str(refusal.reason),
        "step": int(refusal.step),
        "bodies": list(refusal.bodies),
        "interval_s": interval(refusal.interval),
        "amount": optional(refusal.amount),
        "unit": refusal.unit,
        "detail": refusal.detail,
    }
