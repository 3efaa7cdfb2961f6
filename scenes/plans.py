"""A plan out of its document: the facts that the checker judges, as they were before they were written down."""

from __future__ import annotations

from typing import Any

import numpy as np

from assur.planner.checker.verdict import Code, Finding
from assur.planner.model.outcome import Arrival, Certificate, Leg, LegKind, Missed, Plan
from assur.scenes.answer import INDICES, REALS
from assur.scenes.build.frames import placed
from assur.scenes.build.neighbours import trajectory_of
from assur.scenes.conventions import Conventions, converted
from assur.scenes.documents.plans import CertificateDocument, MissedDocument, PlanDocument
from assur.scenes.documents.read import read
from assur.scenes.faults import Path, fault

PLAN: Path = ("plan",)
"""Where the plan is in what is checked: {request, plan}."""


TIME_S = 1e-9
"""By how much durations may be off the trajectory's, s: sums of times round."""
REFUSAL = "planned; this answer is a refusal: its status is not_planned, so there is no plan in it to check"


def plan_of(plan: object, conventions: Conventions) -> tuple[Plan, tuple[Finding, ...]]:
    """The plan in a planned answer with a full certificate, and what the answer says of its durations that is not so.

    Not checked: whether anything else in it is true; that is the checker's. Raises `DocumentError` below "plan".
    """
    root = {"plan": plan}
    if isinstance(plan, dict):
        if plan.get("status") == "not_planned":
            raise fault(root, (*PLAN, "status"), REFUSAL)
        certificate = plan.get("certificate")
        if isinstance(certificate, dict) and set(certificate) == {"digest", "rows", "covers"}:
            raise fault(root, (*PLAN, "certificate"), "the certificate in full, as certificate=full gives it")
    document = read(PlanDocument, plan, PLAN)
    _hold_to_robot(root, document, conventions)
    made = Plan(
        trajectory=trajectory_of(root, (*PLAN, "trajectory"), document.trajectory, conventions),
        legs=tuple(Leg(LegKind(leg.kind), leg.step, leg.from_s, leg.to_s, leg.note) for leg in document.legs),
        arrivals=tuple(
            Arrival(
                step=a.step,
                control_point=a.control_point,
                time=a.time_s,
                until=a.until_s,
                pose=placed(a.at_m, a.yaw_rad),
                matched=a.matched,
                yaw_offset=a.yaw_offset_rad,
                along_m=a.along_m,
                window_left_s=a.window_left_s,
                pitch=a.pitch_rad,
                roll=a.roll_rad,
                missed_by=_missed(root, i, a.missed_by, conventions),
            )
            for i, a in enumerate(document.arrivals)
        ),
        certificate=_certificate(root, document.certificate),
    )
    return made, _untrue(document)


def _hold_to_robot(root: object, document: PlanDocument, conventions: Conventions) -> None:
    """Raises `DocumentError` for a plan of other joints than the request's robot has."""
    names = [joint.name for joint in conventions]
    if document.trajectory.joint_names != names:
        allowed = f"{', '.join(names)}; this plan belongs to another request, for another robot"
        raise fault(root, (*PLAN, "trajectory", "joint_names"), allowed)


def _missed(root: object, i: int, item: MissedDocument | None, conventions: Conventions) -> Missed | None:
    if item is None:
        return None
    if len(item.joints) != len(conventions):
        path = (*PLAN, "arrivals", i, "missed_by", "joints")
        raise fault(root, path, f"{len(conventions)} numbers, one for each joint")
    return Missed(tuple(converted(np.array(item.joints, dtype=np.float64), conventions).tolist()), item.distance_m)


def _untrue(document: PlanDocument) -> tuple[Finding, ...]:
    """Durations that an answer states and its trajectory has not; what it leaves out is no claim."""
    first, last = document.trajectory.time_s[0], document.trajectory.time_s[-1]
    duration, bound = last - first, document.lower_bound_s
    found = [
        Finding(Code.FORM, f"{key} is {said:.6f}, but the trajectory's is {true:.6f}", abs(said - true), "s", key)
        for key, said, true in (("duration_s", document.duration_s, duration), ("start_s", document.start_s, first))
        if said is not None and not abs(said - true) <= TIME_S
    ]
    if bound is not None and not bound <= duration + TIME_S:
        what = f"lower_bound_s is {bound:.6f}, but this plan takes only {duration:.6f}"
        found.append(Finding(Code.FORM, what, bound - duration, "s", "lower_bound_s"))
    return tuple(found)


def _certificate(root: object, item: CertificateDocument) -> Certificate:
    columns: dict[str, Any] = {}
    for name, key in [*REALS.items(), *((name, name) for name in INDICES)]:
        values = getattr(item, key)
        if len(values) != item.rows:
            raise fault(root, (*PLAN, "certificate", key), f"{item.rows} rows, as many as it says")
        if name in INDICES:
            columns[name] = np.array(values, dtype=np.int64)
        else:
            columns[name] = np.array(values, dtype=np.float64)
    columns["normal"] = columns["normal"].reshape(-1, 3)
    return Certificate(names=tuple(item.names), digest=item.digest, covers=tuple(item.covers), **columns)
