"""What can be said of solids at a glance: from above an oblong or a circle, from the side a height."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.collision.arrangement import Carriers, Solids


@dataclass(frozen=True, slots=True)
class Outlines:
    """Units from above and from the side: centres x, y, z (T, U), half heights `tall` (T, U) or (U,) about them.

    From above all of a unit is within an oblong of half edges `oblong` (U, 2) along (c, s) (T, U) and across it, grown
    by `round` (U,), and within the circle of radius `wide` (U,).
    """

    x: FloatArray
    y: FloatArray
    z: FloatArray
    c: FloatArray
    s: FloatArray
    tall: FloatArray
    oblong: FloatArray
    round: FloatArray
    wide: FloatArray


UPRIGHT = 1e-12
"""A unit whose z axis is off its carrier's by no more than this (a few roundings, rad) stands upright in it."""


def outlines(solids: Solids, where: Carriers, units: IntArray) -> Outlines:
    """Of units (U,) at all times (T,) of `where`; NaN where a carrier is not known."""
    carrier, inside = solids.carrier[units], solids.rotation[units]
    half, disc, ball = solids.half[units], solids.disc[units], solids.ball[units]
    cx, cy, cz = solids.centre[units].T
    position, rotation = where.position, where.rotation
    turning = rotation[:, carrier, 0, 0], rotation[:, carrier, 1, 0]
    if (rotation[..., 2, 2] == 1.0).all():  # all carriers turn about the vertical only
        x = position[:, carrier, 0] + turning[0] * cx - turning[1] * cy
        y = position[:, carrier, 1] + turning[1] * cx + turning[0] * cy
        z = position[:, carrier, 2] + cz
        upright = np.maximum(np.abs(inside[:, 2, 0]), np.abs(inside[:, 2, 1])) <= UPRIGHT
        up = inside[:, 2]
    else:
        centre = position[:, carrier] + (rotation[:, carrier] @ solids.centre[units][None, :, :, None])[..., 0]
        x, y, z = centre[..., 0], centre[..., 1], centre[..., 2]
        upright, turning = np.zeros(len(units), dtype=bool), (np.ones(x.shape), np.zeros(x.shape))
        up = (rotation[:, carrier, 2:3, :] @ inside[None])[:, :, 0, :]
    tall = (np.abs(up) * half).sum(-1) + disc * np.hypot(up[..., 0], up[..., 1]) + ball
    for k in np.flatnonzero(solids.hull[units] >= 0):
        vertices = solids.hulls[int(solids.hull[units[k]])].vertices
        # about its own origin, which need not be its middle
        ball[k], upright[k] = float(np.sqrt((vertices**2).sum(-1)).max()), False
        tall[..., k], half[k] = ball[k], 0.0
    grown = disc + ball
    wide = grown + np.sqrt(half[:, 0] ** 2 + half[:, 1] ** 2 + np.where(upright, 0.0, half[:, 2]) ** 2)
    # what does not stand upright is a circle from above, which may be turned in any way
    ux, uy = np.where(upright, inside[:, :2, 0].T, ((1.0,), (0.0,)))
    oblong = np.where(upright[:, None], half[:, :2], 0.0)
    c, s = turning[0] * ux - turning[1] * uy, turning[1] * ux + turning[0] * uy
    return Outlines(x, y, z, c, s, tall, oblong, np.where(upright, grown, wide), wide)
