"""What a diagram of a motion shows: joints with three derivatives, their limits, and the speed of the tool point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene
from assur.planner.robots.facts import Limits
from assur.planner.tracks.thinning import kept_of_curves
from assur.planner.trajectory import Trajectory

ORDERS = 4
"""Position, velocity, acceleration, jerk."""
PER_PIECE, MOST_SAMPLES = 24, 40_000
"""Samples of each piece of the spline before they are thinned out, and of the whole at most."""
OFF = 0.002
"""How far a curve that is drawn may be from what it is, as a part of its limit (of a position: of its range) ..."""
MOST_KEPT = 1_500
"""... unless that takes more samples than this; then twice as far, and so on."""


@dataclass(frozen=True, eq=False)
class Curves:
    """`joints` (T, 4, n): position and three derivatives in the planner's convention, SI; `tool` (T, 2): speed, m/s,
    and acceleration, m/s², of the tool point; at times (T,), s, two of which are the same where something jumps."""

    time: FloatArray
    joints: FloatArray
    tool: FloatArray


@dataclass(frozen=True, eq=False)
class LimitSpan:
    """The joints' limits from one time to another, s, with what is carried then."""

    start: float
    end: float
    limits: Limits


def curves(scene: Scene, trajectory: Trajectory) -> Curves:
    """The curves of a whole trajectory, both sides of each of its knots among them."""
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
    kept = kept_of_curves(time, values, allowed)
    while len(kept) > MOST_KEPT:
        allowed = 2.0 * allowed
        kept = kept_of_curves(time, values, allowed)
    return Curves(time[kept], flat[kept], rates[kept])


def limit_spans(scene: Scene, phases: tuple[Phase, ...]) -> tuple[LimitSpan, ...]:
    """The joints' limits over the phases, those that are the same and follow each other as one."""
    found = list[LimitSpan]()
    for phase in phases:
        limits = phase.attached.limits(scene)
        if found and found[-1].limits is limits:
            found[-1] = LimitSpan(found[-1].start, phase.t1, limits)
        else:
            found.append(LimitSpan(phase.t0, phase.t1, limits))
    return tuple(found)
