"""What is executed: knots and quintic Hermite splines, their exact extremes, and whether they keep limits."""

from assur.planner.trajectory.limits import (
    JERK_TOLERANCE,
    LIMIT_TOLERANCE,
    LimitCheck,
    LimitReport,
    accepted_bands,
    check_limits,
    keeps_bands,
)
from assur.planner.trajectory.trajectory import Trajectory

__all__ = [
    "JERK_TOLERANCE",
    "LIMIT_TOLERANCE",
    "LimitCheck",
    "LimitReport",
    "Trajectory",
    "accepted_bands",
    "check_limits",
    "keeps_bands",
]
