"""Whether a robot with a loop stays in its assembly mode all along a trajectory, proved over intervals.

Between two assembly modes lies a type 2 singularity; a trajectory that keeps its distance from all of them cannot have
changed its mode. Arms without a loop are not checked.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.model.refusal import Quantity, Reason, Refusal, Singular, Stage
from assur.planner.robots.robot import Robot
from assur.planner.trajectory import Trajectory


def has_loop(robot: Robot) -> bool:
    """Whether there are joint vectors for which the robot does not assemble."""
    return robot.parallel_least > 0.0


def leaves_assembly(robot: Robot, step: int, trajectory: Trajectory) -> Refusal | None:
    """The first instant at which the robot is not proved to stay assembled with its least parallel margin."""
    if not has_loop(robot):
        return None
    from assur.planner.kernels.postures import first_lost

    t, margin = first_lost(robot.row, trajectory.spline)
    return None if t == math.inf else lost_at(robot, Stage.LIMITS, step, np.array([t]), np.array([margin]))


def lost_at(robot: Robot, stage: Stage, step: int, t: FloatArray, margin: FloatArray) -> Refusal:
    """The refusal of a way that nears or crosses type 2 at times t (N,), with margins (N,) there."""
    known = np.isfinite(margin)
    least = float(margin.min()) if known.all() else None
    return Refusal(
        stage=stage,
        reason=Reason.NEAR_PARALLEL_SINGULARITY,
        step=step,
        interval=(float(t.min()), float(t.max())),
        amount=Quantity(max(0.0, robot.parallel_least - (least or 0.0)), "1"),
        facts=Singular(margin=least, required=robot.parallel_least),
    )
