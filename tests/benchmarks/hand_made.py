"""Answers made by hand: joint motions along a straight line, at rest or at a given velocity at the end."""

from __future__ import annotations

import copy
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.judge.spline import Spline
from benchmarks.peers.arm import along as along_a_line
from benchmarks.problem_set import ProblemSet

Floats = NDArray[np.float64]


def problem_set(problem: dict[str, Any]) -> ProblemSet:
    """One problem for a robot with the limits of the shipped sets."""
    limits = {
        "qmin": (-2.3038, -2.618, 0.05, -6.2832),
        "qmax": (2.3038, 2.618, 0.25, 6.2832),
        "vmax": (7.8, 9.4, 2.0, 40.0),
        "amax": (50.0, 80.0, 25.0, 300.0),
        "jmax": (1000.0, 1600.0, 500.0, 6000.0),
    }
    return ProblemSet("hand-made", limits, (problem,))


def joints_at(position: list[float], yaw: float, sign: float) -> Floats:
    """Joint positions (4,) that put the tool there; `sign` of the elbow."""
    found = along_a_line(position, position, (yaw, yaw), sign, 1)[0]
    found[[0, 3]] = np.remainder(found[[0, 3]] + np.pi, 2 * np.pi) - np.pi
    return np.asarray(found)


def along(points: list[Floats], durations: list[float]) -> dict[str, Any]:
    """An answer that goes from point to point (4,) in straight joint lines, stopping at each: quintics of rest to
    rest, whose peaks of velocity, acceleration and jerk are 1.875 D/T, 5.774 D/T² and 60 D/T³."""
    assert len(points) == len(durations) + 1
    time = [0.0]
    for duration in durations:
        time.append(time[-1] + duration)
    still = [[0.0] * 4 for _ in points]
    return answer(time, [point.tolist() for point in points], still, copy.deepcopy(still))


def answer(time: list[float], q: list[list[float]], qd: list[list[float]], qdd: list[list[float]]) -> dict[str, Any]:
    """A line as `benchmarks.run_problems` writes it."""
    trajectory = {"time_s": time, "position": q, "velocity": qd, "acceleration": qdd}
    return {
        "id": "hand-made",
        "status": "planned",
        "match": "position",
        "first_s": 0.01,
        "duration_s": time[-1],
        "trajectory": trajectory,
        "checked": True,
        "reason": None,
    }


def with_more_knots(line: dict[str, Any], knots: int) -> dict[str, Any]:
    """The same motion with `knots` more knots in each piece: a quintic is reproduced from its own states."""
    trajectory = line["trajectory"]
    columns = [np.array(trajectory[name]) for name in ("time_s", "position", "velocity", "acceleration")]
    spline = Spline.through(columns[0], *columns[1:])
    time = np.unique(np.concatenate([np.linspace(a, b, knots + 2) for a, b in pairwise(columns[0])]))
    return answer(time.tolist(), *(spline.evaluate(time, k).tolist() for k in range(3)))
