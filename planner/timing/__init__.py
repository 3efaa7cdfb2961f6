"""When joints are where: profiles of constant jerk, the door to the solver that makes them, and lower bounds."""

from assur.planner.timing.blend_times import TooShort, fastest, with_acceleration_time
from assur.planner.timing.bounds import least_duration, rest_to_rest_time
from assur.planner.timing.combine import combine, to_trajectory
from assur.planner.timing.parabolic_blend import ParabolicBlend
from assur.planner.timing.profile import Profile
from assur.planner.timing.question import Numbers, TimingRefusal
from assur.planner.timing.sketch import Settled, Sketch
from assur.planner.timing.solver import SHORTEST, Solver, time_joints

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
