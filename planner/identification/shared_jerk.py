"""One jerk for all moves of a joint: the best, and which jerks and which lags of the servo the readings leave open.

A ramp of the acceleration that lasts T and a lag τ have nearly the same effect where only T²/12 + τ² is seen: so the
jerk is never told from readings at one lag alone.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from assur.planner.identification.scurve import Fit, SCurves

SIGMAS = 4.0
"""Standard deviations that a stated error is wide, to either side."""
JERK_RATIO, LAG_RATIO = 2.0, 2.0
"""Of neighbouring jerks, and of neighbouring lags, at which a search begins."""
SHORTEST = 0.05
"""Ramp of the acceleration, in sampling steps, whose length cannot be told from none: jerks end there."""
LONGEST_LAG_S = 0.05
"""No servo that is fit for the job lags so much."""
LAG_SEGMENTS = 4
"""So many segments decide at which lag all are compared."""
STEPS = 20
"""Most steps to the best jerk; three are usual."""
BISECTIONS = 7
"""A bound of a range is found to a hundredth of where it was looked for."""
FLAT = 0.5
"""Growth of the squares, of the variance, up to which it does not matter where they are least."""
LEAST_SQUARE = 0.3
"""Mean squares of weighted residuals below this count as this: a uniform error of quantisation has 1."""


@dataclass(frozen=True, eq=False)
class JerkFit:
    """The best common jerk of some segments at a lag: the fits of the segments at it, the sum of their squares, and
    the standard deviation of the logarithm of the jerk, for residuals of variance 1."""

    jerk: float
    lag: float
    squares: float
    deviation: float
    fits: tuple[Fit, ...]


@dataclass(frozen=True, eq=False)
class JerkRange:
    """What a joint's readings say of its jerk and of its servo's lag, s. `low` may be 0, `high` infinite.

    without_lag    the lowest jerk if the servo did not lag at all, whether or not the readings allow that
    cases          jerks and lags that are best, and at the ends of what is left open
    """

    best: JerkFit
    low: float
    high: float
    without_lag: float
    lag_low: float
    lag_high: float
    cases: tuple[tuple[float, float], ...]


def _top(curves: Sequence[SCurves]) -> float:
    """The highest jerk that makes sense at this sampling, rad/s³ or m/s³."""
    return max(float(c.rough_acceleration.max()) for c in curves) * 2 / (SHORTEST * curves[0].segment.step)


def _bottom(curves: Sequence[SCurves]) -> float:
    """The lowest, likewise."""
    return min(float(c.rough_jerk.min()) for c in curves) / 10


def _fitted(curves: Sequence[SCurves], jerk: float, lag: float, near: Sequence[Fit] | None) -> tuple[Fit, ...]:
    return tuple(c.fit(jerk, lag, None if near is None else near[i]) for i, c in enumerate(curves))


def _squares(fits: Sequence[Fit]) -> float:
    return math.fsum(fit.squares for fit in fits)


def searched(curves: Sequence[SCurves], lag: float) -> JerkFit:
    """The best common jerk at a lag, looked for among all that there could be."""
    low, high = _bottom(curves), _top(curves)
    near: tuple[Fit, ...] | None = None
    tried = []
    for jerk in np.geomspace(high, low, max(2, math.ceil(math.log(high / low) / math.log(JERK_RATIO)))):
        near = _fitted(curves, float(jerk), lag, near)
        tried.append(near)
    return refined(curves, min(tried, key=_squares), lag)


def refined(curves: Sequence[SCurves], near: Sequence[Fit], lag: float) -> JerkFit:
    """The best common jerk at a lag, near that of `near`, by Gauss-Newton steps that are shortened until they help."""
    jerk, top = near[0].jerk, _top(curves)
    fits = _fitted(curves, jerk, lag, near)
    for _ in range(STEPS):
        slope = np.array([fit.triangle[-2, -2] for fit in fits])
        change = float(slope @ [fit.triangle[-2, -1] for fit in fits]) / max(float(slope @ slope), 1e-300)
        change = float(np.clip(change, -math.log(2), math.log(2)))
        gain = 0.0
        while abs(change) > 1e-7 and gain <= 0:
            there = _fitted(curves, min(jerk * math.exp(change), top), lag, fits)
            gain = _squares(fits) - _squares(there)
            change /= 4
        if gain > 0:
            jerk, fits = there[0].jerk, there
        if gain <= 2e-2 + 1e-6 * _squares(fits):
            break
    slope = np.array([fit.triangle[-2, -2] for fit in fits])
    return JerkFit(jerk, lag, _squares(fits), 1 / max(float(np.linalg.norm(slope)), 1e-12), fits)


def _least(function: Callable[[float], float], low: float, high: float) -> None:
    """Evaluates a function of one minimum until it is known where that is."""
    minimize_scalar(function, bounds=(low, high), method="bounded", options={"xatol": 1e-4 * high, "maxiter": 20})


def own_jerks(curves: Sequence[SCurves], lags: bool) -> list[JerkFit]:
    """The best jerk of each segment by itself, at the lag that is best for all of them. `lags`: whether there is one.

    The lag is that with the least Σ n log(mean square), so that segments that no S-curve fits do not decide it.
    """
    without = [searched([c], 0.0) for c in curves]
    if not lags:
        return without
    some = range(0, len(curves), math.ceil(len(curves) / LAG_SEGMENTS))
    found = {0.0: [without[i] for i in some]}
    rows = np.array([len(curves[i].segment.time) for i in some])

    def score(lag: float) -> float:
        if lag not in found:
            near = found[min(found, key=lambda other: abs(other - lag))]
            found[lag] = [refined([curves[i]], fit.fits, lag) for i, fit in zip(some, near, strict=True)]
        mean = np.array([fit.squares for fit in found[lag]]) / rows
        return float(np.sum(rows * np.log(np.maximum(mean, LEAST_SQUARE))))

    grid, scores = [0.0], [score(0.0)]
    while len(grid) - int(np.argmin(scores)) < 4 and grid[-1] < LONGEST_LAG_S:
        grid.append(grid[-1] * LAG_RATIO or curves[0].segment.step / 4)
        scores.append(score(grid[-1]))
    i = int(np.argmin(scores))
    if 0 < i < len(grid) - 1:
        _least(score, grid[i - 1], grid[i + 1])
    lag = min(found, key=score)
    known = dict(zip(some, found[lag], strict=True))
    return [known[i] if i in known else refined([c], without[i].fits, lag) for i, c in enumerate(curves)]


def jerk_range(curves: Sequence[SCurves], own: Sequence[JerkFit], variance: float, lags: bool) -> JerkRange:
    """The common jerk of segments, from their own jerks. `variance`: of their weighted residuals; `lags`: whether the
    servo may lag."""
    weight = np.array([1 / fit.deviation**2 for fit in own])
    jerk = math.exp(float(weight @ [math.log(fit.jerk) for fit in own] / weight.sum()))
    begin = own[0].lag
    near = _fitted(curves, jerk, begin, [fit.fits[0] for fit in own])
    found = {begin: refined(curves, near, begin)}

    def at(lag: float) -> JerkFit:
        if lag not in found:
            found[lag] = refined(curves, found[min(found, key=lambda other: abs(other - lag))].fits, lag)
        return found[lag]

    lag_low = lag_high = begin
    step = curves[0].segment.step / 4 if lags else 0.0
    around = (begin / 1.2, begin * 1.2 + step) if lags else (begin, begin)
    if max(at(lag).squares for lag in around) - at(begin).squares > FLAT * variance:
        _least(lambda lag: at(lag).squares, *around)
    least = min(fit.squares for fit in found.values())

    def excess(lag: float) -> float:
        return (at(lag).squares - least) / variance

    if lags:
        middle = min(found, key=lambda lag: found[lag].squares)
        lag_low = 0.0 if excess(0.0) <= SIGMAS**2 else _edge(excess, middle, 0.0)
        inside, outside = middle, middle + step
        while excess(outside) <= SIGMAS**2 and outside < LONGEST_LAG_S:
            inside, outside = outside, outside + 2 * (outside - middle)
        lag_high = outside if excess(outside) <= SIGMAS**2 else _edge(excess, inside, outside)
    middle = min(found, key=lambda lag: found[lag].squares)

    def edge(lag: float, way: int) -> tuple[float, float]:
        allowed = SIGMAS**2 - excess(lag)
        return _jerk_edge(curves, at(lag), way, max(allowed, 1.0) * variance), lag

    low = min(edge(lag, -1) for lag in sorted({lag_low, (lag_low + middle) / 2, middle}))
    high = edge(middle, 1) if lag_high < LONGEST_LAG_S else (math.inf, lag_high)
    for lag in ((middle + lag_high) / 2, lag_high):
        if math.isfinite(high[0]):
            high = max(high, edge(lag, 1))
    without = low[0] if low[1] == 0.0 else _jerk_edge(curves, at(0.0), -1, SIGMAS**2 * variance)
    bottom, top = _bottom(curves), _top(curves)
    cases = tuple((min(max(jerk, bottom), top), lag) for jerk, lag in ((found[middle].jerk, middle), low, high))
    return JerkRange(found[middle], low[0], high[0], without, lag_low, lag_high, cases)


def _edge(excess: Callable[[float], float], inside: float, outside: float) -> float:
    """Where the squares have grown by as much as is allowed, between a lag at which they have not and one at which they
    have."""
    room = abs(outside - inside) / 50
    return float(brentq(lambda lag: excess(lag) - SIGMAS**2, inside, outside, xtol=room)) if room else outside


def _jerk_edge(curves: Sequence[SCurves], fit: JerkFit, way: int, allowed: float) -> float:
    """The jerk above (`way` 1) or below (−1) the best at which the squares have grown by `allowed`; 0 or infinite where
    they never do."""
    width = math.sqrt(allowed) * fit.deviation
    if width < 0.02:  # a parabola
        return fit.jerk * math.exp(way * width)
    bottom, top = _bottom(curves), _top(curves)
    inside, near, change = fit.jerk, fit.fits, 0.1
    while True:
        outside = inside * math.exp(way * change)
        if not bottom < outside < top:
            return 0.0 if way < 0 else math.inf
        there = _fitted(curves, outside, fit.lag, near)
        if _squares(there) - fit.squares > allowed:
            break
        inside, near, change = outside, there, 2 * change
    for _ in range(BISECTIONS):
        middle = math.sqrt(inside * outside)
        there = _fitted(curves, middle, fit.lag, near)
        if _squares(there) - fit.squares > allowed:
            outside = middle
        else:
            inside, near = middle, there
    return outside
