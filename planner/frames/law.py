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
    """How far a frame may be from its law: `position_m` always, and `speed_m_s` times the time since it was seen.

    `shift_s`: how much earlier, and how much later, the whole motion of the frame may be, s. It is common to all that
    sits in the frame.
    """

    position_m: float = 0.0
    speed_m_s: float = 0.0
    shift_s: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True)
class Frame:
    """A named frame of the cell."""

    name: str
    law: Law
    uncertainty: Uncertainty = Uncertainty()
