"""How the tool point moves in the world, and how hard it pulls at the part it carries."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Motion
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory

STEP_S = 0.001
"""Sampling of the tool's acceleration while a part is carried, s."""
RESERVE = 0.02
"""Share of the carry limit that is left for what lies between samples; the checker bounds it there."""


def tool_motion(scene: Scene, trajectory: Trajectory, t: FloatArray) -> Motion:
    """Motion of the tool point in the world at times t (T,) within the trajectory, up to its acceleration: its jerk is
    that of joints which have none."""
    robot = scene.robot
    q, qd, qdd = trajectory.states_on_piece(*trajectory.piece(t))
    return robot.link_motion(robot.links.index("flange"), q, qd, qdd, np.zeros_like(q)).at(scene.tool.tcp)


def tool_peak(scene: Scene, trajectory: Trajectory, t0: float, t1: float) -> tuple[float, float]:
    """Largest acceleration, m/s², of the tool point over [t0, t1], within the trajectory, by samples of `STEP_S`, and
    when."""
    t = np.linspace(t0, t1, max(2, int(np.ceil((t1 - t0) / STEP_S)) + 1))
    pull = np.sqrt((tool_motion(scene, trajectory, t).a ** 2).sum(-1))
    top = int(np.argmax(pull))
    return float(pull[top]), float(t[top])


def carrying_peak(scene: Scene, trajectory: Trajectory, phases: tuple[Phase, ...]) -> tuple[float, float] | None:
    """Largest acceleration, m/s², of the tool point while a part is carried, and when; None: nothing is carried."""
    spans = [(p.t0, p.t1) for p in phases if p.attached.held is not None and p.t1 > p.t0 and p.step >= 0]
    return max((tool_peak(scene, trajectory, t0, t1) for t0, t1 in spans), default=None)
