"""Poses (x, y, z, yaw) and motions: a pose with its first three time derivatives.

Every frame of a cell turns about the vertical only, so its attitude is one angle. Equations: docs/kinematics.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

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


_UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, slots=True)
class Motion:
    """Pose of a frame in the world over times of shape (...), with three time derivatives.

    `p, v, a, j` are (..., 3) in m, m/s, m/s², m/s³; `yaw, yaw_d, yaw_dd, yaw_ddd` are (...) in rad, rad/s, ...
    """

    p: FloatArray
    v: FloatArray
    a: FloatArray
    j: FloatArray
    yaw: FloatArray
    yaw_d: FloatArray
    yaw_dd: FloatArray
    yaw_ddd: FloatArray

    def at(self, offset: Pose) -> Motion:
        """Motion of a frame that is fixed in this one at `offset`.

        With r = R(yaw) offset and r⊥ = ẑ × r:  ṙ = ω r⊥,  r̈ = α r⊥ − ω² r,  r⃛ = (α̇ − ω³) r⊥ − 3 ω α r.
        """
        w, dw, ddw = self.yaw_d, self.yaw_dd, self.yaw_ddd
        if offset.x == 0.0 and offset.y == 0.0:
            # on the axis: r⊥ is zero
            return Motion(self.p + offset.z * _UP, self.v, self.a, self.j, self.yaw + offset.yaw, w, dw, ddw)
        c, s = np.cos(self.yaw), np.sin(self.yaw)
        rx, ry = c * offset.x - s * offset.y, s * offset.x + c * offset.y
        if not (w.any() or dw.any() or ddw.any()):
            p = self.p + offset.z * _UP
            p[..., 0] += rx
            p[..., 1] += ry
            return Motion(p, self.v, self.a, self.j, self.yaw + offset.yaw, w, dw, ddw)
        flat, turned = np.zeros((2, *self.p.shape))
        turned[..., 1] = flat[..., 0] = rx
        flat[..., 1] = ry
        turned[..., 0] = -ry
        r = flat.copy()
        r[..., 2] = offset.z
        w_, dw_, ddw_ = w[..., None], dw[..., None], ddw[..., None]
        return Motion(
            self.p + r,
            self.v + w_ * turned,
            self.a + dw_ * turned - w_**2 * flat,
            self.j + (ddw_ - w_**3) * turned - 3 * w_ * dw_ * flat,
            self.yaw + offset.yaw,
            w,
            dw,
            ddw,
        )

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
        return Motion(
            self.p + r,
            self.v + w * turned + rd,
            self.a + dw * turned - w**2 * flat + 2 * w * turned_d + rdd,
            np.full_like(r, np.nan),
            self.yaw + yaw,
            self.yaw_d + yaw_d,
            self.yaw_dd + yaw_dd,
            self.yaw_ddd,
        )

    def __getitem__(self, key: object) -> Motion:
        """The motion at some of the times."""
        return Motion(*(getattr(self, name)[key] for name in Motion.__slots__))

    def at_rest(self) -> Motion:
        """The same poses with all derivatives zero: met in position only."""
        still, unturned = np.zeros((3, *self.p.shape)), np.zeros((3, *self.yaw.shape))
        return Motion(self.p, still[0], still[1], still[2], self.yaw, unturned[0], unturned[1], unturned[2])

    @staticmethod
    def still(pose: Pose, shape: tuple[int, ...] = ()) -> Motion:
        """A pose that does not move, repeated over `shape` times."""
        p = np.empty((*shape, 3))
        p[...] = pose.position
        yaw = np.full(shape, pose.yaw)
        still, unturned = np.zeros((3, *shape, 3)), np.zeros((3, *shape))
        return Motion(p, still[0], still[1], still[2], yaw, unturned[0], unturned[1], unturned[2])
