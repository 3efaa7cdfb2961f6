"""The tree of links and joints that a URDF says, with the solids of its links, as plain data in metres and radians; and
turns as a URDF writes them, as rotation matrices, in which multiples of a right angle have no rounding."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

import numpy as np

from assur.planner.arrays import FloatArray

JointType = Literal["revolute", "continuous", "prismatic", "fixed", "floating", "planar"]
MOVING = ("revolute", "continuous", "prismatic")
Bound = Literal["lower", "upper", "velocity", "acceleration", "deceleration", "jerk"]
"""What limits a joint, rad or m, and s."""


@dataclass(frozen=True, slots=True)
class Limit:
    """A limit that a URDF states, and the element and attribute that state it."""

    value: float
    source: str


@dataclass(frozen=True, eq=False)
class Solid:
    """A collision shape of a link: `origin` (4, 4) in the link's frame. A primitive has its `sizes` in m; a mesh its
    `file` as it is written, and the scale (3,) of its coordinates."""

    where: str
    kind: str
    origin: FloatArray
    sizes: tuple[float, ...] = ()
    file: str = ""
    scale: tuple[float, ...] = (1.0, 1.0, 1.0)


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint. `origin` (4, 4): the child's frame in the parent's at position 0; `axis` (3,): a unit vector in the
    child's frame. `bounds`: the limits that the file states, the narrowest of each."""

    name: str
    kind: JointType
    parent: str
    child: str
    origin: FloatArray
    axis: FloatArray
    bounds: Mapping[Bound, Limit] = field(default_factory=dict)
    mimics: str | None = None
    follows: tuple[float, float] = (1.0, 0.0)
    """Multiplier and offset of a joint that mimics another."""
    rpy: tuple[float, ...] = (0.0, 0.0, 0.0)
    """Roll, pitch and yaw of the origin as they are written."""
    stretch: float = 1.0
    """Length of the axis as it is written."""

    @property
    def moves(self) -> bool:
        return self.kind in MOVING

    def motion(self, q: FloatArray) -> FloatArray:
        """Pose (..., 4, 4) of the child in the parent for positions (...), rad or m; what does not move stays."""
        found = np.broadcast_to(self.origin, (*q.shape, 4, 4)).copy()
        if self.kind == "prismatic":
            found[..., :3, 3] += q[..., None] * (self.origin[:3, :3] @ self.axis)
        elif self.moves:
            x, y, z = self.axis
            cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
            s, c = np.sin(q)[..., None, None], np.cos(q)[..., None, None]
            found[..., :3, :3] = self.origin[:3, :3] @ (np.eye(3) + s * cross + (1 - c) * cross @ cross)
        return found


@dataclass(frozen=True, eq=False)
class Tree:
    """A robot: its links by name, each with its solids, and its joints by name. It has one root and no loop.

    `rounded`: angles that were read as multiples of a right angle, as they are written; `only_seen`: links with a
    visual shape and no collision shape; `remarks`: what was read otherwise than it looks, or not at all, with its line;
    `unused`: what a URDF may hold and no plan depends on; `warnings`: angles that are probably in degrees.
    """

    name: str
    links: dict[str, tuple[Solid, ...]]
    joints: dict[str, Joint]
    rounded: tuple[str, ...] = ()
    only_seen: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()
    unused: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()

    @property
    def root(self) -> str:
        children = {joint.child for joint in self.joints.values()}
        return next(link for link in self.links if link not in children)

    @cached_property
    def _below(self) -> dict[str, list[Joint]]:
        found: dict[str, list[Joint]] = {}
        for joint in self.joints.values():
            found.setdefault(joint.parent, []).append(joint)
        return found

    @cached_property
    def _above(self) -> dict[str, Joint]:
        return {joint.child: joint for joint in self.joints.values()}

    def below(self, link: str) -> list[Joint]:
        """The joints whose parent is a link, in the order of the file."""
        return self._below.get(link, [])

    def all_below(self, link: str) -> Iterator[Joint]:
        """The joints that hang on a link, each after the one that carries it."""
        ahead = [link]
        while ahead:
            for joint in self.below(ahead.pop()):
                yield joint
                ahead.append(joint.child)

    def above(self, link: str) -> Joint | None:
        """The joint whose child is a link."""
        return self._above.get(link)

    def path(self, base: str, tip: str) -> list[Joint] | None:
        """The joints from `base` to `tip`; None if `tip` does not hang on `base`."""
        found: list[Joint] = []
        while tip != base:
            joint = self.above(tip)
            if joint is None:
                return None
            found.append(joint)
            tip = joint.parent
        return found[::-1]

    def with_held(self, held: dict[str, float]) -> Tree:
        """The tree with some joints held at a position, as if they were fixed there, and with them the joints that
        follow them."""
        joints, at = dict(self.joints), dict(held)
        while more := [joint for joint in joints.values() if joint.mimics in at and joint.name not in at]:
            for joint in more:
                multiplier, offset = joint.follows
                at[joint.name] = multiplier * at[joint.mimics or ""] + offset
        for name, value in at.items():
            joint = joints[name]
            joints[name] = replace(joint, kind="fixed", origin=joint.motion(np.array(value)), mimics=None)
        return replace(self, joints=joints)


def turned(axis: Literal["x", "y", "z"], angle: float) -> FloatArray:
    """A rotation (3, 3) about an axis by an angle, rad."""
    c, s = math.cos(angle), math.sin(angle)
    quarter = angle / (math.pi / 2)
    if quarter == round(quarter):
        c, s = float(round(c)), float(round(s))
    i = "xyz".index(axis)
    j, k = (i + 1) % 3, (i + 2) % 3
    found = np.eye(3)
    found[j, j] = found[k, k] = c
    found[j, k], found[k, j] = -s, s
    return found


def of_rpy(roll: float, pitch: float, yaw: float) -> FloatArray:
    """A rotation (3, 3) by roll, pitch and yaw about the fixed x, y and z axes, in this order, rad."""
    found: FloatArray = turned("z", yaw) @ turned("y", pitch) @ turned("x", roll)
    return found


def of_quaternion(x: float, y: float, z: float, w: float) -> FloatArray:
    """The rotation (3, 3) of a quaternion of any length above 0."""
    # the division comes last: equal components then make exact zeros and ones
    square = x * x + y * y + z * z + w * w
    return (
        np.array(
            [
                [(x * x + w * w - y * y - z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
                [2.0 * (x * y + w * z), (y * y + w * w - x * x - z * z), 2.0 * (y * z - w * x)],
                [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), (z * z + w * w - x * x - y * y)],
            ]
        )
        / square
    )
