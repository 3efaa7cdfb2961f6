"""Curves of a motion to draw: joints with three derivatives, and speed and acceleration of the tool point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory
from assur.scenes.view.thinning import needed_of_curves

ORDERS = 4
"""Position, velocity, acceleration, jerk."""
PER_PIECE, MOST_SAMPLES = 24, 40_000
"""Samples of each piece of the spline before thinning, and largest number of them in all."""
OFF = 0.002
"""Allowed error of a drawn curve, as a fraction of its limit (of a position: of its range) ..."""
MOST_KEPT = 1_500
"""... unless that needs more samples than this: then the allowed error is doubled, as often as necessary."""


@dataclass(frozen=True, eq=False)
class Curves:
    """`joints` (T, 4, n): position and three derivatives in the planner's convention, SI; `tool` (T, 2): speed, m/s,
    and acceleration, m/s², of the tool point; at times (T,), s. A time occurs twice where a curve jumps."""

    time: FloatArray
    joints: FloatArray
    tool: FloatArray


def curves(scene: Scene, trajectory: Trajectory) -> Curves:
    """The curves of a whole trajectory, with both sides of each knot."""
    edges, c = trajectory.edges, trajectory.coefficients
    many = max(3, min(PER_PIECE, MOST_SAMPLES // max(1, len(c))))
    share = np.linspace(0.0, 1.0, many)
    tau = share[None, :] * np.diff(edges)[:, None]
    time = (edges[:-1, None] + tau).ravel()
    joints = np.empty((*tau.shape, ORDERS, trajectory.n))
    factor = np.ones(6)
    powers = np.arange(6)
    for order in range(ORDERS):
        of = np.where(powers >= order, factor, 0.0)
        terms = tau[..., None] ** np.maximum(powers - order, 0) * of
        joints[..., order, :] = np.einsum("pmk,pnk->pmn", terms, c)
        factor = factor * (powers - order)
    flat = joints.reshape(-1, ORDERS, trajectory.n)
    flange = scene.robot.link_motion(len(scene.robot.links) - 1, *(flat[:, order].copy() for order in range(ORDERS)))
    tool = flange if scene.robot.tilting else flange.at(scene.tool.tcp)
    rates = np.stack([np.linalg.norm(tool.v, axis=-1), np.linalg.norm(tool.a, axis=-1)], -1)
    limits = scene.robot.limits
    spans = np.concatenate([limits.upper - limits.lower, limits.velocity, limits.acceleration, limits.jerk])
    values = np.concatenate([flat.reshape(len(time), -1), rates], -1)
    peaks = np.maximum(np.abs(rates).max(0), 1e-6)
    allowed = OFF * np.concatenate([spans, peaks])
    kept = needed_of_curves(time, values, allowed)
    while len(kept) > MOST_KEPT:
        allowed = 2.0 * allowed
        kept = needed_of_curves(time, values, allowed)
    return Curves(time[kept], flat[kept], rates[kept])
