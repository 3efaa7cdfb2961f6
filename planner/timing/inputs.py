"""What the solver is given, made legal: finite vectors of one length, states within limits, limits lowered."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError

JERK_RESERVE = 0.02
"""Fraction of the jerk limit that the solver does not get: merged switches and rounding took up to 0.006 in
150,000 random motions (see `kernels.knots`)."""
RATE_RESERVE = 1e-3
"""Fraction of the velocity and acceleration limits that the solver does not get, likewise."""
LIMIT_TOLERANCE = 1e-9
"""Relative. States up to this beyond a limit count as at the limit: the tolerance of the trajectory's own check."""

Reason = Literal["limits", "too short", "blocked", "too long", "no profile", "unsound"]


@dataclass(frozen=True, slots=True)
class TimingRefusal:
    """Why there is no motion as asked.

    limits      a given state is, or will inevitably come, beyond a limit; `excess` relative to it
    too short   the earliest motion takes `excess` seconds longer than asked
    blocked     shorter motions exist, but the next possible duration is `excess` seconds above the one asked
    too long    it takes more than `LONGEST`; `excess` in seconds
    no profile  the solver found none for a legal problem; `excess` is NaN
    unsound     its profile does not end where it should; `excess` is how far, in units of what is allowed
    """

    reason: Reason
    excess: float
    detail: str


@dataclass(frozen=True, slots=True)
class Limits:
    """What the solver is given, n numbers each: the most and the least velocity and acceleration, and the jerk."""

    velocity: list[float]
    backward: list[float]
    acceleration: list[float]
    braking: list[float]
    jerk: list[float]


@dataclass(frozen=True, slots=True)
class Allowed:
    """The robot's own limits, n finite positive numbers each, and `lowered`: what the solver gets of them at least.

    Raises `InputError` for limits that are none, or of different length.
    """

    velocity: list[float]
    acceleration: list[float]
    jerk: list[float]
    lowered: Limits = field(init=False)

    def __post_init__(self) -> None:
        accepted(LIMIT_NAMES, (self.velocity, self.acceleration, self.jerk), len(self.velocity))
        for name, row in zip(LIMIT_NAMES, (self.velocity, self.acceleration, self.jerk), strict=True):
            if not min(row) > 0:
                raise InputError(f"timing.{name}", row, "positive limits")
        velocity = [v * (1 - RATE_RESERVE) for v in self.velocity]
        acceleration = [a * (1 - RATE_RESERVE) for a in self.acceleration]
        jerk = [j * (1 - JERK_RESERVE) for j in self.jerk]
        lowered = Limits(velocity, [-v for v in velocity], acceleration, [-a for a in acceleration], jerk)
        object.__setattr__(self, "lowered", lowered)


STATE_NAMES = ("q0", "v0", "a0", "q1", "v1", "a1")
LIMIT_NAMES = ("velocity", "acceleration", "jerk")

Row = list[float]
Numbers = tuple[Row, Row, Row]
"""q, q̇, q̈, n numbers each: for four joints NumPy takes three times as long."""


def numbers(arguments: Sequence[FloatArray]) -> list[Row]:
    """Vectors as lists, of one length; `InputError` naming the one that is none. `arguments`: states, then limits."""
    rows: list[Row] = []
    for name, argument in zip((*STATE_NAMES, *LIMIT_NAMES), arguments, strict=True):
        row = np.asarray(argument, dtype=np.float64)
        if row.ndim != 1 or len(row) != len(rows[0] if rows else row) or not len(row):
            raise InputError(f"timing.{name}", argument, f"a vector of {len(rows[0]) if rows else 'some'} numbers")
        rows.append(row.tolist())
    return rows


def accepted(names: Sequence[str], rows: Sequence[Row], n: int) -> None:
    """Accepts rows of n finite numbers each; `InputError` naming the first that is not."""
    # a sum is finite only if every number is
    if n > 0 and all(len(row) == n for row in rows) and math.isfinite(sum(map(sum, rows))):
        return
    for name, row in zip(names, rows, strict=True):
        if not (len(row) == n > 0 and math.isfinite(sum(row))):
            raise InputError(f"timing.{name}", row, f"{n or 'some'} finite numbers")


def accepted_duration(duration: float | None) -> None:
    """Accepts None and a number of seconds from 0; `InputError` otherwise."""
    if duration is not None and not (math.isfinite(duration) and duration >= 0):
        raise InputError("timing.duration", duration, "None, or a number of seconds from 0")


def lowered_limits(start: Numbers, goal: Numbers, allowed: Allowed) -> Limits | TimingRefusal:
    """Limits for the solver: lowered, but never below what the end states need, each direction by itself.

    A state with acceleration a comes to the velocity v ± a|a|/(2j) whatever one does (equation P2: + after the start,
    − before the goal). A state that needs the whole jerk limit for that gets it.
    """
    (_, v0, a0), (_, v1, a1), usual = start, goal, allowed.lowered
    if not (any(v0) or any(a0) or any(v1) or any(a1)):
        return usual
    states = zip(v0, a0, v1, a1, usual.velocity, usual.acceleration, usual.jerk, strict=True)
    ease = [_at_ease(*joint) for joint in states]
    if all(ease):
        return usual
    out = Limits([], [], [], [], [])
    for i, (v, a, j) in enumerate(zip(allowed.velocity, allowed.acceleration, allowed.jerk, strict=True)):
        if ease[i]:
            out.velocity.append(usual.velocity[i])
            out.backward.append(usual.backward[i])
            out.acceleration.append(usual.acceleration[i])
            out.braking.append(usual.braking[i])
            out.jerk.append(usual.jerk[i])
            continue
        need_a = (0.0, a0[i], a1[i])
        worst = max(map(abs, need_a))
        if not worst <= a * (1 + LIMIT_TOLERANCE):
            return TimingRefusal("limits", worst / a - 1, f"joint {i}: acceleration {worst}, limit {a}")
        for lowered_j in (usual.jerk[i], j):
            after = v0[i] + a0[i] * abs(a0[i]) / (2 * lowered_j)
            before = v1[i] - a1[i] * abs(a1[i]) / (2 * lowered_j)
            need_v = (0.0, v0[i], v1[i], after, before)
            worst = max(map(abs, need_v))
            if worst <= v * (1 + LIMIT_TOLERANCE):
                break
        else:
            return TimingRefusal("limits", worst / v - 1, f"joint {i}: velocity comes to {worst}, limit {v}")
        # The solver compares without tolerance: a few roundings more than is needed.
        lowered_v, lowered_a = usual.velocity[i], usual.acceleration[i]
        out.velocity.append(max(lowered_v, max(need_v) * (1 + 1e-14)))
        out.backward.append(min(-lowered_v, min(need_v) * (1 + 1e-14)))
        out.acceleration.append(max(lowered_a, max(need_a) * (1 + 1e-14)))
        out.braking.append(min(-lowered_a, min(need_a) * (1 + 1e-14)))
        out.jerk.append(lowered_j)
    return out


def _at_ease(v0: float, a0: float, v1: float, a1: float, v: float, a: float, j: float) -> bool:
    """Whether both states, and what they lead to (equation P6), are within the lowered limits: nearly always."""
    if not (-a <= a0 <= a and -a <= a1 <= a and -v <= v0 <= v and -v <= v1 <= v):
        return False
    return -v <= v0 + a0 * abs(a0) / (2 * j) <= v and -v <= v1 - a1 * abs(a1) / (2 * j) <= v
