"""What is not seen yet, as a body: the stretch of a conveyor behind the line at which its parts are seen.

It is as wide and high as the parts can be there, and moves with the conveyor. Its front is where a part can be at most
that is just not reported. So a motion that is proved against it is proved against all parts that come later.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from assur.planner.geometry.shapes import LARGEST_M
from assur.scenes.faults import Refused
from assur.scenes.streams.stream import Stream

Document = dict[str, Any]
HORIZON_S = 20.0
"""So long a stretch is behind the edge of what the arm reaches that a motion up to so long is proved, s."""
MORE_M = 0.05
"""By how much it is longer, m, and twice the radius of its largest part."""


@dataclass(frozen=True)
class Unseen:
    """The stretch of one stream, as a part of a task. `front_m`: x of its front at the time at which it is stated, and
    `clear_m`: up to which it may be then.
    `proved_s`: so long after that time no part that is not reported is outside of it where the arm reaches."""

    name: str
    part: Document
    front_m: float
    clear_m: float
    proved_s: float

    def fields(self, at_s: float) -> Document:
        """The stretch at a time, as a session sees it."""
        return {**self.part, "pose": {**self.part["pose"], "at_s": at_s}}


def unseen_name(stream: Stream) -> str:
    """The name of the stretch of a stream."""
    return f"unseen.{stream.name}"


def unseen_of(stream: Stream, reached_m: float, speed_off_m_s: float) -> Unseen:
    """The stretch of a stream; `reached_m`: x in its frame at which the arm reaches its parts first; `speed_off_m_s`:
    by how much the speed of the frame may be off. Raises `Refused` for one that is too long."""
    radius, speed = stream.radius_m, stream.speed_m_s
    fastest, more = speed + speed_off_m_s, 2.0 * radius + MORE_M
    front = stream.seen_m + fastest * stream.latency_s + radius
    back = min(front, reached_m) - fastest * HORIZON_S - more
    length = front - back
    if length > LARGEST_M:
        raise Refused(f"a line at most {LARGEST_M:g} m from the arm, and a slower conveyor", "streams", stream.name)
    low, high = min(kind.heights_m[0] for kind in stream.kinds), max(kind.heights_m[1] for kind in stream.kinds)
    left, right = stream.offsets_m
    size = [length, right - left + 2.0 * radius, high - low]
    at = [0.5 * (front + back), 0.5 * (left + right), stream.at_m[2] + 0.5 * (low + high)]
    part: Document = {"shape": {"box": {"size_m": size}}, "pose": {"frame": stream.frame, "at_m": at}}
    off = max(kind.off_m for kind in stream.kinds)
    part["uncertainty"] = {
        "position_m": off,
        "vertical_m": max(kind.vertical_m for kind in stream.kinds),
    }
    proved_s = (reached_m - more - back) / fastest
    return Unseen(unseen_name(stream), part, front, front + off, proved_s)
