"""Whether a Cartesian leg keeps the joints' limits, by the exact extrema of its spline; and by how much it does not."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.model.joint_range import beyond
from assur.planner.model.refusal import (
    RATES,
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
    (3, n): those of all joints, without the jerk (2, n) where the acceleration may jump; `limits`: of what they are
    shares."""

    velocity: float
    acceleration: float
    jerk: float
    ok: bool
    ratios: FloatArray
    limits: Limits

    @property
    def ratio(self) -> float:
        """By what the speed of the leg is to be divided for it to reach its limits, if rates scale with it."""
        return max(self.velocity, math.sqrt(self.acceleration), math.pow(self.jerk, 1 / 3))


def rates(scene: Scene, stage: Stage, step: int, trajectory: Trajectory, limits: Limits) -> Rates | Refusal:
    """How fast the leg is for the limits that hold with its load; a refusal where a joint position is beyond its limit,
    which no slowing down mends."""
    report = _report(limits, trajectory)
    if not report.position.ok:
        return _beyond(scene, stage, step, trajectory, report.position)
    ratios = np.stack([check.ratio for check in report.checks[1:]])
    velocity, acceleration, jerk = (*ratios.max(1).tolist(), 0.0)[:3]
    return Rates(velocity, acceleration, jerk, report.ok, ratios, limits)


def _report(limits: Limits, trajectory: Trajectory) -> LimitReport:
    jerk = None if trajectory.jumps else limits.jerk
    return check_limits(trajectory, limits.lower, limits.upper, limits.velocity, limits.acceleration, jerk)


@lru_cache(maxsize=16)
def _bands(limits: Limits, jumps: bool) -> FloatArray:
    """What is accepted of motions within these limits, that of the jerk only where the acceleration does not jump; for
    every robot once."""
    jerk = None if jumps else limits.jerk
    return accepted_bands(limits.lower, limits.upper, limits.velocity, limits.acceleration, jerk)


def beyond_limits(scene: Scene, step: int, trajectory: Trajectory, limits: Limits) -> Refusal | None:
    """Whether a joint breaks one of `limits` on the way: moving ends overshoot, and the spline as written is what
    counts."""
    if keeps_bands(trajectory, _bands(limits, trajectory.jumps)):
        return None
    fast = rates(scene, Stage.LIMITS, step, trajectory, limits)
    if isinstance(fast, Refusal):
        return fast
    if fast.ok:
        return None
    return too_fast(scene, Stage.LIMITS, step, fast)


def parts(trajectory: Trajectory, spans: Sequence[tuple[float, Limits]]) -> list[tuple[Trajectory, Limits]]:
    """The parts of a trajectory with the limits that hold there: `spans` are the times, which are knots, at which they
    end, and their limits; those with the same limits that follow each other are one. Spans of no length have no part.
    """
    if all(limits is spans[0][1] for _, limits in spans):
        return [(trajectory, spans[0][1])]
    found, begin, knots = [], 0, trajectory.knots
    for k, (end, limits) in enumerate(spans):
        if k + 1 < len(spans) and spans[k + 1][1] is limits:
            continue
        last = int(np.searchsorted(knots[:, 0], end)) if k + 1 < len(spans) else len(knots) - 1
        if last > begin:
            found.append((Trajectory.of_knots(knots[begin : last + 1].copy()), limits))
        begin = last
    return found


def too_fast(scene: Scene, stage: Stage, step: int, fast: Rates, frame: str | None = None) -> Refusal:
    """The refusal of rates that are not `ok`: the joint and the rate whose share of its limit is greatest; `frame`:
    which the tool tracks."""
    limits = fast.limits
    kind, joint = (int(k) for k in np.unravel_index(int(fast.ratios.argmax()), fast.ratios.shape))
    limit = float((limits.velocity, limits.acceleration, limits.jerk)[kind][joint])
    what, value = scene.robot.joints[joint], float(fast.ratios[kind, joint]) * limit
    obstacle = Obstacle.FRAME_TOO_FAST if frame else Obstacle.RATE
    return Refusal(
        stage=stage,
        reason=Reason.MOTION_LIMIT,
        step=step,
        subject=JointName(what.name),
        amount=of_joint(what.kind, value - limit, kind + 1),
        facts=MotionLimit(obstacle=obstacle, rate=RATES[kind], frame=frame, value=value, limit=limit),
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
        facts=beyond(scene, joint, float((position.lower if below > above else position.upper)[joint])),
    )
