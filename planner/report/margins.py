"""What a plan leaves: peaks against limits, what binds, the smallest clearance, the tool's acceleration."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from assur.planner.collision.nearest import nearest
from assur.planner.collision.proof import Prover
from assur.planner.kernels.postures import least_margins
from assur.planner.legs.limits import parts
from assur.planner.legs.tool_motion import carrying_peak, tool_peak
from assur.planner.model.assembly_mode import has_loop
from assur.planner.model.load import Carried, held_inertia
from assur.planner.model.outcome import Contact, JointPeak, Margins
from assur.planner.model.phases import Phase
from assur.planner.model.refusal import RATES
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory

STEP_S = 0.004
"""Sampling of the tool's acceleration where nothing is carried, s."""
INSTANTS = 64
"""Times at which the margin to a singularity is looked for."""


def margins(scene: Scene, prover: Prover, trajectory: Trajectory, phases: tuple[Phase, ...]) -> Margins:
    """The margins of a plan. Peaks are exact extrema; clearance and tool acceleration are looked for at times."""
    peaks, (ratio, joint, kind) = _peaks(scene, trajectory, phases)
    serial, parallel = least_margins(scene.robot.row, trajectory.edges, trajectory.coefficients, INSTANTS)
    limit, held = scene.carry_acceleration, carrying_peak(scene, trajectory, phases)
    pull = held[0] if held is not None else tool_peak(scene, trajectory, trajectory.start, trajectory.end, STEP_S)[0]
    binds = f"{kind} of {joint} ({100 * ratio:.0f} %)"
    if held is not None and limit is not None and held[0] / limit > ratio:
        binds = f"acceleration of the carried part ({100 * held[0] / limit:.0f} %)"
    return Margins(
        peaks=peaks,
        binds=binds,
        nearest=nearest(prover, trajectory, phases),
        tool_acceleration=pull,
        tool_acceleration_limit=limit,
        singularity=serial,
        parallel=parallel if has_loop(scene.robot) else None,
        jerk="unbounded" if scene.options.blended else "limited",
    )


def _peaks(
    scene: Scene, trajectory: Trajectory, phases: tuple[Phase, ...]
) -> tuple[tuple[JointPeak, ...], tuple[float, str, str]]:
    """The peaks of all joints, and the greatest ratio of one to its limit, with joint and kind. No jerk where it was
    not asked. A ratio is the greatest of all phases, each with the limits of its load."""
    joints, kinds = scene.robot.joints, RATES[:2] if scene.options.blended else RATES
    tops, ratios = np.zeros((len(kinds), len(joints))), np.zeros((len(kinds), len(joints)))
    spans = [(phase.t1, phase.attached.limits(scene)) for phase in phases if phase.t1 <= trajectory.end]
    for part, limits in parts(trajectory, spans):
        for k, limit in enumerate((limits.velocity, limits.acceleration, limits.jerk)[: len(kinds)]):
            low, high = part.extrema(k + 1)
            top = np.maximum(np.abs(low), np.abs(high))
            tops[k], ratios[k] = np.maximum(tops[k], top), np.maximum(ratios[k], top / limit)
    binding = max(
        (ratio, joint.name, str(kind))
        for kind, of_kind in zip(kinds, ratios.tolist(), strict=True)
        for ratio, joint in zip(of_kind, joints, strict=True)
    )
    return tuple(
        _peak(joint.name, tops[:, i].tolist(), ratios[:, i].tolist()) for i, joint in enumerate(joints)
    ), binding


def _peak(joint: str, top: list[float], ratio: list[float]) -> JointPeak:
    """Velocity, acceleration and, if it has a limit, jerk."""
    (v, a, *j), (v_ratio, a_ratio, *j_ratio) = top, ratio
    return JointPeak(joint, v, a, j[0] if j else None, v_ratio, a_ratio, j_ratio[0] if j_ratio else None)


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
    found = list[Carried]()
    for phase in phases:
        if phase.step < 0:
            continue  # the arm stands still
        held = phase.attached.held
        part = None if held is None else held.part
        if found and found[-1].part == part:
            found[-1] = replace(found[-1], t1=phase.t1)
            continue
        load = next(load for load in scene.loads if load.part == part)
        inertia = scene.loads[0].inertia_kgm2
        if inertia is not None and held is not None:
            body = scene.index[held.part]
            inertia += held_inertia(body.body, body.mass_kg or 0.0, held.in_flange)
        found.append(Carried(part, load.mass_kg, inertia, load.share, phase.t0, phase.t1))
    return tuple(found)
