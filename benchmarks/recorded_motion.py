"""Synthetic recorded motion: moves from rest to rest by Ruckig, with known limits, through a servo and an encoder, to
test the identification of limits."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import ruckig
from scipy.signal import cont2discrete, lfilter

from assur.planner.arrays import FloatArray

FINE_S = 2e-5
"""Step at which a servo is simulated at most."""
STILL_S = 0.3
"""Rest before the first and after the last move."""


@dataclass(frozen=True, eq=False)
class Limits:
    """Of n joints, each (n,), rad or m and s."""

    velocity: FloatArray
    acceleration: FloatArray
    jerk: FloatArray


@dataclass(frozen=True, eq=False)
class Motion:
    """Phases of n joints one after the other, (n, p) each: when they begin, s; position, velocity, acceleration and
    jerk in them, from their begin on. `end`: s."""

    begin: FloatArray
    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    jerk: FloatArray
    end: float

    def at(self, time: FloatArray) -> FloatArray:
        """Positions (k, n) at times (k,), s."""
        found = np.empty((len(time), len(self.begin)))
        for i, begin in enumerate(self.begin):
            k = np.maximum(np.searchsorted(begin, time, side="right") - 1, 0)
            u = np.maximum(time - begin[k], 0.0)
            rates = self.velocity[i, k], self.acceleration[i, k] / 2, self.jerk[i, k] / 6
            found[:, i] = self.position[i, k] + u * (rates[0] + u * (rates[1] + u * rates[2]))
        return found


def motion(
    points: FloatArray, rests: Sequence[float] | FloatArray, limits: Limits, synchronization: str = "Time"
) -> Motion:
    """Through `points` (m, n) with a rest of `rests` (m − 1,) s after each move. All joints arrive together: each as
    fast as its limits allow and then slower (`Time`), in proportion where that is possible (`Phase`), or each by itself
    (`No`)."""
    n = points.shape[1]
    phases: list[list[tuple[float, float, float, float, float]]] = [[(0.0, q, 0.0, 0.0, 0.0)] for q in points[0]]
    now = STILL_S
    for start, goal, rest in zip(points[:-1], points[1:], rests, strict=True):
        given, found = ruckig.InputParameter(n), ruckig.Trajectory(n)
        given.current_position, given.target_position = start.tolist(), goal.tolist()
        given.max_velocity, given.max_acceleration = limits.velocity.tolist(), limits.acceleration.tolist()
        given.max_jerk = limits.jerk.tolist()
        given.synchronization = getattr(ruckig.Synchronization, synchronization)
        result = ruckig.Ruckig(n).calculate(given, found)
        if result not in (ruckig.Result.Working, ruckig.Result.Finished):
            raise ValueError(f"no motion from {start} to {goal}: {result}")
        for joint, profile, q in zip(phases, found.profiles[0], goal.tolist(), strict=True):
            begin = now
            for t, p, v, a, j in zip(profile.t, profile.p, profile.v, profile.a, profile.j, strict=False):
                joint.append((begin, p, v, a, j))
                begin += t
            joint.append((begin, q, 0.0, 0.0, 0.0))
        now += found.duration + rest
    begin, position, velocity, acceleration, jerk = np.moveaxis(np.array(phases), -1, 0)
    return Motion(begin, position, velocity, acceleration, jerk, now + STILL_S)


def behind(made: Motion, time: FloatArray, numerator: Sequence[float], denominator: Sequence[float]) -> FloatArray:
    """Positions (k, n) at evenly spaced times (k,) from 0 on, behind a servo with this transfer function."""
    step = float(time[1] - time[0])
    parts = int(np.ceil(step / FINE_S))
    fine = made.at(np.linspace(0.0, float(time[-1]), (len(time) - 1) * parts + 1))
    b, a, _ = cont2discrete((numerator, denominator), step / parts, method="foh")
    after: FloatArray = lfilter(np.ravel(b), np.ravel(a), fine - fine[0], axis=0) + fine[0]
    return after[::parts]


def read_by_encoder(positions: FloatArray, step: float, random: np.random.Generator) -> FloatArray:
    """Positions as an encoder of that step has them, whose zero is anywhere, in a file of nine decimals."""
    zero = random.uniform(0.0, 1.0, positions.shape[1])
    return np.round(np.round(positions / step + zero) * step, 9)


def as_csv(time: FloatArray, positions: FloatArray, names: Sequence[str], decimals: int = 9) -> str:
    """A log: times (k,) in s, and positions (k, n) in the units that `names` bear."""
    rows = [",".join([f"{t:.6f}", *(f"{q:.{decimals}f}" for q in row)]) for t, row in zip(time, positions, strict=True)]
    return "\n".join([",".join(["t_s", *names]), *rows]) + "\n"


KINDS = (
    "plain",  # exact times, a perfect servo
    "times",  # uneven rows, and errors of their times
    "noise",  # of readings
    "short",  # moves of some hundredths of a radian
    "lag",  # a servo that lags by first order
    "proportion",  # joints in proportion, where their limits allow it
    "second_order",  # a servo that swings
    "feed_forward",  # a servo that lags by first order, partly made up for
    "vibration",  # of an arm that is not stiff
    "no_jerk_limit",  # acceleration that jumps
)
"""Kinds of random logs; from `proportion` on limits may not be identifiable at all."""
STEPS = (*(2 * np.pi / counts / gear for counts in (2**17, 2**20) for gear in (50, 100)), 1e-4, 3e-5, 1e-5)
"""Steps of encoders, rad."""


def random_log(kind: str, seed: int) -> tuple[Limits, FloatArray, FloatArray]:
    """Limits of two joints, and times (k,) and readings (k, 2) of some cycles through random points."""
    random = np.random.default_rng([seed, KINDS.index(kind)])
    hz, step = float(random.choice([250, 1000])), float(random.choice(STEPS))
    span = float(random.choice([0.005, 0.02, 0.05])) if kind == "short" else 2.0
    velocity = random.uniform(2, 10, 2)
    acceleration, jerk = _any_size(random, 10, 150, 2), _any_size(random, 500, 30_000, 2)
    limits = Limits(velocity, acceleration, np.full(2, 1e7) if kind == "no_jerk_limit" else jerk)
    count, cycles = int(random.integers(3, 6)), int(random.integers(1, 4))
    points = random.uniform(-span, span, (count, 2))
    points = np.concatenate([points] * cycles + [points[:1]])
    rests = np.where(random.random(len(points) - 1) < 0.15, 0.0, random.uniform(0.05, 0.3, len(points) - 1))
    made = motion(points, rests, limits, "Phase" if kind == "proportion" else "Time")
    time = np.arange(0.0, made.end, 1 / hz)
    if kind == "times":
        error = float(random.choice([1e-6, 1e-5, 5e-5]))
        time = np.sort(time + random.normal(0.0, 0.03 / hz, len(time)))
        q, time = made.at(time), time + random.normal(0.0, error, len(time))
    else:
        servo = _servo(kind, random)
        q = made.at(time) if servo is None else behind(made, time, *servo)
    if kind == "noise":
        q = q + random.normal(0.0, float(_any_size(random, 1e-6, 1e-4)[0]), q.shape)
    time = np.round(time, 6)
    keep = np.concatenate([[True], np.diff(time) > 0.1 / hz])
    return limits, time[keep], read_by_encoder(q, step, random)[keep]


def _any_size(random: np.random.Generator, low: float, high: float, count: int = 1) -> FloatArray:
    """Numbers whose logarithms are uniform."""
    return np.exp(random.uniform(math.log(low), math.log(high), count))


def _servo(kind: str, random: np.random.Generator) -> tuple[list[float], list[float]] | None:
    """Numerator and denominator of what is between command and reading."""
    if kind in ("lag", "feed_forward"):
        lag = float(_any_size(random, 0.001, 0.02)[0])
        return ([1.0] if kind == "lag" else [float(random.uniform(0.3, 1.2)) * lag, 1.0]), [lag, 1.0]
    if kind == "second_order":
        w, damping = 2 * np.pi * float(_any_size(random, 5, 80)[0]), float(random.choice([0.5, 0.7, 1.0]))
        return [w * w], [1.0, 2 * damping * w, w * w]
    if kind == "vibration":
        w, damping = 2 * np.pi * float(random.uniform(10, 60)), float(random.choice([0.02, 0.05, 0.1]))
        return [2 * damping * w, w * w], [1.0, 2 * damping * w, w * w]
    return None


def example() -> str:
    """The log of `docs/logs`: three joints of an arm, one after the other, read every 4 ms."""
    limits = Limits(np.array([7.0, 9.0, 1.0]), np.array([60.0, 95.0, 10.0]), np.array([2100.0, 3600.0, 420.0]))
    stops = np.radians([(0, 40, 0), (75, 40, 0), (75, -30, 0), (75, -30, 0), (75, 10, 0), (30, 10, 0), (30, 40, 0)])
    stops[:, 2] = 0.02, 0.02, 0.02, 0.16, 0.16, 0.16, 0.08
    made = motion(np.concatenate([stops, stops[:1]]), np.full(len(stops), 0.08), limits)
    time = np.arange(0.0, made.end, 0.004)
    shown = made.at(time) * np.array([180 / np.pi, 180 / np.pi, 1000.0])
    encoders = 360 / (2**17 * 100), 360 / (2**17 * 80), 0.002
    random = np.random.default_rng(0)
    columns = [read_by_encoder(shown[:, [i]], step, random) for i, step in enumerate(encoders)]
    return as_csv(time, np.concatenate(columns, axis=1), ("j1_deg", "j2_deg", "j3_mm"), 6)


if __name__ == "__main__":
    print(example(), end="")
