"""Arms whose links tilt: what they have in common, the polar arm and the elbow arm."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.frames.motion import Motion
from assur.planner.geometry.shapes import SMALLEST_M
from assur.planner.robots.facts import AHEAD, UP, Bend, Chain, Link, check_lengths, ring_margin
from assur.planner.robots.robot import Robot

BASE, LINK1, LINK2, LINK3, FLANGE = range(5)


@dataclass(frozen=True, eq=False, kw_only=True)
class TiltingArm(Robot):
    """The facts that elbow, polar and five-axis arm share.

    Link frames: `base` at the base origin; `link1` at the shoulder, turned by φ1, upright; `link2` at the shoulder and
    `link3`, `flange` where the arm says, turned by φ1 and then tilted: x ahead along the link, y level, so that all
    frames have the base's axes where all angles are 0.

    Argument: `height` of the shoulder above the base origin, m. Raises `InputError` for what is not one. The rest:
    `Robot`.
    """

    links: ClassVar[tuple[str, ...]] = ("base", "link1", "link2", "link3", "flange")

    height: float

    def __post_init__(self) -> None:
        if not np.isfinite(self.height):
            raise InputError("robot.height", self.height, "a finite number")
        super().__post_init__()

    @property
    def _shoulder(self) -> tuple[Link, ...]:
        """The links that these arms share: base, the one that turns, and the first that tilts."""
        return (
            Link(-1, (self.base.x, self.base.y, self.base.z)),
            Link(BASE, (0.0, 0.0, self.height), (0,)),
            Link(LINK1, turns=(0,), tilts=(1,)),
        )

    def in_plane(self, flange: Motion, mode: int) -> tuple[FloatArray, FloatArray]:
        """Radius ρ and height h (...) of the flange in the vertical plane of the arm, from the shoulder, K23; in a mode
        in which the base is turned away ρ is negative."""
        away = flange.p - self.base.position
        radius = np.hypot(away[..., 0], away[..., 1])
        return (-radius if self.modes[mode].startswith("back") else radius), away[..., 2] - self.height


@dataclass(frozen=True, eq=False, kw_only=True)
class PolarArm(TiltingArm):
    """A polar arm.

    `link2` is the guide that tilts, its frame at the shoulder; `link3` the ram that slides in it, its frame at the
    flange; `flange` likewise. Raises `InputError` unless the ram's shortest length is at least 10 µm: at zero the arm
    has no direction. The rest: `TiltingArm`.
    """

    family: ClassVar[str] = "polar"
    names: ClassVar[tuple[str, ...]] = ("theta1", "theta2", "d3")
    kinds: ClassVar[tuple[str, ...]] = ("revolute", "revolute", "prismatic")
    modes: ClassVar[tuple[str, ...]] = ("front", "back")
    """`back`: the base is turned away and the arm reaches over the vertical."""

    def __post_init__(self) -> None:
        if len(self.limits.lower) == 3 and not self.limits.lower[2] >= SMALLEST_M:
            raise InputError("robot.limits.lower", float(self.limits.lower[2]), f"a length from {SMALLEST_M} m")
        super().__post_init__()

    @property
    def longest(self) -> float:
        """The farthest that the flange can be from the shoulder, m."""
        return float(self.limits.upper[-1])

    @property
    def lengths(self) -> tuple[float, ...]:
        return ()

    @property
    def chain(self) -> Chain:
        ram = Link(LINK2, turns=(0,), tilts=(1,), slide=(2, AHEAD))
        bends = (Bend(LINK3, LINK2, AHEAD, self.longest), Bend(LINK3, LINK1, AHEAD, self.longest))
        return Chain((*self._shoulder, ram, ram), bends, ((1, 1), (1, -1)))

    def reach_margin(self, flange: Motion, mode: int) -> FloatArray:
        distance = np.hypot(*self.in_plane(flange, mode))
        lower, upper = float(self.limits.lower[-1]), float(self.limits.upper[-1])
        return np.asarray(np.minimum(upper - distance, distance - lower))


SIGNS = ((-1, 1), (1, 1), (1, -1), (-1, -1))
"""Of the sine of the elbow and of the radius of the flange, mode by mode."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ElbowArm(TiltingArm):
    """An elbow arm.

    `link2` is the upper arm, its frame at the shoulder; `link3` the forearm, its frame at the elbow; `flange` is at the
    forearm's end and tilts with it. `l1`, `l2`: lengths of upper arm and forearm, m. The rest: `TiltingArm`.
    """

    family: ClassVar[str] = "elbow"
    names: ClassVar[tuple[str, ...]] = ("theta1", "theta2", "theta3")
    kinds: ClassVar[tuple[str, ...]] = ("revolute", "revolute", "revolute")
    modes: ClassVar[tuple[str, ...]] = ("up", "down", "back-up", "back-down")
    """Elbow above or below the line from shoulder to flange; `back`: the base is turned away, the arm reaches over
    it."""

    l1: float
    l2: float

    def __post_init__(self) -> None:
        check_lengths(l1=self.l1, l2=self.l2)
        super().__post_init__()

    @property
    def lengths(self) -> tuple[float, ...]:
        return self.l1, self.l2

    @property
    def longest(self) -> float:
        """The farthest that the flange can be from the shoulder, m."""
        return sum(self.lengths)

    @property
    def chain(self) -> Chain:
        forearm = Link(LINK2, (self.l1, 0.0, 0.0), (0,), (1, 2))
        links = (*self._shoulder, forearm, Link(LINK3, (self.l2, 0.0, 0.0), (0,), (1, 2)))
        return Chain(links, self._bends, SIGNS)

    @property
    def _bends(self) -> tuple[Bend, ...]:
        """Of the elbow, and how far the flange is off the base axis."""
        return Bend(LINK3, LINK2, UP), Bend(len(self.links) - 1, LINK1, AHEAD, self.longest)

    def reach_margin(self, flange: Motion, mode: int) -> FloatArray:
        return ring_margin(np.hypot(*self.in_plane(flange, mode)), self.l1, self.l2)
