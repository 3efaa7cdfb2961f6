"""Angles, lengths and reach of the links of an arm, and which bodies on them look the same at any yaw."""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.geometry.shapes import LARGEST_M, SMALLEST_M, Piece, Primitive

TURN = 2.0 * math.pi
"""A full turn, rad."""
AXIS_SLACK = 1e-9
"""How far a solid of revolution may be off its body's z axis, m or rad: rounding of a pose, far below any clearance."""


def principal(angle: FloatArray) -> FloatArray:
    """The angle in (−π, π], rad; what is there keeps its bits, but −π and what rounds to it becomes π."""
    wrapped: FloatArray = angle - TURN * np.ceil((angle - math.pi) / TURN)
    return wrapped


def ring_margin(distance: FloatArray, l1: float, l2: float) -> FloatArray:
    """Metres (...) from a point at a distance (...) from where the first of two links turns to the edge of the ring
    that they reach; negative: so far out of reach (K45)."""
    margin: FloatArray = np.minimum(l1 + l2 - distance, distance - abs(l1 - l2))
    return margin


def upright(piece: Piece) -> bool:
    """Whether a solid is one of revolution about its body's z axis, so that it looks the same at any yaw."""
    shape = piece.shape
    if not (isinstance(shape, Primitive) and shape.half[0] == shape.half[1] == 0.0):
        return False
    centred = np.hypot(piece.position[0], piece.position[1]) <= AXIS_SLACK
    is_ball = shape.half[2] == shape.disc == 0.0
    return bool(centred and (is_ball or np.hypot(piece.rotation[0, 2], piece.rotation[1, 2]) <= AXIS_SLACK))


def check_lengths(**lengths: float) -> None:
    """Raises `InputError` for a link that is not from 10 µm to 50 m long, naming it."""
    for name, length in lengths.items():
        if not SMALLEST_M <= length <= LARGEST_M:
            raise InputError(name, length, f"a length from {SMALLEST_M} to {LARGEST_M} m")
