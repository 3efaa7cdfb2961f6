"""A scene and a plan as the checker's kernels see them, and their questions as Python asks them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker import along, motion
from assur.planner.checker.laws import tables
from assur.planner.checker.spline import joints
from assur.planner.frames.motion import Pose
from assur.planner.model.outcome import Plan
from assur.planner.model.scene import Scene

REST = 1e-9
"""A joint slower than this is at rest, rad/s or m/s (and rad/s², m/s²): in an hour it goes 4 µm."""


class State(NamedTuple):
    """Of a frame at an instant: position, yaw and their rates in the world; pitch and roll of the hand of an arm with
    five axes and their rates, and the speed of the fastest joint. NaN where it is not known."""

    x: float
    y: float
    z: float
    yaw: float
    vx: float
    vy: float
    vz: float
    yaw_d: float
    pitch: float
    roll: float
    pitch_d: float
    roll_d: float
    fastest: float

    @property
    def p(self) -> tuple[float, float, float]:
        return self[:3]

    @property
    def v(self) -> tuple[float, float, float]:
        return self[4:7]


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
        self.start, self.end = plan.trajectory.start, plan.trajectory.end
        shifts = [frame.uncertainty.shift_s for frame in scene.frames.values()]
        early, late = min((low for low, _ in shifts), default=0.0), max((high for _, high in shifts), default=0.0)
        self.until = self.end + scene.options.stay_safe_s + scene.execution.start_tolerance_s - early
        self.tables = tables(scene, plan.trajectory, self.start - late, self.until)
        self.links = len(scene.robot.links)
        self.flange = self.links - 1
        self.frame = {name: self.links + k for k, name in enumerate(scene.frames)}

    @cached_property
    def at_rest(self) -> bool:
        """Whether the last knot is at rest up to `REST`."""
        return all(abs(rate) <= REST for rates in (self.knots.qd, self.knots.qdd) for rate in rates[-1].tolist())

    def joints(self, t0: float, t1: float) -> FloatArray:
        """Bounds (n, 6) of q, q̇ and q̈ over [t0, t1]: low and high of each; over an instant, their values."""
        found = np.zeros((8, 6))
        joints(self.tables[1], 0, len(self.knots.time) - 1, self.knots.n, t0, t1, found)
        return found[: self.knots.n]

    def states(self, asked: Sequence[tuple[int, Pose, float]]) -> list[State]:
        """Motion of frames at poses in carriers, each at a time."""
        where = np.array([(carrier, pose.x, pose.y, pose.z, pose.yaw, t) for carrier, pose, t in asked], np.float64)
        found = np.empty((len(where), len(State._fields)))
        along.states(where, self.tables, found)
        return [State._make(row) for row in found.tolist()]

    def tool(self, t: float) -> State:
        """Motion of the tool point."""
        return self.states([(self.flange, self.scene.tool.tcp, t)])[0]

    def place(self, carrier: int, t: float) -> tuple[FloatArray, FloatArray]:
        """Position (3,) and rotation (3, 3) of a carrier."""
        jets = motion.all_jets(self.tables) * np.nan
        motion.carry(carrier if carrier >= self.links else 0, t, t, self.tables, jets)
        return jets[carrier, :3, 0], jets[carrier, 3:, 0].reshape(3, 3).T

    def relative(self, carrier: int, spans: FloatArray) -> FloatArray:
        """How the tool point moves as it is seen from a frame, over intervals (N, 2): as `along.relative` has it."""
        tcp, found = self.scene.tool.tcp, np.empty((len(spans), along.RELATIVE))
        pose = np.array([tcp.x, tcp.y, tcp.z, tcp.yaw])
        along.relative(np.ascontiguousarray(spans), carrier, pose, self.tables, found)
        return found

    def keeps(self, kind: int, asked: Sequence[tuple[int, float]], t0: float, t1: float) -> Excess | None:
        """Whether nothing is exceeded over [t0, t1], `asked` having what is in some columns (`along`)."""
        row, found, tcp = np.zeros(along.NUMBERS), np.zeros(4), self.scene.tool.tcp
        row[along.FRAME] = self.flange
        row[along.TCP : along.TCP + 4] = tcp.x, tcp.y, tcp.z, tcp.yaw
        for column, value in asked:
            row[column] = value
        along.keeps(kind, row, t0, t1, self.tables, found)
        if found[0] == 0.0:
            return None
        return Excess(int(found[1]), float(found[2]), float(found[3]), bool(found[0] == 1.0))
