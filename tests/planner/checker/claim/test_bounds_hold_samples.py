"""Jets over random intervals hold what carriers do at instants within, and rounding is within its bound."""

from __future__ import annotations

import json
import math
from fractions import Fraction

import numpy as np
import pytest
from flint import arb, arb_series, ctx

from assur.planner.arrays import FloatArray
from assur.planner.checker.claim import tables as tb
from assur.planner.checker.claim.chain import slot_of
from assur.planner.checker.claim.joint_bounds import sum_within
from assur.planner.checker.claim.motion import make_curves, make_laws, over, through_loop
from assur.planner.checker.claim.solids import Jet, inverse, polynomial, root, times, turned
from assur.planner.checker.claim.verdict import prepare
from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from assur.prover import prove as prover
from tests.forgeries.claims import read
from tests.prover.bundles import bundle

SCENARIOS = ("demo", "five-bar", "rv-m1", "loader", "shutter", "two-robots", "parabolic-blend", "polar-arm")
INTERVALS, SAMPLES = 12, 9


def prepared(name: str) -> tuple[Claim, tb.Geometry, tb.Scratch]:
    """The claim of a scenario, with its motions."""
    claim = read(json.loads(json.dumps(bundle(name))))
    geometry, scratch = prepare(claim)
    make_laws(claim, geometry, scratch)
    assert make_curves(claim, geometry, scratch)
    return claim, geometry, scratch


@pytest.mark.parametrize("name", SCENARIOS)
def test_jets_of_carriers_hold_samples(name: str) -> None:
    claim, geometry, scratch = prepared(name)
    rng, tested = np.random.default_rng(1), 0
    begin, end = claim.knots[0, 0], claim.knots[int(claim.arms[0, c.ARM_KNOTS]) - 1, 0]
    for _ in range(INTERVALS):
        h = (end - begin) * 10.0 ** rng.uniform(-4, -0.7)
        t0 = rng.uniform(begin, end - h)
        for on in range(len(geometry.carriers)):
            slot = slot_of(claim, geometry, scratch, on, t0, t0 + h)
            if slot < 0:
                continue
            jets = scratch.jets[slot, on].copy()
            for t in np.linspace(t0, t0 + h, SAMPLES).tolist():
                at = slot_of(claim, geometry, scratch, on, t, t)
                assert at >= 0
                values = scratch.jets[at, on, :, ::2]
                for order in range(3):
                    off = np.abs(values[:, order] - jets[:, 2 * order])
                    rounds = geometry.rounds[on, 2 * order : 2 * order + 2].sum()
                    assert (off <= jets[:, 2 * order + 1] + 4.0 * rounds + 1e-14).all(), (on, order)
                    tested += 12
    assert tested > 1000


def exact(knots: FloatArray, j: int, t: float) -> tuple[Fraction, Fraction, Fraction, Fraction]:
    """Value and three derivatives of a joint between two knots, without rounding."""
    (t0, *one), (t1, *other) = [[Fraction(float(x)) for x in row] for row in knots]
    n = c.MOST_JOINTS
    x, v, p = one[j], one[j + n], one[j + 2 * n]
    y, w, q = other[j], other[j + n], other[j + 2 * n]
    h, d, s = t1 - t0, y - x, Fraction(t) - t0
    a3 = (20 * d - (8 * w + 12 * v) * h - (3 * p - q) * h**2) / (2 * h**3)
    a4 = (-30 * d + (14 * w + 16 * v) * h + (3 * p - 2 * q) * h**2) / (2 * h**4)
    a5 = (12 * d - 6 * (v + w) * h + (q - p) * h**2) / (2 * h**5)
    value = x + v * s + p / 2 * s**2 + a3 * s**3 + a4 * s**4 + a5 * s**5
    rate = v + p * s + 3 * a3 * s**2 + 4 * a4 * s**3 + 5 * a5 * s**4
    return value, rate, p + 6 * a3 * s + 12 * a4 * s**2 + 20 * a5 * s**3, 6 * a3 + 24 * a4 * s + 60 * a5 * s**2


@pytest.mark.parametrize("name", ["demo", "two-robots-neighbour", "parabolic-blend"])
def test_joints_round_by_no_more_than_is_stated(name: str) -> None:
    """The bounds of the links hold the rounding of each joint: links turn by at least as much as their joints do."""
    claim, geometry, scratch = prepared(name)
    rng, curve, worst = np.random.default_rng(4), 0, np.zeros(3)
    for i in range(int(claim.arms[0, c.ARM_KNOTS]) - 1):
        t0, t1 = claim.knots[i : i + 2, 0].tolist()
        if t0 == t1:
            continue
        for j in range(int(claim.arms[0, c.ARM_JOINTS])):
            t = rng.uniform(t0, t1)
            made = over(geometry.curves, curve, tb.CURVE_POWER + tb.POWERS * j, t, t, scratch.work)
            right = exact(claim.knots[i : i + 2], j, t)
            off = [abs(float(Fraction(made[2 * order]) - right[order])) for order in range(3)]
            worst = np.maximum(worst, off)
        curve += 1
    assert (worst <= geometry.rounds[0, tb.ROUND_TURN :: 2]).all()
    assert (worst > 0.0).all()


def within(claim: Claim, knots: FloatArray, t: float, order: int, low: float, high: float) -> bool:
    """Whether the checker shows bounds of a derivative of the first joint at an instant, of a motion of two knots."""
    arms, own, state = claim.arms.copy(), np.zeros(c.SUM), np.zeros(tb.STATE)
    arms[0, c.ARM_KNOTS] = 2.0
    own[[c.SUM_T0, c.SUM_T1, c.SUM_ORDER, c.SUM_SHARE, c.SUM_LOW, c.SUM_HIGH]] = t, t, order, 1.0, low, high
    state[tb.WORK] = 1e6
    stack = np.zeros((2 * tb.DEEPEST + 8, max(tb.POWERS + 1, c.SUM, tb.OBJECT)))
    return bool(sum_within(claim._replace(knots=knots, arms=arms), own, -1.0, stack, state))


def rounded(knots: FloatArray, h: float, order: int) -> float:
    """(R5), for the first joint of two knots."""
    x, v, a = (np.abs(knots[:, column]).sum() for column in (c.KNOT_Q, c.KNOT_QD, c.KNOT_QDD))
    if order == 0:
        return float(4.0 * tb.ULP * (x + h * v + h * h * a))
    terms = 5.0 * abs(knots[1, c.KNOT_Q] - knots[0, c.KNOT_Q]) / h + 2.0 * v + 0.25 * h * a
    return float(4.0 * tb.ULP * terms * (8.0 / h) ** (order - 1))


@pytest.mark.parametrize("order", [0, 1, 2, 3])
@pytest.mark.parametrize("h", [2e-5, 1e-3, 0.3])
def test_bounds_at_an_instant_hold_without_rounding_and_are_near_that(order: int, h: float) -> None:
    """What coefficients on a part of a piece may round by is taken off, and little more: (R5), and inside a piece some
    rounding units of the largest coefficient."""
    claim, _, _ = prepared("demo")
    rng, columns = np.random.default_rng(order), [0, c.KNOT_Q, c.KNOT_QD, c.KNOT_QDD]
    for k in range(200):
        at_begin, knots = k % 3 == 0, np.zeros((2, claim.knots.shape[1]))
        size, begin = 10.0 ** rng.uniform(-3, 0.5), rng.choice([0.0, 1.0, 9_000.0])
        a, b, j = rng.uniform(-1, 1, 3) * size
        knots[0, columns] = begin, size, a, b
        knots[1, columns] = begin + h, size + h * (a + h * (b / 2 + h * j / 6)), a + h * (b + h * j / 2), b + h * j
        t = knots[0, 0] if at_begin else rng.uniform(knots[0, 0], np.nextafter(knots[1, 0], 0.0))
        right = exact(knots, 0, t)[order]
        value = float(right)
        above = np.nextafter(value, np.inf) if Fraction(value) <= right else value
        below = np.nextafter(value, -np.inf) if Fraction(value) >= right else value
        assert not within(claim, knots, t, order, above, np.inf)
        assert not within(claim, knots, t, order, -np.inf, below)
        off = 2.0 * rounded(knots, knots[1, 0] - knots[0, 0], order) + 8.0 * tb.ULP * abs(value)
        if not at_begin:  # no coefficient is more than 20 times as large as the polynomial
            values = [exact(knots, 0, s)[order] for s in np.linspace(knots[0, 0], knots[1, 0], 9).tolist()]
            off += 12.0 * (5 - order) * tb.ULP * 20.0 * float(max(map(abs, values)))
        assert within(claim, knots, t, order, value - off, value + off)


@pytest.mark.parametrize("name", SCENARIOS)
def test_links_round_by_no_more_than_is_stated(name: str) -> None:
    """At instants, against places, columns and both derivatives of them in balls of 160 bits."""
    claim, geometry, scratch = prepared(name)
    before, (ctx.prec, ctx.cap) = (ctx.prec, ctx.cap), (prover.BITS, prover.TERMS)
    try:
        exact_links = prover.World(prover.read(json.dumps(bundle(name)).encode()))
        rng, worst = np.random.default_rng(6), np.zeros(3)
        begin, end = claim.knots[0, 0], claim.knots[int(claim.arms[0, c.ARM_KNOTS]) - 1, 0]
        for t in rng.uniform(begin, end, 40).tolist():
            for on in range(int(claim.arms[0, c.ARM_LINKS])):
                slot, rounds = slot_of(claim, geometry, scratch, on, t, t), geometry.rounds[on]
                link = exact_links.carrier(on, -1, t, t)
                assert slot >= 0
                vectors = [link.place, *link.columns]
                for row, series in enumerate(number for vector in vectors for number in vector):
                    for order in range(3):
                        right = series[order] * math.factorial(order)
                        off = float(abs(right - arb(scratch.jets[slot, on, row, 2 * order])).upper())
                        most = float(rounds[2 * order + (tb.ROUND_PLACE if row < 3 else tb.ROUND_TURN)])
                        assert off <= most, (on, row, order)
                        worst[order] = max(worst[order], off)
    finally:
        ctx.prec, ctx.cap = before
    assert (worst > 0.0).all()


def test_a_vertical_slide_of_an_upright_link_turns_nothing() -> None:
    """Its 3 m, counted for each link that slides, made the bounds of a five-bar twice as large as its reach does."""
    claim, geometry, _ = prepared("five-bar")
    slides = np.flatnonzero(claim.links[:, c.LINK_SLIDE] >= 0.0)
    far = geometry.rounds[slides, tb.ROUND_PLACE] / geometry.rounds[slides, tb.ROUND_TURN]
    assert len(slides) > 0
    assert (far < 3.0).all()


@pytest.mark.parametrize(("cranks", "sine"), [(2.0, 0.3), (14.0, 0.01), (20.0, 0.05), (200.0, 0.05)])
def test_a_coupler_changes_no_faster_with_its_cranks_than_is_stated(cranks: float, sine: float) -> None:
    """(R4), where it is nearest to what is true: long cranks across the line of their origins turn in opposite
    directions, and couplers of 1 m are nearly stretched."""
    apart, before = 2.0 * math.cos(0.5 * math.asin(sine)), (ctx.prec, ctx.cap)
    ctx.prec, ctx.cap = 200, 4
    try:
        turn = arb_series([0, 1])
        x, y = apart + cranks * turn.sin(), arb_series([0, 0])  # from the end of one crank to that of the other
        coupler = (y / x).atan() + ((x * x + y * y).sqrt() / 2).acos()
        first, second, third = (abs(float(coupler[k])) * math.factorial(k) for k in (1, 2, 3))
    finally:
        ctx.prec, ctx.cap = before
    claim, _, _ = prepared("five-bar")
    loops = claim.loops.copy()
    loops[0, c.LOOP_LENGTH : c.LOOP_SIDE] = 0.5 * cranks, 0.5 * cranks, 1.0, 1.0
    loops[0, c.LOOP_LEAST] = sine

    def errors(*of_cranks: float) -> FloatArray:
        found = np.array([*of_cranks, *np.zeros(6 - len(of_cranks))])
        through_loop(claim._replace(loops=loops), 0, apart, found)
        return found

    assert first <= errors(0.0, 1.0)[1]
    assert second <= errors(1.0, 0.0, 0.0, 1.0)[1]
    assert third <= errors(1.0, 0.0, 0.0, 1.0)[2]
    if cranks > 10.0:  # two thirds of it are too little
        assert third > errors(1.0, 0.0, 0.0, 1.0)[2] / 1.5


def jet_of(powers: FloatArray, a: float, b: float) -> Jet:
    """The jet of a polynomial over [a, b]."""
    return polynomial(powers, 0, 5, a, b, np.zeros(8))


def functions(x: Jet, y: Jet) -> tuple[Jet, ...]:
    """All functions of jets: of x > 0 and y."""
    return times(x, y), *turned(y), inverse(x), root(x)


def test_jets_of_functions_hold_samples() -> None:
    rng = np.random.default_rng(5)
    for _ in range(60):
        one, other = rng.normal(size=(2, 6))
        one[0], h = 3.0 + abs(one[1:]).sum(), rng.uniform(0.01, 0.9)
        wide = functions(jet_of(one, 0.0, h), jet_of(other, 0.0, h))
        for t in np.linspace(0.0, h, 7).tolist():
            for at, bounds in zip(functions(jet_of(one, t, t), jet_of(other, t, t)), wide, strict=True):
                for k in (0, 2, 4):
                    assert abs(at[k] - bounds[k]) <= bounds[k + 1] * (1.0 + 1e-9) + 1e-12


@pytest.mark.parametrize(("later", "most"), [(0.0, 1e-13), (9e4, 5e-10)])
def test_a_law_rounds_by_what_its_time_in_the_plan_is_and_not_by_all_that_follows(later: float, most: float) -> None:
    """A belt at 1 m/s, whose pose is stated at time 0, in a plan at that time and in one a day later."""
    claim = read(json.loads(json.dumps(bundle("demo"))))
    belt = int(np.flatnonzero(claim.frames[:, c.FRAME_PIECES] > 0.0)[0])
    row, on = claim.frames[belt], len(claim.links) + belt
    row[c.FRAME_RATE] = 1.0
    claim.phases[:, c.PHASE_T0 : c.PHASE_T1 + 1] += later
    claim.required[0, c.REQUIRED_UNTIL] += later
    assert claim.laws[int(row[c.FRAME_PIECE] + row[c.FRAME_PIECES]) - 1, c.LAW_END] == c.LATEST_S
    geometry, scratch = prepare(claim)
    assert make_laws(claim, geometry, scratch)
    begin, end = claim.phases[0, c.PHASE_T0], claim.phases[-1, c.PHASE_T1]
    stated = geometry.rounds[on, tb.ROUND_PLACE]
    assert stated <= 3.0 * most
    for t in np.random.default_rng(3).uniform(begin, end, 50).tolist():
        slot = slot_of(claim, geometry, scratch, on, t, t)
        since = Fraction(t) - Fraction(float(claim.laws[int(row[c.FRAME_PIECE]), c.LAW_BEGIN]))
        exact_x = Fraction(float(row[c.FRAME_POSE])) + since
        assert abs(Fraction(float(scratch.jets[slot, on, 0, 0])) - exact_x) <= Fraction(float(stated))
    for t in (begin - 2.0, end + 2.0):  # lateness and shifts are less
        assert slot_of(claim, geometry, scratch, on, t, t) == -1 - tb.NOT_GIVEN
