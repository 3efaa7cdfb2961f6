"""How the tool point moves in the world, and how hard it pulls at the part it carries."""

from __future__ import annotations

import numpy as np

from planner.arrays import FloatArray
from planner.frames.motion import Motion
from planner.phases import Phase
from planner.scene import Scene
from planner.trajectory import Trajectory

STEP_S = 0.001
"""Sampling of the tool's acceleration while a part is carried, s."""
RESERVE = 0.02
"""Share of the carry limit that is left for what lies between samples; the checker bounds it there."""


def tool_motion(scene: Scene, trajectory: Trajectory, t: FloatArray) -> Motion:
    """Motion of the tool point in the world at times t (T,)."""
    robot = scene.robot
    q, qd, qdd, qddd = (trajectory.evaluate(t, order) for order in range(4))
    return robot.link_motion(robot.links.index("flange"), q, qd, qdd, qddd).at(scene.tool.tcp)


def carrying_peak(scene: Scene, trajectory: Trajectory, phases: tuple[Phase, ...]) -> tuple[float, float] | None:
    """Largest acceleration, m/s², of the tool point while a part is carried, and when; None: nothing is carried."""
    best: tuple[float, float] | None = None
    for phase in phases:
        if phase.carried is None or not phase.t1 > phase.t0 or phase.step < 0:
            continue
        t = np.linspace(phase.t0, phase.t1, max(2, int(np.ceil((phase.t1 - phase.t0) / STEP_S)) + 1))
        pull = np.sqrt((tool_motion(scene, trajectory, t).a ** 2).sum(-1))
        top = int(np.argmax(pull))
        if best is None or pull[top] > best[0]:
            best = float(pull[top]), float(t[top])
    return best
