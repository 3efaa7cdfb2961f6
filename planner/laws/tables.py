"""Writing the tables of a law (`assur.planner.kernels.columns.laws`), and joining those of several."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.kernels.columns import laws as c
from assur.planner.laws.law import Law

ROUNDING = 1e-14
"""Bounds are raised by this part of the sum of the terms of a polynomial: ten times its rounding."""


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
    ends = [*(begin for begin, *_ in pieces[1:]), end if repeat is None else repeat.period]
    row[c.COUNT] = row[c.WAVE] = len(pieces)
    row[c.WAVES], row[c.COS], row[c.SIN] = len(waves), math.cos(yaw), math.sin(yaw)
    row[c.LINE : c.LINE + 3], row[c.AXIS] = line, max(range(3), key=lambda k: abs(line[k]))
    if repeat is not None:
        row[c.START : c.WHOLE + 1] = repeat.start, repeat.period, *repeat.step, repeat.whole
    for (begin, pose, rates, powers), until in zip(pieces, ends, strict=True):
        curved = any(len(way) > 2 for way in powers)
        turning = corners if curved else [-way[0] / way[1] for way in powers if len(way) == 2 and way[1] != 0.0]
        side.append([begin, until, *pose, *rates, *turning, *[math.inf] * (c.CORNERS - len(turning))])
        for way in powers or ((),) * 4:
            side[-1] += [*way, *[0.0] * (c.MOST_POWERS - len(way))]
            most = max(most, len(way))
        sizes = [_largest(rate, way, until - begin) for rate, way in zip(rates, powers or ((),) * 4, strict=True)]
        for n in range(2):
            row[c.SLACK + n] = max(row[c.SLACK + n], ROUNDING * sum(size[n] for size in sizes[:3]))
            row[c.SLACK + 2 + n] = max(row[c.SLACK + 2 + n], ROUNDING * sizes[3][n])
    for k in range(3):
        moving = any(rates[k] != 0.0 or (powers and any(powers[k])) for _, _, rates, powers in pieces)
        row[c.MOVES + k] = moving or any(wave[0] == k for wave in waves)
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
