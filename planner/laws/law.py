"""A frame of the cell and its law: polynomial pieces of time, sines and a period, made of the numbers of the request.

`assur.planner.kernels.columns.laws` names the columns of the tables. The kind of a law is a word for modules that read
requests; every computation reads the tables.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.frames.motion import Motion, Pose
from assur.planner.frames.sweep import Sweep
from assur.planner.kernels.columns import laws as c
from assur.planner.laws.links import ArmLink
from assur.planner.laws.ramps import Change
from assur.planner.laws.validity import FURTHEST_S

Kind = Literal[
    "fixed", "linear", "conveyor", "turntable", "indexer", "swing", "oscillation", "keyframes", "link"
]  # fmt: skip
Ends = Literal["natural", "clamped", "periodic"]


@dataclass(frozen=True)
class Numbers:
    """The numbers of a law as the request states them, in SI units; `assur.planner.laws.kinds` says which of them a
    kind has, and what they mean."""

    pose: Pose = Pose()
    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)
    speed: float = 0.0
    rate: float = 0.0
    rise: float = 0.0
    changes: tuple[Change, ...] = ()
    at_time: float = 0.0
    step: float = 0.0
    move_s: float = 0.0
    dwell_s: float = 0.0
    start: float = 0.0
    turns: bool = False
    """Of an indexer: it turns about its origin, and else travels along its x axis."""
    direction: tuple[float, float, float] = (0.0, 0.0, 0.0)
    amplitude: float = 0.0
    period: float = 0.0
    phase: float = 0.0
    times: tuple[float, ...] = ()
    poses: tuple[Pose, ...] = ()
    ends: Ends = "clamped"


@dataclass(frozen=True)
class Law:
    """A frame's pose as a function of time, known over `valid` (s) and nowhere else.

    Laws of the same numbers are equal. `row` (LAW_COLUMNS,) and `side` (R, PIECE_COLUMNS) are its tables, with rows of
    the side table counted from 0.
    """

    kind: Kind
    numbers: Numbers
    valid: tuple[float, float]
    row: FloatArray = field(repr=False, compare=False)
    side: FloatArray = field(repr=False, compare=False)
    way: tuple[float, float, float] | None = field(default=None, compare=False)
    """The unit vector, in the frame's own axes, along which windows in metres are measured; None: there is none."""
    fastest: tuple[float, float] = field(default=(0.0, 0.0), compare=False)
    """Upper bounds of its speed, m/s, and of its yaw rate, rad/s; 0 for what is given by instants that are exact:
    keyframes, and links."""
    stated_s: float = field(default=0.0, compare=False)
    """The instant from which it counts, s."""
    cycle_s: float | None = field(default=None, compare=False)
    """After how many seconds the frame is where it was, again and again; None: never, or that is not known."""
    link: ArmLink | None = None
    """What the frame is, if it is a link of another robot."""

    def __post_init__(self) -> None:
        row = self.row.copy()
        row[c.FIRST], row[c.LAST] = max(self.valid[0], -FURTHEST_S), min(self.valid[1], FURTHEST_S)
        object.__setattr__(self, "row", row)

    @property
    def is_fixed(self) -> bool:
        """Whether the frame never moves."""
        return self.kind == "fixed"

    @property
    def line(self) -> FloatArray | None:
        """The unit vector (3,) along which the frame travels for ever, in the world; None: it has no such line. A belt
        at rest has one."""
        rests = self.kind == "linear" and self.fastest[0] == 0.0
        return None if self.way is None or rests else self.row[c.LINE : c.LINE + 3].copy()

    @property
    def yaw(self) -> float | None:
        """The yaw, rad, that the frame has at all times, known or not; None: it turns, or that is not known."""
        if self.row[c.TURNS] > 0.0 or self.link is not None:
            return None
        return float(self.side[0, c.POSE + 3])

    @property
    def changes_until(self) -> float:
        """When its last piece begins, s; minus infinity: it has one, or repeats."""
        count, repeats = int(self.row[c.COUNT]), self.row[c.PERIOD] > 0.0
        return -math.inf if count < 2 or repeats else float(self.side[count - 1, c.PIECE_BEGIN])

    def knows(self, t: FloatArray) -> BoolArray:
        """Whether the law is known at times `t` (...), s; NaN is no time."""
        return np.asarray((self.row[c.FIRST] <= t) & (t <= self.row[c.LAST]))

    def motion(self, t: FloatArray) -> Motion:
        """Pose and three derivatives at times `t` (...), s. NaN in all that belongs to a time outside `valid`. Where a
        derivative jumps, the later piece counts."""
        # the compiler is loaded when a motion is computed first, and not where requests are only read
        from assur.planner.kernels.laws import frame_motions

        t = np.asarray(t, dtype=np.float64)
        if self.link is not None:
            return self.link.motion(t, self.knows(t))
        vectors, angles = np.empty((4, t.size, 3)), np.empty((4, t.size))
        frame_motions(self.row, self.side, np.ascontiguousarray(t.ravel()), vectors, angles)
        return Motion(*vectors.reshape(4, *t.shape, 3), *angles.reshape(4, *t.shape))

    def sweep(self, t0: float, t1: float) -> Sweep:
        """How the frame moves over the closed interval [t0, t1], s (K44)."""
        from assur.planner.kernels.laws import sweep_frame
        from assur.planner.kernels.sweeps.chain import JETS
        from assur.planner.kernels.sweeps.jets import JET_COLUMNS

        jets = np.zeros((1, JETS, JET_COLUMNS))
        sweep_frame(self.row, self.side, t0, t1, jets, 0)
        return Sweep(jets[0])


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


def all_stand(frames: Iterable[Frame]) -> bool:
    """Whether none of the frames moves."""
    return all(frame.law.is_fixed for frame in frames)
