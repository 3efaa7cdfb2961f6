"""Writing the tables of a law (`assur.planner.kernels.law_columns`), and joining those of several."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.kernels import law_columns as c
from assur.planner.laws.law import Law

ROUNDING = 1e-14
"""Bounds are raised by this part of the sum of the terms of a polynomial: ten times its rounding."""


@dataclass(frozen=True, slots=True)
class Repeat:
    """A period begins at `start`, s, and lasts `period`; coordinates (4,) have gone on by `step` after it. `whole`: the
    yaw by whole turns."""

    start: float
    period: float
    step: Sequence[float] | FloatArray
    whole: bool = False


def tables(
    begins: Sequence[float] | FloatArray,
    poses: FloatArray,
    rates: FloatArray,
    powers: FloatArray,
    end: float = math.inf,
    *,
    turns: bool,
    corners: Sequence[float] = (),
    waves: Sequence[tuple[int, float, float, float]] = (),
    repeat: Repeat | None = None,
    line: Sequence[float] = (0.0, 0.0, 0.0),
) -> tuple[FloatArray, FloatArray]:
    """Row and side table of a law of K pieces that begin at `begins` (K,), the last of them until `end`, with `poses`
    and `rates` (K, 4) then and the powers (K, 4, P) of their accelerations.

    `turns`: whether the yaw may change. `corners`: of a first piece whose accelerations are no linear functions.
    `waves`: coordinate, amplitude, rate and phase of each sine. `line` (3,): the only line along which it travels.
    """
    count, shape = len(begins), np.asarray(powers)
    used = np.flatnonzero(shape.any(axis=(0, 1)))
    row, side = np.zeros(c.LAW_COLUMNS), np.zeros((count + len(waves), c.PIECE_COLUMNS))
    row[[c.COUNT, c.WAVE, c.WAVES, c.TURNS]] = count, count, len(waves), turns
    row[c.POWERS] = used[-1] + 1 if len(used) else 0
    yaw = float(poses[0][3])
    row[c.COS : c.SIN + 1] = math.cos(yaw), math.sin(yaw)
    row[c.LINE : c.LINE + 3], row[c.AXIS] = line, np.argmax(np.abs(line))
    if repeat is not None:
        row[[c.START, c.PERIOD, c.WHOLE]] = repeat.start, repeat.period, repeat.whole
        row[c.STEP : c.STEP + 4], end = repeat.step, repeat.period
    pieces = side[:count]
    pieces[:, c.PIECE_BEGIN], pieces[:, c.PIECE_END] = begins, np.append(begins[1:], end)
    pieces[:, c.POSE : c.POSE + 4], pieces[:, c.RATE : c.RATE + 4] = poses, rates
    pieces[:, c.POWER :].reshape(count, 4, c.MOST_POWERS)[:, :, : shape.shape[2]] = shape
    pieces[:, c.CORNER : c.CORNER + c.CORNERS] = math.inf
    if row[c.POWERS] == 2.0:
        constant, linear = shape[:, :, 0], shape[:, :, 1]
        found = np.divide(-constant, linear, out=np.full(constant.shape, math.inf), where=linear != 0.0)
        pieces[:, c.CORNER : c.CORNER + 4] = found
    pieces[0, c.CORNER : c.CORNER + len(corners)] = corners
    for k, wave in enumerate(waves):
        side[count + k, : len(wave)] = wave
    row[c.SLACK : c.SLACK + 4] = ROUNDING * _largest(pieces[:, c.PIECE_END] - pieces[:, c.PIECE_BEGIN], rates, shape)
    return row, side


def _largest(lasts: FloatArray, rates: FloatArray, powers: FloatArray) -> FloatArray:
    """(4,): the greatest sums of the terms of speed, acceleration, yaw rate and yaw acceleration."""
    speed, acceleration = np.abs(rates), np.zeros(np.shape(rates))
    h = np.where(np.isfinite(lasts), lasts, 0.0)[:, None]  # a piece without an end is at constant speed
    for n in range(powers.shape[2]):
        size = np.abs(powers[:, :, n]) * h**n
        acceleration, speed = acceleration + size, speed + size * h / (n + 1)
    travel = [rate[:, :3].sum(axis=1).max() for rate in (speed, acceleration)]  # no squares: they might underflow
    return np.array([*travel, speed[:, 3].max(), acceleration[:, 3].max()])


def law_tables(laws: Sequence[Law]) -> tuple[FloatArray, FloatArray]:
    """Rows of laws (F, `LAW_COLUMNS`) and their common side table (R, `PIECE_COLUMNS`)."""
    rows, above = np.zeros((len(laws), c.LAW_COLUMNS)), 0
    for row, law in zip(rows, laws, strict=True):
        row[:] = law.row
        row[[c.BEGIN, c.WAVE]] += above
        above += len(law.side)
    return rows, np.concatenate([np.zeros((0, c.PIECE_COLUMNS)), *(law.side for law in laws)])
