"""What is claimed of the tool: where it is, how fast and how hard it accelerates, and which way its axes point.

Each function gives rows with what they are called for people.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from assur.planner.claim import columns as c
from assur.planner.claim.extremes import between_jumps
from assur.planner.claim.lifts import arch_top
from assur.planner.model.attachments import at_start
from assur.planner.model.outcome import TRACKING, LegKind, Plan
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene, Step, Trace

Rows = list[tuple[str, tuple[float, ...]]]
MEET_M, MEET_RAD, MEET_M_S, MEET_RAD_S = 1e-6, 1e-6, 1e-6, 1e-6
"""How far the tool may be off its control point when it meets it: half of what who measures may find."""
TRACKED_M, TRACKED_RAD = 1e-5, 1e-4
"""The promise of legs that track."""
CARRY_SHARE = 1e-6
"""Of the acceleration that a grip allows."""
UP = (0.0, 0.0, 1.0)
FREE = -1.0
"""In place of an error: nothing is claimed of it."""
ANYWHERE_M = 2.0 * c.FARTHEST_M
"""How far the tool may be from a point of which only the yaw counts."""


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
