"""Poses are a group, and a motion at an offset is the motion of the point that rides there."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.laws import Pose
from tests.planner.laws.laws import Case, cases
from tests.planner.laws.test_motions_of_laws import PARTS, STEP_S, stacked

coordinates = st.one_of(st.sampled_from([0.0, 1.0, -0.5, math.pi / 2, math.pi]), st.floats(-10, 10))
poses = st.builds(Pose, coordinates, coordinates, coordinates, coordinates)


def matrix(pose: Pose) -> FloatArray:
    """The homogeneous matrix, by another way than the product's."""
    turn = complex(math.cos(pose.yaw), math.sin(pose.yaw))
    return np.array(
        [[turn.real, -turn.imag, 0, pose.x], [turn.imag, turn.real, 0, pose.y], [0, 0, 1, pose.z], [0, 0, 0, 1]]
    )


def close(a: Pose, b: Pose) -> None:
    np.testing.assert_allclose(dataclasses.astuple(a), dataclasses.astuple(b), atol=1e-12)


@given(poses, poses, poses)
def test_poses_are_a_group(a: Pose, b: Pose, c: Pose) -> None:
    close(a.then(b).then(c), a.then(b.then(c)))
    close(a.then(Pose()), a)
    close(Pose().then(a), a)
    close(a.then(a.inverse()), Pose())
    close(a.inverse().then(a), Pose())


@given(poses, poses)
def test_a_pose_then_another_is_the_product_of_their_matrices(a: Pose, b: Pose) -> None:
    np.testing.assert_allclose(matrix(a.then(b)), matrix(a) @ matrix(b), atol=1e-12)
    np.testing.assert_allclose(matrix(a.inverse()), np.linalg.inv(matrix(a)), atol=1e-12)


@given(cases(("turntable", "turn", "swing", "keyframes")), poses, st.lists(st.floats(0.01, 0.99), min_size=1))
def test_the_motion_at_an_offset_has_the_difference_quotients_of_its_position(
    case: Case, offset: Pose, where: list[float]
) -> None:
    low, high = case.window
    t = low + 0.01 + np.array(where) * (high - low - 0.02)
    t = t[(np.abs(t[:, None] - np.array([*case.switches, math.inf])) > 3 * STEP_S).all(axis=1)]
    exact = stacked(case.law.motion(t).at(offset))
    scale = 1 + np.abs(stacked(case.law.motion(np.linspace(low, high, 400)).at(offset))).max(axis=(1, 2))
    before2, before, after, after2 = (stacked(case.law.motion(t + k * STEP_S).at(offset))[:3] for k in (-2, -1, 1, 2))
    found = (before2 - 8 * before + 8 * after - after2) / (12 * STEP_S)
    for order in range(3):
        assert (np.abs(found - exact[1:])[order] <= 1e-6 * scale[order + 1]).all()


@given(cases(), poses, poses, st.floats(0, 1))
def test_offsets_chain_like_poses(case: Case, first: Pose, then: Pose, where: float) -> None:
    motion = case.law.motion(np.array([case.window[0] + where * (case.window[1] - case.window[0])]))
    once, twice = motion.at(first.then(then)), motion.at(first).at(then)
    for name in PARTS:
        value = getattr(once, name)
        np.testing.assert_allclose(getattr(twice, name), value, rtol=1e-9, atol=1e-9 * (1 + np.abs(value).max()))


@given(cases(), poses)
def test_the_position_at_an_offset_is_that_of_the_pose(case: Case, offset: Pose) -> None:
    motion = case.law.motion(np.array(case.window[0]))
    there = Pose(motion.p[0], motion.p[1], motion.p[2], float(motion.yaw)).then(offset)
    found = motion.at(offset)
    np.testing.assert_allclose([*found.p, found.yaw], dataclasses.astuple(there), atol=1e-12)


@given(cases())
def test_a_motion_at_rest_keeps_its_poses_and_nothing_else(case: Case) -> None:
    motion = case.law.motion(np.linspace(*case.window, 5))
    rest = stacked(motion.at_rest())
    np.testing.assert_array_equal(rest[0], stacked(motion)[0])
    assert not rest[1:].any()
