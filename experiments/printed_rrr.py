"""The RRR dyad and the SCARA as source 000 prints them, with its errors mended: an oracle for the planner's own form.

Figures 2 and 3 and equations 1 to 16, arccos and quotient rules included, for arrays of any one shape. Nothing here is
used by the planner, and nothing of the planner is used here. Mended (each is compared with finite differences in
tests/experiments/test_printed_rrr.py):

- figure 2, x = 0, y < 0: θ̇ = −ẋ/y, as for y > 0;
- figure 2, x = 0: θ̈ = (2ẋẏ − ẍy)/y² for both signs of y;
- equation 8, first line: both terms in the bracket are added;
- equations 4 and 5: Ȧ = 2 l_AB l̇_AB and B = 2 l_AC l_AB, where glyphs are unreadable.

What the source leaves undefined is NaN: the angle of a null vector, a dyad that cannot be assembled, derivatives of
an aligned one. Units are the caller's, angles in radians.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Angle = tuple[Array, Array, Array]
"""An angle or a length with its first two time derivatives."""

L_OA, L_AB, L_BC = 0.150, 0.080, 0.050
"""The SCARA of section 4, m."""


@dataclass(frozen=True, slots=True)
class Point:
    """A point in the plane with velocity and acceleration."""

    x: Array
    y: Array
    xd: Array
    yd: Array
    xdd: Array
    ydd: Array

    def __sub__(self, other: Point) -> Point:
        return Point(*(getattr(self, name) - getattr(other, name) for name in Point.__slots__))


@dataclass(frozen=True, slots=True)
class Dyad:
    """Result of section 2: `phi` of link AC with derivatives, the point C, and A/B (equation 1), |A/B| = 1 singular."""

    phi: Angle
    c: Point
    ratio: Array


@np.errstate(all="ignore")
def vector_angle(r: Point) -> Angle:
    """Figure 2: the angle of a vector with the x axis, case by case."""
    x, y, xd, yd, xdd, ydd = (getattr(r, name) for name in Point.__slots__)
    slope = np.arctan(y / x)
    theta = np.where(x < 0, np.where(y >= 0, slope + np.pi, slope - np.pi), slope)
    theta_d = 1 / (1 + (y / x) ** 2) * (yd * x - y * xd) / x**2
    square = x**2 + y**2
    theta_dd = ((ydd * x - y * xdd) * square - (yd * x - y * xd) * 2 * (x * xd + y * yd)) / square**2
    upright = (x == 0) & (y != 0)
    theta = np.where(upright, np.copysign(np.pi / 2, y), theta)
    theta_d = np.where(upright, -xd / y, theta_d)
    theta_dd = np.where(upright, (2 * xd * yd - xdd * y) / y**2, theta_dd)
    null = (x == 0) & (y == 0)
    return np.where(null, np.nan, theta), np.where(null, np.nan, theta_d), np.where(null, np.nan, theta_dd)


@np.errstate(all="ignore")
def distance(a: Point, b: Point) -> Angle:
    """Figure 3: the distance AB; its derivatives do not exist (NaN) where it is 0."""
    r = b - a
    length = np.sqrt(r.x**2 + r.y**2)
    length_d = (r.x * r.xd + r.y * r.yd) / length
    inner = r.xd**2 + r.x * r.xdd + r.yd**2 + r.y * r.ydd
    length_dd = (inner * length - (r.x * r.xd + r.y * r.yd) * length_d) / length**2
    return length, length_d, length_dd


@np.errstate(all="ignore")
def dyad(a: Point, b: Point, l_ac: float, l_bc: float, mode: int) -> Dyad:
    """Equations 1 to 10: the RRR group in assembly mode 1 (φ = θ + β) or 2 (φ = θ − β)."""
    if mode not in (1, 2):
        raise ValueError(f"assembly mode {mode}: 1 or 2")
    theta, theta_d, theta_dd = vector_angle(b - a)
    l_ab, l_ab_d, l_ab_dd = distance(a, b)
    a_, a_d, a_dd = l_ac**2 + l_ab**2 - l_bc**2, 2 * l_ab * l_ab_d, 2 * (l_ab_d**2 + l_ab * l_ab_dd)  # (4)
    b_, b_d, b_dd = 2 * l_ac * l_ab, 2 * l_ac * l_ab_d, 2 * l_ac * l_ab_dd  # (5)
    ratio = a_ / b_
    beta = np.arccos(ratio)  # (1)
    quotient = (a_d * b_ - a_ * b_d) / b_**2
    root = np.where(np.abs(ratio) < 1, np.sqrt(1 - ratio**2), np.nan)
    beta_d = -1 / root * quotient  # (2)
    quotient_d = ((a_dd * b_ - a_ * b_dd) * b_**2 - 2 * (a_d * b_ - a_ * b_d) * b_ * b_d) / b_**4
    beta_dd = -1 / root * (1 / (1 - ratio**2) * ratio * quotient**2 + quotient_d)  # (3)
    sign = 1 if mode == 1 else -1  # (9), (10)
    phi, phi_d, phi_dd = theta + sign * beta, theta_d + sign * beta_d, theta_dd + sign * beta_dd
    cos, sin = np.cos(phi), np.sin(phi)
    c = Point(
        a.x + l_ac * cos,  # (6)
        a.y + l_ac * sin,
        a.xd - l_ac * sin * phi_d,  # (7)
        a.yd + l_ac * cos * phi_d,
        a.xdd - l_ac * (cos * phi_d**2 + sin * phi_dd),  # (8)
        a.ydd + l_ac * (-sin * phi_d**2 + cos * phi_dd),
    )
    return Dyad((phi, phi_d, phi_dd), c, ratio)


def scara(d: Point, l_ab: float, l_bc: float, mode: int) -> tuple[Angle, Angle]:
    """Equations 11 to 15 in the plane: θ1 and θ2 = θ1 − θ_BC, the *opposite* of Denavit-Hartenberg's."""
    zero = np.zeros_like(d.x)
    a = Point(zero, zero, zero, zero, zero, zero)  # (11), (12); (13) is C = D in the plane
    elbow = dyad(a, d, l_ab, l_bc, mode)
    theta_bc = vector_angle(d - elbow.c)
    first, second, third = (one - two for one, two in zip(elbow.phi, theta_bc, strict=True))
    return elbow.phi, (first, second, third)


def spiral(t: Array) -> tuple[Array, Array, Array, Array]:
    """Equation 16: the path of D, m, with three derivatives, each (..., 3); t in seconds from 0 to 8."""
    rate = np.pi / 2
    sin, cos, one, none = 0.02 * np.sin(rate * t), 0.02 * np.cos(rate * t), np.ones_like(t), np.zeros_like(t)
    return (
        np.stack([0.1 + sin, -cos, 0.05 + 0.01 * t], -1),
        np.stack([rate * cos, rate * sin, 0.01 * one], -1),
        np.stack([-(rate**2) * sin, rate**2 * cos, none], -1),
        np.stack([-(rate**3) * cos, -(rate**3) * sin, none], -1),
    )
