"""What the protocol promises of kinematics, asked of every robot of the catalogue: a new entry is asked by being there.

Joints turn freely here and slide within their range; states that a robot's own `within` refuses (a closed chain that
does not assemble) are left out. Only the protocol is used, and `assur.experiments.differential`, which is made of
it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import numpy as np
import pytest

from assur.experiments.differential import determinant, inverse_jacobian, transforms
from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.frames.motion import Motion, Pose
from assur.planner.frames.tilted import TiltedMotion
from assur.planner.robots.protocol import Code, Limits, Robot
from assur.scenes.catalogue import arm_named, models

BASE = Pose(0.4, -0.7, 0.2, 2.5)
STATES = 10_000
"""Random states for each robot and mode."""
FREE_RAD = 4.0
"""Range of a revolute joint to either side: beyond π, so that a folded elbow is inside it."""
MARGIN = 0.05
"""Least singularity margin of a random state: what requests ask by default."""
STEP = 1e-3
"""Of differences, rad or m: their error is of order 8 in it, so rounding (1e-16/1e-3) is what is left."""
STENCIL = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
"""Weights of the central first difference of order 8, over steps −4 … 4."""
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


def tilted(motion: Motion) -> TiltedMotion:
    assert isinstance(motion, TiltedMotion)
    return motion


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


@cache
def robot_named(model: str) -> Robot:
    """The robot of a catalogue's entry at BASE, its revolute joints free to turn."""
    arm = arm_named(model)
    shipped = arm.robot(BASE, arm.limits)
    revolute = np.array([joint.kind == "revolute" for joint in shipped.joints])
    limits = shipped.limits
    lower, upper = np.where(revolute, -FREE_RAD, limits.lower), np.where(revolute, FREE_RAD, limits.upper)
    return arm.robot(BASE, Limits(lower, upper, limits.velocity, limits.acceleration, limits.jerk))


MODES = [(model, mode) for model in models() for mode in range(len(robot_named(model).modes))]
SQUARE = {model for model in models() if len(robot_named(model).coordinates) == len(robot_named(model).joints)}
"""Robots whose flange's motion leaves their joints no choice, and whose determinant has a sign."""
every_robot = pytest.mark.parametrize("model", models())
every_square_robot = pytest.mark.parametrize("model", [model for model in models() if model in SQUARE])
every_mode = pytest.mark.parametrize(("model", "mode"), MODES)
every_mode_of_square_robots = pytest.mark.parametrize(("model", "mode"), [row for row in MODES if row[0] in SQUARE])


def random_q(robot: Robot, rng: np.random.Generator, size: int, mode: int | None = None) -> FloatArray:
    """States (size, n) with the margin, in one working mode if one is asked."""
    found = np.empty((0, len(robot.joints)))
    for _ in range(400):
        q = rng.uniform(robot.limits.lower, robot.limits.upper, (2 * size, len(robot.joints)))
        good = robot.within(q) & (robot.margin(q) >= MARGIN)
        found = np.concatenate([found, q[good if mode is None else good & (robot.mode_of(q) == mode)]])
        if len(found) >= size:
            return found[:size]
    raise AssertionError(f"{robot.name} is hardly ever in mode {mode}")


def random_motion(robot: Robot, seed: int, size: int, mode: int | None = None) -> tuple[FloatArray, ...]:
    """q, q̇, q̈, q⃛, each (size, n)."""
    rng = np.random.default_rng(seed)
    q = random_q(robot, rng, size, mode)
    return q, *(scale * rng.normal(size=q.shape) for scale in (1.0, 10.0, 100.0))


def flange_of(robot: Robot) -> int:
    return robot.links.index("flange")


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
    return float((np.abs(robot.jacobian(q) - wanted) / size).max())


@every_mode
def test_forward_of_the_inverse_is_where_the_flange_was_asked_to_be(model: str, mode: int) -> None:
    robot = robot_named(model)
    made = random_motion(robot, mode, STATES, mode)
    flange = robot.link_motion(flange_of(robot), *made)
    found = robot.inverse(flange, mode)
    assert (found.code == Code.ASSEMBLED).all()
    assert off(robot, found.q, flange).max() <= 1e-13
    assert np.abs(found.margin - robot.margin(found.q)).max() <= 1e-12
    assert (robot.mode_of(found.q) == mode).all()


@every_mode_of_square_robots
def test_the_inverse_of_the_flange_s_motion_is_the_motion_of_the_joints(model: str, mode: int) -> None:
    robot = robot_named(model)
    made = random_motion(robot, mode, STATES, mode)
    found = robot.inverse(robot.link_motion(flange_of(robot), *made), mode)
    assert apart(robot, found.q, made[0]).max() <= 1e-9
    scale = np.linalg.norm(np.stack(made[1:]), axis=(0, 2))[:, None]
    for got, wanted in zip((found.qd, found.qdd, found.qddd), made[1:], strict=True):
        assert (np.abs(got - wanted) / scale).max() <= 1e-7  # errors grow as rounding over the margin's powers


@every_mode
def test_the_velocities_of_the_dyads_are_those_of_the_inverse_jacobian(model: str, mode: int) -> None:
    robot = robot_named(model)
    flange = robot.link_motion(flange_of(robot), *random_motion(robot, mode, STATES, mode))
    found = robot.inverse(flange, mode, 1)
    task = rates(robot, flange)
    jacobian = robot.jacobian(found.q)
    back = (jacobian @ found.qd[..., None])[..., 0]
    scale = np.linalg.norm(found.qd, axis=-1, keepdims=True) * np.linalg.norm(jacobian, axis=(1, 2))[:, None]
    assert (np.abs(back - task) / scale).max() <= 1e-12
    if model in SQUARE:
        by_jacobian = (inverse_jacobian(robot, found.q) @ task[..., None])[..., 0]
        scale = np.linalg.norm(found.qd, axis=-1, keepdims=True)
        assert (np.abs(by_jacobian - found.qd) / scale).max() <= 1e-10


@every_robot
def test_the_jacobian_is_the_difference_of_the_forward_problem(model: str) -> None:
    robot = robot_named(model)
    with np.errstate(all="raise"):
        assert jacobian_error(robot, random_q(robot, np.random.default_rng(1), STATES)) <= 1e-10


@every_robot
def test_a_jacobian_of_which_one_entry_is_off_by_a_millionth_is_noticed(
    model: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = robot_named(model)
    q = random_q(robot, np.random.default_rng(1), 100)
    true = type(robot).jacobian

    def off_by_a_little(self: Robot, q: FloatArray) -> FloatArray:
        found = true(self, q)
        found[..., 0, 0] *= 1 + 1e-6
        return found

    monkeypatch.setattr(type(robot), "jacobian", off_by_a_little)
    assert jacobian_error(robot, q) > 1e-9


@every_robot
def test_every_link_frame_moves_as_its_differences_say(model: str) -> None:
    """Positions and attitudes by `placements`, which knows no derivatives, against `link_motion`."""
    robot = robot_named(model)
    q, qd, qdd, qddd = random_motion(robot, 5, 1000)
    around, frames = [], []
    for k in range(-4, 5):
        t = k * STEP / 10
        moved = q + qd * t + qdd * t**2 / 2 + qddd * t**3 / 6
        state = moved, qd + qdd * t + qddd * t**2 / 2, qdd + qddd * t, qddd
        frames.append(transforms(robot, moved))
        around.append([robot.link_motion(link, *state) for link in range(len(robot.links))])
    for link in range(len(robot.links)):
        motions = [row[link] for row in around]
        for ladder in (("p", "v", "a", "j"), ("yaw", "yaw_d", "yaw_dd", "yaw_ddd")):
            for below, above in pairwise(ladder):
                rows = np.stack([getattr(m, below) for m in motions])
                if below == "yaw":
                    rows = np.unwrap(rows, axis=0)
                slope, told = np.tensordot(STENCIL, rows, 1) / (STEP / 10), getattr(motions[4], above)
                assert (np.abs(slope - told) / np.maximum(1.0, np.abs(rows[4]) + np.abs(told))).max() <= 1e-8
        assert np.abs(frames[4][:, link, :3, 3] - motions[4].p).max() <= 1e-13
        if link not in robot.tilting:
            c, s = np.cos(motions[4].yaw), np.sin(motions[4].yaw)
            upright = np.zeros((len(q), 3, 3))
            upright[:, 0, 0] = upright[:, 1, 1] = c
            upright[:, 1, 0], upright[:, 0, 1], upright[:, 2, 2] = s, -s, 1.0
            assert np.abs(frames[4][:, link, :3, :3] - upright).max() <= 1e-13


@every_robot
def test_the_transforms_along_the_chain_are_rigid_and_end_where_forward_says(model: str) -> None:
    robot = robot_named(model)
    q = random_q(robot, np.random.default_rng(2), STATES)
    found = transforms(robot, q)
    rotation = found[..., :3, :3]
    assert np.abs(np.swapaxes(rotation, -1, -2) @ rotation - np.eye(3)).max() <= 1e-14
    assert np.abs(np.linalg.det(rotation) - 1.0).max() <= 1e-14
    p, yaw = robot.forward(q)
    end = found[:, flange_of(robot)]
    assert np.abs(end[:, :3, 3] - p).max() <= 1e-14
    if "yaw" in robot.coordinates:
        assert angle(np.arctan2(end[:, 1, 0], end[:, 0, 0]) - yaw).max() <= 1e-13


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
    sign = np.sign(determinant(robot, low))
    good = sign * np.sign(determinant(robot, high)) < 0
    low, high, sign = low[good], high[good], sign[good]
    for _ in range(60):
        middle = (low + high) / 2
        here = (np.sign(determinant(robot, middle)) == sign)[:, None]
        low, high = np.where(here, middle, low), np.where(here, high, middle)
    kept = robot.within(low) & np.isfinite(robot.jacobian(low)).all((1, 2))
    q = low[kept]
    left, values, right = np.linalg.svd(robot.jacobian(q))
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
def test_where_the_determinant_vanishes_the_margin_does_and_the_singularity_has_its_name(model: str) -> None:
    robot = robot_named(model)
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
def test_where_the_margin_does_not_vanish_the_determinant_does_not(model: str) -> None:
    robot = robot_named(model)
    q = random_q(robot, np.random.default_rng(4), STATES)
    assert (np.abs(determinant(robot, q)) > 0.0).all()
    inverse, jacobian = inverse_jacobian(robot, q), robot.jacobian(q)
    size = np.linalg.norm(inverse, axis=(1, 2)) * np.linalg.norm(jacobian, axis=(1, 2))
    error = np.abs(jacobian @ inverse - np.eye(len(robot.coordinates))).max((1, 2))
    assert (error / size).max() <= 1e-13
