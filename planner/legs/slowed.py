"""A joint motion, slowed down where it pulls too hard at the held part, and nowhere else.

The way stays the same; the clock runs slower on it. With s the time of the motion as it was and w = ds/dt ≤ 1, the tool
point is accelerated by p'' w² + p' w w'. The fastest w that keeps the carry limit is found as for a motion on a given
path: bounded by what pulls across the way, then by what may speed it up and slow it down along the way, forwards and
backwards. A cubic B-spline through lower ends of it is smooth enough for jerk. What comes out is checked like any other
motion. Source: Bobrow, Dubowsky and Gibson, Time-Optimal Control of Robotic Manipulators Along Specified Paths (1985).
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.legs.limits import beyond_limits
from assur.planner.legs.tool_motion import RESERVE, tool_peak
from assur.planner.model.scene import Scene
from assur.planner.robots.facts import Limits
from assur.planner.trajectory import Trajectory

CELLS = 48
"""Pieces of the spline over a motion."""
PER_CELL = 8
"""Instants of a piece at which the pull is looked at."""
TRIES, GENTLER = 6, 0.98
"""Motions that are made, each for as much less of the limit as the one before was beyond it, and a little less."""
SLOWEST = 0.02
"""The clock does not run slower than this."""


def slowed(scene: Scene, step: int, motion: Trajectory, limit: float, limits: Limits) -> Trajectory | None:
    """The motion on the same way, from rest or not, which pulls with `limit`, m/s², at most and keeps the joints' own
    `limits`; None: none was found.

    At ends in motion the clock is not slowed: their states are kept, as all positions are.
    """
    allowed = limit * (1 - RESERVE)
    for _ in range(TRIES):
        found = _paced(scene, motion, allowed)
        if found is None or beyond_limits(scene, step, found, limits) is not None:
            return None
        peak, _ = tool_peak(scene, found, found.start, found.end)
        if peak <= limit * (1 - RESERVE):
            return found
        allowed *= GENTLER * limit * (1 - RESERVE) / peak
    return None


def _paced(scene: Scene, motion: Trajectory, allowed: float) -> Trajectory | None:
    cell = motion.duration / CELLS
    s = np.linspace(0.0, motion.duration, CELLS * PER_CELL + 1)
    fast = np.sqrt(_squared(scene, motion, s, allowed))
    # the lowest within a cell on either side: the spline is a mean of what is around
    low = np.array([fast[max(0, (k - 1) * PER_CELL) : (k + 1) * PER_CELL + 1].min() for k in range(CELLS + 1)])
    moving = [bool(rates.any()) for rates in (motion.knots[0, 1 + motion.n :], motion.knots[-1, 1 + motion.n :])]
    for ends, inner in ((low[:2], moving[0]), (low[-2:], moving[1])):
        if inner and not (ends == 1.0).all():
            return None  # the pull begins where the motion does, which cannot be slowed there
    coefficients = np.concatenate([[low[0]], np.maximum(low, SLOWEST), [low[-1]]])
    if (coefficients == 1.0).all():
        return None
    return _timed(motion, coefficients, cell)


def _squared(scene: Scene, motion: Trajectory, s: FloatArray, allowed: float) -> FloatArray:
    """The largest w² (N,) at instants s (N,) with which the tool point is accelerated by `allowed` at most."""
    tcp, h = scene.tool.tcp, float(s[1] - s[0])
    flange, yaw = scene.robot.forward(motion.evaluate(motion.start + s))
    p = flange + np.stack(
        [np.cos(yaw) * tcp.x - np.sin(yaw) * tcp.y, np.sin(yaw) * tcp.x + np.cos(yaw) * tcp.y, 0 * yaw + tcp.z], -1
    )
    d, c = np.gradient(p, h, axis=0), np.zeros_like(p)
    c[1:-1] = (p[2:] - 2 * p[1:-1] + p[:-2]) / h**2
    c[0], c[-1] = c[1], c[-2]
    speed = np.sqrt((d**2).sum(-1))
    direction = d / np.maximum(speed, 1e-9)[:, None]
    along = (c * direction).sum(-1)
    across = np.sqrt(((c - along[:, None] * direction) ** 2).sum(-1))
    bound = np.minimum(1.0, allowed / np.maximum(across, 1e-9))
    for order, sign in ((range(len(s) - 1), 1.0), (range(len(s) - 1, 0, -1), -1.0)):
        b, v, t, n = bound.tolist(), speed.tolist(), along.tolist(), across.tolist()
        for i in order:
            spare = math.sqrt(max(0.0, allowed**2 - (n[i] * b[i]) ** 2))
            after = b[i] + 2 * h * (spare - sign * t[i] * b[i]) / max(v[i], 1e-9)
            k = i + int(sign)
            b[k] = max(SLOWEST**2, min(b[k], after))
        bound = np.array(b)
    return np.asarray(bound)


def _timed(motion: Trajectory, coefficients: FloatArray, cell: float) -> Trajectory:
    """The motion with the clock of a uniform cubic B-spline over cells of `cell` s."""
    edges = motion.edges - motion.start
    s = np.unique(np.concatenate([edges, np.arange(CELLS + 1) * cell]))
    s = s[np.concatenate([[True], np.diff(s) > 1e-6 * cell])]
    s[-1] = motion.duration
    nodes, weights = np.polynomial.legendre.leggauss(6)
    middles, halves = (s[1:] + s[:-1]) / 2, (s[1:] - s[:-1]) / 2
    inside = middles[:, None] + halves[:, None] * nodes
    spent = ((1 / _clock(coefficients, cell, inside.ravel())[0]).reshape(inside.shape) * weights).sum(1) * halves
    w, slope = _clock(coefficients, cell, s)
    q, qd, qdd = motion.states(motion.start + s)
    w, slope = w[:, None], slope[:, None]
    knots = np.concatenate(
        [(motion.start + np.concatenate([[0.0], np.cumsum(spent)]))[:, None], q, qd * w, qdd * w**2 + qd * w * slope], 1
    )
    # to the bit: what comes before and behind begins and ends there
    knots[0], knots[-1, 1:] = motion.knots[0], motion.knots[-1, 1:]
    return Trajectory.of_knots(knots)


def _clock(coefficients: FloatArray, cell: float, s: FloatArray) -> tuple[FloatArray, FloatArray]:
    """w and dw/ds at s (N,)."""
    k = np.minimum((s / cell).astype(np.int64), CELLS - 1)
    x = s / cell - k
    four = np.stack([coefficients[k + i] for i in range(4)])
    basis = np.stack([(1 - x) ** 3, 3 * x**3 - 6 * x**2 + 4, -3 * x**3 + 3 * x**2 + 3 * x + 1, x**3]) / 6
    slope = np.stack([-((1 - x) ** 2), 3 * x**2 - 4 * x, -3 * x**2 + 2 * x + 1, x**2]) / (2 * cell)
    return (four * basis).sum(0), (four * slope).sum(0)
