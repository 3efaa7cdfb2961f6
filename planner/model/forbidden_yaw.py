"""Ranges of yaw in which the tool may never be: what they are, and how much room a yaw has between them.

The yaw is that of the tool point in the world, so a range holds modulo full turns. A SCARA's yaw is a sum of joint
angles, which does not jump: from the start to the end it stays between the two ranges beside which it begins, full
turns counted (`Room`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from assur.planner.errors import InputError
from assur.planner.robots.robot import Robot

MOST = 16
"""Ranges of one request."""
NARROWEST_RAD = math.radians(0.1)
"""Width that a range has at least, and that all ranges together leave free at least."""
RESERVE_RAD = 1e-6
"""The planner counts ranges wider by this at both ends, for rounding of motions and of the proof."""


@dataclass(frozen=True, slots=True)
class YawRange:
    """From `first` counter-clockwise to `last`, rad, both ends included, whatever the full turns.

    Raises `InputError` for what is no number from -2π to 2π, for ends that are equal or a full turn or more apart, and
    for a width below `NARROWEST_RAD`.
    """

    first: float
    last: float

    def __post_init__(self) -> None:
        ends = self.first, self.last
        if not all(-math.tau <= end <= math.tau for end in ends):  # nor is NaN
            raise InputError("forbidden_yaw", ends, "two angles from -360° to 360°")
        if not 0.0 < abs(self.last - self.first) < math.tau:
            allowed = "two ends that differ, less than 360° apart; the range goes counter-clockwise from the first"
            raise InputError("forbidden_yaw", ends, allowed)
        if not self.width >= NARROWEST_RAD * (1.0 - 1e-9):
            raise InputError("forbidden_yaw", ends, "a range of 0.1° or more")

    @property
    def width(self) -> float:
        """rad, above 0 and below a full turn."""
        return (self.last - self.first) % math.tau

    @property
    def middle(self) -> float:
        return self.first + self.width / 2.0

    def beside(self, yaw: float) -> float:
        """The yaw, rad, less full turns: within half a turn of the range's middle."""
        return self.middle + math.remainder(yaw - self.middle, math.tau)

    def depth(self, yaw: float, slack: float) -> float:
        """How far, rad, a yaw is from the nearer end of the range, widened by `slack`; below 0: it is outside."""
        return self.width / 2.0 + slack - abs(math.remainder(yaw - self.middle, math.tau))


@dataclass(frozen=True, slots=True)
class Room:
    """Between which yaws, rad, full turns counted, the tool may turn, and which ranges end it; infinite: no range."""

    low: float = -math.inf
    high: float = math.inf
    below: YawRange | None = None
    above: YawRange | None = None


def entered(ranges: Sequence[YawRange], yaw: float, slack: float) -> tuple[YawRange, float] | None:
    """The range in which a yaw is deepest, and how deep, rad; None: it is in none. Ranges count wider by `slack`."""
    found = max(((each.depth(yaw, slack), k) for k, each in enumerate(ranges)), default=(-1.0, 0))
    return (ranges[found[1]], found[0]) if found[0] >= 0.0 else None


def room(ranges: Sequence[YawRange], yaw: float, slack: float) -> Room:
    """The room about a yaw that is in no range."""
    found = Room()
    for each in ranges:
        behind = (yaw - each.first) % math.tau  # how far counter-clockwise behind the first end the yaw is
        low, up = yaw - behind + each.width + slack, yaw - behind + math.tau - slack
        if low > found.low:
            found = Room(low, found.high, each, found.above)
        if up < found.high:
            found = Room(found.low, up, found.below, each)
    return found


def check_ranges(robot: Robot, ranges: Sequence[YawRange], lag: Sequence[float]) -> None:
    """Raises `InputError` for ranges that leave no yaw, for an arm that cannot turn its tool at will, and for lags
    that turn the tool by an unknown angle."""
    if not ranges:
        return
    if len(ranges) > MOST:
        raise InputError("robot.limits.forbidden_yaw", len(ranges), f"at most {MOST} ranges")
    if not robot.turns_load:
        allowed = f"none: {robot.name} has no wrist that turns its tool about the vertical"
        raise InputError("robot.limits.forbidden_yaw", [(each.first, each.last) for each in ranges], allowed)
    if robot.yaw_joints is None and any(lag[:2]):
        names = " and ".join(joint.name for joint in robot.joints[:2])
        allowed = f"none of {names} with limits.forbidden_yaw: how lag turns the tool is known for SCARAs only"
        raise InputError("execution.lag", tuple(lag), allowed)
    if not gaps(ranges, slack_of(lag)):
        allowed = "ranges that leave a yaw free, 0.1° or more, with the lags of the joints added at both ends"
        raise InputError("robot.limits.forbidden_yaw", [(each.first, each.last) for each in ranges], allowed)


def slack_of(lag: Sequence[float]) -> float:
    """By how much, rad, joints that lag may turn the tool: θ1, θ2 and θ4 add up (of a five-bar θ4 alone lags). A belt
    correction turns it by nothing: the wrist turns back by as much as the arm turns."""
    return float(lag[0] + lag[1] + lag[3]) if len(lag) > 3 else 0.0


def gaps(ranges: Sequence[YawRange], slack: float) -> list[tuple[float, float]]:
    """Where the circle is free between the ranges, widened by `slack`: from which yaw counter-clockwise, and how far,
    rad, `NARROWEST_RAD` at least."""
    found = []
    for each in ranges:
        edge = each.first + each.width + slack
        ahead = min((other.first - slack - edge) % math.tau for other in ranges)
        inside = any(other.depth(edge + NARROWEST_RAD / 2.0, slack) >= 0.0 for other in ranges)
        if not inside and ahead >= NARROWEST_RAD:
            found.append((edge, ahead))
    return found
