"""All that a plan promises, looked at as it is planned."""

from __future__ import annotations

import numpy as np

from benchmarks.oracle.apart_kept import apart_kept
from benchmarks.oracle.arrivals_kept import Targets, arrivals_kept
from benchmarks.oracle.faults import Broken, beyond
from benchmarks.oracle.hands_kept import hands_kept
from benchmarks.oracle.joints_kept import joints_kept
from benchmarks.oracle.motion import Motion
from benchmarks.oracle.traces_kept import traces_kept
from benchmarks.oracle.ways_kept import ways_kept
from benchmarks.soak.poses import Document

TOOL = 0.05
"""By so much of it the tool's speed may exceed the peak that is told, between the instants at which it is searched."""


def broken_promises(request: Document, answer: Document) -> list[Broken]:
    """What a planned answer promises and does not keep; `request` in SI, of a kind that the oracle knows."""
    motion = Motion(request, answer)
    targets = Targets(motion)
    return [
        *joints_kept(motion),
        *arrivals_kept(motion, targets),
        *ways_kept(motion, targets),
        *traces_kept(motion),
        *apart_kept(motion),
        *hands_kept(motion),
        *_tool(motion),
    ]


def _tool(motion: Motion) -> list[Broken]:
    """The tool point's peak of speed is there, and nowhere is it much more."""
    told, h = motion.answer["margins"]["tool"], 1e-5
    t = np.linspace(motion.start_s + h, motion.end_s - h, max(int((motion.end_s - motion.start_s) / 5e-4), 10))
    speed = np.linalg.norm(motion.tool(t + h).p - motion.tool(t - h).p, axis=1) / (2.0 * h)
    found = beyond(
        "tool", "speed", float(speed.max()), told["speed_m_s"] * (1.0 + TOOL) + 1e-6, float(t[speed.argmax()])
    )
    at = min(max(float(told["speed_at_s"]), motion.start_s + h), motion.end_s - h)
    there = motion.tool(np.array([at - h, at + h])).p
    off = abs(float(np.linalg.norm(there[1] - there[0])) / (2.0 * h) - float(told["speed_m_s"]))
    return found + beyond("tool", "speed, as told", off, 1e-3 * float(told["speed_m_s"]) + 1e-4, at)
