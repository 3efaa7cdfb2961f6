"""Whether control points are met within their windows, in time and in metres along a conveyor."""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.checker.meeting import MEET_M
from assur.planner.checker.order import TIME_S
from assur.planner.checker.settle import settle
from assur.planner.checker.targets import Target
from assur.planner.checker.verdict import Code, Finding
from assur.planner.frames import Conveyor, Linear
from assur.planner.model.outcome import Arrival
from assur.planner.model.scene import Scene

COARSEST_S = 0.05
"""Length of the intervals to begin with, s: a belt that does not change its speed needs no other."""


def windows(scene: Scene, arrivals: tuple[Arrival, ...], found: tuple[Target, ...]) -> list[Finding]:
    """Findings for the control points that are not inside their window over the whole glue."""
    findings = []
    for arrival, target in zip(arrivals, found, strict=False):
        window, name = target.step.window, target.step.name
        if window.time is not None:
            over = max(window.time[0] - arrival.time, arrival.until - window.time[1])
            if not over <= TIME_S:
                where = f"{arrival.time:.6g} s"
                findings.append(Finding(Code.WINDOW, f"{name} is met outside its window", over, "s", where))
        law = scene.frames[target.frame].law
        if isinstance(law, Conveyor | Linear):
            findings += _on_conveyor(law, arrival, target)
        elif window.along is not None:
            findings.append(Finding(Code.WINDOW, f"{name} has a window in metres, and is not on a conveyor"))
    return findings


def _on_conveyor(law: Conveyor | Linear, arrival: Arrival, target: Target) -> list[Finding]:
    """Along u, the direction of travel, from the pose that was given for the conveyor (its place at its `at_time`)."""
    name = target.step.name
    velocity = (math.cos(law.pose.yaw), math.sin(law.pose.yaw), 0.0) if isinstance(law, Conveyor) else law.velocity
    length = math.hypot(*velocity)
    u = np.array(velocity) / length if length > 0 else np.array([1.0, 0.0, 0.0])

    def along(t: FloatArray) -> FloatArray:
        return np.asarray((law.motion(t).at(target.point).p - law.pose.position) @ u)

    findings = []
    if arrival.along_m is not None:
        off = abs(arrival.along_m - float(along(np.array(arrival.time))))
        if not off <= MEET_M:
            findings.append(Finding(Code.ARRIVAL, f"{name} is not that far along its conveyor", off, "m"))
    if target.step.window.along is not None:
        low, high = target.step.window.along

        def beyond(_of: IntArray, a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
            ends = np.stack([along(a), along(b)])
            bent = law.bounds(a, b, np.tile(u, (len(a), 1))).acceleration * (b - a) ** 2 / 8
            taken = np.stack([low - ends.min(0), ends.max(0) - high], -1) - MEET_M
            return taken + bent[:, None], taken

        for excess in settle([np.array([arrival.time, arrival.until])], COARSEST_S, beyond):
            where = f"{excess.time:.6g} s"
            findings.append(Finding(Code.WINDOW, f"{name} is outside its window", excess.amount + MEET_M, "m", where))
    return findings
