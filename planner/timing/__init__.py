"""When joints are where: phases of constant jerk, the door to the solver that makes them, and lower bounds."""

from assur.planner.timing.inputs import Numbers, TimingRefusal
from assur.planner.timing.raw_profile import RawProfile, trajectory_of
from assur.planner.timing.solver import SHORTEST, Solver, time_joints

__all__ = [
    "SHORTEST",
    "Numbers",
    "RawProfile",
    "Solver",
    "TimingRefusal",
    "time_joints",
    "trajectory_of",
]
