"""Poses (x, y, z, yaw) and motions: a pose with its first three time derivatives.

Every frame of a cell turns about the vertical only, so its attitude is one angle. Equations: docs/kinematics.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeAlias

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


@dataclass(frozen=True, slots=True)
class TiltedMotion(Motion):
    """A motion with pitch and roll: `tilt` (..., 2) in rad, and three time derivatives. Upright motions have none."""

    tilt: FloatArray
    tilt_d: FloatArray
    tilt_dd: FloatArray
    tilt_ddd: FloatArray

    @staticmethod
    def of(motion: Motion, tilt: FloatArray, *rates: FloatArray) -> TiltedMotion:
        """`motion` with pitch and roll (..., 2) and their three derivatives; without `rates` they do not change."""
        tilt = np.broadcast_to(tilt, (*motion.yaw.shape, 2))
        d, dd, ddd = rates or (np.zeros(tilt.shape),) * 3
        place, turn = (
            (motion.p, motion.v, motion.a, motion.j),
            (motion.yaw, motion.yaw_d, motion.yaw_dd, motion.yaw_ddd),
        )
        return TiltedMotion(*place, *turn, tilt, d, dd, ddd)

    def at(self, offset: Pose) -> TiltedMotion:
        """Motion of a frame beside this one, `offset` being in a frame that has its heading and stays upright."""
        beside = Motion.at(self, offset)
        return TiltedMotion.of(beside, self.tilt, self.tilt_d, self.tilt_dd, self.tilt_ddd)

    def __getitem__(self, key: object) -> TiltedMotion:
        """The motion at some of the times."""
        names = (*Motion.__slots__, *TiltedMotion.__slots__)
        return TiltedMotion(*(getattr(self, name)[key] for name in names))

    def at_rest(self) -> TiltedMotion:
        """The same poses with all derivatives zero: met in position only."""
        return TiltedMotion.of(Motion.at_rest(self), self.tilt)


def like(motion: Motion, pattern: Motion) -> Motion:
    """`motion` with the pitch and roll that `pattern` begins with, if it has any; they stay."""
    return TiltedMotion.of(motion, pattern.tilt.reshape(-1, 2)[0]) if isinstance(pattern, TiltedMotion) else motion
