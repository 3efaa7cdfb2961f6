"""Angles and arms of robots whose links turn about the vertical."""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.assur.codes import Code
from assur.planner.frames.motion import Motion
from assur.planner.geometry.shapes import Piece, Primitive

TURN = 2.0 * math.pi
"""A full turn, rad."""
AXIS_SLACK = 1e-9
"""How far a solid of revolution may be off its body's z axis, m or rad: rounding of a pose, far below any clearance."""


def principal(angle: FloatArray) -> FloatArray:
    """The angle in (−π, π], rad; what is there keeps its bits, but −π and what rounds to it becomes π."""
    wrapped: FloatArray = angle - TURN * np.ceil((angle - math.pi) / TURN)
    return wrapped


def add_arm(motion: Motion, length: float, phi: FloatArray, w: FloatArray, dw: FloatArray, ddw: FloatArray) -> None:
    """Move `motion` in place along an arm of `length` (m) at the absolute angle `phi` (...) with its rates (K12).

    p += r,  ṗ += ω r⊥,  p̈ += ω̇ r⊥ − ω² r,  p⃛ += (ω̈ − ω³) r⊥ − 3 ω ω̇ r  with r = length (cos φ, sin φ).
    """
    x, y = length * np.cos(phi), length * np.sin(phi)
    square, jerk, mixed = w * w, ddw - w * w * w, 3.0 * w * dw
    motion.p[..., 0] += x
    motion.p[..., 1] += y
    motion.v[..., 0] -= w * y
    motion.v[..., 1] += w * x
    motion.a[..., 0] -= dw * y + square * x
    motion.a[..., 1] += dw * x - square * y
    motion.j[..., 0] -= jerk * y + mixed * x
    motion.j[..., 1] += jerk * x - mixed * y


def arm_bounds(
    n: FloatArray, arms: FloatArray, turn: FloatArray, turn_d: FloatArray, lift: FloatArray, lift_d: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Upper bounds (N,) of |n·ẋ| (K13) and |n·ẍ| (K14) for x = constant + Σ ρᵢ e(φᵢ + const) + z ẑ.

    Proof. An arm ρᵢ e moves by φ̇ᵢ ρᵢ e⊥ and accelerates by φ̈ᵢ ρᵢ e⊥ − φ̇ᵢ² ρᵢ e: two terms at a right angle, so by
    ρᵢ √(φ̈ᵢ² + φ̇ᵢ⁴). It is horizontal, so at most |n_xy| of it counts along n; z adds |n_z||ż| and |n_z||z̈|.

    Arguments: `n` (N, 3); upper bounds of ρ, |φ̇|, |φ̈|: `arms, turn, turn_d` (N, m), in m, rad/s, rad/s²; of |ż|, |z̈|:
    `lift, lift_d` (N,), in m/s, m/s². A row with NaN is bounded by inf. Sharp: all arms in line, turning as one.
    """
    with np.errstate(all="ignore"):
        across, along = np.hypot(n[:, 0], n[:, 1]), np.abs(n[:, 2])
        speed = across * (arms * turn).sum(1) + along * lift
        acceleration = across * (arms * np.hypot(turn_d, turn * turn)).sum(1) + along * lift_d
    return np.where(speed >= 0, speed, np.inf), np.where(acceleration >= 0, acceleration, np.inf)


def elbow_singularity(l1: float, l2: float, bend: FloatArray) -> tuple[FloatArray, IntArray, FloatArray]:
    """For an RRR dyad bent by θ (...): its margin |sin θ|, the singularity that it is nearer to, and the metres (K16)
    that its end may move outwards or inwards until it is there."""
    outer, inner, product = l1 + l2, abs(l1 - l2), 4.0 * l1 * l2
    beyond, within = product * np.sin(bend / 2) ** 2, product * np.cos(bend / 2) ** 2
    radius = np.sqrt(inner * inner + within)
    left = np.minimum(beyond / (outer + radius), within / (inner + radius))
    code = np.where(np.cos(bend) >= 0.0, int(Code.STRETCHED), int(Code.FOLDED))
    return np.abs(np.sin(bend)), code, left


def upright(piece: Piece) -> bool:
    """Whether a solid is one of revolution about its body's z axis, so that it looks the same at any yaw."""
    shape = piece.shape
    if not (isinstance(shape, Primitive) and shape.half[0] == shape.half[1] == 0.0):
        return False
    centred = np.hypot(piece.position[0], piece.position[1]) <= AXIS_SLACK
    is_ball = shape.half[2] == shape.disc == 0.0
    return bool(centred and (is_ball or np.hypot(piece.rotation[0, 2], piece.rotation[1, 2]) <= AXIS_SLACK))
