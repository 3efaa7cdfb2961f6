"""What the statement checker reports: differences between what a claim states and what the request requires."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from assur.planner.arrays import FloatArray

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


class Topic(StrEnum):
    """What a difference is about."""

    DIGEST = "DIGEST"
    LAW = "LAW"
    """The motion of a frame."""
    UNCERTAINTY = "UNCERTAINTY"
    """What is uncertain of frames, bodies, joints and the start, and the tool's share in it."""
    LINK = "LINK"
    """The links of an arm."""
    SOLID = "SOLID"
    """The shape of a body."""
    DISTANCE = "DISTANCE"
    """Which distance is required of which pair, and until when."""
    MOTION = "MOTION"
    """The knots of an arm."""
    START = "START"
    END = "END"
    LEGS = "LEGS"
    ARRIVAL = "ARRIVAL"
    WINDOW = "WINDOW"
    PHASE = "PHASE"
    """The times of the phases."""
    SEAT = "SEAT"
    """Which link or frame a body is fixed to, and its pose there."""
    CONTACT = "CONTACT"
    """Which bodies may touch, how deep, and on what a part rests that was put down."""
    LIMIT = "LIMIT"
    LOAD = "LOAD"
    POINT = "POINT"
    """Where the tool is at a control point, and while it tracks it."""
    AXIS = "AXIS"
    """Directions of the tool."""
    YAW = "YAW"
    """Yaws of the tool that are forbidden."""
    RATE = "RATE"
    """How hard a part is accelerated, and how fast the tool is on a trace."""
    GUIDE = "GUIDE"
    """Where the tool is along a straight leg, along a path, and on a trace."""
    SUM = "SUM"
    """Joints that rest or go on; pitch and roll."""
    ARCH = "ARCH"
    ERROR = "ERROR"
    """How far the tool may be from its point, whatever is uncertain."""
    PARABOLA = "PARABOLA"
    """Parabolas, and vias that are missed."""
    MODE = "MODE"
    """The working mode of the arm."""
    MARGIN = "MARGIN"
    """How near the arm comes to singular positions."""
    NEARNESS = "NEARNESS"
    """How near bodies come, and parts are to tool and support."""
    PEAK = "PEAK"
    """Peaks of the joints and of the tool."""


@dataclass(frozen=True, slots=True)
class Difference:
    """A claim does not state what the request requires: `topic`, `what` in words, and `when` (None: always)."""

    topic: Topic
    what: str
    when: Interval | None = None


def is_same(one: FloatArray, other: FloatArray) -> bool:
    """Whether all numbers of two arrays are the same; NaN is not."""
    return bool((abs(one - other) <= SAME).all())
