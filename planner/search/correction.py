"""Whether the joints keep their ranges, and the arm its reach, where a belt correction shifts the tool."""

from __future__ import annotations

import numpy as np

from assur.planner.claim.frames import displaced_of
from assur.planner.claim.obligations import shares_of
from assur.planner.collision.pairs import shift_of
from assur.planner.kernels.postures import FITS, SINGULAR, correction_fits
from assur.planner.model.phases import Phase
from assur.planner.model.refusal import Corrected, JointName, Quantity, Reason, Refusal, Stage, of_joint
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory
from assur.planner.trajectory.spline import spline_table


def shifted_out(scene: Scene, step: int, trajectory: Trajectory, phases: list[Phase]) -> Refusal | None:
    """Why the motion of these phases cannot be corrected as far as may be needed."""
    if not scene.execution.belt_correction:
        return None
    robot, execution = scene.robot, scene.execution
    spline, lag = spline_table(trajectory), np.zeros(trajectory.n)
    if execution.lags:
        lag[:] = execution.lag
    motion = (robot.row, np.zeros((0, 1)), np.zeros((0, 1)), spline.tk, spline.c, spline.whole)
    displaced = displaced_of(scene)
    for phase, shares in zip(phases, shares_of(scene, phases), strict=True):
        shift = shift_of(displaced, shares)
        if not any(shift) or not phase.robot:
            continue
        clock = np.array([scene.start.time, execution.start_tolerance_s, *shift])
        found = np.empty(2)
        doubt = (np.zeros((0, 1)), lag, clock)
        joint = correction_fits(motion, robot.limits.table, doubt, phase.t0, phase.t1, found)
        if joint == FITS:
            continue
        when = float(found[0])
        most = shift[0] + shift[1] * max(when + execution.start_tolerance_s - scene.start.time, 0.0)
        named = None if joint == SINGULAR else robot.joints[joint]
        return Refusal(
            stage=Stage.LIMITS,
            reason=Reason.NEAR_SINGULARITY if named is None else Reason.JOINT_LIMIT,
            step=step,
            subject=None if named is None else JointName(named.name),
            interval=(when, when),
            amount=Quantity.of(most, "m") if named is None else of_joint(named.kind, float(found[1])),
            facts=Corrected(shift_m=most, joint=None if named is None else named.name),
        )
    return None
