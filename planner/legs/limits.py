"""Whether a Cartesian leg keeps the joints' limits, by the exact extrema of its spline; and by how much it does not."""

from __future__ import annotations

from dataclasses import dataclass

from planner.outcome import Reason, Refusal
from planner.scene import Scene
from planner.trajectory import Trajectory, check_limits


@dataclass(frozen=True, slots=True)
class Rates:
    """Peaks of velocity, acceleration and jerk over their limits, the worst joint each; `ok`: all are kept."""

    velocity: float
    acceleration: float
    jerk: float
    ok: bool


def rates(scene: Scene, stage: str, step: int, trajectory: Trajectory) -> Rates | Refusal:
    """How fast the leg is; a refusal where a joint position is beyond its limit, which no slowing down mends."""
    limits = scene.robot.limits
    report = check_limits(
        trajectory,
        limits.lower,
        limits.upper,
        limits.velocity,
        limits.acceleration,
        limits.jerk,
    )
    if not report.position.ok:
        joint = report.position.joint or 0
        below = float(limits.lower[joint] - report.position.lower[joint])
        above = float(report.position.upper[joint] - limits.upper[joint])
        what = scene.robot.joints[joint]
        unit = "rad" if what.kind == "revolute" else "m"
        span = (trajectory.start, trajectory.end)
        detail = f"{what.name} is beyond its limit"
        return Refusal(stage, Reason.JOINT_LIMIT, step, (what.name,), span, max(below, above), unit, detail)
    velocity, acceleration, jerk = (float(k.ratio.max()) for k in report.checks[1:])
    return Rates(velocity, acceleration, jerk, report.ok)
