"""The four-axis SCARA of source 001: its Denavit-Hartenberg matrices, its T₀⁴ and its inverse, with errors mended.

Nothing of the planner is used here. These equations are mended; the printed form of each is `printed_...`:

- 4.1.5, Rot_z: c, −s / s, c where c, s / s, c is printed;
- 5.4: θ4 = θ1 + θ2 − atan2(n_y, n_x) where θ1 + θ2 is missing;
- 5.4: d3 = d_z + d4, from the matrix above it, where another origin is meant (d_b and d_H, which nothing defines).

Units are the caller's, angles in radians. The tool looks down (α = π in the third row), so its θ4 turns against ours.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def homogeneous(rows: list[list[Array | float]]) -> Array:
    """Matrices (..., 4, 4) of entries that broadcast."""
    flat = np.broadcast_arrays(*(np.asarray(x, dtype=np.float64) for row in rows for x in row))
    return np.stack(flat, -1).reshape(*flat[0].shape, 4, 4)


def rotation_z(theta: Array) -> Array:
    """Rot_z of 4.1.5, mended."""
    c, s = np.cos(theta), np.sin(theta)
    return homogeneous([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])


def printed_rotation_z(theta: Array) -> Array:
    """Rot_z of 4.1.5 as printed: no rotation."""
    c, s = np.cos(theta), np.sin(theta)
    return homogeneous([[c, s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])


def step(theta: Array, d: Array, a: float, alpha: float, *, as_printed: bool = False) -> Array:
    """The matrix of one joint by the four factors of 4.1.5: Rot_z(θ) Trans_z(d) Trans_x(a) Rot_x(α)."""
    turn = printed_rotation_z(theta) if as_printed else rotation_z(theta)
    c, s = np.cos(alpha), np.sin(alpha)
    along = homogeneous([[1, 0, 0, a], [0, 1, 0, 0], [0, 0, 1, d], [0, 0, 0, 1]])
    twist = homogeneous([[1, 0, 0, 0], [0, c, -s, 0], [0, s, c, 0], [0, 0, 0, 1]])
    return np.asarray(turn @ along @ twist)


def frames(q: Array, a1: float, a2: float, d4: float, *, as_printed: bool = False) -> tuple[Array, Array, Array, Array]:
    """T₀¹, T₀², T₀³, T₀⁴ (..., 4, 4) by products, for q = θ1, θ2, d3, θ4 (..., 4)."""
    zero = np.zeros_like(q[..., 0])
    rows = (
        (q[..., 0], zero, a1, 0.0),
        (q[..., 1], zero, a2, 0.0),
        (zero, q[..., 2], 0.0, np.pi),
        (q[..., 3], zero + d4, 0.0, 0.0),
    )
    one, two, three, four = (step(*row, as_printed=as_printed) for row in rows)
    return one, np.asarray(one @ two), np.asarray(one @ two @ three), np.asarray(one @ two @ three @ four)


def printed_tool(q: Array, a1: float, a2: float, d4: float) -> Array:
    """T₀⁴ (..., 4, 4) as the closed matrix of 5.3 prints it."""
    c1, s1, c4, s4 = np.cos(q[..., 0]), np.sin(q[..., 0]), np.cos(q[..., 3]), np.sin(q[..., 3])
    c12, s12 = np.cos(q[..., 0] + q[..., 1]), np.sin(q[..., 0] + q[..., 1])
    return homogeneous(
        [
            [c12 * c4 + s12 * s4, -c12 * s4 + s12 * c4, 0, a1 * c1 + a2 * c12],
            [s12 * c4 - c12 * s4, -s12 * s4 - c12 * c4, 0, a1 * s1 + a2 * s12],
            [0, 0, -1, q[..., 2] - d4],
            [0, 0, 0, 1],
        ]
    )


def inverse(tool: Array, a1: float, a2: float, d4: float, root: int) -> Array:
    """θ1, θ2, d3, θ4 (..., 4) of T₀⁴ (..., 4, 4) by 5.4, mended, with the sign `root` of the square root."""
    if root not in (-1, 1):
        raise ValueError(f"root {root}: -1 or 1")
    dx, dy = tool[..., 0, 3], tool[..., 1, 3]
    r = (dx**2 + dy**2 - a1**2 - a2**2) / (2 * a1 * a2)
    theta2 = np.arctan2(root * np.sqrt(1 - r**2), r)
    theta1 = np.arctan2(dy, dx) - np.arctan2(a2 * np.sin(theta2), a1 + a2 * np.cos(theta2))
    theta4 = theta1 + theta2 - np.arctan2(tool[..., 1, 0], tool[..., 0, 0])
    return np.stack([theta1, theta2, tool[..., 2, 3] + d4, theta4], -1)


def printed_theta4(tool: Array) -> Array:
    """θ4 of 5.4 as printed (...), without θ1 + θ2."""
    return -np.arctan2(tool[..., 1, 0], tool[..., 0, 0])
