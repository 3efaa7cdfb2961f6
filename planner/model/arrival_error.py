"""How far the tool may be from a control point, and why: facts, SI."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from assur.planner.laws.law import PoseUncertainty


class Cause(StrEnum):
    """Why the tool may not be where its control point is."""

    FRAME = "frame"
    """The frame is not where its law has it."""
    LATE = "late start"
    """The robot starts late, and the frame has gone on."""
    LAG = "servo lag"
    PART = "part"
    """The part is not where it should be in its frame."""
    GRIP = "grip"
    """The part is not where it should be in the gripper."""


@dataclass(frozen=True, slots=True)
class Share:
    """What one cause adds to an error at most: m and rad."""

    cause: Cause
    position_m: float
    yaw_rad: float


@dataclass(frozen=True, slots=True)
class ArrivalError:
    """How far the tool may be from its control point when the step is done: no realisation of what the request does not
    know is worse. `position_m`: distance; `within`: the same split into horizontal, vertical and yaw.

    `shares`: by cause, the largest first. `worst`: one realisation that comes near `position_m`: signs of the frame's
    error along and across its line and along the vertical and of the lag of each joint, lateness in s, and the
    direction of what is the same in all horizontal directions, rad in the world.
    """

    position_m: float
    within: PoseUncertainty
    shares: tuple[Share, ...]
    worst: tuple[tuple[str, float], ...]
