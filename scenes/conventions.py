"""The joint conventions of makers, and the conversion of values to the planner's convention and back.

The planner counts a lifting joint upwards from its base origin, which is at the maker's zero. So maker's and planner's
values differ only by a sign, unless a turning joint has a zero of its own. Without such a zero, converting a trajectory
to the maker's convention and back is exact in floating point: a plan that was written and read again is the same plan,
bit by bit. With such a zero, the position is rounded once, by some 1e-16 of its value, when the plan is written; later
conversions change nothing.
"""

from __future__ import annotations

from collections.abc import Iterable
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


class Conventions(tuple[JointConvention, ...]):
    """How the maker counts all joints of an arm, in the maker's order.

    `places` (n,): which of the planner's joints each is; `order` (n,): which of the maker's joints each of the
    planner's is. `signs`, `zeros` (n,): those of the planner's joints, in its order. `keys`: names with units.
    """

    def __init__(self, joints: Iterable[JointConvention]) -> None:  # noqa: ARG002 - a tuple has them by now
        self.places = np.array([i if joint.place is None else joint.place for i, joint in enumerate(self)], np.int64)
        self.order: IntArray = np.argsort(self.places)
        self.signs = np.array([float(joint.sign) for joint in self])[self.order]
        self.zeros = np.array([joint.zero for joint in self])[self.order]
        self.keys = tuple(f"{joint.name}_{joint.unit}" for joint in self)


def converted(values: FloatArray, conventions: Conventions) -> FloatArray:
    """Joint positions (..., n) of the maker in the planner's order and convention."""
    # + 0.0, which a zero is as well: no negative zeros
    turned: FloatArray = values.take(conventions.order, -1) * conventions.signs + conventions.zeros
    return turned


def as_maker(values: FloatArray, conventions: Conventions) -> FloatArray:
    """Joint positions (..., n) of the planner in the maker's order and convention: what `converted` undoes, exactly
    where no joint has a zero."""
    turned: FloatArray = (values - conventions.zeros) * conventions.signs + 0.0
    return turned.take(conventions.places, -1)


def converted_rates(values: FloatArray, conventions: Conventions) -> FloatArray:
    """Joint rates, or differences of positions, (..., n) of the maker in the planner's order and convention."""
    turned: FloatArray = values.take(conventions.order, -1) * conventions.signs + 0.0
    return turned


def rates_as_maker(values: FloatArray, conventions: Conventions) -> FloatArray:
    """Joint rates, or differences of positions, (..., n) of the planner as the maker counts; `converted_rates` undoes
    it exactly."""
    turned: FloatArray = values * conventions.signs + 0.0
    return turned.take(conventions.places, -1)


def as_counted(signs: tuple[tuple[str, float], ...], conventions: Conventions) -> tuple[tuple[str, float], ...]:
    """Named signs, those of joints as the maker counts them in place of the planner's, or the other way round."""
    reversed_ = {joint.name for joint in conventions if joint.sign < 0}
    return tuple((name, -value + 0.0 if name in reversed_ else value) for name, value in signs)
