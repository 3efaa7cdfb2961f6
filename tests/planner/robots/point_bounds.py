"""What the kernels bound of points on a robot's links, in arrays, for tests."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.kernels.jets import ACCELERATION, JET_COLUMNS, RATE
from assur.planner.robots.robot import Robot


def joint_jets(lower: FloatArray, upper: FloatArray, rate: FloatArray, rate_d: FloatArray) -> FloatArray:
    """Jets (..., n, 6) of joints in a range (..., n) whose rates and second derivatives are known."""
    found = np.zeros((*lower.shape, JET_COLUMNS))
    with np.errstate(invalid="ignore"):
        found[..., 0], found[..., 1] = 0.5 * (lower + upper), 0.5 * (upper - lower)
    found[..., RATE], found[..., ACCELERATION] = rate, rate_d
    return found


def point_bounds(
    robot: Robot, link: int, points: FloatArray, n: FloatArray, joints: FloatArray, radius: float = 0.0
) -> tuple[FloatArray, FloatArray]:
    """Upper bounds (N,) of |n·ẋ| and |n·ẍ| over N intervals, along unit vectors `n` (N, 3), for all points x within
    `radius` of a point (N, 3) of link number `link`, from the jets of the joints (N, n, 6)."""
    found = np.full((len(points), 2), np.inf)
    for i, (point, along, each) in enumerate(zip(points, n, joints, strict=True)):
        jets = robot.sweep(np.ascontiguousarray(each), link).jets
        place = np.append(1.0, point)
        for order in (1, 2) if np.isfinite(jets).all() else ():
            middle, off = (jets[:, 2 * order + k].reshape(4, 3) for k in (0, 1))
            turned = np.abs(middle[1:] @ along) + off[1:] @ np.abs(along)
            bound = abs(place @ middle @ along) + np.abs(place) @ off @ np.abs(along)
            found[i, order - 1] = bound + radius * np.linalg.norm(turned)
    return found[:, 0].copy(), found[:, 1].copy()
