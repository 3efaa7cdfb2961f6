"""Whether a Cartesian leg keeps the joints' limits, by the exact extrema of its spline; and by how much it does not."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.model.refusal import (
    RATES,
    BeyondRange,
    JointName,
    MotionLimit,
    Obstacle,
    Reason,
    Refusal,
    Stage,
    of_joint,
)
from assur.planner.model.scene import Scene
from assur.planner.robots.facts import Limits
from assur.planner.trajectory import LimitCheck, LimitReport, Trajectory, accepted_bands, check_limits, keeps_bands


@dataclass(frozen=True, slots=True, eq=False)
class Rates:
    """Peaks of velocity, acceleration and jerk over their limits, the worst joint each; `ok`: all are kept; `ratios`
    (3, n): those of all joints."""

    velocity: float
    acceleration: float
    jerk: float
    ok: bool
    ratios: FloatArray


def rates(scene: Scene, stage: Stage, step: int, trajectory: Trajectory) -> Rates | Refusal:
    """How fast the leg is; a refusal where a joint position is beyond its limit, which no slowing down mends."""
    report = _report(scene.robot.limits, trajectory)
    if not report.position.ok:
        return _beyond(scene, stage, step, trajectory, report.position)
    ratios = np.stack([check.ratio for check in report.checks[1:]])
    velocity, acceleration, jerk = ratios.max(1).tolist()
    return Rates(velocity, acceleration, jerk, report.ok, ratios)


def _report(limits: Limits, trajectory: Trajectory) -> LimitReport:
    kinds = limits.lower, limits.upper, limits.velocity, limits.acceleration, limits.jerk
    return check_limits(trajectory, *kinds)


@lru_cache(maxsize=16)
def _bands(limits: Limits) -> FloatArray:
    """What is accepted of motions within these limits; for every robot once."""
    return accepted_bands(limits.lower, limits.upper, limits.velocity, limits.acceleration, limits.jerk)


def beyond_limits(scene: Scene, step: int, trajectory: Trajectory) -> Refusal | None:
    """Whether a joint breaks a limit on the way: moving ends overshoot, and the spline as written is what counts."""
    if keeps_bands(trajectory, _bands(scene.robot.limits)):
        return None
    fast = rates(scene, Stage.LIMITS, step, trajectory)
    if isinstance(fast, Refusal):
        return fast
    if fast.ok:
        return None
    return too_fast(scene, Stage.LIMITS, step, fast)


def too_fast(scene: Scene, stage: Stage, step: int, fast: Rates, frame: str | None = None) -> Refusal:
    """The refusal of rates that are not `ok`: the joint and the rate whose share of its limit is greatest; `frame`:
    which the tool tracks."""
    limits = scene.robot.limits
    kind, joint = (int(k) for k in np.unravel_index(int(fast.ratios.argmax()), fast.ratios.shape))
    limit = (limits.velocity, limits.acceleration, limits.jerk)[kind]
    what = scene.robot.joints[joint]
    excess = float((fast.ratios[kind, joint] - 1) * limit[joint])
    return Refusal(
        stage=stage,
        reason=Reason.MOTION_LIMIT,
        step=step,
        subject=JointName(what.name),
        amount=of_joint(what.kind, excess, kind + 1),
        facts=MotionLimit(obstacle=Obstacle.FRAME_TOO_FAST if frame else Obstacle.RATE, rate=RATES[kind], frame=frame),
    )


def _beyond(scene: Scene, stage: Stage, step: int, trajectory: Trajectory, position: LimitCheck) -> Refusal:
    """The joint that is farthest beyond its limit of position for its range, and by how much."""
    limits, joint = scene.robot.limits, position.joint or 0
    below = float(limits.lower[joint] - position.lower[joint])
    above = float(position.upper[joint] - limits.upper[joint])
    what = scene.robot.joints[joint]
    return Refusal(
        stage=stage,
        reason=Reason.JOINT_LIMIT,
        step=step,
        subject=JointName(what.name),
        interval=(trajectory.start, trajectory.end),
        amount=of_joint(what.kind, max(below, above)),
        facts=BeyondRange(),
    )
