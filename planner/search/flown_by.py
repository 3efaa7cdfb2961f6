"""Vias that are flown by: where the arm goes on from one, and that it does not stop there while a joint goes on."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.legs.branch import Branch
from assur.planner.legs.control_point import control_point
from assur.planner.legs.tilt import tilts
from assur.planner.model.refusal import Obstacle, Refusal, Stage, unmoved
from assur.planner.model.scene import Scene
from assur.planner.search.partial_plan import PartialPlan
from assur.planner.trajectory import Trajectory

RESTS = 1e-6
"""rad/s or m/s. An arm all of whose joints are slower than this stops, as the checker counts it."""
BESIDE_S = 0.01
"""How long before and after a via the way of each joint is compared, s, as in the checker."""
WAY = 1e-9
"""rad or m. A joint that goes a shorter way in this time stands."""


def ahead(scene: Scene, partial: PartialPlan, branch: Branch) -> FloatArray | None:
    """Joints (n,) near those of the control point behind the next one, for a via that is met as `branch` says and is
    flown by; None: no such. They are those that come quickest in the mode of the via, or else in another one that is
    allowed."""
    step = scene.task[partial.step]
    if not step.via or partial.step + 1 >= len(scene.task):
        return None
    robot, q = scene.robot, branch.q[0]
    others = range(len(robot.modes)) if scene.options.elbow == "auto" else ()
    velocity = partial.attached.limits(scene).velocity
    for mode in dict.fromkeys((branch.mode, *others)):
        best: tuple[float, FloatArray] | None = None
        for tilt in tilts(scene, scene.task[partial.step + 1], q):
            behind = control_point(scene, partial.step + 1, partial.attached, 0.0, tilt)
            motion = behind.flange(np.array([partial.state.time]), behind.approach)
            found = robot.inverse(motion, mode, 0).q[0]
            if not np.isfinite(found).all():
                continue
            there = found + robot.revolute * 2 * np.pi * np.round((q - found) / (2 * np.pi))
            takes = float((np.abs(there - q) / velocity).max())
            if best is None or takes < best[0]:
                best = takes, np.asarray(there)
        if best is not None:
            return best[1]
    return None


def stops_at_via(scene: Scene, partial: PartialPlan, trajectory: Trajectory) -> Refusal | None:
    """Why a motion may not go on from a via at which the arm is at rest: a joint goes on in its direction. A stop is
    allowed only where all joints that move turn round."""
    before = scene.task[partial.step - 1] if partial.step > 0 else None
    if before is None or not before.via or before.leg != "joint" or partial.knots is None:
        return None
    state, done = partial.state, Trajectory.of_knots(partial.knots.table)
    if not np.abs(state.qd).max() <= RESTS or not done.start < state.time < trajectory.end:
        return None
    times = max(done.start, state.time - BESIDE_S), min(trajectory.end, state.time + BESIDE_S)
    came, goes = (
        state.q - done.evaluate(np.array(times[:1]), 0)[0],
        trajectory.evaluate(np.array(times[1:]), 0)[0] - state.q,
    )
    goes_on = (np.minimum(np.abs(came), np.abs(goes)) > WAY) & (came * goes > 0.0)
    return unmoved(Stage.TIMING, partial.step, Obstacle.STOPS_AT_VIA) if goes_on.any() else None
