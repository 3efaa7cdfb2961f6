"""What every robot answers, whatever its family, from the row of numbers that its family gives it.

Planner, certificate and checker know no more of a robot than this.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.errors import FaultError, InputError
from assur.planner.frames.motion import Motion, Pose, Sweep
from assur.planner.robots.facts import UP, Chain, Inverse, Joint, Limits, RobotBody, Rows, upright


@dataclass(frozen=True, eq=False, kw_only=True)
class Robot(ABC):
    """A robot arm with n joints and L link frames; a family gives the facts below. World frame everywhere.

    `limits` in the order of q; `base` in the world; `bodies` on links by number; `self_pairs`: names of links between
    which self-collision counts, bodies on the one against bodies on the other; `joint_names`: those of the family if
    none are given; `parallel_least`: the parallel margin below which the arm may never be, 0 without a loop.

    Raises `InputError` unless joint names are different and, as the limits, as many as the joints; for a body on a
    link, or a pair of links, that the arm has not; and for a body on the link `quill`, which is never turned, that
    would look different if it were. Not checked: that bodies of neighbouring links do not overlap.
    """

    family: ClassVar[str]
    """Its name in `assur.planner.robots.kinematics`."""
    names: ClassVar[tuple[str, ...]]
    """Names of the joints of an arm of the family that has all of them ..."""
    kinds: ClassVar[tuple[str, ...]]
    """... and their kinds."""
    links: ClassVar[tuple[str, ...]]
    """Names of the link frames, on which bodies are. The last, "flange", carries tool and part."""
    modes: ClassVar[tuple[str, ...]]
    """Working modes; for a SCARA ("left", "right")."""
    ways: ClassVar[tuple[str, ...]] = ("x", "y", "z", "yaw")
    """`coordinates` of an arm of the family that has all joints."""

    dyads: ClassVar[int] = 0
    """How many dyads in a horizontal plane carry the flange; 0: its links move otherwise."""

    name: str
    limits: Limits
    base: Pose = field(default_factory=Pose)
    bodies: tuple[RobotBody, ...] = ()
    self_pairs: tuple[tuple[str, str], ...] = ()
    joint_names: tuple[str, ...] = ()
    parallel_least: float = field(default=0.0, init=False, repr=False)

    def __post_init__(self) -> None:
        names = self.joint_names or self.names[: self.count]
        if not (len(names) == len(set(names)) == self.count):
            raise InputError("robot.joint_names", names, f"{self.count} different names")
        if len(self.limits.lower) != self.count:
            raise InputError("robot.limits", len(self.limits.lower), f"{self.count} joints")
        for body in self.bodies:
            where = f"robot.bodies {body.body.name}"
            if body.link not in range(len(self.links)):
                raise InputError(where, body.link, f"a link number below {len(self.links)}")
            if self.links[body.link] == "quill" and not all(upright(piece) for piece in body.body.pieces):
                raise InputError(where, "quill", "solids of revolution about the quill")
        for pair in self.self_pairs:
            if not set(pair) <= set(self.links):
                raise InputError("robot.self_pairs", pair, f"pairs out of {self.links}")

    @property
    def count(self) -> int:
        """How many joints the arm has."""
        return len(self.names)

    @cached_property
    def joints(self) -> tuple[Joint, ...]:
        """Names and kinds, in the order of q."""
        names = self.joint_names or self.names[: self.count]
        return tuple(Joint(*pair) for pair in zip(names, self.kinds[: self.count], strict=True))

    @cached_property
    def coordinates(self) -> tuple[str, ...]:
        """Task coordinates it can follow, out of x, y, z, yaw, pitch, roll (a three-axis SCARA has no yaw of its own;
        pitch and roll come together, and the motion of the flange of such an arm is tilted)."""
        return self.ways[: self.count]

    @cached_property
    def lift(self) -> int | None:
        """The joint that moves the flange along the vertical and does nothing else, if there is one."""
        slide = self.chain.links[-1].slide or self.chain.links[1].slide
        return slide[0] if slide is not None and slide[1] == UP else None

    @cached_property
    def yaw_joints(self) -> tuple[int, ...] | None:
        """The joints whose sum, added to the yaw of the base, is the yaw of the flange; None: it is no such sum, or it
        is the heading of a flange that tilts."""
        flange = self.chain.links[-1]
        return flange.turns if flange.tilts is None and flange.coupler < 0 else None

    @property
    @abstractmethod
    def lengths(self) -> tuple[float, ...]:
        """The lengths of links, m, in the order of the columns of `assur.planner.kernels.links`."""

    @property
    @abstractmethod
    def chain(self) -> Chain:
        """The links as a tree, in the order of their names."""

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
        """`chain` as rows; not to be written to."""
        return self.chain.rows(self.base.yaw)

    @cached_property
    def turns_load(self) -> bool:
        """Whether the last joint turns the flange, and what it carries, about the vertical."""
        return "yaw" in self.coordinates and "pitch" not in self.coordinates

    @cached_property
    def sums_yaw(self) -> bool:
        """Whether it has a wrist, and the yaw of its flange is a sum of joints (`yaw_joints`): a SCARA with a wrist."""
        return self.turns_load and self.yaw_joints is not None

    @cached_property
    def revolute(self) -> FloatArray:
        """1 for joints (n,) that turn, 0 for those that slide; not to be written to."""
        return np.array([float(joint.kind == "revolute") for joint in self.joints])

    def inverse(self, flange: Motion, mode: int, order: int = 3) -> Inverse:
        """Joint motion that gives the flange this motion (world) in working mode number `mode`: K10, K23 to K25, K35.

        Derivatives above `order` are not computed and NaN. An arm without a wrist does not read the yaw; a flange that
        pitches and rolls has a tilted motion. Rows that are not ASSEMBLED: see `Inverse`; a row that is not
        finite in what is read is OUT_OF_REACH. Revolute joints are in (−π, π]. Not checked: joint limits (`within`).
        Raises `FaultError` for a mode or an order that there is not, and for a motion without pitch and roll.
        """
        from assur.planner.kernels.inverse import joint_motions
        from assur.planner.kernels.motion import COORDINATES, ORDERS
        from assur.planner.robots.kinematics import targets_of

        if mode not in range(len(self.modes)) or order not in range(4):
            raise FaultError(f"{type(self).__name__}.inverse: mode {mode}, order {order}")
        if "pitch" in self.coordinates and not flange.tilted:
            raise FaultError(f"{type(self).__name__}.inverse: a motion without pitch and roll")
        shape, n = flange.table.shape[:-2], len(self.joints)
        joints, margins = np.empty((*shape, ORDERS, n)), np.empty((*shape, 2))
        codes = np.empty(shape, dtype=np.int64)
        targets, flat = targets_of(flange, order).reshape(-1, ORDERS, COORDINATES), joints.reshape(-1, ORDERS, n)
        joint_motions(self.row, mode, order, targets, flat, margins.reshape(-1, 2), codes.reshape(-1))
        q, qd, qdd, qddd = [joints[..., k, :].copy() for k in range(ORDERS)]
        parallel = margins[..., 1] if self.parallel_least > 0.0 else None
        return Inverse(q, qd, qdd, qddd, codes, margins[..., 0], parallel)

    def forward(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Flange position (..., 3) and yaw (...) in the world for q (..., n), the heading of a flange that tilts; NaN
        where q is not finite or does not assemble."""
        from assur.planner.robots.kinematics import moved

        found = moved(self, len(self.links) - 1, q)
        return found[..., 0, :3].copy(), found[..., 0, 3].copy()

    def link_motion(self, link: int, q: FloatArray, qd: FloatArray, qdd: FloatArray, qddd: FloatArray) -> Motion:
        """Motion of link frame number `link` in the world for joint motion (..., n), K12, K23; tilted if it is
        a flange that pitches and rolls. NaN where the joint motion is not finite or does not assemble.

        Raises `FaultError` for a link that does not exist.
        """
        from assur.planner.robots.kinematics import moved

        if link not in range(len(self.links)):
            raise FaultError(f"{type(self).__name__}.link_motion: link {link}")
        tilted = "pitch" in self.coordinates and link == len(self.links) - 1
        return Motion(moved(self, link, q, qd, qdd, qddd)[..., : 6 if tilted else 4])

    def placements(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Link frames in the world for q (..., n): positions (..., L, 3) and rotations (..., L, 3, 3), K9, K31, K34."""
        from assur.planner.kernels.links import POSE_COLUMNS, places_of_links

        shape = (*q.shape[:-1], len(self.links))
        placed = np.empty((*shape, POSE_COLUMNS))
        flat = np.array(q, dtype=np.float64).reshape(-1, len(self.joints))
        places_of_links(self.row, flat, placed.reshape(-1, *placed.shape[-2:]))
        return placed[..., :3].copy(), placed[..., 3:].reshape(*shape, 3, 3)

    def sweep(self, joints: FloatArray, link: int) -> Sweep:
        """How link number `link` moves while the joints are as their jets (n, 6) say (K43)."""
        from assur.planner.kernels.jets import JET_COLUMNS, JETS, sweep_links

        jets = np.zeros((len(self.links), JETS, JET_COLUMNS))
        sweep_links(self.row, joints, np.empty((len(self.chain_rows.angles), 2, JET_COLUMNS)), jets)
        return Sweep(jets[link])

    def _posture(self, q: FloatArray) -> FloatArray:
        """(..., 5): columns of `assur.planner.kernels.inverse`."""
        from assur.planner.kernels.inverse import POSTURE_COLUMNS, postures

        out = np.empty((*q.shape[:-1], POSTURE_COLUMNS))
        flat = np.array(q, dtype=np.float64).reshape(-1, len(self.joints))
        postures(self.row, flat, out.reshape(-1, POSTURE_COLUMNS))
        return out

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
        proved = np.ones(len(lower), dtype=np.bool_)
        if self.parallel_least > 0.0:
            from assur.planner.kernels.links import ranges_assembled

            ranges_assembled(self.row, np.array(lower, np.float64), np.array(upper, np.float64), proved)
        return proved

    def within(self, q: FloatArray) -> BoolArray:
        """Whether q (..., n) keeps the position limits and assembles with `parallel_least`, (...); NaN does not."""
        kept = self.limits.holds(q)
        if not self.parallel_least > 0.0:
            return kept
        flat = q.reshape(-1, q.shape[-1])
        return np.asarray(kept & self.assembled(flat, flat).reshape(q.shape[:-1]))
