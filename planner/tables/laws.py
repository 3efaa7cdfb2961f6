"""The time laws of frames as tables: one row a frame, and a side table for what is more than a row.

Columns of `assur.planner.kernels.laws`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from assur.planner.frames import (
    Conveyor,
    Fixed,
    Indexer,
    Keyframes,
    Law,
    Linear,
    Oscillation,
    Pose,
    Swing,
    Turntable,
)
from assur.planner.frames.profile import Profile
from assur.planner.frames.validity import FURTHEST_S
from assur.planner.kernels import laws as of
from assur.planner.model.link_frames import TrajectoryLaw

ROUNDING = 1e-13
"""Bounds are raised by this part of a law's largest speed or acceleration, for the rounding of its polynomials."""


def law_tables(laws: Sequence[Law]) -> tuple[FloatArray, FloatArray]:
    """Rows of laws (F, `LAW_COLUMNS`) and their side table (R, `PIECE_COLUMNS`), in SI units.

    Raises `FaultError` for a law that the kernels do not know.
    """
    rows = np.zeros((len(laws), of.LAW_COLUMNS))
    pieces: list[FloatArray] = []
    for row, law in zip(rows, laws, strict=True):
        begin = sum(len(part) for part in pieces)
        row[of.FIRST], row[of.LAST] = max(law.valid[0], -FURTHEST_S), min(law.valid[1], FURTHEST_S)
        part = _fill(row, law, begin)
        if part is not None:
            pieces.append(part)
    return rows, np.concatenate([np.zeros((0, of.PIECE_COLUMNS)), *pieces])


def _fill(row: FloatArray, law: Law, begin: int) -> FloatArray | None:
    """Fills the row of a law, and returns its rows of the side table, which will be at `begin`."""
    match law:
        case Fixed():
            row[of.KIND] = of.FIXED
            _pose(row, law.pose)
            return None
        case Linear():
            row[of.KIND], row[of.AT] = of.LINEAR, law.at_time
            _pose(row, law.pose)
            row[of.VX : of.VZ + 1] = law.velocity
            return None
        case Conveyor():
            row[of.KIND] = of.TRAVEL
            _pose(row, law.pose)
            _own_x(row)
            return _ramps(row, law.drive, begin)
        case Turntable():
            row[of.KIND], row[of.AT], row[of.VZ] = of.TURN, law.at_time, law.rise
            _pose(row, law.pose)
            return _ramps(row, law.drive, begin)
        case Indexer():
            row[of.KIND], row[of.DRIVE] = of.TURN if law.kind == "turn" else of.TRAVEL, of.INDEX
            _pose(row, law.pose)
            if law.kind == "travel":
                _own_x(row)
            row[of.STEP : of.START + 1] = law.step, law.move_s, law.period, law.start
            return None
        case Swing():
            row[of.KIND] = of.TURN
            _sine(row, law)
            return None
        case Oscillation():
            row[of.KIND] = of.TRAVEL
            row[of.VX : of.VZ + 1] = law.along
            _sine(row, law)
            return None
        case Keyframes():
            return _keyframes(row, law, begin)
        case TrajectoryLaw():
            return _neighbour(row, law, begin)
    raise FaultError(f"no table for a law of type {type(law).__name__}")


def _pose(row: FloatArray, pose: Pose) -> None:
    row[of.X : of.SIN + 1] = pose.x, pose.y, pose.z, pose.yaw, math.cos(pose.yaw), math.sin(pose.yaw)


def _own_x(row: FloatArray) -> None:
    """The frame travels along its own x axis."""
    row[of.VX : of.VZ + 1] = row[of.COS], row[of.SIN], 0.0


def _sine(row: FloatArray, law: Swing | Oscillation) -> None:
    row[of.DRIVE] = of.SWING
    _pose(row, law.pose)
    row[of.AMPLITUDE : of.PHASE + 1] = law.amplitude, 2.0 * math.pi / law.period, law.phase


def _ramps(row: FloatArray, profile: Profile, begin: int) -> FloatArray:
    """Pieces of cubics; the first and the last reach to infinity and are linear."""
    table = np.zeros((len(profile.coefficients), of.PIECE_COLUMNS))
    table[:, 0] = [profile.first, *profile.switches]
    table[:, 1:5] = profile.coefficients
    h = np.diff(table[:, 0], append=table[-1, 0])
    c1, c2, c3 = np.abs(table[:, 2:5]).T
    row[of.DRIVE], row[of.BEGIN], row[of.COUNT] = of.RAMPS, begin, len(table)
    row[of.SLACK] = ROUNDING * (c1 + 2.0 * c2 * h + 3.0 * c3 * h * h).max()
    row[of.SLACK + 1] = ROUNDING * (2.0 * c2 + 6.0 * c3 * h).max()
    return table


def _keyframes(row: FloatArray, law: Keyframes, begin: int) -> FloatArray:
    """A row a piece, by coordinates, and one with the end."""
    count = len(law.coefficients)
    table = np.zeros((count + 1, of.PIECE_COLUMNS))
    table[:, 0] = law.knots
    table[:-1, 1:] = law.coefficients.transpose(0, 2, 1).reshape(count, 16)
    row[of.KIND], row[of.BEGIN], row[of.COUNT] = of.KEYFRAMES, begin, count
    row[of.SLACK : of.SLACK + 4] = law.slack
    if law.period:
        row[of.AT], row[of.REPEAT_S] = law.times[0], law.period
    return table


def _neighbour(row: FloatArray, law: TrajectoryLaw, begin: int) -> FloatArray:
    """Robot, rate matrix and spline as one run of numbers (`kernels.laws.trajectory_of`)."""
    spline = law.spline
    parts = (law.robot.row, spline.matrix, spline.tk, spline.c, spline.whole)
    run = np.concatenate([part.ravel() for part in parts])
    row[of.KIND], row[of.LINK] = of.NEIGHBOUR, law.link
    row[of.BEGIN], row[of.COUNT], row[of.RATES] = begin, len(spline.c), len(spline.matrix)
    table = np.zeros((math.ceil(run.size / of.PIECE_COLUMNS), of.PIECE_COLUMNS))
    table.ravel()[: run.size] = run
    return table
