"""The five-bar or parallel SCARA: two cranks turned by motors at the base, two couplers, a tool axis where they meet.

q = [θ1, θ5], [θ1, θ5, z] or [θ1, θ5, z, θ4]: the left and the right crank's angles from the base's x axis, which points
to the front, z the height of the flange above the base origin (without it the flange is at that height), θ4 the angle
of the flange from the left coupler, on which the quill rides. Absolute angles are

    φ1 = ψ + θ1    φ5 = ψ + θ5    φ2 = ∠u    φ3 = ∠(−w)    φ4 = φ2 + θ4  (φ2 without a wrist)             (K34)

with u, w of `assur.planner.robots.loop`. The inverse is two RRR dyads, one from each crank axis to the tool axis: four
working modes. The direct problem is one dyad between the elbows: two assembly modes, of which a robot has one for good.
Type 1 (serial) singularities, a crank in line with its coupler, may be crossed by joint legs; type 2 may not be neared.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray, frozen
from assur.planner.assur.rrr import LEFT, RIGHT, RRR, Assembly
from assur.planner.errors import FaultError, InputError
from assur.planner.frames.motion import Motion, Pose
from assur.planner.robots.five_bar_jacobian import jacobian
from assur.planner.robots.five_bar_links import (
    BASE,
    DISTAL_RIGHT,
    LINKS,
    PROXIMAL_LEFT,
    PROXIMAL_RIGHT,
    QUILL,
    placements,
    point_bounds,
)
from assur.planner.robots.loop import ASSEMBLIES, Loop
from assur.planner.robots.planar import add_arm, elbow_singularity
from assur.planner.robots.protocol import Inverse, Joint, Limits, RobotBody, Sweep
from assur.planner.robots.riders import check_riders, joints_of
from assur.planner.robots.two_dyads import Sides, merged

MODES = ("left-left", "left-right", "right-left", "right-right")
"""Where the left arm's elbow is, and where the right one's: to the left or the right of the line from crank axis to
tool axis, seen from the crank axis. The usual mode, elbows outwards, is left-right."""
SIGMA = ((LEFT, LEFT), (LEFT, RIGHT), (RIGHT, LEFT), (RIGHT, RIGHT))

PARALLEL_LEAST = 0.1
"""Least parallel margin, |sin| of the angle between the couplers (no unit): at 0.1, 5.7°, a torque of the motors or
a play in a joint acts ten times as strong along the tool's worst direction as at a right angle."""


@dataclass(frozen=True, eq=False)
class FiveBar:
    """A five-bar arm; implements `assur.planner.robots.protocol.Robot`.

    Link frames: `base` at the base origin, midway between the crank axes; `proximal-left` and `proximal-right` at the
    crank axes, turned by φ1 and φ5; `distal-left` and `distal-right` at the elbows, turned by φ2 and φ3, all at the
    height of the base origin; `quill` at the flange, never turned, for solids of revolution; `flange` turned by φ4.

    Arguments: `name`; `separation` of the crank axes, `proximal` and `distal` lengths (left, right), m; `axes` 2, 3
    or 4; `limits` in the order of q; `base` in the world; `bodies` on links by number; `self_pairs` of link names;
    `joint_names`; `assembly` out of `ASSEMBLIES`; `parallel_least`. Raises `InputError` for what is not one.
    Not checked: that bodies of neighbouring links do not overlap.
    """

    name: str
    separation: float
    proximal: tuple[float, float]
    distal: tuple[float, float]
    axes: int
    limits: Limits
    base: Pose = field(default_factory=Pose)
    bodies: tuple[RobotBody, ...] = ()
    self_pairs: tuple[tuple[str, str], ...] = ()
    joint_names: tuple[str, ...] = ()
    assembly: str = "front"
    parallel_least: float = PARALLEL_LEAST
    modes: tuple[str, ...] = field(default=MODES, init=False, repr=False)
    links: tuple[str, ...] = field(default=LINKS, init=False, repr=False)
    tilting: frozenset[int] = field(default=frozenset(), init=False, repr=False)
    joints: tuple[Joint, ...] = field(init=False, repr=False)
    loop: Loop = field(init=False, repr=False)
    sides: Sides = field(init=False, repr=False)
    rate_matrix: FloatArray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if self.axes not in (2, 3, 4):
            raise InputError("robot.axes", self.axes, "2, 3 or 4")
        if self.assembly not in ASSEMBLIES:
            raise InputError("robot.assembly", self.assembly, f"one of {ASSEMBLIES}")
        if not 0.0 < self.parallel_least < 1.0:
            raise InputError("robot.parallel_least", self.parallel_least, "a number between 0 and 1")
        if not 0.0 <= self.separation < sum(self.proximal) + sum(self.distal):
            raise InputError("robot.separation", self.separation, "a distance that the links can span, m")
        names = self.joint_names or ("theta1", "theta5", "z", "theta4")[: self.axes]
        kinds = ("revolute", "revolute", "prismatic", "revolute")[: self.axes]
        check_riders(LINKS, self.bodies, self.self_pairs)
        dyads = (RRR(self.proximal[0], self.distal[0]), RRR(self.proximal[1], self.distal[1]))
        sigma = LEFT if self.assembly == "front" else RIGHT
        for key, value in (
            ("joint_names", names),
            ("joints", joints_of(names, kinds, self.limits)),
            ("loop", Loop(self.separation, self.proximal, self.distal, sigma)),
            ("sides", Sides(self.separation, dyads)),
            ("rate_matrix", frozen(np.eye(4)[:, : self.axes], (4, self.axes), "rate_matrix")),
        ):
            object.__setattr__(self, key, value)

    @property
    def coordinates(self) -> tuple[str, ...]:
        return ("x", "y", "z", "yaw")[: self.axes]

    @property
    def lift(self) -> int | None:
        return 2 if self.axes > 2 else None

    @np.errstate(all="ignore")
    def inverse(self, flange: Motion, mode: int, order: int = 3) -> Inverse:
        """Joint motion that gives the flange this motion (world), in working mode `mode` out of `MODES`, K35.

        Derivatives above `order` are not computed and NaN. Without a wrist the yaw is not looked at; without a quill
        the flange must stay at the height of the base origin. A row in the other assembly mode, or with a parallel
        margin below `parallel_least`, is PARALLEL: it has a position, and is not to be followed.
        Not checked: joint limits (`within`).
        """
        if mode not in range(4) or order not in range(4):
            raise FaultError(f"FiveBar.inverse: mode {mode}, order {order}")
        return merged(self.base, self.axes, self.loop, self.sides, SIGMA[mode], flange, order, self.parallel_least)

    @np.errstate(all="ignore")
    def forward(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Flange position (..., 3) and yaw (...) in the world for q (..., n); NaN where q does not assemble."""
        found = self._assembled(q)
        c, s = np.cos(self.base.yaw), np.sin(self.base.yaw)
        x = self.proximal[0] * np.cos(q[..., 0]) + found.u[0]
        y = self.proximal[0] * np.sin(q[..., 0]) + found.u[1] + self.separation / 2
        p = np.empty((*q.shape[:-1], 3))
        p[..., 0], p[..., 1] = self.base.x + c * x - s * y, self.base.y + s * x + c * y
        p[..., 2] = self.base.z + (q[..., 2] if self.axes > 2 else 0.0)
        yaw = self.base.yaw + np.arctan2(found.u[1], found.u[0])
        return p, yaw + q[..., 3] if self.axes == 4 else yaw

    @np.errstate(all="ignore")
    def placements(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Link frames in the world for q (..., n): positions (..., 7, 3) and rotations (..., 7, 3, 3), K34."""
        return placements(self.base, self.loop, self.axes, q)

    @np.errstate(all="ignore")
    def link_motion(self, link: int, q: FloatArray, qd: FloatArray, qdd: FloatArray, qddd: FloatArray) -> Motion:
        """Motion of link frame number `link` in the world for joint motion (..., n), K12. NaN where it is not finite.

        Raises `FaultError` for a link that does not exist.
        """
        if link not in range(len(LINKS)):
            raise FaultError(f"FiveBar.link_motion: link {link}")
        joints, base, shape = (q, qd, qdd, qddd), self.base, q.shape[:-1]
        if link == BASE:
            return Motion.still(base, shape)
        right = link in (PROXIMAL_RIGHT, DISTAL_RIGHT)
        motion = Motion.still(base.then(Pose(y=-self.separation / 2 if right else self.separation / 2)), shape)
        cranks = [tuple(x[..., k] for x in joints) for k in (0, 1)]
        crank = [cranks[right][0] + base.yaw, *cranks[right][1:]]
        if link in (PROXIMAL_LEFT, PROXIMAL_RIGHT):
            return Motion(motion.p, motion.v, motion.a, motion.j, crank[0], crank[1], crank[2], crank[3])
        add_arm(motion, self.proximal[right], *crank)
        found = self.loop.assembled(cranks[0], cranks[1])
        x, y = (-found.w[0], -found.w[1]) if right else found.u
        angle = [base.yaw + np.arctan2(y, x), *(pair[right] for pair in found.rates)]
        if link >= QUILL:
            add_arm(motion, self.distal[0], *angle)
            if self.axes > 2:
                for row, each in zip((motion.p, motion.v, motion.a, motion.j), joints, strict=True):
                    row[..., 2] += each[..., 2]
            if link == QUILL:
                angle = [np.zeros(shape) for _ in joints]
            elif self.axes == 4:
                angle = [phi + each[..., 3] for phi, each in zip(angle, joints, strict=True)]
        return Motion(motion.p, motion.v, motion.a, motion.j, angle[0], angle[1], angle[2], angle[3])

    def jacobian(self, q: FloatArray) -> FloatArray:
        """(..., len(coordinates), n): rates of x, y (z, yaw) in the world per joint rate, K36; infinite at type 2."""
        return jacobian(self.base, self.loop, self.axes, q)

    @np.errstate(all="ignore")
    def margin(self, q: FloatArray) -> FloatArray:
        """Serial margin (...): the lesser |sin| of the angles between crank and coupler, left and right."""
        left, right = self._sides(q)
        return np.asarray(np.minimum(left[0], right[0]))

    @np.errstate(all="ignore")
    def parallel_margin(self, q: FloatArray) -> FloatArray:
        """|sin| of the angle between the couplers (...); NaN where q does not assemble (K33)."""
        return self._assembled(q).margin

    @np.errstate(all="ignore")
    def singular_distance(self, q: FloatArray) -> FloatArray:
        """Metres (...) that the tool axis may move along either radius until that arm is singular (type 1), K16."""
        left, right = self._sides(q)
        return np.asarray(np.minimum(left[2], right[2]))

    @np.errstate(all="ignore")
    def singularity(self, q: FloatArray) -> IntArray:
        """Which type 1 singularity (...) is nearer, of the side with the lesser margin: STRETCHED or FOLDED."""
        left, right = self._sides(q)
        return np.where(left[0] <= right[0], left[1], right[1])

    @np.errstate(all="ignore")
    def mode_of(self, q: FloatArray) -> IntArray:
        """Working mode number (...) of q in `MODES`; −1 where it does not assemble."""
        left, right = (np.sin(elbow) for elbow in self._elbows(q))
        return np.where(np.isnan(left + right), -1, 2 * (left > 0.0) + (right > 0.0))

    def within(self, q: FloatArray) -> BoolArray:
        """Whether q (..., n) keeps the position limits and assembles with `parallel_least`, (...); NaN does not."""
        kept = self.limits.holds(q)
        flat = q.reshape(-1, q.shape[-1])
        return np.asarray(kept & self.assembled(flat, flat).reshape(q.shape[:-1]))

    @np.errstate(all="ignore")
    def assembled(self, lower: FloatArray, upper: FloatArray) -> BoolArray:
        """Whether (N,) the arm is proved to assemble with `parallel_least` for lower <= q <= upper (N, n), K39."""
        return self.loop.keeps(lower[:, :2], upper[:, :2], self.parallel_least)

    def point_bounds(
        self, link: IntArray, reach: FloatArray, _distance: FloatArray, n: FloatArray, sweep: Sweep, /
    ) -> tuple[FloatArray, FloatArray]:
        """Upper bounds (N,) of |n·ẋ| and |n·ẍ| over N intervals for the points of a link, K40 to K42.

        Infinite where it is not proved that the chain assembles throughout, but for links and directions to which the
        couplers' motion does not matter. Raises `FaultError` for a link that does not exist.
        """
        if not ((link >= 0) & (link < len(LINKS))).all():
            raise FaultError("FiveBar.point_bounds: no such link")
        return point_bounds(self.loop, link, reach, n, sweep)

    def _assembled(self, q: FloatArray) -> Assembly:
        return self.loop.assembled((q[..., 0],), (q[..., 1],))

    def _elbows(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Angles (...) of the couplers from their cranks, left and right."""
        found = self._assembled(q)
        u, w = found.u, found.w
        return np.arctan2(u[1], u[0]) - q[..., 0], np.arctan2(-w[1], -w[0]) - q[..., 1]

    def _sides(self, q: FloatArray) -> tuple[tuple[FloatArray, IntArray, FloatArray], ...]:
        """What `elbow_singularity` says of the left and of the right arm."""
        sides = zip(self.proximal, self.distal, self._elbows(q), strict=True)
        return tuple(elbow_singularity(a, b, bend) for a, b, bend in sides)
