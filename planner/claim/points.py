"""What is claimed of the tool: where it is, how hard it accelerates with a part, and which way its axes point.

Each function gives rows with what they are called for people.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

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


def points_of(scene: Scene, plan: Plan) -> Rows:
    """Where the tool is at its control points, and on legs that track them."""
    found, tcp, link = Rows(), scene.tool.tcp, len(scene.robot.links) - 1
    frames, tool = list(scene.frames), (tcp.x, tcp.y, tcp.z, tcp.yaw)
    attached, arrivals = at_start(scene), {arrival.step: arrival for arrival in plan.arrivals}
    turns = "yaw" in scene.robot.coordinates
    met, turning, tracked = (MEET_RAD, MEET_RAD_S, TRACKED_RAD) if turns else (FREE, FREE, FREE)
    for number, step in enumerate(scene.task):
        arrival = arrivals[number]
        if isinstance(step, Trace):
            continue  # it takes no part and puts none down
        frame, flange = attached.flange(scene, step, arrival.yaw_offset)
        at = flange.then(tcp)
        target = (frames.index(frame), link, *tool, at.x, at.y, at.z, at.yaw)
        # a via that may be missed has an error of its own
        for t in () if step.via and scene.options.vias_missed else dict.fromkeys((arrival.time, arrival.until)):
            fast = t == arrival.time and (arrival.matched or _matches(step))
            rates = (MEET_M_S, turning) if fast else (FREE, FREE)
            found.append((step.name, (t, t, *target, 0.0, FREE, MEET_M, met, *rates)))
        for leg in plan.legs:
            if leg.step == number and leg.kind in TRACKING:
                half, height = 0.0, FREE
                if leg.kind is not LegKind.FOLLOW and step.part is not None:
                    half = scene.straight(step)[leg.kind is LegKind.DEPART] / 2.0
                    height = half + TRACKED_M
                found.append((step.name, (leg.t0, leg.t1, *target, half, height, TRACKED_M, tracked, FREE, FREE)))
        attached = attached.after(scene, step, arrival.yaw_offset)
    return found


def _matches(step: Step) -> bool:
    """Whether the velocity of the control point is required."""
    return step.match == "velocity" and not step.via


def rates_of(scene: Scene, plan: Plan, phases: Sequence[Phase]) -> Rows:
    """When a part is held, how hard the tool point accelerates at most."""
    limit, end, tcp, link = scene.carry_acceleration, plan.trajectory.end, scene.tool.tcp, len(scene.robot.links) - 1
    if limit is None:
        return []
    most = limit * (1.0 + CARRY_SHARE)
    return [
        (str(each.kind), (each.t0, min(each.t1, end), link, tcp.x, tcp.y, tcp.z, -1, 2, 0.0, most))
        for each in phases
        if each.attached.held is not None and each.t0 < end
    ]


def axes_of(scene: Scene, plan: Plan) -> Rows:
    """Directions of the tool: outside of forbidden ranges of yaw, and with the pitch and roll of arrivals."""
    found, path, link, lag = Rows(), plan.trajectory, len(scene.robot.links) - 1, scene.execution.lag
    for each in scene.forbidden_yaw:
        late = lag[0] + lag[1] + lag[3] if lag else 0.0
        axis = (math.cos(scene.tool.tcp.yaw), math.sin(scene.tool.tcp.yaw), 0.0)
        away = (math.cos(each.middle), math.sin(each.middle), 0.0)
        high = math.cos(min(each.width / 2.0 + late, math.pi))
        found.append(("forbidden yaw", (path.start, path.end, link, 0, *axis, -1, *away, -2.0, high)))
    for arrival in plan.arrivals:
        if arrival.pitch is None or arrival.roll is None or arrival.missed_by is not None:
            continue
        spans = ((arrival.time, MEET_RAD), (arrival.until, TRACKED_RAD))
        for t1, off in spans[: 1 + (arrival.until > arrival.time)]:
            for axis, value in (
                ((1.0, 0.0, 0.0), math.sin(arrival.pitch)),
                ((0.0, 1.0, 0.0), math.sin(arrival.roll) * math.cos(arrival.pitch)),
            ):
                row = (arrival.time, t1, link, 0, *axis, -1, *UP, value - off, value + off)
                found.append((arrival.control_point, row))
    return found
