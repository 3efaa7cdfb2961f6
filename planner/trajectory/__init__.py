"""What is executed: knots and quintic Hermite splines, their exact extremes, and whether they keep limits."""

from assur.planner.trajectory.trajectory import (
    JERK_TOLERANCE,
    LIMIT_TOLERANCE,
    Trajectory,
    accepted_bands,
    keeps_bands,
)

__all__ = [
    "JERK_TOLERANCE",
    "LIMIT_TOLERANCE",
    "Trajectory",
    "accepted_bands",
    "keeps_bands",
]
