"""Arms whose links tilt: their frames by homogeneous transforms, the printed matrices, the attitude of a hand."""

from __future__ import annotations

import numpy as np
import pytest

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Pose
from tests.planner.robots.families import (
    BASE,
    FAR,
    five_axis,
    flange_of,
    polar,
    random_motion,
    random_q,
    tilted,
)

BASES = (Pose(), BASE, FAR)


def homogeneous(axis: str, angle: float, *shift: float) -> FloatArray:
    """A right-handed rotation about an axis after a shift, (4, 4)."""
    c, s, found = np.cos(angle), np.sin(angle), np.eye(4)
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    found[[i, j], [i, j]], found[i, j], found[j, i] = c, -s, s
    found[:3, 3] = shift or (0.0, 0.0, 0.0)
    return found


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
