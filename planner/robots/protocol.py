"""What the planner needs of a robot, whatever its family.

Everything that differs between families is behind this protocol; planner, certificate and checker know no other.
`q` is in radians and metres in the order of `joints`; the maker's names, units, signs and zeros live at the border.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol, runtime_checkable

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray, every, frozen
from assur.planner.errors import InputError
from assur.planner.frames.motion import Motion, Pose
from assur.planner.geometry.shapes import Body
from assur.planner.robots.codes import Code

__all__ = ["Code", "Inverse", "Joint", "Limits", "Pitching", "Robot", "RobotBody", "Sweep"]


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

    def keeps(self, asked: float) -> BoolArray:
        """Rows (...) whose margins are both `asked` at least."""
        enough = self.margin >= asked
        return np.asarray(enough if self.parallel is None else enough & (self.parallel >= asked))


@dataclass(frozen=True, slots=True)
class Sweep:
    """What is known of the joint motion over N intervals: joint range `lower, upper` (N, n), and upper bounds of
    |C q̇| and |C q̈| with C = `rate_matrix`: `rate, rate_d` (N, m)."""

    lower: FloatArray
    upper: FloatArray
    rate: FloatArray
    rate_d: FloatArray


@dataclass(frozen=True, eq=False)
class RobotBody:
    """A body that rides on link number `link` of the robot, its frame being the link's."""

    body: Body
    link: int


class Robot(Protocol):
    """A robot arm with n joints and L link frames. World frame everywhere, unless said."""

    @property
    def name(self) -> str: ...

    @property
    def joints(self) -> tuple[Joint, ...]: ...

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Task coordinates it can follow, out of x, y, z, yaw, pitch, roll (a three-axis SCARA has no yaw of its own;
        pitch and roll come together, and such an arm is `Pitching`)."""
        ...

    @property
    def modes(self) -> tuple[str, ...]:
        """Working modes; for a SCARA ("left", "right")."""
        ...

    @property
    def limits(self) -> Limits: ...

    @property
    def base(self) -> Pose: ...

    @property
    def links(self) -> tuple[str, ...]:
        """Names of the link frames. Bodies ride on them. "flange" is one of them: it carries tool and part."""
        ...

    @property
    def tilting(self) -> frozenset[int]:
        """Numbers of the links that do not stay upright: their attitude is more than the yaw of their Motion."""
        ...

    @property
    def bodies(self) -> tuple[RobotBody, ...]: ...

    @property
    def self_pairs(self) -> tuple[tuple[str, str], ...]:
        """Names of links between which self-collision is asked: bodies on the one against bodies on the other."""
        ...

    @property
    def row(self) -> FloatArray:
        """What the kernels know of it (`assur.planner.kernels.links`); not to be written to."""
        ...

    @property
    def revolute(self) -> FloatArray:
        """1 for joints (n,) that turn, 0 for those that slide; not to be written to."""
        ...

    @property
    def rate_matrix(self) -> FloatArray:
        """(m, n): the combinations of joint rates that bound point speeds (SCARA: q1, q1+q2, q3, q1+q2+q4)."""
        ...

    @property
    def lift(self) -> int | None:
        """The joint that moves the flange along the vertical and does nothing else, if there is one."""
        ...

    def inverse(self, flange: Motion, mode: int, order: int = 3) -> Inverse:
        """Joint motion that gives the flange this motion (world) in working mode number `mode`, up to derivative
        number `order`; those beyond are NaN."""
        ...

    def forward(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Flange position (..., 3) and yaw (...) in the world for q (..., n)."""
        ...

    def link_motion(self, link: int, q: FloatArray, qd: FloatArray, qdd: FloatArray, qddd: FloatArray) -> Motion:
        """Motion of a link frame in the world for joint motion (..., n); of a `tilting` link the yaw is its heading."""
        ...

    def placements(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Link frames in the world: positions (..., L, 3) and rotations (..., L, 3, 3)."""
        ...

    def margin(self, q: FloatArray) -> FloatArray:
        """Singularity margin (...), from 0 (singular) to 1."""
        ...

    def singularity(self, q: FloatArray) -> IntArray:
        """Which singularity (...) the margin is measured to, as a `Code`: STRETCHED at the workspace's outer edge,
        FOLDED at an inner edge, ALIGNED inside it."""
        ...

    def singular_distance(self, q: FloatArray) -> FloatArray:
        """Metres (...) by which the flange may move outwards or inwards until the arm is singular."""
        ...

    def mode_of(self, q: FloatArray) -> IntArray:
        """Working mode number (...) that q (..., n) is in."""
        ...

    @property
    def parallel_least(self) -> float:
        """The parallel margin below which the robot may never be; 0 without a loop."""
        ...

    def parallel_margin(self, q: FloatArray) -> FloatArray:
        """Margin (...) to a type 2 singularity, from 0 to 1; NaN where q does not assemble. Without a loop it is 1."""
        ...

    def assembled(self, lower: FloatArray, upper: FloatArray) -> BoolArray:
        """Whether (N,) the arm is proved to assemble for every q with lower <= q <= upper (N, n), and to have a
        parallel margin of `parallel_least`.

        A trajectory that keeps this never changes its assembly mode. False: not proved, perhaps because the range is
        wide. An arm without a loop assembles for any q, which it says of an infinite range, too.
        """
        ...

    def within(self, q: FloatArray) -> BoolArray:
        """Whether q (..., n) keeps the position limits and assembles (`assembled`), (...)."""
        ...

    def point_bounds(
        self, link: IntArray, reach: FloatArray, distance: FloatArray, n: FloatArray, sweep: Sweep, /
    ) -> tuple[FloatArray, FloatArray]:
        """Upper bounds (N,) of |n·ẋ| and |n·ẍ| over N intervals, for every point x of link number `link` (N,), along
        unit vectors `n` (N, 3). The points are within horizontal distance `reach` (N,) of the link frame's z axis (an
        upright link looks at this alone) and within `distance` (N,) of its origin (a `tilting` link looks at this)."""
        ...


@runtime_checkable
class Pitching(Protocol):
    """An arm whose hand has a pitch and a roll: its flange moves as a `TiltedMotion`, and `inverse` asks for one."""

    def out_of_reach(self, p: FloatArray) -> FloatArray:
        """Metres (...) by which tool points p (..., 3) in the world are out of reach at every pitch and roll; 0: they
        are not, joint limits left aside."""
        ...
