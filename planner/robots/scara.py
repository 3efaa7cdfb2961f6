"""The SCARA with three (RRP) or four axes (RRPR): one RRR dyad, a prismatic quill, a wrist.

q = [θ1, θ2, z] or [θ1, θ2, z, θ4]: θ2 = θ_BC − θ1 (Denavit-Hartenberg), z the height of the flange above the base
origin (up), θ4 turns the flange against link 2. With the base at yaw ψ, the absolute angles are

    φ1 = ψ + θ1        φ2 = φ1 + θ2        φ4 = φ2 + θ4  (φ2 with three axes)                           (K9)

and a point is base + l1 e(φ1) + l2 e(φ2) + r e(φ4 + const) + z ẑ with e(φ) = (cos φ, sin φ).
Sources: 000 section 3 for the dyad, 001 for the wrist, both as mended in docs/kinematics.md.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.frames.motion import Motion, Pose
from assur.planner.robots.chain import LEFT, UP, Bend, Chain, Link
from assur.planner.robots.facts import Joint, Limits, RobotBody
from assur.planner.robots.planar import ring_margin
from assur.planner.robots.riders import check_lengths, check_riders, joints_of
from assur.planner.robots.robot import Robot

LINKS = ("base", "link1", "link2", "quill", "flange")
BASE, LINK1, LINK2, QUILL, FLANGE = range(5)
MODES = ("left", "right")
"""Left is assembly mode 1 (θ2 < 0), right is mode 2 (θ2 > 0)."""


@dataclass(frozen=True, eq=False)
class Scara(Robot):
    """A SCARA arm.

    Link frames: `base` at the base origin; `link1` at the shoulder axis, turned by φ1; `link2` at the elbow axis,
    turned by φ2, both at the height of the base origin; `quill` at the flange, never turned (world axes), for solids
    of revolution; `flange` at the flange, turned by φ4.

    Arguments: `name`; `l1`, `l2` lengths in m; `axes` 3 or 4; `limits` in the order of q; `base` in the world;
    `bodies` on links by number; `self_pairs` of link names; `joint_names`; `arms_rise`: the lift carries the arms, too
    (axis order R-P-R-R), so `link1` and `link2` are at the height of the flange; q keeps its order. Raises `InputError`
    for what is not one. Not checked: that bodies of neighbouring links do not overlap.
    """

    name: str
    l1: float
    l2: float
    axes: int
    limits: Limits
    base: Pose = field(default_factory=Pose)
    bodies: tuple[RobotBody, ...] = ()
    self_pairs: tuple[tuple[str, str], ...] = ()
    joint_names: tuple[str, ...] = ()
    arms_rise: bool = False
    modes: tuple[str, ...] = field(default=MODES, init=False, repr=False)
    lift: int | None = field(default=2, init=False, repr=False)
    dyads = 1
    parallel_least: float = field(default=0.0, init=False, repr=False)
    links: tuple[str, ...] = field(default=LINKS, init=False, repr=False)
    coordinates: tuple[str, ...] = field(init=False, repr=False)
    joints: tuple[Joint, ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if self.axes not in (3, 4):
            raise InputError("robot.axes", self.axes, "3 or 4")
        names = self.joint_names or ("theta1", "theta2", "z", "theta4")[: self.axes]
        kinds = ("revolute", "revolute", "prismatic", "revolute")[: self.axes]
        object.__setattr__(self, "joints", joints_of(names, kinds, self.limits))
        object.__setattr__(self, "joint_names", names)
        check_riders(LINKS, self.bodies, self.self_pairs)
        object.__setattr__(self, "coordinates", ("x", "y", "z", "yaw")[: self.axes])
        check_lengths(l1=self.l1, l2=self.l2)

    @property
    def facts(self) -> tuple[str, tuple[float, ...], dict[str, float]]:
        return "scara", (self.l1, self.l2), {"rises": float(self.arms_rise), "longest": self.l1 + self.l2}

    @property
    def chain(self) -> Chain:
        rise, lift = ((2, UP), None) if self.arms_rise else (None, (2, UP))
        end = (self.l2, 0.0, 0.0)
        return Chain(
            (
                Link("base", -1, (self.base.x, self.base.y, self.base.z)),
                Link("link1", BASE, turns=(0,), slide=rise),
                Link("link2", LINK1, (self.l1, 0.0, 0.0), (0, 1)),
                Link("quill", LINK2, end, slide=lift, fixed=True),
                Link("flange", LINK2, end, (0, 1, 3)[: self.axes - 1], slide=lift),
            ),
            (Bend(LINK2, LINK1, LEFT),),
            ((-1,), (1,)),
        )

    def reach_margin(self, flange: Motion, mode: int) -> FloatArray:  # noqa: ARG002 - both modes reach as far
        away = flange.p - self.base.position
        return ring_margin(np.hypot(away[..., 0], away[..., 1]), self.l1, self.l2)
