"""What is claimed of the tool: where it is, how fast and how hard it accelerates, and which way its axes point.

Each function gives rows with what they are called for people.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.claim import columns as c
from assur.planner.claim.lifts import arch_top, between_jumps
from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.model.attachments import at_start
from assur.planner.model.outcome import TRACKING, Arrival, LegKind, Plan
from assur.planner.model.path import TANGENT_RAD, PathCurve
from assur.planner.model.phases import Phase
from assur.planner.model.scene import WORLD, Move, Scene, Step, Trace
from assur.planner.trajectory import Trajectory

Rows = list[tuple[str, tuple[float, ...]]]
MEET_M, MEET_RAD, MEET_M_S, MEET_RAD_S = 1e-6, 1e-6, 1e-6, 1e-6
"""How far the tool may be off its control point when it meets it: half of what a measurement would show."""
TRACKED_M, TRACKED_RAD = 1e-5, 1e-4
"""The promise of legs that track."""
CARRY_SHARE = 1e-6
"""Of the acceleration that a grip allows."""
UP = (0.0, 0.0, 1.0)
FREE = -1.0
"""In place of an error: nothing is claimed of it."""
ANYWHERE_M = 2.0 * c.FARTHEST_M
"""How far the tool may be from a point whose yaw alone counts."""


def tool_on(scene: Scene) -> tuple[int, float, float, float, float]:
    """The link that carries the tool, and the pose of the tool point on it: columns that follow each other."""
    tcp = scene.tool.tcp
    return len(scene.robot.links) - 1, tcp.x, tcp.y, tcp.z, tcp.yaw


def points_of(scene: Scene, plan: Plan, phases: Sequence[Phase]) -> Rows:
    """Where the tool is at its control points, on legs that track them, and where the straight parts of these begin and
    end. `phases`: those of the plan."""
    found, tcp, on, frames = Rows(), scene.tool.tcp, tool_on(scene), list(scene.frames)
    attached, of_step = at_start(scene), {phase.step: phase.attached for phase in reversed(phases)}
    turns = "yaw" in scene.robot.coordinates
    met, turning, tracked = (MEET_RAD, MEET_RAD_S, TRACKED_RAD) if turns else (FREE, FREE, FREE)
    # a motion without a task has no arrivals
    for step, arrival in zip(scene.task, plan.arrivals, strict=False):
        attached = of_step.get(arrival.step, attached)
        frame, flange = attached.flange(scene, step, arrival.yaw_offset)
        at = flange.then(tcp)
        target = (frames.index(frame), *on, at.x, at.y, at.z, at.yaw)
        legs = [leg for leg in plan.legs if leg.step == arrival.step and leg.kind in TRACKING]
        if isinstance(step, Trace):
            # guides state where the tool is; it keeps its yaw in the frame
            if turns:
                yaw = (0.0, FREE, ANYWHERE_M, tracked, FREE, FREE)
                found.append((step.name, (legs[0].t0, legs[-1].t1, *target, *yaw)))
            continue
        # a via that is missed is passed at a distance: the rest is of the pose that is missed
        missed = arrival.missed_by
        for t in dict.fromkeys((arrival.time, arrival.until)):
            fast = t == arrival.time and (arrival.matched or _matches(step))
            rates = (MEET_M_S, turning) if fast else (FREE, FREE)
            near = (MEET_M, met) if missed is None else (missed.distance_m + MEET_M, FREE)
            found.append((step.name, (t, t, *target, 0.0, FREE, *near, *rates)))
        for leg in legs:
            half, height = 0.0, FREE
            if leg.kind is not LegKind.FOLLOW and step.part is not None:
                length = scene.straight(step)[leg.kind is LegKind.DEPART]
                half, height = length / 2.0, length / 2.0 + TRACKED_M
                first = leg.kind is LegKind.APPROACH
                outer, stops = (leg.t0, step.approach_stop) if first else (leg.t1, step.depart_stop)
                rates = (MEET_M_S, turning) if stops else (FREE, FREE)
                found.append((step.name, (outer, outer, *target, length, TRACKED_M, TRACKED_M, tracked, *rates)))
            found.append((step.name, (leg.t0, leg.t1, *target, half, height, TRACKED_M, tracked, FREE, FREE)))
    return found


def _matches(step: Step) -> bool:
    """Whether the velocity of the control point is required."""
    return step.match == "velocity" and not step.via


def rates_of(scene: Scene, plan: Plan, phases: Sequence[Phase]) -> Rows:
    """How hard the tool point accelerates at most when a part is held, and how fast it is on the path of a trace."""
    limit, path, on, found = scene.carry_acceleration, plan.trajectory, tool_on(scene)[:4], Rows()
    for each in phases:
        if limit is not None and each.attached.held is not None and each.t0 < path.end:
            most = limit * (1.0 + CARRY_SHARE)
            parts = between_jumps(path, each.t0, min(each.t1, path.end))
            found += [(str(each.kind), (*part, *on, -1, 2, 0.0, most)) for part in parts]
    for arrival in plan.arrivals:
        trace, step = arrival.trace, scene.task[arrival.step]
        if trace is not None and step.target is not None:
            frame = list(scene.frames).index(step.target.frame)
            speeds = (trace.slowest_m_s, trace.fastest_m_s)
            found.append((step.name, (arrival.time, arrival.until, *on, frame, 1, *speeds)))
    return found


def axes_of(scene: Scene, plan: Plan) -> Rows:
    """Directions of the tool: outside of forbidden ranges of yaw, and yaws that are kept. How high an arch reaches."""
    found, path, lag, tcp = Rows(), plan.trajectory, scene.execution.lag, scene.tool.tcp
    link = len(scene.robot.links) - 1
    ahead, aside = (math.cos(tcp.yaw), math.sin(tcp.yaw), 0.0), (-math.sin(tcp.yaw), math.cos(tcp.yaw), 0.0)
    for each in scene.forbidden_yaw:
        late = lag[0] + lag[1] + lag[3] if lag else 0.0
        away = (math.cos(each.middle), math.sin(each.middle), 0.0)
        high = math.cos(min(each.width / 2.0 + late, math.pi))
        found.append(("forbidden yaw", (path.start, path.end, link, 0, *ahead, -1, *away, -2.0, high)))
    for step, arrival in zip(scene.task, plan.arrivals, strict=False):
        if step.target is not None and step.target.yaw_keep:
            # the yaw of the tool when the step begins; its point row states that it is met with this yaw
            own = scene.frames[step.target.frame].law.yaw or 0.0
            yaw = own + step.target.pose.yaw + arrival.yaw_offset
            begin, same = (math.cos(yaw), math.sin(yaw), 0.0), (link, 0)
            t = next(leg.t0 for leg in plan.legs if leg.step == arrival.step)
            found.append((step.name, (t, t, *same, *aside, -1, *begin, -MEET_RAD, MEET_RAD)))
            found.append((step.name, (t, t, *same, *ahead, -1, *begin, 0.5, 2.0)))
        if step.arch is not None:
            t = arch_top(scene, plan, arrival.step)
            high = step.arch.top_m - MEET_M
            found.append((step.name, (t, t, link, 1, tcp.x, tcp.y, tcp.z, -1, *UP, high, c.GREATEST)))
    return found


# Guides: where the tool is along straight legs, along paths and on traces, as chords that follow each other.
#
# Along a straight leg both ends of the line may move, and shares rise from 0 to 1. On paths both ends of a chord are
# points of the path in its frame. The tool and the path may leave a chord; the writer halves chords at sampled instants
# until both do so by a part of what is allowed, and the claim checker shows the rest.

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
