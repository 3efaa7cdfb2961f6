"""Trajectories for tests: random, short-pieced, flat, and hypothesis strategies of them."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from assur.planner.kernels.jets import JET_COLUMNS
from assur.planner.kernels.limits import HULL_COLUMNS, first_column, piece_hulls
from assur.planner.kernels.spline import sweep_joints
from assur.planner.trajectory import Trajectory, accepted_bands, keeps_bands

Floats = NDArray[np.float64]


def bernstein(path: Trajectory, derivative: int) -> Floats:
    """Bernstein coefficients of a derivative (0 to 3) on every piece, (P, n, 6 - derivative): its convex hull."""
    hulls, first = np.empty((len(path.time) - 1, path.n, HULL_COLUMNS)), first_column(derivative)
    piece_hulls(path.knots, hulls)
    return hulls[np.diff(path.time) > 0, :, first : first + 6 - derivative]


def keeps_limits(path: Trajectory, *limits: Floats | None) -> bool:
    """Whether a motion stays within what its limits allow, as candidates are asked."""
    return keeps_bands(path, accepted_bands(*limits))  # type: ignore[arg-type]


def sweep(path: Trajectory, t0: Floats, t1: Floats) -> tuple[Floats, Floats]:
    """The least and the greatest q, q̇ and q̈ (N, n, 3) of the joints over intervals (N,), by the kernel."""
    table, found = path.spline, np.empty((len(t0), path.n, JET_COLUMNS))
    for i in range(len(t0)):
        sweep_joints(table, t0[i], t1[i], found[i])
    return found[..., ::2] - found[..., 1::2], found[..., ::2] + found[..., 1::2]


REGIMES = ("even", "random", "short pieces", "cubic", "still", "far from zero")
"""Kinds of knots: a grid, any, pieces down to 10 µs, constant jerk, all at rest, positions near 100."""


def spline(seed: int, regime: str = "random", pieces: int = 8, n: int = 3) -> Trajectory:
    """A random trajectory of a regime."""
    rng = np.random.default_rng(seed)
    h = rng.uniform(0.05, 0.4, pieces)
    if regime == "even":
        h = np.full(pieces, 0.25)
    if regime == "short pieces":
        h[rng.random(pieces) < 0.5] = 10.0 ** rng.uniform(-5, -3)
    time = rng.uniform(-1, 5) + np.concatenate([[0.0], np.cumsum(h)])
    if regime == "cubic":
        return constant_jerk(time, rng.normal(size=(pieces, n)) * 50, rng.normal(size=(3, n)))
    q, qd, qdd = rng.normal(size=(3, len(time), n)) * np.array([1.0, 3.0, 30.0])[:, None, None]
    if regime == "short pieces":
        # A motion that could be: q̇ and q̈ of a sine, so that short pieces have no wild jerk.
        w, phase = rng.uniform(0.5, 3, n), rng.uniform(-3, 3, n)
        s = time[:, None] * w + phase
        q, qd, qdd = np.sin(s), w * np.cos(s), -w * w * np.sin(s)
    if regime == "still":
        q, qd, qdd = np.broadcast_to(q[0], q.shape), np.zeros_like(q), np.zeros_like(q)
    if regime == "far from zero":
        q = q + 100.0
    return Trajectory(time, q, qd, qdd)


def constant_jerk(time: Floats, jerk: Floats, state: Floats) -> Trajectory:
    """The trajectory from a state (3, n) with a constant jerk (K-1, n) on each piece."""
    states = [state]
    for h, j in zip(np.diff(time), jerk, strict=True):
        q, qd, qdd = states[-1]
        states.append(np.stack([q + h * (qd + h * (qdd / 2 + h * j / 6)), qd + h * (qdd + h * j / 2), qdd + h * j]))
    q, qd, qdd = np.stack(states, 1)
    return Trajectory(time, q, qd, qdd)


splines = st.builds(spline, st.integers(0, 10**6), st.sampled_from(REGIMES), st.integers(1, 12), st.integers(1, 4))
"""Trajectories of all regimes."""
