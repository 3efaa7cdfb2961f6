"""The clock of `dyad-timing`: each formulation of the dyad on the same problems, one at a time and in arrays."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from typing import Any, cast

import numpy as np

from assur.experiments import dyad_forms as forms
from assur.experiments import printed_rrr as printed
from assur.experiments.dyad import RRR
from assur.planner.arrays import FloatArray

L1, L2, SIGMA = printed.L_AB, printed.L_BC, 1
"""The dyad of the source's SCARA, m, in assembly mode 1."""
REPEATS, SEED = 100, 4
INNER, ROUNDS = 10, 4
"""Solutions timed at once, and how often; the fastest counts, for whatever else runs only slows down."""
SPREAD = 0.5
"""Standard deviation of the guess about the solution, as a share of l1, where one is needed."""
SPREADS = (0.01, 0.03, 0.1, 0.3, 1.0, 3.0)
STARTS = 200
"""Guesses after which a repeat would be given up; at a spread of 3 one start in two lands."""
BATCHES = (1, 10, 100, 1000, 10_000)
NEAR = 1e-6
"""m. Closer than this to the wanted assembly is it: the other one is centimetres away."""
Guesses = list[tuple[float, float]]


def dyads(count: int) -> FloatArray:
    """Random motions (12, count) of A and B between which the dyad can be assembled, 5 mm from where it cannot."""
    random = np.random.default_rng(SEED)
    given = random.uniform(-0.1, 0.1, (12, count))
    radius, angle = random.uniform(L1 - L2 + 5e-3, L1 + L2 - 5e-3, count), random.uniform(-np.pi, np.pi, count)
    given[6], given[7] = given[0] + radius * np.cos(angle), given[1] + radius * np.sin(angle)
    return given


def single(given: FloatArray, i: int) -> forms.Given[float]:
    """Dyad number i as plain floats."""
    return cast("forms.Given[float]", tuple(given[:, i].tolist()))


def columns(given: FloatArray) -> forms.Given[FloatArray]:
    """All dyads as arrays."""
    return cast("forms.Given[FloatArray]", tuple(given))


def starts(
    given: forms.Given[float], wanted: tuple[float, float], spread: float, random: np.random.Generator
) -> Guesses:
    """The guesses that are tried until Newton lands on the wanted C: all but the last do not."""
    guesses: Guesses = []
    while len(guesses) < STARTS:
        noise = random.normal(0.0, spread * L1, 2)
        guesses.append((wanted[0] + float(noise[0]), wanted[1] + float(noise[1])))
        found = forms.natural(given, L1, L2, guesses[-1], forms.FLOATS)
        if found is not None and np.hypot(found[3] - wanted[0], found[4] - wanted[1]) <= NEAR:
            break
    return guesses


def restarted(
    given: forms.Given[float], wanted: tuple[float, float], guesses: Guesses, f: forms.Functions[float]
) -> forms.Found[float] | None:
    """Natural coordinates from one guess after the other until C is the wanted one."""
    for guess in guesses:
        found = forms.natural(given, L1, L2, guess, f)
        if found is not None and abs(found[3] - wanted[0]) <= NEAR and abs(found[4] - wanted[1]) <= NEAR:
            return found
    return None


def kernel(given: FloatArray) -> Any:
    """The planner's dyad on arrays (12, N): both links' rates and accelerations, and every case distinguished."""
    d = given[6:] - given[:6]
    return RRR(L1, L2).solve(SIGMA, (d[0], d[1]), (d[2], d[3]), (d[4], d[5]))


def printed_batch(given: FloatArray) -> printed.Dyad:
    """The printed equations on arrays (12, N)."""
    return printed.dyad(printed.Point(*given[:6]), printed.Point(*given[6:]), L1, L2, 1)


def clocked(run: Callable[[], object], inner: int = INNER) -> float:
    """Seconds for one `run`: the fastest of some rounds."""
    best = np.inf
    for _ in range(ROUNDS):
        begin = time.perf_counter()
        for _ in range(inner):
            run()
        best = min(best, (time.perf_counter() - begin) / inner)
    return best


def one_by_one(given: FloatArray) -> tuple[dict[str, FloatArray], FloatArray, dict[str, float]]:
    """Times (REPEATS,) by formulation, the number of starts, and how far each is from the vector form at most."""
    random = np.random.default_rng(SEED)
    times: dict[str, list[float]] = {}
    tried, worst = [], dict.fromkeys(("printed", "relative", "natural"), 0.0)
    dyad = RRR(L1, L2)
    for i in range(REPEATS):
        g = single(given, i)
        truth = forms.vector(g, L1, L2, SIGMA, forms.FLOATS)
        wanted = truth[3], truth[4]
        guesses = starts(g, wanted, SPREAD, random)
        tried.append(len(guesses))
        d = [np.array(given[6 + k, i] - given[k, i]) for k in range(6)]
        ways: dict[str, Callable[[], Any]] = {
            "printed": partial(forms.printed_single, g, L1, L2, SIGMA),
            "vector": partial(forms.vector, g, L1, L2, SIGMA, forms.FLOATS),
            "kernel": partial(dyad.solve, SIGMA, (d[0], d[1]), (d[2], d[3]), (d[4], d[5])),
            "relative": partial(forms.relative, g, L1, L2, SIGMA, forms.FLOATS),
            "relative, general": partial(forms.relative, g, L1, L2, SIGMA, forms.FLOATS_GENERAL),
            "natural": partial(restarted, g, wanted, guesses, forms.FLOATS),
            "natural, general": partial(restarted, g, wanted, guesses, forms.FLOATS_GENERAL),
        }
        for name, way in ways.items():
            times.setdefault(name, []).append(clocked(way))
        for name in worst:
            found = np.array(ways[name]())
            found[0] = truth[0] + np.remainder(found[0] - truth[0] + np.pi, 2 * np.pi) - np.pi
            scale = np.maximum(1.0, np.abs(truth))
            worst[name] = max(worst[name], float((np.abs(found - truth) / scale).max()))
    return {name: np.array(row) for name, row in times.items()}, np.array(tried), worst


def in_batches(given: FloatArray) -> tuple[dict[str, FloatArray], float]:
    """Seconds for one dyad (BATCHES,) by formulation in arrays, and the mean number of starts in the largest."""
    random = np.random.default_rng(SEED)
    times: dict[str, list[float]] = {}
    mean = 0.0
    for size in BATCHES:
        rows = np.ascontiguousarray(given[:, :size])
        g = columns(rows)
        wanted = printed_batch(rows).c
        c = wanted.x, wanted.y
        guesses = np.stack(c) + random.normal(0.0, SPREAD * L1, (STARTS, 2, size))
        mean = forms.natural_batch(g, L1, L2, guesses, c, NEAR)[1] / size
        ways: dict[str, Callable[[], Any]] = {
            "printed": partial(printed_batch, rows),
            "kernel": partial(kernel, rows),
            "relative": partial(forms.relative, g, L1, L2, SIGMA, forms.ARRAYS),
            "natural": partial(forms.natural_batch, g, L1, L2, guesses, c, NEAR),
        }
        for name, way in ways.items():
            times.setdefault(name, []).append(clocked(way, 3 if size < 1000 else 1) / size)
    return {name: np.array(row) for name, row in times.items()}, mean


def by_spread(given: FloatArray) -> tuple[dict[str, FloatArray], FloatArray]:
    """Seconds of natural coordinates (median of the repeats) by solver, and mean number of starts, for SPREADS."""
    solvers = {"natural": forms.FLOATS, "natural, general": forms.FLOATS_GENERAL}
    seconds: dict[str, list[float]] = {name: [] for name in solvers}
    mean = []
    for spread in SPREADS:
        random, tried = np.random.default_rng(SEED), []
        times: dict[str, list[float]] = {name: [] for name in solvers}
        for i in range(REPEATS):
            g = single(given, i)
            truth = forms.vector(g, L1, L2, SIGMA, forms.FLOATS)
            wanted = truth[3], truth[4]
            guesses = starts(g, wanted, spread, random)
            tried.append(len(guesses))
            for name, functions in solvers.items():
                times[name].append(clocked(partial(restarted, g, wanted, guesses, functions), 2))
        for name, row in times.items():
            seconds[name].append(float(np.median(row)))
        mean.append(float(np.mean(tried)))
    return {name: np.array(row) for name, row in seconds.items()}, np.array(mean)
