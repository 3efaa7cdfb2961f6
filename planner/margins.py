"""What a plan leaves: peaks against limits, what binds, the smallest clearance, the tool's acceleration."""

from __future__ import annotations

import numpy as np

from planner.arrays import FloatArray, IntArray
from planner.certificate import Prover
from planner.gjk import separate
from planner.leeway import Contact, JointPeak, Margins, Nearest
from planner.loops import has_loop
from planner.phases import Phase
from planner.scene import Scene
from planner.separation import likely_gaps, place, rough_gaps, swept_gaps
from planner.solids import COVER, Carriers, Solids, carriers, exempted, standing
from planner.tool_motion import carrying_peak, tool_peak
from planner.trajectory import LimitCheck, Trajectory, check_limits

INSTANTS = 64
"""Times at which the smallest clearance and the tool's acceleration are looked for."""
BATCH = 192
"""Pairs and times that are looked at together."""
PAIRS = 64
"""Pairs that are looked at together, those first whose places come nearest to each other at any times."""
FINER = 65
"""Times around the nearest one at which its pair is looked at again: one batch costs little more than one row of it."""


def margins(scene: Scene, prover: Prover, trajectory: Trajectory, phases: tuple[Phase, ...]) -> Margins:
    """The margins of a plan. Peaks are exact extrema; clearance and tool acceleration are looked for at times."""
    limits = scene.robot.limits
    jerk = None if scene.options.blended else limits.jerk
    report = check_limits(trajectory, limits.lower, limits.upper, limits.velocity, limits.acceleration, jerk)
    kinds = report.checks[1:]
    tops = [np.maximum(np.abs(kind.lower), np.abs(kind.upper)) for kind in kinds]
    peaks = tuple(_peak(joint.name, kinds, tops, i) for i, joint in enumerate(scene.robot.joints))
    names = ("velocity", "acceleration", "jerk")[: len(kinds)]
    ratio, joint, kind = max(
        (float(report_kind.ratio[i]), peak.joint, name)
        for name, report_kind in zip(names, kinds, strict=True)
        for i, peak in enumerate(peaks)
    )
    t = np.linspace(trajectory.start, trajectory.end, INSTANTS)
    q = trajectory.evaluate(t)
    limit, held = scene.carry_acceleration, carrying_peak(scene, trajectory, phases)
    pull = held[0] if held is not None else tool_peak(scene, trajectory, trajectory.start, trajectory.end)[0]
    binds = f"{kind} of {joint} ({100 * ratio:.0f} %)"
    if held is not None and limit is not None and held[0] / limit > ratio:
        binds = f"acceleration of the carried part ({100 * held[0] / limit:.0f} %)"
    return Margins(
        peaks=peaks,
        binds=binds,
        nearest=nearest(prover, trajectory, phases),
        tool_acceleration=pull,
        tool_acceleration_limit=limit,
        singularity=float(scene.robot.margin(q).min()),
        parallel=float(scene.robot.parallel_margin(q).min()) if has_loop(scene.robot) else None,
        jerk="limited" if report.jerk is not None else "unbounded",
    )


def _peak(joint: str, kinds: tuple[LimitCheck, ...], tops: list[FloatArray], i: int) -> JointPeak:
    """The peaks of joint number i; no jerk where it was not asked."""
    (v, a, *j), (v_ratio, a_ratio, *j_ratio) = (
        [float(top[i]) for top in tops],
        [float(kind.ratio[i]) for kind in kinds],
    )
    return JointPeak(joint, v, a, j[0] if j else None, v_ratio, a_ratio, j_ratio[0] if j_ratio else None)


def nearest(prover: Prover, trajectory: Trajectory, phases: tuple[Phase, ...]) -> Nearest | None:
    """The pair and time, of `INSTANTS` and then `FINER` about them, at which the distance is least.

    Of the pairs and times that are likely to be nearest GJK is asked; what is given is a lower bound of the distance
    there. Allowed contacts do not count. None: nothing is asked.
    """
    best: tuple[float, float, Phase, int] | None = None
    total = sum(phase.t1 - phase.t0 for phase in phases)
    for phase in phases:
        count = max(2, int(np.ceil(INSTANTS * (phase.t1 - phase.t0) / total))) if total > 0 else 2
        found = _nearest(prover, trajectory, phase, np.linspace(phase.t0, phase.t1, count), None)
        if found is not None and (best is None or found[0] < best[0]):
            step = (phase.t1 - phase.t0) / (count - 1)
            around = np.linspace(max(phase.t0, found[1] - step), min(phase.t1, found[1] + step), FINER)
            gap, time, which = min(found, _nearest(prover, trajectory, phase, around, found[2]) or found)
            best = gap, time, phase, which
    if best is None:
        return None
    gap, time, phase, which = best
    solids = prover.solids(phase.carried, phase.rides)
    a, b = prover.asked(solids)
    names = (solids.names[solids.body[a[which]]], solids.names[solids.body[b[which]]])
    return Nearest(gap, time, names, phase.kind)


def _nearest(
    prover: Prover, trajectory: Trajectory, phase: Phase, t: FloatArray, only: int | None
) -> tuple[float, float, int] | None:
    """Least gap, its time and number of pair at times t (T,); `only`: of this pair."""
    solids = prover.solids(phase.carried, phase.rides)
    a, b = prover.asked(solids)
    which = np.arange(len(a)) if only is None else np.array([only])
    if phase.exempt:
        which = which[~exempted(solids, phase, a[which], b[which])]
    if not len(which):
        return None
    where = carriers(prover.scene, standing(trajectory, t), t)
    least = swept_gaps(solids, where, a[which], b[which])
    order = np.argsort(least, kind="stable")
    best = (np.inf, float(t[0]), int(which[0]))
    # the pairs that may be nearest first: the others need not be looked at
    for first in range(0, len(order), PAIRS):
        some = order[first : first + PAIRS]
        if not least[some[0]] < best[0]:
            break
        best = _nearest_of(solids, where, t, which[some], a, b, best)
    return best


def _nearest_of(
    solids: Solids,
    where: Carriers,
    t: FloatArray,
    which: IntArray,
    a: IntArray,
    b: IntArray,
    best: tuple[float, float, int],
) -> tuple[float, float, int]:
    """`best`, or what is nearer among the pairs number `which` (p,) of units a, b at times t (T,)."""
    rough = rough_gaps(solids, where, a[which], b[which])
    row, column = np.unravel_index(np.argsort(rough, axis=None, kind="stable"), rough.shape)
    # the roughly nearest first: what is roughly further than the nearest found so far need not be looked at
    for first in range(0, len(row), BATCH):
        if not rough[row[first], column[first]] < best[0]:
            break
        part = slice(first, first + BATCH)
        units_a, units_b = a[which[column[part]]], b[which[column[part]]]
        one, other = place(solids, where, row[part], units_a), place(solids, where, row[part], units_b)
        gap = likely_gaps(one, other)
        for k in np.argsort(gap, kind="stable"):
            if not gap[k] < best[0]:
                break
            if solids.piece[units_a[k]] == COVER or solids.piece[units_b[k]] == COVER:
                true = _between_pieces(solids, where, int(row[part][k]), int(units_a[k]), int(units_b[k]))
            else:
                true = max(float(gap[k]), separate(one, other, int(k))[0])
            if true < best[0]:
                best = true, float(t[row[part][k]]), int(which[column[part][k]])
    return best


def _between_pieces(solids: Solids, where: Carriers, row: int, first: int, second: int) -> float:
    """Distance, m, of two bodies of several pieces at one time: the nearest pair of pieces, by GJK."""
    ones, others = (np.array(solids.pieces[int(solids.body[unit])]) for unit in (first, second))
    rows = np.full(len(ones) * len(others), row)
    one = place(solids, where, rows, np.repeat(ones, len(others)))
    other = place(solids, where, rows, np.tile(others, len(ones)))
    gap, best = likely_gaps(one, other), np.inf
    for k in np.argsort(gap, kind="stable"):
        if not gap[k] < best:
            break
        best = min(best, separate(one, other, int(k))[0])
    return float(best)


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
