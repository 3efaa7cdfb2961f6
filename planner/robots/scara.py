"""The SCARA with three (RRP) or four axes (RRPR): one RRR dyad, a prismatic quill, a wrist.

q = [θ1, θ2, z] or [θ1, θ2, z, θ4]: θ2 = θ_BC − θ1 (Denavit-Hartenberg), z the height of the flange above the base
origin (up), θ4 turns the flange against link 2. With the base at yaw ψ, the absolute angles are

    φ1 = ψ + θ1        φ2 = φ1 + θ2        φ4 = φ2 + θ4  (φ2 with three axes)                           (K9)

and a point is base + l1 e(φ1) + l2 e(φ2) + r e(φ4 + const) + z ẑ with e(φ) = (cos φ, sin φ).
Sources: 000 section 3 for the dyad, 001 for the wrist, both as mended in docs/kinematics.md.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.frames.motion import Motion
from assur.planner.robots.facts import LEFT, UP, Bend, Chain, Link, check_lengths, ring_margin
from assur.planner.robots.robot import Robot

BASE, LINK1, LINK2, QUILL, FLANGE = range(5)


@dataclass(frozen=True, eq=False, kw_only=True)
class Scara(Robot):
    """A SCARA arm; in mode `left` θ2 < 0 (assembly mode 1), in mode `right` θ2 > 0 (2).

    Link frames: `base` at the base origin; `link1` at the shoulder axis, turned by φ1; `link2` at the elbow axis,
    turned by φ2, both at the height of the base origin; `quill` at the flange, never turned (world axes), for solids
    of revolution; `flange` at the flange, turned by φ4.

    Arguments: `l1`, `l2` lengths in m; `axes` 3 or 4; `arms_rise`: the lift carries the arms, too (axis order R-P-R-R),
    so `link1` and `link2` are at the height of the flange; q keeps its order. Raises `InputError` for what is not one.
    The rest: `Robot`.
    """

    family: ClassVar[str] = "scara"
    names: ClassVar[tuple[str, ...]] = ("theta1", "theta2", "z", "theta4")
    kinds: ClassVar[tuple[str, ...]] = ("revolute", "revolute", "prismatic", "revolute")
    links: ClassVar[tuple[str, ...]] = ("base", "link1", "link2", "quill", "flange")
    modes: ClassVar[tuple[str, ...]] = ("left", "right")

    l1: float
    l2: float
    axes: int
    arms_rise: bool = False
    dyads: ClassVar[int] = 1

    def __post_init__(self) -> None:
        if self.axes not in (3, 4):
            raise InputError("robot.axes", self.axes, "3 or 4")
        check_lengths(l1=self.l1, l2=self.l2)
        super().__post_init__()

    @property
    def count(self) -> int:
        return self.axes

    @property
    def lengths(self) -> tuple[float, ...]:
        return self.l1, self.l2

    @property
    def longest(self) -> float:
        """The farthest that the flange can be from the shoulder, m."""
        return self.l1 + self.l2

    @property
    def chain(self) -> Chain:
        rise, lift = ((2, UP), None) if self.arms_rise else (None, (2, UP))
        end = (self.l2, 0.0, 0.0)
        return Chain(
            (
                Link(-1, (self.base.x, self.base.y, self.base.z)),
                Link(BASE, turns=(0,), slide=rise),
                Link(LINK1, (self.l1, 0.0, 0.0), (0, 1)),
                Link(LINK2, end, slide=lift, fixed=True),
                Link(LINK2, end, (0, 1, 3)[: self.axes - 1], slide=lift),
            ),
            (Bend(LINK2, LINK1, LEFT),),
            ((-1,), (1,)),
        )

    def reach_margin(self, flange: Motion, mode: int) -> FloatArray:  # noqa: ARG002 - both modes reach as far
        away = flange.p - self.base.position
        return ring_margin(np.hypot(away[..., 0], away[..., 1]), self.l1, self.l2)
