"""The polar arm with three axes (RRP): a base that turns, and an RPR dyad in the vertical plane.

q = [θ1, ψ, d]: base angle, angle of the arm above the horizontal (up is positive), length from shoulder to flange. The
flange is, in the plane, at ζ = d e^{iψ} (K25). Source: 002, whose θ2 is ψ − 90° and whose l1 is the shoulder's height;
000, figures 2 and 3, for the dyad.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.frames.motion import Motion
from assur.planner.geometry.shapes import SMALLEST_M
from assur.planner.robots.chain import AHEAD, Bend, Chain, Link
from assur.planner.robots.tilting import LINK1, LINK2, LINK3, TiltingArm


@dataclass(frozen=True, eq=False, kw_only=True)
class PolarArm(TiltingArm):
    """A polar arm.

    `link2` is the guide that tilts, its frame at the shoulder; `link3` the ram that slides in it, its frame at the
    flange; `flange` likewise. Raises `InputError` unless the ram's shortest length is at least 10 µm: at zero the arm
    has no direction. The rest: `TiltingArm`.
    """

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
    def facts(self) -> tuple[str, tuple[float, ...], dict[str, float]]:
        return "polar", (), {"height": self.height, "longest": self.longest}

    @property
    def chain(self) -> Chain:
        ram = Link(LINK2, turns=(0,), tilts=(1,), slide=(2, AHEAD))
        bends = (Bend(LINK3, LINK2, AHEAD, self.longest), Bend(LINK3, LINK1, AHEAD, self.longest))
        return Chain((*self._shoulder, ram, ram), bends, ((1, 1), (1, -1)))

    def reach_margin(self, flange: Motion, mode: int) -> FloatArray:
        distance = np.hypot(*self.in_plane(flange, mode))
        lower, upper = float(self.limits.lower[-1]), float(self.limits.upper[-1])
        return np.asarray(np.minimum(upper - distance, distance - lower))
