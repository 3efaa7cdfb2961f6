"""Guides: where the tool is along straight legs, along paths and on traces, as chords that follow each other.

Along a straight leg both ends of the line may move, and shares rise from 0 to 1. On paths both ends of a chord are
points of the path in its frame. The tool and the path may leave a chord; the writer halves chords at sampled instants
until both do so by a part of what is allowed, and the claim checker shows the rest.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.claim.points import TRACKED_M
from assur.planner.errors import InputError
from assur.planner.frames.motion import Motion, Pose
from assur.planner.model.attachments import at_start
from assur.planner.model.outcome import Arrival, LegKind, Plan
from assur.planner.model.path import TANGENT_RAD, PathCurve
from assur.planner.model.scene import WORLD, Move, Scene, Trace
from assur.planner.trajectory import Trajectory

CELL_S, CELLS, MOST_CELLS = 2e-4, 8, 50_000
"""Samples are so near in time, s; a piece of the trajectory has so many at least; all of a leg has about so many at
most."""
REST = 1e-9
"""A joint that is slower rests, rad/s or m/s."""
RESERVE_M = 1e-6
"""By which the error that is stated of a trace is larger than what was found."""


class _Limits(NamedTuple):
    """How far, m, tool and path together may be off a chord at most; and how much of that is left for what the claim
    checker bounds between samples."""

    most: float
    left: float


ALONG = _Limits(TRACKED_M, 0.07 * TRACKED_M)
LOOSER = 1.2
"""By which the statement checker's bound of a curvature may be larger than what is sampled of it."""
ROUNDED_M = 1e-8
"""What both checkers keep for rounding, m, ten times."""
LATER_S = 1e-9
"""So much later than its arrival a leg may end, s, in a motion through other knots."""
STEPS = 4
"""Steps to the nearest place on a path."""
Row = tuple[float, ...]


def guides_of(scene: Scene, plan: Plan) -> list[Row]:
    """The rows of guides of a plan."""
    found, attached, before = list[Row](), at_start(scene), WORLD
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
                found += _straight(scene, plan, attached.flange(scene, step, arrival.yaw_offset), before, t)
        before = attached.frame(scene, step)
        attached = attached.after(scene, step, arrival.yaw_offset)
    return found


def _straight(scene: Scene, plan: Plan, goal_at: tuple[str, Pose], before: str, t: FloatArray) -> list[Row]:
    """The tool goes along the line from where it is left, at rest or in the frame `before`, to the control point, at
    which the flange is at `goal_at`."""
    path = plan.trajectory
    w = _tool(scene, path, t)
    first = WORLD if np.abs(path.evaluate(float(t[0]), 1)).max() <= REST else before
    goal_frame, goal = goal_at[0], goal_at[1].then(scene.tool.tcp)
    left = _seen(_frame(scene, first, t[:1]), w[:1])[0]
    a, b = (_fixed(_frame(scene, name, t), p) for name, p in ((first, left), (goal_frame, goal.position)))
    gap = b - a
    square = (gap**2).sum(1)
    share = np.where(square > 0.0, ((w - a) * gap).sum(1) / np.where(square > 0.0, square, 1.0), 0.0)
    share = np.maximum.accumulate(np.clip(share, 0.0, 1.0))
    share[0], share[-1] = 0.0, 1.0

    def off(ends: IntArray) -> FloatArray:
        s = np.interp(t, t[ends], share[ends])
        return _most(np.linalg.norm(w - a - s[:, None] * gap, axis=1), ends) / (ALONG.most - ALONG.left)

    ends = _chords(len(t), off)
    frames = list(scene.frames)
    head = (*_link(scene), frames.index(first), frames.index(goal_frame), *left.tolist(), *goal.position.tolist())
    times, shares = t[ends].tolist(), share[ends].tolist()
    return [(times[k], times[k + 1], *head, shares[k], shares[k + 1], ALONG.most) for k in range(len(times) - 1)]


def _along_path(scene: Scene, plan: Plan, step: Move, t: FloatArray) -> list[Row]:
    """The tool goes along the path of a move, by whatever law of time."""
    w = _seen(_frame(scene, step.target.frame, t), _tool(scene, plan.trajectory, t))
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
    return _on_curve(scene, step.target.frame, curve, t, s, w, np.zeros(len(t)), ALONG)


def _traced(scene: Scene, plan: Plan, step: Trace, arrival: Arrival) -> list[Row]:
    """The tool is on the path of a trace at the times at which it should be there (Q6), with its leads."""
    found, v = list[Row](), step.speed_m_s
    if arrival.trace is None:
        return found
    curve = step.path.curve
    on_path = _Limits(arrival.trace.error_m, 0.25 * RESERVE_M)
    for leg in plan.legs:
        if leg.step != arrival.step or leg.kind not in (LegKind.APPROACH, LegKind.FOLLOW, LegKind.DEPART):
            continue
        t = _samples(plan.trajectory, leg.t0, leg.t1)
        w = _seen(_frame(scene, step.target.frame, t), _tool(scene, plan.trajectory, t))
        pull, limits = np.zeros(len(t)), ALONG
        if leg.kind is LegKind.FOLLOW:
            s, limits = v * (t - leg.t0), on_path
        else:
            before = leg.kind is LegKind.APPROACH
            length = step.lead_in_m if before else step.lead_out_m
            x = np.clip((t - leg.t0 if before else leg.t1 - t) * v / (2.0 * length), 0.0, 1.0)
            s = length * (x**3 * (2.0 - x) - 1.0)
            s = s if before else curve.length - s
            pull += 0.75 * v * v / length
        found += _on_curve(scene, step.target.frame, curve, t, s, w, pull, limits)
    return found


def _on_curve(
    scene: Scene,
    frame: str,
    curve: PathCurve,
    t: FloatArray,
    s: FloatArray,
    w: FloatArray,
    pull: FloatArray,
    limits: _Limits,
) -> list[Row]:
    """Rows whose chords are of a curve. `s`, `w`: at each time (T,) the place on the curve, m, and where the tool is
    (T, 3) in its frame; `pull` (T,): greatest acceleration along the curve, m/s²."""
    place, _, bend = curve.at(s)
    # a bound of the curvature holds for all of a part
    part = np.clip(np.searchsorted(curve.edges, s, side="right") - 1, 0, len(curve.parts) - 1)
    most = np.zeros(len(curve.parts))
    np.maximum.at(most, part, np.linalg.norm(bend, axis=1))
    bend = most[part]
    parts = np.cumsum(np.append(0, np.diff(part) != 0))

    def curved(ends: IntArray) -> FloatArray:
        """How far the curve may be off each chord, m."""
        far, lasts = np.diff(s[ends]), np.diff(t[ends])
        found = _most(bend, ends) * far**2 / 8.0
        found += (parts[ends[1:]] > parts[ends[:-1]]) * TANGENT_RAD * far / 4.0
        found += _most(pull, ends) * lasts**2 / 8.0
        return np.asarray(LOOSER * found + ROUNDED_M)

    def off(ends: IntArray) -> FloatArray:
        chord = np.stack([np.interp(t, t[ends], place[ends, k]) for k in range(3)], 1)
        return (_most(np.linalg.norm(w - chord, axis=1), ends) + curved(ends)) / (limits.most - limits.left)

    ends = _chords(len(t), off)
    frames, head = [list(scene.frames).index(frame)] * 2, _link(scene)
    times, points, most = t[ends].tolist(), place[ends].tolist(), (limits.most - curved(ends)).tolist()
    return [
        (times[k], times[k + 1], *head, *frames, *points[k], *points[k + 1], 0.0, 1.0, most[k])
        for k in range(len(times) - 1)
    ]


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


def _frame(scene: Scene, name: str, t: FloatArray) -> Motion:
    return scene.frames[name].law.motion(t)


def _fixed(frame: Motion, point: FloatArray) -> FloatArray:
    """A point of a frame (3,) in the world at its times, (T, 3)."""
    return frame.at(Pose(*(float(x) for x in point))).p


def _seen(frame: Motion, points: FloatArray) -> FloatArray:
    """Points (T, 3) of the world in the axes of a frame at its times."""
    off, (cosine, sine) = points - frame.p, (np.cos(frame.yaw), np.sin(frame.yaw))
    return np.stack([cosine * off[:, 0] + sine * off[:, 1], cosine * off[:, 1] - sine * off[:, 0], off[:, 2]], 1)


def _link(scene: Scene) -> Row:
    """The columns of the link and of the point on it."""
    tcp = scene.tool.tcp
    return (len(scene.robot.links) - 1, tcp.x, tcp.y, tcp.z)
