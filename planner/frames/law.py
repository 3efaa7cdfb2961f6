"""What a time law must give, and a frame: a law with a name and an uncertainty."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Motion


class Law(Protocol):
    """A frame's pose as a function of time, known over `valid` (seconds) and nowhere else."""

    @property
    def valid(self) -> tuple[float, float]:
        """First and last time at which the law is known (may be -inf, inf)."""
        ...

    def motion(self, t: FloatArray) -> Motion:
        """Pose and three derivatives at times `t` (...). Outside `valid`: NaN in every field of that row."""
        ...


@dataclass(frozen=True, slots=True)
class Uncertainty:
    """How far a frame may be from its law; it is common to all that sits in the frame.

    `position_m`, and `speed_m_s` times the time since the start: of a frame that travels along a line (a belt) along
    that line, of any other in every horizontal direction. `lateral_m`: of a belt, across it. `vertical_m`. `yaw_rad`:
    about the frame's origin. `shift_s`: by how much, at least and at most, the whole motion of the frame is late, s.
    """

    position_m: float = 0.0
    speed_m_s: float = 0.0
    lateral_m: float = 0.0
    vertical_m: float = 0.0
    yaw_rad: float = 0.0
    shift_s: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True, slots=True)
class PoseUncertainty:
    """How far a part may be from its pose: in every horizontal direction, up or down, and about its own vertical."""

    position_m: float = 0.0
    vertical_m: float = 0.0
    yaw_rad: float = 0.0


EXACT = PoseUncertainty()
"""Of a pose that is known."""


@dataclass(frozen=True)
class Frame:
    """A named frame of the cell."""

    name: str
    law: Law
    uncertainty: Uncertainty = Uncertainty()
