"""Poses (x, y, z, yaw) and motions: a pose with its first three time derivatives.

Every frame of a cell turns about the vertical only, so its attitude is one angle. Equations: docs/kinematics.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError


@dataclass(frozen=True, slots=True)
class Pose:
    """A pose in a parent frame: metres and radians. Raises `InputError` for a number that is not finite."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    yaw: float = 0.0

    def __post_init__(self) -> None:
        if math.isfinite(self.x + self.y + self.z + self.yaw):
            return  # a sum is finite only if all its terms are
        for name in ("x", "y", "z", "yaw"):
            if not math.isfinite(getattr(self, name)):
                raise InputError(f"pose.{name}", getattr(self, name), "a finite number")

    @property
    def position(self) -> FloatArray:
        """(3,) metres."""
        return np.array([self.x, self.y, self.z])

    def then(self, child: Pose) -> Pose:
        """The pose, in this one's parent, of a child whose pose in this one is `child`."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        return Pose(
            self.x + c * child.x - s * child.y,
            self.y + s * child.x + c * child.y,
            self.z + child.z,
            self.yaw + child.yaw,
        )

    def inverse(self) -> Pose:
        """The pose of the parent in this frame."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        return Pose(-c * self.x - s * self.y, s * self.x - c * self.y, -self.z, -self.yaw)


class _Part:
    """One of the arrays in the table of a motion: of an order, a column or several."""

    def __init__(self, order: int, columns: int | slice | list[int]) -> None:
        self.order, self.columns = order, columns

    def __get__(self, motion: Motion, _: object = None) -> FloatArray:
        return np.asarray(motion.table[..., self.order, self.columns])


ORDERS = range(4)
"""Of a motion: the pose and three time derivatives."""


@dataclass(frozen=True, slots=True)
class Motion:
    """Pose of a frame in the world over times of shape (...), with three time derivatives: a table (..., 4, 4), a row
    an order, columns x, y, z, yaw; or (..., 4, 6), with pitch and roll behind them.

    `p, v, a, j` are (..., 3) in m, m/s, m/s², m/s³; `yaw, yaw_d, yaw_dd, yaw_ddd` are (...) in rad, rad/s, ...; `tilt`
    and so on are pitch and roll (..., 2) of a motion that is `tilted`; of another one they raise `IndexError`.
    """

    table: FloatArray

    p, v, a, j = (_Part(order, slice(3)) for order in ORDERS)
    yaw, yaw_d, yaw_dd, yaw_ddd = (_Part(order, 3) for order in ORDERS)
    tilt, tilt_d, tilt_dd, tilt_ddd = (_Part(order, [4, 5]) for order in ORDERS)

    @staticmethod
    def of(*parts: FloatArray) -> Motion:
        """The motion with `p, v, a, j` (..., 3) and `yaw, yaw_d, yaw_dd, yaw_ddd` (...)."""
        table = np.empty((*parts[0].shape[:-1], 4, 4))
        for order in ORDERS:
            table[..., order, :3], table[..., order, 3] = parts[order], parts[4 + order]
        return Motion(table)

    @property
    def tilted(self) -> bool:
        """Whether it has pitch and roll; motions that stay upright have none."""
        return bool(self.table.shape[-1] > 4)

    def with_tilt(self, *tilts: FloatArray) -> Motion:
        """This motion with pitch and roll (..., 2) and their derivatives, 0 where left out."""
        table = np.zeros((*self.table.shape[:-1], 6))
        table[..., :4] = self.table[..., :4]
        for order, each in enumerate(tilts):
            table[..., order, 4:] = each
        return Motion(table)

    def at(self, offset: Pose, above: FloatArray | float = 0.0) -> Motion:
        """Motion of a frame that is fixed in this one at `offset`, and `above` it, m, a number or one for each time. Of
        a hand that tilts, `offset` is in a frame that has its heading and stays upright."""
        table = self.table.copy()
        if offset.x != 0.0 or offset.y != 0.0:
            from assur.planner.kernels.motion import move_aside

            move_aside(table.reshape(-1, *table.shape[-2:]), offset.x, offset.y)
        table[..., 0, 2] += offset.z + above
        table[..., 0, 3] += offset.yaw
        return Motion(table)

    def carrying(self, place: FloatArray, rate: FloatArray, bend: FloatArray, *yaws: FloatArray | float) -> Motion:
        """Motion of a frame that moves in this one: its place (T, 3), velocity and acceleration in it; `yaws`: by which
        it is turned against this one, and two derivatives of that, 0 where left out. The jerk is not known: NaN.

        With r = R(yaw) place and so on:  v = ṗ + ω r⊥ + ṙ,  a = p̈ + α r⊥ − ω² r + 2 ω ṙ⊥ + r̈.
        """
        yaw, yaw_d, yaw_dd = (*yaws, 0.0, 0.0, 0.0)[:3]
        c, s = np.cos(self.yaw), np.sin(self.yaw)
        r, rd, rdd = (
            np.stack([c * x[..., 0] - s * x[..., 1], s * x[..., 0] + c * x[..., 1], x[..., 2]], -1)
            for x in (place, rate, bend)
        )
        flat, turned, turned_d = r.copy(), np.zeros_like(r), np.zeros_like(r)
        flat[..., 2] = 0.0
        turned[..., 0], turned[..., 1] = -r[..., 1], r[..., 0]
        turned_d[..., 0], turned_d[..., 1] = -rd[..., 1], rd[..., 0]
        w, dw = self.yaw_d[..., None], self.yaw_dd[..., None]
        return Motion.of(
            self.p + r,
            self.v + w * turned + rd,
            self.a + dw * turned - w**2 * flat + 2 * w * turned_d + rdd,
            np.full_like(r, np.nan),
            self.yaw + yaw,
            self.yaw_d + yaw_d,
            self.yaw_dd + yaw_dd,
            self.yaw_ddd,
        )

    def __getitem__(self, key: Any) -> Motion:
        """The motion at some of the times."""
        return Motion(self.table[key])

    def at_rest(self) -> Motion:
        """The same poses with all derivatives zero: met in position only."""
        table = np.zeros(self.table.shape)
        table[..., 0, :] = self.table[..., 0, :]
        return Motion(table)

    @staticmethod
    def still(pose: Pose, shape: tuple[int, ...] = ()) -> Motion:
        """A pose that does not move, repeated over `shape` times."""
        table = np.zeros((*shape, 4, 4))
        table[..., 0, :] = pose.x, pose.y, pose.z, pose.yaw
        return Motion(table)


# How far points that a link or a frame carries move at most over an interval, from its jets.


@dataclass(frozen=True, slots=True)
class Sweep:
    """The jets (12, 6) of a carrier over an interval (`assur.planner.kernels.jets`)."""

    jets: FloatArray

    def point(self, order: int, x: float, y: float, z: float) -> FloatArray:
        """Upper bounds (3,) of the magnitudes of the coordinates, in the world, of the derivative of that order (1 or
        2) of the point (x, y, z) that is carried; infinite where nothing is known (K43)."""
        if not np.isfinite(self.jets).all():
            return np.full(3, np.inf)
        place = np.array([1.0, x, y, z])
        middle = place @ self.jets[:, 2 * order].reshape(4, 3)
        radius = np.abs(place) @ self.jets[:, 2 * order + 1].reshape(4, 3)
        return np.asarray(np.abs(middle) + radius)

    def turning(self, order: int) -> float:
        """An upper bound of the magnitude of that derivative of the horizontal direction of a carrier's x axis, if it
        stays upright: of the order 1 its rate of turning, rad/s."""
        if not np.isfinite(self.jets).all():
            return float(np.inf)
        return float(np.hypot(*(abs(self.jets[k, 2 * order]) + self.jets[k, 2 * order + 1] for k in (3, 4))))


# Motions of a hand that has a pitch and a roll beside its heading.
#
# Frames of a cell turn about the vertical only; the hand of an arm with a wrist does not. Its attitude in the world is
# Rz(yaw) Ry(−pitch) Rx(roll), equation H1 of docs/kinematics.md: `yaw` is the heading of the arm's vertical plane, the
# pitch is that of the tool axis (x) above the horizontal in this plane, the roll is about the tool axis.

Tilt: TypeAlias = tuple[float, float]
"""Pitch and roll, rad."""
