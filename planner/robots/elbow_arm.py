"""The elbow arm with three axes (RRR): a base that turns, and an RRR dyad in the vertical plane.

q = [θ1, θ2, θ3]: base angle, angle of the upper arm above the horizontal, angle of the forearm from the upper arm (up
is positive). With ψ2 = θ2 and ψ3 = θ2 + θ3 the flange is, in the plane, at ζ = l1 e^{iψ2} + l2 e^{iψ3} (K24); the tool
is a part of the forearm. Sources: 002 (geometric method), 003 (by oblique triangles).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Motion
from assur.planner.robots.chain import AHEAD, UP, Bend, Chain, Link
from assur.planner.robots.planar import check_lengths, ring_margin
from assur.planner.robots.tilting import LINK1, LINK2, LINK3, TiltingArm

SIGNS = ((-1, 1), (1, 1), (1, -1), (-1, -1))
"""Of the sine of the elbow and of the radius of the flange, mode by mode."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ElbowArm(TiltingArm):
    """An elbow arm.

    `link2` is the upper arm, its frame at the shoulder; `link3` the forearm, its frame at the elbow; `flange` is at the
    forearm's end and tilts with it. `l1`, `l2`: lengths of upper arm and forearm, m. The rest: `TiltingArm`.
    """

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
    def longest(self) -> float:
        """The farthest that the flange can be from the shoulder, m."""
        return self.l1 + self.l2

    @property
    def facts(self) -> tuple[str, tuple[float, ...], dict[str, float]]:
        return "elbow", (self.l1, self.l2), {"height": self.height, "longest": self.longest}

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
