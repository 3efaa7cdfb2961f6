"""Arms whose links tilt: their frames by homogeneous transforms, the printed matrices, the attitude of a hand."""

from __future__ import annotations

import numpy as np
import pytest

from assur.experiments.differential import transforms
from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Motion, Pose, TiltedMotion
from assur.planner.robots.facts import Code
from assur.planner.robots.five_axis_arm import FiveAxisArm
from assur.planner.robots.tilting import ElbowArm, PolarArm
from tests.planner.robots.families import (
    BASE,
    FAR,
    elbow,
    far,
    five_axis,
    flange_of,
    polar,
    random_motion,
    random_q,
    tilted,
)

L1, L2, L3, HEIGHT = 0.25, 0.16, 0.072, 0.3
"""Of the five-axis arm, m."""
BASES = (Pose(), BASE, FAR)


def homogeneous(axis: str, angle: float, *shift: float) -> FloatArray:
    """A right-handed rotation about an axis after a shift, (4, 4)."""
    c, s, found = np.cos(angle), np.sin(angle), np.eye(4)
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    found[[i, j], [i, j]], found[i, j], found[j, i] = c, -s, s
    found[:3, 3] = shift or (0.0, 0.0, 0.0)
    return found


@pytest.mark.parametrize("robot", [make(base) for make in (elbow, polar, five_axis) for base in BASES])
def test_the_link_frames_are_the_products_of_homogeneous_transforms(
    robot: ElbowArm | PolarArm | FiveAxisArm,
) -> None:
    """T = T_base · T(height) Rz(θ1) · Ry(−ψ) …: tilting up is turning about −y."""
    base = homogeneous("z", robot.base.yaw, *robot.base.position)
    q = random_q(robot, np.random.default_rng(6), 50)
    for row, frames in zip(q, transforms(robot, q), strict=True):
        chain = [base, base @ homogeneous("z", row[0], 0.0, 0.0, robot.height)]
        chain.append(chain[-1] @ homogeneous("y", -row[1]))
        if isinstance(robot, PolarArm):
            chain += [chain[-1] @ homogeneous("x", 0.0, row[2], 0.0, 0.0)] * 2
        else:
            chain.append(chain[-1] @ homogeneous("y", -row[2], L1, 0.0, 0.0))
            if isinstance(robot, FiveAxisArm):
                chain.append(chain[-1] @ homogeneous("y", -row[3], L2, 0.0, 0.0))
                chain.append(chain[-1] @ homogeneous("x", row[4], L3, 0.0, 0.0))
            else:
                chain.append(chain[-1] @ homogeneous("x", 0.0, L2, 0.0, 0.0))
        assert np.abs(frames - np.stack(chain)).max() < 1e-14 * far(robot)


def test_the_polar_arm_is_that_of_the_printed_matrices() -> None:
    """Source 002: T = A1 A2 A3 with θ2 = ψ − 90°, d3 and l1; the last column is where the flange is."""
    robot = polar(Pose())
    for q in random_q(robot, np.random.default_rng(8), 50):
        c1, s1 = np.cos(q[0]), np.sin(q[0])
        c2, s2 = np.cos(q[1] - np.pi / 2), np.sin(q[1] - np.pi / 2)
        a1 = np.array([[c1, 0, s1, 0], [s1, 0, -c1, 0], [0, 1, 0, robot.height], [0, 0, 0, 1]])
        a2 = np.array([[c2, 0, -s2, 0], [s2, 0, c2, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
        a3 = homogeneous("z", 0.0, 0.0, 0.0, q[2])
        printed = a1 @ a2 @ a3
        position, rotation = robot.placements(q)
        assert np.abs(printed[:3, 3] - position[flange_of(robot)]).max() < 1e-15
        # its third axis is the ram's direction, our first
        assert np.abs(printed[:3, 2] - rotation[flange_of(robot)][:, 0]).max() < 1e-15


@pytest.mark.parametrize("base", BASES)
def test_heading_pitch_and_roll_are_the_attitude_of_the_flange_and_over_the_back_of_the_same_family(base: Pose) -> None:
    """H1, and that (φ1, P, R) and (φ1 + π, π − P, R + π) are one attitude."""
    robot = five_axis(base)
    q, *rest = random_motion(robot, 16, 200)
    motion = tilted(robot.link_motion(flange_of(robot), q, *rest))
    rotation = robot.placements(q)[1][:, flange_of(robot)]
    for yaw, (pitch, roll), found in zip(motion.yaw, motion.tilt, rotation, strict=True):
        for heading, p, r in ((yaw, pitch, roll), (yaw + np.pi, np.pi - pitch, roll + np.pi)):
            made = homogeneous("z", heading) @ homogeneous("y", -p) @ homogeneous("x", r)
            assert np.abs(made[:3, :3] - found).max() < 1e-13
        # the tool axis: pitch above the horizontal, in the plane of the heading
        axis = [np.cos(pitch) * np.cos(yaw), np.cos(pitch) * np.sin(yaw), np.sin(pitch)]
        assert found[:, 0] == pytest.approx(axis, abs=1e-13)


@pytest.mark.parametrize("base", BASES)
def test_a_point_is_out_of_reach_at_every_pitch_by_as_much_as_the_nearest_pitch_says(base: Pose) -> None:
    rng = np.random.default_rng(9)
    lengths = ((L1, L2, L3), (0.2, 0.05, 0.05), (0.1, 0.1, 0.4))
    for l1, l2, l3 in lengths:
        other = five_axis(base, l1, l2, l3)
        d = rng.uniform(0.0, 1.3 * (l1 + l2 + l3), 200)
        way = rng.normal(size=(200, 3))
        p = d[:, None] * way / np.linalg.norm(way, axis=1, keepdims=True)
        shoulder = other.base.position + np.array([0.0, 0.0, HEIGHT])
        p += shoulder
        short = other.out_of_reach(p)
        pitch = np.linspace(-np.pi, np.pi, 721)
        met = np.repeat(p[:, None], 721, 1)
        still = np.zeros_like(met)
        yaw = np.zeros(met.shape[:-1])
        tilt = np.stack([np.broadcast_to(pitch, yaw.shape), yaw], -1)
        asked = TiltedMotion.of(Motion(met, still, still, still, yaw, yaw, yaw, yaw), tilt)
        reached = (other.inverse(asked, 0, 0).code != Code.OUT_OF_REACH).any(1)
        assert not reached[short > 0].any()
        # a point that is reached with a hair to spare is found by one of the pitches
        edges = np.array([l1 + l2 + l3, l3 - l1 - l2, abs(l1 - l2) - l3])
        edge = np.abs(np.linalg.norm(p - shoulder, axis=1)[:, None] - edges).min(1)
        assert reached[(short == 0) & (edge > 1e-3)].all()
        assert (short > 0).any()
    tip = five_axis(Pose()).out_of_reach(np.array([[0.582, 0.0, 0.3], [0.0, 0.0, 0.3], [np.nan, 0.0, 0.3]]))
    assert tip[:2] == pytest.approx([0.1, L1 - L2 - L3])
    assert np.isnan(tip[2])
