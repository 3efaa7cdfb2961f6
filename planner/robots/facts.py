"""Facts of a robot, whatever its family: joints and their limits, bodies on links, joint motion for a flange motion.

`q` is in radians and metres in the order of the joints; the maker's names, units, signs and zeros live at the border.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray, every, frozen
from assur.planner.claim import columns as c
from assur.planner.errors import FaultError, InputError
from assur.planner.geometry.shapes import LARGEST_M, SMALLEST_M, Body, Piece, Primitive

# How an inverse solution came out.


class Code(IntEnum):
    """How an inverse solution came out, one per row of a batch (docs/kinematics.md, table of cases).

    ASSEMBLED is the only one that may be followed. OUT_OF_REACH also answers input that is not finite (NaN or
    infinity in a position or in a derivative that is required): what cannot be answered is refused.
    """

    ASSEMBLED = 0
    OUT_OF_REACH = 1
    STRETCHED = 2
    FOLDED = 3
    INDETERMINATE = 4
    ALIGNED = 5
    """Inside the workspace: the tool point is on the axis of the base, whose angle may be any."""
    PARALLEL = 6
    """Of closed chains: nearer to a type 2 singularity than the robot may be, or beyond it, in the other assembly."""


__all__ = ["Code", "Inverse", "Joint", "Limits", "RobotBody", "lowered"]


RANGE_SLACK = 1e-10
"""Share of a joint's range by which a position may be beyond its end: rounding of inverse kinematics is 1e-15, and a
tenth of what the limits of a trajectory are checked to."""


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint: its name and whether it is `revolute` (rad) or `prismatic` (m)."""

    name: str
    kind: str


@dataclass(frozen=True, eq=False)
class Limits:
    """Joint limits, each (n,), SI: `lower <= q <= upper`, `|q̇| <= velocity`, `|q̈| <= acceleration`, `|q⃛| <= jerk`."""

    lower: FloatArray
    upper: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    jerk: FloatArray

    def __post_init__(self) -> None:
        n = len(self.lower)
        for name in ("lower", "upper", "velocity", "acceleration", "jerk"):
            object.__setattr__(self, name, frozen(getattr(self, name), (n,), f"limits.{name}"))
        if not (self.lower < self.upper).all():
            raise InputError("limits.lower", self.lower.tolist(), f"below limits.upper {self.upper.tolist()}")
        for name in ("velocity", "acceleration", "jerk"):
            if not (getattr(self, name) > 0).all():
                raise InputError(f"limits.{name}", getattr(self, name).tolist(), "positive numbers")

    @cached_property
    def slack(self) -> FloatArray:
        """By how much (n,) a position may be beyond its limit: rounding, for points exactly at the end of a range."""
        return np.asarray(RANGE_SLACK * (self.upper - self.lower))

    @cached_property
    def within(self) -> FloatArray:
        """The least and the greatest position that are accepted, (2, n), `slack` included; not to be written to."""
        return np.array([self.lower - self.slack, self.upper + self.slack])

    @cached_property
    def table(self) -> FloatArray:
        """All limits (5, n) as kernels take them (rows of `assur.planner.kernels.candidates`); not to be written to."""
        return np.array([self.lower, self.upper, self.velocity, self.acceleration, self.jerk])

    def holds(self, q: FloatArray) -> BoolArray:
        """Whether q (..., n) keeps the position limits up to `slack`, (...); NaN does not."""
        return every((self.within[0] <= q) & (q <= self.within[1]))


@lru_cache(maxsize=64)
def lowered(limits: Limits, share: float) -> Limits:
    """The limits with `share`, in (0, 1], of the accelerations and jerks; with 1 the limits themselves."""
    if share == 1.0:
        return limits
    rates = limits.velocity, share * limits.acceleration, share * limits.jerk
    return Limits(limits.lower, limits.upper, *rates)


@dataclass(frozen=True, slots=True)
class Inverse:
    """Joint motion for a flange motion of shape (...): `q, qd, qdd, qddd` (..., n), `code` (...), `margin` (...).

    Rows whose code is not ASSEMBLED hold NaN in what is not defined: a stretched or folded arm has a position (q)
    but no derivatives, an arm over its base axis (ALIGNED) all but the base angle, an arm out of reach has nothing.
    `margin` is |sin θ2| for a dyad (NaN out of reach), the lesser one of two.
    Revolute joints are principal values; `turns` of the caller add full turns.

    `parallel` (...) is the margin to a type 2 singularity of a closed chain, where actuators hold the tool no longer:
    from 1 over 0 (singular) to -1, negative in the other assembly mode. None: the robot has no loop.
    """

    q: FloatArray
    qd: FloatArray
    qdd: FloatArray
    qddd: FloatArray
    code: IntArray
    margin: FloatArray
    parallel: FloatArray | None = None

    def keeps(self, least: float) -> BoolArray:
        """Rows (...) whose margins are both `least` at least."""
        enough = self.margin >= least
        return np.asarray(enough if self.parallel is None else enough & (self.parallel >= least))


@dataclass(frozen=True, eq=False)
class RobotBody:
    """A body that rides on link number `link` of the robot, its frame being the link's."""

    body: Body
    link: int


# Angles, lengths and reach of the links of an arm, and which bodies on them look the same at any yaw.

TURN = 2.0 * math.pi
"""A full turn, rad."""
AXIS_SLACK = 1e-9
"""How far a solid of revolution may be off its body's z axis, m or rad: rounding of a pose, far below any clearance."""


def principal(angle: FloatArray) -> FloatArray:
    """The angle in (−π, π], rad; what is there keeps its bits, but −π and what rounds to it becomes π."""
    wrapped: FloatArray = angle - TURN * np.ceil((angle - math.pi) / TURN)
    return wrapped


def ring_margin(distance: FloatArray, l1: float, l2: float) -> FloatArray:
    """Metres (...) from a point at a distance (...) from where the first of two links turns to the edge of the ring
    that they reach; negative: so far out of reach (K45)."""
    margin: FloatArray = np.minimum(l1 + l2 - distance, distance - abs(l1 - l2))
    return margin


def upright(piece: Piece) -> bool:
    """Whether a solid is one of revolution about its body's z axis, so that it looks the same at any yaw."""
    shape = piece.shape
    if not (isinstance(shape, Primitive) and shape.half[0] == shape.half[1] == 0.0):
        return False
    centred = np.hypot(piece.position[0], piece.position[1]) <= AXIS_SLACK
    is_ball = shape.half[2] == shape.disc == 0.0
    return bool(centred and (is_ball or np.hypot(piece.rotation[0, 2], piece.rotation[1, 2]) <= AXIS_SLACK))


def check_lengths(**lengths: float) -> None:
    """Raises `InputError` for a link that is not from 10 µm to 50 m long, naming it."""
    for name, length in lengths.items():
        if not SMALLEST_M <= length <= LARGEST_M:
            raise InputError(name, length, f"a length from {SMALLEST_M} to {LARGEST_M} m")


# An arm as a tree of links whose angles are sums of joint values, and as rows of numbers, whatever its family.

AHEAD, LEFT, UP = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
"""Axes of a link."""
Vector = tuple[float, float, float]


class Link(NamedTuple):
    """A link frame. Its origin is at `offset` (m, in the axes of the link number `parent`; -1: the world), moved by the
    joint of `slide` along an axis of the parent. Its yaw is the sum of the joints `turns`, counted from the yaw of the
    base, from the coupler number `coupler`, or (`fixed`) from the world's x axis. A link that tilts is then pitched by
    the sum of the joints `tilts` (up is positive) and rolled about its x axis by that of `rolls`; None: it stays
    upright."""

    parent: int
    offset: Vector = (0.0, 0.0, 0.0)
    turns: tuple[int, ...] = ()
    tilts: tuple[int, ...] | None = None
    rolls: tuple[int, ...] = ()
    slide: tuple[int, Vector] | None = None
    coupler: int = -1
    fixed: bool = False


class Loop(NamedTuple):
    """Two couplers that close a chain. Both cranks turn about axes that the base has. The couplers begin at the ends of
    both `cranks` (numbers of links, of these `lengths`, m) and meet at their own lengths `couplers`, m, on the side
    `side` of the line from the first end to the second (1: to the left, seen from above). The sine of the angle between
    them is `least` at least."""

    cranks: tuple[int, int]
    lengths: tuple[float, float]
    couplers: tuple[float, float]
    side: float
    least: float


class Bend(NamedTuple):
    """A number that is 0 in a singular position and whose sign tells working modes apart: the x axis of link number
    `link` (or, for a `length` that is not 0, m, the way to its origin from that of link `other`, divided by the length)
    times the axis `along` of link `other`."""

    link: int
    other: int
    along: Vector
    length: float = 0.0


NO_SLIDE = (-1.0, 0.0, 0.0, 0.0)


class Rows(NamedTuple):
    """A chain as rows of the tables `links`, `angles` and `loops` of a claim, numbered from 0. `apart` (2,): from the
    axis of the loop's first crank to that of its second one, m, horizontally in the world."""

    links: FloatArray
    angles: FloatArray
    loops: FloatArray
    apart: FloatArray


class Chain(NamedTuple):
    """All links of an arm, each behind its parent and behind the cranks of its coupler; and its loop, if it has one.

    The singularity margin is the least size of the `bends`; `signs` are theirs in each working mode, in their order.
    """

    links: tuple[Link, ...]
    bends: tuple[Bend, ...]
    signs: tuple[tuple[int, ...], ...]
    loop: Loop | None = None

    def rows(self, yaw: float) -> Rows:
        """The rows of an arm with this yaw of its base, and `c.MOST_JOINTS` joints at most. Raises `FaultError` for a
        loop whose cranks turn about axes of another link than the base."""
        links, loops, apart = list[tuple[float, ...]](), list[tuple[float, ...]](), np.zeros(2)
        known = dict[tuple[float, ...], int]()

        def angle(constant: float, joints: tuple[int, ...]) -> int:
            key = (constant, *(float(joint in joints) for joint in range(c.MOST_JOINTS)))
            return known.setdefault(key, len(known))

        for link in self.links:
            counted = angle(0.0 if link.fixed or link.coupler >= 0 else yaw, link.turns)
            tilts = (-1, -1) if link.tilts is None else (angle(0.0, link.tilts), angle(0.0, link.rolls))
            slide = NO_SLIDE if link.slide is None else (link.slide[0], *link.slide[1])
            links.append((link.parent, *link.offset, *slide, counted, *tilts, link.coupler))
        made = np.array(links)
        if self.loop is not None:
            one, other = (self.links[crank] for crank in self.loop.cranks)
            if not one.parent == other.parent == 0:
                raise FaultError(f"a loop whose cranks turn on links {one.parent} and {other.parent}")
            x, y = (b - a for a, b in zip(one.offset[:2], other.offset[:2], strict=True))
            apart = np.array([math.cos(yaw) * x - math.sin(yaw) * y, math.sin(yaw) * x + math.cos(yaw) * y])
            between = known_between(known, [int(made[crank, c.LINK_YAW]) for crank in self.loop.cranks], 0)
            loops.append((*(x for part in self.loop[:3] for x in part), *self.loop[3:], between))
        return Rows(c.table("links", links), c.table("angles", list(known)), c.table("loops", loops), apart)


def known_between(known: dict[tuple[float, ...], int], yaws: list[int], start: int) -> int:
    """The row of the angle between two cranks whose yaws are these rows, added to the angles `known` of an arm, which
    begin at row `start`."""
    angles = list(known)
    one, other = (angles[yaw - start] for yaw in yaws)
    return known.setdefault(tuple(b - a for a, b in zip(one, other, strict=True)), start + len(known))
