"""What a plan leaves of its limits and distances: facts for the one who reads an answer. SI."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, slots=True)
class JointPeak:
    """Peaks of one joint over the plan (exact extrema, SI) and their ratios to the limits; no jerk: it is unbounded."""

    joint: str
    velocity: float
    acceleration: float
    jerk: float | None
    velocity_ratio: float
    acceleration_ratio: float
    jerk_ratio: float | None


@dataclass(frozen=True, slots=True)
class Nearest:
    """Where the arm comes closest to something, less contacts: `gap_m` is proved not to exceed the distance of any pair
    at any time; `distance_m` is that of `bodies` at `time`, larger by 0.05 mm at most."""

    gap_m: float
    time: float
    bodies: tuple[str, str]
    phase: str
    distance_m: float


@dataclass(frozen=True, slots=True)
class Contact:
    """An allowed contact and the time for which it is allowed."""

    bodies: tuple[str, str]
    t0: float
    t1: float


@dataclass(frozen=True, slots=True)
class Margins:
    """How much is left. `binds`: the joint and kind of limit that is used most. `parallel`: None without a loop.
    `jerk`: whether it has bounds."""

    peaks: tuple[JointPeak, ...]
    binds: str
    nearest: Nearest | None
    tool_acceleration: float
    tool_acceleration_limit: float | None
    singularity: float
    parallel: float | None = None
    jerk: Literal["limited", "unbounded"] = "limited"
