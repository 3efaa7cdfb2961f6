"""When joints are where: profiles of constant jerk, the door to the solver that makes them, and lower bounds."""

from planner.timing.bounds import least_duration, rest_to_rest_time
from planner.timing.combine import combine, to_trajectory
from planner.timing.profile import Profile
from planner.timing.question import TimingRefusal
from planner.timing.sketch import Settled, Sketch
from planner.timing.solver import shortest_duration, sketch_joints, time_joints

__all__ = [
    "Profile",
    "Settled",
    "Sketch",
    "TimingRefusal",
    "combine",
    "least_duration",
    "rest_to_rest_time",
    "shortest_duration",
    "sketch_joints",
    "time_joints",
    "to_trajectory",
]
