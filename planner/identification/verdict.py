"""What a record says about the limits of a joint, and what it cannot say.

A controller that is at its limit shows the same acceleration, and the same jerk, in moves of different lengths. So a
level counts as a limit if moves of different lengths reach it, none goes beyond it, and no other joint moves in
proportion, which might be the one that is at its limit. Anything else is a lower bound of the limit.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.identification.recording import LEAST_MOVED, JointRecord, Segment
from assur.planner.identification.scurve import SCurves
from assur.planner.identification.shared_jerk import SIGMAS, JerkFit, JerkRange, jerk_range, own_jerks

ACCEPTED_ACCELERATION, ACCEPTED_JERK = 0.05, 0.15
"""Relative errors up to which a limit counts as identified."""
ACCELERATION_ERROR, JERK_ERROR = 0.001, 0.005
"""Relative error of a limit that no reading lessens: rounding, and what the readings' errors are taken to be."""
LAG_ERROR = 0.25
"""Of what a lag changes in the jerk, the part that counts as error: a servo is not quite of first order."""
MOST_SEGMENTS = 8
"""So many segments are fitted, of all lengths."""
DISTINCT = 1.1
"""Ratio of the lengths of two moves that count as different ones."""
SAME_LENGTH = 0.01
"""Relative difference of lengths up to which a move is taken for another's repeat: their readings may have the same
errors of quantisation, so that repeating brings no more precision."""
CORRELATED = 0.25
"""Autocorrelation of residuals, beside its own error, above which S-curves are not what is in the readings."""
WORSE = 6.0
"""Mean square of residuals, over that of the readings' errors, above which they are not either."""
NEARLY = 0.003
"""Residual, of the length of the shortest move, up to which an S-curve that does not explain the readings still shows
for how long which acceleration is held."""
INFORMATIVE = 0.15
"""Standard deviation of the logarithm of a segment's own jerk up to which it can be compared."""
SAME_JERK, SAME_ACCELERATION = 0.005, 0.003
"""Relative differences of levels that are one, beside their errors."""
LEAST_HELD = 2.0
"""Sampling steps for which an acceleration is held at least where it counts as a plateau."""
PROPORTIONAL, MOST_SHIFT_S = 0.01, 0.02
"""Difference of the progress of two joints, of their whole way, up to which they move in proportion, one perhaps by so
much later."""

Status = Literal["identified", "lower_bound", "not_identifiable"]
Reason = Literal[
    "STILL", "NO_MOVES", "MISFIT", "UNCERTAIN", "NO_PLATEAU", "ONE_LENGTH", "IN_PROPORTION", "LEVELS", "ASYMMETRIC"
]


@dataclass(frozen=True, slots=True)
class Estimate:
    """A limit, SI. identified: within `error` of `value`; lower_bound: at least `value`, because of `reason`;
    not_identifiable: because of `reason`. `moves`: so many moves show it.

    STILL          the joint hardly moved
    NO_MOVES       there are no moves from rest to rest, or too many of them without a rest between
    MISFIT         the moves are not S-curves behind a lag of first order
    UNCERTAIN      the error would be larger than `ACCEPTED_ACCELERATION` or `ACCEPTED_JERK`
    NO_PLATEAU     an acceleration was reached, but not held
    ONE_LENGTH     only moves of one length show it
    IN_PROPORTION  in all moves that show it, another joint moves in proportion
    LEVELS         there is a higher level that moves of different lengths do not share
    ASYMMETRIC     speeding up and braking differ, or one of them reaches no plateau
    """

    status: Status
    value: float | None = None
    error: float | None = None
    reason: Reason | None = None
    moves: int = 0


@dataclass(frozen=True, slots=True)
class JointLimits:
    """What is known of a joint, SI.

    velocity      that was reached, of the moves that are explained, if any are
    encoder_step  distance of neighbouring readings; None if they are too fine for the record, or not quantised
    deviation     standard deviation of a reading; `time_error_s`: of the rows' times, as far as it matters
    lag_s         the least and the most that the servo's lag could be; None where nothing is known of it
    fitted        segments between rests that were fitted, `explained` of them by S-curves, of `segments` in all
    """

    velocity: float
    acceleration: Estimate
    jerk: Estimate
    encoder_step: float | None
    deviation: float
    time_error_s: float = 0.0
    lag_s: tuple[float, float] | None = None
    fitted: int = 0
    explained: int = 0
    segments: int = 0


@dataclass(frozen=True, eq=False)
class _Fitted:
    """Segments (k) with their own jerks. variance (k,): of weighted residuals, more where they are correlated; white
    (k,): whether they are not; good (k,): whether S-curves explain the segment; alone (k,): whether no other joint
    moves in proportion."""

    curves: list[SCurves]
    own: list[JerkFit]
    variance: FloatArray
    white: BoolArray
    good: BoolArray
    alone: BoolArray


def joint_limits(record: JointRecord, others: Sequence[JointRecord] = (), lags: bool = True) -> JointLimits:
    """The limits of a joint. `others`: the other joints in the same rows; `lags`: False for a record of commanded
    positions, behind which no servo lags."""
    blank = JointLimits(
        record.fastest(), _nothing("NO_MOVES"), _nothing("NO_MOVES"), record.encoder_step, record.deviation
    )
    if np.ptp(record.position) < 2 * LEAST_MOVED * record.resolution:
        return replace(blank, acceleration=_nothing("STILL"), jerk=_nothing("STILL"))
    segments = record.segments()
    if not segments:
        return blank
    fitted = _fit(record, segments, others, lags)
    time_error = _time_error(record, fitted)
    if time_error > 0:
        fitted = _fit(record, record.segments(time_error), others, lags)
    explained = int(fitted.good.sum())
    known = replace(blank, time_error_s=time_error, fitted=len(fitted.own), explained=explained, segments=len(segments))
    if not explained:
        nearly = replace(fitted, good=_nearly(record, fitted))
        acceleration = _nothing("MISFIT")
        if nearly.good.any():
            acceleration = _acceleration(record, nearly, _range(nearly, _top_level(nearly)[0], lags))
        return replace(known, acceleration=acceleration, jerk=_nothing("MISFIT"))
    members, above = _top_level(fitted)
    span = _range(fitted, members, lags)
    return replace(
        known,
        velocity=max(float(fitted.own[i].fits[0].moves[:, 2].max()) for i in np.flatnonzero(fitted.good)),
        acceleration=_acceleration(record, fitted, span),
        jerk=_jerk(fitted, members, above, span),
        lag_s=(span.lag_low, span.lag_high),
    )


def _nothing(reason: Reason) -> Estimate:
    return Estimate("not_identifiable", reason=reason)


def _fit(record: JointRecord, segments: list[Segment], others: Sequence[JointRecord], lags: bool) -> _Fitted:
    if len(segments) > MOST_SEGMENTS:
        by_length = sorted(segments, key=lambda s: float(np.abs(s.moved).max()))
        segments = [by_length[i] for i in np.linspace(0, len(by_length) - 1, MOST_SEGMENTS).round().astype(int)]
    curves = [SCurves(s) for s in segments]
    own = own_jerks(curves, lags)
    squares, correlation, rows = (np.zeros(len(own)) for _ in range(3))
    for i, (c, one) in enumerate(zip(curves, own, strict=True)):
        fit = one.fits[0]
        inside = fit.in_pulses(c.segment.time, 5 * one.lag + 2 * record.step)
        r, both = fit.residual, inside[1:] & inside[:-1]
        squares[i], rows[i] = np.mean(r[inside] ** 2), inside.sum()
        correlation[i] = (r[1:] * r[:-1])[both].sum() / max((r[1:] ** 2)[both].sum(), 1e-300)
    white = correlation <= CORRELATED + 1 / np.sqrt(rows)
    good = white & (squares <= WORSE)
    if good.sum() < len(good) / 2:
        good = np.zeros_like(good)
    correlation = np.clip(correlation, 0, 0.9)
    variance = np.maximum(squares, 1.0) * (1 + correlation) / (1 - correlation)
    alone = np.array([not any(_in_proportion(s, record, other) for other in others) for s in segments])
    return _Fitted(curves, own, variance, white, good, alone)


def _nearly(record: JointRecord, fitted: _Fitted) -> BoolArray:
    """Segments that S-curves do not explain, but nearly."""
    rows = [len(c.segment.time) for c in fitted.curves]
    residual = np.sqrt([one.squares for one in fitted.own] / np.array(rows)) * record.deviation
    return residual <= NEARLY * np.array([np.abs(c.segment.moved).min() for c in fitted.curves])


def _in_proportion(segment: Segment, record: JointRecord, other: JointRecord) -> bool:
    """Whether two joints move in proportion between two rests: then nobody can tell which of them is at its limit."""
    rows = slice(*np.searchsorted(record.time, segment.begin + np.array([0.0, segment.time[-1]])))
    time, progress, room = record.time[rows], [], PROPORTIONAL
    for one in (record, other):
        q = one.position[rows]
        extent = float(np.ptp(q))
        if extent < LEAST_MOVED * one.resolution:
            return False
        progress.append((q - q[0]) / (q[np.argmax(np.abs(q - q[0]))] - q[0]))
        room += 2 * one.resolution / extent
    # one servo may lag more than the other
    return any(
        np.max(np.abs(progress[0] - np.interp(time - shift, time, progress[1]))) <= room
        for shift in np.linspace(-MOST_SHIFT_S, MOST_SHIFT_S, 21)
    )


def _time_error(record: JointRecord, fitted: _Fitted) -> float:
    """Standard deviation of the rows' times, s, from how much larger residuals are where the joint is fast; 0 where it
    matters less than the readings' own errors."""
    squares, speeds = [np.zeros(0)], [np.zeros(0)]
    for c, own, white in zip(fitted.curves, fitted.own, fitted.white, strict=True):
        s = c.segment
        moving = white & (np.abs(s.speed) > 0.02 * np.abs(s.speed).max())
        squares.append((own.fits[0].residual[moving] / s.weight[moving]) ** 2)
        speeds.append(s.speed[moving] ** 2)
    e, v = np.concatenate(squares), np.concatenate(speeds)
    if not len(e):
        return 0.0
    fast = v > np.median(v)
    found = (e[fast].mean() - e[~fast].mean()) / max(v[fast].mean() - v[~fast].mean(), 1e-300)
    error = math.sqrt(max(float(found), 0.0))
    return error if error * math.sqrt(float(v[fast].mean())) > record.deviation / 2 else 0.0


def _level(value: FloatArray, error: FloatArray, room: float) -> tuple[BoolArray, float]:
    """Which values, all positive or all logarithms, are at the highest level that there is, and that level. `room`: by
    how much values differ that are one, beside their errors."""
    top = int(np.argmax(value - error / 2))
    middle, of_middle, members = float(value[top]), float(error[top]), np.zeros(len(value), dtype=bool)
    members[top] = True
    for _ in value:
        near = np.abs(value - middle) <= np.hypot(error, of_middle) + room
        if not near.any() or (near == members).all():
            break
        members, of_middle = near, 0.0
        middle = float(np.average(value[members], weights=1 / (error[members] ** 2 + room**2)))
    return members, middle


def _top_level(fitted: _Fitted) -> tuple[list[int], bool | None]:
    """Segments whose own jerk is at the highest level, and whether others are higher still; all that are good and None
    if none of them can tell."""
    level = np.log([one.jerk for one in fitted.own])
    deviation = np.array([one.deviation for one in fitted.own]) * np.sqrt(fitted.variance)
    known = np.flatnonzero(fitted.good & (deviation <= INFORMATIVE))
    if not len(known):
        return np.flatnonzero(fitted.good).tolist(), None
    members, middle = _level(level[known], SIGMAS * deviation[known], SAME_JERK)
    above = bool((level[known] - middle > SIGMAS * deviation[known] + SAME_JERK)[~members].any())
    return known[members].tolist(), above


def _range(fitted: _Fitted, members: list[int], lags: bool) -> JerkRange:
    rows = np.array([len(fitted.curves[i].segment.time) for i in members])
    lengths = np.sort([np.abs(fitted.curves[i].segment.moved).max() for i in members])
    different = 1 + int((np.diff(lengths) > SAME_LENGTH * lengths[1:]).sum())
    variance = float(fitted.variance[members] @ rows / rows.sum()) * len(members) / different
    return jerk_range([fitted.curves[i] for i in members], [fitted.own[i] for i in members], variance, lags)


def _unconvincing(lengths: FloatArray) -> Reason | None:
    """Why moves of these lengths cannot show a limit."""
    if not len(lengths):
        return "IN_PROPORTION"
    return None if lengths.max() > DISTINCT * lengths.min() else "ONE_LENGTH"


def _estimate(reason: Reason | None, value: float, error: float, lower: float, moves: int) -> Estimate:
    """An identified limit where there is no reason against it, else a lower bound, if it is one."""
    if reason is None:
        return Estimate("identified", value, error, None, moves)
    return Estimate("lower_bound", lower, None, reason, moves) if lower > 0 else _nothing(reason)


def _jerk(fitted: _Fitted, members: list[int], above: bool | None, span: JerkRange) -> Estimate:
    jerk = span.best.jerk
    lengths = [np.abs(fitted.curves[i].segment.moved) for i in members if fitted.alone[i]]
    of = np.concatenate([np.zeros(0), *lengths])
    error = max(span.high / jerk - 1, 1 - span.low / jerk) + JERK_ERROR
    if span.lag_low > 0:
        error += LAG_ERROR * abs(1 - span.without_lag / jerk)
    reason = _unconvincing(of)
    if error > ACCEPTED_JERK or above is None:
        reason = "UNCERTAIN"
    elif reason is None and above:
        reason = "LEVELS"
    lower = min(span.low, span.without_lag) * (1 - JERK_ERROR)
    return _estimate(reason, jerk, error * jerk, lower, len(of))


def _acceleration(record: JointRecord, fitted: _Fitted, span: JerkRange) -> Estimate:
    """From the pulses of all moves that are explained, whatever jerk and lag are possible. Each pulse has its greatest
    acceleration, in a column for speeding up and one for braking."""
    good = np.flatnonzero(fitted.good)
    levels, random, plateaus = [], [], []
    for jerk, lag in span.cases:
        fits = [fitted.curves[i].fit(jerk, lag, fitted.own[i].fits[0]) for i in good]
        spread = [
            [SIGMAS * math.sqrt(fitted.variance[i]) * d for d in f.deviations()]
            for i, f in zip(good, fits, strict=True)
        ]
        levels.append(np.concatenate([f.acceleration() for f in fits]))
        random.append(np.concatenate([a for a, _ in spread]))
        held = np.concatenate([f.held() ** 2 - b for f, (_, b) in zip(fits, spread, strict=True)])
        plateaus.append(held > (LEAST_HELD * record.step) ** 2)
    level, plateau = levels[0], np.all(plateaus, axis=0)
    shift = np.maximum(np.max(levels, axis=0) - level, level - np.min(levels, axis=0))
    least = (level - random[0] - shift) * (1 - ACCELERATION_ERROR)
    if not plateau.any(axis=0).all():
        return _estimate("NO_PLATEAU", 0.0, 0.0, float(least.max()), 0)
    moved = np.concatenate([fitted.curves[i].segment.moved for i in good])
    alone = np.concatenate([np.full(len(fitted.curves[i].segment.moved), fitted.alone[i]) for i in good])
    members = np.zeros_like(plateau)
    room = SAME_ACCELERATION * float(level[plateau].max())
    members[plateau], middle = _level(level[plateau], (random[0] + shift)[plateau], room)
    showing = members.any(axis=1) & alone
    reason = _unconvincing(np.abs(moved[showing]))
    error = 1 / math.sqrt(float((1 / (random[0][members] ** 2 + 1e-300)).sum()))
    error += float(np.median(shift[members])) + ACCELERATION_ERROR * middle
    lower = max(middle - error, float(least.max()))
    if error > ACCEPTED_ACCELERATION * middle:
        reason = "UNCERTAIN"
    elif (least > middle + error).any():
        reason = "LEVELS"
    elif not members.any(axis=0).all():
        reason, lower = "ASYMMETRIC", min(float(least[:, i][plateau[:, i]].max()) for i in (0, 1))
    return _estimate(reason, middle, error, lower, int(showing.sum()))
