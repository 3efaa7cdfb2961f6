"""Facts of a robot, whatever its family: joints and their limits, bodies on links, joint motion for a flange motion.

`q` is in radians and metres in the order of the joints; the maker's names, units, signs and zeros live at the border.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray, every, frozen
from assur.planner.errors import InputError
from assur.planner.geometry.shapes import Body
from assur.planner.robots.codes import Code

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

    def keeps(self, asked: float) -> BoolArray:
        """Rows (...) whose margins are both `asked` at least."""
        enough = self.margin >= asked
        return np.asarray(enough if self.parallel is None else enough & (self.parallel >= asked))


@dataclass(frozen=True, eq=False)
class RobotBody:
    """A body that rides on link number `link` of the robot, its frame being the link's."""

    body: Body
    link: int
