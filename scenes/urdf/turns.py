"""Turns as a URDF writes them, as rotation matrices; multiples of a right angle have no rounding."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from assur.planner.arrays import FloatArray


def turned(axis: Literal["x", "y", "z"], angle: float) -> FloatArray:
    """A rotation (3, 3) about an axis by an angle, rad."""
    c, s = math.cos(angle), math.sin(angle)
    quarter = angle / (math.pi / 2)
    if quarter == round(quarter):
        c, s = float(round(c)), float(round(s))
    i = "xyz".index(axis)
    j, k = (i + 1) % 3, (i + 2) % 3
    found = np.eye(3)
    found[j, j] = found[k, k] = c
    found[j, k], found[k, j] = -s, s
    return found


def of_rpy(roll: float, pitch: float, yaw: float) -> FloatArray:
    """A rotation (3, 3) by roll, pitch and yaw about the fixed x, y and z axes, in this order, rad."""
    found: FloatArray = turned("z", yaw) @ turned("y", pitch) @ turned("x", roll)
    return found


def of_quaternion(x: float, y: float, z: float, w: float) -> FloatArray:
    """The rotation (3, 3) of a quaternion of any length above 0."""
    # the division comes last: equal components then make exact zeros and ones
    square = x * x + y * y + z * z + w * w
    return (
        np.array(
            [
                [(x * x + w * w - y * y - z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
                [2.0 * (x * y + w * z), (y * y + w * w - x * x - z * z), 2.0 * (y * z - w * x)],
                [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), (z * z + w * w - x * x - y * y)],
            ]
        )
        / square
    )
