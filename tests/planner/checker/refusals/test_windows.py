"""When a point is in its window along a conveyor, by the polynomials of its way: against what a grid of times shows."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from assur.planner.checker.refusals.points import frame_ranges
from assur.planner.checker.refusals.windows import Tracking
from assur.planner.checker.statement import laws
from assur.planner.frames.motion import Pose
from assur.planner.laws import Law, conveyor, keyframes, linear, oscillation, swing, turntable
from assur.planner.laws.ramps import Change
from tests.planner.cells import cell, go

LONG_S = 30.0


def some_belt(rng: np.random.Generator) -> Law:
    pose = Pose(0.1, 0.2, 0.0, float(rng.uniform(-3.0, 3.0)))
    if rng.random() < 0.3:
        return linear(pose, tuple(rng.uniform(-0.1, 0.1, 3).tolist()), valid=(-1e4, LONG_S))
    times = np.cumsum(rng.uniform(2.0, 8.0, 4)).tolist()
    changes = tuple(
        Change(t, float(rng.choice([0.0, *rng.uniform(-0.3, 0.3, 2)])), 0.5, float(rng.choice([5.0, math.inf])))
        for t in times
    )
    return conveyor(pose, float(rng.uniform(-0.3, 0.3)), changes=changes, valid=(-1e4, LONG_S))


def some_tracking(rng: np.random.Generator) -> Tracking:
    law, low = some_belt(rng), float(rng.uniform(-0.6, 0.5))
    return Tracking(
        frame="belt",
        law=law,
        point=(float(rng.uniform(-0.3, 0.3)), 0.1, 0.0, 0.0),
        along=(low, low + float(rng.uniform(0.01, 0.6))),
        in_time=(-math.inf, math.inf),
        known=laws.known(law),
        needed=1.0,
        start=float(rng.uniform(0.0, 2.0)),
        latest=math.inf,
    )


def test_a_point_is_inside_at_the_times_at_which_a_grid_has_it_inside() -> None:
    rng, inside, outside = np.random.default_rng(8), 0, 0
    for _ in range(60):
        of = some_tracking(rng)
        assert of.along is not None
        spans, times = of.inside(), np.linspace(of.start, LONG_S, 400)
        ways = of.way(laws.formula_of(of.law, of.start, LONG_S))(times)
        low, high = of.along
        for t, x in zip(times.tolist(), ways.tolist(), strict=True):
            known = any(a - 1e-9 <= t <= b + 1e-9 for a, b in spans)
            if min(abs(x - low), abs(x - high)) > 1e-7:
                assert known is (low < x < high), (t, x, spans)
        assert all(a <= b for a, b in spans)
        assert all(one[1] < other[0] for one, other in pairwise(spans))
        nearest, farthest = float(np.maximum(low - ways, ways - high).min()), of.farthest()
        assert (farthest <= 1e-9) is bool(spans)
        if not spans:  # between two times of the grid it may be somewhat nearer
            assert nearest - 0.05 <= farthest <= nearest + 1e-9
        inside, outside = inside + bool(spans), outside + (not spans)
    assert min(inside, outside) > 5


def test_a_point_on_no_conveyor_has_no_window_and_can_be_met_at_all_times() -> None:
    of = replace(some_tracking(np.random.default_rng(1)), along=None)
    assert of.inside() == [(of.start, LONG_S)]
    assert of.farthest() == -math.inf


MOVING = {
    "turntable": turntable(Pose(0.3, 0.1, 0.0, 0.4), 1.3),
    "swing": swing(Pose(0.3, 0.1, 0.0, 0.4), 0.7, 3.0, 0.2),
    "oscillation": oscillation(Pose(0.3, 0.1, 0.0, 0.4), (0.6, 0.8, 0.0), 0.1, 2.0),
    "keyframes": keyframes(
        [0.0, 1.0, 2.5, 4.0], [Pose(), Pose(0.2, 0.1, 0.0, 0.5), Pose(0.1, -0.2, 0.1, -0.3), Pose()], ends="periodic"
    ),
}


@pytest.mark.parametrize("name", MOVING)
def test_bounds_of_aframe_over_an_interval_hold_all_of_its_places(name: str) -> None:
    law, rng = MOVING[name], np.random.default_rng(2)
    for wide in (1e-3, 0.1, 5.0):
        begin = float(rng.uniform(0.0, 9.0))
        spans = frame_ranges(law, (begin, begin + wide))
        for t in np.linspace(begin, begin + wide, 40).tolist():
            for span, value in zip(spans, laws.place_at(law, t), strict=True):
                assert span.low <= value <= span.high
        if wide < 0.01:
            assert max(span.high - span.low for span in spans) < 0.01


@pytest.mark.parametrize("name", MOVING)
def test_a_frame_that_repeats_its_motion_is_where_it_was_after_a_period(name: str) -> None:
    law = MOVING[name]
    period = laws.period_of(law)
    assert period is not None
    for t in (0.3, 1.7, 3.1):
        one, other = laws.place_at(law, t), laws.place_at(law, t + period)
        assert one[:3] == pytest.approx(other[:3], abs=1e-9)
        assert math.remainder(one[3] - other[3], math.tau) == pytest.approx(0.0, abs=1e-9)


def test_what_travels_for_ever_or_stands_has_no_period() -> None:
    rng = np.random.default_rng(9)
    assert laws.period_of(some_belt(rng)) is None
    assert laws.period_of(cell(go(0.35, 0.2)).frames["world"].law) is None
