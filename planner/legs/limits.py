"""Whether a Cartesian leg keeps the joints' limits, by the exact extrema of its spline; and by how much it does not."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.model.outcome import Reason, Refusal
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory, check_limits, keeps_limits, keeps_positions, rate_ratios


@dataclass(frozen=True, slots=True, eq=False)
class Rates:
    """Peaks of velocity, acceleration and jerk over their limits, the worst joint each; `ok`: all are kept; `ratios`
    (3, n): those of all joints."""

    velocity: float
    acceleration: float
    jerk: float
    ok: bool
    ratios: FloatArray


def rates(scene: Scene, stage: str, step: int, trajectory: Trajectory) -> Rates | Refusal:
    """How fast the leg is; a refusal where a joint position is beyond its limit, which no slowing down mends."""
    limits = scene.robot.limits
    if not keeps_positions(trajectory, limits.lower, limits.upper):
        return _beyond(scene, stage, step, trajectory)
    ratios, ok = rate_ratios(trajectory, limits.velocity, limits.acceleration, limits.jerk)
    velocity, acceleration, jerk = ratios.max(1).tolist()
    return Rates(velocity, acceleration, jerk, ok, ratios)


def beyond_limits(scene: Scene, step: int, trajectory: Trajectory) -> Refusal | None:
    """Whether a joint breaks a limit on the way: moving ends overshoot, and the spline as written is what counts."""
    limits = scene.robot.limits
    kinds = limits.lower, limits.upper, limits.velocity, limits.acceleration, limits.jerk
    if keeps_limits(trajectory, *kinds):
        return None
    fast = rates(scene, "limits", step, trajectory)
    if isinstance(fast, Refusal):
        return fast
    if fast.ok:
        return None
    return too_fast(scene, "limits", step, fast, "the spline breaks a limit")


def too_fast(scene: Scene, stage: str, step: int, fast: Rates, detail: str) -> Refusal:
    """The refusal of rates that are not `ok`: the joint and the rate whose share of its limit is greatest."""
    limits = scene.robot.limits
    kind, joint = (int(k) for k in np.unravel_index(int(fast.ratios.argmax()), fast.ratios.shape))
    limit = (limits.velocity, limits.acceleration, limits.jerk)[kind]
    what = scene.robot.joints[joint]
    unit = ("rad" if what.kind == "revolute" else "m") + ("/s", "/s²", "/s³")[kind]
    excess = float((fast.ratios[kind, joint] - 1) * limit[joint])
    return Refusal(stage, Reason.MOTION_LIMIT, step, (what.name,), None, excess, unit, detail)


def _beyond(scene: Scene, stage: str, step: int, trajectory: Trajectory) -> Refusal:
    """The joint that is first beyond its limit of position, and by how much at most."""
    limits = scene.robot.limits
    rates = limits.velocity, limits.acceleration, limits.jerk
    position = check_limits(trajectory, limits.lower, limits.upper, *rates).position
    joint = position.joint or 0
    below = float(limits.lower[joint] - position.lower[joint])
    above = float(position.upper[joint] - limits.upper[joint])
    what = scene.robot.joints[joint]
    unit = "rad" if what.kind == "revolute" else "m"
    span = (trajectory.start, trajectory.end)
    detail = f"{what.name} is beyond its limit"
    return Refusal(stage, Reason.JOINT_LIMIT, step, (what.name,), span, max(below, above), unit, detail)
