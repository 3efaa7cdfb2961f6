"""Velocities of a five-bar: A ẋ = B q̇, the determinants that tell both kinds of singularity, and the Jacobian A⁻¹B.

The lengths of the couplers do not change, so along each of them the tool axis P moves as its elbow does:

    A Ṗ = B (θ̇1, θ̇5)    A = | uᵀ |    B = diag(a_L e(θ1)⊥·u, a_R e(θ5)⊥·w) = diag(D_L, −D_R)             (K36)
                             | wᵀ |

det A = D vanishes at type 2: the cranks stand and P can still move. det B vanishes at type 1: P stands and a crank can
still move. det J = det B/det A.
"""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Pose
from assur.planner.robots.five_bar_links import joined
from assur.planner.robots.loop import Loop


@np.errstate(all="ignore")
def velocity_equation(loop: Loop, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """A and B (..., 2, 2), m and m², of K36 in base axes for q (..., n); NaN where q does not assemble."""
    found = loop.assembled((q[..., 0],), (q[..., 1],))
    direct = np.stack([joined(found.u), joined(found.w)], -2)
    inverse = np.zeros(direct.shape)
    for k in (0, 1):
        inverse[..., k, k] = (_push(loop, q, k) * direct[..., k, :]).sum(-1)
    return direct, inverse


@np.errstate(all="ignore")
def jacobian(base: Pose, loop: Loop, axes: int, q: FloatArray) -> FloatArray:
    """(..., axes, axes): rates of x, y (z, yaw) in the world per joint rate; infinite at type 2, NaN beyond."""
    direct, inverse = velocity_equation(loop, q)
    u, w = direct[..., 0, :], direct[..., 1, :]
    cross = u[..., 0] * w[..., 1] - u[..., 1] * w[..., 0]
    c, s = np.cos(base.yaw), np.sin(base.yaw)
    found = np.zeros((*q.shape[:-1], axes, axes))
    for k, (across, sign) in enumerate(((w, 1.0), (u, -1.0))):  # Cramer's rule
        push = inverse[..., k, k] / cross
        x, y = sign * push * across[..., 1], -sign * push * across[..., 0]
        found[..., 0, k], found[..., 1, k] = c * x - s * y, s * x + c * y
        if axes == 4:  # K4: how the left coupler turns
            found[..., 3, k] = -sign * (_push(loop, q, k) * w).sum(-1) / cross
    for k in range(2, axes):
        found[..., k, k] = 1.0
    return found


def _push(loop: Loop, q: FloatArray, k: int) -> FloatArray:
    """Velocity (..., 2) of an elbow per rate of its crank."""
    return loop.cranks[k] * np.stack([-np.sin(q[..., k]), np.cos(q[..., k])], -1)
