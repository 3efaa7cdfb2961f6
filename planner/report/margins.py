"""What a plan leaves: peaks against limits, the smallest clearance, the tool's acceleration; and which limit binds."""

from __future__ import annotations

from typing import Any

import numpy as np

from assur.planner.claim.obligations import loads_of
from assur.planner.collision.nearest import nearest, nearest_pairs
from assur.planner.collision.proof import Prover
from assur.planner.legs.limits import instants, least_margins, parts, used
from assur.planner.legs.tool_motion import carrying_peak, tool_peaks
from assur.planner.model.load import Carried, held_inertia
from assur.planner.model.outcome import Clearances, Contact, JointPeak, Margins, Plan
from assur.planner.model.phases import Phase, phases
from assur.planner.model.refusal import RATES
from assur.planner.model.scene import Scene
from assur.planner.report.notes import MostUsed, busiest
from assur.planner.trajectory import Trajectory

NEAREST_PAIRS = 4
"""Pairs of bodies whose smallest clearances are reported, in travel and near a point; each costs about as much as the
smallest clearance of all pairs."""


def reported(scene: Scene, prover: Prover, plan: Plan) -> Clearances | None:
    """The smallest clearances of a plan, or its margins, or None, as the option `report` says. A smallest clearance
    that is not known before the deadline in force is 0, which is proved, too."""
    if scene.options.report == "none":
        return None
    path, of_plan = plan.trajectory, phases(scene, plan.legs, plan.arrivals)
    least = Clearances(nearest(prover, path, of_plan, of="arm"), nearest(prover, path, of_plan, of="placed"))
    return margins(scene, prover, path, of_plan, least) if scene.options.report == "full" else least


def margins(
    scene: Scene, prover: Prover, trajectory: Trajectory, phases: tuple[Phase, ...], least: Clearances
) -> Margins:
    """The margins of a plan with these smallest clearances. Peaks of joints are exact extrema; those of the tool point
    are evaluated at instants."""
    peaks, binding = _peaks(scene, trajectory, phases)
    limit, carrying = scene.carry_acceleration, carrying_peak(scene, trajectory, phases)
    tool = tool_peaks(scene, trajectory, trajectory.start, trajectory.end)
    held = None if carrying is None else carrying[0]
    if held is not None and limit is not None and held / limit > binding.share:
        binding = MostUsed(held / limit, "", "acceleration")
    t, lasts = instants(trajectory)
    serial, parallel = least_margins(scene.robot, trajectory, t)
    return Margins(
        peaks=peaks,
        binds=binding.binds,
        nearest=least.nearest,
        placed=least.placed,
        tool_acceleration=tool.acceleration if held is None else held,
        tool_acceleration_limit=limit,
        singularity=serial[0],
        parallel=None if parallel is None else parallel[0],
        jerk="limited" if scene.options.jerk_limited else "unbounded",
        busiest=busiest(scene, trajectory, phases, binding, t, lasts),
        helps=binding.helps,
        tool=tool,
        travel_pairs=nearest_pairs(prover, trajectory, tuple(p for p in phases if not p.near), NEAREST_PAIRS),
        near_pairs=nearest_pairs(prover, trajectory, tuple(p for p in phases if p.near), NEAREST_PAIRS),
    )


def _peaks(scene: Scene, trajectory: Trajectory, phases: tuple[Phase, ...]) -> tuple[tuple[JointPeak, ...], MostUsed]:
    """The peaks of all joints, and the most used limit. No jerk where it has no limit. A ratio is the
    greatest of all phases, each with the limits of its load."""
    joints, kinds = scene.robot.joints, RATES if scene.options.jerk_limited else RATES[:2]
    tops, ratios = np.zeros((2, 3, len(joints)))
    spans = [(phase.t1, phase.attached.limits(scene)) for phase in phases if phase.t1 <= trajectory.end]
    for part, limits in parts(trajectory, spans):
        rates = used(part, limits)
        tops, ratios = np.maximum(tops, np.abs(rates.extremes[1:]).max(1)), np.maximum(ratios, rates.ratios)
    tops, ratios = tops[: len(kinds)], ratios[: len(kinds)]
    binding = max(
        (ratio, joint.name, str(kind))
        for kind, of_kind in zip(kinds, ratios.tolist(), strict=True)
        for ratio, joint in zip(of_kind, joints, strict=True)
    )
    none: list[Any] = [None] * (3 - len(kinds))
    rows = zip(joints, tops.T.tolist(), ratios.T.tolist(), strict=True)
    return tuple(JointPeak(joint.name, *top, *none, *ratio, *none) for joint, top, ratio in rows), MostUsed(*binding)


def contacts(phases: tuple[Phase, ...]) -> tuple[Contact, ...]:
    """The allowed contacts of a plan, joined over phases that follow each other."""
    spans: dict[tuple[str, str], list[tuple[float, float]]] = {}
    for phase in phases:
        for bodies in sorted(phase.contacts):
            held = spans.setdefault(bodies, [])
            if held and held[-1][1] == phase.t0:
                held[-1] = (held[-1][0], phase.t1)
            else:
                held.append((phase.t0, phase.t1))
    return tuple(Contact(bodies, t0, t1) for bodies, held in sorted(spans.items()) for t0, t1 in held)


def carried(scene: Scene, phases: tuple[Phase, ...]) -> tuple[Carried, ...]:
    """What the flange carries, one entry for all phases that follow each other with the same part in the gripper."""
    found, loads = list[Carried](), {load.part: load for load in scene.loads}
    for part, t0, t1 in loads_of(phases):
        load, inertia = loads[part], scene.loads[0].inertia_kgm2
        if inertia is not None and part is not None:
            held = [phase.attached.held for phase in phases if phase.t0 == t0]
            at = next(each.in_flange for each in held if each is not None and each.part == part)
            body = scene.index[part]
            inertia += held_inertia(body.body, body.mass_kg or 0.0, at)
        found.append(Carried(part, load.mass_kg, inertia, load.share, t0, t1))
    return tuple(found)
