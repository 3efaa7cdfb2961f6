"""What the statement checker reports: what is required and is not stated, as findings."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from assur.planner.arrays import FloatArray
from assur.planner.checker.verdict import Code, Finding

Four = tuple[float, float, float, float]
"""A pose: x, y, z in m, and the yaw in rad."""
Interval = tuple[float, float]
"""From when to when, s."""

SAME = 1e-9
"""Two lengths, angles or times that differ by no more are the same, m, rad or s: rounding of sums and products. The
claim checker keeps as much of every gap."""
MEET = 1e-6
"""How far the tool may be off a control point when it meets it, m, rad, m/s and rad/s."""
TRACKED_M, TRACKED_RAD = 1e-5, 1e-4
"""How far the tool may be off while it is guided along a control point."""


class Requirements:
    """The findings about what is required and not so."""

    def __init__(self) -> None:
        self.findings: list[Finding] = []

    def require(self, holds: object, code: Code, what: str, when: Interval | None = None) -> None:
        """Adds a finding unless something holds: `what` is wrong in words, and `when` (None: always)."""
        if not holds:
            where = "" if when is None else at(when[0]) if when[0] == when[1] else f"{at(when[0])} to {at(when[1])}"
            self.findings.append(Finding(code, what, where=where))

    def require_all(self, code: Code, when: Interval | None, *requirements: tuple[object, str]) -> None:
        """`require` for what has to hold, and what is wrong else, one after the other."""
        for holds, what in requirements:
            if not holds:
                self.require(False, code, what, when)


def at(time: float) -> str:
    """A time in words."""
    return f"{time:.6g} s"


def is_same(one: FloatArray, other: FloatArray) -> bool:
    """Whether all numbers of two arrays are the same; NaN is not."""
    return bool((abs(one - other) <= SAME).all())


# Poses (x, y, z, yaw): how one follows another. The z axis of everything that has such a pose points up.

if TYPE_CHECKING:
    from assur.planner.frames.motion import Pose

IDENTITY: Four = (0.0, 0.0, 0.0, 0.0)


def numbers(pose: Pose) -> Four:
    """The four numbers of a pose of the request."""
    return (pose.x, pose.y, pose.z, pose.yaw)


def then(one: Four, other: Four) -> Four:
    """The pose `other`, which is given in the axes of `one`, in the axes in which `one` is given."""
    c, s = math.cos(one[3]), math.sin(one[3])
    x, y = one[0] + c * other[0] - s * other[1], one[1] + s * other[0] + c * other[1]
    return (x, y, one[2] + other[2], one[3] + other[3])


def inverse_pose(one: Four) -> Four:
    """The pose with which then(one, inverse(one)) is the identity."""
    c, s = math.cos(one[3]), math.sin(one[3])
    return (-c * one[0] - s * one[1], s * one[0] - c * one[1], -one[2], -one[3])
