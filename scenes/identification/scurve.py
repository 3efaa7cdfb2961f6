"""S-curves: moves from rest to rest whose acceleration is two trapezoids, behind a servo that lags.

Equations I1 to I3, docs/kinematics.md. A move has five numbers: the middles of its two pulses of acceleration, its
speed v, and β = b² of each pulse, which holds its greatest acceleration for 2b. Readings determine the middles and the
second moments of the pulses best. These are kept when the jerk or the lag changes, so that fits converge from afar.

A ramp of the acceleration of duration T and a lag τ have nearly the same effect: readings show T²/12 + τ². So the jerk
of a joint, which all its moves share, is a range over all lags that explain the readings.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import cast

import numpy as np
from scipy.optimize import least_squares, minimize_scalar

from assur.planner.arrays import BoolArray, FloatArray
from assur.scenes.identification.recording import Segment

BLOCK = 128
"""Rows of one QR decomposition. More rows start the threads of the linear algebra library, which cost more time than
they save on matrices as narrow as these."""
EVALUATIONS = 40
"""Most evaluations of a fit; five to eight are usual."""
RATIO = 2.0
"""Of neighbouring jerks, and of neighbouring lags, at which a search begins."""
SHORTEST = 0.05
"""Shortest ramp of the acceleration that is considered, in sampling steps: it determines the highest jerk."""
LONGEST_LAG_S = 0.05
"""Longest lag that is considered, s: no servo that is fit for the job lags longer."""
LAG_SEGMENTS = 4
"""Number of segments that determine the common lag."""
STEPS, BISECTIONS = 20, 7
"""Most steps to the best jerk, three are usual; and halvings of the interval that contains an end of its range."""
LEAST_SQUARE = 0.3
"""Smaller mean squares of weighted residuals count as this: a uniform error of quantisation has 1."""


def lagged(u: FloatArray, lag: float) -> tuple[FloatArray, FloatArray]:
    """g₃ and g₂ of equation I2 for times `u` in s since the change of jerk, of any shape; 0 before it."""
    u = np.maximum(u, 0.0)
    g2 = u * u / 2
    g3 = u * g2 / 3
    if lag > 0:
        g2 -= lag * (u + lag * np.expm1(-u / lag))
        g3 -= lag * g2
    return g3, g2


def triangle(rows: FloatArray) -> FloatArray:
    """R (p, p) of the QR decomposition of `rows` (n, p), n ≥ p."""
    n, p = rows.shape
    padded = np.zeros((-(-n // BLOCK) * BLOCK, p))
    padded[:n] = rows
    blocks = cast(FloatArray, np.linalg.qr(padded.reshape(-1, BLOCK, p), mode="r"))
    return cast(FloatArray, np.linalg.qr(blocks.reshape(-1, p), mode="r"))


@dataclass(frozen=True, eq=False)
class Fit:
    """S-curves fitted to a segment at a jerk and a lag.

    moves (k, 5)   middles of both pulses in s, speed, both β in s²
    squares        sum of squares of weighted residuals; residual (n,): they
    triangle       R of weighted derivatives by `moves`, by log jerk, and residual, constant eliminated
    """

    moves: FloatArray
    jerk: float
    lag: float
    squares: float
    residual: FloatArray
    triangle: FloatArray

    def acceleration(self) -> FloatArray:
        """Greatest acceleration of each pulse (k, 2), unsigned."""
        v, beta = self.moves[:, 2:3], self.moves[:, 3:]
        greatest: FloatArray = v / (np.sqrt(v / self.jerk + beta) + np.sqrt(beta))
        return greatest

    def held(self) -> FloatArray:
        """Duration of the greatest acceleration, s (k, 2)."""
        return 2 * np.sqrt(self.moves[:, 3:])

    def deviations(self) -> tuple[FloatArray, FloatArray]:
        """Standard deviations of `acceleration` and of the squares of `held` (k, 2), jerk and lag being known."""
        r = self.triangle[:-2, :-2]
        scale = np.linalg.norm(r, axis=0)
        if not (scale > 0).all():
            # no reading depends on one of the numbers
            return np.full((len(self.moves), 2), np.inf), np.full((len(self.moves), 2), np.inf)
        _, s, vt = np.linalg.svd(r / scale)
        root = vt.T / np.maximum(s, 1e-9 * s[0]) / scale[:, None]
        k = len(self.moves)
        v, beta = self.moves[:, 2:3], self.moves[:, 3:]
        a, b = np.sqrt(v / self.jerk + beta), np.sqrt(beta)
        by_v = 1 / (a + b) - v / (a + b) ** 2 / (2 * a * self.jerk)
        by_beta = -v / (a + b) ** 2 * (1 / (2 * a) + 1 / (2 * np.maximum(b, 1e-3 * a)))
        rows, squares = np.zeros((k, 2, k, 5)), np.zeros((k, 2, k, 5))
        i, j = np.indices((k, 2))
        rows[i, j, i, 2], rows[i, j, i, 3 + j], squares[i, j, i, 3 + j] = by_v, by_beta, 4.0
        both = [np.linalg.norm(x.reshape(2 * k, -1) @ root, axis=1).reshape(k, 2) for x in (rows, squares)]
        return both[0], both[1]

    def in_pulses(self, time: FloatArray, margin: float) -> BoolArray:
        """Which of `time` lie in a pulse of the acceleration, or up to `margin` s after it."""
        v, beta = self.moves[:, 2:3], self.moves[:, 3:]
        reach = (np.sqrt(v / self.jerk + beta)).ravel()
        middle = self.moves[:, :2].ravel()
        inside = (time[:, None] > middle - reach) & (time[:, None] < middle + reach + margin)
        return np.asarray(inside.any(axis=1))

    def moves_at(self, jerk: float, lag: float) -> FloatArray:
        """First moves of a fit at another jerk and lag."""
        moves = self.moves.copy()
        moves[:, :2] -= lag - self.lag
        v = moves[:, 2:3]
        moves[:, 3:] += (v / self.jerk - v / jerk) / 2 - 3 * (lag**2 - self.lag**2)
        moves[:, 3:] = np.maximum(moves[:, 3:], 0.0)
        return moves


class SCurves:
    """The S-curves of a segment, to be fitted at any jerk and lag."""

    def __init__(self, segment: Segment) -> None:
        self.segment, self.k = segment, len(segment.moved)
        self._sign = np.sign(segment.moved)
        self._guess = np.array([self._guessed(i) for i in range(self.k)])
        self._jerk = self._lag = 0.0
        self._at = np.zeros(0)
        v, squares = self._guess[:, 2:3], self._guess[:, 3:]
        self.rough_jerk = v / squares
        self.rough_acceleration = v / np.sqrt(squares)

    def _guessed(self, i: int) -> list[float]:
        """Middles, speed, and squares of the half durations of the pulses of a move, roughly."""
        s = self.segment
        begin, end, moved = float(s.begins[i]), float(s.ends[i]), float(s.moved[i])
        inside = np.flatnonzero((s.time >= begin) & (s.time <= end))
        speed = s.speed[inside] * np.sign(moved)
        fast = s.time[inside[speed >= speed.max() / 2]]
        first, last = float(fast[0]), max(float(fast[-1]), float(fast[0]) + s.step)
        half = [max(first - begin, s.step), max(end - last, s.step)]
        return [first, last, abs(moved) / (last - first), 0.8 * half[0] ** 2, 0.8 * half[1] ** 2]

    def fit(self, jerk: float, lag: float, near: Fit | None = None) -> Fit:
        """The best S-curves at a jerk and a lag."""
        self._jerk, self._lag = jerk, lag
        if near is None:
            start = self._guess.copy()
            start[:, :2] -= lag
            start[:, 3:] -= start[:, 2:3] / jerk + 3 * lag**2
        else:
            start = near.moves_at(jerk, lag)
        moves, squares = self._least(start)
        apart = self._apart(moves)
        if apart is not None:
            other, less = self._least(apart)
            if less <= squares + 1.0:
                moves, squares = other, less
        self._residual(moves)  # sets rows and triangle
        one, y = self._rows[:, 0], self._rows[:, -1]
        residual = y - one * (one @ y) / (one @ one)
        return Fit(moves.reshape(-1, 5), jerk, lag, squares, residual, self._triangle[1:, 1:])

    def _least(self, start: FloatArray) -> tuple[FloatArray, float]:
        """The moves (5 k,) near `start` (k, 5) with the least squares, and these."""
        lower = np.tile([-np.inf, -np.inf, 1e-9, 0.0, 0.0], self.k)
        inside = np.tile([-np.inf, -np.inf, 1e-9, *[(1e-2 * self.segment.step) ** 2] * 2], self.k)
        found = least_squares(
            self._residual,
            np.maximum(start.ravel(), inside),
            self._slopes,
            bounds=(lower, np.inf),
            x_scale="jac",
            max_nfev=EVALUATIONS,
            ftol=1e-6,
            xtol=1e-10,
            gtol=1e-12,
        )
        return found.x, 2 * float(found.cost)

    def _apart(self, moves: FloatArray) -> FloatArray | None:
        """Moves (k, 5) whose pulses do not overlap, for `moves` (5 k,) with overlaps; None if there is no overlap.

        The ramp that ends one pulse and the one that begins the next are alike: a motion with the two exchanged is the
        same, but its speed and its plateaus are not."""
        x = moves.reshape(-1, 5).copy()
        a, b = np.sqrt(x[:, 2:3] / self._jerk + x[:, 3:]), np.sqrt(x[:, 3:])
        falls, brakes = x[:, 0] + b[:, 0], x[:, 1] - a[:, 1]
        for i in np.flatnonzero(brakes < falls):
            ramps = a[i] - b[i]
            until = [brakes[i] - (x[i, 0] - a[i, 0]), x[i, 1] + b[i, 1] - falls[i]]
            if min(until) <= 0:
                return None
            x[i, :2] = x[i, 0] - a[i, 0] + (until[0] + ramps[0]) / 2, x[i, 1] + a[i, 1] - (until[1] + ramps[1]) / 2
            x[i, 2] = self._jerk * (until[0] * ramps[0] + until[1] * ramps[1]) / 2
            x[i, 3:] = ((until - ramps) / 2) ** 2
        return x if (brakes < falls).any() else None

    def _residual(self, moves: FloatArray) -> FloatArray:
        """Residual, rotated into few rows; least squares need only its products with itself and with the Jacobian."""
        self._at = moves.copy()
        s, jerk, x = self.segment, self._jerk, moves.reshape(-1, 5)
        middle, v, beta = x[:, :2], x[:, 2:3], x[:, 3:]
        a, b = np.sqrt(v / jerk + beta), np.sqrt(beta)
        changes = np.stack([middle - a, middle - b, middle + b, middle + a], axis=-1)
        g3, g2 = lagged(s.time - changes[..., None], self._lag)  # (k, 2, 4, n)
        size = jerk * self._sign[:, None, None] * np.array([[1.0], [-1.0]])
        model = ((g3[:, :, 0] - g3[:, :, 1] - g3[:, :, 2] + g3[:, :, 3]) * size).sum(axis=(0, 1))
        outer, inner = g2[:, :, 0] - g2[:, :, 3], g2[:, :, 2] - g2[:, :, 1]
        by_a = outer * (size / (2 * a[..., None]))
        rows = np.empty((5 * self.k + 3, len(model)))
        rows[0] = 1.0
        own = rows[1:-2].reshape(self.k, 5, -1)
        own[:, :2] = (g2[:, :, 1] + g2[:, :, 2] - g2[:, :, 0] - g2[:, :, 3]) * size
        own[:, 2] = by_a.sum(axis=1) / jerk
        own[:, 3:] = by_a + inner * (size / (2 * np.maximum(b, 1e-3 * s.step)[..., None]))
        rows[-2] = model - (own[:, 2] * v).sum(axis=0)
        rows[-1] = s.position - model
        self._rows = (rows * s.weight).T
        self._triangle = triangle(self._rows)
        return self._triangle[1:, -1]

    def _slopes(self, moves: FloatArray) -> FloatArray:
        """Jacobian of `_residual`, rotated alike."""
        if not np.array_equal(moves, self._at):
            self._residual(moves)
        return -self._triangle[1:, 1:-2]


@dataclass(frozen=True, eq=False)
class JerkFit:
    """The best common jerk of some segments at a lag: the fits of the segments, the sum of their squares, and the
    standard deviation of the logarithm of the jerk, for residuals of variance 1."""

    jerk: float
    lag: float
    squares: float
    deviation: float
    fits: tuple[Fit, ...]


def jerk_bounds(curves: Sequence[SCurves]) -> tuple[float, float]:
    """The lowest and the highest jerk that make sense at this sampling, rad/s³ or m/s³."""
    low = min(float(c.rough_jerk.min()) for c in curves) / 10
    return low, max(float(c.rough_acceleration.max()) for c in curves) * 2 / (SHORTEST * curves[0].segment.step)


def fits_at(curves: Sequence[SCurves], jerk: float, lag: float, near: Sequence[Fit] | None) -> tuple[Fit, ...]:
    """The fits of all segments at a jerk and a lag, each of them near its own in `near`, if that is given."""
    return tuple(c.fit(jerk, lag, None if near is None else near[i]) for i, c in enumerate(curves))


def sum_of_squares(fits: Sequence[Fit]) -> float:
    """The sum of squares of the weighted residuals of some fits."""
    return math.fsum(fit.squares for fit in fits)


def searched(curves: Sequence[SCurves], lag: float) -> JerkFit:
    """The best common jerk at a lag, of all that make sense."""
    low, high = jerk_bounds(curves)
    near: tuple[Fit, ...] | None = None
    tried = []
    for jerk in np.geomspace(high, low, max(2, math.ceil(math.log(high / low) / math.log(RATIO)))):
        near = fits_at(curves, float(jerk), lag, near)
        tried.append(near)
    return refined(curves, min(tried, key=sum_of_squares), lag)


def refined(curves: Sequence[SCurves], near: Sequence[Fit], lag: float) -> JerkFit:
    """The best common jerk at a lag, near that of `near`, by Gauss-Newton steps that are shortened until they help."""
    jerk, (_, top) = near[0].jerk, jerk_bounds(curves)
    fits = fits_at(curves, jerk, lag, near)
    for _ in range(STEPS):
        slope = np.array([fit.triangle[-2, -2] for fit in fits])
        change = float(slope @ [fit.triangle[-2, -1] for fit in fits]) / max(float(slope @ slope), 1e-300)
        change = float(np.clip(change, -math.log(2), math.log(2)))
        gain = 0.0
        while abs(change) > 1e-7 and gain <= 0:
            there = fits_at(curves, min(jerk * math.exp(change), top), lag, fits)
            gain = sum_of_squares(fits) - sum_of_squares(there)
            change /= 4
        if gain > 0:
            jerk, fits = there[0].jerk, there
        if gain <= 2e-2 + 1e-6 * sum_of_squares(fits):
            break
    slope = np.array([fit.triangle[-2, -2] for fit in fits])
    return JerkFit(jerk, lag, sum_of_squares(fits), 1 / max(float(np.linalg.norm(slope)), 1e-12), fits)


def jerk_edge(curves: Sequence[SCurves], fit: JerkFit, way: int, allowed: float) -> float:
    """The jerk above (`way` 1) or below (−1) the best at which the sum of squares has grown by `allowed`; infinite or 0
    where it never does."""
    width = math.sqrt(allowed) * fit.deviation
    if width < 0.02:  # a parabola
        return fit.jerk * math.exp(way * width)
    bottom, top = jerk_bounds(curves)
    inside, near, change = fit.jerk, fit.fits, 0.1
    while True:
        outside = inside * math.exp(way * change)
        if not bottom < outside < top:
            return 0.0 if way < 0 else math.inf
        there = fits_at(curves, outside, fit.lag, near)
        if sum_of_squares(there) - fit.squares > allowed:
            break
        inside, near, change = outside, there, 2 * change
    for _ in range(BISECTIONS):
        middle = math.sqrt(inside * outside)
        there = fits_at(curves, middle, fit.lag, near)
        if sum_of_squares(there) - fit.squares > allowed:
            outside = middle
        else:
            inside, near = middle, there
    return outside


def minimise(function: Callable[[float], float], low: float, high: float) -> None:
    """Evaluates a function, which keeps its values, near its only minimum."""
    minimize_scalar(function, bounds=(low, high), method="bounded", options={"xatol": 1e-4 * high, "maxiter": 20})


def own_jerks(curves: Sequence[SCurves], lags: bool) -> list[JerkFit]:
    """The best jerk of each segment by itself, at the lag that is best for all. `lags`: whether the servo may lag.

    The best lag has the least Σ n log(mean square), so that segments that no S-curve fits do not determine it.
    """
    without = [searched([c], 0.0) for c in curves]
    if not lags:
        return without
    some = range(0, len(curves), math.ceil(len(curves) / LAG_SEGMENTS))
    known = {0.0: [without[i] for i in some]}
    rows = np.array([len(curves[i].segment.time) for i in some])

    def score(lag: float) -> float:
        if lag not in known:
            near = known[min(known, key=lambda other: abs(other - lag))]
            known[lag] = [refined([curves[i]], fit.fits, lag) for i, fit in zip(some, near, strict=True)]
        mean = np.array([fit.squares for fit in known[lag]]) / rows
        return float(np.sum(rows * np.log(np.maximum(mean, LEAST_SQUARE))))

    grid, scores = [0.0], [score(0.0)]
    while len(grid) - int(np.argmin(scores)) < 4 and grid[-1] < LONGEST_LAG_S:
        grid.append(grid[-1] * RATIO or curves[0].segment.step / 4)
        scores.append(score(grid[-1]))
    i = int(np.argmin(scores))
    if 0 < i < len(grid) - 1:
        minimise(score, grid[i - 1], grid[i + 1])
    lag = min(known, key=score)
    best = dict(zip(some, known[lag], strict=True))
    return [best[i] if i in best else refined([c], without[i].fits, lag) for i, c in enumerate(curves)]
