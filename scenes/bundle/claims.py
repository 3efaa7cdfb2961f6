"""What else a bundle claims: limits of joints, where the tool is, and how hard it accelerates with a part."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import groupby
from typing import Any

from assur.planner.frames.motion import Pose
from assur.planner.model.attachments import at_start
from assur.planner.model.outcome import TRACKING, LegKind, Plan
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Follow, Move, Pick, Place, Scene, Step, Trace
from assur.planner.robots.facts import Limits

Document = dict[str, Any]
MEET_M, MEET_RAD, MEET_M_S, MEET_RAD_S = 1e-6, 1e-6, 1e-6, 1e-6
"""How far the tool may be off its control point when it meets it: half of what who measures may find."""
TRACKED_M, TRACKED_RAD = 1e-5, 1e-4
"""The promise of legs that track."""
SHARES = [1e-9, 1e-9, 1e-9, 1e-6]
"""Of half the range, velocity, acceleration and jerk, beyond the limit: rounding of knots on a limit."""
CARRY_SHARE = 1e-6
"""Of the acceleration that a grip allows."""


def limits_of(scene: Scene, plan: Plan, phases: Sequence[Phase]) -> list[Document]:
    """The limits of the joints, and for each part those that its load leaves, for as long as it is held."""
    limited = scene.options.jerk_limited
    found = [_limits(scene.robot.limits, plan.trajectory.start, phases[-1].t1, jerk=limited)]
    for held, group in groupby((phase for phase in phases if phase.step >= 0), key=lambda phase: phase.attached.held):
        own, all_ = scene.limits_with(None if held is None else held.part), list(group)
        if own is not scene.robot.limits:
            found.append(_limits(own, all_[0].t0, all_[-1].t1, jerk=limited))
    return found


def _limits(limits: Limits, t0: float, t1: float, *, jerk: bool) -> Document:
    return {
        "t0": t0,
        "t1": t1,
        "lower": limits.lower.tolist(),
        "upper": limits.upper.tolist(),
        "velocity": limits.velocity.tolist(),
        "acceleration": limits.acceleration.tolist(),
        "jerk": limits.jerk.tolist() if jerk else [],
        "shares": SHARES,
    }


def points_of(scene: Scene, plan: Plan) -> list[Document]:
    """Where the tool is at its control points, and on legs that track them."""
    frames, attached, found = list(scene.frames), at_start(scene), list[Document]()
    arrivals = {arrival.step: arrival for arrival in plan.arrivals}
    turns = "yaw" in scene.robot.coordinates
    for number, step in enumerate(scene.task):
        arrival = arrivals[number]
        frame, flange = attached.flange(scene, step, arrival.yaw_offset)
        target = flange.then(scene.tool.tcp)
        common = {
            "name": step.name,
            "frame": frames.index(frame),
            "link": len(scene.robot.links) - 1,
            "tool": _four(scene.tool.tcp),
            "target": _four(target),
        }
        passed = scene.options.vias_missed and isinstance(step, Move) and step.via
        for t in () if isinstance(step, Trace) or passed else dict.fromkeys((arrival.time, arrival.until)):
            fast = t == arrival.time and (arrival.matched or _matches(step))
            found.append(
                {
                    **common,
                    "t0": t,
                    "t1": t,
                    "middle": 0.0,
                    "height": [],
                    "position": MEET_M,
                    "yaw": [MEET_RAD] if turns else [],
                    "rates": [MEET_M_S, MEET_RAD_S][: 1 + turns] if fast else [],
                }
            )
        for leg in plan.legs:
            if leg.step == number and leg.kind in TRACKING and not isinstance(step, Trace):
                half, height = 0.0, list[float]()
                if leg.kind is not LegKind.FOLLOW and isinstance(step, Pick | Place):
                    half = scene.straight(step)[leg.kind is LegKind.DEPART] / 2.0
                    height = [half + TRACKED_M]
                found.append(
                    {
                        **common,
                        "t0": leg.t0,
                        "t1": leg.t1,
                        "middle": half,
                        "height": height,
                        "position": TRACKED_M,
                        "yaw": [TRACKED_RAD] if turns else [],
                        "rates": [],
                    }
                )
        attached = attached.after(scene, step, arrival.yaw_offset)
    return found


def _matches(step: Step) -> bool:
    """Whether the velocity of the control point is asked for."""
    if isinstance(step, Move):
        return step.match == "velocity" and not step.via
    return isinstance(step, Follow) or step.match == "velocity"


def pulls_of(scene: Scene, plan: Plan, phases: Sequence[Phase]) -> list[Document]:
    """When a part is held, how hard the tool point accelerates at most."""
    limit, end = scene.carry_acceleration, plan.trajectory.end
    if limit is None:
        return []
    return [
        {
            "name": str(phase.kind),
            "t0": phase.t0,
            "t1": min(phase.t1, end),
            "link": len(scene.robot.links) - 1,
            "tool": _four(scene.tool.tcp),
            "most": limit,
            "share": CARRY_SHARE,
        }
        for phase in phases
        if phase.attached.held is not None and phase.t0 < end
    ]


def axes_of(scene: Scene, plan: Plan) -> list[Document]:
    """Directions of the tool: outside of forbidden ranges of yaw, and with the pitch and roll that arrivals say."""
    found, path, link = list[Document](), plan.trajectory, len(scene.robot.links) - 1
    c, s = math.cos(scene.tool.tcp.yaw), math.sin(scene.tool.tcp.yaw)
    lag = scene.execution.lag
    late = lag[0] + lag[1] + lag[3] if lag and scene.forbidden_yaw else 0.0
    for each in scene.forbidden_yaw:
        way = [math.cos(each.middle), math.sin(each.middle), 0.0]
        high = math.cos(min(each.width / 2.0 + late, math.pi))
        span = {"name": "forbidden yaw", "t0": path.start, "t1": path.end, "link": link}
        found.append({**span, "axis": [c, s, 0.0], "direction": way, "low": -2.0, "high": high})
    for arrival in plan.arrivals:
        if arrival.pitch is None or arrival.roll is None or arrival.missed_by is not None:
            continue
        spans = [(arrival.time, arrival.time, MEET_RAD), (arrival.time, arrival.until, TRACKED_RAD)]
        for t0, t1, off in spans[: 2 if arrival.until > arrival.time else 1]:
            for axis, value in (
                ([1.0, 0.0, 0.0], math.sin(arrival.pitch)),
                ([0.0, 1.0, 0.0], math.sin(arrival.roll) * math.cos(arrival.pitch)),
            ):
                span = {"name": arrival.control_point, "t0": t0, "t1": t1, "link": link}
                ends = {"low": value - off, "high": value + off}
                found.append({**span, "axis": axis, "direction": [0.0, 0.0, 1.0], **ends})
    return found


def _four(pose: Pose) -> list[float]:
    return [pose.x, pose.y, pose.z, pose.yaw]
