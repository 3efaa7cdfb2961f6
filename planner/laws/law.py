"""A frame of the cell and its law: polynomial pieces of time, sines and a period, made of the numbers of the request.

`assur.planner.kernels.law_columns` names the columns of the tables. The kind of a law is a word for modules that read
requests; every computation reads the tables.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.errors import InputError
from assur.planner.frames.motion import Motion, Pose, Sweep
from assur.planner.kernels import law_columns as c
from assur.planner.laws.ramps import Change
from assur.planner.laws.validity import FURTHEST_S, interval
from assur.planner.robots.robot import Robot
from assur.planner.trajectory import Trajectory

# The other robot in the cell: a link of an arm that runs a plan made earlier.


@dataclass(frozen=True, eq=False)
class ArmLink:
    """Link number `link` of `robot`, which follows `trajectory` and is at rest before and after it (equation F6)."""

    robot: Robot
    trajectory: Trajectory
    link: int

    def motion(self, t: FloatArray, known: BoolArray) -> Motion:
        """Pose and three derivatives at times `t` (...), s; NaN where `known` (...) is false."""
        path = self.trajectory
        held = np.minimum(np.maximum(np.where(known, t, path.start), path.start), path.end)
        q, qd, qdd, qddd = (path.evaluate(held, derivative) for derivative in range(4))
        # At rest the first three are zero by themselves; the jerk is not, it jumps.
        moving = (path.start <= t) & (t < path.end)
        moved = self.robot.link_motion(self.link, q, qd, qdd, np.where(moving[..., None], qddd, 0.0))
        return Motion(np.where(known[..., None, None], moved.table, math.nan))


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
    the side table counted from 0. Raises `InputError` for a `valid` that is no interval.
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
    is_fixed: bool = field(init=False, repr=False, compare=False)
    """Whether the frame never moves."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "valid", interval(self.valid, f"{self.kind}.valid"))
        row = self.row.copy()
        row[c.FIRST], row[c.LAST] = max(self.valid[0], -FURTHEST_S), min(self.valid[1], FURTHEST_S)
        object.__setattr__(self, "row", row)
        object.__setattr__(self, "is_fixed", self.kind == "fixed")

    def __hash__(self) -> int:
        # a few of the numbers tell laws apart; what is kept of laws is looked up often
        return hash((self.kind, self.numbers.pose, self.valid))

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
        table = np.empty((*t.shape, 4, 4))
        frame_motions(self.row, self.side, np.ascontiguousarray(t.ravel()), table.reshape(-1, 4, 4))
        return Motion(table)

    def sweep(self, t0: float, t1: float) -> Sweep:
        """How the frame moves over the closed interval [t0, t1], s (K44)."""
        from assur.planner.kernels.jets import JET_COLUMNS, JETS
        from assur.planner.kernels.laws import sweep_frame

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
    return not [frame for frame in frames if not frame.law.is_fixed]


# How far what is on a frame goes in the time for which its law is evaluated: numbers of that size are what rounds.
#
# A law that has run for T seconds at up to V m/s is a sum of terms of up to V T. Each rounds by 2^-53 of that, so far
# from the time at which a frame's pose is stated, or from time zero, its place is known less well than proofs need.

FARTHEST_WAY_M = 200_000.0
"""Greatest way V T, m: eighteen roundings of it are 0.4 nm (docs/guarantees.md, "Rounding"). A dial of 600 mm at one
turn a second goes so far in 29 hours."""
FARTHEST_PLACE_M = 10_000.0
"""How far a body may be from the origin of the frame that bears it, m: forty roundings of it are 0.05 nm. Coordinates
are 100 m at most, but frames may be fixed on frames."""


def way(law: Law, reach: float, begin: float, end: float) -> float:
    """The way V T, m, of a point within `reach` m of a frame's vertical axis: at up to V the law runs from the instant
    at which it is stated, or time zero, to the farthest of two instants, s."""
    at = law.stated_s
    speed = law.fastest[0] + reach * law.fastest[1]
    return speed * max(abs(at), abs(begin), abs(begin - at), abs(end), abs(end - at))


def check_rounding(field: str, law: Law, reach: float, begin: float, lasts: float) -> None:
    """Raises `InputError` naming `field` for a body that reaches so far, m, from its frame's origin that it is beyond
    `FARTHEST_PLACE_M`, or that goes farther than `FARTHEST_WAY_M` in a plan that begins at `begin`, s, and lasts so
    long, s, at least."""
    if not reach <= FARTHEST_PLACE_M:
        allowed = (
            f"bodies within {FARTHEST_PLACE_M:g} m of the frame's origin, frames that are fixed on it counted along; "
            f"one is {reach:.6g} m from it (a conveyor that has run for so long is stated for a later time, by its "
            f"at_s)"
        )
        raise InputError(field, reach, allowed)
    far = way(law, reach, begin, begin + lasts)
    if far <= FARTHEST_WAY_M:
        return
    speed, since = law.fastest[0] + reach * law.fastest[1], law.stated_s
    allowed = (
        f"a way of at most {FARTHEST_WAY_M:g} m, speed times time (numbers of a longer way round by more than a proof "
        f"allows for): what is on the frame moves at up to {speed:.6g} m/s, its pose is stated at {since:g} s, and the "
        f"plan is from {begin:g} s to {begin + lasts:g} s at least"
    )
    raise InputError(field, far, allowed)


# Writing the tables of a law (`assur.planner.kernels.law_columns`), and joining those of several.

ROUNDING = 1e-14
"""Bounds are raised by this part of the sum of the terms of a polynomial: ten times its rounding."""
NO_CURVE = (math.inf,) * c.CORNERS + (0.0,) * (4 * c.MOST_POWERS)
"""The columns of a piece at constant speed behind its rates."""


Piece = tuple[float, Sequence[float], Sequence[float], Sequence[Sequence[float]]]
"""When a piece begins; x, y, z and yaw then, and their rates; the powers of their accelerations, or nothing."""


@dataclass(frozen=True, slots=True)
class Repeat:
    """A period begins at `start`, s, and lasts `period`; coordinates (4,) have gone on by `step` after it. `whole`: the
    yaw by whole turns."""

    start: float
    period: float
    step: Sequence[float]
    whole: bool = False


def tables(
    pieces: Sequence[Piece],
    end: float = math.inf,
    *,
    turns: bool,
    corners: Sequence[float] = (),
    waves: Sequence[tuple[int, float, float, float]] = (),
    repeat: Repeat | None = None,
    line: Sequence[float] = (0.0, 0.0, 0.0),
) -> tuple[FloatArray, FloatArray]:
    """Row and side table of a law of these pieces, the last of them until `end`, s.

    `turns`: whether the yaw may change. `corners`: of pieces whose accelerations have more than two powers. `waves`:
    coordinate, amplitude, rate and phase of each sine. `line` (3,): the only line along which the frame travels.
    """
    # plain Python: most laws have one piece
    row, side, most, yaw = [0.0] * c.LAW_COLUMNS, list[list[float]](), 0, pieces[0][1][3]
    ends = [*[piece[0] for piece in pieces[1:]], end if repeat is None else repeat.period]
    row[c.COUNT] = row[c.WAVE] = len(pieces)
    row[c.WAVES], row[c.COS], row[c.SIN] = len(waves), math.cos(yaw), math.sin(yaw)
    along = [*map(abs, line)]
    row[c.LINE : c.LINE + 3], row[c.AXIS] = line, along.index(max(along))
    if repeat is not None:
        row[c.START : c.WHOLE + 1] = repeat.start, repeat.period, *repeat.step, repeat.whole
    for (begin, pose, rates, powers), until in zip(pieces, ends, strict=True):
        for k in range(3):
            if rates[k] != 0.0 or (powers and any(powers[k])):
                row[c.MOVES + k] = 1.0
        if not powers:
            # at constant speed
            side.append([begin, until, *pose, *rates, *NO_CURVE])
            row[c.SLACK] = max(row[c.SLACK], ROUNDING * sum(map(abs, rates[:3])))
            row[c.SLACK + 2] = max(row[c.SLACK + 2], ROUNDING * abs(rates[3]))
            continue
        curved = any(len(way) > 2 for way in powers)
        turning = corners if curved else [-way[0] / way[1] for way in powers if len(way) == 2 and way[1] != 0.0]
        side.append([begin, until, *pose, *rates, *turning, *[math.inf] * (c.CORNERS - len(turning))])
        for way in powers:
            side[-1] += [*way, *[0.0] * (c.MOST_POWERS - len(way))]
            most = max(most, len(way))
        sizes = [_largest(rate, way, until - begin) for rate, way in zip(rates, powers, strict=True)]
        for n in range(2):
            row[c.SLACK + n] = max(row[c.SLACK + n], ROUNDING * sum(size[n] for size in sizes[:3]))
            row[c.SLACK + 2 + n] = max(row[c.SLACK + 2 + n], ROUNDING * sizes[3][n])
    for k, *_ in waves:
        if k < 3:
            row[c.MOVES + k] = 1.0
    row[c.TURNS], row[c.POWERS] = turns, most
    side += [[*wave, *[0.0] * (c.PIECE_COLUMNS - len(wave))] for wave in waves]
    return np.array(row), np.array(side)


def _largest(rate: float, way: Sequence[float], lasts: float) -> tuple[float, float]:
    """The sums of the terms of velocity and acceleration of a coordinate over a piece. One without an end is at
    constant speed."""
    speed, acceleration = abs(rate), 0.0
    for n, a in enumerate(way):
        size = abs(a) * lasts**n
        speed, acceleration = speed + size * lasts / (n + 1), acceleration + size
    return speed, acceleration


def law_tables(laws: Sequence[Law]) -> tuple[FloatArray, FloatArray]:
    """Rows of laws (F, `LAW_COLUMNS`) and their common side table (R, `PIECE_COLUMNS`)."""
    rows, above = np.zeros((len(laws), c.LAW_COLUMNS)), 0
    for row, law in zip(rows, laws, strict=True):
        row[:] = law.row
        row[[c.BEGIN, c.WAVE]] += above
        above += len(law.side)
    return rows, np.concatenate([np.zeros((0, c.PIECE_COLUMNS)), *(law.side for law in laws)])
