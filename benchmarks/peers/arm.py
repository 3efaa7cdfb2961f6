"""The problems' arm for peers that bring no kinematics: closed forms, and every turn of the joints.

cos q2 = (r² - a1² - a2²) / (2 a1 a2)      q1 = ∠(x, y) - atan2(a2 sin q2, a1 + a2 cos q2)      (B1)
"""

from __future__ import annotations

import math
from itertools import product
from typing import Any

import numpy as np

from benchmarks.translation import A1_M, A2_M

Array = Any


def solutions(position: list[float], yaw: float, limits: dict[str, list[float]]) -> list[list[float]]:
    """Every q within the limits that puts the tool there, in both modes and all turns; those of least |q| first."""
    found = []
    for sign in (1.0, -1.0):
        q1, q2, z, q4 = along(position, position, (yaw, yaw), sign, 1)[0].tolist()
        for k1, k4 in product((-1, 0, 1), (-2, -1, 0, 1, 2)):
            q = [q1 + 2 * math.pi * k1, q2, z, math.remainder(q4, 2 * math.pi) + 2 * math.pi * k4]
            # not where the tool is out of reach: NaN
            if all(low <= value <= high for low, value, high in zip(limits["qmin"], q, limits["qmax"], strict=True)):
                found.append(q)
    return sorted(found, key=lambda q: sum(abs(value) for value in q))


def along(start: Array, end: Array, yaw: tuple[float, float], sign: float, points: int) -> Array:
    """Joint positions (points, 4) along a straight line of the tool from `start` to `end` (3,), yaw going evenly, the
    elbow on the side `sign`; angles continuous from the first. NaN where the line cannot be reached."""
    s = np.linspace(0.0, 1.0, points)[:, None]
    p = np.asarray(start) + s * (np.asarray(end) - np.asarray(start))
    r2 = p[:, 0] ** 2 + p[:, 1] ** 2
    with np.errstate(invalid="ignore"):
        q2 = sign * np.arccos((r2 - A1_M**2 - A2_M**2) / (2 * A1_M * A2_M))
    q1 = np.arctan2(p[:, 1], p[:, 0]) - np.arctan2(A2_M * np.sin(q2), A1_M + A2_M * np.cos(q2))
    q1 = np.unwrap(q1)
    q4 = np.unwrap(yaw[0] + s[:, 0] * (yaw[1] - yaw[0]) - q1 - q2)
    return np.stack([q1, q2, p[:, 2], q4], axis=-1)
