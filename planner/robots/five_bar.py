"""The five-bar or parallel SCARA: two cranks turned by motors at the base, two couplers, a tool axis where they meet.

q = [θ1, θ5], [θ1, θ5, z] or [θ1, θ5, z, θ4]: the left and the right crank's angles from the base's x axis, which points
to the front, z the height of the flange above the base origin (without it the flange is at that height), θ4 the angle
of the flange from the left coupler, on which the quill rides. Absolute angles are

    φ1 = ψ + θ1    φ5 = ψ + θ5    φ2 = ∠u    φ3 = ∠(−w)    φ4 = φ2 + θ4  (φ2 without a wrist)             (K34)

with u (from the left elbow to the tool axis) and w (from there to the right elbow) the RRR dyad on

    s = P2 − P1 = u + w        P1 = A_L + a_L e(θ1)        P2 = A_R + a_R e(θ5)                         (K32)

in base axes, the cranks turning about A_L = (0, d/2) and A_R = (0, −d/2). The inverse is two RRR dyads, one from each
crank axis to the tool axis: four working modes. The direct problem is one dyad between the elbows: two assembly modes;
a robot never leaves its own. Type 1 (serial) singularities, a crank in line with its coupler, may be crossed by
joint legs; type 2 may not be neared.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.frames.motion import Motion
from assur.planner.robots.facts import LEFT, UP, Bend, Chain, Link, Loop, check_lengths, ring_margin
from assur.planner.robots.robot import Robot

BASE, PROXIMAL_LEFT, PROXIMAL_RIGHT, DISTAL_LEFT, DISTAL_RIGHT, QUILL, FLANGE = range(7)
ASSEMBLIES = ("front", "back")
"""On which side of the line of the elbows the tool axis is: with both cranks sideways, in front or behind."""
PARALLEL_LEAST = 0.1
"""Least parallel margin, |sin| of the angle between the couplers (no unit): at 0.1, 5.7°, a torque of the motors or
a play in a joint acts ten times as strong along the tool's worst direction as at a right angle."""


@dataclass(frozen=True, eq=False, kw_only=True)
class FiveBar(Robot):
    """A five-bar arm.

    Link frames: `base` at the base origin, midway between the crank axes; `proximal-left` and `proximal-right` at the
    crank axes, turned by φ1 and φ5; `distal-left` and `distal-right` at the elbows, turned by φ2 and φ3, all at the
    height of the base origin; `quill` at the flange, never turned, for solids of revolution; `flange` turned by φ4.

    Arguments: `separation` of the crank axes, `proximal` and `distal` lengths (left, right), m; `axes` 2, 3 or 4;
    `assembly` out of `ASSEMBLIES`; `parallel_least`. Raises `InputError` for what is not one. The rest: `Robot`.
    """

    family: ClassVar[str] = "five-bar"
    names: ClassVar[tuple[str, ...]] = ("theta1", "theta5", "z", "theta4")
    kinds: ClassVar[tuple[str, ...]] = ("revolute", "revolute", "prismatic", "revolute")
    links: ClassVar[tuple[str, ...]] = (
        "base", "proximal-left", "proximal-right", "distal-left", "distal-right", "quill", "flange",
    )  # fmt: skip
    modes: ClassVar[tuple[str, ...]] = ("left-left", "left-right", "right-left", "right-right")
    """Where the left arm's elbow is, and where the right one's: to the left or the right of the line from crank axis to
    tool axis, seen from the crank axis. The usual mode, elbows outwards, is left-right."""

    separation: float
    proximal: tuple[float, float]
    distal: tuple[float, float]
    axes: int
    assembly: str = "front"
    parallel_least: float = PARALLEL_LEAST
    dyads: ClassVar[int] = 2

    def __post_init__(self) -> None:
        if self.axes not in (2, 3, 4):
            raise InputError("robot.axes", self.axes, "2, 3 or 4")
        if self.assembly not in ASSEMBLIES:
            raise InputError("robot.assembly", self.assembly, f"one of {ASSEMBLIES}")
        if not 0.0 < self.parallel_least < 1.0:
            raise InputError("robot.parallel_least", self.parallel_least, "a number between 0 and 1")
        if not 0.0 <= self.separation < sum(self.proximal) + sum(self.distal):
            raise InputError("robot.separation", self.separation, "a distance that the links can span, m")
        for crank, coupler in zip(self.proximal, self.distal, strict=True):
            check_lengths(l1=crank, l2=coupler)
        super().__post_init__()

    @property
    def count(self) -> int:
        return self.axes

    @property
    def lengths(self) -> tuple[float, ...]:
        return self.proximal[0], self.distal[0], self.proximal[1], self.distal[1]

    @property
    def chain(self) -> Chain:
        """Both cranks come before the couplers, which depend on them."""
        half, lift = self.separation / 2.0, (2, UP) if self.axes > 2 else None
        end, wrist = (self.distal[0], 0.0, 0.0), (3,) if self.axes > 3 else ()
        links = (
            Link(-1, (self.base.x, self.base.y, self.base.z)),
            Link(0, (0.0, half, 0.0), (0,)),
            Link(0, (0.0, -half, 0.0), (1,)),
            Link(1, (self.proximal[0], 0.0, 0.0), coupler=0),
            Link(2, (self.proximal[1], 0.0, 0.0), coupler=1),
            Link(3, end, slide=lift, fixed=True),
            Link(3, end, wrist, slide=lift, coupler=0),
        )
        loop = Loop((1, 2), self.proximal, self.distal, float(self.sigma), self.parallel_least)
        return Chain(links, (Bend(3, 1, LEFT), Bend(4, 2, LEFT)), ((-1, -1), (-1, 1), (1, -1), (1, 1)), loop)

    def reach_margin(self, flange: Motion, mode: int) -> FloatArray:  # noqa: ARG002 - all modes reach as far
        """As `Robot.reach_margin`, the lesser one of both sides: a point outside both may be a little further off."""
        away, turn = flange.p - self.base.position, self.base.yaw
        x = np.cos(turn) * away[..., 0] + np.sin(turn) * away[..., 1]
        y = np.cos(turn) * away[..., 1] - np.sin(turn) * away[..., 0]
        half = self.separation / 2
        left, right = (
            ring_margin(np.hypot(x, y - side), crank, coupler)
            for side, crank, coupler in zip((half, -half), self.proximal, self.distal, strict=True)
        )
        return np.asarray(np.minimum(left, right))

    @property
    def sigma(self) -> int:
        """Assembly mode of the dyad between the elbows: 1 (left, D < 0) in front, −1 behind."""
        return 1 if self.assembly == "front" else -1

    def span(self, q: FloatArray) -> FloatArray:
        """s (..., 2), from the left elbow to the right one, m, base axes, for q (..., n) (K32)."""
        (left, right), apart = self.proximal, np.array([0.0, self.separation])
        cosine, sine = np.cos(q[..., :2]), np.sin(q[..., :2])
        reach = (
            np.stack([cosine[..., 1], sine[..., 1]], -1) * right - np.stack([cosine[..., 0], sine[..., 0]], -1) * left
        )
        return np.asarray(reach - apart)
