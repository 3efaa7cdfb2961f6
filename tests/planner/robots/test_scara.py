"""The SCARA with three and four axes: inverse against forward, differences, the dyad; every refusal."""

from __future__ import annotations

from dataclasses import FrozenInstanceError
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError, InputError
from assur.planner.frames.motion import Motion, Pose
from assur.planner.geometry.shapes import AXES, Body, Piece, box, capsule, cylinder, sphere
from assur.planner.robots.protocol import Code, Inverse, Limits, Robot, RobotBody
from assur.planner.robots.scara import FLANGE, LINKS, QUILL, Scara

BASES = [Pose(), Pose(0.4, -0.7, 0.2, 2.5), Pose(-12.0, 30.0, -1.0, -9.0)]
STENCIL = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
"""Weights of the central first difference of order 8, over steps −4 … 4."""


def limits(axes: int) -> Limits:
    upper = np.array([3.0, 2.6, 0.4, 6.4])[:axes]
    lower = np.array([-3.0, -2.6, 0.1, -6.4])[:axes]
    return Limits(lower, upper, np.full(axes, 7.0), np.full(axes, 100.0), np.full(axes, 5000.0))


def scara(axes: int = 4, base: Pose = BASES[1], l1: float = 0.325, l2: float = 0.225, arms_rise: bool = False) -> Scara:
    return Scara("arm", l1, l2, axes, limits(axes), base, arms_rise=arms_rise)


ARMS = [scara(axes, base) for axes in (3, 4) for base in BASES]
every_arm = pytest.mark.parametrize("robot", [*ARMS, scara(arms_rise=True)])


def joint_motion(rng: np.random.Generator, robot: Robot, mode: int, size: int) -> tuple[FloatArray, ...]:
    """q, q̇, q̈, q⃛ (size, n) with |sin θ2| > 0.1 in `mode`, θ1 and θ4 principal."""
    n = len(robot.joints)
    q = rng.uniform(-3.1, 3.1, (size, n))
    side = np.arcsin(rng.uniform(0.1, 1.0, size))
    q[:, 1] = (1 if mode else -1) * np.where(rng.random(size) < 0.5, side, np.pi - side)
    q[:, 2] = rng.uniform(0.1, 0.4, size)
    return (q, *(scale * rng.normal(size=(size, n)) for scale in (3.0, 20.0, 200.0)))


def same_angle(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.asarray(np.abs(np.angle(np.exp(1j * (a - b)))))


def test_a_scara_is_a_robot() -> None:
    robot: Robot = scara()
    assert robot.links == ("base", "link1", "link2", "quill", "flange")
    assert robot.modes == ("left", "right")
    assert robot.lift == 2
    assert robot.coordinates == ("x", "y", "z", "yaw")
    assert scara(3).coordinates == ("x", "y", "z")
    assert [joint.kind for joint in robot.joints] == ["revolute", "revolute", "prismatic", "revolute"]
    assert robot.rate_matrix.tolist() == [[1, 0, 0, 0], [1, 1, 0, 0], [0, 0, 1, 0], [1, 1, 0, 1]]
    assert scara(3).rate_matrix.tolist() == [[1, 0, 0], [1, 1, 0], [0, 0, 1], [1, 1, 0]]
    with pytest.raises(FrozenInstanceError):
        robot.name = "other"  # type: ignore[misc]
    with pytest.raises(ValueError, match="read-only"):
        robot.rate_matrix[0, 0] = 2.0


@every_arm
@pytest.mark.parametrize("mode", [0, 1])
def test_the_inverse_of_the_flange_motion_is_the_joint_motion(robot: Scara, mode: int) -> None:
    motion = joint_motion(np.random.default_rng(mode), robot, mode, 10_000)
    with np.errstate(all="raise"):
        got = robot.inverse(robot.link_motion(FLANGE, *motion), mode)
    assert (got.code == Code.ASSEMBLED).all()
    far = max(1.0, abs(robot.base.x), abs(robot.base.y))
    assert np.abs(got.q - motion[0]).max() < 1e-12 * far
    assert np.abs(got.margin - np.abs(np.sin(motion[0][:, 1]))).max() < 1e-13 * far / 0.1
    scale = np.linalg.norm(np.stack(motion[1:]), axis=(0, 2))[:, None]
    for found, made in zip((got.qd, got.qdd, got.qddd), motion[1:], strict=True):
        assert (np.abs(found - made) / scale).max() < 1e-9 * far


@every_arm
@pytest.mark.parametrize("mode", [0, 1])
def test_forward_of_the_inverse_is_where_the_flange_was_asked_to_be(robot: Scara, mode: int) -> None:
    rng = np.random.default_rng(3)
    radius, angle = rng.uniform(0.11, 0.54, 5000), rng.uniform(-4, 4, 5000)
    p = robot.base.position + np.stack([radius * np.cos(angle), radius * np.sin(angle), rng.normal(size=5000)], -1)
    still = Motion.still(Pose(), (5000,))
    target = Motion(p, still.v, still.a, still.j, rng.uniform(-20, 20, 5000), *(still.yaw,) * 3)
    got = robot.inverse(target, mode)
    assert (got.code == Code.ASSEMBLED).all()
    assert (robot.mode_of(got.q) == mode).all()
    position, yaw = robot.forward(got.q)
    assert np.abs(position - p).max() < 1e-9
    assert np.abs(position - p).max() < 2e-14 * max(1.0, abs(robot.base.y))
    if robot.axes == 4:
        assert same_angle(yaw, target.yaw).max() < 1e-13
    revolute = [i for i, joint in enumerate(robot.joints) if joint.kind == "revolute"]
    assert (np.abs(got.q[:, revolute]) <= np.pi).all()
    assert not got.qd.any()


def test_a_three_axis_arm_does_not_look_at_the_yaw() -> None:
    robot = scara(3)
    motion = robot.link_motion(FLANGE, *joint_motion(np.random.default_rng(4), robot, 1, 50))
    nowhere = np.full(50, np.nan)
    blind = Motion(motion.p, motion.v, motion.a, motion.j, nowhere, nowhere, nowhere, nowhere)
    assert np.array_equal(robot.inverse(blind, 1).qddd, robot.inverse(motion, 1).qddd)


@every_arm
def test_every_link_moves_as_its_differences_say(robot: Scara) -> None:
    rng, step = np.random.default_rng(5), 1e-3
    q, qd, qdd, qddd = joint_motion(rng, robot, 1, 300)
    qd, qdd, qddd = qd / 3, qdd / 20, qddd / 200
    for link in range(len(LINKS)):
        around = []
        for k in range(-4, 5):
            t = k * step
            states = (
                q + qd * t + qdd * t**2 / 2 + qddd * t**3 / 6,
                qd + qdd * t + qddd * t**2 / 2,
                qdd + qddd * t,
                qddd,
            )
            with np.errstate(all="raise"):
                around.append(robot.link_motion(link, *states))
        for ladder in (("p", "v", "a", "j"), ("yaw", "yaw_d", "yaw_dd", "yaw_ddd")):
            for below, above in pairwise(ladder):
                difference = np.tensordot(STENCIL, np.stack([getattr(m, below) for m in around]), 1) / step
                assert np.abs(difference - getattr(around[4], above)).max() < 1e-9 * max(1, abs(robot.base.y))


@every_arm
def test_placements_forward_and_link_motion_are_one_geometry(robot: Scara) -> None:
    motion = joint_motion(np.random.default_rng(6), robot, 0, 200)
    q = motion[0]
    p, rotation = robot.placements(q)
    assert p.shape == (200, 5, 3)
    assert rotation.shape == (200, 5, 3, 3)
    for link in range(len(LINKS)):
        exact = robot.link_motion(link, *motion)
        assert np.abs(p[:, link] - exact.p).max() < 1e-14 * max(1, abs(robot.base.y))
        c, s = np.cos(exact.yaw), np.sin(exact.yaw)
        none, one = np.zeros_like(c), np.ones_like(c)
        turned = np.stack(
            [np.stack([c, -s, none], -1), np.stack([s, c, none], -1), np.stack([none, none, one], -1)], -2
        )
        assert np.abs(rotation[:, link] - turned).max() < 1e-14
    position, yaw = robot.forward(q)
    assert np.abs(position - p[:, FLANGE]).max() < 1e-14 * max(1, abs(robot.base.y))
    assert np.array_equal(yaw, robot.link_motion(FLANGE, *motion).yaw)
    assert (rotation[:, QUILL] == np.eye(3)).all()


def test_the_links_are_chained_as_poses_are() -> None:
    """By the pose algebra alone: base, shoulder turn, elbow, elbow turn, wrist."""
    robot, q = scara(), np.array([0.4, -1.1, 0.23, 2.0])
    shoulder = robot.base.then(Pose(yaw=0.4))
    elbow = shoulder.then(Pose(0.325)).then(Pose(yaw=-1.1))
    flange = elbow.then(Pose(0.225, 0.0, 0.23)).then(Pose(yaw=2.0))
    p, _ = robot.placements(q)
    quill = Pose(flange.x, flange.y, flange.z)
    for link, pose in enumerate((robot.base, shoulder, elbow, quill, flange)):
        assert np.abs(p[link] - pose.position).max() < 1e-15
        zero = np.zeros(4)
        assert robot.link_motion(link, q, zero, zero, zero).yaw == pytest.approx(pose.yaw, abs=1e-15)


@every_arm
def test_the_jacobian_is_the_difference_of_forward_and_gives_the_rates_of_the_dyad(robot: Scara) -> None:
    motion = joint_motion(np.random.default_rng(7), robot, 1, 500)
    q, step = motion[0], 1e-3
    n = robot.axes
    jacobian = robot.jacobian(q)
    assert jacobian.shape == (500, n, n)
    for joint in range(n):
        around = [robot.forward(q + k * step * np.eye(n)[joint]) for k in range(-4, 5)]
        task = np.stack([np.concatenate([p, yaw[:, None]], 1)[:, :n] for p, yaw in around])
        difference = np.tensordot(STENCIL, task, 1) / step
        assert np.abs(difference - jacobian[:, :, joint]).max() < 1e-10 * max(1, abs(robot.base.y))
    flange = robot.link_motion(FLANGE, *motion)
    rates = np.concatenate([flange.v, flange.yaw_d[:, None]], 1)[:, :n, None]
    qd = np.linalg.solve(jacobian, rates)[..., 0]
    assert np.abs(qd - robot.inverse(flange, 1).qd).max() < 1e-9 * max(1, abs(robot.base.y))
    if n == 4:
        assert np.abs(np.abs(np.linalg.det(jacobian)) - robot.l1 * robot.l2 * robot.margin(q)).max() < 1e-15


def test_the_velocities_of_the_dyad_are_those_of_the_inverse_jacobian() -> None:
    robot = scara()
    for mode in (0, 1):
        motion = joint_motion(np.random.default_rng(mode), robot, mode, 500)
        got = robot.inverse(robot.link_motion(FLANGE, *motion), mode, 1)
        flange = robot.link_motion(FLANGE, *motion)
        rates = np.concatenate([flange.v, flange.yaw_d[:, None]], -1)
        by_jacobian = (np.linalg.inv(robot.jacobian(got.q)) @ rates[..., None])[..., 0]
        assert np.abs(got.qd - by_jacobian).max() < 1e-10


def test_the_lift_carries_the_arms_where_they_rise_and_the_flange_alone_where_they_do_not() -> None:
    q = np.array([0.3, 1.0, 0.2, 0.0])
    low, high = scara().placements(q)[0], scara(arms_rise=True).placements(q)[0]
    assert low[:, 2].tolist() == [0.2, 0.2, 0.2, 0.4, 0.4]
    assert high[:, 2].tolist() == [0.2, 0.4, 0.4, 0.4, 0.4]
    assert np.array_equal(low[:, :2], high[:, :2])
    assert np.array_equal(scara().forward(q)[0], scara(arms_rise=True).forward(q)[0])


def test_the_nearer_singularity_has_its_name() -> None:
    q = np.array([[0.3, bend, 0.2, 0.0] for bend in (0.0, 1.5, -1.5, 1.6, -1.6, np.pi)])
    expected = [Code.STRETCHED] * 3 + [Code.FOLDED] * 3
    assert scara().singularity(q).tolist() == expected


@pytest.mark.parametrize("order", [0, 1, 2, 3])
@pytest.mark.parametrize("shape", [(), (1,), (7,), (3, 4)])
def test_lower_orders_and_other_shapes_give_the_same_numbers(order: int, shape: tuple[int, ...]) -> None:
    robot = scara()
    size = int(np.prod(shape))
    motion = [x.reshape(*shape, 4) for x in joint_motion(np.random.default_rng(8), robot, 0, size)]
    flange = robot.link_motion(FLANGE, *motion)
    part, full = robot.inverse(flange, 0, order), robot.inverse(flange, 0)
    assert part.code.shape == part.margin.shape == shape
    for k, name in enumerate(("q", "qd", "qdd", "qddd")):
        got = getattr(part, name)
        assert got.shape == (*shape, 4)
        assert np.array_equal(got, getattr(full, name)) if k <= order else np.isnan(got).all()
        flat = robot.inverse(
            Motion(
                *(getattr(flange, f).reshape(size, *getattr(flange, f).shape[len(shape) :]) for f in Motion.__slots__)
            ),
            0,
        )
        assert np.array_equal(getattr(flat, name).reshape(*shape, 4), getattr(full, name))


def reach_for(robot: Scara, x: FloatArray, y: FloatArray, mode: int) -> Inverse:
    """Inverse for flange positions in the base's own axes, moving."""
    c, s = np.cos(robot.base.yaw), np.sin(robot.base.yaw)
    p = np.stack([robot.base.x + c * x - s * y, robot.base.y + s * x + c * y, np.full_like(x, robot.base.z + 0.2)], -1)
    one, turn = np.ones_like(p), np.ones_like(x)
    with np.errstate(all="raise"):
        return robot.inverse(Motion(p, one, one, one, turn, turn, turn, turn), mode)


@every_arm
@pytest.mark.parametrize("mode", [0, 1])
def test_every_case_of_the_dyad_comes_through_with_what_is_defined(robot: Scara, mode: int) -> None:
    x = np.array([0.4, 0.55, 0.1, 0.7, 0.05])
    got = reach_for(robot, x, np.zeros(5), mode)
    expected = [Code.ASSEMBLED, Code.STRETCHED, Code.FOLDED, Code.OUT_OF_REACH, Code.OUT_OF_REACH]
    assert got.code.tolist() == expected
    for row, code in enumerate(expected):
        positioned = code in (Code.ASSEMBLED, Code.STRETCHED, Code.FOLDED)
        assert np.isfinite(got.q[row]).all() == positioned
        assert np.isnan(got.q[row]).all() != positioned
        assert np.isfinite(got.margin[row]) == positioned
        for rate in (got.qd, got.qdd, got.qddd):
            assert np.isfinite(rate[row]).all() == (code == Code.ASSEMBLED)
            assert np.isnan(rate[row]).all() == (code != Code.ASSEMBLED)
    assert got.q[1, 1] == 0
    assert got.q[2, 1] == (np.pi if mode else -np.pi)
    assert same_angle(got.q[1:3, 0], np.array([0.0, 0.0])).max() < 1e-13
    assert got.margin[1] == got.margin[2] == 0
    p, _ = robot.forward(got.q[1:3])
    assert np.abs(np.hypot(*(p[:, :2] - robot.base.position[:2]).T) - x[1:3]).max() < 1e-12


def test_equal_links_over_the_shoulder_are_indeterminate() -> None:
    got = reach_for(scara(l1=0.2, l2=0.2), np.zeros(2), np.zeros(2), 0)
    assert (got.code == Code.INDETERMINATE).all()
    assert np.isnan(np.stack([got.q, got.qd, got.qdd, got.qddd])).all()
    assert np.isnan(got.margin).all()


FIELDS = [("p", 0), ("p", 2), ("v", 1), ("v", 2), ("a", 2), ("j", 0), ("j", 2)]
TURNS = ["yaw", "yaw_d", "yaw_dd", "yaw_ddd"]


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("where", [*FIELDS, *((name, None) for name in TURNS)])
@pytest.mark.parametrize("reach", [0.4, 0.55])
def test_a_target_that_is_not_finite_is_refused_and_its_neighbours_are_not(
    bad: float, where: tuple[str, int | None], reach: float
) -> None:
    robot = Scara("arm", 0.325, 0.225, 4, limits(4))
    for shape in ((1,), (3,), ()):
        p = np.zeros((*shape, 3)) + np.array([reach, 0.0, 0.2])
        fields = {"p": p, **{name: np.ones_like(p) for name in "vaj"}, **{name: np.ones(shape) for name in TURNS}}
        good = robot.inverse(Motion(**{name: value.copy() for name, value in fields.items()}), 1)
        name, axis = where
        fields[name][(*(0 for _ in shape), *(() if axis is None else (axis,)))] = bad
        with np.errstate(all="raise"):
            got = robot.inverse(Motion(**fields), 1)
        first = (0,) * len(shape)
        assert got.code[first] == Code.OUT_OF_REACH
        assert np.isnan(got.margin[first])
        for part in ("q", "qd", "qdd", "qddd"):
            assert np.isnan(getattr(got, part)[first]).all()
        if shape == (3,):
            assert np.array_equal(got.code[1:], good.code[1:])
            assert np.array_equal(got.q[1:], good.q[1:])


def test_what_was_not_asked_may_be_anything() -> None:
    robot = Scara("arm", 0.325, 0.225, 4, limits(4))
    nan = np.full(3, np.nan)
    one = np.array(1.0)
    motion = Motion(
        np.array([0.4, 0.0, 0.2]), np.ones(3), nan, nan, one, one, nan[0:1].reshape(()), nan[0:1].reshape(())
    )
    assert robot.inverse(motion, 1, 1).code == Code.ASSEMBLED
    assert robot.inverse(motion, 1, 2).code == Code.OUT_OF_REACH


@given(
    theta1=st.floats(-3.0, 3.0),
    gap=st.floats(2.0, 5.0).map(lambda k: 10.0**-k),
    mode=st.sampled_from([0, 1]),
    folded=st.booleans(),
    base=st.sampled_from(BASES[:2]),
)
def test_near_a_singularity_the_inverse_still_comes_back_to_its_flange(
    theta1: float, gap: float, mode: int, folded: bool, base: Pose
) -> None:
    robot = scara(base=base)
    theta2 = (1 if mode else -1) * (np.pi - gap if folded else gap)
    q = np.array([theta1, theta2, 0.2, 1.0])
    p, yaw = robot.forward(q)
    zero = np.zeros(3)
    got = robot.inverse(Motion(p, zero, zero, zero, yaw, *(np.array(0.0),) * 3), mode)
    assert got.code == Code.ASSEMBLED
    back, back_yaw = robot.forward(got.q)
    assert np.abs(back - p).max() < 1e-14
    assert same_angle(back_yaw, yaw) < 1e-13
    assert abs(got.q[1] - theta2) < 1e-14 / gap
    assert got.margin == pytest.approx(np.sin(gap), rel=1e-14 / gap**2 + 1e-12)


grid = st.integers(-4, 4).map(lambda k: k * np.pi / 4)


@given(q1=grid, q2=grid, q4=grid, base_yaw=grid, shape=st.sampled_from([(), (2,)]))
def test_on_right_angles_the_inverse_comes_back_to_its_flange(
    q1: float, q2: float, q4: float, base_yaw: float, shape: tuple[int, ...]
) -> None:
    robot = scara(base=Pose(0.5, -0.25, 0.0, base_yaw), l1=0.25, l2=0.25)
    q = np.broadcast_to(np.array([q1, q2, 0.2, q4]), (*shape, 4))
    zero = np.zeros((*shape, 4))
    mode = int(robot.mode_of(np.array([q1, q2, 0.2, q4])))
    got = robot.inverse(robot.link_motion(FLANGE, q, zero, zero, zero), mode)
    if abs(q2) == np.pi:
        assert (got.code == Code.INDETERMINATE).all()
    else:
        assert (got.code == (Code.STRETCHED if q2 == 0 else Code.ASSEMBLED)).all()
        assert np.abs(robot.forward(got.q)[0] - robot.forward(q)[0]).max() < 1e-14
        assert same_angle(robot.forward(got.q)[1], robot.forward(q)[1]).max() < 1e-14


@given(st.floats(-3.14, 3.14), st.sampled_from([(0.325, 0.225), (0.2, 0.3), (0.25, 0.25)]))
def test_the_singular_distance_is_what_is_left_of_the_radius_on_either_side(
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


def test_the_mode_is_right_where_theta2_is_positive_and_none_where_it_is_unknown() -> None:
    q = np.zeros((6, 4))
    q[:, 1] = [0.5, -0.5, 2.6, -2.6, np.nan, np.inf]
    with np.errstate(all="raise"):
        assert scara().mode_of(q).tolist() == [1, 0, 1, 0, -1, -1]
    assert scara().margin(q)[:4].tolist() == np.abs(np.sin(q[:4, 1])).tolist()
    assert np.isnan(scara().margin(q)[4:]).all()


def test_within_takes_the_limits_themselves_and_nothing_beyond_rounding_and_no_nan() -> None:
    robot = scara()
    lower, upper = robot.limits.lower, robot.limits.upper
    assert (robot.limits.slack <= 1.01e-10 * (upper - lower)).all()
    assert robot.within(np.stack([lower, upper, (lower + upper) / 2])).all()
    for joint in range(4):
        for edge, outwards in ((lower, -1.0), (upper, 1.0)):
            beyond = edge.copy()
            beyond[joint] += outwards * 1.01 * robot.limits.slack[joint]
            assert not robot.within(beyond)
        unknown = lower.copy()
        unknown[joint] = np.nan
        assert not robot.within(unknown)
    assert robot.within(np.empty((0, 4))).shape == (0,)
    assert robot.within(np.zeros((2, 3, 4))).shape == (2, 3)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_joint_vectors_that_are_not_finite_give_nan_without_a_warning(bad: float) -> None:
    robot = scara()
    q = np.array([[0.1, bad, 0.2, 0.3], [0.1, 0.2, 0.3, 0.4]])
    with np.errstate(all="raise"):
        p, yaw = robot.forward(q)
        places, rotation = robot.placements(q)
        jacobian = robot.jacobian(q)
        moved = robot.link_motion(FLANGE, q, q, q, q)
    for x in (p, places[:, FLANGE], rotation[:, FLANGE], jacobian, moved.p, moved.j):
        assert np.isnan(x[0]).any()
        assert np.isfinite(x[1]).all()
    assert not np.isfinite(yaw[0])


def test_what_is_wrong_in_a_call_is_a_fault() -> None:
    robot, zero = scara(), np.zeros((1, 4))
    flange = robot.link_motion(FLANGE, zero, zero, zero, zero)
    with pytest.raises(FaultError, match="mode 2"):
        robot.inverse(flange, 2)
    with pytest.raises(FaultError, match="order 4"):
        robot.inverse(flange, 0, 4)
    with pytest.raises(FaultError, match="link 5"):
        robot.link_motion(5, zero, zero, zero, zero)


def solid(*pieces: Piece) -> Body:
    return Body("solid", pieces)


ROUND = [
    solid(Piece(cylinder(0.02, 0.3))),
    solid(Piece(capsule(0.02, 0.3), np.array([0.0, 0.0, 0.1]))),
    solid(Piece(sphere(0.05), rotation=AXES["x"])),
    solid(Piece(cylinder(0.02, 0.3), rotation=np.diag([1.0, -1.0, -1.0])), Piece(sphere(0.05))),
]
UNROUND = [
    solid(Piece(box(0.1, 0.1, 0.1))),
    solid(Piece(cylinder(0.02, 0.3), np.array([0.001, 0.0, 0.0]))),
    solid(Piece(cylinder(0.02, 0.3), rotation=AXES["x"])),
    solid(Piece(sphere(0.05)), Piece(box(0.1, 0.1, 0.1))),
]


@pytest.mark.parametrize("body", ROUND)
def test_a_solid_of_revolution_may_ride_on_the_quill(body: Body) -> None:
    assert Scara("arm", 0.3, 0.2, 4, limits(4), bodies=(RobotBody(body, QUILL),)).bodies[0].body is body


@pytest.mark.parametrize("body", UNROUND)
def test_what_turns_visibly_may_not_ride_on_the_quill_but_on_the_flange(body: Body) -> None:
    with pytest.raises(InputError, match="solids of revolution"):
        Scara("arm", 0.3, 0.2, 4, limits(4), bodies=(RobotBody(body, QUILL),))
    assert Scara("arm", 0.3, 0.2, 4, limits(4), bodies=(RobotBody(body, FLANGE),)).bodies


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"axes": 5}, "robot.axes"),
        ({"axes": 3}, "robot.limits"),
        ({"l1": 0.0}, "l1"),
        ({"l2": np.nan}, "l2"),
        ({"joint_names": ("a", "b", "c")}, "robot.joint_names"),
        ({"joint_names": ("a", "b", "c", "a")}, "robot.joint_names"),
        ({"bodies": (RobotBody(ROUND[0], 5),)}, "robot.bodies solid"),
        ({"bodies": (RobotBody(ROUND[0], -1),)}, "robot.bodies solid"),
        ({"self_pairs": (("base", "hand"),)}, "robot.self_pairs"),
    ],
)
def test_an_arm_that_is_not_one_is_refused_by_the_name_of_the_field(change: dict[str, object], field: str) -> None:
    good: dict[str, object] = {"name": "arm", "l1": 0.3, "l2": 0.2, "axes": 4, "limits": limits(4)}
    with pytest.raises(InputError) as refusal:
        Scara(**{**good, **change})  # type: ignore[arg-type]
    assert refusal.value.field == field
