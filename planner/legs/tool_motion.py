"""How hard the tool point pulls at the part that it carries."""

from __future__ import annotations

import math

from assur.planner.kernels.postures import tool_peak as sampled_peak
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory

STEP_S = 0.001
"""Sampling of the tool's acceleration while a part is carried, s."""
LEAST = 33
"""... and at least so many instants of an interval: a leg that lasts a millisecond has a peak, too."""
RESERVE = 0.02
"""Share of the carry limit that is left for what lies between samples; the checker bounds it there."""


LIFTED = 0.7
"""Share of the carry limit that the lift uses: what is left for the motion across is as much (√½)."""


def lift_most(scene: Scene, *, carried: bool) -> float:
    """The acceleration, m/s², that the lift keeps to, with a part in the gripper or without."""
    limit = scene.carry_acceleration
    return LIFTED * limit if carried and limit is not None else math.inf


def tool_peak(scene: Scene, trajectory: Trajectory, t0: float, t1: float, step: float = STEP_S) -> tuple[float, float]:
    """Largest acceleration, m/s², of the tool point over [t0, t1], within the trajectory, by samples every `step` s
    (`LEAST` at least), and when."""
    many, tcp = max(LEAST, math.ceil((t1 - t0) / step) + 1), scene.tool.tcp
    return sampled_peak(scene.robot.row, trajectory.edges, trajectory.coefficients, tcp.x, tcp.y, t0, t1, many)


def carrying_peak(scene: Scene, trajectory: Trajectory, phases: tuple[Phase, ...]) -> tuple[float, float] | None:
    """Largest acceleration, m/s², of the tool point while a part is carried, and when; None: nothing is carried."""
    spans = [(p.t0, p.t1) for p in phases if p.attached.held is not None and p.t1 > p.t0 and p.step >= 0]
    return max((tool_peak(scene, trajectory, t0, t1) for t0, t1 in spans), default=None)
