"""The arm with five axes (RRRRR): an elbow arm that carries a wrist, which pitches and rolls. Mitsubishi RV-M1.

q = [θ1, θ2, θ3, θ4, θ5]: those of the elbow arm, angle of the hand from the forearm (up is positive), roll of the
flange about the hand. With ψ4 = θ2 + θ3 + θ4 the tool point is, in the plane, at ζ = l1 e^{iψ2} + l2 e^{iψ3} +
l3 e^{iψ4} (H2). Equations H of docs/kinematics.md. Source: 003, section 5.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError, InputError
from assur.planner.frames.motion import Motion
from assur.planner.robots.facts import Chain, Link, ring_margin
from assur.planner.robots.tilting import LINK2, LINK3, SIGNS, ElbowArm

LINK4, FLANGE = 4, 5


@dataclass(frozen=True, eq=False, kw_only=True)
class FiveAxisArm(ElbowArm):
    """A five-axis arm; its hand has a pitch and a roll.

    `link2` to `link3` as in an elbow arm; `link4` is the hand, its frame at the pitch axis; `flange` is at the tool
    point, `l3` (m) from there along the hand, and rolls about it. Modes are named by the elbow and by the side on which
    the tool point is: in `back` modes the heading φ1 points away from it, and the pitch is still counted from φ1.
    Raises `InputError` unless l3 is positive and finite. The rest: `ElbowArm`.
    """

    family: ClassVar[str] = "five-axis"
    names: ClassVar[tuple[str, ...]] = ("theta1", "theta2", "theta3", "theta4", "theta5")
    kinds: ClassVar[tuple[str, ...]] = ("revolute",) * 5
    links: ClassVar[tuple[str, ...]] = ("base", "link1", "link2", "link3", "link4", "flange")
    ways: ClassVar[tuple[str, ...]] = ("x", "y", "z", "pitch", "roll")

    l3: float

    def __post_init__(self) -> None:
        if not 0.0 < self.l3 < np.inf:
            raise InputError("robot.l3", self.l3, "a positive length in m")
        super().__post_init__()

    @property
    def lengths(self) -> tuple[float, ...]:
        return self.l1, self.l2, self.l3

    @property
    def chain(self) -> Chain:
        forearm = Link(LINK2, (self.l1, 0.0, 0.0), (0,), (1, 2))
        hand = Link(LINK3, (self.l2, 0.0, 0.0), (0,), (1, 2, 3))
        flange = Link(LINK4, (self.l3, 0.0, 0.0), (0,), (1, 2, 3), (4,))
        return Chain((*self._shoulder, forearm, hand, flange), self._bends, SIGNS)

    def reach_margin(self, flange: Motion, mode: int) -> FloatArray:
        """As `Robot.reach_margin`: that of the wrist (H2). Raises `FaultError` for a motion without pitch."""
        if not flange.tilted:
            raise FaultError("FiveAxisArm.reach_margin: a motion without pitch and roll")
        radius, height = self.in_plane(flange, mode)
        pitch = flange.tilt[..., 0]
        distance = np.hypot(radius - self.l3 * np.cos(pitch), height - self.l3 * np.sin(pitch))
        return ring_margin(distance, self.l1, self.l2)
