"""What the kernels take for an arm and a motion, and the motion that they give back.

The web process loads robots and must not load numba, so this module is imported where it is first needed.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.claim import columns as c
from assur.planner.frames.motion import Motion
from assur.planner.kernels import links as of
from assur.planner.kernels.motion import COORDINATES, ORDERS, link_motions

if TYPE_CHECKING:
    from assur.planner.robots.robot import Robot

FAMILIES = {
    "scara": of.SCARA,
    "five-bar": of.FIVE_BAR,
    "elbow": of.ELBOW,
    "polar": of.POLAR,
    "five-axis": of.FIVE_AXIS,
}
"""Kinds of arms by name."""
PLACES = (
    ("height", of.HEIGHT),
    ("separation", of.HEIGHT),
    ("arms_rise", of.RISES),
    ("sigma", of.SIGMA),
    ("parallel_least", of.PARALLEL_LEAST),
    ("longest", of.LONGEST),
)
"""Numbers that not every family has, and their columns."""


def row_of(arm: Robot) -> FloatArray:
    """The arm as a row of numbers, SI units."""
    row = np.zeros(of.CHAIN)
    row[of.KIND], row[of.JOINTS], row[of.LINKS] = FAMILIES[arm.family], len(arm.joints), len(arm.links)
    base = arm.base
    row[[of.BASE_X, of.BASE_Y, of.BASE_Z, of.BASE_YAW]] = base.x, base.y, base.z, base.yaw
    row[of.BASE_COS], row[of.BASE_SIN] = math.cos(base.yaw), math.sin(base.yaw)
    row[of.L1 : of.L1 + len(arm.lengths)] = arm.lengths
    for name, column in PLACES:
        row[column] = getattr(arm, name, row[column])
    rows = arm.chain_rows
    constant = rows.angles[:, c.ANGLE_CONSTANT]
    moves = rows.angles[:, c.ANGLE_SHARE :].any(1)
    angles = np.column_stack([rows.angles, moves, np.cos(constant), np.sin(constant)])
    loop = np.append(rows.loops, rows.apart) if len(rows.loops) else np.zeros(0)
    row[of.ANGLES], row[of.ANGLE_COUNT] = of.CHAIN + rows.links.size, len(angles)
    end = of.CHAIN + rows.links.size + angles.size
    row[of.LOOP], row[of.SIZE] = end if len(loop) else 0.0, end + len(loop)
    return np.concatenate([row, rows.links.ravel(), angles.ravel(), loop])


def targets_of(flange: Motion, order: int) -> FloatArray:
    """A motion as the kernels take it, (..., 4, 6), up to a derivative; what is beyond is 0."""
    targets = np.zeros((*flange.table.shape[:-2], ORDERS, COORDINATES))
    targets[..., : order + 1, : flange.table.shape[-1]] = flange.table[..., : order + 1, :]
    return targets


def moved(arm: Robot, link: int, *orders: FloatArray) -> FloatArray:
    """Motion (..., 4, 6) of a link for q and up to three derivatives (..., n), those not given being 0."""
    joints = np.zeros((*orders[0].shape[:-1], ORDERS, len(arm.joints)))
    for k, each in enumerate(orders):
        joints[..., k, :] = each
    out = np.empty((*joints.shape[:-2], ORDERS, COORDINATES))
    flat = joints.reshape(-1, ORDERS, joints.shape[-1])
    link_motions(arm.row, link, flat, out.reshape(-1, ORDERS, COORDINATES))
    return out
