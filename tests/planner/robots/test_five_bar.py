"""The five-bar: its closed chain, both kinds of singularity, working modes and assembly modes, its workspace.

The oracles are laws of cosines and the lengths of the couplers: not the dyad's formulas.
"""

from __future__ import annotations

import numpy as np
import pytest

from assur.experiments.differential import determinant
from assur.experiments.five_bar_workspace import type_2_curves, velocity_equation, workspace
from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.frames.motion import Motion, Pose
from assur.planner.robots.facts import Code
from assur.planner.robots.five_bar import DISTAL_LEFT, DISTAL_RIGHT, FLANGE, FiveBar
from tests.planner.robots.families import BASE
from tests.planner.robots.five_bars import LENGTHS, five_bar, states

SIZE = 10_000
every_mode = pytest.mark.parametrize("mode", range(4), ids=FiveBar.modes)
every_assembly = pytest.mark.parametrize("assembly", ["front", "back"])


def at_rest(x: float, y: float, z: float = 0.2, yaw: float = 0.0) -> Motion:
    return Motion.still(Pose(x, y, z, yaw), ())


def same_angle(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.asarray(np.abs(np.angle(np.exp(1j * (a - b)))))


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


# Singularities.


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
            assert robot.within(found.q[followed]).all()
            assert same_angle(found.q[known, 0], theta1[known]).max() < 1e-9
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


def test_the_parallel_margin_of_a_robot_is_kept_by_inverse_and_within() -> None:
    robot = five_bar("short")
    x = np.sqrt(0.2**2 - (0.16 - 0.0425) ** 2) + np.linspace(0.0, 0.02, 400)
    motion = Motion.still(Pose(), (400,))
    motion.p[:, 0], motion.p[:, 2] = x, 0.2
    got = robot.inverse(motion, 1)
    assert got.parallel is not None
    enough = got.parallel >= robot.parallel_least
    assert 0 < enough.sum() < 400
    assert np.array_equal(got.code == Code.ASSEMBLED, enough)
    clear = np.abs(got.parallel - robot.parallel_least) > 1e-9
    assert np.array_equal(robot.within(got.q)[clear], enough[clear])


def test_joints_that_do_not_assemble_are_not_within_and_are_nowhere() -> None:
    robot = five_bar("short")
    q = np.array([[np.pi / 2, -np.pi / 2, 0.2, 0.0], [0.5, -0.5, 0.2, 0.0], [np.nan, 0, 0.2, 0], [0.5, -0.5, 9.0, 0.0]])
    with np.errstate(all="raise"):
        assert robot.within(q).tolist() == [False, True, False, False]
        assert robot.assembled(q, q).tolist() == [False, True, False, True]
        assert robot.mode_of(q).tolist() == [-1, 1, -1, 1]
        assert np.isnan(robot.forward(q)[0][[0, 2]]).any(1).all()
        assert np.isnan(robot.parallel_margin(q)[[0, 2]]).all()


def test_without_a_quill_the_flange_keeps_its_height() -> None:
    robot = five_bar(axes=2, base=Pose(0, 0, 0.3))
    assert robot.inverse(at_rest(0.3, 0.0, 0.3), 1).code == Code.ASSEMBLED
    assert robot.inverse(at_rest(0.3, 0.0, 0.301), 1).code == Code.OUT_OF_REACH


# The workspace.


@pytest.mark.parametrize("lengths", sorted(LENGTHS))
def test_the_type_2_curves_are_where_couplers_are_in_line(lengths: str) -> None:
    robot = five_bar(lengths)
    for curve in type_2_curves(robot, 181):
        found = 0
        for x, y in curve[np.isfinite(curve).all(1)]:
            margins = []
            for mode in range(4):
                got = robot.inverse(at_rest(float(x), float(y)), mode, 0)
                if got.code != Code.OUT_OF_REACH and got.parallel is not None:
                    margins.append(abs(float(got.parallel)))
            if margins:
                found += 1
                assert np.nanmin(margins) < 1e-5
        assert found > 0 or not np.isfinite(curve).all(1).any()


def test_the_sampled_workspace_is_what_the_inverse_says() -> None:
    robot = five_bar("short", base=BASE)
    seen = workspace(robot, 0.02, 91)
    assert seen.code.shape == (4, len(seen.y), len(seen.x))
    for mode in range(4):
        assert (seen.parallel[mode][seen.within[mode]] >= robot.parallel_least).all()
    i, k = np.argwhere(seen.within[1])[40]
    place = robot.base.then(Pose(float(seen.x[k]), float(seen.y[i])))
    assert robot.inverse(at_rest(place.x, place.y), 1).code == Code.ASSEMBLED
    # symmetrical about the x axis: what left-left reaches, right-right reaches mirrored
    assert np.array_equal(seen.within[0], seen.within[3][::-1])
    assert len(seen.type_1) == 4
    assert all(curve.shape == (91, 2) for curve in (*seen.type_1, *seen.type_2))
