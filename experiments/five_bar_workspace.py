"""The workspace of a five-bar, sampled: what its four working modes reach, and where both kinds of singularity lie.

The lengths of the couplers do not change, so along each of them the tool axis P moves as its elbow does:

    A Ṗ = B (θ̇1, θ̇5)    A = | uᵀ |    B = diag(a_L e(θ1)⊥·u, a_R e(θ5)⊥·w) = diag(D_L, −D_R)             (K36)
                             | wᵀ |

det A = D vanishes at type 2: P can move while the cranks are at rest. det B vanishes at type 1: a crank can move while
P is at rest. det J = det B/det A.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assur.experiments.dyad import LEFT, RIGHT, RRR
from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.frames.motion import Motion, Pose
from assur.planner.geometry.shapes import SMALLEST_M
from assur.planner.robots.five_bar import FiveBar


@dataclass(frozen=True, eq=False)
class Workspace:
    """Over a grid of places `x` (X,), `y` (Y,) of the tool axis in base axes, m, and the modes in their order:

    `code` (4, Y, X) as `inverse` gives it; `serial`, `parallel` margins, NaN where nothing reaches, `parallel` negative
    in the other assembly mode; `within`: assembled there, and cranks within their ranges, full turns being free.
    `type_1`, `type_2`: curves (N, 2), m, on which the singularities lie for one mode or another, NaN where a curve is
    interrupted.
    """

    x: FloatArray
    y: FloatArray
    code: IntArray
    serial: FloatArray
    parallel: FloatArray
    within: BoolArray
    type_1: tuple[FloatArray, ...]
    type_2: tuple[FloatArray, ...]


def workspace(robot: FiveBar, spacing: float, many: int = 721) -> Workspace:
    """Samples all that the links could span, every `spacing` m; curves have `many` points."""
    far = max(a + b for a, b in zip(robot.proximal, robot.distal, strict=True))
    half = robot.separation / 2
    x = _grid(far, spacing)
    y = _grid(far + half, spacing)
    at_x, at_y = np.meshgrid(x, y)
    c, s, base = math.cos(robot.base.yaw), math.sin(robot.base.yaw), robot.base
    still = Motion.still(Pose(), at_x.shape)
    still.p[..., 0], still.p[..., 1] = base.x + c * at_x - s * at_y, base.y + s * at_x + c * at_y
    still.p[..., 2] = base.z
    found = [robot.inverse(still, mode, 0) for mode in range(len(robot.modes))]
    code = np.stack([each.code for each in found])
    lower, upper = robot.limits.lower[:2], robot.limits.upper[:2]
    q = np.stack([each.q[..., :2] for each in found])
    least = q + 2 * math.pi * np.ceil((lower - q) / (2 * math.pi))  # the first turn that is not below the range
    turn = np.linspace(-math.pi, math.pi, many)
    circle = np.stack([np.cos(turn), np.sin(turn)], -1)
    circles = [
        np.array([0.0, side]) + radius * circle
        for side, a, b in zip((half, -half), robot.proximal, robot.distal, strict=True)
        for radius in (a + b, abs(a - b))
    ]
    nowhere = np.full(at_x.shape, np.nan)
    parallel = [nowhere if each.parallel is None else each.parallel for each in found]
    return Workspace(
        x=x,
        y=y,
        code=code,
        serial=np.stack([each.margin for each in found]),
        parallel=np.stack(parallel),
        within=np.asarray((code == 0) & (least <= upper).all(-1)),
        type_1=tuple(circles),
        type_2=type_2_curves(robot, many),
    )


def _grid(far: float, spacing: float) -> FloatArray:
    count = math.ceil(far / spacing)
    return np.linspace(-count * spacing, count * spacing, 2 * count + 1)


def velocity_equation(robot: FiveBar, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """A and B (..., 2, 2), m and m², of K36 in base axes for q (..., n); NaN where q does not assemble."""
    s = robot.span(q)
    found = RRR(*robot.distal).solve(robot.sigma, (s[..., 0], s[..., 1]))
    direct = np.stack([np.stack(found.u, -1), np.stack(found.w, -1)], -2)
    inverse = np.zeros(direct.shape)
    for k, crank in enumerate(robot.proximal):
        push = crank * np.stack([-np.sin(q[..., k]), np.cos(q[..., k])], -1)
        inverse[..., k, k] = (push * direct[..., k, :]).sum(-1)
    return direct, inverse


def type_2_curves(robot: FiveBar, many: int) -> tuple[FloatArray, ...]:
    """Where the tool axis can be at type 2: curves (many, 2), m, base axes, NaN where there is no such point.

    Couplers in one line are one link of length b_L + b_R or |b_L − b_R| between the cranks: a four-bar, whose
    tool axis is followed over a turn of the left crank, on both of its branches.
    """
    (al, ar), (bl, br) = robot.proximal, robot.distal
    theta = np.linspace(-math.pi, math.pi, many)
    x, y = al * np.cos(theta), robot.separation / 2 + al * np.sin(theta)
    found = []
    for bar, share in ((bl + br, bl), (abs(bl - br), math.copysign(bl, bl - br))):
        if bar >= SMALLEST_M:
            for branch in (LEFT, RIGHT):
                ux, uy = RRR(bar, ar).solve(branch, (-x, -robot.separation / 2 - y)).u
                found.append(np.stack([x + share / bar * ux, y + share / bar * uy], -1))
        else:
            # Equal couplers fold where the elbows meet; the tool axis is then anywhere around them.
            meet = RRR(al, ar).solve(LEFT, (np.zeros(1), np.full(1, -robot.separation)))
            for side in (1.0, -1.0):
                centre = np.array([side * meet.u[0][0], robot.separation / 2 + meet.u[1][0]])
                found.append(centre + bl * np.stack([np.cos(theta), np.sin(theta)], -1))
    return tuple(found)
