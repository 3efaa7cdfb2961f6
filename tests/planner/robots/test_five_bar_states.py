"""Ten thousand random states of a five-bar in each working mode and each assembly mode, and as many singular ones.

The oracles are differences of positions, laws of cosines, and the lengths of the couplers: not the dyad's formulas.
"""

from __future__ import annotations

import numpy as np
import pytest

from assur.experiments.differential import determinant, inverse_jacobian
from assur.experiments.five_bar_workspace import velocity_equation
from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.frames.motion import Motion
from assur.planner.robots.five_bar import DISTAL_LEFT, DISTAL_RIGHT, FLANGE, MODES, FiveBar
from assur.planner.robots.protocol import Code
from tests.planner.robots.five_bars import BASES, five_bar, states

SIZE = 10_000
STENCIL = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
"""Weights of the central first difference of order 8, over steps −4 … 4."""
SCALES = (0.3, 3.0, 30.0)
"""Of the flange's velocity, acceleration and jerk, m and rad."""

every_mode = pytest.mark.parametrize("mode", range(4), ids=MODES)
every_assembly = pytest.mark.parametrize("assembly", ["front", "back"])


def moving(robot: FiveBar, q: FloatArray, rng: np.random.Generator) -> Motion:
    """Flange motions (SIZE,) through the places of q, with any derivatives."""
    p, yaw = robot.forward(q)
    v, a, j = (scale * rng.normal(size=p.shape) for scale in SCALES)
    turn, turn_d, turn_dd = (scale * rng.normal(size=yaw.shape) for scale in SCALES)
    return Motion(p, v, a, j, yaw, turn, turn_d, turn_dd)


def later(motion: Motion, t: float) -> Motion:
    """The cubic motion with these derivatives, after t seconds."""

    def on(x: FloatArray, v: FloatArray, a: FloatArray, j: FloatArray) -> tuple[FloatArray, ...]:
        return x + v * t + a * t**2 / 2 + j * t**3 / 6, v + a * t + j * t**2 / 2, a + j * t, j

    place = on(motion.p, motion.v, motion.a, motion.j)
    return Motion(*place, *on(motion.yaw, motion.yaw_d, motion.yaw_dd, motion.yaw_ddd))


def angles(difference: FloatArray, kinds: list[str]) -> FloatArray:
    """Differences of joint values, those of revolute joints in (−π, π]."""
    turned = np.array([kind == "revolute" for kind in kinds])
    return np.asarray(np.where(turned, np.angle(np.exp(1j * difference)), difference))


@every_mode
@every_assembly
def test_the_derivatives_of_the_inverse_are_its_differences(mode: int, assembly: str) -> None:
    """q̇ from differences of q, q̈ of q̇, q⃛ of q̈, along ten thousand moving flanges."""
    robot, rng, step = five_bar(base=BASES[1], assembly=assembly), np.random.default_rng(10 + mode), 5e-5
    q = states(rng, robot, mode, SIZE)
    motion = moving(robot, q, rng)
    around = [robot.inverse(later(motion, k * step), mode) for k in range(-4, 5)]
    middle, kinds = around[4], [joint.kind for joint in robot.joints]
    assert (middle.code == Code.ASSEMBLED).all()
    assert np.abs(angles(middle.q - q, kinds)).max() < 1e-9
    for below, above in (("q", "qd"), ("qd", "qdd"), ("qdd", "qddd")):
        values = np.stack([getattr(found, below) for found in around])
        if below == "q":
            values = angles(values - middle.q, kinds)
        difference, exact = np.tensordot(STENCIL, values, 1) / step, getattr(middle, above)
        scale = np.abs(exact).max(1, keepdims=True) + 1
        assert (np.abs(difference - exact) / scale).max() < 1e-6


@every_mode
@every_assembly
def test_the_jacobian_is_the_differences_of_forward_and_the_dyads_give_its_inverse(mode: int, assembly: str) -> None:
    robot, rng, step = five_bar("odd", base=BASES[1], assembly=assembly), np.random.default_rng(20 + mode), 1e-4
    q = states(rng, robot, mode, SIZE)
    jacobian = robot.jacobian(q)
    for k in range(4):
        around = [robot.forward(q + i * step * np.eye(4)[k]) for i in range(-4, 5)]
        position = np.tensordot(STENCIL, np.stack([p for p, _ in around]), 1) / step
        turn = np.angle(np.exp(1j * (np.stack([yaw for _, yaw in around]) - around[4][1])))
        difference = np.concatenate([position, (np.tensordot(STENCIL, turn, 1) / step)[:, None]], -1)
        assert (np.abs(difference - jacobian[:, :, k]) / (1 + np.abs(jacobian).max((1, 2)))[:, None]).max() < 1e-7
    motion = moving(robot, q, rng)
    by_dyads = robot.inverse(motion, mode, 1).qd
    task = np.concatenate([motion.v, motion.yaw_d[:, None]], -1)
    by_jacobian = (inverse_jacobian(robot, q) @ task[:, :, None])[:, :, 0]
    assert (np.abs(by_dyads - by_jacobian) / (1 + np.abs(by_dyads).max(1, keepdims=True))).max() < 1e-10


@every_mode
@every_assembly
def test_both_jacobians_hold_and_their_determinants_are_the_margins(mode: int, assembly: str) -> None:
    """A ẋ = B q̇ for what the flange really does; det A is the parallel margin, det B both serial ones."""
    robot, rng = five_bar("odd", assembly=assembly), np.random.default_rng(30 + mode)
    q = states(rng, robot, mode, SIZE)
    qd, none = rng.normal(size=q.shape), np.zeros_like(q)
    direct, inverse = velocity_equation(robot, q)
    flange = robot.link_motion(FLANGE, q, qd, none, none)
    left = (direct @ flange.v[:, :2, None])[:, :, 0]
    right = (inverse @ qd[:, :2, None])[:, :, 0]
    assert np.abs(left - right).max() < 1e-13
    (al, ar), (bl, br) = robot.proximal, robot.distal
    det_a, det_b = np.linalg.det(direct), np.linalg.det(inverse)
    assert np.abs(np.abs(det_a) / (bl * br) - robot.parallel_margin(q)).max() < 1e-12
    assert (det_a < 0).all() if assembly == "front" else (det_a > 0).all()
    # the sides by their angles, as the frames of the links have them
    _, rotation = robot.placements(q)
    sines = []
    for k, link in ((0, DISTAL_LEFT), (1, DISTAL_RIGHT)):
        c, s = np.cos(q[:, k]), np.sin(q[:, k])
        sines.append(c * rotation[:, link, 1, 0] - s * rotation[:, link, 0, 0])
    assert np.abs(det_b + al * bl * ar * br * sines[0] * sines[1]).max() < 1e-15
    assert np.abs(np.minimum(*np.abs(sines)) - robot.margin(q)).max() < 1e-12
    assert np.abs(determinant(robot, q) * det_a / det_b - 1).max() < 1e-9


def sided(robot: FiveBar, q: FloatArray) -> FloatArray:
    """The places (N, 2) of the left arm's end, whose coupler is in line with its crank by construction."""
    return np.asarray(np.array([0.0, robot.separation / 2]) + q)


def reached(robot: FiveBar, p: FloatArray, right_bends: BoolArray) -> tuple[FloatArray, FloatArray]:
    """Angle (N,) of the right crank for the tool axis at p (N, 2), and of its coupler, by the law of cosines."""
    d = p + np.array([0.0, robot.separation / 2])
    a, b, far = robot.proximal[1], robot.distal[1], np.hypot(d[:, 0], d[:, 1])
    with np.errstate(invalid="ignore"):
        inner = np.arccos((a * a + far**2 - b * b) / (2 * a * far))
    crank = np.arctan2(d[:, 1], d[:, 0]) + np.where(right_bends, -inner, inner)
    end = d - a * np.stack([np.cos(crank), np.sin(crank)], -1)
    return crank, np.arctan2(end[:, 1], end[:, 0])


@pytest.mark.parametrize("kind", [Code.STRETCHED, Code.FOLDED])
@pytest.mark.parametrize("lengths", ["even", "odd"])
def test_a_left_arm_in_one_line_is_type_1_and_not_type_2(kind: Code, lengths: str) -> None:
    """All around the crank axis; the right arm, and with it the angle of the couplers, by the law of cosines."""
    robot, rng = five_bar(lengths), np.random.default_rng(int(kind))
    theta1 = rng.uniform(-np.pi, np.pi, SIZE)
    e = np.stack([np.cos(theta1), np.sin(theta1)], -1)
    a, b = robot.proximal[0], robot.distal[0]
    coupler = e if kind is Code.STRETCHED else -e
    p = sided(robot, a * e + b * coupler)
    motion = Motion.still(robot.base, (SIZE,))
    motion.p[:, :2], motion.p[:, 2] = p, 0.2
    counted = 0
    for bends in (False, True):
        _, other = reached(robot, p, np.full(SIZE, bends))
        # the couplers, u to the tool axis and w from it: front has u × w < 0
        angle = np.sin(other - np.arctan2(coupler[:, 1], coupler[:, 0]))
        followed, beyond = angle >= robot.parallel_least + 1e-9, angle < robot.parallel_least - 1e-9
        for mode in (0 + bends, 2 + bends):
            found = robot.inverse(motion, mode)
            assert (found.code[followed] == kind).all()
            assert (found.code[beyond] == Code.PARALLEL).all()
            assert (found.code[np.isnan(angle)] == Code.OUT_OF_REACH).all()
            assert found.parallel is not None
            known = np.isfinite(angle)
            assert np.abs(found.parallel - angle)[known].max() < 1e-6
            assert (found.margin[known] == 0).all()
            assert np.isfinite(found.q[known]).all()
            assert np.isnan(found.qd).all()
            direct, inverse = velocity_equation(robot, found.q[followed])
            assert np.abs(np.linalg.det(inverse)).max() < 1e-9
            assert np.abs(np.linalg.det(direct)).min() > 0.09 * robot.distal[0] * robot.distal[1]
            near = robot.singularity(found.q[followed])
            right_serial = np.abs(np.sin(other - found.q[:, 1]))[followed]
            assert (near[right_serial > 1e-3] == kind).all()
            counted += int(followed.sum())
    assert counted > 1_000


@pytest.mark.parametrize(("lengths", "inside_out"), [("short", False), ("short", True), ("odd", True)])
def test_couplers_in_one_line_are_type_2_and_not_type_1(lengths: str, *, inside_out: bool) -> None:
    """Couplers as one bar between the elbows, of their sum or (inside out) their difference, by the law of cosines."""
    robot, rng = five_bar(lengths), np.random.default_rng(7)
    (al, ar), (bl, br) = robot.proximal, robot.distal
    bar = bl - br if inside_out else bl + br
    if bar == 0.0:
        # Equal couplers: their elbows meet, on the line of symmetry, and the tool axis is anywhere about them.
        theta1 = np.full(SIZE, -np.arcsin(robot.separation / 2 / al))
        gamma = rng.uniform(-np.pi, np.pi, SIZE)
    else:
        theta1 = rng.uniform(-np.pi, np.pi, SIZE)
    p1 = np.array([0.0, robot.separation / 2]) + al * np.stack([np.cos(theta1), np.sin(theta1)], -1)
    if bar != 0.0:
        back = np.array([0.0, -robot.separation / 2]) - p1
        far = np.hypot(back[:, 0], back[:, 1])
        with np.errstate(invalid="ignore"):
            open_ = np.arccos((bar**2 + far**2 - ar**2) / (2 * abs(bar) * far))
        gamma = np.arctan2(back[:, 1], back[:, 0]) + open_ * rng.choice([-1, 1], SIZE)
        gamma = gamma if bar > 0 else gamma + np.pi
    e = np.stack([np.cos(gamma), np.sin(gamma)], -1)
    p, p2 = p1 + bl * e, p1 + bar * e
    theta5 = np.arctan2(p2[:, 1] + robot.separation / 2, p2[:, 0])
    last = gamma + np.pi if not inside_out else gamma
    bend = np.sin(gamma - theta1), np.sin(last - theta5)
    good = np.isfinite(p).all(1) & (np.abs(bend[0]) > 0.05) & (np.abs(bend[1]) > 0.05)
    assert good.sum() > 1_000
    modes = 2 * (bend[0] > 0) + (bend[1] > 0)
    seen = set()
    for mode in range(4):
        rows = good & (modes == mode)
        if not rows.any():
            continue
        seen.add(mode)
        motion = Motion.still(robot.base, (int(rows.sum()),))
        motion.p[:, :2], motion.p[:, 2] = p[rows], 0.2
        found = robot.inverse(motion, mode)
        assert (found.code == Code.PARALLEL).all()
        assert np.abs(np.angle(np.exp(1j * (found.q[:, 0] - theta1[rows])))).max() < 1e-9
        assert np.abs(np.angle(np.exp(1j * (found.q[:, 1] - theta5[rows])))).max() < 1e-9
        assert found.parallel is not None
        assert np.abs(found.parallel).max() < 1e-9
        assert np.abs(found.margin - np.minimum(*np.abs(np.stack(bend))[:, rows])).max() < 1e-9
        assert np.isfinite(found.qd).all()
        assert not robot.within(found.q).any()
        # across the couplers' line the assembly mode changes: one side is the front's, the other the back's
        side = np.stack([-e[rows, 1], e[rows, 0]], -1) if bar != 0.0 else e[rows]
        margins = []
        for shift in (-1e-6, 1e-6):
            motion.p[:, :2] = p[rows] + shift * side
            there = robot.inverse(motion, mode, 0)
            assert there.parallel is not None
            assert (there.code == Code.PARALLEL).all()
            margins.append(there.parallel)
        assert (margins[0] * margins[1] < 0).mean() > 0.99
    assert len(seen) > 1
