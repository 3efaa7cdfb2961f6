"""What every robot answers, whatever its family, from the row of numbers that its family gives it.

Planner, certificate and checker know no more of a robot than this.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.errors import FaultError
from assur.planner.frames.motion import Motion, Pose
from assur.planner.frames.sweep import Sweep
from assur.planner.frames.tilted import TiltedMotion
from assur.planner.robots.chain import Chain, Rows
from assur.planner.robots.facts import Inverse, Joint, Limits, RobotBody


class Robot(ABC):
    """A robot arm with n joints and L link frames; a family gives the facts below. World frame everywhere."""

    name: str
    joints: tuple[Joint, ...]
    limits: Limits
    base: Pose
    coordinates: tuple[str, ...]
    """Task coordinates it can follow, out of x, y, z, yaw, pitch, roll (a three-axis SCARA has no yaw of its own; pitch
    and roll come together, and the flange of such an arm moves as a `TiltedMotion`)."""
    modes: tuple[str, ...]
    """Working modes; for a SCARA ("left", "right")."""
    links: tuple[str, ...]
    """Names of the link frames, on which bodies are. "flange" is one of them: it carries tool and part."""
    bodies: tuple[RobotBody, ...]
    self_pairs: tuple[tuple[str, str], ...]
    """Names of links between which self-collision is asked: bodies on the one against bodies on the other."""
    lift: int | None
    """The joint that moves the flange along the vertical and does nothing else, if there is one."""
    dyads: int = 0
    """How many dyads in a horizontal plane carry the flange; 0: its links move otherwise."""
    parallel_least: float
    """The parallel margin below which the arm may never be; 0 without a loop."""

    @property
    @abstractmethod
    def facts(self) -> tuple[str, tuple[float, ...], dict[str, float]]:
        """The family's name in `assur.planner.robots.kinematics`, lengths of links, m, what else its kernels read."""

    @property
    @abstractmethod
    def chain(self) -> Chain:
        """The same links as a tree."""

    @cached_property
    def tilting(self) -> frozenset[int]:
        """Numbers of the links that do not stay upright: their attitude is more than the yaw of their motion."""
        return frozenset(number for number, link in enumerate(self.chain.links) if link.tilts is not None)

    @abstractmethod
    def reach_margin(self, flange: Motion, mode: int) -> FloatArray:
        """Metres (...) between poses of the flange (world) and the edge of what the links reach in working mode number
        `mode`, with the pitch of the motion; negative: so far out of reach (K45).

        Of the ranges that of a joint which makes a link longer counts; a height that no joint changes does not count.
        """

    @cached_property
    def row(self) -> FloatArray:
        """The arm as the kernels know it (columns of `assur.planner.kernels.links`); not to be written to."""
        from assur.planner.robots.kinematics import row_of

        return row_of(self)

    @cached_property
    def chain_rows(self) -> Rows:
        """`chain` as rows; not to be written to. Raises `FaultError` if the chain has other links."""
        names = tuple(link.name for link in self.chain.links)
        if names != self.links:
            raise FaultError(f"the links of {self.name}: {names}")
        return self.chain.rows(self.base.yaw)

    @property
    def turns_load(self) -> bool:
        """Whether the last joint turns the flange, and what it carries, about the vertical."""
        return "yaw" in self.coordinates and "pitch" not in self.coordinates

    @cached_property
    def sums_yaw(self) -> bool:
        """Whether it has a wrist, and the yaw of its flange is the sum of the joints that turn, but for that of its
        base."""
        return self.turns_load and self.chain.loop is None

    @cached_property
    def revolute(self) -> FloatArray:
        """1 for joints (n,) that turn, 0 for those that slide; not to be written to."""
        return np.array([float(joint.kind == "revolute") for joint in self.joints])

    def inverse(self, flange: Motion, mode: int, order: int = 3) -> Inverse:
        """Joint motion that gives the flange this motion (world) in working mode number `mode`: K10, K23 to K25, K35.

        Derivatives above `order` are not computed and NaN. An arm without a wrist does not read the yaw; a flange that
        pitches and rolls moves as a `TiltedMotion`. Rows that are not ASSEMBLED: see `Inverse`; a row that is not
        finite in what is read is OUT_OF_REACH. Revolute joints are in (−π, π]. Not checked: joint limits (`within`).
        Raises `FaultError` for a mode or an order that there is not, and for a motion without pitch and roll.
        """
        from assur.planner.robots.kinematics import inverse

        if mode not in range(len(self.modes)) or order not in range(4):
            raise FaultError(f"{type(self).__name__}.inverse: mode {mode}, order {order}")
        if "pitch" in self.coordinates and not isinstance(flange, TiltedMotion):
            raise FaultError(f"{type(self).__name__}.inverse: a motion without pitch and roll")
        return inverse(self, flange, mode, order)

    def forward(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Flange position (..., 3) and yaw (...) in the world for q (..., n), the heading of a flange that tilts; NaN
        where q is not finite or does not assemble."""
        from assur.planner.robots.kinematics import moved

        found = moved(self, len(self.links) - 1, q)
        return found[..., 0, :3].copy(), found[..., 0, 3].copy()

    def link_motion(self, link: int, q: FloatArray, qd: FloatArray, qdd: FloatArray, qddd: FloatArray) -> Motion:
        """Motion of link frame number `link` in the world for joint motion (..., n), K12, K23; a `TiltedMotion` if it
        is a flange that pitches and rolls. NaN where the joint motion is not finite or does not assemble.

        Raises `FaultError` for a link that does not exist.
        """
        from assur.planner.robots.kinematics import motion_of, moved

        if link not in range(len(self.links)):
            raise FaultError(f"{type(self).__name__}.link_motion: link {link}")
        tilted = "pitch" in self.coordinates and link == len(self.links) - 1
        return motion_of(moved(self, link, q, qd, qdd, qddd), tilted)

    def placements(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Link frames in the world for q (..., n): positions (..., L, 3) and rotations (..., L, 3, 3), K9, K31, K34."""
        from assur.planner.robots.kinematics import placements

        return placements(self, q)

    def sweep(self, joints: FloatArray, link: int) -> Sweep:
        """How link number `link` moves while the joints are as their jets (n, 6) say (K43)."""
        from assur.planner.robots.kinematics import sweep

        return sweep(self, joints, link)

    def _posture(self, q: FloatArray) -> FloatArray:
        from assur.planner.robots.kinematics import postures

        return postures(self, q)

    def singularity(self, q: FloatArray) -> IntArray:
        """Which singularity (...) the margin is measured to, as a `Code`: STRETCHED or FOLDED, whichever is nearer, or
        ALIGNED where the base axis counts most. Of a posture that is not known: OUT_OF_REACH."""
        code = self._posture(q)[..., 0]
        return np.where(np.isnan(code), 1, code).astype(np.int64)

    def singular_distance(self, q: FloatArray) -> FloatArray:
        """Metres (...) that the flange may move until the arm is singular (K16, K30)."""
        return np.asarray(self._posture(q)[..., 1])

    def mode_of(self, q: FloatArray) -> IntArray:
        """Working mode number (...) of q (..., n); −1 where it is not finite or does not assemble."""
        return np.asarray(self._posture(q)[..., 2].astype(np.int64))

    def margin(self, q: FloatArray) -> FloatArray:
        """Singularity margin (...), from 0 (singular) to 1: the lesser |sin| of the elbows, or the share of the
        reach by which the flange is off the base axis."""
        return np.asarray(self._posture(q)[..., 3])

    def parallel_margin(self, q: FloatArray) -> FloatArray:
        """Margin (...) to a type 2 singularity (K33), from 0 to 1; NaN where q does not assemble. Without a loop: 1."""
        if not self.parallel_least > 0.0:
            return np.ones(q.shape[:-1])
        return np.asarray(self._posture(q)[..., 4])

    def assembled(self, lower: FloatArray, upper: FloatArray) -> BoolArray:
        """Whether (N,) the arm is proved to assemble with `parallel_least` for lower <= q <= upper (N, n), K39; without
        a loop always."""
        from assur.planner.robots.kinematics import assembled

        return assembled(self, lower, upper) if self.parallel_least > 0.0 else np.ones(len(lower), dtype=bool)

    def within(self, q: FloatArray) -> BoolArray:
        """Whether q (..., n) keeps the position limits and assembles with `parallel_least`, (...); NaN does not."""
        kept = self.limits.holds(q)
        if not self.parallel_least > 0.0:
            return kept
        flat = q.reshape(-1, q.shape[-1])
        return np.asarray(kept & self.assembled(flat, flat).reshape(q.shape[:-1]))
