"""What the prover says of motions and solids holds what the planner's formulas give; no number shows nothing."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from flint import arb, ctx
from hypothesis import given, settings
from hypothesis import strategies as st

from assur.planner.geometry.shapes import Piece, box, capsule, cylinder, sphere
from assur.planner.geometry.shapes import support as exact
from assur.planner.trajectory import Trajectory
from assur.prover import prove as prover
from assur.prover.prove import Carrier, Curve, Solid, chain, law, spline, upright
from tests.planner.laws.laws import Case, cases
from tests.planner.robots.families import NAMES, random_motion, robot_named
from tests.prover.bundles import arm_document, body_document, law_document

NEAR = 1e-9
"""How far sampled values may be outside of what holds them: the rounding of those who sample."""


@pytest.fixture(autouse=True)
def precision() -> Iterator[None]:
    before = ctx.prec, ctx.cap
    ctx.prec, ctx.cap = prover.BITS, prover.TERMS
    yield
    ctx.prec, ctx.cap = before


def holds(ball: arb, value: float, near: float = NEAR) -> bool:
    return bool(float(ball.lower()) - near <= value <= float(ball.upper()) + near)


def wide(ball: arb) -> float:
    return float(ball.upper() - ball.lower())


def path(q: np.ndarray, rng: np.random.Generator) -> Trajectory:
    """A little motion about some joints (n,)."""
    t = np.array([0.0, 0.05, 0.12])
    states = [q + 0.01 * rng.normal(size=(3, len(q))), rng.normal(size=(3, len(q))), 5.0 * rng.normal(size=(3, len(q)))]
    return Trajectory(t, *states)


@pytest.mark.parametrize("name", NAMES)
def test_links_are_where_the_planner_has_them(name: str) -> None:
    robot, rng = robot_named(name), np.random.default_rng(3)
    for k in range(4):
        motion = path(random_motion(robot, 5, 20)[0][k], rng)
        arm = arm_document(robot, motion, 0.0, 0.12)
        curve = spline(arm)
        for t0, t1 in ((0.0, 0.12), (0.03, 0.031), (0.05, 0.05), (0.04, 0.07)):
            try:
                links = chain(arm, curve.over(arb(t0), arb(t1)))
            except ArithmeticError:
                assert robot.parallel_least > 0.0
                continue
            t = np.linspace(t0, t1, 20)
            place, turn = robot.placements(motion.evaluate(t))
            for number in range(len(robot.links)):
                carrier = links[number]
                assert carrier.upright == (number not in robot.tilting)
                for i in range(3):
                    assert all(holds(carrier.place[i][0], x) for x in place[:, number, i])
                    for j in range(3):
                        assert all(holds(carrier.columns[j][i][0], x) for x in turn[:, number, i, j])


@given(cases(), st.floats(0, 1), st.floats(0, 1), st.booleans())
@settings(max_examples=150, deadline=None)
def test_frames_are_where_their_laws_have_them(case: Case, one: float, other: float, ends: bool) -> None:
    low, high = case.window
    begin, until = (low + 0.01, high - 0.01) if math.isfinite(case.law.valid[0]) else (low, high)
    known = replace(case.law, valid=(max(-99.0, case.law.valid[0]), high)) if ends else case.law
    frame = law_document(known, begin)
    t0, t1 = sorted(begin + share * (until - begin) for share in (one, other))
    if frame["period"] > 0.0:
        t1 = min(t1, t0 + frame["period"])  # an interval of more periods is halved first
    t = np.linspace(t0, t1, 30)
    motion = case.law.motion(t)
    world = prover.World.__new__(prover.World)
    world.frames, world.laws = [{**frame, "arm": -1}], [law(frame) if frame["edges"] else None]
    carrier = world.frame(0, arb(t0), arb(t1))
    for i in range(3):
        assert all(holds(carrier.place[i][0], x) for x in motion.p[:, i])
        assert all(holds(carrier.place[i][1], x, 1e-7) for x in motion.v[:, i])
        # the acceleration may jump within the interval, and both sides count
        assert all(holds(carrier.place[i][2] * 2, x, 1e-6) for x in motion.a[1:-1, i])
    assert all(holds(carrier.columns[0][0][0], x) for x in np.cos(motion.yaw))
    assert all(holds(carrier.columns[0][1][0], x) for x in np.sin(motion.yaw))
    if t1 - t0 < 1e-3:
        assert wide(carrier.place[0][0]) < 0.1


def test_a_spline_is_that_of_the_planner_with_its_derivatives() -> None:
    rng = np.random.default_rng(1)
    motion = path(np.array([0.3, -1.0, 0.1]), rng)
    curve = spline({"time": motion.time.tolist(), **{x: getattr(motion, x).tolist() for x in ("q", "qd", "qdd")}})
    for t in np.linspace(0.0, 0.12, 41).tolist():
        found = curve.over(arb(t), arb(t))
        for order in range(4) if t not in motion.time else range(3):
            value = motion.evaluate(np.array(t), order)
            for j in range(3):
                ball = found[j][order] * math.factorial(order)
                assert abs(float(ball.mid()) - value[j]) <= 1e-9 * 10.0 ** (2 * order)


@pytest.mark.parametrize(
    "shape", [box(0.2, 0.1, 0.05), cylinder(0.04, 0.3), capsule(0.03, 0.2), sphere(0.07)], ids=lambda s: s.kind
)
def test_supports_are_those_of_the_planner(shape: object) -> None:
    from assur.planner.geometry.shapes import AXES, Body

    rng = np.random.default_rng(2)
    for axis in "xyz":
        piece = Piece(shape, rng.normal(size=3), AXES[axis])  # type: ignore[arg-type]
        (made,) = body_document(Body("body", (piece,)))["pieces"]
        solid = Solid(made, [0.0, 0.0, 0.0, 0.0])
        unit = [[arb(float(i == k)) for i in range(3)] for k in range(3)]
        for n in rng.normal(size=(10, 3)):
            m = [arb(x) for x in n.tolist()]
            found = solid.support([arb(0)] * 3, unit, m, prover.dot(m, m).sqrt(), True)
            assert abs(float(found.mid()) - exact(piece, n)) <= 1e-12
            assert found.upper() >= exact(piece, n) - 1e-14


def test_what_turns_about_the_vertical_does_not_change_an_upright_disc_but_a_lying_one() -> None:
    still, turning = [arb(0)] * 3, [[arb(-1), arb(0), arb(0)], [arb(0), arb(-1), arb(0)], [arb(0)] * 3]
    disc = {"centre": [0, 0, 0], "edges": [], "disc": 0.1, "axis": [0, 0, 1], "ball": 0.5, "vertices": []}
    m = [arb(1), arb(0), arb(0)]
    assert Solid(disc, [0.0] * 4).support(still, turning, m, None, True) == 0
    assert Solid(disc, [0.0] * 4).support(still, turning, m, None, False) >= 0.1
    assert Solid({**disc, "axis": [0, 1, 0]}, [0.0] * 4).support(still, turning, m, None, True) >= 0.1


def test_no_number_shows_nothing() -> None:
    assert not prover.largest([arb(1), arb("nan"), arb(2)]) <= 5
    assert not prover.length([arb("nan"), arb(0)]) <= 5
    assert not Curve([0.0, 1.0], [[]]).over(arb(0), arb(1))
    with pytest.raises(ArithmeticError):
        Curve([0.0, 1.0], [[]]).over(arb(0), arb(1.5))
    with pytest.raises(ArithmeticError):
        Curve([0.0, 1.0], [[]]).over(arb("nan"), arb(0.5))
    world = prover.World.__new__(prover.World)
    world.work, world.splines, world.laws = 10_000, [], []
    assert not world.everywhere(lambda *_: prover.IN_TIME, 0.0, 1.0)
    assert world.everywhere(lambda t0, t1, *_: prover.SHOWN if t1 - t0 < 0.01 else prover.IN_TIME, 0.0, 1.0)
    assert not world.everywhere(lambda t0, *_: prover.WRONG if t0 > 0.9 else prover.IN_TIME, 0.0, 1.0)


def test_carriers_know_whether_they_stay_upright() -> None:
    zero, one = prover.constant(0), prover.constant(1)
    carrier = upright([zero, zero, zero], zero, one)
    assert isinstance(carrier, Carrier)
    assert carrier.upright
    assert float(carrier.point([arb(1), arb(2), arb(3)])[1][0]) == 2.0
