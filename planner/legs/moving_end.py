"""The end of a straight part at which the tool does not stop."""

from __future__ import annotations

from dataclasses import dataclass

from assur.planner.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class MovingEnd:
    """Motion along the vertical of the point at the outer end of an approach or depart.

    `height` above the point, m; its `rate`, m/s, upwards positive, and `acceleration`, m/s²; `far`: the height, m, at
    which the motion that was cut there stops; `profile`: the heights from there to rest at the point, or back.
    """

    height: float
    rate: float
    acceleration: float
    far: float
    profile: Trajectory
