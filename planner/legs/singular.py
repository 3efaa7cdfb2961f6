"""How near an arm would be to a singular position, as facts of a refusal: serial and parallel apart."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.model.refusal import Quantity, Reason, Refusal, Singular, Stage, finite
from assur.planner.model.scene import Scene
from assur.planner.robots.facts import Code, Inverse
from assur.planner.robots.robot import Robot
from assur.planner.trajectory import Trajectory

LOOKED_S = 1e-3
"""Margins of a motion that is made are looked at so often, s: knots are farther apart, and between them the arm may
come nearer. The checker allows 1e-3, and at 100 rad/s² an elbow leaves its chord by 1e-5 rad in this time."""
MOST = 100_000
"""So many of these times at most, where the arm moves; where it stands still there are none."""


@dataclass(frozen=True, slots=True)
class Near:
    """The singularity that is nearest, by `reason`; its `margin` (no unit), which is `missing` short of what is asked.

    `row`: where.
    """

    reason: Reason
    margin: float
    missing: float
    row: int

    def refusal(
        self,
        stage: Stage,
        step: int,
        interval: tuple[float, float],
        *,
        mode: str | None = None,
        distance_m: float | None = None,
        positions: tuple[str, ...] = (),
    ) -> Refusal:
        """The refusal at a stage and step; the rest as in `Singular`."""
        margin, required = finite(self.margin), finite(self.margin + self.missing)
        return Refusal(
            stage=stage,
            reason=self.reason,
            step=step,
            interval=interval,
            amount=Quantity.of(self.missing, "1"),
            facts=Singular(margin=margin, required=required, mode=mode, positions=positions, distance_m=distance_m),
        )


class Margins(NamedTuple):
    """Code and margins of postures, (N,), as `Inverse` has them."""

    code: IntArray
    margin: FloatArray
    parallel: FloatArray | None


def nearest(robot: Robot, found: Inverse | Margins, asked: float, rows: IntArray, *, best: bool) -> Near:
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


def too_near(scene: Scene, stage: Stage, step: int, trajectory: Trajectory, t0: float, t1: float) -> Refusal | None:
    """Whether the arm comes nearer to a singular position than `singularity_margin` over [t0, t1] of a motion."""
    asked, robot = scene.options.singularity_margin, scene.robot
    if not (asked > 0.0 and t1 > t0):
        return None
    t = _looked_at(trajectory, t0, t1)
    q = trajectory.evaluate(t)
    margin, parallel = robot.margin(q), robot.parallel_margin(q) if robot.parallel_least > 0.0 else None
    kept = margin >= asked if parallel is None else (margin >= asked) & (parallel >= asked)
    if kept.all():
        return None
    rows = np.flatnonzero(~kept)
    near = nearest(robot, Margins(robot.singularity(q), margin, parallel), asked, rows, best=False)
    return near.refusal(stage, step, (float(t[rows[0]]), float(t[rows[-1]])))


def _looked_at(trajectory: Trajectory, t0: float, t1: float) -> FloatArray:
    """Times (T,) from t0 to t1, `LOOKED_S` apart at most where the arm moves for no longer than `MOST` of these."""
    inside = (trajectory.time > t0) & (trajectory.time < t1)
    edges = np.unique(np.concatenate([[t0], trajectory.time[inside], [t1]]))
    middles = trajectory.evaluate(0.5 * (edges[1:] + edges[:-1]))
    ends = trajectory.evaluate(edges)
    moves = (ends[1:] != ends[:-1]).any(axis=1) | (middles != ends[1:]).any(axis=1)
    lengths = np.diff(edges)
    apart = max(LOOKED_S, float(lengths[moves].sum()) / MOST)
    counts = np.where(moves, np.ceil(lengths / apart), 1).astype(np.int64)
    within = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    return np.append(within * np.repeat(lengths / counts, counts) + np.repeat(edges[:-1], counts), t1)
