"""The five-axis arm of source 003, section 5: the wrist from tool point and pitch, then its two oblique triangles.

Nothing of the planner is used here. With the hand's length L_e, its pitch P above the horizontal and the tool point at
(x, y, z):

    B = atan2(y, x)        x_w = x − L_e cos P cos B        y_w = y − L_e cos P sin B                            (7)
    z_w = z − L_e sin P                                                                              (its figure 7)

The source leaves the sign of the last one to "the case"; with a signed pitch there is one. Then equations 1 to 6, as
mended in `assur.experiments.printed_triangles`, for the target (r_w, z_w); the wrist has what is left, θ4 = P − θ2 −
θ3 and
θ5 = roll. The source takes r_w = √(x_w² + y_w²), and the triangles know no sign either: a wrist behind the base axis is
seen in front of it. Mended, r_w = √(x² + y²) − L_e cos P, and the angle A_i takes its sign.
"""

from __future__ import annotations

import numpy as np

from assur.experiments.printed_triangles import Array, elbow_up


def wrist(x: Array, y: Array, z: Array, pitch: Array, hand: float) -> tuple[Array, Array, Array]:
    """B, r_w with its sign, and z_w: (7) and figure 7, mended."""
    return np.arctan2(y, x), np.hypot(x, y) - hand * np.cos(pitch), z - hand * np.sin(pitch)


def printed_radius(x: Array, y: Array, pitch: Array, hand: float) -> Array:
    """r_w from (7) as printed: never negative."""
    base = np.arctan2(y, x)
    along = hand * np.cos(pitch)
    return np.asarray(np.hypot(x - along * np.cos(base), y - along * np.sin(base)))


def joints(base: Array, r: Array, z: Array, pitch: Array, roll: Array, lengths: tuple[float, float, float]) -> Array:
    """θ1 to θ5 (..., 5), the elbow being up, for a wrist at signed radius r; `lengths`: shoulder's height, links."""
    height, link1, link2 = lengths
    lower, upper, bend = elbow_up(np.abs(r), z, height, link1, link2)
    second = np.where(r < 0, -lower, lower) + upper - np.pi / 2
    third = bend - np.pi
    return np.stack([base, second, third, pitch - second - third, roll], -1)
