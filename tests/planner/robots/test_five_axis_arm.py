"""The five-axis arm: inverse against forward, differences, dyads against J⁻¹ẋ, every case, and its bounds."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from assur.experiments.differential import determinant, inverse_jacobian, transforms
from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError, InputError
from assur.planner.frames.motion import Motion, Pose
from assur.planner.frames.tilted import TiltedMotion
from assur.planner.robots.elbow_arm import ElbowArm
from assur.planner.robots.five_axis_arm import FLANGE, LINK4, LINKS, FiveAxisArm
from assur.planner.robots.protocol import Code, Inverse, Limits, Pitching, Robot, Sweep
from assur.planner.robots.tilting import LINK2, LINK3

L1, L2, L3, HEIGHT = 0.25, 0.16, 0.072, 0.3
BASES = [Pose(), Pose(0.4, -0.7, 0.2, 2.5), Pose(-12.0, 30.0, -1.0, -9.0)]
STENCIL = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
"""Weights of the central first difference of order 8, over steps −4 … 4."""
SECOND = np.array([-1 / 560, 8 / 315, -1 / 5, 8 / 5, -205 / 72, 8 / 5, -1 / 5, 8 / 315, -1 / 560])
TILTS = ("tilt", "tilt_d", "tilt_dd", "tilt_ddd")
EVERY = (*Motion.__slots__, *TILTS)


def arm(base: Pose = BASES[1], l1: float = L1, l2: float = L2, l3: float = L3) -> FiveAxisArm:
    high, rate = np.full(5, 3.1), np.full(5, 5.0)
    limits = Limits(-high, high, rate, 20 * rate, 400 * rate)
    return FiveAxisArm(name="five", height=HEIGHT, l1=l1, l2=l2, l3=l3, limits=limits, base=base)


ARMS = [arm(base) for base in BASES]
every_arm = pytest.mark.parametrize("robot", ARMS)
every_mode = pytest.mark.parametrize("mode", range(4))


def states(rng: np.random.Generator, robot: FiveAxisArm, size: int, mode: int | None = None) -> tuple[FloatArray, ...]:
    """q, q̇, q̈, q⃛ (size, 5), q well away from singular positions, and in one working mode if one is asked."""
    limits, found = robot.limits, np.empty((0, 5))
    while len(found) < size:
        q = rng.uniform(limits.lower, limits.upper, (4 * size, 5))
        good = robot.margin(q) > 0.1
        found = np.concatenate([found, q[good if mode is None else good & (robot.mode_of(q) == mode)]])
    return (found[:size], *(scale * rng.normal(size=(size, 5)) for scale in (3.0, 20.0, 200.0)))


def far(robot: FiveAxisArm) -> float:
    return max(1.0, abs(robot.base.x), abs(robot.base.y))


def apart(a: FloatArray, b: FloatArray) -> FloatArray:
    """Difference of angles modulo full turns."""
    return np.asarray(np.abs(np.angle(np.exp(1j * (a - b)))))


def flange(robot: FiveAxisArm, *motion: FloatArray) -> TiltedMotion:
    found = robot.link_motion(FLANGE, *motion)
    assert isinstance(found, TiltedMotion)
    return found


def test_it_is_a_robot_with_a_wrist_and_others_are_not() -> None:
    robot: Robot = arm()
    assert robot.links == ("base", "link1", "link2", "link3", "link4", "flange")
    assert robot.coordinates == ("x", "y", "z", "pitch", "roll")
    assert robot.modes == ("up", "down", "back-up", "back-down")
    assert robot.tilting == {LINK2, LINK3, LINK4, FLANGE}
    assert robot.lift is None
    assert [joint.kind for joint in robot.joints] == ["revolute"] * 5
    assert isinstance(robot, Pitching)
    assert not isinstance(ElbowArm(name="e", height=0.3, l1=L1, l2=L2, limits=three()), Pitching)
    with pytest.raises(ValueError, match="read-only"):
        robot.rate_matrix[0, 0] = 2.0


def three() -> Limits:
    return Limits(*(getattr(arm().limits, name)[:3] for name in Limits.__dataclass_fields__))


@every_mode
@every_arm
def test_the_inverse_of_the_flange_motion_is_the_joint_motion(robot: FiveAxisArm, mode: int) -> None:
    motion = states(np.random.default_rng(mode), robot, 10_000, mode)
    asked = flange(robot, *motion)
    with np.errstate(all="raise"):
        got = robot.inverse(asked, mode)
    assert (got.code == Code.ASSEMBLED).all()
    assert apart(got.q, motion[0]).max() < 1e-12 * far(robot)
    assert np.abs(got.margin - robot.margin(motion[0])).max() < 1e-12 * far(robot)
    assert (robot.mode_of(got.q) == mode).all()
    back = flange(robot, got.q, got.qd, got.qdd, got.qddd)
    assert np.abs(back.p - asked.p).max() < 1e-9
    assert apart(back.tilt, asked.tilt).max() < 1e-9
    scale = np.linalg.norm(np.stack(motion[1:]), axis=(0, 2))[:, None]
    for found, made in zip((got.qd, got.qdd, got.qddd), motion[1:], strict=True):
        assert (np.abs(found - made) / scale).max() < 1e-8 * far(robot)


@every_arm
def test_every_link_moves_as_its_differences_say(robot: FiveAxisArm) -> None:
    q, *rates = states(np.random.default_rng(5), robot, 300)
    qd, qdd, qddd = rates[0] / 3, rates[1] / 20, rates[2] / 200
    step = 1e-3
    for link in range(len(LINKS)):
        around: list[Motion] = []
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
            assert np.abs(around[-1].p - robot.placements(joints[0])[0][:, link]).max() < 1e-14 * far(robot)
        names = [("p", "v", "a", "j"), ("yaw", "yaw_d", "yaw_dd", "yaw_ddd")]
        names += [TILTS] if link == FLANGE else []
        for orders in names:
            for lower, higher in pairwise(orders):
                slope = sum(w * getattr(m, lower) for w, m in zip(STENCIL, around, strict=True)) / step
                assert np.abs(slope - getattr(around[4], higher)).max() < 1e-9 * far(robot), (link, higher)


def homogeneous(axis: str, angle: float, *shift: float) -> FloatArray:
    """A right-handed rotation about an axis after a shift, (4, 4)."""
    c, s, found = np.cos(angle), np.sin(angle), np.eye(4)
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    found[[i, j], [i, j]], found[i, j], found[j, i] = c, -s, s
    found[:3, 3] = shift or (0.0, 0.0, 0.0)
    return found


@every_arm
def test_the_link_frames_are_the_products_of_homogeneous_transforms(robot: FiveAxisArm) -> None:
    base = homogeneous("z", robot.base.yaw, *robot.base.position)
    q = states(np.random.default_rng(6), robot, 50)[0]
    for row, frames in zip(q, transforms(robot, q), strict=True):
        chain = [base, base @ homogeneous("z", row[0], 0.0, 0.0, HEIGHT)]
        chain.append(chain[-1] @ homogeneous("y", -row[1]))
        chain.append(chain[-1] @ homogeneous("y", -row[2], L1, 0.0, 0.0))
        chain.append(chain[-1] @ homogeneous("y", -row[3], L2, 0.0, 0.0))
        chain.append(chain[-1] @ homogeneous("x", row[4], L3, 0.0, 0.0))
        assert np.abs(frames - np.stack(chain)).max() < 1e-14 * far(robot)


@every_arm
def test_heading_pitch_and_roll_are_the_attitude_of_the_flange_and_over_the_back_of_the_same_family(
    robot: FiveAxisArm,
) -> None:
    """H1, and that (φ1, P, R) and (φ1 + π, π − P, R + π) are one attitude."""
    q, *rest = states(np.random.default_rng(16), robot, 200)
    motion, rotation = flange(robot, q, *rest), robot.placements(q)[1][:, FLANGE]
    for yaw, (pitch, roll), found in zip(motion.yaw, motion.tilt, rotation, strict=True):
        for heading, p, r in ((yaw, pitch, roll), (yaw + np.pi, np.pi - pitch, roll + np.pi)):
            made = homogeneous("z", heading) @ homogeneous("y", -p) @ homogeneous("x", r)
            assert np.abs(made[:3, :3] - found).max() < 1e-13
        # the tool axis: pitch above the horizontal, in the plane of the heading
        axis = [np.cos(pitch) * np.cos(yaw), np.cos(pitch) * np.sin(yaw), np.sin(pitch)]
        assert found[:, 0] == pytest.approx(axis, abs=1e-13)


@every_arm
def test_the_jacobian_is_the_difference_of_position_and_attitude_and_its_determinant_is_that_of_h5(
    robot: FiveAxisArm,
) -> None:
    q = states(np.random.default_rng(7), robot, 10_000)[0]
    with np.errstate(all="raise"):
        jacobian = robot.jacobian(q)
    zero, step = np.zeros_like(q), 1e-3
    for joint in range(5):
        slope = np.zeros((len(q), 5))
        for k, weight in zip(range(-4, 5), STENCIL, strict=True):
            moved = q.copy()
            moved[:, joint] += k * step
            at = flange(robot, moved, zero, zero, zero)
            slope += weight * np.concatenate([at.p, at.tilt], -1) / step
        assert np.abs(slope - jacobian[..., joint]).max() < 1e-10 * far(robot)
    psi = np.cumsum(q[:, 1:4], -1)
    rho = L1 * np.cos(psi[:, 0]) + L2 * np.cos(psi[:, 1]) + L3 * np.cos(psi[:, 2])
    expected = -rho * L1 * L2 * np.sin(q[:, 2])
    assert np.abs(np.linalg.det(jacobian) - expected).max() < 1e-15
    assert np.abs(determinant(robot, q) - expected).max() < 1e-15
    assert np.abs(inverse_jacobian(robot, q) @ jacobian - np.eye(5)).max() < 1e-11
    assert robot.jacobian(q[3]).tolist() == jacobian[3].tolist()


@every_mode
@every_arm
def test_the_velocities_of_the_dyads_are_those_of_the_inverse_jacobian(robot: FiveAxisArm, mode: int) -> None:
    asked = flange(robot, *states(np.random.default_rng(mode), robot, 500, mode))
    got = robot.inverse(asked, mode, 1)
    rate = np.concatenate([asked.v, asked.tilt_d], -1)[..., None]
    assert np.abs(got.qd - (np.linalg.inv(robot.jacobian(got.q)) @ rate)[..., 0]).max() < 1e-10 * far(robot)


def reach_for(robot: FiveAxisArm, rho: FloatArray, h: FloatArray, pitch: FloatArray, mode: int) -> Inverse:
    """Inverse for moving tool points at radius ρ ahead of a base at the origin, h above the shoulder."""
    p = np.stack([rho, 0.0 * rho, HEIGHT + h], -1)
    one, turn = np.ones_like(p), np.ones_like(rho)
    tilt = np.stack([pitch, 0.3 * turn], -1)
    motion = TiltedMotion.of(Motion(p, one, one, one, turn, turn, turn, turn), tilt, *(0.1 * np.ones((3, *tilt.shape))))
    with np.errstate(all="raise"):
        return robot.inverse(motion, mode)


@every_mode
def test_every_case_comes_through_with_what_is_defined(mode: int) -> None:
    """The wrist is L3 inwards of the tool point for a hand that points outwards (in `back` modes: −x, pitch π)."""
    robot, out = arm(Pose()), 0.0 if mode < 2 else np.pi
    rho = L3 + np.array([0.3, L1 + L2, L1 - L2, 0.5, -L3, -L3, -L3])
    h = np.array([0.0, 0.0, 0.0, 0.1, 0.3 - L3, L1 + L2 - L3, 0.6])
    up = np.pi / 2
    got = reach_for(robot, rho, h, np.array([out, out, out, out, -up, -up, up]), mode)
    expected = [Code.ASSEMBLED, Code.STRETCHED, Code.FOLDED, Code.OUT_OF_REACH]
    expected += [Code.ALIGNED, Code.ALIGNED, Code.OUT_OF_REACH]
    assert got.code.tolist() == expected
    for row, code in enumerate(expected):
        known = np.isfinite(got.q[row])
        assert known.tolist() == [code not in (Code.ALIGNED, Code.OUT_OF_REACH), *[code != Code.OUT_OF_REACH] * 4]
        assert (got.margin[row] == 0.0) == (code not in (Code.ASSEMBLED, Code.OUT_OF_REACH))
        assert np.isfinite(got.qddd[row]).all() == (code == Code.ASSEMBLED)
        assert np.isnan(got.qd[row]).all() == (code != Code.ASSEMBLED)
    # over the axis the posture is known, whatever the base angle
    posture = got.q[4].copy()
    posture[0] = 1.234
    assert np.abs(robot.forward(posture)[0] - [0.0, 0.0, HEIGHT + 0.3 - L3]).max() < 1e-15
    # ... also where the wrist is far from it
    aside = reach_for(robot, np.zeros(1), np.array([0.25]), np.array([0.4]), mode)
    assert aside.code.tolist() == [Code.ALIGNED]


def test_the_singularities_are_where_the_determinant_vanishes_and_have_their_names() -> None:
    robot = arm(Pose())
    elbow, wrist = 1.0, 0.5
    reach = L1 + L2 * np.exp(1j * elbow) + L3 * np.exp(1j * (elbow + wrist))
    for joints, code in (
        ([0.3, 0.2, 0.0, 0.9, 0.1], Code.STRETCHED),
        ([0.3, 0.2, np.pi, 0.9, 0.1], Code.FOLDED),
        ([0.3, np.pi / 2 - float(np.angle(reach)), elbow, wrist, 0.1], Code.ALIGNED),
    ):
        at = np.array(joints)
        assert abs(np.linalg.det(robot.jacobian(at))) < 1e-17
        assert float(robot.margin(at)) < 1e-15
        assert float(robot.singular_distance(at)) < 1e-15
        assert robot.singularity(at) == code
    # the roll makes nothing singular: there is no factor of θ5
    q = np.array([0.3, 0.9, -1.3, 0.0, 0.0]) + np.linspace(-3, 3, 50)[:, None] * np.eye(5)[4]
    assert np.ptp(robot.margin(q)) == 0.0


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize(
    ("name", "axis"),
    [(name, i) for name in "pvaj" for i in range(3)] + [(name, i) for name in TILTS for i in range(2)],
)
def test_a_target_that_is_not_finite_is_refused_and_its_neighbours_are_not(bad: float, name: str, axis: int) -> None:
    robot = arm()
    rows = flange(robot, *states(np.random.default_rng(1), robot, 3, 0))
    good = robot.inverse(rows, 0)
    fields = {key: getattr(rows, key).copy() for key in EVERY}
    fields[name][1, axis] = bad
    with np.errstate(all="raise"):
        got = robot.inverse(TiltedMotion(**fields), 0)
    assert got.code.tolist() == [Code.ASSEMBLED, Code.OUT_OF_REACH, Code.ASSEMBLED]
    assert np.isnan([got.q[1], got.qd[1], got.qdd[1], got.qddd[1]]).all()
    assert np.isnan(got.margin[1])
    assert np.array_equal(got.q[::2], good.q[::2])


def test_lower_orders_and_other_shapes_give_the_same_numbers_and_the_yaw_is_not_looked_at() -> None:
    robot = arm()
    motion = flange(robot, *states(np.random.default_rng(2), robot, 6, 0))
    full, nowhere = robot.inverse(motion, 0), np.full(6, np.nan)
    blind = replace(motion, yaw=nowhere, yaw_d=nowhere, yaw_dd=nowhere, yaw_ddd=nowhere)
    assert np.array_equal(robot.inverse(blind, 0).qddd, full.qddd)
    for order in range(4):
        # what lies beyond the order asked need not be known
        beyond = TILTS[order + 1 :]
        part = robot.inverse(replace(motion, **{name: np.full((6, 2), np.nan) for name in beyond}), 0, order)
        for k, name in enumerate(("q", "qd", "qdd", "qddd")):
            value = getattr(part, name)
            assert np.array_equal(value, getattr(full, name)) if k <= order else np.isnan(value).all()
    single = robot.inverse(motion[2], 0)
    assert single.q.shape == (5,)
    assert np.array_equal(single.qddd, full.qddd[2])


@every_arm
def test_a_point_is_out_of_reach_at_every_pitch_by_as_much_as_the_nearest_pitch_says(robot: FiveAxisArm) -> None:
    rng = np.random.default_rng(9)
    lengths = ((L1, L2, L3), (0.2, 0.05, 0.05), (0.1, 0.1, 0.4))
    for l1, l2, l3 in lengths:
        other = arm(robot.base, l1, l2, l3)
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
    tip = arm(Pose()).out_of_reach(np.array([[0.582, 0.0, 0.3], [0.0, 0.0, 0.3], [np.nan, 0.0, 0.3]]))
    assert tip[:2] == pytest.approx([0.1, L1 - L2 - L3])
    assert np.isnan(tip[2])


@every_arm
@pytest.mark.parametrize("link", range(len(LINKS)))
def test_point_bounds_are_never_below_the_truth_at_random_points(robot: FiveAxisArm, link: int) -> None:
    """Truth by differences of placements: none of the bound's own formulas, nor of the link motion's."""
    rng, size = np.random.default_rng(link), 10_000
    q = rng.uniform(robot.limits.lower, robot.limits.upper, (size, 5))
    qd, qdd = rng.normal(size=(2, size, 5)) * np.array([2.0, 8.0])[:, None, None]
    local = rng.normal(size=(size, 3)) * 0.15
    step, around = 1e-3, []
    for k in range(-4, 5):
        t = k * step
        position, rotation = robot.placements(q + qd * t + qdd * t * t / 2)
        around.append(position[:, link] + (rotation[:, link] @ local[..., None])[..., 0])
    v = sum(w * x for w, x in zip(STENCIL, around, strict=True)) / step
    a = sum(w * x for w, x in zip(SECOND, around, strict=True)) / step**2
    c = robot.rate_matrix.T
    sweep = Sweep(q, q, np.abs(qd @ c), np.abs(qdd @ c))
    links, reach, distance = np.full(size, link), np.hypot(local[:, 0], local[:, 1]), np.linalg.norm(local, axis=1)
    for n in (rng.normal(size=(size, 3)), np.tile([0.0, 0.0, 1.0], (size, 1)), v, a):
        unit = n / np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-300)
        speed, acceleration = robot.point_bounds(links, reach, distance, unit, sweep)
        assert (np.abs((unit * v).sum(1)) <= speed * (1 + 1e-9) + 1e-8).all()
        assert (np.abs((unit * a).sum(1)) <= acceleration * (1 + 1e-9) + 1e-4).all()


def test_a_flange_that_only_rolls_moves_the_points_off_its_axis_and_nothing_else() -> None:
    robot, ones = arm(), np.ones(1)
    q, rate = np.zeros((1, 5)), np.array([[0.0, 0.0, 0.0, 0.0, 2.0]])
    sweep = Sweep(q, q, np.abs(rate @ robot.rate_matrix.T), np.zeros((1, 5)))
    n = np.array([[0.0, 0.0, 1.0]])
    for link in range(len(LINKS)):
        speed, acceleration = robot.point_bounds(np.array([link]), 0.1 * ones, 0.1 * ones, n, sweep)
        rolls = link == FLANGE
        assert speed[0] == pytest.approx(0.2 if rolls else 0.0, abs=1e-15)
        assert acceleration[0] == pytest.approx(0.4 if rolls else 0.0, abs=1e-15)


@pytest.mark.parametrize("link", [LINK2, LINK3, LINK4, FLANGE])
def test_the_bound_of_speed_is_reached_by_a_stretched_arm_that_only_tilts(link: int) -> None:
    robot = arm()
    q, rate = np.array([[0.3, 0.4, 0.0, 0.0, 0.0]]), np.array([[0.0, 2.0, 0.0, 0.0, 0.0]])
    position, rotation = robot.placements(q)
    tip = position[0, link] + 0.1 * rotation[0, link, :, 0] - position[0, LINK2]
    sweep = Sweep(q, q, np.abs(rate @ robot.rate_matrix.T), np.zeros((1, 5)))
    n = np.array([[0.0, 0.0, 1.0]])
    speed, acceleration = robot.point_bounds(np.array([link]), np.array([0.1]), np.array([0.1]), n, sweep)
    assert speed[0] == pytest.approx(2.0 * np.linalg.norm(tip), rel=1e-12)
    assert acceleration[0] == pytest.approx(4.0 * np.linalg.norm(tip), rel=1e-12)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_what_is_not_known_is_bounded_by_infinity_without_a_warning(bad: float) -> None:
    robot, links, n = arm(), np.arange(1, 6), np.tile([0.6, 0.0, 0.8], (5, 1))
    known, unknown, ones = np.ones((5, 5)), np.full((5, 5), bad), np.ones(5)
    with np.errstate(all="raise"):
        for sweep, size in (
            (Sweep(unknown, unknown, unknown, unknown), ones),
            (Sweep(known, known, known, known), bad * ones),
            (Sweep(known, known, known, known), -ones),
        ):
            assert all((bound == np.inf).all() for bound in robot.point_bounds(links, size, size, n, sweep))
    with pytest.raises(FaultError, match="no such link"):
        robot.point_bounds(np.array([6]), ones[:1], ones[:1], n[:1], Sweep(known, known, known, known))


def test_what_is_no_arm_or_has_no_attitude_is_refused() -> None:
    for bad in (0.0, -0.1, np.inf, np.nan):
        with pytest.raises(InputError, match="l3"):
            arm(l3=bad)
    with pytest.raises(InputError, match="5 joints"):
        FiveAxisArm(name="five", height=HEIGHT, l1=L1, l2=L2, l3=L3, limits=three())
    with pytest.raises(FaultError, match="pitch and roll"):
        arm().inverse(Motion.still(Pose(0.3, 0.0, 0.3)), 0)
    still = TiltedMotion.of(Motion.still(Pose(0.3, 0.0, 0.3)), np.zeros(2))
    for mode in (-1, 4):
        with pytest.raises(FaultError, match="mode"):
            arm().inverse(still, mode)
    with pytest.raises(FaultError, match="link 6"):
        arm().link_motion(6, *np.zeros((4, 5)))
