"""The SCARA with three (RRP) or four axes (RRPR): one RRR dyad, a prismatic quill, a wrist.

q = [θ1, θ2, z] or [θ1, θ2, z, θ4]: θ2 = θ_BC − θ1 (Denavit-Hartenberg), z the height of the flange above the base
origin (up), θ4 turns the flange against link 2. With the base at yaw ψ, the absolute angles are

    φ1 = ψ + θ1        φ2 = φ1 + θ2        φ4 = φ2 + θ4  (φ2 with three axes)                           (K9)

and a point is base + l1 e(φ1) + l2 e(φ2) + r e(φ4 + const) + z ẑ with e(φ) = (cos φ, sin φ).
Sources: 000 section 3 for the dyad, 001 for the wrist, both as mended in docs/kinematics.md.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray, frozen
from assur.planner.assur.rrr import LEFT, RIGHT, RRR
from assur.planner.errors import FaultError, InputError
from assur.planner.frames.motion import Motion, Pose
from assur.planner.robots.planar import add_arm, arm_bounds, elbow_singularity, principal
from assur.planner.robots.protocol import Code, Inverse, Joint, Limits, RobotBody, Serial, Sweep
from assur.planner.robots.riders import check_riders, joints_of

LINKS = ("base", "link1", "link2", "quill", "flange")
BASE, LINK1, LINK2, QUILL, FLANGE = range(5)
MODES = ("left", "right")
SIGMA = (LEFT, RIGHT)
"""σ of the dyad for each mode: left is assembly mode 1 (θ2 < 0), right is mode 2 (θ2 > 0)."""

_RATES = frozen([[1, 0, 0, 0], [1, 1, 0, 0], [0, 0, 1, 0], [1, 1, 0, 1]], (4, 4), "rate_matrix")
_SPIN = frozen([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0], [0, 0, 1]], (5, 3), "spin")
"""Which of φ̇1, φ̇2, φ̇4 turns each link frame; the quill's does not turn."""


@dataclass(frozen=True, eq=False)
class Scara(Serial):
    """A SCARA arm; implements `assur.planner.robots.protocol.Robot`.

    Link frames: `base` at the base origin; `link1` at the shoulder axis, turned by φ1; `link2` at the elbow axis,
    turned by φ2, both at the height of the base origin; `quill` at the flange, never turned (world axes), for solids
    of revolution; `flange` at the flange, turned by φ4.

    Arguments: `name`; `l1`, `l2` lengths in m; `axes` 3 or 4; `limits` in the order of q; `base` in the world;
    `bodies` on links by number; `self_pairs` of link names; `joint_names`; `arms_rise`: the lift carries the arms, too
    (axis order R-P-R-R), so `link1` and `link2` are at the height of the flange; q keeps its order. Raises `InputError`
    for what is not one. Not checked: that bodies of neighbouring links do not overlap.
    """

    name: str
    l1: float
    l2: float
    axes: int
    limits: Limits
    base: Pose = field(default_factory=Pose)
    bodies: tuple[RobotBody, ...] = ()
    self_pairs: tuple[tuple[str, str], ...] = ()
    joint_names: tuple[str, ...] = ()
    arms_rise: bool = False
    modes: tuple[str, ...] = field(default=MODES, init=False, repr=False)
    links: tuple[str, ...] = field(default=LINKS, init=False, repr=False)
    tilting: frozenset[int] = field(default=frozenset(), init=False, repr=False)
    lift: int | None = field(default=2, init=False, repr=False)
    joints: tuple[Joint, ...] = field(init=False, repr=False)
    lowest_lifted: int = field(init=False, repr=False)
    dyad: RRR = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if self.axes not in (3, 4):
            raise InputError("robot.axes", self.axes, "3 or 4")
        names = self.joint_names or ("theta1", "theta2", "z", "theta4")[: self.axes]
        kinds = ("revolute", "revolute", "prismatic", "revolute")[: self.axes]
        object.__setattr__(self, "joints", joints_of(names, kinds, self.limits))
        object.__setattr__(self, "joint_names", names)
        check_riders(LINKS, self.bodies, self.self_pairs)
        object.__setattr__(self, "dyad", RRR(self.l1, self.l2))
        object.__setattr__(self, "lowest_lifted", LINK1 if self.arms_rise else QUILL)

    @property
    def coordinates(self) -> tuple[str, ...]:
        return ("x", "y", "z", "yaw")[: self.axes]

    @property
    def rate_matrix(self) -> FloatArray:
        """(4, n): φ̇1, φ̇2, ż, φ̇4 per joint rate (three axes: the last is φ̇2 again)."""
        return _RATES[:, : self.axes]

    @np.errstate(all="ignore")
    def inverse(self, flange: Motion, mode: int, order: int = 3) -> Inverse:
        """Joint motion that gives the flange this motion (world), in working mode `mode` (0 left, 1 right), K10.

        Derivatives above `order` are not computed and NaN, so that position alone is cheap. A three-axis arm does not
        look at the yaw. Rows that are not ASSEMBLED: see `Inverse`; a row that is not finite in what was asked is
        OUT_OF_REACH. θ1 and θ4 are in (−π, π]; θ2 of a folded arm is −π left and π right.
        Not checked: joint limits (`within`).
        """
        if mode not in (0, 1) or order not in range(4):
            raise FaultError(f"Scara.inverse: mode {mode}, order {order}")
        path = (flange.p, flange.v, flange.a, flange.j)[: order + 1]
        turn = (flange.yaw, flange.yaw_d, flange.yaw_dd, flange.yaw_ddd)[: order + 1]
        d = (path[0][..., 0] - self.base.x, path[0][..., 1] - self.base.y)
        solved = self.dyad.solve(SIGMA[mode], d, *((x[..., 0], x[..., 1]) for x in path[1:]))
        (ux, uy), (wx, wy), code, margin = solved.u, solved.w, solved.code, solved.margin
        joints = np.empty((order + 1, *code.shape, self.axes))
        first = joints[0]
        first[..., 0] = principal(np.arctan2(uy, ux) - self.base.yaw)
        first[..., 1] = np.arctan2(solved.cross, ux * wx + uy * wy)
        first[..., 2] = path[0][..., 2] - self.base.z
        if self.axes == 4:
            first[..., 3] = principal(turn[0] - self.base.yaw - first[..., 0] - first[..., 1])
        for k, (rate1, rate2) in enumerate(solved.rates, start=1):
            joints[k, ..., 0], joints[k, ..., 1], joints[k, ..., 2] = rate1, rate2 - rate1, path[k][..., 2]
            if self.axes == 4:
                joints[k, ..., 3] = turn[k] - rate2
        watched = [*(x[..., 2] for x in path), *(turn if self.axes == 4 else ())]
        unknown = np.isnan(sum((x * 0.0 for x in watched), np.zeros(code.shape)))  # 0 · NaN and 0 · inf are NaN
        if code.any() or unknown.any():
            code = np.where(unknown, Code.OUT_OF_REACH, code).astype(np.int64)
            joints[1:, code != Code.ASSEMBLED] = np.nan
            nowhere = (code == Code.OUT_OF_REACH) | (code == Code.INDETERMINATE)
            joints[0, nowhere] = np.nan
            margin = np.where(nowhere, np.nan, margin)
        q, qd, qdd, qddd = [*joints, *(np.full_like(first, np.nan) for _ in range(3 - order))]
        return Inverse(q, qd, qdd, qddd, code, margin)

    @np.errstate(all="ignore")
    def forward(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Flange position (..., 3) and yaw (...) in the world for q (..., n); NaN where q is not finite."""
        phi1 = q[..., 0] + self.base.yaw
        phi2 = phi1 + q[..., 1]
        p = np.empty((*q.shape[:-1], 3))
        p[..., 0] = self.base.x + self.l1 * np.cos(phi1) + self.l2 * np.cos(phi2)
        p[..., 1] = self.base.y + self.l1 * np.sin(phi1) + self.l2 * np.sin(phi2)
        p[..., 2] = self.base.z + q[..., 2]
        return p, phi2 + q[..., 3] if self.axes == 4 else phi2

    @np.errstate(all="ignore")
    def placements(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Link frames in the world for q (..., n): positions (..., 5, 3) and rotations (..., 5, 3, 3), K9."""
        shape, base = q.shape[:-1], self.base
        phi1 = q[..., 0] + base.yaw
        phi2 = phi1 + q[..., 1]
        phi4 = phi2 + q[..., 3] if self.axes == 4 else phi2
        p, rotation = np.empty((*shape, 5, 3)), np.empty((*shape, 5, 3, 3))
        rotation[...] = np.eye(3)
        p[...] = base.position
        turned = [(LINK1, np.cos(phi1), np.sin(phi1)), (LINK2, np.cos(phi2), np.sin(phi2))]
        turned.append((FLANGE, np.cos(phi4), np.sin(phi4)) if self.axes == 4 else (FLANGE, *turned[1][1:]))
        turned.append((BASE, np.cos(base.yaw), np.sin(base.yaw)))
        for link, c, s in turned:
            rotation[..., link, 0, 0] = rotation[..., link, 1, 1] = c
            rotation[..., link, 1, 0], rotation[..., link, 0, 1] = s, -s
        for axis in (0, 1):
            elbow = base.position[axis] + self.l1 * turned[0][1 + axis]
            p[..., LINK2, axis] = elbow
            p[..., QUILL, axis] = p[..., FLANGE, axis] = elbow + self.l2 * turned[1][1 + axis]
        p[..., self.lowest_lifted :, 2] = (base.z + q[..., 2])[..., None]
        return p, rotation

    @np.errstate(all="ignore")
    def link_motion(self, link: int, q: FloatArray, qd: FloatArray, qdd: FloatArray, qddd: FloatArray) -> Motion:
        """Motion of link frame number `link` in the world for joint motion (..., n), K12. NaN where it is not finite.

        Raises `FaultError` for a link that does not exist.
        """
        if link not in range(len(LINKS)):
            raise FaultError(f"Scara.link_motion: link {link}")
        motion = Motion.still(self.base, q.shape[:-1])
        if link == BASE:
            return motion
        joints = (q, qd, qdd, qddd)
        first = [x[..., 0] for x in joints]
        first[0] = first[0] + self.base.yaw
        second = [phi + x[..., 1] for phi, x in zip(first, joints, strict=True)]
        if link >= LINK2:
            add_arm(motion, self.l1, *first)
        if link >= QUILL:
            add_arm(motion, self.l2, *second)
        if link >= self.lowest_lifted:
            for row, x in zip((motion.p, motion.v, motion.a, motion.j), joints, strict=True):
                row[..., 2] += x[..., 2]
        angle = first if link == LINK1 else second
        if link == QUILL:
            angle = [np.zeros(q.shape[:-1]) for _ in joints]
        elif link == FLANGE and self.axes == 4:
            angle = [phi + x[..., 3] for phi, x in zip(second, joints, strict=True)]
        return Motion(motion.p, motion.v, motion.a, motion.j, angle[0], angle[1], angle[2], angle[3])

    @np.errstate(all="ignore")
    def jacobian(self, q: FloatArray) -> FloatArray:
        """(..., len(coordinates), n): rates of x, y, z (and yaw) in the world per joint rate, K11."""
        phi1 = q[..., 0] + self.base.yaw
        phi2 = phi1 + q[..., 1]
        jacobian = np.zeros((*q.shape[:-1], self.axes, self.axes))
        jacobian[..., 0, 1] = -self.l2 * np.sin(phi2)
        jacobian[..., 1, 1] = self.l2 * np.cos(phi2)
        jacobian[..., 0, 0] = jacobian[..., 0, 1] - self.l1 * np.sin(phi1)
        jacobian[..., 1, 0] = jacobian[..., 1, 1] + self.l1 * np.cos(phi1)
        jacobian[..., 2, 2] = 1.0
        if self.axes == 4:
            jacobian[..., 3, [0, 1, 3]] = 1.0
        return jacobian

    @np.errstate(all="ignore")
    def margin(self, q: FloatArray) -> FloatArray:
        """|sin θ2| (...), from 0 (stretched or folded) to 1."""
        return np.abs(np.sin(q[..., 1]))

    @np.errstate(all="ignore")
    def singularity(self, q: FloatArray) -> IntArray:
        """STRETCHED (...) while the elbow is nearer to stretched than to folded, else FOLDED."""
        return elbow_singularity(self.l1, self.l2, q[..., 1])[1]

    @np.errstate(all="ignore")
    def singular_distance(self, q: FloatArray) -> FloatArray:
        """Metres (...) that the flange may move along its radius until the arm is stretched or folded, K16."""
        return elbow_singularity(self.l1, self.l2, q[..., 1])[2]

    @np.errstate(all="ignore")
    def mode_of(self, q: FloatArray) -> IntArray:
        """Working mode number (...) of q: 1 (right) where sin θ2 > 0, else 0 (left); −1 where θ2 is not finite."""
        sine = np.sin(q[..., 1])
        return np.where(sine > 0.0, 1, np.where(sine <= 0.0, 0, -1))

    def within(self, q: FloatArray) -> BoolArray:
        """Whether q (..., n) keeps the position limits, (...); NaN does not."""
        return self.limits.holds(q)

    @np.errstate(all="ignore")
    def point_bounds(
        self, link: IntArray, reach: FloatArray, _distance: FloatArray, n: FloatArray, sweep: Sweep, /
    ) -> tuple[FloatArray, FloatArray]:
        """Upper bounds (N,) of |n·ẋ| and |n·ẍ| over N intervals for the points of a link (`planar.arm_bounds`).

        The arms of a point are l1 and l2 as far as its link is beyond them, and its distance r <= `reach` from the
        link frame's axis; the quill frame does not turn, so there r does not count. As no link tilts, the distance from
        its origin is not looked at. Rows with NaN, or a negative reach, are bounded by inf. Raises `FaultError` for a
        link that does not exist.
        """
        if not ((link >= 0) & (link < len(LINKS))).all():
            raise FaultError("Scara.point_bounds: no such link")
        arms = np.where(reach >= 0, reach, np.nan)[:, None] * _SPIN[link]
        arms[:, 0] += self.l1 * (link >= LINK2)
        arms[:, 1] += self.l2 * (link >= QUILL)
        turn, turn_d, rides = sweep.rate[:, [0, 1, 3]], sweep.rate_d[:, [0, 1, 3]], link >= self.lowest_lifted
        return arm_bounds(n, arms, turn, turn_d, rides * sweep.rate[:, 2], rides * sweep.rate_d[:, 2])
