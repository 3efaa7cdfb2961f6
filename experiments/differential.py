"""Homogeneous transforms along the chain, the Jacobian, its inverse and determinant, for any robot of the protocol."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.robots.robot import Robot

LEAST_MARGIN = 1e-12
"""A margin up to this, no unit, is 0: that of a closed chain comes out of a triangle, and rounds to some 1e-16."""


def transforms(robot: Robot, q: FloatArray) -> FloatArray:
    """Link frames in the world for q (..., n) as homogeneous transforms (..., L, 4, 4), in the order of `links`.

    The transform from one link to the next is inv(T[i]) @ T[i + 1] (K31 for arms whose links tilt).
    """
    position, rotation = robot.placements(q)
    found = np.zeros((*position.shape[:-1], 4, 4))
    found[..., :3, :3], found[..., :3, 3], found[..., 3, 3] = rotation, position, 1.0
    return found


def jacobian(robot: Robot, q: FloatArray) -> FloatArray:
    """(..., len(coordinates), n): rates of the task coordinates per joint rate, which are linear in them; NaN where the
    arm does not assemble with rates (K11, K26, K27, K36, H5)."""
    n = q.shape[-1]
    each = np.broadcast_to(np.eye(n), (*q.shape[:-1], n, n))
    rest = np.zeros_like(each)
    flange = robot.link_motion(len(robot.links) - 1, np.broadcast_to(q[..., None, :], each.shape), each, rest, rest)
    rates = {"x": flange.v[..., 0], "y": flange.v[..., 1], "z": flange.v[..., 2], "yaw": flange.yaw_d}
    if flange.tilted:
        rates |= {"pitch": flange.tilt_d[..., 0], "roll": flange.tilt_d[..., 1]}
    return np.stack([rates[name] for name in robot.coordinates], -2)


def determinant(robot: Robot, q: FloatArray) -> FloatArray:
    """det J (...) for q (..., n); of a J that is not square, √det(J Jᵀ). Zero at singular positions (K11, K26, K27)."""
    found = jacobian(robot, q)
    if found.shape[-1] == found.shape[-2]:
        return np.asarray(np.linalg.det(found))
    square = np.linalg.det(found @ np.swapaxes(found, -1, -2))
    return np.asarray(np.sqrt(np.maximum(square, 0.0)))


@np.errstate(all="ignore")
def inverse_jacobian(robot: Robot, q: FloatArray) -> FloatArray:
    """(..., n, len(coordinates)): joint rates per rate of the task coordinates; NaN where J is singular or not finite.

    For more joints than coordinates it is the pseudo-inverse Jᵀ (J Jᵀ)⁻¹, of the least joint rates (source 002 prints
    (J Jᵀ)⁻¹). Singular is what the robot's margin says: rows with a margin of 0 (`LEAST_MARGIN`), where the plain
    inverse would fail.
    """
    direct = jacobian(robot, q)
    good = np.isfinite(direct).all((-1, -2)) & (robot.margin(q) > LEAST_MARGIN) & (determinant(robot, q) != 0.0)
    found = np.full((*direct.shape[:-2], direct.shape[-1], direct.shape[-2]), np.nan)
    regular = direct[good]
    turned = np.swapaxes(regular, -1, -2)
    square = direct.shape[-1] == direct.shape[-2]
    found[good] = np.linalg.inv(regular) if square else turned @ np.linalg.inv(regular @ turned)
    return found
