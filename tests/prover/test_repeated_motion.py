"""Frames that repeat their motion are where the same motion brings them that is written out."""

from __future__ import annotations

import math

import pytest
from flint import arb, ctx

from assur.prover import prove as prover
from tests.prover.bundles import Document, agreed
from tests.prover.test_guards import ball, body, frame, row, sliding
from tests.prover.test_stated_rows import LITTLE

EDGES, GAIN = [-0.5, -0.25, 0.0, 0.5], 0.125
WAYS: list[list[list[float]]] = [
    [[], [2.0], [], [3.0]], [[], [-2.0], [], [-3.0]], [[], [], [], []],
]  # fmt: skip


def dial(**changes: object) -> Document:
    """From -0.5 s on: in each second it goes 0.125 m along y and turns by 0.1875 rad, and rests for half of it."""
    own = {"edges": EDGES, "acceleration": WAYS, "period": 1.0, "step": [0.0, GAIN, 0.0, 1.5 * GAIN]}
    return frame("dial", pose=[0.1, 0.2, 0.3, 0.4], **{**own, **changes})


def written_out(periods: int) -> Document:
    edges = [-0.5, *(t + k for k in range(periods) for t in EDGES[1:])]
    return dial(period=0.0, step=[0.0] * 4, edges=edges, acceleration=WAYS * periods)


def test_a_motion_that_repeats_is_the_same_written_out() -> None:
    before = ctx.prec, ctx.cap
    ctx.prec, ctx.cap = prover.BITS, prover.TERMS
    try:
        one, other = prover.law(dial()), prover.law(written_out(6))
        for low, high in ((-0.5, -0.5), (0.5, 0.5), (0.6, 0.7), (0.4, 0.6), (-0.2, 1.3), (3.5, 3.5), (4.9, 5.2)):
            both = zip(one.over(arb(low), arb(high)), other.over(arb(low), arb(high)), strict=True)
            for x, y in both:
                for k in range(3):
                    assert x[k].overlaps(y[k])
                    assert abs(x[k].mid() - y[k].mid()) < (1e-30 if low == high else 1e-6)
                    assert abs(x[k].rad() - y[k].rad()) < 1e-6
        # long after, too
        far = one.over(arb(1000.5), arb(1000.5))
        assert abs(far[1][0] - (arb(0.2) + 1001 * GAIN)) < 1e-30
        for low, high in ((-0.6, -0.4), (0.0, 3.5)):  # it is not known, or repeats too often to be bounded at once
            with pytest.raises(ArithmeticError):
                one.over(arb(low), arb(high))
    finally:
        ctx.prec, ctx.cap = before


def test_what_rounding_leaves_of_a_period_is_spread_over_it() -> None:
    before = ctx.prec, ctx.cap
    ctx.prec, ctx.cap = prover.BITS, prover.TERMS
    try:
        step = [0.0, GAIN + 1e-10, 0.0, 1.5 * GAIN]
        rough = prover.law(dial(step=step))
        ends = [rough.over(arb(t), arb(t))[1] for t in (0.5 - 2**-60, 0.5)]
        assert abs(ends[0][0] - ends[1][0]) < 1e-17
        assert abs(ends[0][1] - ends[1][1]) < 1e-17
        assert abs(ends[1][0] - (arb(0.2) + step[1])) < 1e-30
        for changes in ({"step": [0.0, GAIN + 1e-8, 0.0, 1.5 * GAIN]}, {"rate": [0.0, 0.0, 0.0, 1e-8]}):
            with pytest.raises(ValueError, match="where the next one begins"):
                prover.law(dial(**changes))
        with pytest.raises(ValueError, match="last one period"):
            prover.law(dial(edges=[*EDGES[:-1], math.nextafter(0.5, 0.0)]))
        with pytest.raises(ValueError, match="last one period"):
            prover.law(dial(edges=[], acceleration=[]))
    finally:
        ctx.prec, ctx.cap = before


def passing(least: float, **changes: object) -> Document:
    """A ball at the origin; another comes nearer by 0.5 m in each 0.25 s, and goes back. Rows follow the clock."""
    document = sliding(body("part", ball(0.9)), rows=[row(0, 1)], least=least)
    ways: list[list[list[float]]] = [[[a], [], [], []] for a in (-128.0, 128.0, 128.0, -128.0)]
    edges = [-0.0625 + 0.0625 * k for k in range(5)]
    document["frames"][1].update(rate=[0.0] * 4, edges=edges, acceleration=ways, period=0.25, **changes)
    document["seats"][1]["frame"] = 1
    return document


def test_every_period_counts() -> None:
    assert agreed(passing(0.2 - LITTLE))[0]
    assert not agreed(passing(0.2 + LITTLE))[0]
    assert agreed(passing(0.2 - LITTLE))[1]["frames that repeat their motion"] == 1
    # 5 mm nearer after each period: from the second on it is too near
    nearer = passing(0.2 - LITTLE, step=[-1e-10, 0.0, 0.0, 0.0])
    assert agreed(nearer)[0]
    nearer["required"].update(travel=0.2 - 2e-10, near=0.2 - 2e-10)
    assert not agreed(nearer)[0]


def test_a_late_start_over_many_periods_is_shown() -> None:
    document = passing(0.15)
    document["required"]["late"] = 1.5
    assert not agreed(document)[0]
    document["rows"][0]["s1"] = 1.5
    assert agreed(document)[0]
    document["required"].update(travel=0.21, near=0.21)
    assert not agreed(document)[0]
