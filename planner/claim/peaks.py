"""Peaks that an answer states of the joints and of the tool: bounds of the whole motion, and instants at which they are
reached."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import groupby, pairwise

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.claim import columns as c
from assur.planner.legs.tool_motion import carrying_peak, tool_accelerations, tool_peak
from assur.planner.model.claims import Claims
from assur.planner.model.outcome import JointPeak, Plan
from assur.planner.model.phases import Phase
from assur.planner.model.scene import WORLD, Scene
from assur.planner.robots.facts import Limits
from assur.planner.trajectory import Trajectory

WITHIN = (1e-6, 1e-6, 1e-3)
"""By how much a peak of velocity, acceleration and jerk may be off, as a share of the joint's limit: rounding. Jerk is
a third difference of the knots' numbers, which over pieces of 10 µs rounds to 1e-4 of a usual limit."""
BETWEEN, REACHED, ROUNDING, LEAST = 0.01, 1e-3, 1e-4, 1e-6
"""Shares by which a peak of the tool, found at instants, may be exceeded between them; by which the largest
acceleration with a part may be missed, whose instant is not stated; and by which a peak may be off at its instant. And
m/s or m/s²: what is no faster stands."""
OFF = (1e-6, 1e-3)
"""By how much a speed, m/s, and an acceleration, m/s², of the tool may be off at its instant in addition: bounds of a
closed chain round the acceleration by 0.5 mm/s²."""
BESIDE_S = 1e-9
"""How far from a jump of the acceleration, s, either of its sides is evaluated."""
SAMPLES, PIECES = 17, 4
"""Instants of each piece of the motion, and pieces in which a peak of a joint is then computed."""
Row = tuple[float, ...]


def joint_peaks_of(scene: Scene, plan: Plan, phases: Sequence[Phase], said: Sequence[JointPeak]) -> list[Row]:
    """Rows of `sums` for the stated peaks of the joints, and for their shares of the limits if a load changes these."""
    found, path, names = list[Row](), plan.trajectory, [peak.joint for peak in said]
    if names != [joint.name for joint in scene.robot.joints]:
        return found
    own = scene.robot.limits
    spans = [(path.start, path.end, own)] if all(
        limits is own for _, _, limits in loaded(scene, phases)
    ) else loaded(scene, phases)  # fmt: skip
    for order, kind in enumerate(("velocity", "acceleration", "jerk"), start=1):
        sizes, ratios = ([getattr(peak, kind + of) for peak in said] for of in ("", "_ratio"))
        if None in sizes or None in ratios:
            continue
        slack = WITHIN[order - 1] * np.array(getattr(own, kind))
        found += _reached(path, order, slack, [(path.start, path.end, np.array(sizes))])
        if len(spans) > 1 or spans[0][2] is not own:
            most = [(t0, t1, np.array(ratios) * getattr(limits, kind)) for t0, t1, limits in spans]
            found += _reached(path, order, slack, most)
    return found


def loaded(scene: Scene, phases: Sequence[Phase]) -> list[tuple[float, float, Limits]]:
    """From when to when each load is carried, and the limits that it leaves."""
    found = []
    for _, group in groupby((phase for phase in phases if phase.step >= 0), key=lambda phase: phase.attached.held):
        own = list(group)
        if own[-1].t1 > own[0].t0:
            found.append((own[0].t0, own[-1].t1, own[0].attached.limits(scene)))
    return found


def _reached(
    path: Trajectory,
    order: int,
    slack: FloatArray,
    spans: Sequence[tuple[float, float, FloatArray]],
) -> list[Row]:
    """Rows for each joint: rates of an order are no larger over each span than its sizes (n,) with `slack`, and once in
    one of the spans as large but for it."""
    found = list[Row]()
    peaks = [_peaks(path, order, t0, t1) for t0, t1, _ in spans]
    for joint in range(path.n):
        for t0, t1, sizes in spans:
            found.append(_sum(joint, order, t0, t1, -sizes[joint] - slack[joint], sizes[joint] + slack[joint]))
        shares = [peak[joint, 1] / sizes[joint] if sizes[joint] > 0.0 else 0.0
                  for peak, (_, _, sizes) in zip(peaks, spans, strict=True)]  # fmt: skip
        k = int(np.argmax(np.abs(shares)))
        t, size = float(peaks[k][joint, 0]), float(spans[k][2][joint])
        least, most = size - float(slack[joint]), size + float(slack[joint])
        if least > 0.0:
            low, high = (least, most) if shares[k] > 0.0 else (-most, -least)
            found.append(_sum(joint, order, t, t, low, high))
    return found


def _sum(joint: int, order: int, t0: float, t1: float, low: float, high: float) -> Row:
    return t0, t1, order, *(float(k == joint) for k in range(c.MOST_JOINTS)), low, high


def _peaks(path: Trajectory, order: int, t0: float, t1: float) -> FloatArray:
    """(n, 2): when, within [t0, t1], a derivative of each joint is largest in size, and its value there. Instants are
    within pieces of the motion, where no derivative jumps."""
    begins, steps = path.edges[:-1], path.steps
    inside = np.flatnonzero((begins >= t0 - BESIDE_S) & (begins + steps <= t1 + BESIDE_S))
    if not len(inside):
        return np.column_stack([np.full(path.n, t0), np.zeros(path.n)])
    powers = np.array([math.perm(i, order) for i in range(6)], dtype=float)[order:]
    c_ = path.coefficients[inside][:, :, order:] * powers  # (P, n, 6 - order)
    u = np.linspace(0.0, 1.0, SAMPLES)
    u[[0, -1]] = BESIDE_S, 1.0 - BESIDE_S
    taus = steps[inside][:, None] * u
    values = np.einsum("pnk,psk->pns", c_, taus[:, :, None] ** np.arange(6 - order))
    found = np.empty((path.n, 2))
    for joint in range(path.n):
        own = np.abs(values[:, joint])
        best = (-math.inf, 0.0, 0.0)
        for p in np.argsort(own.max(axis=1))[-PIECES:].tolist():
            polynomial = c_[p, joint, ::-1]
            turns = np.roots(np.polyder(polynomial))
            times = [t for t in turns.real.tolist() if taus[p, 0] < t < taus[p, -1]] + [taus[p, int(own[p].argmax())]]
            for tau in times:
                value = float(np.polyval(polynomial, tau))
                best = max(best, (abs(value), float(begins[inside[p]] + tau), value))
        found[joint] = best[1:]
    return found


def tool_peaks_of(scene: Scene, plan: Plan, phases: Sequence[Phase], claims: Claims) -> list[Row]:
    """Rows of `rates` for the stated peaks of the tool point."""
    path, found = plan.trajectory, list[Row]()
    whole = [(path.start, path.end)]
    if claims.tool is not None:
        said = claims.tool
        fastest = said.speed * (1.0 + BETWEEN) + LEAST
        found += [_rate(scene, t0, t1, 1, 0.0, fastest) for t0, t1 in _between_jumps(path, *whole[0])]
        most = said.acceleration * (1.0 + BETWEEN) + LEAST
        found += [_rate(scene, t0, t1, 2, 0.0, most) for t0, t1 in _between_jumps(path, *whole[0])]
        for order, size, t in ((1, said.speed, said.speed_time), (2, said.acceleration, said.acceleration_time)):
            at = _beside(scene, path, t) if order == 2 else min(max(t, path.start), path.end)
            found.append(_rate(scene, at, at, order, *around(size, order)))
    if claims.tool_acceleration is not None:
        size = claims.tool_acceleration
        spans = [(p.t0, p.t1) for p in phases if p.attached.held is not None and p.t1 > p.t0 and p.step >= 0] or whole
        most = size * (1.0 + BETWEEN) + LEAST
        found += [_rate(scene, *part, 2, 0.0, most) for span in spans for part in _between_jumps(path, *span)]
        least = size * (1.0 - REACHED) - OFF[1]
        if least > 0.0:
            peak = carrying_peak(scene, path, tuple(phases)) or tool_peak(scene, path, path.start, path.end)
            at = _beside(scene, path, peak[1])
            found.append(_rate(scene, at, at, 2, least, most))
    return found


LONG_S = 60.0
"""A piece that lasts longer has rows of its own."""


def _between_jumps(path: Trajectory, t0: float, t1: float) -> list[tuple[float, float]]:
    """[t0, t1] in parts within which no acceleration jumps: bounds over both sides of a jump are bounds of neither."""
    cut = np.diff(path.edges) > LONG_S  # halving a long piece never reaches the short pieces next to it
    cuts = path.edges if path.jumps else path.edges[np.append(cut, False) | np.append(False, cut)]
    inside = cuts[(cuts > t0) & (cuts < t1)].tolist()
    return list(pairwise([t0, *inside, t1]))


def around(size: float, order: int) -> tuple[float, float]:
    """Between which sizes a peak of the speed (order 1) or the acceleration (2) is at its instant."""
    off = ROUNDING * size + OFF[order - 1]
    return max(size - off, 0.0), size + off


def _beside(scene: Scene, path: Trajectory, t: float) -> float:
    """The instant itself, or beside a jump of the acceleration that which has the larger one."""
    t = min(max(t, path.start), path.end)
    if not path.jumps:
        return t
    times = np.array([max(t - BESIDE_S, path.start), min(t + BESIDE_S, path.end)])
    return float(times[int(np.argmax(tool_accelerations(scene, path, times)))])


def _rate(scene: Scene, t0: float, t1: float, order: int, least: float, most: float) -> Row:
    link, tcp = len(scene.robot.links) - 1, scene.tool.tcp
    frame = list(scene.frames).index(WORLD) if order == 1 else -1
    return t0, t1, link, tcp.x, tcp.y, tcp.z, frame, order, least, most
