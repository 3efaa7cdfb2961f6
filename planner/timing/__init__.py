"""When joints are where: profiles of constant jerk, the door to the solver that makes them, and lower bounds."""

from planner.timing.blend_times import TooShort, fastest, with_acceleration_time
from planner.timing.bounds import least_duration, rest_to_rest_time
from planner.timing.combine import combine, to_trajectory
from planner.timing.parabolic_blend import ParabolicBlend
from planner.timing.profile import Profile
from planner.timing.question import Numbers, TimingRefusal
from planner.timing.sketch import Settled, Sketch
from planner.timing.solver import SHORTEST, Solver, time_joints

__all__ = [
    "SHORTEST",
    "Numbers",
    "ParabolicBlend",
    "Profile",
    "Settled",
    "Sketch",
    "Solver",
    "TimingRefusal",
    "TooShort",
    "combine",
    "fastest",
    "least_duration",
    "rest_to_rest_time",
    "time_joints",
    "to_trajectory",
    "with_acceleration_time",
]
