"""TOPPRA along a straight line of the tool: the fastest timing of that path; run in the environment of the peers.

It knows limits of velocity and acceleration, none of jerk, so no arm with a limit of jerk is as fast.
"""

from __future__ import annotations

import time
from importlib.metadata import version
from typing import Any

import numpy as np
import toppra
from toppra import algorithm, constraint

from benchmarks.dialogue import Document, answer_lines
from benchmarks.peers.arm import along

POINTS = 41
"""Points of the line, through which a spline goes: it leaves the line by less than 0.1 mm."""
SAMPLES = 201
"""Joint positions given back, to be rechecked."""


def answer(question: Document) -> Document:
    """Duration, time taken and samples for one leg: `start` and `end` (3,), `yaw` at both, `sign` of the elbow."""
    began = time.perf_counter()
    points = along(question["start"], question["end"], tuple(question["yaw"]), question["sign"], POINTS)
    if not np.isfinite(points).all():
        return {"status": "not_planned", "reason": "the line leaves the workspace"}
    way = toppra.SplineInterpolator(np.linspace(0, 1, POINTS), points)
    limits = question["limits"]
    kept = [
        constraint.JointVelocityConstraint(np.array(limits["vmax"])),
        constraint.JointAccelerationConstraint(np.array(limits["amax"])),
    ]
    timed = algorithm.TOPPRA(kept, way, parametrizer="ParametrizeConstAccel").compute_trajectory()
    if timed is None:
        return {"status": "not_planned", "reason": "no timing"}
    elapsed = time.perf_counter() - began
    samples = timed(np.linspace(0, timed.duration, SAMPLES))
    return {
        "status": "planned",
        "elapsed_s": elapsed,
        "duration_s": float(timed.duration),
        "position": samples.tolist(),
    }


def prepare() -> tuple[Document, Any]:
    """Quiet: it tells its warnings to nobody here."""
    toppra.setup_logging("ERROR")
    return {"version": version("toppra")}, answer


if __name__ == "__main__":
    answer_lines(prepare)
