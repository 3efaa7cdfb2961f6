"""What the flange carries, the tool and with it a part: mass, inertia about the wrist's axis, and the share of the
joints' acceleration and jerk that it leaves.

The law between rated and maximum load (equation G2): share = rated load / load, so that no load is accelerated with
more force than the rated one; or, where it is given, the maker's table of shares by mass, linear between its rows.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import Body


@dataclass(frozen=True, eq=False)
class Tool:
    """What is bolted to the flange: tool point `tcp` in the flange frame, bodies in the flange frame, mass (None: not
    stated). `inertia_kgm2`: about the flange's z axis; None: the mass is spread over the bodies by volume, or is at the
    tool point where there are none."""

    tcp: Pose
    bodies: tuple[Body, ...] = ()
    mass_kg: float | None = None
    inertia_kgm2: float | None = None

    @cached_property
    def inertia(self) -> float:
        """About the flange's z axis, kg·m²."""
        if self.inertia_kgm2 is not None:
            return self.inertia_kgm2
        if not self.mass_kg:
            return 0.0
        if not self.bodies:
            return self.mass_kg * (self.tcp.x**2 + self.tcp.y**2)
        parts = [body.spread for body in self.bodies]
        squares = [part.square + part.centroid[0] ** 2 + part.centroid[1] ** 2 for part in parts]
        whole = sum(part.volume for part in parts)
        return self.mass_kg * sum(p.volume * square for p, square in zip(parts, squares, strict=True)) / whole


@dataclass(frozen=True, slots=True)
class LoadLimits:
    """What an arm may carry: rated and maximum load, kg, greatest inertia about the wrist's axis, kg·m² (None: not
    known), and the share of acceleration and jerk by mass: rows (kg, share), which replace the law G2.

    Raises `InputError` for a number that is not positive and finite, a rated load above the maximum, masses that do not
    increase, and shares that increase or are not in (0, 1].
    """

    rated_kg: float | None = None
    max_kg: float | None = None
    max_inertia_kgm2: float | None = None
    shares: tuple[tuple[float, float], ...] = ()

    def __post_init__(self) -> None:
        for name in ("rated_kg", "max_kg", "max_inertia_kgm2"):
            value = getattr(self, name)
            if value is not None and not 0.0 < value < math.inf:
                raise InputError(f"load.{name}", value, "a positive number")
        if self.rated_kg is not None and self.max_kg is not None and not self.rated_kg <= self.max_kg:
            raise InputError("load.rated_kg", self.rated_kg, f"up to the maximum load of {self.max_kg:g} kg")
        for i, (mass, share) in enumerate(self.shares):
            if not 0.0 <= mass < math.inf or not 0.0 < share <= 1.0:
                raise InputError(f"load.shares[{i}]", (mass, share), "a mass from 0 kg on and a share in (0, 1]")
            if i and not (self.shares[i - 1][0] < mass and share <= self.shares[i - 1][1]):
                raise InputError(f"load.shares[{i}]", (mass, share), "a larger mass, and no larger share, than before")

    @property
    def nothing_known(self) -> bool:
        """Whether no load is refused and nothing is scaled."""
        return self.rated_kg is self.max_kg is self.max_inertia_kgm2 is None and not self.shares

    @property
    def most_kg(self) -> float | None:
        """The greatest mass that may be carried: the maximum load, or the last mass of the table if that is less; where
        neither is known the rated load; None: not known."""
        if not self.shares:
            return self.rated_kg if self.max_kg is None else self.max_kg
        last, _ = self.shares[-1]
        return last if self.max_kg is None else min(last, self.max_kg)

    def share(self, mass: float) -> float:
        """The share of acceleration and jerk that is used with this mass, kg (G2)."""
        if self.shares:
            masses, shares = zip(*self.shares, strict=True)
            return float(np.interp(mass, masses, shares))
        return 1.0 if self.rated_kg is None or mass <= self.rated_kg else self.rated_kg / mass


UNKNOWN = LoadLimits()


@dataclass(frozen=True, slots=True)
class Load:
    """Tool and `part` (None: the tool alone), which step number `step` takes (-1: from the start on): mass, greatest
    inertia about the wrist's axis (None: the arm has no such axis), and the share of acceleration and jerk."""

    step: int
    part: str | None
    mass_kg: float
    inertia_kgm2: float | None
    share: float


@dataclass(frozen=True, slots=True)
class Carried:
    """What the flange carries from `t0` to `t1`, s, in a plan: as a `Load`, but with the inertia for the turn in which
    the part is held."""

    part: str | None
    mass_kg: float
    inertia_kgm2: float | None
    share: float
    t0: float
    t1: float


def held_inertia(body: Body, mass_kg: float, in_flange: Pose) -> float:
    """Of a part that is held with its frame at `in_flange`, about the flange's z axis, kg·m² (G1)."""
    if not mass_kg > 0.0:
        return 0.0
    how = body.spread
    at = in_flange.then(Pose(how.centroid[0], how.centroid[1]))
    return mass_kg * (how.square + at.x**2 + at.y**2)


def greatest_inertia(body: Body, mass_kg: float, tcp: Pose, grasp: Pose, yaw_symmetry: int) -> float:
    """Of a part that is held at `grasp` (the tool point in its frame): the greatest over the turns that its
    `yaw_symmetry` leaves (0: any), about the vertical through its origin."""
    if not mass_kg > 0.0:
        return 0.0
    how, axis = body.spread, grasp.then(tcp.inverse())
    x, y, _ = how.centroid
    # the axis in the part's frame, which a turn turns about the part's origin
    away, angle, out = math.hypot(axis.x, axis.y), math.atan2(axis.y, axis.x), math.hypot(x, y)
    if yaw_symmetry == 0 or out == 0.0:
        return mass_kg * (how.square + (away + out) ** 2)
    angles = [angle + 2 * math.pi * k / yaw_symmetry - math.atan2(y, x) for k in range(yaw_symmetry)]
    return mass_kg * (how.square + away**2 + out**2 - 2 * away * out * min(map(math.cos, angles)))
