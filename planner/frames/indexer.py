"""A dial or a chain that moves on by a step, waits, and moves on again."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal, get_args

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.frames.conveyor import travelling
from assur.planner.frames.motion import Motion, Pose
from assur.planner.frames.profile import Profile, chained
from assur.planner.frames.turntable import turning
from assur.planner.frames.validity import ALWAYS, FURTHEST_S, KnownLaw, interval, number, placed, span

Kind = Literal["turn", "travel"]

STEP = (0.0, 0.0, 0.0, 35.0, -84.0, 70.0, -20.0)
"""Coefficients of u, u², ... u⁷ of the step's law, see `Indexer`."""


@dataclass(frozen=True)
class Indexer(KnownLaw):
    """A frame that moves by `step` in `move_s`, stands for `dwell_s`, and so on; at `start` a move begins from `pose`.

    It goes on for ever, before `start` too. Kind `turn`: in place about its origin, `step` in rad; `travel`: along
    its local x, `step` in m. The law of a move, u from 0 to 1 over `move_s`, is the polynomial of least degree that
    begins and ends with no velocity, no acceleration and no jerk (equation F3):

        x = step (35 u⁴ − 84 u⁵ + 70 u⁶ − 20 u⁷)

    Raises `InputError` for a kind that is not known, numbers that are not finite, or a time that is not positive
    (the dwell may be zero).
    """

    pose: Pose
    step: float
    move_s: float
    dwell_s: float
    kind: Kind = "turn"
    start: float = 0.0
    valid: tuple[float, float] = ALWAYS
    _cycle: Profile = field(init=False, repr=False, compare=False)
    _along: FloatArray = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        if self.kind not in get_args(Kind):
            raise InputError("indexer.kind", self.kind, f"one of {get_args(Kind)}")
        object.__setattr__(self, "pose", placed(self.pose, "indexer.pose"))
        object.__setattr__(self, "step", number(self.step, "indexer.step"))
        object.__setattr__(self, "move_s", span(self.move_s, "indexer.move_s"))
        object.__setattr__(self, "dwell_s", number(self.dwell_s, "indexer.dwell_s", 0.0, FURTHEST_S))
        object.__setattr__(self, "start", number(self.start, "indexer.start", -FURTHEST_S, FURTHEST_S))
        object.__setattr__(self, "valid", interval(self.valid, "indexer.valid"))
        move = tuple(self.step * c / self.move_s ** (k + 1) for k, c in enumerate(STEP))
        object.__setattr__(self, "_cycle", chained((0.0, self.move_s), ((), move, ()), 0.0))
        object.__setattr__(self, "_along", np.array([math.cos(self.pose.yaw), math.sin(self.pose.yaw), 0.0]))

    @property
    def period(self) -> float:
        """From the begin of a move to the begin of the next, s."""
        return self.move_s + self.dwell_s

    def _motion(self, t: FloatArray, /) -> Motion:
        turns, local = reduced(t, self.start, self.period)
        x, xd, xdd, xddd = self._cycle.evaluate(local)
        moved = (x + turns * self.step, xd, xdd, xddd)
        return turning(self.pose, moved) if self.kind == "turn" else travelling(self.pose, self._along, moved)


def reduced(t: FloatArray, start: float, period: float) -> tuple[FloatArray, FloatArray]:
    """Number of whole periods since `start` (...), and the time since the last of them began (...)."""
    since = t - start
    whole = np.floor(since / period)
    return whole, since - whole * period
