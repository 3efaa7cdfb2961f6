"""The workspace of a five-bar, sampled: what its four working modes reach, and where both kinds of singularity lie."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.frames.motion import Motion, Pose
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
        type_2=robot.loop.type_2_curves(many),
    )


def _grid(far: float, spacing: float) -> FloatArray:
    count = math.ceil(far / spacing)
    return np.linspace(-count * spacing, count * spacing, 2 * count + 1)
