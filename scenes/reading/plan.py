"""Reads a plan from its document: the facts that the checker judges."""

from __future__ import annotations

from typing import Any

import numpy as np

from assur.planner.checker.verdict import Code, Finding
from assur.planner.laws.law import PoseUncertainty
from assur.planner.model.arrival_error import ArrivalError, Share
from assur.planner.model.outcome import (
    TRACKING,
    Arrival,
    Certificate,
    Leg,
    LegKind,
    Missed,
    Plan,
)
from assur.planner.model.path import LONGEST_S
from assur.planner.model.scene import Move, Scene, Trace
from assur.planner.trajectory import Trajectory
from assur.scenes.answer_facts import fact_of
from assur.scenes.conventions import Conventions, as_counted, converted, converted_rates
from assur.scenes.faults import NOTHING, DocumentError, Refused, fault, located, together, within
from assur.scenes.reading.frames import placed
from assur.scenes.reading.neighbours import trajectory_of
from assur.scenes.schema import answer as document
from assur.scenes.schema.read import read_normal

PLAN = "plan"
"""Where the plan is in what is checked: {request, plan}."""
ONLY = "; where `fields` selects parts of an answer, it must list this one, too"
"""What a message adds about a part that was left out."""

TIME_S = 1e-9
"""By how much durations may be off the trajectory's, s: sums of times round."""
JOINTS = 1e-9
"""... and by how much the joints of arrivals, rad or m: what writing rounds."""
REFUSAL = "planned; this answer is a refusal: its status is not_planned, so there is no plan in it"


BESIDE = document.PlannedAnswer.__annotations__.keys() - document.CheckedPlan.__annotations__.keys()
"""Fields of an answer that are no part of its plan: they may be left out, and what they claim is read by `claims`."""
CERTIFICATE_DIGEST = frozenset(document.CertificateDigest.__annotations__)
"""Fields of a certificate that is not in full."""
COLUMNS = document.Certificate.__required_keys__ - CERTIFICATE_DIGEST
"""What a certificate in full has in addition."""


PATH_TIME_S = 1e-3
"""A leg may last longer than a path by this, s: times are rounded."""


def plan_of(plan: object, conventions: Conventions, *, proved_anew: bool = False) -> tuple[Plan, tuple[Finding, ...]]:
    """The plan in a planned answer with a full certificate, and findings for wrong durations and wrong joints of
    arrivals.

    `proved_anew`: its motion will be proved again, so that the digest of the certificate is enough; the certificate of
    the plan has no rows then. Whether other statements are true is not checked here (see `claims` and the checker).
    Raises `DocumentError` below "plan".
    """
    with located({PLAN: plan}), within(PLAN):
        if isinstance(plan, dict):
            status = plan.get("status", "planned")
            if not isinstance(status, str) or status != "planned":
                raise Refused(REFUSAL if isinstance(status, str) and status == "not_planned" else "planned", "status")
            certificate = plan.get("certificate")
            plan = {key: value for key, value in plan.items() if key not in BESIDE}
            if isinstance(certificate, dict) and set(certificate) == CERTIFICATE_DIGEST:
                if not proved_anew:
                    raise Refused("the certificate in full, as certificate=full gives it", "certificate")
                read_normal(document.CertificateDigest, certificate, certificate, (PLAN, "certificate"))
                plan["certificate"] = {**certificate, "rows": 0} | {key: [] for key in COLUMNS}
        item: document.CheckedPlan = _read(document.CheckedPlan, plan)
        made = _made(item, conventions)
        return made, _untrue(item) + _untrue_joints(item, made, conventions)


def check_lengths(answer: dict[str, object], made: Plan, scene: Scene) -> None:
    """Raises `DocumentError` at a leg that ends too long after the first leg of its step: its path could not be
    checked."""
    begins: dict[int, float] = {}
    for i, leg in enumerate(made.legs):
        step = scene.task[leg.step] if 0 <= leg.step < len(scene.task) else None
        if isinstance(step, Trace) and leg.kind in TRACKING:
            begin = leg.t0
        elif isinstance(step, Move) and step.path and leg.kind is not LegKind.WAIT:
            begin = begins.setdefault(leg.step, leg.t0)
        else:
            continue
        if not leg.t1 - begin <= LONGEST_S + PATH_TIME_S:
            allowed = f"at most {LONGEST_S:g} s after the way along the path of {step.name} begins"
            raise fault({PLAN: answer}, (PLAN, "legs", i, "to_s"), allowed)


def motion_of(
    answer: dict[str, object], conventions: Conventions
) -> tuple[Trajectory, tuple[Leg, ...], tuple[Arrival, ...]]:
    """Trajectory, legs and arrivals of an answer, or of a candidate in it; other fields are ignored. For callers that
    show a motion and do not rely on it. Raises `DocumentError` below "plan"."""
    with located({PLAN: answer}), within(PLAN):
        shown = {key: answer[key] for key in document.ShownMotion.__annotations__ if key in answer}
        item: document.ShownMotion = _read(document.ShownMotion, shown)
        _hold_to_robot(item, conventions)
        with within("trajectory"):
            trajectory = trajectory_of(item["trajectory"], conventions)
        return trajectory, _legs(item), _arrivals(item, conventions)


def _read(model: Any, part: object) -> Any:
    """A part of an answer. Raises `DocumentError` below "plan", which says of a field that was left out why it may
    be."""
    try:
        return read_normal(model, part, part, (PLAN,))
    except DocumentError as error:
        every = [
            DocumentError(each.field, each.value, f"{each.allowed}{ONLY}")
            if each.value is NOTHING and "[" not in each.field  # `fields` gives lists whole
            else DocumentError(each.field, each.value, each.allowed)
            for each in (error, *error.more)
        ]
        raise together(every, error.left_out) from None


def _made(item: document.CheckedPlan, conventions: Conventions) -> Plan:
    _hold_to_robot(item, conventions)
    with within("trajectory"):
        trajectory = trajectory_of(item["trajectory"], conventions)
    return Plan(trajectory, _legs(item), _arrivals(item, conventions), _certificate(item["certificate"]))


def _legs(item: document.ShownMotion | document.CheckedPlan) -> tuple[Leg, ...]:
    return tuple(fact_of(Leg, leg) for leg in item["legs"])


def _arrivals(item: document.ShownMotion | document.CheckedPlan, conventions: Conventions) -> tuple[Arrival, ...]:
    return tuple(
        fact_of(
            Arrival,
            each,
            pose=placed(each["at_m"], each["yaw_rad"]),
            missed_by=_missed(i, each.get("missed_by"), conventions),
            error=_error(each.get("error"), conventions),
        )
        for i, each in enumerate(item["arrivals"])
    )


def _error(item: document.ArrivalError | None, conventions: Conventions) -> ArrivalError | None:
    if item is None:
        return None
    return ArrivalError(
        position_m=item["position_m"],
        within=PoseUncertainty(item["horizontal_m"], item["vertical_m"], item["yaw_rad"]),
        shares=tuple(fact_of(Share, each) for each in item["causes"]),
        worst=as_counted(tuple((each["what"], each["value"]) for each in item["worst"]), conventions),
    )


def _hold_to_robot(item: document.ShownMotion | document.CheckedPlan, conventions: Conventions) -> None:
    """Raises `Refused` for a plan of other joints than the request's robot has."""
    names = [joint.name for joint in conventions]
    if item["trajectory"]["joint_names"] != names:
        allowed = f"{', '.join(names)}; this plan belongs to another request, for another robot"
        raise Refused(allowed, "trajectory", "joint_names")


def _missed(i: int, item: document.Missed | None, conventions: Conventions) -> Missed | None:
    if item is None:
        return None
    if len(item["joints"]) != len(conventions):
        raise Refused(f"{len(conventions)} numbers, one for each joint", "arrivals", i, "missed_by", "joints")
    joints = converted_rates(np.array(item["joints"], dtype=np.float64), conventions)
    return Missed(tuple(joints.tolist()), item["distance_m"])


def _untrue(item: document.CheckedPlan) -> tuple[Finding, ...]:
    """Findings for durations that differ from the trajectory's; a field that is left out is no claim."""
    first, last = item["trajectory"]["time_s"][0], item["trajectory"]["time_s"][-1]
    duration = last - first
    return tuple(
        Finding(Code.FORM, f"{key} is {stated:.6f}, but the trajectory's is {true:.6f}", abs(stated - true), "s", key)
        for key, stated, true in (
            ("duration_s", item.get("duration_s"), duration),
            ("start_s", item.get("start_s"), first),
        )
        if stated is not None and not abs(stated - true) <= TIME_S
    )


def _untrue_joints(item: document.CheckedPlan, made: Plan, conventions: Conventions) -> tuple[Finding, ...]:
    """Findings for joints of arrivals that differ from the trajectory's."""
    found = []
    for i, arrival in enumerate(item["arrivals"]):
        time, field = arrival["time_s"], f"arrivals[{i}]"
        if not made.trajectory.start <= time <= made.trajectory.end:
            continue  # the checker says so
        q = made.trajectory.evaluate(time)
        stated = arrival.get("joints")
        if stated is not None:
            if len(stated) != len(conventions):
                raise Refused(f"{len(conventions)} numbers, one for each joint", "arrivals", i, "joints")
            off = float(np.abs(converted(np.array(stated, dtype=np.float64), conventions) - q).max())
            if not off <= JOINTS:
                what = "the joints of an arrival are not those of the trajectory"
                found.append(Finding(Code.FORM, what, off, "rad or m", f"{field}.joints"))
    return tuple(found)


def _certificate(item: document.Certificate) -> Certificate:
    for key, column in item.items():
        if key not in CERTIFICATE_DIGEST | {"names"} and column is not None and len(column) != item["rows"]:  # type: ignore[arg-type]
            raise Refused(f"{item['rows']} rows, as many as it says", "certificate", key)
    normal = np.array(item["normal"], dtype=np.float64).reshape(-1, 3)
    return fact_of(Certificate, item, normal=normal)
