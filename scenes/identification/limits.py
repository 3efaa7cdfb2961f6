"""Limits of a joint that its record shows, with their errors, or the reason why it does not show them.

A controller that is at its limit shows the same acceleration, and the same jerk, in moves of different lengths. So a
level counts as a limit if moves of different lengths reach it, no move exceeds it, and no other joint moves in
proportion, because that joint might be the one at its limit. Any other level is a lower bound of the limit.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from scipy.optimize import brentq

from assur.planner.arrays import BoolArray, FloatArray
from assur.scenes.identification import scurve
from assur.scenes.identification.recording import LEAST_MOVED, JointRecord, Segment
from assur.scenes.identification.scurve import JerkFit, SCurves

SIGMAS = 4.0
"""Half width of a stated error, in standard deviations."""
ACCEPTED_ACCELERATION, ACCEPTED_JERK = 0.05, 0.15
"""Largest relative error of an identified limit."""
ACCELERATION_ERROR, JERK_ERROR = 0.001, 0.005
"""Relative error of a limit that more readings do not reduce: rounding, and the assumed errors of readings."""
LAG_ERROR = 0.25
"""Part of the effect of a lag on the jerk that counts as error: a servo is not exactly of first order."""
MOST_SEGMENTS = 8
"""Number of segments that are fitted, at most; they have all lengths."""
DISTINCT = 1.1
"""Ratio of the lengths of two moves that count as different."""
SAME_LENGTH = 0.01
"""Relative difference of lengths up to which a move counts as a repetition: both may have the same errors of
quantisation, so that a repetition does not improve precision."""
CORRELATED = 0.25
"""Largest autocorrelation of residuals, without its own error, for which S-curves explain the readings."""
WORSE = 6.0
"""Largest mean square of weighted residuals for which they do."""
NEARLY = 0.003
"""Largest residual, in lengths of the shortest move, for which an S-curve that does not explain the readings still
shows which acceleration is held, and for how long."""
INFORMATIVE = 0.15
"""Largest standard deviation of the logarithm of a segment's own jerk for which the jerk is compared with others."""
SAME_JERK, SAME_ACCELERATION = 0.005, 0.003
"""Relative differences of levels that count as one, in addition to their errors."""
LEAST_HELD = 2.0
"""Shortest plateau of an acceleration, in sampling steps."""
PROPORTIONAL, MOST_SHIFT_S = 0.01, 0.02
"""Joints move in proportion if their progress differs by at most this part of the whole, one of them at most so much
later, s."""
FLAT = 0.5
"""Growth of the sum of squares, in variances, below which the best lag is not determined more exactly."""

Status = Literal["identified", "lower_bound", "not_identifiable"]
Reason = Literal[
    "STILL", "NO_MOVES", "MISFIT", "UNCERTAIN", "NO_PLATEAU", "ONE_LENGTH", "IN_PROPORTION", "LEVELS", "ASYMMETRIC"
]


@dataclass(frozen=True, slots=True)
class Estimate:
    """A limit, SI. identified: within `error` of `value`; lower_bound: at least `value`, because of `reason`;
    not_identifiable: because of `reason` (`scenes.fitted_limits.WHY`). `moves`: number of moves that show it."""

    status: Status
    value: float | None = None
    error: float | None = None
    reason: Reason | None = None
    moves: int = 0


@dataclass(frozen=True, slots=True)
class JointLimits:
    """What a record shows of a joint, SI.

    velocity      the greatest in moves that S-curves explain, else the greatest mean over some rows
    encoder_step  distance of neighbouring readings; None if they are too fine for the record, or not quantised
    deviation     standard deviation of a reading; `time_error_s`: of the rows' times, where it matters
    lag_s         shortest and longest possible lag of the servo; None if it is not known
    fitted        number of fitted segments; S-curves explain `explained` of them; the record has `segments`
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
class JerkRange:
    """The jerks of a joint, and the lags of its servo, s, that explain its readings. `low` may be 0, `high` infinite.

    without_lag    the lowest jerk of a servo without lag, even if the readings exclude that
    cases          pairs of jerk and lag: the best, and those at both ends of the range of the jerk
    """

    best: JerkFit
    low: float
    high: float
    without_lag: float
    lag_low: float
    lag_high: float
    cases: tuple[tuple[float, float], ...]


@dataclass(frozen=True, eq=False)
class _Fitted:
    """Segments (k) with their own jerks. variance (k,): of weighted residuals, larger where they are correlated; white
    (k,): whether they are not correlated; good (k,): whether S-curves explain the segment; alone (k,): whether no other
    joint moves in proportion."""

    curves: list[SCurves]
    own: list[JerkFit]
    variance: FloatArray
    white: BoolArray
    good: BoolArray
    alone: BoolArray


def joint_limits(record: JointRecord, others: Sequence[JointRecord] = (), lags: bool = True) -> JointLimits:
    """The limits of a joint. `others`: the other joints in the same rows; `lags`: False for a record of commanded
    positions, behind which no servo lags."""
    still = np.ptp(record.position) < 2 * LEAST_MOVED * record.resolution
    unknown = _not_identifiable("STILL" if still else "NO_MOVES")
    blank = JointLimits(record.fastest(), unknown, unknown, record.encoder_step, record.deviation)
    segments = [] if still else record.segments()
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
        acceleration = _not_identifiable("MISFIT")
        if nearly.good.any():
            acceleration = _acceleration(record, nearly, _range(nearly, _top_level(nearly)[0], lags))
        return replace(known, acceleration=acceleration, jerk=_not_identifiable("MISFIT"))
    members, above = _top_level(fitted)
    span = _range(fitted, members, lags)
    return replace(
        known,
        velocity=max(float(fitted.own[i].fits[0].moves[:, 2].max()) for i in np.flatnonzero(fitted.good)),
        acceleration=_acceleration(record, fitted, span),
        jerk=_jerk(fitted, members, above, span),
        lag_s=(span.lag_low, span.lag_high),
    )


def _not_identifiable(reason: Reason) -> Estimate:
    return Estimate("not_identifiable", reason=reason)


def _fit(record: JointRecord, segments: list[Segment], others: Sequence[JointRecord], lags: bool) -> _Fitted:
    if len(segments) > MOST_SEGMENTS:
        by_length = sorted(segments, key=lambda s: float(np.abs(s.moved).max()))
        segments = [by_length[i] for i in np.linspace(0, len(by_length) - 1, MOST_SEGMENTS).round().astype(int)]
    curves = [SCurves(s) for s in segments]
    own = scurve.own_jerks(curves, lags)
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
    """Which segments S-curves nearly explain."""
    rows = [len(c.segment.time) for c in fitted.curves]
    residual = np.sqrt([one.squares for one in fitted.own] / np.array(rows)) * record.deviation
    return residual <= NEARLY * np.array([np.abs(c.segment.moved).min() for c in fitted.curves])


def _in_proportion(segment: Segment, record: JointRecord, other: JointRecord) -> bool:
    """Whether two joints move in proportion between two rests: then the record does not show which of them is at
    its limit."""
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
    """Which values, all positive or all logarithms, are at the highest level, and that level. `room`: difference of
    values that count as one, in addition to their errors."""
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
    """Segments whose own jerk is at the highest level, and whether others are higher still. If no jerk is exact enough:
    all segments that S-curves explain, and None."""
    level = np.log([one.jerk for one in fitted.own])
    deviation = np.array([one.deviation for one in fitted.own]) * np.sqrt(fitted.variance)
    known = np.flatnonzero(fitted.good & (deviation <= INFORMATIVE))
    if not len(known):
        return np.flatnonzero(fitted.good).tolist(), None
    members, middle = _level(level[known], SIGMAS * deviation[known], SAME_JERK)
    above = bool((level[known] - middle > SIGMAS * deviation[known] + SAME_JERK)[~members].any())
    return known[members].tolist(), above


def _range(fitted: _Fitted, members: list[int], lags: bool) -> JerkRange:
    """The common jerk of some segments. `lags`: whether the servo may lag."""
    curves, own = [fitted.curves[i] for i in members], [fitted.own[i] for i in members]
    rows = np.array([len(c.segment.time) for c in curves])
    lengths = np.sort([np.abs(c.segment.moved).max() for c in curves])
    different = 1 + int((np.diff(lengths) > SAME_LENGTH * lengths[1:]).sum())
    variance = float(fitted.variance[members] @ rows / rows.sum()) * len(members) / different
    weight = np.array([1 / fit.deviation**2 for fit in own])
    jerk = math.exp(float(weight @ [math.log(fit.jerk) for fit in own] / weight.sum()))
    begin = own[0].lag
    near = scurve.fits_at(curves, jerk, begin, [fit.fits[0] for fit in own])
    known = {begin: scurve.refined(curves, near, begin)}

    def at(lag: float) -> JerkFit:
        if lag not in known:
            near = known[min(known, key=lambda other: abs(other - lag))].fits
            known[lag] = scurve.refined(curves, near, lag)
        return known[lag]

    lag_low = lag_high = begin
    step = curves[0].segment.step / 4 if lags else 0.0
    around = (begin / 1.2, begin * 1.2 + step) if lags else (begin, begin)
    if max(at(lag).squares for lag in around) - at(begin).squares > FLAT * variance:
        scurve.minimise(lambda lag: at(lag).squares, *around)
    least = min(fit.squares for fit in known.values())

    def excess(lag: float) -> float:
        return (at(lag).squares - least) / variance - SIGMAS**2

    def lag_edge(inside: float, outside: float) -> float:
        room = abs(outside - inside) / 50
        return float(brentq(excess, inside, outside, xtol=room)) if room else outside

    if lags:
        middle = min(known, key=lambda lag: known[lag].squares)
        lag_low = 0.0 if excess(0.0) <= 0 else lag_edge(middle, 0.0)
        inside, outside = middle, middle + step
        while excess(outside) <= 0 and outside < scurve.LONGEST_LAG_S:
            inside, outside = outside, outside + 2 * (outside - middle)
        lag_high = outside if excess(outside) <= 0 else lag_edge(inside, outside)
    middle = min(known, key=lambda lag: known[lag].squares)

    def edge(lag: float, way: int) -> tuple[float, float]:
        return scurve.jerk_edge(curves, at(lag), way, max(-excess(lag), 1.0) * variance), lag

    low = min(edge(lag, -1) for lag in sorted({lag_low, (lag_low + middle) / 2, middle}))
    high = edge(middle, 1) if lag_high < scurve.LONGEST_LAG_S else (math.inf, lag_high)
    for lag in ((middle + lag_high) / 2, lag_high):
        if math.isfinite(high[0]):
            high = max(high, edge(lag, 1))
    without = low[0] if low[1] == 0.0 else scurve.jerk_edge(curves, at(0.0), -1, SIGMAS**2 * variance)
    bottom, top = scurve.jerk_bounds(curves)
    cases = tuple((min(max(jerk, bottom), top), lag) for jerk, lag in ((known[middle].jerk, middle), low, high))
    return JerkRange(known[middle], low[0], high[0], without, lag_low, lag_high, cases)


def _unconvincing(lengths: FloatArray) -> Reason | None:
    """The reason why moves of these lengths do not show a limit; None: they do."""
    if not len(lengths):
        return "IN_PROPORTION"
    return None if lengths.max() > DISTINCT * lengths.min() else "ONE_LENGTH"


def _estimate(reason: Reason | None, value: float, error: float, lower: float, moves: int) -> Estimate:
    """An identified limit if there is no reason against it, else a lower bound if it is above 0."""
    if reason is None:
        return Estimate("identified", value, error, None, moves)
    return Estimate("lower_bound", lower, None, reason, moves) if lower > 0 else _not_identifiable(reason)


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
    """The limit of acceleration, from the pulses of all moves that S-curves explain, for all possible jerks and lags.
    Each pulse has its greatest acceleration, in a column for speeding up and one for braking."""
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
