"""Poses (x, y, z, yaw): how one follows another. The z axis of everything that has such a pose points up."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from assur.planner.checker.statement.differences import Four

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


def inverse(one: Four) -> Four:
    """The pose with which then(one, inverse(one)) is the identity."""
    c, s = math.cos(one[3]), math.sin(one[3])
    return (-c * one[0] - s * one[1], s * one[0] - c * one[1], -one[2], -one[3])
