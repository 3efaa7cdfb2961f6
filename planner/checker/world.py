"""A scene and a plan as the checker's kernels see them, and their questions as Python asks them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker import along, motion
from assur.planner.checker.laws import tables
from assur.planner.checker.spline import QD, joints
from assur.planner.frames.motion import Pose
from assur.planner.model.outcome import Plan
from assur.planner.model.scene import Scene

REST = 1e-9
"""A joint slower than this is at rest, rad/s or m/s (and rad/s², m/s²): in an hour it goes 4 µm."""


@dataclass(frozen=True, slots=True)
class State:
    """Of a frame at an instant: position (3,), yaw, velocity (3,), yaw rate, in the world."""

    p: FloatArray
    yaw: float
    v: FloatArray
    yaw_d: float


@dataclass(frozen=True, slots=True)
class Excess:
    """Quantity number `column` exceeds what is allowed by `amount` at `time`, or could not be shown not to."""

    column: int
    amount: float
    time: float
    decided: bool


class World:
    """The tables of a scene and a plan; carriers are links (0..L-1) and frames behind them."""

    def __init__(self, scene: Scene, plan: Plan) -> None:
        self.scene, self.plan, self.knots = scene, plan, plan.trajectory
        self.until = plan.trajectory.end + scene.options.stay_safe_s + scene.execution.start_tolerance_s
        self.tables = tables(scene, plan.trajectory, self.until)
        self.links = len(scene.robot.links)
        self.flange = self.links - 1
        self.frame = {name: self.links + k for k, name in enumerate(scene.frames)}

    @property
    def start(self) -> float:
        return float(self.knots.time[0])

    @property
    def end(self) -> float:
        return float(self.knots.time[-1])

    @property
    def at_rest(self) -> bool:
        """Whether the last knot is at rest up to `REST`."""
        return bool((np.abs(self.tables[1][self._last, QD:]) <= REST).all())

    @property
    def _last(self) -> int:
        return int(self.tables[0][0, motion.LAST_KNOT])

    def joints(self, t0: float, t1: float) -> FloatArray:
        """Bounds (n, 6) of q, q̇ and q̈ over [t0, t1]: low and high of each; over an instant, their values."""
        n, found = self.knots.q.shape[1], np.zeros((8, 6))
        joints(self.tables[1], 0, self._last, n, t0, t1, np.empty((4, 6)), found)
        return found[:n]

    def state(self, carrier: int, pose: Pose, t: float) -> State:
        """Motion of a frame at `pose` in a carrier; NaN where it is not known."""
        found = np.zeros(8)
        if not along.state(carrier, _four(pose), t, self.links, self.tables, found):
            found[:] = np.nan
        return State(found[:3], float(found[3]), found[4:7], float(found[7]))

    def place(self, carrier: int, t: float) -> tuple[FloatArray, FloatArray]:
        """Position (3,) and rotation (3, 3) of a carrier."""
        jets = np.full((len(self.tables[2]) + self.links + motion.MOST_LINKS, motion.JETS, 6), np.nan)
        motion.carry(carrier if carrier >= self.links else 0, self.links, t, t, self.tables, jets)
        return jets[carrier, :3, 0], jets[carrier, 3:, 0].reshape(3, 3).T

    def tool(self, t: float) -> State:
        """Motion of the tool point."""
        return self.state(self.flange, self.scene.tool.tcp, t)

    def tilt(self, t: float) -> tuple[float, float, float, float]:
        """Pitch and roll of the hand of an arm with five axes, and their rates: sums of joints (H2)."""
        q = self.joints(t, t)
        return float(q[1:4, 0].sum()), float(q[4, 0]), float(q[1:4, 2].sum()), float(q[4, 2])

    def keeps(self, kind: int, asked: Sequence[tuple[int, float]], t0: float, t1: float) -> Excess | None:
        """Whether nothing is exceeded over [t0, t1], `asked` having what is in some columns (`along`)."""
        row, found = np.zeros(along.NUMBERS), np.zeros(4)
        row[along.FRAME] = self.flange
        row[along.TCP : along.TCP + 4] = _four(self.scene.tool.tcp)
        for column, value in asked:
            row[column] = value
        along.keeps(kind, row, t0, t1, self.links, self.tables, found)
        if found[0] == 0.0:
            return None
        return Excess(int(found[1]), float(found[2]), float(found[3]), bool(found[0] == 1.0))


def _four(pose: Pose) -> FloatArray:
    return np.array([pose.x, pose.y, pose.z, pose.yaw])
