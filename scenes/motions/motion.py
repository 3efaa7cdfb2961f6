"""The motion of joints as a file has it, whichever way it is written."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from assur.planner.arrays import FloatArray
from assur.scenes.bounds import FAR_M, STRONG, TURNS_RAD

POSITION, VELOCITY, ACCELERATION = range(3)
STATES = ("positions", "velocities", "accelerations")
"""States of a joint by the order of their derivative, as ROS calls them."""
TIME = -1
"""In place of the order of a state: the time."""
Where = Callable[[int, int, int], tuple[str, int | None]]
"""(row, order of the state or `TIME`, joint) → what an error calls the place of this number, and its line."""


@dataclass(frozen=True, eq=False)
class Track:
    """A joint: its name in the file, its SI unit (None: rad or m, the file does not say), and its positions, velocities
    and accelerations (K,) in SI, None for those that the file does not have."""

    name: str
    unit: str | None
    states: tuple[FloatArray | None, FloatArray | None, FloatArray | None]


@dataclass(frozen=True, eq=False)
class Motion:
    """Times (K,), s, and joints. `relative`: the times count from the first row, of which the file has the time of day.

    `named`: what an error calls the names of the joints, and their line. `notes`: what was read otherwise than as it is
    written, or not read, in sentences.
    """

    time: FloatArray
    tracks: tuple[Track, ...]
    where: Where
    named: tuple[str, int | None]
    relative: bool = False
    notes: tuple[str, ...] = field(default=())


def largest(unit: str | None, order: int) -> float:
    """The largest amount of a state, SI: of positions in `unit` (None: rad or m), and of their derivatives."""
    if order != POSITION:
        return STRONG
    return FAR_M if unit == "m" else TURNS_RAD
