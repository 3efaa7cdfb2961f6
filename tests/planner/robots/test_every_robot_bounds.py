"""Bounds of point speed and acceleration along a direction, of every robot: never below the truth, and sharp."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.robots.robot import Robot
from assur.planner.robots.scara import BASE, FLANGE, LINK1, LINK2, LINKS, QUILL
from tests.planner.robots.families import MADE, NAMES, STENCIL, elbow, five_axis, polar, random_q, robot_named, scara
from tests.planner.robots.five_bars import LENGTHS, five_bar, states
from tests.planner.robots.point_bounds import Sweep, point_bounds

SECOND = np.array([-1 / 560, 8 / 315, -1 / 5, 8 / 5, -205 / 72, 8 / 5, -1 / 5, 8 / 315, -1 / 560])
"""Weights of the central second difference."""
UP = np.array([[0.0, 0.0, 1.0]])
KINDS = (*MADE, "mitsubishi-rp-5ah", "mitsubishi-rv-m1", "polar-arm", "elbow-arm")
every_link = pytest.mark.parametrize(
    ("name", "link"), [(name, link) for name in KINDS for link in range(len(robot_named(name).links))]
)


def of_rates(robot: Robot, lower: FloatArray, upper: FloatArray, qd: FloatArray, qdd: FloatArray) -> Sweep:
    """What is known of a motion within a range: the rates themselves."""
    return Sweep(lower, upper, np.abs(qd @ robot.rate_matrix.T), np.abs(qdd @ robot.rate_matrix.T))


def ranges(robot: Robot, rng: np.random.Generator, size: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Random states (size, n), singular or not, at the corners of ranges that a proof may ask for: instants, and up to
    0.02 wide."""
    middle = rng.uniform(robot.limits.lower, robot.limits.upper, (40 * size, len(robot.joints)))
    middle = middle[robot.within(middle)][:size]
    assert len(middle) == size
    width = rng.choice([0.0, 1e-6, 1e-3, 0.02], (size, 1))
    lower, upper = middle - width * rng.random(middle.shape), middle + width * rng.random(middle.shape)
    return lower, upper, lower + (upper - lower) * rng.integers(0, 2, middle.shape)


@every_link
def test_the_bounds_are_never_below_the_truth_anywhere_in_the_range(name: str, link: int) -> None:
    """Truth by differences of placements, of upright links by the rotation about the vertical: none of the bound's own
    formulas."""
    robot, rng, size = robot_named(name), np.random.default_rng(link), 5_000
    lower, upper, q = ranges(robot, rng, size)
    qd, qdd = rng.normal(size=(2, *q.shape)) * np.array([2.0, 8.0])[:, None, None]
    local = rng.normal(size=(size, 3)) * 0.15
    reach, distance = np.hypot(local[:, 0], local[:, 1]), np.linalg.norm(local, axis=1)
    if link in robot.tilting:
        step, around = 1e-3, []
        for k in range(-4, 5):
            position, rotation = robot.placements(q + qd * k * step + qdd * (k * step) ** 2 / 2)
            around.append(position[:, link] + (rotation[:, link] @ local[..., None])[..., 0])
        v, a = (np.tensordot(w, np.stack(around), 1) / step**order for order, w in ((1, STENCIL), (2, SECOND)))
        off = 1e-8, 1e-4
    else:
        frame = robot.link_motion(link, q, qd, qdd, 0 * q)
        c, s = np.cos(frame.yaw), np.sin(frame.yaw)
        x, y = c * local[:, 0] - s * local[:, 1], s * local[:, 0] + c * local[:, 1]
        out, along = np.stack([x, y, 0 * x], -1), np.stack([-y, x, 0 * x], -1)
        v = frame.v + frame.yaw_d[:, None] * along
        a = frame.a + frame.yaw_dd[:, None] * along - frame.yaw_d[:, None] ** 2 * out
        off = 1e-14, 1e-12
    known = robot.assembled(lower, upper)
    assert known.mean() > 0.5
    sweep, links = of_rates(robot, lower, upper, qd, qdd), np.full(size, link)
    for n in (rng.normal(size=(size, 3)), np.tile(UP, (size, 1)), v, a):
        unit = n / np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-300)
        speed, acceleration = point_bounds(robot, links, reach, distance, unit, sweep)
        assert np.isfinite(speed[known]).all()
        assert (np.abs((unit * v).sum(1))[known] <= (speed * (1 + 1e-11) + off[0])[known]).all()
        assert (np.abs((unit * a).sum(1))[known] <= (acceleration * (1 + 1e-11) + off[1])[known]).all()


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("bad", [np.inf, np.nan])
def test_what_is_not_known_is_bounded_by_infinity_without_a_warning(name: str, bad: float) -> None:
    robot = robot_named(name)
    q = random_q(robot, np.random.default_rng(1), 1)
    for link in range(1, len(robot.links)):
        fine = of_rates(robot, q, q, np.ones_like(q), np.ones_like(q))
        unknown = Sweep(bad * q, bad * q, np.full(fine.rate.shape, bad), np.full(fine.rate.shape, bad))
        size, n = np.full(1, 0.1), np.array([[0.6, 0.0, 0.8]])
        quill = robot.links[link] == "quill"  # a solid of revolution: its size does not count
        with np.errstate(all="raise"):
            cases = [(Sweep(q, q, unknown.rate, unknown.rate_d), size, size), (unknown, size, size)]
            cases += [] if quill else [(fine, bad * size, bad * size), (fine, -size, -size)]
            for sweep, reach, distance in cases:
                bounds = point_bounds(robot, np.array([link]), reach, distance, n, sweep)
                assert all((bound == np.inf).all() for bound in bounds), (link, sweep, reach)
    with np.errstate(all="raise"):
        wide = np.full(q.shape, np.inf)
        assert robot.assembled(-wide, wide).all() == (robot.parallel_least == 0.0)
        assert not robot.assembled(bad * q, bad * q).any() or robot.parallel_least == 0.0


# Arms whose links stay upright


@pytest.mark.parametrize(("arms_rise", "rising"), [(False, [0, 0, 0, 1, 1]), (True, [0, 1, 1, 1, 1])])
@pytest.mark.parametrize("axes", [3, 4])
def test_along_the_vertical_only_what_the_lift_carries_has_a_speed(
    axes: int, arms_rise: bool, rising: list[int]
) -> None:
    robot, up = scara(axes, arms_rise=arms_rise), np.tile(-UP, (5, 1))
    sweep = Sweep(np.zeros((5, axes)), np.zeros((5, axes)), np.full((5, 4), 3.0), np.full((5, 4), 7.0))
    speed, acceleration = point_bounds(robot, np.arange(5), np.full(5, 0.3), np.full(5, np.nan), up, sweep)
    assert speed.tolist() == [3 * x for x in rising]
    assert acceleration.tolist() == [7 * x for x in rising]


@given(st.integers(0, 4), st.floats(0, 3.2), st.floats(0, 1.0), st.lists(st.floats(0, 50), min_size=8, max_size=8))
def test_the_bounds_are_the_formulas_of_the_page(link: int, tilt: float, reach: float, rates: list[float]) -> None:
    """Of a SCARA, which does not look at distances; a quill's own radius does not count."""
    robot = scara()
    rate, rate_d = np.array(rates[:4]), np.array(rates[4:])
    n = np.array([[np.sin(tilt) * 0.6, np.sin(tilt) * 0.8, np.cos(tilt)]])
    sweep = Sweep(np.zeros((1, 4)), np.zeros((1, 4)), rate[None], rate_d[None])
    speed, acceleration = point_bounds(robot, np.array([link]), np.array([reach]), np.array([np.nan]), n, sweep)
    arms = {
        BASE: [],
        LINK1: [(reach, 0)],
        LINK2: [(0.325, 0), (reach, 1)],
        QUILL: [(0.325, 0), (0.225, 1)],
        FLANGE: [(0.325, 0), (0.225, 1), (reach, 3)],
    }[link]
    lifted = link in (QUILL, FLANGE)
    flat, upright = abs(np.sin(tilt)), abs(np.cos(tilt))
    assert speed[0] == pytest.approx(
        flat * sum(length * rate[k] for length, k in arms) + lifted * upright * rate[2], rel=1e-12, abs=1e-300
    )
    assert acceleration[0] == pytest.approx(
        flat * sum(length * np.hypot(rate_d[k], rate[k] ** 2) for length, k in arms) + lifted * upright * rate_d[2],
        rel=1e-12,
        abs=1e-300,
    )


@pytest.mark.parametrize("link", range(1, len(LINKS)))
def test_the_bounds_are_reached_by_a_stretched_arm_that_turns_as_one(link: int) -> None:
    """All arms in line: nothing of the bound is given away but by the directions of arms."""
    robot, q, qd, qdd = scara(), np.zeros((1, 4)), np.zeros((1, 4)), np.zeros((1, 4))
    qd[:, 0], qdd[:, 0] = 2.0, -5.0
    radius = {LINK1: 0.1, LINK2: 0.425, QUILL: 0.55, FLANGE: 0.65}[link]
    c, s = np.cos(robot.base.yaw), np.sin(robot.base.yaw)
    tangent, radial = np.array([[-s, c, 0.0]]), np.array([[c, s, 0.0]])
    both = radius * np.hypot(5.0, 2.0**2)
    along = radius * (-5.0 * tangent - 2.0**2 * radial) / both
    sweep = of_rates(robot, q, q, qd, qdd)
    speed, _ = point_bounds(robot, np.array([link]), np.full(1, 0.1), np.full(1, np.nan), tangent, sweep)
    _, acceleration = point_bounds(robot, np.array([link]), np.full(1, 0.1), np.full(1, np.nan), along, sweep)
    assert speed[0] == pytest.approx(2.0 * radius, rel=1e-12)
    assert acceleration[0] == pytest.approx(both, rel=1e-12)


# Arms whose links tilt


@pytest.mark.parametrize("robot", [elbow(), polar(), five_axis()])
def test_the_bound_of_speed_is_reached_by_a_stretched_arm_that_only_tilts(robot: Robot) -> None:
    """In the vertical plane nothing is given away."""
    q, rate = np.zeros((1, len(robot.joints))), np.zeros((1, len(robot.joints)))
    q[0, :2], rate[0, 1] = (0.3, 0.4), 2.0
    if robot.name == "polar":
        q[0, 2] = robot.limits.upper[2]
    position, rotation = robot.placements(q)
    for link in sorted(robot.tilting):
        tip = position[0, link] + 0.1 * rotation[0, link, :, 0] - position[0, min(robot.tilting)]
        sweep, size = of_rates(robot, q, q, rate, 0 * rate), np.full(1, 0.1)
        speed, acceleration = point_bounds(robot, np.array([link]), size, size, UP, sweep)
        assert speed[0] == pytest.approx(2.0 * np.linalg.norm(tip), rel=1e-5)
        assert acceleration[0] == pytest.approx(4.0 * np.linalg.norm(tip), rel=1e-5)


@pytest.mark.parametrize("robot", [elbow(), polar(), five_axis()])
def test_the_base_stands_and_the_turret_does_not_tilt(robot: Robot) -> None:
    q, n = np.ones((4, len(robot.joints))), np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]] * 2)
    sweep = Sweep(q, q, np.ones((4, len(robot.rate_matrix))), np.ones((4, len(robot.rate_matrix))))
    speed, _ = point_bounds(robot, np.array([0, 0, 1, 1]), np.full(4, 0.2), np.full(4, 9.0), n, sweep)
    assert speed.tolist() == [0.0, 0.0, 0.2, 0.0]


def test_a_flange_that_only_rolls_moves_the_points_off_its_axis_and_nothing_else() -> None:
    robot, tenth = five_axis(), np.full(1, 0.1)
    q, rate = np.zeros((1, 5)), np.array([[0.0, 0.0, 0.0, 0.0, 2.0]])
    for link, name in enumerate(robot.links):
        bounds = point_bounds(robot, np.array([link]), tenth, tenth, UP, of_rates(robot, q, q, rate, 0 * rate))
        assert np.ravel(bounds) == pytest.approx([0.2, 0.4] if name == "flange" else [0.0, 0.0], abs=1e-15)


# A chain that is closed


@given(
    seed=st.integers(0, 2**32 - 1),
    lengths=st.sampled_from(sorted(LENGTHS)),
    width=st.floats(0.0, 1.5),
    assembly=st.sampled_from(["front", "back"]),
)
def test_a_range_that_is_proved_to_assemble_does_everywhere(
    seed: int, lengths: str, width: float, assembly: str
) -> None:
    robot, rng = five_bar(lengths, assembly=assembly), np.random.default_rng(seed)
    lower = rng.uniform(-3.2, 3.2, (200, 4))
    upper = lower + width * rng.random((200, 4))
    proved = robot.assembled(lower, upper)
    for share in (rng.random((30, 200, 4)), rng.integers(0, 2, (16, 200, 4))):
        margin = robot.parallel_margin(lower + share * (upper - lower))
        assert (margin[:, proved] >= robot.parallel_least - 1e-12).all()


def test_small_ranges_in_the_clear_are_proved_and_points_nearly_always() -> None:
    """The proof is of use: points, and 20 ms of full speed, 0.15 rad, where the margin is ample."""
    robot = five_bar()
    q = states(np.random.default_rng(1), robot, 1, 2_000)
    assert robot.assembled(q, q).all()
    ample = q[robot.parallel_margin(q) > 0.7]
    assert robot.assembled(ample - 0.075, ample + 0.075).mean() > 0.99


def test_what_is_not_proved_is_bounded_by_infinity_except_where_couplers_do_not_matter() -> None:
    robot, tenth = five_bar("short"), np.full(1, 0.1)
    q = np.array([[np.pi / 2, -np.pi / 2, 0.2, 0.0]])  # the elbows are too far apart
    sweep, along = Sweep(q, q, np.ones((1, 4)), np.ones((1, 4))), np.array([[0.6, 0.0, 0.8]])
    for link in range(len(robot.links)):
        with np.errstate(all="raise"):
            speed, acceleration = point_bounds(robot, np.array([link]), tenth, tenth, along, sweep)
            up, _ = point_bounds(robot, np.array([link]), tenth, tenth, UP, sweep)
        assert (speed[0] == np.inf) == (acceleration[0] == np.inf) == (link not in (0, 1, 3))
        assert up[0] == (1.0 if link >= 5 else 0.0)


def test_a_crank_that_turns_alone_is_bounded_sharply() -> None:
    robot, q, fifth = five_bar(), np.array([[0.5, -0.5, 0.2, 0.0]]), np.full(1, 0.2)
    rate, ahead = np.array([[2.0, 0.0, 0.0, 0.0]]), np.array([[1.0, 0.0, 0.0]])
    found = point_bounds(robot, np.array([1]), fifth, fifth, ahead, Sweep(q, q, rate, 5 * rate))
    assert np.ravel(found) == pytest.approx([0.4, 0.2 * np.hypot(10, 4)], rel=1e-14)
