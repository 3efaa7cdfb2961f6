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
        own, jerk = scene.robot.limits, not scene.options.blended
        lowered = {load.part: scene.limits_with(load.part) for load in scene.loads}
        self._own = _row(own, jerk=jerk)
        self._lowered = {part: _row(each, jerk=jerk) for part, each in lowered.items() if each is not own}

    def over(self, start: float, phases: Sequence[Phase]) -> FloatArray:
        """The limits (N, c.LIMIT) of a plan: the robot's from `start` on, s, and those that each load leaves, for as
        long as it is held."""
        spans = [(self._own, start, phases[-1].t1)]
        if self._lowered:
            for held, group in groupby((phase for phase in phases if phase.step >= 0), key=_held):
                row, all_ = self._lowered.get(held), list(group)
                if row is not None:
                    spans.append((row, all_[0].t0, all_[-1].t1))
        found = np.array([row for row, _, _ in spans])
        found[:, c.LIMIT_T0 : c.LIMIT_JERKS] = [(t0, t1) for _, t0, t1 in spans]
        return found


def _held(phase: Phase) -> str | None:
    """The part that the gripper holds."""
    held = phase.attached.held
    return None if held is None else held.part


def _row(limits: Limits, *, jerk: bool) -> FloatArray:
    row, n = np.zeros(c.LIMIT), len(limits.lower)
    row[c.LIMIT_JERKS], row[c.LIMIT_SHARE : c.LIMIT_LOWER] = jerk, SHARES
    firsts = (c.LIMIT_LOWER, c.LIMIT_UPPER, c.LIMIT_VELOCITY, c.LIMIT_ACCELERATION, c.LIMIT_JERK)[: 4 + jerk]
    for first, values in zip(firsts, limits.table, strict=False):
        row[first : first + n] = values
    return row
