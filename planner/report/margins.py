"""What a plan leaves: peaks against limits, what binds, the smallest clearance, the tool's acceleration."""

from __future__ import annotations

import numpy as np

from assur.planner.collision.nearest import nearest
from assur.planner.collision.proof import Prover
from assur.planner.kernels.postures import least_margins
from assur.planner.legs.tool_motion import carrying_peak, tool_peak
from assur.planner.model.assembly_mode import has_loop
from assur.planner.model.outcome import Contact, JointPeak, Margins
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory

STEP_S = 0.004
"""Sampling of the tool's acceleration where nothing is carried, s."""
INSTANTS = 64
"""Times at which the margin to a singularity is looked for."""


def margins(scene: Scene, prover: Prover, trajectory: Trajectory, phases: tuple[Phase, ...]) -> Margins:
    """The margins of a plan. Peaks are exact extrema; clearance and tool acceleration are looked for at times."""
    peaks, (ratio, joint, kind) = _peaks(scene, trajectory)
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


def _peaks(scene: Scene, trajectory: Trajectory) -> tuple[tuple[JointPeak, ...], tuple[float, str, str]]:
    """The peaks of all joints, and the greatest ratio of one to its limit, with joint and kind. No jerk where it was
    not asked."""
    limits, joints = scene.robot.limits, scene.robot.joints
    kinds = [("velocity", limits.velocity), ("acceleration", limits.acceleration)]
    if not scene.options.blended:
        kinds.append(("jerk", limits.jerk))
    tops, ratios = [], []
    for order, (_, limit) in enumerate(kinds, start=1):
        low, high = trajectory.extrema(order)
        top = np.maximum(np.abs(low), np.abs(high))
        tops.append(top.tolist())
        ratios.append((top / limit).tolist())
    binding = max(
        (ratio, joint.name, kind)
        for (kind, _), of_kind in zip(kinds, ratios, strict=True)
        for ratio, joint in zip(of_kind, joints, strict=True)
    )
    return tuple(
        _peak(joint.name, [top[i] for top in tops], [r[i] for r in ratios]) for i, joint in enumerate(joints)
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
