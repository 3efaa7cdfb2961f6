"""How near an arm would be to a singular position, in the words of a refusal: serial and parallel told apart."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.model.outcome import Reason
from assur.planner.robots.protocol import Code, Inverse, Robot


@dataclass(frozen=True, slots=True)
class Near:
    """The singularity that is nearest, by `reason`; its `margin` (no unit), which is `missing` short of what is asked.

    `row`: where.
    """

    reason: Reason
    margin: float
    missing: float
    row: int

    @property
    def words(self) -> str:
        if self.reason is Reason.NEAR_SINGULARITY:
            return f"margin {self.margin:.3f} where {self.margin + self.missing:.3f} is asked"
        asked = f"{self.margin + self.missing:.3f} is asked"
        if self.margin < 0:
            return f"beyond a type 2 singularity, into another assembly (parallel margin {self.margin:.3f}, {asked})"
        return f"parallel margin {self.margin:.3f} where {asked}"


def nearest(robot: Robot, found: Inverse, asked: float, rows: IntArray, *, best: bool) -> Near:
    """The margin that is short by most in the row of `rows` that is best (or worst) in this; NaN is no margin.

    The parallel margin must be `asked` and the robot's own `parallel_least`, whichever is more.
    """
    need = max(asked, robot.parallel_least)
    serial = asked - found.margin[rows]
    parallel = np.full(len(rows), -np.inf) if found.parallel is None else need - found.parallel[rows]
    short: FloatArray = np.fmax(serial, parallel)
    at = int(np.nanargmin(short) if best else np.nanargmax(short))
    if parallel[at] >= serial[at] or (found.code[rows[at]] == Code.PARALLEL):
        return Near(Reason.NEAR_PARALLEL_SINGULARITY, need - float(parallel[at]), float(parallel[at]), int(rows[at]))
    return Near(Reason.NEAR_SINGULARITY, float(found.margin[rows[at]]), float(serial[at]), int(rows[at]))
