"""The RRR dyad in four formulations, for plain floats or for arrays: what `dyad-timing` compares.

All take the motion of A and B in the plane and give the same nine numbers: φ, φ̇, φ̈ of link AC, and C with velocity
and acceleration. One formula serves floats and arrays; only the functions (`FLOATS`, `ARRAYS`) differ, so that no
formulation pays for machinery that another is spared.

- `vector`: this project's K1 to K5, with C by K12;
- `relative`: unknowns φ and ψ (link 2 against link 1), the loop l1 e(φ) + l2 e(φ + ψ) = d closed for the
  required mode, then two linear systems with its Jacobian;
- `natural`: unknowns are the coordinates of C, constraints |C − A|² = l1² and |C − B|² = l2²; Newton's iteration
  from a guess, then two linear systems with the same Jacobian. Which of the two assemblies it lands on is luck.

The printed form of 000 is `printed_single` for floats (`printed_rrr` has the arrays). σ = +1 is assembly mode 1.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
N = TypeVar("N", float, Array)

NEWTON_STEPS = 50
"""Iterations after which Newton has failed: it needs five from near, and twenty from far."""
NEWTON_RESIDUAL = 1e-12
"""A constraint is met when its residual is below this share of l²: where rounding lets Newton stop."""


@dataclass(frozen=True)
class Functions(Generic[N]):
    """Elementary functions, and `solve` of a 2 × 2 system (a b; c d)(x, y) = (e, f)."""

    sqrt: Callable[[N], N]
    cos: Callable[[N], N]
    sin: Callable[[N], N]
    acos: Callable[[N], N]
    atan2: Callable[[N, N], N]
    solve: Callable[[N, N, N, N, N, N], tuple[N, N]]


Given = tuple[N, N, N, N, N, N, N, N, N, N, N, N]
"""x, y, ẋ, ẏ, ẍ, ÿ of A, then of B."""
Found = tuple[N, N, N, N, N, N, N, N, N]
"""φ, φ̇, φ̈, then x, y, ẋ, ẏ, ẍ, ÿ of C."""


def cramer(a: N, b: N, c: N, d: N, e: N, f: N) -> tuple[N, N]:
    """By Cramer's rule: the least that a 2 × 2 system costs."""
    determinant = a * d - b * c
    return (e * d - b * f) / determinant, (a * f - e * c) / determinant


def general(a: float, b: float, c: float, d: float, e: float, f: float) -> tuple[float, float]:
    """By the general solver of the library, as code for mechanisms of any size does it (Matlab's backslash)."""
    x, y = np.linalg.solve(np.array([[a, b], [c, d]]), np.array([e, f]))
    return float(x), float(y)


FLOATS = Functions(math.sqrt, math.cos, math.sin, math.acos, math.atan2, cramer)
FLOATS_GENERAL = Functions(math.sqrt, math.cos, math.sin, math.acos, math.atan2, general)
ARRAYS: Functions[Array] = Functions(np.sqrt, np.cos, np.sin, np.arccos, np.arctan2, cramer)


def vector(given: Given[N], l1: float, l2: float, sigma: int, f: Functions[N]) -> Found[N]:
    """K1 to K5 of docs/kinematics.md."""
    ax, ay, axd, ayd, axdd, aydd, bx, by, bxd, byd, bxdd, bydd = given
    dx, dy, vx, vy = bx - ax, by - ay, bxd - axd, byd - ayd
    square = dx * dx + dy * dy
    k = (square + (l1 * l1 - l2 * l2)) / 2
    h = 0.5 * sigma * f.sqrt(((l1 + l2) ** 2 - square) * (square - (l1 - l2) ** 2))
    ux, uy = (k * dx - h * dy) / square, (k * dy + h * dx) / square
    wx, wy = dx - ux, dy - uy
    inverse = -1 / h
    w1, w2 = (vx * wx + vy * wy) * inverse, -(vx * ux + vy * uy) * inverse
    s1, s2 = w1 * w1, w2 * w2
    a1 = ((bxdd - axdd + s1 * ux + s2 * wx) * wx + (bydd - aydd + s1 * uy + s2 * wy) * wy) * inverse
    return (
        f.atan2(uy, ux),
        w1,
        a1,
        ax + ux,
        ay + uy,
        axd - w1 * uy,
        ayd + w1 * ux,
        axdd - a1 * uy - s1 * ux,
        aydd + a1 * ux - s1 * uy,
    )


def relative(given: Given[N], l1: float, l2: float, sigma: int, f: Functions[N]) -> Found[N]:
    """Relative coordinates: φ, ψ and their loop."""
    ax, ay, axd, ayd, axdd, aydd, bx, by, bxd, byd, bxdd, bydd = given
    dx, dy = bx - ax, by - ay
    psi = -sigma * f.acos((dx * dx + dy * dy - l1 * l1 - l2 * l2) / (2 * l1 * l2))
    phi = f.atan2(dy, dx) - f.atan2(l2 * f.sin(psi), l1 + l2 * f.cos(psi))
    x1, y1 = l1 * f.cos(phi), l1 * f.sin(phi)
    x2, y2 = l2 * f.cos(phi + psi), l2 * f.sin(phi + psi)
    phi_d, psi_d = f.solve(-y1 - y2, -y2, x1 + x2, x2, bxd - axd, byd - ayd)
    s1, s2 = phi_d * phi_d, (phi_d + psi_d) * (phi_d + psi_d)
    right = bxdd - axdd + s1 * x1 + s2 * x2, bydd - aydd + s1 * y1 + s2 * y2
    phi_dd, _ = f.solve(-y1 - y2, -y2, x1 + x2, x2, *right)
    return (
        phi,
        phi_d,
        phi_dd,
        ax + x1,
        ay + y1,
        axd - phi_d * y1,
        ayd + phi_d * x1,
        axdd - phi_dd * y1 - s1 * x1,
        aydd + phi_dd * x1 - s1 * y1,
    )


def natural(
    given: Given[float], l1: float, l2: float, guess: tuple[float, float], f: Functions[float]
) -> Found[float] | None:
    """Natural coordinates from a guess of C; None if Newton does not arrive."""
    x, y, steps = _newton(given, l1, l2, guess, f)
    return natural_rates(given, l1, x, y, f) if steps else None


def _newton(
    given: Given[float], l1: float, l2: float, guess: tuple[float, float], f: Functions[float]
) -> tuple[float, float, int]:
    ax, ay, bx, by = given[0], given[1], given[6], given[7]
    x, y = guess
    enough = NEWTON_RESIDUAL * min(l1, l2) ** 2
    for step in range(1, NEWTON_STEPS + 1):
        rx, ry, sx, sy = x - ax, y - ay, x - bx, y - by
        one, two = rx * rx + ry * ry - l1 * l1, sx * sx + sy * sy - l2 * l2
        if abs(one) <= enough and abs(two) <= enough:
            return x, y, step
        if rx * sy == ry * sx:
            break
        dx, dy = f.solve(2 * rx, 2 * ry, 2 * sx, 2 * sy, one, two)
        x, y = x - dx, y - dy
    return x, y, 0


def natural_rates(given: Given[N], l1: float, x: N, y: N, f: Functions[N]) -> Found[N]:
    """Velocity and acceleration of C at (x, y) from the constraints' derivatives, and the angle of AC."""
    ax, ay, axd, ayd, axdd, aydd, bx, by, bxd, byd, bxdd, bydd = given
    rx, ry, sx, sy = x - ax, y - ay, x - bx, y - by
    xd, yd = f.solve(2 * rx, 2 * ry, 2 * sx, 2 * sy, 2 * (rx * axd + ry * ayd), 2 * (sx * bxd + sy * byd))
    px, py, qx, qy = xd - axd, yd - ayd, xd - bxd, yd - byd
    one = 2 * (rx * axdd + ry * aydd - px * px - py * py)
    two = 2 * (sx * bxdd + sy * bydd - qx * qx - qy * qy)
    xdd, ydd = f.solve(2 * rx, 2 * ry, 2 * sx, 2 * sy, one, two)
    square = l1 * l1
    phi_d, phi_dd = (rx * py - ry * px) / square, (rx * (ydd - aydd) - ry * (xdd - axdd)) / square
    return f.atan2(ry, rx), phi_d, phi_dd, x, y, xd, yd, xdd, ydd


def natural_batch(
    given: Given[Array], l1: float, l2: float, guesses: Array, wanted: tuple[Array, Array], near: float
) -> tuple[Found[Array], int]:
    """Natural coordinates of many dyads at once: each row restarts from its next guess (G, 2, rows) until it lands
    within `near` of the `wanted` C. The motions, and how many starts were made in all; rows that never land are NaN."""
    ax, ay, bx, by = given[0], given[1], given[6], given[7]
    x, y = np.full_like(ax, np.nan), np.full_like(ax, np.nan)
    left, starts = np.arange(len(ax)), 0
    enough = NEWTON_RESIDUAL * min(l1, l2) ** 2
    with np.errstate(all="ignore"):
        for guess in guesses:
            starts += len(left)
            px, py = guess[0][left], guess[1][left]
            for _ in range(NEWTON_STEPS):
                rx, ry, sx, sy = px - ax[left], py - ay[left], px - bx[left], py - by[left]
                one, two = rx * rx + ry * ry - l1 * l1, sx * sx + sy * sy - l2 * l2
                if not ((np.abs(one) > enough) | (np.abs(two) > enough)).any():
                    break
                dx, dy = cramer(2 * rx, 2 * ry, 2 * sx, 2 * sy, one, two)
                px, py = px - dx, py - dy
            x[left], y[left] = px, py
            left = left[~(np.hypot(px - wanted[0][left], py - wanted[1][left]) <= near)]
            if not left.size:
                break
        x[left] = y[left] = np.nan
        return natural_rates(given, l1, x, y, ARRAYS), starts


def printed_single(given: Given[float], l1: float, l2: float, sigma: int) -> Found[float]:
    """Figures 2 and 3 and equations 1 to 10 of 000 for plain floats, mended as in `printed_rrr`."""
    ax, ay, axd, ayd, axdd, aydd, bx, by, bxd, byd, bxdd, bydd = given
    x, y, xd, yd, xdd, ydd = bx - ax, by - ay, bxd - axd, byd - ayd, bxdd - axdd, bydd - aydd
    if x == 0:
        theta, theta_d, theta_dd = math.copysign(math.pi / 2, y), -xd / y, (2 * xd * yd - xdd * y) / (y * y)
    else:
        slope = y / x
        theta = math.atan(slope)
        if x < 0:
            theta += math.pi if y >= 0 else -math.pi
        theta_d = 1 / (1 + slope * slope) * (yd * x - y * xd) / (x * x)
        square = x * x + y * y
        theta_dd = ((ydd * x - y * xdd) * square - (yd * x - y * xd) * 2 * (x * xd + y * yd)) / (square * square)
    l = math.sqrt(x * x + y * y)  # noqa: E741 - the source's letter
    l_d = (x * xd + y * yd) / l
    l_dd = ((xd * xd + x * xdd + yd * yd + y * ydd) * l - (x * xd + y * yd) * l_d) / (l * l)
    a, a_d, a_dd = l1 * l1 + l * l - l2 * l2, 2 * l * l_d, 2 * (l_d * l_d + l * l_dd)  # (4)
    b, b_d, b_dd = 2 * l1 * l, 2 * l1 * l_d, 2 * l1 * l_dd  # (5)
    ratio = a / b
    beta = math.acos(ratio)  # (1)
    below, square = 1 - ratio * ratio, b * b
    root, quotient = math.sqrt(below), (a_d * b - a * b_d) / square
    beta_d = -1 / root * quotient  # (2)
    quotient_d = ((a_dd * b - a * b_dd) * square - 2 * (a_d * b - a * b_d) * b * b_d) / (square * square)
    beta_dd = -1 / root * (1 / below * ratio * (quotient * quotient) + quotient_d)  # (3)
    phi, phi_d, phi_dd = theta + sigma * beta, theta_d + sigma * beta_d, theta_dd + sigma * beta_dd  # (9), (10)
    cos, sin, rate = math.cos(phi), math.sin(phi), phi_d * phi_d
    return (
        phi,
        phi_d,
        phi_dd,
        ax + l1 * cos,  # (6)
        ay + l1 * sin,
        axd - l1 * sin * phi_d,  # (7)
        ayd + l1 * cos * phi_d,
        axdd - l1 * (cos * rate + sin * phi_dd),  # (8)
        aydd + l1 * (-sin * rate + cos * phi_dd),
    )
