"""Guides: where the tool is along straight legs, along paths and on traces, as chords that follow each other.

Along a straight leg both ends of the line may move, and shares rise from 0 to 1. On paths both ends of a chord are
points of the path in its frame. The tool and the path may leave a chord; the writer halves chords at sampled instants
until both do so by a part of what is allowed, and the claim checker shows the rest.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.claim.points import TRACKED_M, tool_on
from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.model.outcome import TRACKING, Arrival, LegKind, Plan
from assur.planner.model.path import TANGENT_RAD, PathCurve
from assur.planner.model.phases import Phase
from assur.planner.model.scene import WORLD, Move, Scene, Trace
from assur.planner.trajectory import Trajectory

CELL_S, CELLS, MOST_CELLS = 2e-4, 8, 50_000
"""Samples are so near in time, s; a piece of the trajectory has so many at least; all of a leg has about so many at
most."""
REST = 1e-9
"""A joint that is slower rests, rad/s or m/s."""
RESERVE_M = 1e-6
"""By which the error that is stated of a trace is larger than what was found."""


LEFT = 0.07
"""Share of what tool and path together may be off a chord that is left for what the claim checker bounds between
samples; on a trace it is a quarter of `RESERVE_M`."""
LOOSER = 1.2
"""By which the statement checker's bound of a curvature may be larger than what is sampled of it."""
ROUNDED_M = 1e-8
"""What both checkers keep for rounding, m, ten times."""
LATER_S = 1e-9
"""So much later than its arrival a leg may end, s, in a motion through other knots."""
STEPS = 4
"""Steps to the nearest place on a path."""
Row = tuple[float, ...]


def guides_of(scene: Scene, plan: Plan, phases: Sequence[Phase]) -> list[Row]:
    """The rows of guides of a plan, which has these phases."""
    found = list[Row]()
    for step, arrival in zip(scene.task, plan.arrivals, strict=False):
        if isinstance(step, Trace):
            found += _traced(scene, plan, step, arrival)
        elif isinstance(step, Move) and step.leg == "cartesian":
            legs = [leg for leg in plan.legs if leg.step == arrival.step and leg.kind is not LegKind.WAIT]
            legs = [leg for leg in legs if leg.t1 <= arrival.time + LATER_S]
            t = _samples(plan.trajectory, legs[0].t0, legs[-1].t1)
            if step.path:
                found += _along_path(scene, plan, step, t)
            else:
                last = next((phase for phase in phases if phase.step == arrival.step - 1), None)
                before = WORLD if last is None else last.attached.frame(scene, scene.task[last.step])
                found += _straight(scene, plan, step, before, t)
    return found


def _straight(scene: Scene, plan: Plan, step: Move, before: str, t: FloatArray) -> list[Row]:
    """The tool goes along the line from where it is left, at rest or in the frame `before`, to the control point."""
    path, goal, frames = plan.trajectory, step.target, list(scene.frames)
    w = _tool(scene, path, t)
    first = WORLD if np.abs(path.evaluate(float(t[0]), 1)).max() <= REST else before
    left = Pose(*_seen(scene, first, t[:1], w[:1])[0].tolist())
    a, b = (scene.frames[name].law.motion(t).at(p).p for name, p in ((first, left), (goal.frame, goal.pose)))
    gap = b - a
    square = (gap**2).sum(1)
    share = np.where(square > 0.0, ((w - a) * gap).sum(1) / np.where(square > 0.0, square, 1.0), 0.0)
    share = np.maximum.accumulate(np.clip(share, 0.0, 1.0))
    share[0], share[-1] = 0.0, 1.0

    def off(ends: IntArray) -> FloatArray:
        s = np.interp(t, t[ends], share[ends])
        return _most(np.linalg.norm(w - a - s[:, None] * gap, axis=1), ends) / (TRACKED_M * (1.0 - LEFT))

    ends = _chords(len(t), off)
    head = (*tool_on(scene)[:4], frames.index(first), frames.index(goal.frame))
    head = (*head, *left.position.tolist(), *goal.pose.position.tolist())
    chords = pairwise(zip(t[ends].tolist(), share[ends].tolist(), strict=True))
    return [(t0, t1, *head, s0, s1, TRACKED_M) for (t0, s0), (t1, s1) in chords]


def _along_path(scene: Scene, plan: Plan, step: Move, t: FloatArray) -> list[Row]:
    """The tool goes along the path of a move, by whatever law of time."""
    w = _seen(scene, step.target.frame, t, _tool(scene, plan.trajectory, t))
    try:
        curve = step.path_from((float(w[0, 0]), float(w[0, 1]), float(w[0, 2]))).curve
    except InputError:
        return []  # there is no such path: the statement checker reports that the claim states none
    gone = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(w, axis=0), axis=1)))
    s = gone * (curve.length / gone[-1]) if gone[-1] > 0.0 else gone
    for _ in range(STEPS):
        place, tangent, _ = curve.at(np.clip(s, 0.0, curve.length))
        s = np.clip(s + ((w - place) * tangent).sum(1), 0.0, curve.length)
    s[0], s[-1] = 0.0, curve.length
    s = np.minimum(np.maximum.accumulate(s), curve.length)
    return _on_curve(scene, step.target.frame, curve, t, s, w)


def _traced(scene: Scene, plan: Plan, step: Trace, arrival: Arrival) -> list[Row]:
    """The tool is on the path of a trace at the times at which it should be there (Q6), with its leads."""
    found, v, curve = list[Row](), step.speed_m_s, step.path.curve
    for leg in plan.legs:
        if arrival.trace is None or leg.step != arrival.step or leg.kind not in TRACKING:
            continue
        t = _samples(plan.trajectory, leg.t0, leg.t1)
        w = _seen(scene, step.target.frame, t, _tool(scene, plan.trajectory, t))
        if leg.kind is LegKind.FOLLOW:
            most = arrival.trace.error_m
            found += _on_curve(scene, step.target.frame, curve, t, v * (t - leg.t0), w, 0.0, most, 0.25 * RESERVE_M)
            continue
        before = leg.kind is LegKind.APPROACH
        length = step.lead_in_m if before else step.lead_out_m
        x = np.clip((t - leg.t0 if before else leg.t1 - t) * v / (2.0 * length), 0.0, 1.0)
        s = length * (x**3 * (2.0 - x) - 1.0)
        s = s if before else curve.length - s
        found += _on_curve(scene, step.target.frame, curve, t, s, w, 0.75 * v * v / length)
    return found


def _on_curve(
    scene: Scene,
    frame: str,
    curve: PathCurve,
    t: FloatArray,
    s: FloatArray,
    w: FloatArray,
    pull: float = 0.0,
    limit: float = TRACKED_M,
    left: float = LEFT * TRACKED_M,
) -> list[Row]:
    """Rows whose chords are of a curve. `s`, `w`: at each time (T,) the place on the curve, m, and where the tool is
    (T, 3) in its frame; `pull`: greatest acceleration along the curve, m/s²; `limit`: how far, m, tool and curve
    together may be off a chord; `left`: how much of that is left for what is between samples."""
    place, _, bend = curve.at(s)
    # a bound of the curvature holds for all of a part
    part = np.clip(np.searchsorted(curve.edges, s, side="right") - 1, 0, len(curve.parts) - 1)
    most = np.zeros(len(curve.parts))
    np.maximum.at(most, part, np.linalg.norm(bend, axis=1))
    bend = most[part]
    parts = np.cumsum(np.append(0, np.diff(part) != 0))

    def curved(ends: IntArray) -> FloatArray:
        """How far the curve may be off each chord, m."""
        far = np.diff(s[ends])
        found = (_most(bend, ends) * far**2 + pull * np.diff(t[ends]) ** 2) / 8.0
        found += (parts[ends[1:]] > parts[ends[:-1]]) * TANGENT_RAD * far / 4.0
        return np.asarray(LOOSER * found + ROUNDED_M)

    def off(ends: IntArray) -> FloatArray:
        chord = np.stack([np.interp(t, t[ends], place[ends, k]) for k in range(3)], 1)
        return (_most(np.linalg.norm(w - chord, axis=1), ends) + curved(ends)) / (limit - left)

    ends = _chords(len(t), off)
    head = (*tool_on(scene)[:4], *[list(scene.frames).index(frame)] * 2)
    chords = pairwise(zip(t[ends].tolist(), place[ends].tolist(), strict=True))
    allowed = (limit - curved(ends)).tolist()
    return [(t0, t1, *head, *p, *q, 0.0, 1.0, most) for ((t0, p), (t1, q)), most in zip(chords, allowed, strict=True)]


def _chords(count: int, off: Callable[[IntArray], FloatArray]) -> IntArray:
    """Numbers of the samples at which chords begin and end: chords that are off by more than 1 are halved, while they
    hold a sample. `off`: by how much each of some chords (N,) is off."""
    ends = np.array([0, count - 1])
    while True:
        lasts = np.diff(ends)
        wide = (off(ends) > 1.0) & (lasts > 1)
        if not wide.any():
            return ends
        ends = np.sort(np.append(ends, (ends[:-1] + lasts // 2)[wide]))


def _most(values: FloatArray, ends: IntArray) -> FloatArray:
    """The largest of the values at the samples (T,) of each chord, both its ends included, (N,)."""
    return np.asarray(np.maximum(np.maximum.reduceat(values, ends[:-1]), values[ends[1:]]))


def _samples(path: Trajectory, t0: float, t1: float) -> FloatArray:
    """Times of samples from t0 to t1, s; pieces of the trajectory begin and end with samples."""
    inside = path.time[(path.time > t0) & (path.time < t1)]
    edges = np.unique(np.concatenate([[t0], inside, [t1]]))
    cell = max(CELL_S, (t1 - t0) / MOST_CELLS)
    h = np.diff(edges)
    many = np.maximum(np.ceil(h / cell), CELLS).astype(np.int64)
    first = np.cumsum(many) - many
    within = np.arange(many.sum()) - np.repeat(first, many)
    t = np.repeat(edges[:-1], many) + within * np.repeat(h / many, many)
    return np.append(t, t1)


def _tool(scene: Scene, path: Trajectory, t: FloatArray) -> FloatArray:
    """The tool point (T, 3) in the world at times (T,)."""
    q = path.evaluate(t)
    none = np.zeros_like(q)
    return scene.robot.link_motion(len(scene.robot.links) - 1, q, none, none, none).at(scene.tool.tcp).p


def _seen(scene: Scene, name: str, t: FloatArray, points: FloatArray) -> FloatArray:
    """Points (T, 3) of the world at times (T,) in the axes of a frame."""
    frame = scene.frames[name].law.motion(t)
    off, (cosine, sine) = points - frame.p, (np.cos(frame.yaw), np.sin(frame.yaw))
    return np.stack([cosine * off[:, 0] + sine * off[:, 1], cosine * off[:, 1] - sine * off[:, 0], off[:, 2]], 1)
