"""What the kernels read: units, frames and the arm as plain arrays, packed once and kept for as long as their owner.

What has no such form (another arm than a SCARA, a law with ramps) is packed as None: the original does its work then,
and `FALLBACKS` says so.
"""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from planner.arrays import FloatArray, IntArray
from planner.frames import Fixed, Linear, Turntable
from planner.frames.fixed import ROUNDING
from planner.frames.validity import FURTHEST_S
from planner.robots.scara import Scara
from planner.scene import Scene
from planner.solids import COVER, Solids

FALLBACKS: Counter[str] = Counter()
"""Name of a replaced function → calls that were left to the original."""


@dataclass(frozen=True, eq=False)
class Units:
    """`number` (U, 4), `table` (U, 18) and `vertices` (V, 3) of a `Solids`; the last column of `table` is the reach.
    `plain`: whether each unit is a whole body."""

    number: IntArray
    table: FloatArray
    vertices: FloatArray
    plain: bool


@dataclass(frozen=True, eq=False)
class Cell:
    """`arm` (8,): l1, l2, base x, y, z, yaw, axes, lowest lifted link; `laws` (F, 12): pose, velocity, rate, time of
    the pose, first and last known time, rounding of the speed."""

    arm: FloatArray
    laws: FloatArray


_units: WeakKeyDictionary[Solids, Units] = WeakKeyDictionary()
_cells: WeakKeyDictionary[Scene, Cell] = WeakKeyDictionary()


def forget() -> None:
    """Nothing of an earlier request is kept."""
    _units.clear()
    _cells.clear()


def units(solids: Solids) -> Units:
    """The units of an arrangement."""
    found = _units.get(solids)
    if found is None:
        found = _units[solids] = _pack(solids)
    return found


def _pack(solids: Solids) -> Units:
    count = len(solids.body)
    number, table = np.zeros((count, 4), dtype=np.int64), np.empty((count, 18))
    number[:, 0], number[:, 1] = solids.carrier, solids.hull
    sizes = np.cumsum([0, *(len(hull.vertices) for hull in solids.hulls)])
    for u in np.flatnonzero(solids.hull >= 0):
        number[u, 2:] = sizes[solids.hull[u]], sizes[solids.hull[u] + 1]
    table[:, :3], table[:, 3:12] = solids.centre, solids.rotation.reshape(-1, 9)
    table[:, 12:15], table[:, 15], table[:, 16], table[:, 17] = solids.half, solids.disc, solids.ball, solids.reach
    vertices = np.concatenate([np.zeros((0, 3)), *(hull.vertices for hull in solids.hulls)])
    return Units(number, table, vertices, bool((solids.piece != COVER).all()) and not solids.hulls)


def cell(scene: Scene) -> Cell | None:
    """Arm and frames of a scene; None: it has something that the kernels do not know."""
    found = _cells.get(scene)
    if found is None:
        arm, rows = scene.robot, [law(frame.law) for frame in scene.frames.values()]
        known = [row for row in rows if row is not None]
        if not isinstance(arm, Scara) or len(known) < len(rows):
            return None
        found = _cells[scene] = Cell(arm_row(arm), np.array(known).reshape(-1, 12))
    return found


def arm_row(arm: Scara) -> FloatArray:
    """A SCARA in numbers."""
    base = arm.base
    return np.array([arm.l1, arm.l2, base.x, base.y, base.z, base.yaw, arm.axes, arm.lowest_lifted], dtype=np.float64)


def law(of: Any) -> list[float] | None:
    """A law of constant velocity and rate in numbers."""
    speed, rate, at, rounding = (0.0, 0.0, 0.0), 0.0, 0.0, 0.0
    if isinstance(of, Linear):
        speed, at, rounding = of.velocity, of.at_time, ROUNDING * math.hypot(*of.velocity)
    elif isinstance(of, Turntable) and not of.changes:
        speed, rate, at = (0.0, 0.0, of.rise), of.rate, of.at_time
    elif not isinstance(of, Fixed):
        return None
    first, last = max(of.valid[0], -FURTHEST_S), min(of.valid[1], FURTHEST_S)
    pose = of.pose
    return [pose.x, pose.y, pose.z, pose.yaw, *speed, rate, at, first, last, rounding]
