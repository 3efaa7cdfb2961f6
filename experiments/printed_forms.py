"""Source 002: closed forms of the elbow arm and the polar arm, their transforms and Jacobians; nothing of the planner.

Elbow arm, by geometry, p_z counted from the shoulder, s_r and s_3 the two signs that the source leaves open:

    q1 = atan2(s_r p_y, s_r p_x)     cos q3 = (p_x² + p_y² + p_z² − l2² − l3²)/(2 l2 l3)     sin q3 = s_3 √(1 − cos² q3)
    q2 = atan2(p_z, s_r √(p_x² + p_y²)) − atan2(l3 sin q3, l2 + l3 cos q3)

Polar arm, by matrices, p_z counted from the floor, with r = C1 p_x + S1 p_y:

    θ1 = atan2(s_r p_y, s_r p_x)     θ2 = atan2(−r, p_z − l1)     d3 = C2 (p_z − l1) − S2 r

It prints an arctan of a quotient for each atan2; those are the functions `printed_...`. Also mended: the second row of
its product (III). Any unit of length, angles in radians.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from assur.experiments.printed_dh import Array, homogeneous, step

Frames = list[Array]
"""Transforms (..., 4, 4) of frame 0 and of the frame behind each joint."""
RIGHT = np.pi / 2


def elbow_joints(p: Array, l2: float, l3: float, radial: int, bend: int) -> Array:
    """q1, q2, q3 (..., 3) of points p (..., 3) above the shoulder, mended; signs of the radius and of sin q3."""
    radius = np.hypot(p[..., 0], p[..., 1])
    q3 = np.arctan2(bend * _sine(p, l2, l3), _cosine(p, l2, l3))
    q1 = np.arctan2(radial * p[..., 1], radial * p[..., 0])
    inner = np.arctan2(l3 * np.sin(q3), l2 + l3 * np.cos(q3))
    return np.stack([q1, np.arctan2(p[..., 2], radial * radius) - inner, q3], -1)


@np.errstate(all="ignore")
def printed_elbow_joints(p: Array, l2: float, l3: float, radial: int, bend: int) -> Array:
    """The same as printed: arctan of quotients, which are right within a quarter turn only."""
    radius = np.hypot(p[..., 0], p[..., 1])
    q3 = np.arctan(bend * _sine(p, l2, l3) / _cosine(p, l2, l3))
    inner = np.arctan(l3 * np.sin(q3) / (l2 + l3 * np.cos(q3)))
    return np.stack([np.arctan(p[..., 1] / p[..., 0]), np.arctan(p[..., 2] / (radial * radius)) - inner, q3], -1)


def _cosine(p: Array, l2: float, l3: float) -> Array:
    return np.asarray(((p**2).sum(-1) - l2**2 - l3**2) / (2 * l2 * l3))


@np.errstate(all="ignore")
def _sine(p: Array, l2: float, l3: float) -> Array:
    return np.asarray(np.sqrt(1 - _cosine(p, l2, l3) ** 2))


def elbow_frames(q: Array, height: float, l2: float, l3: float) -> Frames:
    """Frames of the elbow arm for q (..., 3) by products of Denavit-Hartenberg matrices."""
    zero = np.zeros_like(q[..., 0])
    rows = ((q[..., 0], zero + height, 0.0, RIGHT), (q[..., 1], zero, l2, 0.0), (q[..., 2], zero, l3, 0.0))
    return chained([step(*row) for row in rows])


def polar_joints(p: Array, l1: float, radial: int) -> Array:
    """θ1, θ2, d3 (..., 3) of points p (..., 3), mended, with the sign of the radius; d3 is positive."""
    return _polar(p, l1, np.arctan2(radial * p[..., 1], radial * p[..., 0]), np.arctan2)


@np.errstate(all="ignore")
def printed_polar_joints(p: Array, l1: float) -> Array:
    """The same as printed: arctan of quotients. Below the shoulder it asks for a negative d3."""
    return _polar(p, l1, np.arctan(p[..., 1] / p[..., 0]), lambda across, up: np.arctan(across / up))


def _polar(p: Array, l1: float, theta1: Array, angle: Callable[[Array, Array], Array]) -> Array:
    c1, s1, h = np.cos(theta1), np.sin(theta1), p[..., 2] - l1
    r = c1 * p[..., 0] + s1 * p[..., 1]
    theta2 = angle(-r, h)
    return np.stack([theta1, theta2, np.cos(theta2) * h - np.sin(theta2) * r], -1)


def polar_matrices(q: Array, l1: float) -> tuple[Array, Array, Array]:
    """⁰A₁, ¹A₂, ²A₃ (..., 4, 4) as printed, for q = θ1, θ2, d3 (..., 3)."""
    c1, s1, c2, s2 = np.cos(q[..., 0]), np.sin(q[..., 0]), np.cos(q[..., 1]), np.sin(q[..., 1])
    return (
        homogeneous([[c1, 0, s1, 0], [s1, 0, -c1, 0], [0, 1, 0, l1], [0, 0, 0, 1]]),
        homogeneous([[c2, 0, -s2, 0], [s2, 0, c2, 0], [0, -1, 0, 0], [0, 0, 0, 1]]),
        homogeneous([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, q[..., 2]], [0, 0, 0, 1]]),
    )


def polar_frames(q: Array, l1: float) -> Frames:
    """Frames of the polar arm by products of the matrices that follow from its table of parameters."""
    zero = np.zeros_like(q[..., 0])
    rows = ((q[..., 0], zero + l1, 0.0, RIGHT), (q[..., 1], zero, 0.0, -RIGHT), (zero, q[..., 2], 0.0, 0.0))
    return chained([step(*row) for row in rows])


def printed_polar_tool(q: Array, l1: float) -> Array:
    """T = ⁰A₃ (..., 4, 4) as the closed matrix prints it."""
    c1, s1, c2, s2, d3 = np.cos(q[..., 0]), np.sin(q[..., 0]), np.cos(q[..., 1]), np.sin(q[..., 1]), q[..., 2]
    return homogeneous(
        [
            [c1 * c2, -s1, -c1 * s2, -d3 * c1 * s2],
            [s1 * c2, c1, -s1 * s2, -d3 * s1 * s2],
            [s2, 0, c2, d3 * c2 + l1],
            [0, 0, 0, 1],
        ]
    )


def third_product(q: Array, l1: float, *, as_printed: bool = False) -> Array:
    """(III): the product of both inverse matrices, (..., 4, 4); as printed, its second row has a 1 too many."""
    c1, s1, c2, s2 = np.cos(q[..., 0]), np.sin(q[..., 0]), np.cos(q[..., 1]), np.sin(q[..., 1])
    slip = 1.0 if as_printed else 0.0
    return homogeneous(
        [
            [c2 * c1, c2 * s1, s2, -l1 * s2],
            [-s1, c1, slip, 0],
            [-s2 * c1, -s2 * s1, c2, -l1 * c2],
            [0, 0, 0, 1],
        ]
    )


def chained(steps: list[Array]) -> Frames:
    """Frame 0 and the products of the matrices, one after the other."""
    frames = [np.broadcast_to(np.eye(4), steps[0].shape)]
    for matrix in steps:
        frames.append(np.asarray(frames[-1] @ matrix))
    return frames


def jacobian(frames: Frames, slides: tuple[bool, ...]) -> NDArray[np.float64]:
    """The direct Jacobian of the last frame's position (..., 3, n): a joint turns or slides along z of the frame before
    it, so its column is z × (p − o) or z."""
    tip = frames[-1][..., :3, 3]
    columns = [
        frame[..., :3, 2] if slide else np.cross(frame[..., :3, 2], tip - frame[..., :3, 3])
        for frame, slide in zip(frames[:-1], slides, strict=True)
    ]
    return np.stack(columns, -1)
