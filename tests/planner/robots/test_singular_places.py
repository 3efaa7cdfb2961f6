"""Serial arms at their singular places, one by one: what is known there, what it is called, where it begins."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.experiments.differential import determinant, jacobian
from assur.planner.frames.motion import Motion, Pose
from assur.planner.robots.facts import Code
from assur.planner.robots.robot import Robot
from assur.planner.robots.scara import Scara
from assur.planner.robots.tilting import PolarArm
from tests.planner.robots.families import BASE, FAR, elbow, far, five_axis, polar, random_q, scara

L1, L2, L3 = 0.25, 0.16, 0.072
"""Of the elbow arm and the five-axis arm, m."""
HEIGHT = {"arm": 0.2, "elbow": 0.3, "polar": 0.4, "five": 0.3}
"""Of the plane z = 0 of the targets over the base, m: the shoulder, if there is one."""
UP = np.pi / 2
AT, OUT, IN = Code.ASSEMBLED, Code.STRETCHED, Code.FOLDED
OVER, NOWHERE, ANYHOW = Code.ALIGNED, Code.OUT_OF_REACH, Code.INDETERMINATE
IN_PLANE = [(0.4, 0.0, 0.0, AT), (0.55, 0.0, 0.0, OUT), (0.1, 0.0, 0.0, IN), (0.7, 0.0, 0.0, NOWHERE)]
ELBOWS = [
    (0.3, 0.0, 0.0, AT),
    (L1 + L2, 0.0, 0.0, OUT),
    (L1 - L2, 0.0, 0.0, IN),
    (0.5, 0.1, 0.0, NOWHERE),
    (0.0, 0.3, UP, OVER),
    (0.0, L1 + L2, UP, OVER),
    (0.0, 0.6, UP, NOWHERE),
]
"""Radius and height over the shoulder, m, of the end of two links; the pitch of a hand from there; what it is."""
CASES: list[tuple[Robot, list[tuple[float, float, float, Code]]]] = [
    *((scara(axes, base), [*IN_PLANE, (0.05, 0.0, 0.0, NOWHERE)]) for axes in (3, 4) for base in (Pose(), BASE, FAR)),
    (scara(l1=0.2, l2=0.2), [(0.0, 0.0, 0.0, ANYHOW)]),
    (elbow(Pose()), ELBOWS),
    (polar(Pose()), [(0.3, 0.1, 0.0, AT), (0.0, 0.3, 0.0, OVER), (0.0, 0.0, 0.0, ANYHOW)]),
    # over the axis also where the wrist is far from it
    (five_axis(Pose()), [*ELBOWS, (-L3 * np.cos(0.4), 0.25 - L3 * np.sin(0.4), 0.4, OVER)]),
]


def targets(robot: Robot, rows: list[tuple[float, float, float, Code]], mode: int) -> Motion:
    """Moving targets straight ahead of the base, those of a hand as long as it is beyond them (in `back` modes: at
    the pitch π for 0)."""
    x, h, pitch = (np.array([row[k] for row in rows], dtype=np.float64) for k in range(3))
    if robot.name == "five":
        pitch = np.where((pitch == 0.0) & (mode > 1), np.pi, pitch)
        x = np.where(pitch == np.pi, x + L3, x + L3 * np.cos(pitch))
        h = h + L3 * np.sin(pitch)
    base = robot.base
    p = np.stack([np.cos(base.yaw) * x, np.sin(base.yaw) * x, h + HEIGHT[robot.name]], -1) + base.position
    one, turn = np.ones_like(p), np.ones_like(x)
    motion = Motion.of(p, one, one, one, turn, turn, turn, turn)
    if robot.name != "five":
        return motion
    tilt = np.stack([pitch, 0.3 * turn], -1)
    return motion.with_tilt(tilt, *(0.1 * np.ones((3, *tilt.shape))))


@pytest.mark.parametrize(
    ("robot", "rows", "mode"), [(robot, rows, k) for robot, rows in CASES for k in range(len(robot.modes))]
)
def test_every_case_comes_through_with_what_is_defined(
    robot: Robot, rows: list[tuple[float, float, float, Code]], mode: int
) -> None:
    flange = targets(robot, rows, mode)
    with np.errstate(all="raise"):
        got = robot.inverse(flange, mode)
    assert got.code.tolist() == [row[3] for row in rows]
    for row, code in enumerate(got.code):
        nothing = code in (NOWHERE, ANYHOW)
        assert np.isfinite(got.q[row]).tolist() == [not nothing and code != OVER, *[not nothing] * (got.q.shape[1] - 1)]
        assert (got.margin[row] == 0.0) == (code in (OUT, IN, OVER))
        assert np.isnan(got.margin[row]) == nothing or robot.name == "polar"
        for rate in (got.qd, got.qdd, got.qddd):
            assert np.isfinite(rate[row]).all() == (code == AT)
            assert np.isnan(rate[row]).all() == (code != AT)
        if not nothing:
            posture = got.q[row].copy()
            posture[0] = 1.234 if code == OVER else posture[0]  # over the axis it is known, whatever the base angle
            assert np.abs(robot.forward(posture)[0] - flange.p[row]).max() < 1e-14 * far(robot)
    if isinstance(robot, Scara) and len(rows) > 2:
        assert got.q[1, 1] == 0
        assert got.q[2, 1] == (np.pi if mode else -np.pi)
        assert np.abs(np.sin(got.q[1:3, 0] / 2)).max() < 1e-13


FOLD = float(np.angle(L1 + L2 * np.exp(1j)))
"""By how much the hand of a bent arm is below its first link, rad."""
HAND = float(np.angle(L1 + L2 * np.exp(1j) + L3 * np.exp(1.5j)))
NAMED: list[tuple[Robot, list[float], Code, bool]] = [
    *((scara(), [0.3, bend, 0.2, 0.0], OUT, bend == 0.0) for bend in (0.0, 1.5, -1.5)),
    *((scara(), [0.3, bend, 0.2, 0.0], IN, bend == np.pi) for bend in (1.6, -1.6, np.pi)),
    *((elbow(), [0.3, 0.2, bend], OUT, bend == 0.0) for bend in (0.0, 0.01, -0.01)),
    *((elbow(), [0.3, 0.2, bend], IN, bend == np.pi) for bend in (3.13, -3.13, np.pi)),
    (elbow(), [0.3, np.pi / 2 - 0.2, 0.5], OVER, False),
    (elbow(Pose()), [0.3, np.pi / 2 - FOLD, 1.0], OVER, True),
    (polar(), [0.3, 1.5, 0.4], OVER, False),
    (polar(Pose()), [0.3, np.pi / 2, 0.4], OVER, True),
    (polar(), [0.3, 0.0, 0.2], IN, False),
    (five_axis(Pose()), [0.3, 0.2, 0.0, 0.9, 0.1], OUT, True),
    (five_axis(Pose()), [0.3, 0.2, np.pi, 0.9, 0.1], IN, True),
    (five_axis(Pose()), [0.3, np.pi / 2 - HAND, 1.0, 0.5, 0.1], OVER, True),
]
"""Postures, which singularity is nearest, and whether they are singular."""


@pytest.mark.parametrize(("robot", "q", "code", "there"), NAMED)
def test_the_nearest_singularity_has_its_name_and_the_determinant_vanishes_there(
    robot: Robot, q: list[float], code: Code, there: bool
) -> None:
    at = np.array(q)
    assert robot.singularity(at) == code
    assert (abs(np.linalg.det(jacobian(robot, at))) < 1e-16) == there
    assert (float(robot.margin(at)) < 1e-15) == there
    assert (float(robot.singular_distance(at)) < 1e-15) == there


@pytest.mark.parametrize("robot", [scara(), scara(base=FAR), elbow(), polar(), five_axis()])
def test_the_determinant_is_the_product_of_the_page(robot: Robot) -> None:
    """Equations K11, K26, K27 and H5."""
    q = random_q(robot, np.random.default_rng(7), 10_000)
    psi = np.cumsum(q[:, 1:4], -1)
    if isinstance(robot, Scara):
        expected = robot.l1 * robot.l2 * np.sin(q[:, 1])
    elif isinstance(robot, PolarArm):
        expected = q[:, 2] ** 2 * np.cos(q[:, 1])
    else:
        hand = L3 * np.cos(psi[:, 2]) if psi.shape[1] > 2 else 0.0
        expected = -(L1 * np.cos(psi[:, 0]) + L2 * np.cos(psi[:, 1]) + hand) * L1 * L2 * np.sin(q[:, 2])
    assert np.abs(np.linalg.det(jacobian(robot, q)) - expected).max() < 1e-15
    assert np.abs(determinant(robot, q) - expected).max() < 1e-15


@given(st.floats(-3.14, 3.14), st.sampled_from([(0.325, 0.225), (0.2, 0.3), (0.25, 0.25)]))
def test_the_singular_distance_of_a_scara_is_what_is_left_of_the_radius_on_either_side(
    theta2: float, lengths: tuple[float, float]
) -> None:
    robot = scara(base=Pose(), l1=lengths[0], l2=lengths[1])
    q = np.array([0.3, theta2, 0.2, 0.0])
    radius = float(np.hypot(*robot.forward(q)[0][:2]))
    expected = min(sum(lengths) - radius, radius - abs(lengths[0] - lengths[1]))
    assert robot.singular_distance(q) == pytest.approx(expected, abs=2e-16)
    assert robot.singular_distance(q) >= 0


def test_the_singular_distance_has_all_its_digits_where_nearly_nothing_is_left() -> None:
    gap = 1e-6
    q = np.array([[0.0, gap, 0.2, 0.0], [0.0, np.pi - gap, 0.2, 0.0], [0.0, 0.0, 0.2, 0.0], [0.0, np.nan, 0.2, 0.0]])
    got = scara(base=Pose()).singular_distance(q)
    # Second order in the gap: l1 l2 gap²/(2 (l1 ± l2)).
    assert got[:2] == pytest.approx([0.325 * 0.225 * gap**2 / (2 * 0.55), 0.325 * 0.225 * gap**2 / (2 * 0.1)], rel=1e-9)
    assert got[2] == 0
    assert np.isnan(got[3])
    # Equal links fold to the shoulder itself, in the first order.
    assert scara(l1=0.2, l2=0.2).singular_distance(q[1]) == pytest.approx(0.2 * gap, rel=1e-9)


@given(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0), st.floats(-1.0, 1.0))
def test_the_singular_distance_is_that_to_the_nearest_edge_or_the_axis(q1: float, q2: float, share: float) -> None:
    arm, ram = elbow(Pose()), polar(Pose())
    q = np.array([q1, q2, 3.1 * share])
    p = arm.forward(q)[0] - [0.0, 0.0, arm.height]
    rho, r = float(np.hypot(p[0], p[1])), float(np.linalg.norm(p))
    assert arm.singular_distance(q) == pytest.approx(min(0.41 - r, r - 0.09, rho), abs=1e-15)
    q = np.array([q1, q2, 0.4 + 0.2 * share])
    p = ram.forward(q)[0] - [0.0, 0.0, ram.height]
    assert ram.singular_distance(q) == pytest.approx(float(np.hypot(p[0], p[1])), abs=1e-15)
