"""The articulated arm of source 003 by oblique triangles: equations 1 to 6, mended, and equation 1 as printed.

Nothing of the planner is used here. Both triangles are in the arm's vertical plane (figure 4). Lower: origin,
shoulder, target, with a from origin to target, b the shoulder's height, c from shoulder to target. Upper: shoulder,
elbow, target, with a′ the second link, b′ the first, d = c. With S half the perimeter of the triangle in question:

    tan(A_i/2) = √( (S−b)(S−c) / (S(S−a)) )        angle of the lower triangle at the shoulder              (1)
    tan(A_s/2) = √( (S−b′)(S−d) / (S(S−a′)) )      angle of the upper triangle at the shoulder              (3)
    tan(D/2)   = √( (S−a′)(S−b′) / (S(S−d)) )      angle of the upper triangle at the elbow                 (5)

They are half-angle formulas, though the source calls them the law of tangents. A_i + A_s is the angle between the
base (downwards) and link 1, the elbow being up. Any unit of length, angles in radians.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def angle(opposite: Array, one: Array, other: Array) -> Array:
    """The angle of a triangle between the sides `one` and `other`: (1), (3) and (5) as mended. NaN: no triangle."""
    s = (opposite + one + other) / 2
    with np.errstate(all="ignore"):
        return np.asarray(2 * np.arctan(np.sqrt((s - one) * (s - other) / (s * (s - opposite)))))


def printed_angle(opposite: Array, one: Array, other: Array) -> Array:
    """(1) and (3) as printed, with √((S−a)(S−b)(S−c)) over S(S−a): not a pure number, so the unit of length counts."""
    s = (opposite + one + other) / 2
    with np.errstate(all="ignore"):
        return np.asarray(2 * np.arctan(np.sqrt((s - opposite) * (s - one) * (s - other)) / (s * (s - opposite))))


def elbow_up(r: Array, z: Array, height: float, link1: float, link2: float) -> tuple[Array, Array, Array]:
    """A_i, A_s and D of the target at distance r from the base axis and height z, by (1) to (6)."""
    a, c = np.hypot(r, z), np.hypot(r, z - height)
    b, first, second = np.full_like(a, height), np.full_like(a, link1), np.full_like(a, link2)
    return angle(a, b, c), angle(second, first, c), angle(c, second, first)


def joints(r: Array, z: Array, height: float, link1: float, link2: float) -> Array:
    """Elevation of link 1 above the horizontal, and the turn of link 2 against it (..., 2), the elbow being up."""
    lower, upper, elbow = elbow_up(r, z, height, link1, link2)
    return np.stack([lower + upper - np.pi / 2, elbow - np.pi], -1)
