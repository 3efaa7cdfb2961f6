"""What a plan leaves: peaks against limits, what binds, the smallest clearance, the tool's acceleration."""

from __future__ import annotations

import numpy as np

from planner.arrays import FloatArray
from planner.certificate import Prover
from planner.frames.motion import Motion
from planner.outcome import Arrival, Contact, JointPeak, Leg, LegKind, Margins, Nearest
from planner.phases import Phase
from planner.robots.protocol import Robot
from planner.scene import Scene
from planner.separation import centre_normals, face_normals, gaps, place, rough_gaps
from planner.solids import carriers, standing
from planner.trajectory import Trajectory, check_limits

INSTANTS = 200
"""Times at which the smallest clearance and the tool's acceleration are looked for."""
BATCH = 64
"""Pairs and times that are looked at together."""


def margins(scene: Scene, prover: Prover, trajectory: Trajectory, phases: tuple[Phase, ...]) -> Margins:
    """The margins of a plan. Peaks are exact extrema; clearance and tool acceleration are those at `INSTANTS` times."""
    limits = scene.robot.limits
    report = check_limits(
        trajectory, limits.lower, limits.upper, limits.velocity, limits.acceleration, limits.jerk
    )
    kinds = (report.velocity, report.acceleration, report.jerk)
    tops = [np.maximum(np.abs(kind.lower), np.abs(kind.upper)) for kind in kinds]
    peaks = tuple(
        JointPeak(
            joint.name,
            *(float(top[i]) for top in tops),
            *(float(kind.ratio[i]) for kind in kinds),
        )
        for i, joint in enumerate(scene.robot.joints)
    )
    names = ("velocity", "acceleration", "jerk")
    ratio, joint, kind = max(
        (float(report_kind.ratio[i]), peak.joint, name)
        for name, report_kind in zip(names, kinds, strict=True)
        for i, peak in enumerate(peaks)
    )
    t = np.linspace(trajectory.start, trajectory.end, INSTANTS)
    acceleration = tool_motion(scene, trajectory, t).a
    return Margins(
        peaks=peaks,
        binds=f"{kind} of {joint} ({100 * ratio:.0f} %)",
        nearest=nearest(prover, trajectory, phases),
        tool_acceleration=float(np.sqrt((acceleration**2).sum(-1)).max()),
        tool_acceleration_limit=scene.carry_acceleration,
        singularity=float(scene.robot.margin(trajectory.evaluate(t)).min()),
    )


def tool_motion(scene: Scene, trajectory: Trajectory, t: FloatArray) -> Motion:
    """Motion of the tool point in the world at times t (T,)."""
    robot: Robot = scene.robot
    q, qd, qdd, qddd = (trajectory.evaluate(t, order) for order in range(4))
    return robot.link_motion(robot.links.index("flange"), q, qd, qdd, qddd).at(scene.tool.tcp)


def nearest(prover: Prover, trajectory: Trajectory, phases: tuple[Phase, ...]) -> Nearest | None:
    """Where, of `INSTANTS` times, the largest support gap of a pair is least; allowed contacts do not count."""
    best: Nearest | None = None
    total = sum(phase.t1 - phase.t0 for phase in phases)
    for phase in phases:
        solids = prover.solids(phase.carried, phase.rides)
        count = max(2, int(np.ceil(INSTANTS * (phase.t1 - phase.t0) / total))) if total > 0 else 2
        t = np.linspace(phase.t0, phase.t1, count)
        where = carriers(prover.scene, standing(trajectory, t), t)
        a, b = prover.asked(solids)
        names = [(solids.names[solids.body[x]], solids.names[solids.body[y]]) for x, y in zip(a, b, strict=True)]
        asked = np.array([tuple(sorted(pair)) not in phase.exempt for pair in names], dtype=bool)
        which = np.flatnonzero(asked)
        rough = rough_gaps(solids, where, a[which], b[which])
        row, column = np.unravel_index(np.argsort(rough, axis=None, kind="stable"), rough.shape)
        if not len(row):
            continue
        gap = np.array([])
        # the roughly nearest first: what is roughly further than the nearest found so far need not be looked at
        for first in range(0, len(row), BATCH):
            if first and not rough[row[first], column[first]] < gap.min():
                break
            part = slice(first, first + BATCH)
            one = place(solids, where, row[part], a[which[column[part]]])
            other = place(solids, where, row[part], b[which[column[part]]])
            normals = np.concatenate([centre_normals(one, other), face_normals(one, other)], axis=1)
            gap = np.append(gap, gaps(one, other, normals).max(1))
        i = int(np.argmin(gap))
        if best is None or gap[i] < best.gap_m:
            best = Nearest(float(gap[i]), float(t[row[i]]), names[int(which[column[i]])], phase.kind)
    return best


def contacts(phases: tuple[Phase, ...]) -> tuple[Contact, ...]:
    """The allowed contacts of a plan, joined over phases that follow each other."""
    spans: dict[tuple[str, str], list[tuple[float, float]]] = {}
    for phase in phases:
        for bodies in sorted(phase.exempt):
            held = spans.setdefault(bodies, [])
            if held and held[-1][1] == phase.t0:
                held[-1] = (held[-1][0], phase.t1)
            else:
                held.append((phase.t0, phase.t1))
    return tuple(Contact(bodies, t0, t1) for bodies, held in sorted(spans.items()) for t0, t1 in held)


__all__ = ["Arrival", "Leg", "LegKind", "contacts", "margins", "nearest", "tool_motion"]
