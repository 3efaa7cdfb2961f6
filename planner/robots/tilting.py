"""Arms whose links tilt: a base that turns, and a mechanism of two joints in a vertical plane (and, maybe, a wrist).

The base is an RPR dyad in the horizontal plane: angle φ1 and radius ρ of the tool point. What is left is the point
(ρ, h), h the height above the shoulder, in the plane that the base turns; an RRR dyad there makes the elbow arm, an RPR
dyad the polar arm. In complex numbers, ζ = ρ + i h in the plane and p = p_b + ρ e(φ1) + (height + h) ẑ, equations K23
to K31 of docs/kinematics.md. Sources: 002 (both arms), 003 (elbow arm).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.assur.codes import Code
from assur.planner.assur.rpr import RPR
from assur.planner.assur.rrr import ROUNDING
from assur.planner.errors import FaultError, InputError
from assur.planner.frames.motion import Motion, Pose
from assur.planner.robots.planar import principal
from assur.planner.robots.protocol import Inverse, Joint, Limits, RobotBody, Serial, Sweep
from assur.planner.robots.riders import check_riders, joints_of
from assur.planner.robots.vertical_plane import BASE, LINK1, LINK2, LINK3, LINKS, TILTING, InVerticalPlane, turned


@dataclass(frozen=True, eq=False, kw_only=True)
class TiltingArm(InVerticalPlane, Serial):
    """What elbow, polar and five-axis arm share; with what is in its plane it is a
    `assur.planner.robots.protocol.Robot`.

    Link frames: `base` at the base origin; `link1` at the shoulder, turned by φ1, upright; `link2` at the shoulder and
    `link3`, `flange` where the arm says, turned by φ1 and then tilted: x ahead along the link, y level, so that all
    frames have the base's axes where all angles are 0.

    Arguments: `name`; `height` of the shoulder above the base origin, m; `limits` in the order of q; `base` in the
    world; `bodies` on links by number; `self_pairs` of link names; `joint_names`. Raises `InputError` for what is not
    one. Not checked: that bodies of neighbouring links do not overlap.
    """

    name: str
    height: float
    limits: Limits
    base: Pose = field(default_factory=Pose)
    bodies: tuple[RobotBody, ...] = ()
    self_pairs: tuple[tuple[str, str], ...] = ()
    joint_names: tuple[str, ...] = ()
    links: tuple[str, ...] = field(default=LINKS, init=False, repr=False)
    tilting: frozenset[int] = field(default=TILTING, init=False, repr=False)
    coordinates: tuple[str, ...] = field(default=("x", "y", "z"), init=False, repr=False)
    lift: int | None = field(default=None, init=False, repr=False)
    joints: tuple[Joint, ...] = field(init=False, repr=False)
    turn: RPR = field(init=False, repr=False)

    def __post_init__(self) -> None:
        names = self.joint_names or self._names()
        object.__setattr__(self, "joints", joints_of(names, self._kinds(), self.limits))
        object.__setattr__(self, "joint_names", names)
        check_riders(self.links, self.bodies, self.self_pairs)
        if not np.isfinite(self.height):
            raise InputError("robot.height", self.height, "a finite number")
        object.__setattr__(self, "turn", RPR(ROUNDING * self.longest))

    @property
    def tip(self) -> int:
        """Number of the flange, the last link."""
        return len(self.links) - 1

    @np.errstate(all="ignore")
    def inverse(self, flange: Motion, mode: int, order: int = 3) -> Inverse:
        """Joint motion that gives the flange this motion (world) in working mode `mode`, K23, K24 or K25.

        Derivatives above `order` are NaN. The yaw is not looked at. Codes: those of the dyad in the plane; ALIGNED
        where the flange is over the base axis (then q1 is NaN, the other positions are known); OUT_OF_REACH for a row
        that is not finite in what was asked. Revolute joints are in (−π, π]. Not checked: joint limits (`within`).
        """
        if mode not in range(len(self.modes)) or order not in range(4):
            raise FaultError(f"{type(self).__name__}.inverse: mode {mode}, order {order}")
        sign, assembly = self._side(mode)
        path = (flange.p - self.base.position, flange.v, flange.a, flange.j)[: order + 1]
        seen = self.turn.solve(sign, *((x[..., 0], x[..., 1]) for x in path))
        aligned = seen.code == Code.INDETERMINATE
        radii = [seen.length, *(pair[1] for pair in seen.rates)]
        heights = [x[..., 2] for x in path]
        heights[0] = heights[0] - self.height
        # over the axis the radius has no derivatives, but the posture is that of (0, h)
        flat = [np.where(aligned, 0.0, radius) for radius in radii]
        solved = self._assembled(assembly, self._inward(flange, list(zip(flat, heights, strict=True))))
        joints = np.empty((order + 1, *solved.code.shape, 3))
        joints[..., 1:] = solved.joints
        joints[0, ..., 0] = principal(seen.angle - self.base.yaw)
        for k, pair in enumerate(seen.rates, start=1):
            joints[k, ..., 0] = pair[0]
        code = np.where(seen.code == Code.OUT_OF_REACH, Code.OUT_OF_REACH, solved.code)
        placed = (code != Code.OUT_OF_REACH) & (code != Code.INDETERMINATE)
        code = np.where(placed & aligned, Code.ALIGNED, code).astype(np.int64)
        joints[1:, code != Code.ASSEMBLED] = np.nan
        joints[0, ~placed] = np.nan
        margin = np.where(placed, np.minimum(solved.margin, np.abs(flat[0]) / self.longest), np.nan)
        q, qd, qdd, qddd = [*joints, *(np.full_like(joints[0], np.nan) for _ in range(3 - order))]
        return Inverse(q, qd, qdd, qddd, code, margin)

    @np.errstate(all="ignore")
    def forward(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Flange position (..., 3) and heading (...) in the world for q (..., n); NaN where q is not finite."""
        rho, h = self._zeta(self.tip, (q,))[0]
        phi = q[..., 0] + self.base.yaw
        p = np.stack([rho * np.cos(phi), rho * np.sin(phi), h + self.height], -1)
        return p + self.base.position, phi

    @np.errstate(all="ignore")
    def placements(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Link frames in the world for q (..., n): positions (..., L, 3) and rotations (..., L, 3, 3), K31."""
        shape, phi = (*q.shape[:-1], len(self.links)), q[..., 0] + self.base.yaw
        c, s = np.cos(phi), np.sin(phi)
        p, rotation = np.empty((*shape, 3)), np.zeros((*shape, 3, 3))
        p[...] = self.base.position
        p[..., LINK1:, 2] += self.height
        for link in range(LINK3, len(self.links)):
            rho, h = self._zeta(link, (q,))[0]
            p[..., link, 0] += rho * c
            p[..., link, 1] += rho * s
            p[..., link, 2] += h
        rotation[..., 2, 2] = 1.0
        for link, cos, sin in ((BASE, np.cos(self.base.yaw), np.sin(self.base.yaw)), (LINK1, c, s)):
            rotation[..., link, 0, 0] = rotation[..., link, 1, 1] = cos
            rotation[..., link, 1, 0], rotation[..., link, 0, 1] = sin, -sin
        for link in range(LINK2, len(self.links)):
            psi = self._tilt(link, q)
            up, ahead = np.sin(psi), np.cos(psi)
            columns = ((ahead * c, ahead * s, up), (-s, c, 0.0 * up), (-up * c, -up * s, ahead))
            for column, entries in enumerate(columns):
                for row, entry in enumerate(entries):
                    rotation[..., link, row, column] = entry
        return p, rotation

    @np.errstate(all="ignore")
    def link_motion(self, link: int, q: FloatArray, qd: FloatArray, qdd: FloatArray, qddd: FloatArray) -> Motion:
        """Motion of a link's origin in the world for joint motion (..., n), its yaw being the heading φ1, K23.

        Raises `FaultError` for a link that does not exist. NaN where the joint motion is not finite.
        """
        if link not in range(len(self.links)):
            raise FaultError(f"{type(self).__name__}.link_motion: link {link}")
        if link == BASE:
            return Motion.still(self.base, q.shape[:-1])
        joints = (q, qd, qdd, qddd)
        phi = [x[..., 0] for x in joints]
        phi[0] = phi[0] + self.base.yaw
        plane = self._zeta(link, joints)
        flat = turned([x[0] for x in plane], phi)
        orders = [np.stack([x, y, h], -1) for (x, y), (_, h) in zip(flat, plane, strict=True)]
        orders[0] = orders[0] + self.base.position + np.array([0.0, 0.0, self.height])
        return Motion(orders[0], orders[1], orders[2], orders[3], phi[0], phi[1], phi[2], phi[3])

    @np.errstate(all="ignore")
    def jacobian(self, q: FloatArray) -> FloatArray:
        """(..., 3, 3): rates of x, y, z in the world per joint rate, K26 or K27."""
        phi, rho = q[..., 0] + self.base.yaw, self._zeta(self.tip, (q,))[0][0]
        c, s, plane = np.cos(phi), np.sin(phi), self._plane_jacobian(q)
        found = np.zeros((*q.shape[:-1], 3, 3))
        found[..., 0, 0], found[..., 1, 0] = -rho * s, rho * c
        found[..., 0, 1:] = c[..., None] * plane[..., 0, :]
        found[..., 1, 1:] = s[..., None] * plane[..., 0, :]
        found[..., 2, 1:] = plane[..., 1, :]
        return found

    def _alignment(self, q: FloatArray) -> FloatArray:
        """Distance (...) of the flange from the base axis, m."""
        rho: FloatArray = self._zeta(self.tip, (q,))[0][0]
        return np.abs(rho)

    @np.errstate(all="ignore")
    def margin(self, q: FloatArray) -> FloatArray:
        """The lesser (...) of the dyad's own margin and of the flange's distance from the base axis over `longest`."""
        return np.minimum(self._dyad_margin(q)[0], self._alignment(q) / self.longest)

    @np.errstate(all="ignore")
    def singularity(self, q: FloatArray) -> IntArray:
        """ALIGNED (...) where the base axis counts most in the margin, else the edge that the dyad is nearer to."""
        margin, code, _ = self._dyad_margin(q)
        return np.where(self._alignment(q) / self.longest < margin, int(Code.ALIGNED), code)

    @np.errstate(all="ignore")
    def singular_distance(self, q: FloatArray) -> FloatArray:
        """Metres (...) that the flange may move until the arm is singular, K30."""
        return np.minimum(self._dyad_margin(q)[2], self._alignment(q))

    def within(self, q: FloatArray) -> BoolArray:
        """Whether q (..., n) keeps the position limits, (...); NaN does not."""
        return self.limits.holds(q)

    @np.errstate(all="ignore")
    def point_bounds(
        self, link: IntArray, reach: FloatArray, distance: FloatArray, n: FloatArray, sweep: Sweep, /
    ) -> tuple[FloatArray, FloatArray]:
        """Upper bounds of |n·ẋ| (K28) and |n·ẍ| (K29) over N intervals for the points of a link.

        Proof. A point moves in the plane as ζ does, by at most |ζ̇| and |ζ̈|, and with the plane about the base axis, at
        a horizontal distance of at most R. The latter adds, across, R |φ̇1| to its velocity, and to its acceleration
        R φ̈1 and R φ̇1² at a right angle and the Coriolis term 2 ρ̇ φ̇1. What is across counts along n by |n_xy|.

        Arguments: `link`, `reach`, `distance` (N,), m; `n` (N, 3); `sweep` of this robot's `rate_matrix`. Rows with
        NaN, or a negative reach or distance, are bounded by inf. Raises `FaultError` for a link that does not exist.
        """
        if not ((link >= 0) & (link < len(self.links))).all():
            raise FaultError(f"{type(self).__name__}.point_bounds: no such link")
        v, a, far = self._plane_bounds(link, np.where(distance >= 0, distance, np.nan), sweep)
        upright = link < LINK2
        radius = np.where(upright, np.where(reach >= 0, reach, np.nan), far)
        v, a = np.where(upright, 0.0, v), np.where(upright, 0.0, a)
        across, w, dw = np.hypot(n[:, 0], n[:, 1]), sweep.rate[:, 0], sweep.rate_d[:, 0]
        speed = v + across * radius * w
        acceleration = a + across * (radius * np.hypot(dw, w * w) + 2.0 * v * w)
        # the base does not move at all, and is not asked what it does
        still = link == BASE
        found = []
        for bound in (speed, acceleration):
            bound = np.where(still & ~np.isnan(bound), 0.0, bound)
            found.append(np.where(bound >= 0, bound, np.inf))
        return found[0], found[1]
