"""What the protocol promises of kinematics, asked of every robot of the catalogue and of every family: a new entry is
asked by being there.

Joints turn freely here and slide within their range; states that a robot's own `within` refuses (a closed chain that
does not assemble) are left out. Only the protocol is used, and `assur.experiments.differential`, which is made of
it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from assur.experiments.differential import determinant, inverse_jacobian, jacobian, transforms
from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.errors import FaultError
from assur.planner.frames.motion import Motion
from assur.planner.robots.facts import Code
from assur.planner.robots.robot import Robot
from tests.planner.robots.families import NAMES, STENCIL, far, flange_of, random_motion, random_q, robot_named, tilted

STATES = 10_000
"""Random states for each robot and mode."""
STEP = 1e-3
"""Of differences, rad or m: their error is of order 8 in it, so rounding (1e-16/1e-3) is what is left."""
READ: dict[str, Callable[[Motion], tuple[FloatArray, ...]]] = {
    "x": lambda m: (m.p[..., 0], m.v[..., 0]),
    "y": lambda m: (m.p[..., 1], m.v[..., 1]),
    "z": lambda m: (m.p[..., 2], m.v[..., 2]),
    "yaw": lambda m: (m.yaw, m.yaw_d),
    "pitch": lambda m: (tilted(m).tilt[..., 0], tilted(m).tilt_d[..., 0]),
    "roll": lambda m: (tilted(m).tilt[..., 1], tilted(m).tilt_d[..., 1]),
}
"""A task coordinate and its rate out of a motion of the flange. A robot with another coordinate needs a line here, and
in `place_of`."""
ANGLES = frozenset({"yaw", "pitch", "roll"})
ORDERS = (("p", "v", "a", "j"), ("yaw", "yaw_d", "yaw_dd", "yaw_ddd"), ("tilt", "tilt_d", "tilt_dd", "tilt_ddd"))
"""Fields of a motion, each row from a value to its third derivative."""
JOINTS = ("q", "qd", "qdd", "qddd")


def place_of(robot: Robot, q: FloatArray) -> FloatArray:
    """Task coordinates (..., m) by `forward`; pitch and roll by the flange's rotation and its heading."""
    p, yaw = robot.forward(q)
    found = {"x": p[..., 0], "y": p[..., 1], "z": p[..., 2], "yaw": yaw}
    if "pitch" in robot.coordinates:
        x, y, z = np.moveaxis(robot.placements(q)[1][..., flange_of(robot), :, :], -1, 0)
        ahead, level = np.stack([np.cos(yaw), np.sin(yaw)], -1), np.stack([-np.sin(yaw), np.cos(yaw)], -1)
        found["pitch"] = np.arctan2(x[..., 2], (x[..., :2] * ahead).sum(-1))
        found["roll"] = np.arctan2(-(z[..., :2] * level).sum(-1), (y[..., :2] * level).sum(-1))
    return np.stack([found[name] for name in robot.coordinates], -1)


MODES = [(name, mode) for name in NAMES for mode in range(len(robot_named(name).modes))]
SQUARE = {name for name in NAMES if len(robot_named(name).coordinates) == len(robot_named(name).joints)}
"""Robots whose flange's motion leaves their joints no choice, and whose determinant has a sign."""
every_robot = pytest.mark.parametrize("name", NAMES)
every_square_robot = pytest.mark.parametrize("name", [name for name in NAMES if name in SQUARE])
every_mode = pytest.mark.parametrize(("name", "mode"), MODES)
every_mode_of_square_robots = pytest.mark.parametrize(("name", "mode"), [row for row in MODES if row[0] in SQUARE])


def rates(robot: Robot, motion: Motion) -> FloatArray:
    """Rates (..., len(coordinates)) of the task coordinates."""
    return np.stack([READ[name](motion)[1] for name in robot.coordinates], -1)


def angle(a: FloatArray) -> FloatArray:
    """An angle's distance from whole turns."""
    return np.asarray(np.abs(np.angle(np.exp(1j * a))))


def apart(robot: Robot, a: FloatArray, b: FloatArray) -> FloatArray:
    """|a − b| of joint vectors, revolute joints up to whole turns."""
    revolute = np.array([joint.kind == "revolute" for joint in robot.joints])
    return np.where(revolute, angle(a - b), np.abs(a - b))


def off(robot: Robot, q: FloatArray, wanted: Motion) -> FloatArray:
    """How far (...) `forward` is from the flange that was asked in any coordinate the robot has, m or rad."""
    difference = place_of(robot, q) - np.stack([READ[name](wanted)[0] for name in robot.coordinates], -1)
    return np.asarray(np.where(turning(robot), angle(difference), np.abs(difference)).max(-1))


def turning(robot: Robot) -> BoolArray:
    """Which of the task coordinates are angles."""
    return np.array([name in ANGLES for name in robot.coordinates])


def jacobian_error(robot: Robot, q: FloatArray) -> float:
    """The largest difference of `jacobian` from differences of `forward`, as a share of the row's largest entry."""
    wanted = np.zeros((len(q), len(robot.coordinates), len(robot.joints)))
    turns = turning(robot)
    centre = np.where(turns, place_of(robot, q), 0.0)
    for joint in range(len(robot.joints)):
        step = STEP * np.eye(len(robot.joints))[joint]
        for k, weight in zip(range(-4, 5), STENCIL, strict=True):
            read = place_of(robot, q + k * step) - centre
            read = np.where(turns, np.angle(np.exp(1j * read)), read)  # an angle may be counted from anywhere
            wanted[:, :, joint] += weight * read / STEP
    size = np.maximum(1.0, np.abs(wanted).max((1, 2), keepdims=True))
    return float((np.abs(jacobian(robot, q) - wanted) / size).max())


def flange_motion(robot: Robot, seed: int, size: int, mode: int) -> Motion:
    return robot.link_motion(flange_of(robot), *random_motion(robot, seed, size, mode))


def changed(motion: Motion, change: Callable[[str, FloatArray], FloatArray]) -> Motion:
    """The motion with fields that `change` makes of their names and values."""
    upright, tilts = (
        [change(name, np.array(getattr(motion, name))) for orders in rows for name in orders]
        for rows in (ORDERS[:2], ORDERS[2:] if motion.tilted else ())
    )
    made = Motion.of(*upright)
    return made.with_tilt(*tilts) if tilts else made


@every_mode
def test_forward_of_the_inverse_is_where_the_flange_was_asked_to_be(name: str, mode: int) -> None:
    robot = robot_named(name)
    flange = flange_motion(robot, mode, STATES, mode)
    with np.errstate(all="raise"):
        found = robot.inverse(flange, mode)
    assert (found.code == Code.ASSEMBLED).all()
    assert off(robot, found.q, flange).max() <= 1e-13 * far(robot)
    assert np.abs(found.margin - robot.margin(found.q)).max() <= 1e-12
    assert (found.parallel is None) == (robot.parallel_least == 0.0)
    if found.parallel is not None:
        assert np.abs(found.parallel - robot.parallel_margin(found.q)).max() <= 1e-12
    assert (robot.mode_of(found.q) == mode).all()
    revolute = [joint.kind == "revolute" for joint in robot.joints]
    assert (np.abs(found.q[:, revolute]) <= np.pi).all()


@every_mode_of_square_robots
def test_the_inverse_of_the_flange_s_motion_is_the_motion_of_the_joints(name: str, mode: int) -> None:
    robot = robot_named(name)
    made = random_motion(robot, mode, STATES, mode)
    found = robot.inverse(robot.link_motion(flange_of(robot), *made), mode)
    assert apart(robot, found.q, made[0]).max() <= 1e-12 * far(robot)
    assert np.abs(found.margin - robot.margin(made[0])).max() <= 1e-12 * far(robot)
    scale = np.linalg.norm(np.stack(made[1:]), axis=(0, 2))[:, None]
    rates = (found.qd, found.qdd, found.qddd)
    # errors grow as rounding over the margin's powers
    for got, wanted, most in zip(rates, made[1:], (1e-12, 1e-10, 1e-8), strict=True):
        assert (np.abs(got - wanted) / scale).max() <= most * far(robot)
    still = robot.link_motion(flange_of(robot), made[0], *(np.zeros_like(made[0]),) * 3)
    assert not any(rate.any() for rate in (robot.inverse(still, mode).qd, robot.inverse(still, mode).qddd))


@every_mode
def test_the_velocities_of_the_dyads_are_those_of_the_inverse_jacobian(name: str, mode: int) -> None:
    robot = robot_named(name)
    flange = flange_motion(robot, mode, STATES, mode)
    found = robot.inverse(flange, mode, 1)
    task = rates(robot, flange)
    direct = jacobian(robot, found.q)
    back = (direct @ found.qd[..., None])[..., 0]
    scale = np.linalg.norm(found.qd, axis=-1, keepdims=True) * np.linalg.norm(direct, axis=(1, 2))[:, None]
    assert (np.abs(back - task) / scale).max() <= 1e-12 * far(robot)
    if name in SQUARE:
        by_jacobian = (inverse_jacobian(robot, found.q) @ task[..., None])[..., 0]
        scale = np.linalg.norm(found.qd, axis=-1, keepdims=True)
        assert (np.abs(by_jacobian - found.qd) / scale).max() <= 1e-10 * far(robot)


@every_robot
def test_the_jacobian_is_the_difference_of_the_forward_problem(name: str) -> None:
    robot = robot_named(name)
    with np.errstate(all="raise"):
        assert jacobian_error(robot, random_q(robot, np.random.default_rng(1), STATES)) <= 1e-10 * far(robot)


@every_robot
def test_a_jacobian_of_which_one_entry_is_off_by_a_millionth_is_noticed(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = robot_named(name)
    q = random_q(robot, np.random.default_rng(1), 100)
    true = jacobian

    def off_by_a_little(robot: Robot, q: FloatArray) -> FloatArray:
        found = true(robot, q)
        found[..., 0, 0] *= 1 + 1e-6
        return found

    monkeypatch.setitem(globals(), "jacobian", off_by_a_little)
    assert jacobian_error(robot, q) > 1e-9 * far(robot)


@every_robot
def test_every_link_frame_moves_as_its_differences_say(name: str) -> None:
    """Positions and attitudes by `placements`, which knows no derivatives, against `link_motion`."""
    robot = robot_named(name)
    q, qd, qdd, qddd = random_motion(robot, 5, 1000)
    around, frames = [], []
    for k in range(-4, 5):
        t = k * STEP / 10
        moved = q + qd * t + qdd * t**2 / 2 + qddd * t**3 / 6
        state = moved, qd + qdd * t + qddd * t**2 / 2, qdd + qddd * t, qddd
        with np.errstate(all="raise"):
            frames.append(transforms(robot, moved))
            around.append([robot.link_motion(link, *state) for link in range(len(robot.links))])
    for link in range(len(robot.links)):
        motions = [row[link] for row in around]
        for ladder in ORDERS:
            for below, above in pairwise(ladder if motions[4].tilted or ladder[0] != "tilt" else ()):
                rows = np.stack([getattr(m, below) for m in motions])
                if below in ("yaw", "tilt"):
                    rows = np.unwrap(rows, axis=0)
                slope, told = np.tensordot(STENCIL, rows, 1) / (STEP / 10), getattr(motions[4], above)
                error = np.abs(slope - told) / np.maximum(1.0, np.abs(rows[4]) + np.abs(told))
                assert error.max() <= 1e-8, (link, above)
        assert np.abs(frames[4][:, link, :3, 3] - motions[4].p).max() <= 1e-13 * far(robot)
        if link not in robot.tilting:
            c, s = np.cos(motions[4].yaw), np.sin(motions[4].yaw)
            upright = np.zeros((len(q), 3, 3))
            upright[:, 0, 0] = upright[:, 1, 1] = c
            upright[:, 1, 0], upright[:, 0, 1], upright[:, 2, 2] = s, -s, 1.0
            assert np.abs(frames[4][:, link, :3, :3] - upright).max() <= 1e-13


@every_robot
def test_the_transforms_along_the_chain_are_rigid_and_end_where_forward_says(name: str) -> None:
    robot = robot_named(name)
    q = random_q(robot, np.random.default_rng(2), STATES)
    found = transforms(robot, q)
    assert found.shape == (STATES, len(robot.links), 4, 4)
    assert (found[..., 3, :] == [0.0, 0.0, 0.0, 1.0]).all()
    rotation = found[..., :3, :3]
    assert np.abs(np.swapaxes(rotation, -1, -2) @ rotation - np.eye(3)).max() <= 1e-14
    assert np.abs(np.linalg.det(rotation) - 1.0).max() <= 1e-14
    p, yaw = robot.forward(q)
    end = found[:, flange_of(robot)]
    assert np.abs(end[:, :3, 3] - p).max() <= 1e-14 * far(robot)
    if "yaw" in robot.coordinates:
        assert angle(np.arctan2(end[:, 1, 0], end[:, 0, 0]) - yaw).max() <= 1e-13


@every_robot
@pytest.mark.parametrize("order", range(4))
def test_what_is_not_asked_is_not_read_and_other_shapes_give_the_same_numbers(name: str, order: int) -> None:
    """Neither derivatives beyond the order, which are not found, nor a yaw that the robot does not follow."""
    robot = robot_named(name)
    flange = flange_motion(robot, 8, 12, 0)
    full = robot.inverse(flange, 0)
    unread = {field for orders in ORDERS for field in orders[order + 1 :]}
    unread |= set() if "yaw" in robot.coordinates else set(ORDERS[1])
    blind = changed(flange, lambda field, value: value * np.nan if field in unread else value)
    for shape in ((12,), (3, 4), (12, 1)):
        asked = changed(blind, lambda _, value: value.reshape(*shape, *value.shape[1:]))  # noqa: B023
        part = robot.inverse(asked, 0, order)
        assert part.code.shape == part.margin.shape == shape
        for k, field in enumerate(JOINTS):
            value = getattr(part, field)
            assert value.shape == (*shape, len(robot.joints))
            value = value.reshape(12, -1)
            assert np.array_equal(value, getattr(full, field)) if k <= order else np.isnan(value).all()
    one = robot.inverse(changed(blind, lambda _, value: value[7]), 0, order)
    assert np.array_equal(one.q, full.q[7])


@every_robot
@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_a_target_that_is_not_finite_is_refused_and_its_neighbours_are_not(name: str, bad: float) -> None:
    robot = robot_named(name)
    flange = flange_motion(robot, 1, 3, 0)
    good = robot.inverse(flange, 0)
    read = [*ORDERS[0], *(ORDERS[1] if "yaw" in robot.coordinates else ())]
    read += ORDERS[2] if "pitch" in robot.coordinates else ()
    for field in read:
        for axis in np.ndindex(getattr(flange, field).shape[1:]):

            def spoilt(found: str, value: FloatArray) -> FloatArray:
                if found == field:  # noqa: B023
                    value[(1, *axis)] = bad  # noqa: B023
                return value

            with np.errstate(all="raise"):
                got = robot.inverse(changed(flange, spoilt), 0)
                alone = robot.inverse(changed(changed(flange, spoilt), lambda _, value: value[1]), 0)
            assert got.code.tolist() == [Code.ASSEMBLED, Code.OUT_OF_REACH, Code.ASSEMBLED], (field, axis)
            assert alone.code == Code.OUT_OF_REACH
            assert all(np.isnan(getattr(got, each)[1]).all() for each in (*JOINTS, "margin"))
            assert got.parallel is None or np.isnan(got.parallel[1])
            assert np.array_equal(got.q[::2], good.q[::2])
            assert np.array_equal(got.qddd[::2], good.qddd[::2])


@every_robot
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_joint_vectors_that_are_not_finite_give_nan_without_a_warning(name: str, bad: float) -> None:
    robot = robot_named(name)
    q = random_q(robot, np.random.default_rng(1), 2)
    q[0, 1] = bad
    flange, some = flange_of(robot), np.ones_like(q)
    with np.errstate(all="raise"):
        p, yaw = robot.forward(q)
        places, rotation = robot.placements(q)
        direct, moved = jacobian(robot, q), robot.link_motion(flange, q, some, some, some)
        told = robot.margin(q), robot.singular_distance(q)
    for x in (p, places[:, flange], rotation[:, flange], direct, moved.p, moved.j, *told):
        assert np.isnan(x[0]).any()
        assert np.isfinite(x[1]).all()
    assert not np.isfinite(yaw[0]) or "yaw" not in robot.coordinates
    assert robot.mode_of(q)[0] == -1
    assert robot.within(q).tolist() == [False, True]


@every_robot
def test_what_is_wrong_in_a_call_is_a_fault(name: str) -> None:
    robot = robot_named(name)
    q = np.zeros((1, len(robot.joints)))
    flange = flange_motion(robot, 1, 1, 0)
    wrong: list[tuple[str, Callable[[], Any]]] = [
        (f"mode {len(robot.modes)}", lambda: robot.inverse(flange, len(robot.modes))),
        ("mode -1", lambda: robot.inverse(flange, -1)),
        ("order 4", lambda: robot.inverse(flange, 0, 4)),
        (f"link {len(robot.links)}", lambda: robot.link_motion(len(robot.links), q, q, q, q)),
        ("link -1", lambda: robot.link_motion(-1, q, q, q, q)),
    ]
    if flange.tilted:
        upright = Motion(flange.table[..., :4])
        wrong.append(("pitch and roll", lambda: robot.inverse(upright, 0)))
    for told, call in wrong:
        with pytest.raises(FaultError, match=told):
            call()


@dataclass(frozen=True)
class Singular:
    """States (N, n) at which the determinant vanishes; joint rates (N, n) that do not move the flange, and the
    direction (N, 3) in which no joint rates move it, both of length 1."""

    q: FloatArray
    still: FloatArray
    lost: FloatArray


def singular_states(robot: Robot, pairs: int = 4000) -> Singular:
    """By bisection between random states where the determinant has two signs; where it has a pole none is found."""
    rng = np.random.default_rng(3)
    low, high = (rng.uniform(robot.limits.lower, robot.limits.upper, (pairs, len(robot.joints))) for _ in range(2))
    with np.errstate(invalid="ignore"):
        sign = np.sign(determinant(robot, low))
        good = sign * np.sign(determinant(robot, high)) < 0
        low, high, sign = low[good], high[good], sign[good]
        for _ in range(60):
            middle = (low + high) / 2
            here = (np.sign(determinant(robot, middle)) == sign)[:, None]
            low, high = np.where(here, middle, low), np.where(here, high, middle)
    kept = robot.within(low) & np.isfinite(jacobian(robot, low)).all((1, 2))
    q = low[kept]
    left, values, right = np.linalg.svd(jacobian(robot, q))
    # Where two singularities meet neither has the name to itself.
    alone = (values[:, -1] < 1e-12 * values[:, 0]) & (values[:, -2] > 1e-2 * values[:, 0])
    lost = np.zeros((len(q), 3))
    for row, name in enumerate(robot.coordinates):
        if name in "xyz":
            lost[:, "xyz".index(name)] = left[:, row, -1]
    lost = lost[alone] / np.linalg.norm(lost[alone], axis=1, keepdims=True)
    return Singular(q[alone], right[alone, -1], lost)


def named_by_geometry(robot: Robot, q: FloatArray, still: FloatArray, lost: FloatArray) -> tuple[Code, Code]:
    """Which singularity q (n,) is, and what its place is as a target, by where the flange goes along `still`, and by
    none of the robot's own formulas.

    ALIGNED: it stays where it is, however far. Else it is at an edge: the direction that is lost points from or to a
    joint's axis that stands still, and the flange only comes nearer to this axis (the outer edge, STRETCHED) or only
    goes away from it (the inner one, FOLDED). A hand keeps its pitch meanwhile, so it is the wrist, at its other end,
    that comes nearer or goes away. With equal links the inner edge is the axis itself, a hole of no radius:
    there the flange stays, too, and its place is INDETERMINATE.
    """
    elsewhere = q + 0.05 * np.linspace(1.0, 2.0, len(q))
    frames = robot.placements(np.stack([q - 0.05 * still, q, q + 0.05 * still, elsewhere]))[0]
    if robot.lift is not None:
        frames[..., 2] = 0.0  # the height does not count
    tip = frames[:3, flange_of(robot)]
    stays = np.abs(tip - tip[1]).max() < 1e-9
    if "pitch" in robot.coordinates:
        tip = frames[:3, flange_of(robot) - 1]
    names = set()
    for origin in frames[1, np.abs(frames - frames[1]).max((0, 2)) < 1e-12]:  # of links that no joint moves
        away = np.linalg.norm(tip - origin, axis=1)
        if stays and away[1] < 1e-9:
            names.add((Code.FOLDED, Code.INDETERMINATE))
        elif not stays and abs(abs(lost @ (tip[1] - origin)) / away[1] - 1.0) < 1e-9:
            assert (away[0] - away[1]) * (away[2] - away[1]) > 0.0, "no edge: it may go both ways"
            names.add((Code.STRETCHED,) * 2 if away[0] < away[1] else (Code.FOLDED,) * 2)
    if stays and not names:
        names.add((Code.ALIGNED,) * 2)
    assert len(names) == 1, f"{robot.name} at {q} is at the edges {names}"
    return names.pop()


@every_square_robot
def test_where_the_determinant_vanishes_the_margin_does_and_the_singularity_has_its_name(name: str) -> None:
    robot = robot_named(name)
    singular = singular_states(robot)
    assert len(singular.q) > 100
    assert robot.margin(singular.q).max() <= 1e-12
    assert robot.singular_distance(singular.q).max() <= 1e-12
    rows = zip(singular.q, singular.still, singular.lost, strict=True)
    named = np.array([named_by_geometry(robot, *row) for row in rows])
    assert robot.singularity(singular.q).tolist() == named[:, 0].tolist()
    # The inverse Jacobian asks for rates without measure there, or says that there are none.
    inverse = np.linalg.norm(inverse_jacobian(robot, singular.q), axis=(1, 2))
    regular = np.linalg.norm(inverse_jacobian(robot, random_q(robot, np.random.default_rng(3), 100)), axis=(1, 2))
    assert (np.isnan(inverse) | (inverse > 1e9 * regular.max())).all()
    # Asked for as a place it has the same name, a position at an edge, and no rates.
    for mode in range(len(robot.modes)):
        there = robot.mode_of(singular.q) == mode
        none = np.zeros_like(singular.q[there])
        place = robot.link_motion(flange_of(robot), singular.q[there], none, none, none)
        back = robot.inverse(place, mode)
        assert back.code.tolist() == named[there, 1].tolist()
        assert np.isnan(np.stack([back.qd, back.qdd, back.qddd])).all()
        edge = (back.code == Code.STRETCHED) | (back.code == Code.FOLDED)
        assert (off(robot, back.q, place)[edge] <= 1e-9).all()
        assert np.isnan(back.q[~edge, 0]).all()


@every_robot
def test_where_the_margin_does_not_vanish_the_determinant_does_not(name: str) -> None:
    robot = robot_named(name)
    q = random_q(robot, np.random.default_rng(4), STATES)
    assert (np.abs(determinant(robot, q)) > 0.0).all()
    inverse, direct = inverse_jacobian(robot, q), jacobian(robot, q)
    size = np.linalg.norm(inverse, axis=(1, 2)) * np.linalg.norm(direct, axis=(1, 2))
    error = np.abs(direct @ inverse - np.eye(len(robot.coordinates))).max((1, 2))
    assert (error / size).max() <= 1e-13
