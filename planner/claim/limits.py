"""Limits of the joints, and for which time: a load changes them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.claim import columns as c
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene
from assur.planner.robots.facts import Limits

SHARES = (1e-9, 1e-9, 1e-9, 1e-6)
"""Of half the range, velocity, acceleration and jerk, beyond the limit: rounding of knots on a limit."""


class JointLimits:
    """The rows of a scene's limits without their times: of the robot, and of it with each load that lowers them."""

    def __init__(self, scene: Scene) -> None:
        own, jerk = scene.robot.limits, scene.options.jerk_limited
        lowered = {load.part: scene.limits_with(load.part) for load in scene.loads}
        self._own = _row(own, jerk=jerk)
        self._lowered = {part: _row(each, jerk=jerk) for part, each in lowered.items() if each is not own}

    def over(self, start: float, phases: Sequence[Phase]) -> FloatArray:
        """The limits (N, c.LIMIT) of a plan: the robot's from `start` on, s, and those that each load leaves, for as
        long as it is held."""
        loads = loads_of(phases) if self._lowered else []
        spans = [(part, t0, t1) for part, t0, t1 in loads if part in self._lowered]
        found = np.array([self._own, *(self._lowered[part] for part, _, _ in spans)])
        found[:, c.LIMIT_T0 : c.LIMIT_JERKS] = [(start, phases[-1].t1), *((t0, t1) for _, t0, t1 in spans)]
        return found


def loads_of(phases: Sequence[Phase]) -> list[tuple[str | None, float, float]]:
    """What the gripper holds on the legs of a plan, from when to when, s."""
    found = []
    for part, group in groupby((phase for phase in phases if phase.step >= 0), key=lambda phase: phase.attached.part):
        own = list(group)
        found.append((part, own[0].t0, own[-1].t1))
    return found


def _row(limits: Limits, *, jerk: bool) -> FloatArray:
    row, n = np.zeros(c.LIMIT), len(limits.lower)
    row[c.LIMIT_JERKS], row[c.LIMIT_SHARE : c.LIMIT_LOWER] = jerk, SHARES
    firsts = (c.LIMIT_LOWER, c.LIMIT_UPPER, c.LIMIT_VELOCITY, c.LIMIT_ACCELERATION, c.LIMIT_JERK)[: 4 + jerk]
    for first, values in zip(firsts, limits.table, strict=False):
        row[first : first + n] = values
    return row
