"""Whether the tool point's acceleration keeps its limit while a part is held.

In a piece of the spline the acceleration is smooth. Over a short interval it is the cubic through its values and its
slopes (the jerk) at both ends, which stays among its control values, up to h⁴/384 of its fourth derivative; that
remainder is not bounded but measured in the middle, where it is greatest, and counted twice (equation V3).
"""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.checker.settle import settle
from assur.planner.checker.spline import Spline
from assur.planner.checker.verdict import Code, Finding
from assur.planner.frames.motion import Motion
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene

CARRY = 1e-6
"""Relative. What anyone may find over a limit; the limit itself is an estimate of a gripper's grip."""
COARSEST_S = 0.002
"""Length of the intervals to begin with, s: remainders go with h⁴ and are then below 1e-6 of the acceleration."""


def carried(scene: Scene, line: Spline, phases: tuple[Phase, ...]) -> list[Finding]:
    """A finding for each phase in which the limit is broken."""
    limit = scene.carry_acceleration
    if limit is None:
        return []
    held = [phase for phase in phases if phase.carried is not None and phase.t0 < line.end]
    items = []
    for phase in held:
        inner = line.time[(line.time > phase.t0) & (line.time < phase.t1)]
        items.append(np.concatenate([[phase.t0], inner, [min(phase.t1, line.end)]]))
    return [
        Finding(Code.CARRY, f"the tool accelerates too hard in {held[e.of].kind}", e.amount, "m/s²", f"{e.time:.6g} s")
        for e in settle(items, COARSEST_S, _Judge(scene, line, limit))
    ]


class _Judge:
    """The acceleration's excess over the limit, for `settle`."""

    def __init__(self, scene: Scene, line: Spline, limit: float) -> None:
        self.scene, self.line, self.limit = scene, line, limit

    def __call__(self, _of: IntArray, a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
        line, middle = self.line, (a + b) / 2
        piece, _ = line.place(middle)
        begin, length = line.time[piece], line.length[piece]
        at = [self._motion(piece, np.clip((t - begin) / length, 0.0, 1.0)) for t in (a, middle, b)]
        h = (b - a)[:, None]
        cubic = np.stack([at[0].a, at[0].a + h * at[0].j / 3, at[2].a - h * at[2].j / 3, at[2].a])
        sizes = [_size(cubic[k]) for k in range(4)]
        off = _size(at[1].a - (cubic[0] + 3 * cubic[1] + 3 * cubic[2] + cubic[3]) / 8)
        taken = np.maximum.reduce([sizes[0], sizes[3], _size(at[1].a)])
        bound = np.maximum(np.maximum.reduce(sizes), taken) + 2 * off
        allowed = self.limit * (1 + CARRY)
        return (bound - allowed)[:, None], (taken - allowed)[:, None]

    def _motion(self, piece: IntArray, s: FloatArray) -> Motion:
        robot = self.scene.robot
        state = self.line.inside(piece, s)
        return robot.link_motion(robot.links.index("flange"), *state).at(self.scene.tool.tcp)


def _size(vector: FloatArray) -> FloatArray:
    return np.asarray(np.sqrt((vector * vector).sum(-1)))
