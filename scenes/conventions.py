"""The joint conventions of makers, and the conversion of values to the planner's convention and back.

The planner counts a lifting joint upwards from its base origin, which is at the maker's zero. So maker's and planner's
values differ only by a sign, unless a turning joint has a zero of its own. Without such a zero, converting a trajectory
to the maker's convention and back is exact in floating point: a plan that was written and read again is the same plan,
bit by bit. With such a zero, the position is rounded once, by some 1e-16 of its value, when the plan is written; later
conversions change nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from assur.planner.arrays import FloatArray, IntArray

JointKind = Literal["revolute", "prismatic"]
SI_OF: dict[JointKind, str] = {"revolute": "rad", "prismatic": "m"}


@dataclass(frozen=True, slots=True)
class JointConvention:
    """How the maker counts a joint: planner's value = sign × maker's value + zero, in rad or m; `place`: which joint it
    is in the planner's order (None: the same). Rates have no zero."""

    name: str
    kind: JointKind
    sign: Literal[1, -1] = 1
    place: int | None = None
    zero: float = 0.0

    @property
    def unit(self) -> str:
        return SI_OF[self.kind]


Conventions = tuple[JointConvention, ...]


def places(conventions: Conventions) -> IntArray:
    """Which of the planner's joints each of the maker's is, (n,)."""
    own = [i if joint.place is None else joint.place for i, joint in enumerate(conventions)]
    return np.array(own, dtype=np.int64)


def converted(values: FloatArray, conventions: Conventions) -> FloatArray:
    """Joint positions (..., n) of the maker in the planner's order and convention."""
    # + 0.0, which a zero is as well: no negative zeros
    return _in_order(values * _signs(conventions) + _zeros(conventions), conventions)


def as_maker(values: FloatArray, conventions: Conventions) -> FloatArray:
    """Joint positions (..., n) of the planner in the maker's order and convention: what `converted` undoes, exactly
    where no joint has a zero."""
    turned: FloatArray = (values[..., places(conventions)] - _zeros(conventions)) * _signs(conventions) + 0.0
    return turned


def converted_rates(values: FloatArray, conventions: Conventions) -> FloatArray:
    """Joint rates, or differences of positions, (..., n) of the maker in the planner's order and convention."""
    return _in_order(values * _signs(conventions) + 0.0, conventions)


def rates_as_maker(values: FloatArray, conventions: Conventions) -> FloatArray:
    """Joint rates, or differences of positions, (..., n) of the planner as the maker counts; `converted_rates` undoes
    it exactly."""
    turned: FloatArray = values[..., places(conventions)] * _signs(conventions) + 0.0
    return turned


def last_joint(conventions: Conventions) -> int:
    """Which of the maker's joints is the planner's last one: the wrist, of an arm that has one."""
    return int(np.argmax(places(conventions)))


def signs(conventions: Conventions) -> tuple[float, ...]:
    """What the planner's value of each joint, in its order, is multiplied by to be the maker's."""
    return tuple(_in_order(_signs(conventions), conventions).tolist())


def zeros(conventions: Conventions) -> tuple[float, ...]:
    """The planner's value at the maker's zero of each joint, in the planner's order."""
    return tuple(_in_order(_zeros(conventions), conventions).tolist())


def _in_order(values: FloatArray, conventions: Conventions) -> FloatArray:
    """Values (..., n) in the maker's order, in the planner's."""
    found = np.empty(values.shape)
    found[..., places(conventions)] = values
    return found


def as_counted(signs: tuple[tuple[str, float], ...], conventions: Conventions) -> tuple[tuple[str, float], ...]:
    """Named signs, those of joints as the maker counts them in place of the planner's, or the other way round."""
    reversed_ = {joint.name for joint in conventions if joint.sign < 0}
    return tuple((name, -value + 0.0 if name in reversed_ else value) for name, value in signs)


def _signs(conventions: Conventions) -> FloatArray:
    return np.array([float(joint.sign) for joint in conventions])


def _zeros(conventions: Conventions) -> FloatArray:
    return np.array([joint.zero for joint in conventions])
