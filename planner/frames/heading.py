"""Whether a frame ever turns."""

from __future__ import annotations

from assur.planner.frames.conveyor import Conveyor
from assur.planner.frames.fixed import Fixed, Linear
from assur.planner.frames.indexer import Indexer
from assur.planner.frames.keyframes import Keyframes
from assur.planner.frames.law import Law
from assur.planner.frames.oscillation import Oscillation


def constant_yaw(law: Law) -> float | None:
    """The yaw, rad, that a frame has at all times, known or not; None: it turns, or nobody says that it does not."""
    if isinstance(law, Fixed | Conveyor | Linear | Oscillation):
        return law.pose.yaw
    if isinstance(law, Indexer) and law.kind == "travel":
        return law.pose.yaw
    if isinstance(law, Keyframes) and not law.turns:
        return law.poses[0].yaw
    return None
