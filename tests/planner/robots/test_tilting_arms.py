"""Elbow arm and polar arm: inverse against forward, differences, the dyads against J⁻¹ẋ, every case and bound."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError, InputError
from assur.planner.frames.motion import Motion, Pose
from assur.planner.geometry.shapes import Body, Piece, box
from assur.planner.robots.elbow_arm import ElbowArm
from assur.planner.robots.polar_arm import PolarArm
from assur.planner.robots.protocol import Code, Inverse, Limits, Robot, RobotBody, Sweep
from assur.planner.robots.tilting import BASE, FLANGE, LINK1, LINK2, LINK3, LINKS, TiltingArm

BASES = [Pose(), Pose(0.4, -0.7, 0.2, 2.5), Pose(-12.0, 30.0, -1.0, -9.0)]
STENCIL = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
"""Weights of the central first difference of order 8, over steps −4 … 4."""
RATE = np.full(3, 5.0)


def elbow(base: Pose = BASES[1], l1: float = 0.25, l2: float = 0.16) -> ElbowArm:
    limits = Limits(np.array([-3.1, -3.1, -3.1]), np.array([3.1, 3.1, 3.1]), RATE, 20 * RATE, 400 * RATE)
    return ElbowArm(name="elbow", height=0.3, l1=l1, l2=l2, limits=limits, base=base)


def polar(base: Pose = BASES[1]) -> PolarArm:
    limits = Limits(np.array([-3.1, -3.1, 0.2]), np.array([3.1, 3.1, 0.6]), RATE, 20 * RATE, 400 * RATE)
    return PolarArm(name="polar", height=0.4, limits=limits, base=base)


ARMS = [make(base) for make in (elbow, polar) for base in BASES]
every_arm = pytest.mark.parametrize("robot", ARMS)
every_kind = pytest.mark.parametrize("robot", [elbow(), polar()])
modes_of_arms = pytest.mark.parametrize(("robot", "mode"), [(a, k) for a in ARMS for k in range(len(a.modes))])


def states(rng: np.random.Generator, robot: TiltingArm, size: int, mode: int | None = None) -> tuple[FloatArray, ...]:
    """q, q̇, q̈, q⃛ (size, 3), q well away from singular positions, and in one working mode if one is asked."""
    limits, found = robot.limits, np.empty((0, 3))
    while len(found) < size:
        q = rng.uniform(limits.lower, limits.upper, (4 * size, 3))
        good = robot.margin(q) > 0.1
        found = np.concatenate([found, q[good if mode is None else good & (robot.mode_of(q) == mode)]])
    return (found[:size], *(scale * rng.normal(size=(size, 3)) for scale in (3.0, 20.0, 200.0)))


def apart(robot: TiltingArm, a: FloatArray, b: FloatArray) -> FloatArray:
    """Difference of joint vectors, revolute joints modulo full turns."""
    turns = np.array([joint.kind == "revolute" for joint in robot.joints])
    return np.where(turns, np.abs(np.angle(np.exp(1j * (a - b)))), np.abs(a - b))


def test_both_are_robots() -> None:
    robots: list[Robot] = [elbow(), polar()]
    for robot in robots:
        assert robot.links == ("base", "link1", "link2", "link3", "flange")
        assert robot.coordinates == ("x", "y", "z")
        assert robot.tilting == {LINK2, LINK3, FLANGE}
        assert robot.lift is None
        with pytest.raises(ValueError, match="read-only"):
            robot.rate_matrix[0, 0] = 2.0
    assert robots[0].modes == ("up", "down", "back-up", "back-down")
    assert robots[1].modes == ("front", "back")
    assert [joint.kind for joint in robots[1].joints] == ["revolute", "revolute", "prismatic"]


@modes_of_arms
def test_the_inverse_of_the_flange_motion_is_the_joint_motion(robot: TiltingArm, mode: int) -> None:
    motion = states(np.random.default_rng(mode), robot, 10_000, mode)
    with np.errstate(all="raise"):
        got = robot.inverse(robot.link_motion(FLANGE, *motion), mode)
    far = max(1.0, abs(robot.base.x), abs(robot.base.y))
    assert (got.code == Code.ASSEMBLED).all()
    assert apart(robot, got.q, motion[0]).max() < 1e-12 * far
    assert np.abs(got.margin - robot.margin(motion[0])).max() < 1e-12 * far
    position, heading = robot.forward(got.q)
    assert np.abs(position - robot.link_motion(FLANGE, *motion).p).max() < 1e-9
    assert np.isfinite(heading).all()
    scale = np.linalg.norm(np.stack(motion[1:]), axis=(0, 2))[:, None]
    for found, made in zip((got.qd, got.qdd, got.qddd), motion[1:], strict=True):
        assert (np.abs(found - made) / scale).max() < 1e-8 * far


@every_arm
def test_every_link_moves_as_its_differences_say(robot: TiltingArm) -> None:
    q, *rates = states(np.random.default_rng(5), robot, 300)
    qd, qdd, qddd = rates[0] / 3, rates[1] / 20, rates[2] / 200
    step = 1e-3
    for link in range(len(LINKS)):
        around = []
        for k in range(-4, 5):
            t = k * step
            joints = (
                q + qd * t + qdd * t**2 / 2 + qddd * t**3 / 6,
                qd + qdd * t + qddd * t**2 / 2,
                qdd + qddd * t,
                qddd,
            )
            with np.errstate(all="raise"):
                around.append(robot.link_motion(link, *joints))
            frame, _ = robot.placements(joints[0])
            assert np.array_equal(around[-1].p, frame[:, link]) or np.abs(around[-1].p - frame[:, link]).max() < 1e-14
        far = max(1.0, abs(robot.base.y))
        for lower, higher in pairwise(("p", "v", "a", "j")):
            slope = sum(w * getattr(m, lower) for w, m in zip(STENCIL, around, strict=True)) / step
            assert np.abs(slope - getattr(around[4], higher)).max() < 1e-9 * far
        for lower, higher in pairwise(("yaw", "yaw_d", "yaw_dd", "yaw_ddd")):
            slope = sum(w * getattr(m, lower) for w, m in zip(STENCIL, around, strict=True)) / step
            assert np.abs(slope - getattr(around[4], higher)).max() < 1e-9 * far


def homogeneous(rotation: FloatArray, position: FloatArray) -> FloatArray:
    """(4, 4)."""
    found = np.eye(4)
    found[:3, :3], found[:3, 3] = rotation, position
    return found


def about(axis: str, angle: float) -> FloatArray:
    """A right-handed rotation about y or z, (3, 3)."""
    c, s = np.cos(angle), np.sin(angle)
    if axis == "z":
        return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


@every_arm
def test_the_link_frames_are_the_products_of_homogeneous_transforms(robot: TiltingArm) -> None:
    """T = T_base · T(height) Rz(θ1) · Ry(−ψ) …: tilting up is turning about −y."""
    base = homogeneous(about("z", robot.base.yaw), robot.base.position)
    for q in states(np.random.default_rng(6), robot, 50)[0]:
        chain = [base, base @ homogeneous(about("z", q[0]), np.array([0.0, 0.0, robot.height]))]
        chain.append(chain[-1] @ homogeneous(about("y", -q[1]), np.zeros(3)))
        if isinstance(robot, ElbowArm):
            chain.append(chain[-1] @ homogeneous(about("y", -q[2]), np.array([robot.l1, 0.0, 0.0])))
            chain.append(chain[-1] @ homogeneous(np.eye(3), np.array([robot.l2, 0.0, 0.0])))
        else:
            chain += [chain[-1] @ homogeneous(np.eye(3), np.array([q[2], 0.0, 0.0]))] * 2
        position, rotation = robot.placements(q)
        for link, expected in enumerate(chain):
            assert np.abs(rotation[link] - expected[:3, :3]).max() < 1e-14
            assert np.abs(position[link] - expected[:3, 3]).max() < 1e-13


def test_the_polar_arm_is_that_of_the_printed_matrices() -> None:
    """Source 002: T = A1 A2 A3 with θ2 = ψ − 90°, d3 and l1; the last column is where the flange is."""
    robot = polar(Pose())
    for q in states(np.random.default_rng(8), robot, 50)[0]:
        c1, s1 = np.cos(q[0]), np.sin(q[0])
        c2, s2 = np.cos(q[1] - np.pi / 2), np.sin(q[1] - np.pi / 2)
        a1 = np.array([[c1, 0, s1, 0], [s1, 0, -c1, 0], [0, 1, 0, robot.height], [0, 0, 0, 1]])
        a2 = np.array([[c2, 0, -s2, 0], [s2, 0, c2, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
        a3 = homogeneous(np.eye(3), np.array([0.0, 0.0, q[2]]))
        printed = a1 @ a2 @ a3
        position, rotation = robot.placements(q)
        assert np.abs(printed[:3, 3] - position[FLANGE]).max() < 1e-15
        # its third axis is the ram's direction, our first
        assert np.abs(printed[:3, 2] - rotation[FLANGE][:, 0]).max() < 1e-15


@every_arm
def test_the_jacobian_is_the_difference_of_the_position_and_its_determinant_the_printed_one(robot: TiltingArm) -> None:
    q = states(np.random.default_rng(7), robot, 10_000)[0]
    with np.errstate(all="raise"):
        jacobian = robot.jacobian(q)
    step = 1e-3
    for joint in range(3):
        slope = np.zeros((len(q), 3))
        for k, weight in zip(range(-4, 5), STENCIL, strict=True):
            moved = q.copy()
            moved[:, joint] += k * step
            slope += weight * robot.forward(moved)[0] / step
        assert np.abs(slope - jacobian[..., joint]).max() < 1e-10 * max(1.0, abs(robot.base.y))
    if isinstance(robot, ElbowArm):
        rho = robot.l1 * np.cos(q[:, 1]) + robot.l2 * np.cos(q[:, 1] + q[:, 2])
        expected = -rho * robot.l1 * robot.l2 * np.sin(q[:, 2])
    else:
        expected = q[:, 2] ** 2 * np.cos(q[:, 1])
    assert np.abs(np.linalg.det(jacobian) - expected).max() < 1e-15


@modes_of_arms
def test_the_velocities_of_the_dyads_are_those_of_the_inverse_jacobian(robot: TiltingArm, mode: int) -> None:
    motion = states(np.random.default_rng(mode), robot, 500, mode)
    flange = robot.link_motion(FLANGE, *motion)
    got = robot.inverse(flange, mode, 1)
    by_jacobian = (np.linalg.inv(robot.jacobian(got.q)) @ flange.v[..., None])[..., 0]
    assert np.abs(got.qd - by_jacobian).max() < 1e-10 * max(1.0, abs(robot.base.y))


def reach_for(robot: TiltingArm, rho: FloatArray, h: FloatArray, mode: int) -> Inverse:
    """Inverse for moving flange positions at radius ρ, straight ahead of the base, and h above the shoulder."""
    c, s = np.cos(robot.base.yaw), np.sin(robot.base.yaw)
    z = robot.base.z + robot.height + h
    p = np.stack([robot.base.x + c * rho, robot.base.y + s * rho, z], -1)
    one, turn = np.ones_like(p), np.ones_like(rho)
    with np.errstate(all="raise"):
        return robot.inverse(Motion(p, one, one, one, turn, turn, turn, turn), mode)


@pytest.mark.parametrize("mode", range(4))
def test_every_case_of_the_elbow_arm_comes_through_with_what_is_defined(mode: int) -> None:
    robot = elbow(Pose())
    rho = np.array([0.3, 0.41, 0.09, 0.5, 0.0, 0.0, 0.0])
    h = np.array([0.0, 0.0, 0.0, 0.1, 0.3, 0.41, 0.6])
    got = reach_for(robot, rho, h, mode)
    expected = [Code.ASSEMBLED, Code.STRETCHED, Code.FOLDED, Code.OUT_OF_REACH]
    expected += [Code.ALIGNED, Code.ALIGNED, Code.OUT_OF_REACH]
    assert got.code.tolist() == expected
    for row, code in enumerate(expected):
        known = np.isfinite(got.q[row])
        assert known.tolist() == [code not in (Code.ALIGNED, Code.OUT_OF_REACH), *[code != Code.OUT_OF_REACH] * 2]
        assert (got.margin[row] == 0.0) == (code not in (Code.ASSEMBLED, Code.OUT_OF_REACH))
        assert np.isfinite(got.qddd[row]).all() == (code == Code.ASSEMBLED)
        assert np.isnan(got.qd[row]).all() == (code != Code.ASSEMBLED)
    # over the axis the posture is known, whatever the base angle
    posture = got.q[4].copy()
    posture[0] = 1.234
    assert np.abs(robot.forward(posture)[0] - [0.0, 0.0, 0.6]).max() < 1e-15


@pytest.mark.parametrize("mode", range(2))
def test_every_case_of_the_polar_arm_comes_through_with_what_is_defined(mode: int) -> None:
    got = reach_for(polar(Pose()), np.array([0.3, 0.0, 0.0]), np.array([0.1, 0.3, 0.0]), mode)
    assert got.code.tolist() == [Code.ASSEMBLED, Code.ALIGNED, Code.INDETERMINATE]
    assert np.isfinite(got.q[0]).all()
    assert got.q[1, 1:] == pytest.approx([np.pi / 2, 0.3], abs=1e-15)
    assert np.isnan(got.q[1, 0])
    assert np.isnan(got.q[2]).all()
    assert got.margin[1] == 0.0


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize(("name", "axis"), [(name, axis) for name in "pvaj" for axis in range(3)])
@every_kind
def test_a_target_that_is_not_finite_is_refused_and_its_neighbours_are_not(
    robot: TiltingArm, bad: float, name: str, axis: int
) -> None:
    rows = robot.link_motion(FLANGE, *states(np.random.default_rng(1), robot, 3, 0))
    good = robot.inverse(rows, 0)
    fields = {key: getattr(rows, key).copy() for key in Motion.__slots__}
    fields[name][1, axis] = bad
    with np.errstate(all="raise"):
        got = robot.inverse(Motion(**fields), 0)
    assert got.code.tolist() == [Code.ASSEMBLED, Code.OUT_OF_REACH, Code.ASSEMBLED]
    assert np.isnan([got.q[1], got.qd[1], got.qdd[1], got.qddd[1]]).all()
    assert np.isnan(got.margin[1])
    assert np.array_equal(got.q[::2], good.q[::2])


@every_kind
def test_lower_orders_and_other_shapes_give_the_same_numbers_and_the_yaw_is_not_looked_at(robot: TiltingArm) -> None:
    motion = robot.link_motion(FLANGE, *states(np.random.default_rng(2), robot, 6, 0))
    full = robot.inverse(motion, 0)
    nowhere = np.full(6, np.nan)
    blind = Motion(motion.p, motion.v, motion.a, motion.j, nowhere, nowhere, nowhere, nowhere)
    assert np.array_equal(robot.inverse(blind, 0).qddd, full.qddd)
    for order in range(4):
        part = robot.inverse(motion, 0, order)
        for k, name in enumerate(("q", "qd", "qdd", "qddd")):
            value = getattr(part, name)
            assert np.array_equal(value, getattr(full, name)) if k <= order else np.isnan(value).all()
    single = robot.inverse(Motion(*(getattr(motion, name)[2] for name in Motion.__slots__)), 0)
    assert single.q.shape == (3,)
    assert np.array_equal(single.qddd, full.qddd[2])


@pytest.mark.parametrize(
    ("robot", "q", "expected"),
    [
        (elbow(), [0.3, 0.2, 0.01], Code.STRETCHED),
        (elbow(), [0.3, 0.2, -0.01], Code.STRETCHED),
        (elbow(), [0.3, 0.2, 3.13], Code.FOLDED),
        (elbow(), [0.3, 0.2, -3.13], Code.FOLDED),
        (elbow(), [0.3, np.pi / 2 - 0.2, 0.5], Code.ALIGNED),
        (polar(), [0.3, 1.5, 0.4], Code.ALIGNED),
        (polar(), [0.3, 0.0, 0.2], Code.FOLDED),
    ],
)
def test_the_singularity_that_is_nearest_has_its_name(robot: TiltingArm, q: list[float], expected: Code) -> None:
    assert robot.singularity(np.array(q)) == expected


def test_the_singularities_are_where_the_determinant_vanishes() -> None:
    arm, ram = elbow(Pose()), polar(Pose())
    fold = np.arctan2(0.16 * np.sin(1.0), 0.25 + 0.16 * np.cos(1.0))
    for robot, q, code in (
        (arm, [0.3, 0.2, 0.0], Code.STRETCHED),
        (arm, [0.3, 0.2, np.pi], Code.FOLDED),
        (arm, [0.3, np.pi / 2 - fold, 1.0], Code.ALIGNED),
        (ram, [0.3, np.pi / 2, 0.4], Code.ALIGNED),
    ):
        at = np.array(q)
        assert abs(np.linalg.det(robot.jacobian(at))) < 1e-17
        assert float(robot.margin(at)) < 1e-15
        assert float(robot.singular_distance(at)) < 1e-15
        assert robot.singularity(at) == code


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


@every_arm
@pytest.mark.parametrize("link", range(len(LINKS)))
def test_point_bounds_are_never_below_the_truth_at_random_points(robot: TiltingArm, link: int) -> None:
    """Truth by differences of placements: none of the bound's own formulas, nor of the link motion's."""
    rng, size = np.random.default_rng(link), 10_000
    limits = robot.limits
    q = rng.uniform(limits.lower, limits.upper, (size, 3))
    qd, qdd = rng.normal(size=(2, size, 3)) * np.array([2.0, 8.0])[:, None, None]
    local = rng.normal(size=(size, 3)) * 0.15
    step, around = 1e-3, []
    for k in range(-4, 5):
        t = k * step
        position, rotation = robot.placements(q + qd * t + qdd * t * t / 2)
        around.append(position[:, link] + (rotation[:, link] @ local[..., None])[..., 0])
    second = np.array([-1 / 560, 8 / 315, -1 / 5, 8 / 5, -205 / 72, 8 / 5, -1 / 5, 8 / 315, -1 / 560])
    v = sum(w * x for w, x in zip(STENCIL, around, strict=True)) / step
    a = sum(w * x for w, x in zip(second, around, strict=True)) / step**2
    c = robot.rate_matrix.T
    sweep = Sweep(q, q, np.abs(qd @ c), np.abs(qdd @ c))
    links, reach, distance = np.full(size, link), np.hypot(local[:, 0], local[:, 1]), np.linalg.norm(local, axis=1)
    for n in (rng.normal(size=(size, 3)), np.tile([0.0, 0.0, 1.0], (size, 1)), v, a):
        unit = n / np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-300)
        speed, acceleration = robot.point_bounds(links, reach, distance, unit, sweep)
        assert (np.abs((unit * v).sum(1)) <= speed * (1 + 1e-9) + 1e-8).all()
        assert (np.abs((unit * a).sum(1)) <= acceleration * (1 + 1e-9) + 1e-4).all()


@pytest.mark.parametrize("link", [LINK2, LINK3, FLANGE])
@every_kind
def test_the_bound_of_speed_is_reached_by_a_stretched_arm_that_only_tilts(robot: TiltingArm, link: int) -> None:
    """In the vertical plane nothing is given away."""
    longest = float(robot.limits.upper[2]) if isinstance(robot, PolarArm) else 0.0
    q, rate = np.array([[0.3, 0.4, longest]]), np.array([[0.0, 2.0, 0.0]])
    position, rotation = robot.placements(q)
    tip = position[0, link] + 0.1 * rotation[0, link, :, 0] - position[0, LINK2]
    sweep = Sweep(q, q, np.abs(rate @ robot.rate_matrix.T), np.zeros((1, 3)))
    one = np.array([link])
    speed, acceleration = robot.point_bounds(one, np.array([0.1]), np.array([0.1]), np.array([[0.0, 0.0, 1.0]]), sweep)
    assert speed[0] == pytest.approx(2.0 * np.linalg.norm(tip), rel=1e-5)
    assert acceleration[0] == pytest.approx(4.0 * np.linalg.norm(tip), rel=1e-5)


@every_kind
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_what_is_not_known_is_bounded_by_infinity_without_a_warning(robot: TiltingArm, bad: float) -> None:
    links, n = np.arange(1, 5), np.tile([0.6, 0.0, 0.8], (4, 1))
    known, unknown, ones = np.ones((4, 3)), np.full((4, 3), bad), np.ones(4)
    with np.errstate(all="raise"):
        for sweep, reach, distance in (
            (Sweep(unknown, unknown, unknown, unknown), ones, ones),
            (Sweep(known, known, known, known), bad * ones, bad * ones),
            (Sweep(known, known, known, known), -ones, -ones),
        ):
            assert all((bound == np.inf).all() for bound in robot.point_bounds(links, reach, distance, n, sweep))
    with pytest.raises(FaultError, match="no such link"):
        robot.point_bounds(np.array([5]), ones[:1], ones[:1], n[:1], Sweep(known, known, known, known))


@every_kind
def test_the_base_stands_and_the_turret_does_not_tilt(robot: TiltingArm) -> None:
    ones, n = np.ones((4, 3)), np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]] * 2)
    links = np.array([BASE, BASE, LINK1, LINK1])
    sweep = Sweep(ones, ones, ones, ones)
    speed, _ = robot.point_bounds(links, np.full(4, 0.2), np.full(4, 9.0), n, sweep)
    assert speed.tolist() == [0.0, 0.0, 0.2, 0.0]


def test_what_is_no_arm_is_refused() -> None:
    limits = elbow().limits
    body = RobotBody(Body("b", (Piece(box(0.1, 0.1, 0.1)),)), 7)
    for more, match in (
        ({"l1": -1.0}, "l1"),
        ({"height": np.nan}, "height"),
        ({"joint_names": ("a", "a", "b")}, "3 different names"),
        ({"bodies": (body,)}, "link number"),
        ({"self_pairs": (("base", "quill"),)}, "pairs out of"),
    ):
        with pytest.raises(InputError, match=match):
            ElbowArm(**{"name": "e", "height": 0.3, "l1": 0.2, "l2": 0.2, "limits": limits, **more})  # type: ignore[arg-type]
    with pytest.raises(InputError, match="length from"):
        PolarArm(name="p", height=0.3, limits=limits)
    two = Limits(*(getattr(limits, name)[:2] for name in ("lower", "upper", "velocity", "acceleration", "jerk")))
    with pytest.raises(InputError, match="3 joints"):
        ElbowArm(name="e", height=0.3, l1=0.2, l2=0.2, limits=two)
    for bad in (-1, 4):
        with pytest.raises(FaultError, match="mode"):
            elbow().inverse(Motion.still(Pose()), bad)
    with pytest.raises(FaultError, match="link 5"):
        polar().link_motion(5, *np.zeros((4, 3)))
