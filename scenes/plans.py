"""A plan out of its document: the facts that the checker judges, as they were before they were written down."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from planner.outcome import Arrival, Certificate, Leg, LegKind, Plan
from scenes.answer import INDICES, REALS
from scenes.build.frames import placed
from scenes.build.neighbours import trajectory_of
from scenes.catalogue.arm import Conventions
from scenes.documents.plans import CertificateDocument, PlanDocument
from scenes.documents.read import read
from scenes.faults import Path, fault

PLAN: Path = ("plan",)
"""Where the plan is in what is checked: {request, plan}."""


def plan_of(plan: object, conventions: Conventions) -> Plan:
    """The plan in a planned answer with a full certificate. Raises `DocumentError` below "plan".

    Not checked: whether anything in it is true; that is the checker's.
    """
    root = {"plan": plan}
    if isinstance(plan, dict):
        if plan.get("status") == "not_planned":
            raise fault(root, (*PLAN, "status"), "planned: there is nothing to check in a refusal")
        certificate = plan.get("certificate")
        if isinstance(certificate, dict) and set(certificate) == {"digest", "rows"}:
            raise fault(root, (*PLAN, "certificate"), "the certificate in full, as certificate=full gives it")
    document = read(PlanDocument, plan, PLAN)
    return Plan(
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
            )
            for a in document.arrivals
        ),
        certificate=_certificate(root, document.certificate),
    )


def _certificate(root: object, item: CertificateDocument) -> Certificate:
    columns: dict[str, Any] = {}
    for name, key in [*REALS.items(), *((name, name) for name in INDICES)]:
        values = getattr(item, key)
        if len(values) != item.rows:
            raise fault(root, (*PLAN, "certificate", key), f"{item.rows} rows, as many as it says")
        if name in INDICES:
            columns[name] = np.array(values, dtype=np.int64)
        else:
            columns[name] = np.array([math.inf if v is None else v for v in values], dtype=np.float64)
    columns["normal"] = columns["normal"].reshape(-1, 3)
    return Certificate(names=tuple(item.names), digest=item.digest, **columns)
