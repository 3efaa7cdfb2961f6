"""Whether a robot with a loop stays in its assembly mode all along a trajectory, proved over intervals.

Between two assembly modes lies a type 2 singularity; a trajectory that keeps its distance from all of them cannot have
changed its mode. Arms without a loop are not looked at.
"""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.model.refusal import Quantity, Reason, Refusal, Singular, Stage
from assur.planner.robots.protocol import Robot
from assur.planner.trajectory import Trajectory
from assur.planner.trajectory.sweep import sweep

COARSEST_S = 0.05
"""Intervals with which a proof begins, s."""
FINEST_S = 2e-5
"""Intervals are halved no further than this, s; the checker goes further before it refuses."""


def has_loop(robot: Robot) -> bool:
    """Whether there are joint vectors for which the robot does not assemble."""
    everywhere = np.full((1, len(robot.joints)), np.inf)
    return not robot.assembled(-everywhere, everywhere).all()


def leaves_assembly(robot: Robot, step: int, trajectory: Trajectory) -> Refusal | None:
    """The first stretch over which the robot is not proved to stay assembled with its least parallel margin."""
    if not has_loop(robot):
        return None
    count = max(1, int(np.ceil(trajectory.duration / COARSEST_S)))
    edges = np.linspace(trajectory.start, trajectory.end, count + 1)
    edges[-1] = trajectory.end
    t0, t1 = edges[:-1], edges[1:]
    while len(t0):
        swept = sweep(trajectory, t0, t1, robot.rate_matrix)
        left = ~robot.assembled(swept.lower, swept.upper)
        t0, t1 = t0[left], t1[left]
        if not len(t0):
            return None
        middle = (t0 + t1) / 2
        margin = robot.parallel_margin(trajectory.evaluate(middle))
        lost = ~(margin >= robot.parallel_least) | ~(t1 - t0 > FINEST_S)
        if lost.any():
            return lost_at(robot, Stage.LIMITS, step, middle[lost], margin[lost])
        t0, t1 = np.concatenate([t0, middle]), np.concatenate([middle, t1])
    return None


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
