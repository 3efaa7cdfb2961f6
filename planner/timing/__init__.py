"""When joints are where: phases of constant jerk, the entry to the solver that makes them, and lower bounds."""

from assur.planner.timing.solver import (
    SHORTEST,
    Numbers,
    RawProfile,
    Solver,
    TimingRefusal,
    fastest_motion,
    trajectory_of,
)

__all__ = [
    "SHORTEST",
    "Numbers",
    "RawProfile",
    "Solver",
    "TimingRefusal",
    "fastest_motion",
    "trajectory_of",
]
