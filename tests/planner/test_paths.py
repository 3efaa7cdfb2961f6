"""Paths cost little: their corners and splines are found together, and so are the instants of long motions."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from assur.planner.arrays import FloatArray
from assur.planner.geometry import curves
from assur.planner.geometry.curves import Along, Polynomial, Straight
from assur.planner.legs import limits
from assur.planner.legs.state import Knots
from assur.planner.model.path import LineTo, Path, PathPart, Point, SplineThrough
from assur.planner.search.partial_plan import MOST_KNOTS, reported_motion
from assur.planner.trajectory import Trajectory
from tests.planner.cells import cell, go

CORNERS = 20
BEGIN: Point = (0.4, 0.0, 0.1)


def zigzag() -> Path:
    """A path with many rounded corners."""
    parts: list[PathPart] = [LineTo((0.4 + 0.01 * (k % 2), 0.01 * (k + 1), 0.1)) for k in range(CORNERS + 1)]
    return Path(BEGIN, tuple(parts), 5e-4)


def wave(points: int = 100) -> Path:
    """A spline through many points."""
    through = [(0.4 + 0.02 * float(np.sin(0.3 * k)), 0.005 * (k + 1), 0.1) for k in range(points)]
    return Path(BEGIN, (SplineThrough(tuple(through)),))


def test_a_corner_asks_for_few_places_on_the_parts_beside_it(monkeypatch: pytest.MonkeyPatch) -> None:
    calls, own = 0, Straight.at

    def counted(self: Straight, s: FloatArray) -> Along:
        nonlocal calls
        calls += 1
        return own(self, s)

    monkeypatch.setattr(Straight, "at", counted)
    assert len(zigzag().curve.parts) == 2 * CORNERS + 1
    assert calls < 40 * CORNERS


def test_a_spline_is_evaluated_at_once_however_many_points_it_has(monkeypatch: pytest.MonkeyPatch) -> None:
    calls, own = 0, curves._sum

    def counted(c: FloatArray, u: FloatArray) -> FloatArray:
        nonlocal calls
        calls += 1
        return own(c, u)

    monkeypatch.setattr(curves, "_sum", counted)
    asked = []
    for points in (5, 100):
        path = wave(points)
        path.curve.at(np.linspace(0.0, path.length, 200))
        assert path.curve.junctions
        asked.append(calls)
        calls = 0
    assert asked[0] == asked[1]


def test_what_is_found_together_is_what_each_part_says() -> None:
    for path in (zigzag(), wave()):
        s = np.linspace(-0.01, path.length + 0.01, 501)
        curve = path.curve
        for at, point, tangent, bend in zip(s.tolist(), *curve.at(s), strict=True):
            k = int(np.clip(np.searchsorted(curve.edges, at, side="right") - 1, 0, len(curve.parts) - 1))
            part, begin, end = curve.parts[k]
            place = float(np.clip(at - curve.edges[k] + begin, begin, end))
            beyond = at - min(max(at, 0.0), path.length)
            p, t, c = (row[0] for row in part.at(np.array([place])))
            assert point == pytest.approx(p + beyond * t, abs=1e-12)
            assert tangent == pytest.approx(t, abs=1e-9)
            assert bend == pytest.approx(np.zeros(3) if beyond else c, abs=1e-6)


def test_the_middle_of_a_rounded_corner_is_as_far_from_it_as_was_asked() -> None:
    path = zigzag()
    corners = [part for part, _, _ in path.curve.parts if isinstance(part, Polynomial)]
    ends = [part.to for part in path.parts if isinstance(part, LineTo)]
    for corner, end in zip(corners, ends, strict=False):
        middle = 0.5 ** np.arange(6) @ corner.coefficients
        assert np.linalg.norm(middle - np.array(end)) == pytest.approx(path.blend_m, abs=1e-12)


def test_a_long_motion_that_is_told_of_a_refusal_has_a_bounded_number_of_knots() -> None:
    scene = cell(go(0.33, -0.25))
    t = np.linspace(0.0, 100.0, 5 * MOST_KNOTS)
    q = np.stack([np.sin(0.01 * (k + 1) * t) for k in range(4)], 1)
    rates = [np.stack([sign * (0.01 * (k + 1)) ** n * wave(0.01 * (k + 1) * t) for k in range(4)], 1)
             for n, sign, wave in ((1, 1.0, np.cos), (2, -1.0, np.sin))]  # fmt: skip
    long = Knots(np.concatenate([t[:, None], q, *rates], axis=1))
    told = reported_motion(scene, long)
    assert len(told.time) == MOST_KNOTS
    assert (told.start, told.end) == (0.0, 100.0)
    assert np.abs(told.evaluate(t) - q).max() < 1e-6
    short = Knots(long.table[:MOST_KNOTS])
    assert np.array_equal(reported_motion(scene, short).knots, short.table)


def test_times_at_which_a_long_motion_is_looked_at_are_even_in_each_part_that_moves(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(limits, "MOST_FINE", 500)
    time_s = np.cumsum(np.append(0.0, np.random.default_rng(3).uniform(0.5, 2.0, 60)))
    q = np.repeat(np.sin(time_s)[:, None], 4, 1)
    qd = np.repeat(np.cos(time_s)[:, None], 4, 1)
    qd[20:30], q[20:30] = 0.0, q[20]
    motion = Trajectory(time_s, q, qd, np.zeros_like(q))
    t, lasts = limits.instants(motion)
    moving = [(a, b) for k, (a, b) in enumerate(pairwise(time_s.tolist())) if not 20 <= k < 29]
    apart = sum(b - a for a, b in moving) / 500
    parts = [np.linspace(a, b, math.ceil((b - a) / apart) + 1)[:-1] for a, b in moving]
    assert np.array_equal(t, np.append(np.concatenate(parts), time_s[-1]))
    # each stands for as long as it is to the next one, and all of them for as long as the arm moves
    assert lasts.sum() == pytest.approx(500 * apart)
    assert lasts.max() <= apart * (1 + 1e-12)
