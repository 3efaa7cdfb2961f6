"""What a plan leaves: peaks against limits, what binds, the smallest clearance, the tool's acceleration."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.collision.nearest import nearest, nearest_pairs
from assur.planner.collision.proof import Prover
from assur.planner.frames.motion import Pose
from assur.planner.kernels.postures import least_margins
from assur.planner.legs.limits import parts
from assur.planner.model.assembly_mode import has_loop
from assur.planner.model.load import Carried, held_inertia
from assur.planner.model.outcome import Busiest, Contact, JointPeak, Margins, ToolPeaks
from assur.planner.model.phases import Phase
from assur.planner.model.refusal import RATES
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory

FINE_S = 0.001
"""Sampling of the tool point's speed and acceleration, and of what is used of the limit that binds, s."""
PARTS = 8
"""Parts of a short piece of the spline at whose ends peaks of the tool point are looked for. A depart of some
micrometres is over in a few milliseconds, with the whole of its peak between two samples."""
AROUND = 41
"""Instants at which a peak of the tool point is looked for again, between the samples beside the largest."""
NEAR_PEAK = 0.01
"""A limit is used within this share of its peak."""
ORDERS = {"velocity": 1, "acceleration": 2, "jerk": 3}
INSTANTS = 64
"""Times at which the margin to a singularity is looked for."""


def margins(scene: Scene, prover: Prover, trajectory: Trajectory, phases: tuple[Phase, ...], pairs: int = 0) -> Margins:
    """The margins of a plan, with so many `pairs` of bodies that come nearest. Peaks of joints are exact extrema; those
    of the tool point are looked for at times."""
    peaks, (ratio, joint, kind) = _peaks(scene, trajectory, phases)
    serial, parallel = least_margins(scene.robot.row, trajectory.edges, trajectory.coefficients, INSTANTS)
    limit, instants = scene.carry_acceleration, _instants(trajectory)
    tool, held = _tool_peaks(scene, trajectory, instants), _carried_peak(scene, trajectory, phases, instants)
    binds, helps = f"{kind} of {joint} ({100 * ratio:.0f} %)", f"a higher limit of it, or a shorter way of {joint}"
    t = np.linspace(trajectory.start, trajectory.end, max(2, math.ceil(trajectory.duration / FINE_S) + 1))
    number = [each.name for each in scene.robot.joints].index(joint)
    used = np.abs(trajectory.evaluate(t, ORDERS[kind])[:, number])
    if held is not None and limit is not None and held / limit > ratio:
        binds = f"acceleration of the carried part ({100 * held / limit:.0f} %)"
        helps = "a higher limit of it (carry)"
        carried = np.any([(t >= p.t0) & (t <= p.t1) for p in phases if p.attached.held is not None], axis=0)
        used = np.where(carried, _of_tool(scene, trajectory, t)[1], 0.0)
    return Margins(
        peaks=peaks,
        binds=binds,
        nearest=nearest(prover, trajectory, phases),
        tool_acceleration=tool.acceleration if held is None else held,
        tool_acceleration_limit=limit,
        singularity=serial,
        parallel=parallel if has_loop(scene.robot) else None,
        jerk="unbounded" if scene.options.blended else "limited",
        busiest=_busiest(phases, t, used),
        helps=helps,
        tool=tool,
        travel_pairs=nearest_pairs(prover, trajectory, tuple(p for p in phases if not p.near), pairs),
        near_pairs=nearest_pairs(prover, trajectory, tuple(p for p in phases if p.near), pairs),
    )


def _busiest(phases: tuple[Phase, ...], t: FloatArray, used: FloatArray) -> Busiest | None:
    """The phase in which what is `used` (T,) of a limit at times t (T,) is longest within a hundredth of its peak."""
    at_peak = used >= (1.0 - NEAR_PEAK) * float(used.max())
    found: tuple[int, Phase] | None = None
    for phase in phases:
        count = int(np.count_nonzero(at_peak & (t >= phase.t0) & (t < phase.t1)))
        if phase.step >= 0 and phase.t1 > phase.t0 and count > (0 if found is None else found[0]):
            found = count, phase
    if found is None:
        return None
    count, phase = found
    return Busiest(
        str(phase.kind), phase.step, phase.t0, phase.t1, min(count * float(t[1] - t[0]), phase.t1 - phase.t0)
    )


def _instants(trajectory: Trajectory) -> FloatArray:
    """Times (T,) at which peaks of the tool point are looked for: every `FINE_S`, within each piece of the spline that
    is so short that this would miss what it does, and on both sides of a jump."""
    edges, length = trajectory.edges, np.diff(trajectory.edges)
    grid = np.linspace(trajectory.start, trajectory.end, max(2, math.ceil(trajectory.duration / FINE_S) + 1))
    short = length < PARTS * FINE_S
    within = edges[:-1][short, None] + length[short, None] * np.linspace(0.0, 1.0, PARTS + 1)[1:-1]
    before = np.nextafter(edges[1:], -np.inf) if trajectory.jumps else edges[1:]
    return np.unique(np.concatenate([grid, edges, within.ravel(), before]))


def _carried_peak(
    scene: Scene, trajectory: Trajectory, phases: tuple[Phase, ...], instants: FloatArray
) -> float | None:
    """The largest acceleration, m/s², of the tool point while a part is carried; None: nothing is carried."""
    held = [(p.t0, p.t1) for p in phases if p.attached.held is not None and p.t1 > p.t0 and p.step >= 0]
    spans = [np.unique(np.append(instants[(instants >= t0) & (instants <= t1)], [t0, t1])) for t0, t1 in held]
    return max((_tool_peaks(scene, trajectory, span).acceleration for span in spans), default=None)


def _tool_peaks(scene: Scene, trajectory: Trajectory, t: FloatArray) -> ToolPeaks:
    """The largest of the samples at t, sampled again more densely around each."""
    tops = [int(rate.argmax()) for rate in _of_tool(scene, trajectory, t)]
    closer = [np.append(np.linspace(t[max(0, k - 1)], t[min(len(t) - 1, k + 1)], AROUND), t[k]) for k in tops]
    again = _of_tool(scene, trajectory, np.concatenate(closer))
    speeds, pulls = again[0][: AROUND + 1], again[1][AROUND + 1 :]
    fastest, hardest = int(speeds.argmax()), int(pulls.argmax())
    return ToolPeaks(
        float(speeds[fastest]), float(closer[0][fastest]), float(pulls[hardest]), float(closer[1][hardest])
    )


def _of_tool(scene: Scene, trajectory: Trajectory, t: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Speed, m/s, and acceleration, m/s², (T,) of the tool point at times t (T,)."""
    q, qd, qdd = trajectory.states(t)
    flange = len(scene.robot.links) - 1
    moved = scene.robot.link_motion(flange, q, qd, qdd, np.zeros_like(q))
    # a flange that tilts bears the tool point itself
    moved = moved if scene.tool.tcp == Pose() else moved.at(scene.tool.tcp)
    return np.asarray(np.linalg.norm(moved.v, axis=-1)), np.asarray(np.linalg.norm(moved.a, axis=-1))


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
