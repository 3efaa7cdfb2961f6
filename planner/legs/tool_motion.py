"""How fast the tool point is, and how hard it pulls at the part that it carries."""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.kernels.postures import sample_tool_peaks as sampled_peaks
from assur.planner.kernels.postures import tool_rates
from assur.planner.model.outcome import ToolPeaks
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory

STEP_S = 0.001
"""Sampling of the tool's acceleration while a part is carried, s."""
MOST_SAMPLES = 100_000
"""So many samples of one span at most, but for those that each piece of the spline has."""
PARTS = 8
"""... and at least so many parts of a piece of the spline: a depart of some micrometres is over in a few milliseconds,
with the whole of its peak between two samples."""
RESERVE = 0.02
"""Share of the carry limit that is left for what lies between samples; the checker bounds it there."""


LIFTED = 0.7
"""Share of the carry limit that the lift uses: what is left for the motion across is as much (√½)."""


def lift_most(scene: Scene, *, carried: bool) -> float:
    """The acceleration, m/s², that the lift keeps to, with a part in the gripper or without."""
    limit = scene.carry_acceleration
    return LIFTED * limit if carried and limit is not None else math.inf


def tool_peaks(scene: Scene, trajectory: Trajectory, t0: float, t1: float) -> ToolPeaks:
    """The largest speed and acceleration of the tool point over [t0, t1], within the trajectory, and when, by samples
    every `STEP_S` (`PARTS` of each piece of the spline at least) and closer ones around the largest."""
    found, tcp = np.empty(4), scene.tool.tcp
    step = max(STEP_S, (t1 - t0) / MOST_SAMPLES)
    row, edges, c = scene.robot.row, trajectory.edges, trajectory.coefficients
    sampled_peaks(row, edges, c, tcp.x, tcp.y, t0, t1, step, PARTS, found)
    return ToolPeaks(*found.tolist())


def tool_peak(scene: Scene, trajectory: Trajectory, t0: float, t1: float) -> tuple[float, float]:
    """Largest acceleration, m/s², of the tool point over [t0, t1] (`tool_peaks`), and when."""
    found = tool_peaks(scene, trajectory, t0, t1)
    return found.acceleration, found.acceleration_time


def tool_accelerations(scene: Scene, trajectory: Trajectory, t: FloatArray) -> FloatArray:
    """Accelerations (T,), m/s², of the tool point at times t (T,)."""
    rates, tcp = np.empty((2, len(t))), scene.tool.tcp
    tool_rates(scene.robot.row, trajectory.edges, trajectory.coefficients, tcp.x, tcp.y, t, rates)
    return np.asarray(rates[1])


def carrying_peak(scene: Scene, trajectory: Trajectory, phases: tuple[Phase, ...]) -> tuple[float, float] | None:
    """Largest acceleration, m/s², of the tool point while a part is carried, and when; None: nothing is carried."""
    spans = [(p.t0, p.t1) for p in phases if p.attached.held is not None and p.t1 > p.t0 and p.step >= 0]
    return max((tool_peak(scene, trajectory, t0, t1) for t0, t1 in spans), default=None)
