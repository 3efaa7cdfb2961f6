"""How a plan will be run, as far as that is not known exactly."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from assur.planner.errors import InputError
from assur.planner.laws.law import Frame
from assur.planner.robots.robot import Robot


@dataclass(frozen=True, slots=True)
class Execution:
    """How the plan will be run: how far each joint lags behind the trajectory, `lag` (n,) rad or m (empty: not at all),
    dispatch up to `start_tolerance_s` late, and whether the controller shifts legs that track a belt by its live
    encoder (`belt_correction`; `Scene.corrects`)."""

    lag: tuple[float, ...] = ()
    start_tolerance_s: float = 0.0
    belt_correction: bool = False

    @property
    def lags(self) -> bool:
        return any(self.lag)


AS_PLANNED = Execution()
"""No joint lags, the start is on time, and nothing is corrected."""


def check_execution(execution: Execution, robot: Robot, tracked: Sequence[Frame]) -> None:
    """Accept what has known bounds. `tracked`: the frames that steps may follow.

    Raises `InputError` naming the field, its value and what is allowed.
    """
    n = len(robot.joints)
    if execution.lag and len(execution.lag) != n:
        raise InputError("execution.lag", len(execution.lag), f"{n} joints of {robot.name}")
    if not all(0.0 <= amount < math.inf for amount in (*execution.lag, execution.start_tolerance_s)):
        raise InputError("execution", execution.lag, "finite numbers from 0 on")
    if execution.belt_correction and (robot.yaw_joints is None or "yaw" not in robot.coordinates):
        # without a wrist the tool would turn with the arm
        allowed = f"false: how a correction moves the links is known for SCARAs with a wrist, and {robot.name} is none"
        raise InputError("execution.belt_correction", True, allowed)
    for frame in tracked if execution.belt_correction else ():
        line = frame.law.line
        rises = line is not None and line[2] != 0.0
        if rises and (frame.uncertainty.position_m > 0.0 or frame.uncertainty.speed_m_s > 0.0):
            allowed = f"false: {frame.name} rises, and the range of the lift is not proved for corrections upwards"
            raise InputError("execution.belt_correction", True, allowed)
