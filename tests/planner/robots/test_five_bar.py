"""The five-bar: inverse against forward, differences and the dyads, both kinds of singularity, every refusal."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from assur.experiments.five_bar_workspace import type_2_curves, workspace
from assur.planner.arrays import FloatArray
from assur.planner.assur.rrr import RRR
from assur.planner.errors import FaultError, InputError
from assur.planner.frames.motion import Motion, Pose
from assur.planner.geometry.shapes import Body, Piece, box
from assur.planner.robots.five_bar import DISTAL_LEFT, DISTAL_RIGHT, FLANGE, LINKS, MODES, QUILL, FiveBar
from assur.planner.robots.protocol import Code, Limits, Robot, RobotBody
from tests.planner.robots.five_bars import BASES, LENGTHS, five_bar, states

STENCIL = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
"""Weights of the central first difference of order 8, over steps −4 … 4."""

every_mode = pytest.mark.parametrize("mode", range(4), ids=MODES)
every_assembly = pytest.mark.parametrize("assembly", ["front", "back"])


def rates(rng: np.random.Generator, q: FloatArray) -> tuple[FloatArray, ...]:
    return tuple(scale * rng.normal(size=q.shape) for scale in (1.0, 10.0, 100.0))


def at_rest(x: float, y: float, z: float = 0.2, yaw: float = 0.0) -> Motion:
    return Motion.still(Pose(x, y, z, yaw), ())


def same_angle(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.asarray(np.abs(np.angle(np.exp(1j * (a - b)))))


def test_a_five_bar_is_a_robot() -> None:
    robot: Robot = five_bar()
    assert robot.links == LINKS
    assert robot.modes == ("left-left", "left-right", "right-left", "right-right")
    assert [five_bar(axes=axes).coordinates for axes in (2, 3, 4)] == [
        ("x", "y"),
        ("x", "y", "z"),
        ("x", "y", "z", "yaw"),
    ]
    assert [five_bar(axes=axes).lift for axes in (2, 3, 4)] == [None, 2, 2]
    assert [joint.kind for joint in robot.joints] == ["revolute", "revolute", "prismatic", "revolute"]
    assert five_bar(axes=3).rate_matrix.tolist() == [[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0]]
    with pytest.raises(ValueError, match="read-only"):
        robot.rate_matrix[0, 0] = 2.0


@every_mode
@every_assembly
@pytest.mark.parametrize("base", BASES)
def test_the_inverse_of_the_flange_motion_is_the_joint_motion(mode: int, assembly: str, base: Pose) -> None:
    """10,000 states a mode, all four derivatives, and back to the place to less than a nanometre."""
    robot, rng = five_bar("even", base=base, assembly=assembly), np.random.default_rng(mode)
    q = states(rng, robot, mode, 10_000)
    motion = rates(rng, q)
    with np.errstate(all="raise"):
        flange = robot.link_motion(FLANGE, q, *motion)
        got = robot.inverse(flange, mode)
    assert (got.code == Code.ASSEMBLED).all()
    assert (robot.mode_of(q) == mode).all()
    assert same_angle(got.q, q).max() < 1e-12
    assert np.abs(got.q[:, 2] - q[:, 2]).max() < 1e-15
    assert got.parallel is not None
    assert np.abs(got.parallel - robot.parallel_margin(q)).max() < 1e-12
    assert np.abs(got.margin - robot.margin(q)).max() < 1e-12
    position, yaw = robot.forward(got.q)
    assert np.abs(position - flange.p).max() < 1e-9
    assert same_angle(yaw, flange.yaw).max() < 1e-9
    scale = np.linalg.norm(np.stack(motion), axis=(0, 2))[:, None]
    for found, made in zip((got.qd, got.qdd, got.qddd), motion, strict=True):
        assert (np.abs(found - made) / scale).max() < 1e-9


@pytest.mark.parametrize("lengths", sorted(LENGTHS))
@pytest.mark.parametrize("axes", [2, 3, 4])
def test_other_lengths_and_fewer_axes_come_back_too(lengths: str, axes: int) -> None:
    for mode in (1,) if lengths == "one axis" else (0, 1, 3):
        robot, rng = five_bar(lengths, axes=axes, base=BASES[1]), np.random.default_rng(axes)
        q = states(rng, robot, mode, 1_000)
        motion = rates(rng, q)
        got = robot.inverse(robot.link_motion(FLANGE, q, *motion), mode)
        assert (got.code == Code.ASSEMBLED).all()
        assert same_angle(got.q, q).max() < 1e-12
        for found, made in zip((got.qd, got.qdd, got.qddd), motion, strict=True):
            assert (np.abs(found - made) / np.linalg.norm(np.stack(motion), axis=(0, 2))[:, None]).max() < 1e-9


@every_assembly
def test_every_link_moves_as_its_differences_say(assembly: str) -> None:
    robot, rng, step = five_bar("odd", base=BASES[1], assembly=assembly), np.random.default_rng(5), 4e-4
    q = states(rng, robot, 1 if assembly == "front" else 2, 200, 0.2)
    q = q[robot.parallel_margin(q) > 0.4]
    qd, qdd, qddd = rates(rng, q)
    for link in range(len(LINKS)):
        around = []
        for k in range(-4, 5):
            t = k * step
            at = (
                q + qd * t + qdd * t**2 / 2 + qddd * t**3 / 6,
                qd + qdd * t + qddd * t**2 / 2,
                qdd + qddd * t,
                qddd,
            )
            with np.errstate(all="raise"):
                around.append(robot.link_motion(link, *at))
        for ladder in (("p", "v", "a", "j"), ("yaw", "yaw_d", "yaw_dd", "yaw_ddd")):
            for below, above in pairwise(ladder):
                values = np.stack([getattr(m, below) for m in around])
                if below == "yaw":
                    values = np.unwrap(values, axis=0)
                difference = np.tensordot(STENCIL, values, 1) / step
                exact = getattr(around[4], above)
                assert (np.abs(difference - exact) / (1 + np.abs(exact))).max() < 1e-7


def test_placements_forward_and_link_motion_are_one_geometry() -> None:
    for axes in (2, 3, 4):
        robot, rng = five_bar("odd", axes=axes, base=BASES[1]), np.random.default_rng(6)
        q = states(rng, robot, 1, 200)
        still = np.zeros_like(q)
        p, rotation = robot.placements(q)
        for link in range(len(LINKS)):
            exact = robot.link_motion(link, q, still, still, still)
            assert np.abs(p[:, link] - exact.p).max() < 1e-14
            c, s = np.cos(exact.yaw), np.sin(exact.yaw)
            assert np.abs(rotation[:, link, 0] - np.stack([c, -s, 0 * c], -1)).max() < 1e-13
            assert np.abs(rotation[:, link, 1] - np.stack([s, c, 0 * c], -1)).max() < 1e-13
        position, yaw = robot.forward(q)
        assert np.abs(position - p[:, FLANGE]).max() < 1e-14
        assert same_angle(yaw, robot.link_motion(FLANGE, q, still, still, still).yaw).max() < 1e-14
        assert (rotation[:, QUILL] == np.eye(3)).all()


@every_assembly
def test_the_chain_is_closed_and_its_couplers_have_their_lengths(assembly: str) -> None:
    """Seen from the placements alone: both couplers end at the tool axis, on the side that the assembly mode says."""
    robot = five_bar("odd", base=BASES[1], assembly=assembly)
    q = states(np.random.default_rng(7), robot, 1, 500)
    p, rotation = robot.placements(q)
    for link, length in ((DISTAL_LEFT, robot.distal[0]), (DISTAL_RIGHT, robot.distal[1])):
        ends = p[:, link, :2] + length * rotation[:, link, :2, 0]
        assert np.abs(ends - p[:, FLANGE, :2]).max() < 1e-14
    across = p[:, DISTAL_RIGHT, :2] - p[:, DISTAL_LEFT, :2]
    to_tool = p[:, FLANGE, :2] - p[:, DISTAL_LEFT, :2]
    side = across[:, 0] * to_tool[:, 1] - across[:, 1] * to_tool[:, 0]
    assert (side > 0).all() if assembly == "front" else (side < 0).all()


@every_mode
def test_the_jacobian_is_that_of_differences_and_of_the_dyads(mode: int) -> None:
    robot, rng = five_bar("odd", base=BASES[1]), np.random.default_rng(mode)
    q = states(rng, robot, mode, 300)
    jacobian, step = robot.jacobian(q), 2e-4
    for k in range(4):
        e = np.zeros(4)
        e[k] = step
        around = [robot.forward(q + i * e) for i in range(-4, 5)]
        position = np.tensordot(STENCIL, np.stack([p for p, _ in around]), 1) / step
        yaw = np.tensordot(STENCIL, np.unwrap(np.stack([turn for _, turn in around]), axis=0), 1) / step
        difference = np.concatenate([position, yaw[:, None]], -1)
        assert (np.abs(difference - jacobian[:, :, k]) / (1 + np.abs(difference))).max() < 1e-6
    # Direct: the dyad between the elbows. Inverse: the dyads of both sides, J⁻¹ ẋ.
    task = rng.normal(size=(len(q), 4))
    flange = robot.link_motion(FLANGE, q, *(np.zeros_like(q),) * 3)
    moved = Motion(flange.p, task[:, :3], flange.a, flange.j, flange.yaw, task[:, 3], flange.yaw_dd, flange.yaw_ddd)
    qd = robot.inverse(moved, mode, 1).qd
    expected = np.linalg.solve(jacobian, task[:, :, None])[:, :, 0]
    assert (np.abs(qd - expected) / (1 + np.abs(expected))).max() < 1e-9
    again = robot.link_motion(FLANGE, q, qd, np.zeros_like(q), np.zeros_like(q))
    assert np.abs(again.v - task[:, :3]).max() < 1e-9
    # K36: det = −D_L D_R/D
    s = robot.span(q)
    loop = RRR(*robot.distal).solve(robot.sigma, (s[..., 0], s[..., 1]))
    left = np.arctan2(loop.u[1], loop.u[0]) - q[:, 0]
    right = np.arctan2(-loop.w[1], -loop.w[0]) - q[:, 1]
    c1 = robot.proximal[0] * robot.distal[0] * np.sin(left)
    c2 = robot.proximal[1] * robot.distal[1] * np.sin(right)
    assert np.linalg.det(jacobian[:, :2, :2]) == pytest.approx(-c1 * c2 / loop.cross, rel=1e-9)


# Singularities, at constructed places.


def test_type_1_at_both_ends_of_either_arms_reach() -> None:
    robot = five_bar("odd")
    half = robot.separation / 2
    for side, a, b in zip((half, -half), robot.proximal, robot.distal, strict=True):
        for angle in (0.05, -0.1):
            e = np.array([np.cos(angle), np.sin(angle)])
            for radius, kind in ((a + b, Code.STRETCHED), (abs(a - b), Code.FOLDED)):
                x, y = radius * e + [0.0, side]
                codes = {int(robot.inverse(at_rest(x, y), mode).code) for mode in range(4)}
                assert codes <= {kind, Code.OUT_OF_REACH, Code.PARALLEL}
                if kind in codes:
                    mode = next(m for m in range(4) if robot.inverse(at_rest(x, y), m).code == kind)
                    got = robot.inverse(at_rest(x, y), mode)
                    assert got.margin == 0
                    assert np.isfinite(got.q).all()
                    assert np.isnan(got.qd).all()
                    assert robot.margin(got.q) < 1e-6
                    assert robot.singular_distance(got.q) < 1e-12


def test_a_stretched_left_arm_is_type_1_and_can_be_assembled() -> None:
    robot = five_bar("even")
    got = robot.inverse(at_rest(0.46 * np.cos(-0.3), 0.0425 + 0.46 * np.sin(-0.3)), 1)
    assert got.code == Code.STRETCHED
    assert got.margin == 0
    assert got.q[0] == pytest.approx(-0.3, abs=1e-12)
    assert robot.within(got.q)


def test_type_2_between_the_assembly_modes() -> None:
    """Couplers in one line, 0.26 m each, symmetrical about the x axis; and a little to both sides of it."""
    robot = five_bar("short")
    x = np.sqrt(0.2**2 - (0.16 - 0.0425) ** 2)
    for dx, sign in ((0.0, 0), (1e-4, 1), (-1e-4, -1)):
        got = robot.inverse(at_rest(x + dx, 0.0), 1)
        assert got.code == Code.PARALLEL
        assert got.parallel is not None
        assert np.sign(np.round(got.parallel, 9)) == sign
        assert got.margin > 0.5  # nothing is the matter with type 1 there
        assert np.isfinite(got.qd).all()
    front = robot.inverse(at_rest(x + 0.05, 0.0), 1)
    assert front.code == Code.ASSEMBLED
    assert robot.within(front.q)
    behind = robot.inverse(at_rest(x - 0.05, 0.0), 1)
    assert behind.code == Code.PARALLEL
    assert behind.parallel is not None
    assert behind.parallel < -0.1
    # the same place is assembled by the machine that is put together the other way round
    other = five_bar("short", assembly="back").inverse(at_rest(x - 0.05, 0.0), 1)
    assert other.code == Code.ASSEMBLED
    assert other.parallel == pytest.approx(-float(behind.parallel))


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


@every_mode
def test_out_of_reach_and_not_a_number(mode: int) -> None:
    robot = five_bar()
    nan = float("nan")
    for target in (at_rest(1.0, 0.0), at_rest(0.0, 0.0425), Motion.still(Pose(0.3, 0.0, 0.2), ())):
        target.v[...] = nan if target.p[0] == 0.3 else 0.0
        got = robot.inverse(target, mode)
        assert got.code == Code.OUT_OF_REACH
        assert got.parallel is not None
        assert all(np.isnan(x).all() for x in (got.q, got.qd, got.qdd, got.qddd, got.margin, got.parallel))


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


def test_a_working_mode_changes_where_type_1_is_crossed_and_the_assembly_does_not() -> None:
    """The left crank turns through the line with its coupler: the joints are an ordinary way, and K33 stays."""
    robot = five_bar("even")
    q = np.zeros((400, 4))
    q[:, 0], q[:, 1], q[:, 2] = np.linspace(1.2, -0.8, 400), -1.0, 0.2
    modes = robot.mode_of(q)
    assert modes[0] == 1
    assert set(modes.tolist()) == {1, 3}
    assert robot.margin(q).min() < 0.01
    assert robot.assembled(q, q).all()
    assert robot.assembled(q[:1] * 0 + np.minimum(q[0], q[20]), np.maximum(q[:1], q[20])).all()


def test_sigma_is_that_of_the_dyads() -> None:
    robot, q = five_bar("odd"), states(np.random.default_rng(3), five_bar("odd"), 1, 50)
    p, _ = robot.forward(q)
    for k, side in enumerate((0.06, -0.06)):
        solved = RRR(robot.proximal[k], robot.distal[k]).solve((1, -1)[k], (p[:, 0], p[:, 1] - side))
        assert same_angle(np.arctan2(solved.u[1], solved.u[0]), q[:, k]).max() < 1e-12


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
    robot = five_bar("short", base=BASES[1])
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


# What is not a five-bar.


@pytest.mark.parametrize(
    ("field", "change"),
    [
        ("axes", {"axes": 5}),
        ("assembly", {"assembly": "inside"}),
        ("parallel_least", {"parallel_least": 0.0}),
        ("separation", {"separation": 2.0}),
        ("separation", {"separation": float("nan")}),
        ("joint_names", {"joint_names": ("a", "a", "b", "c")}),
        ("limits", {"axes": 3}),
        ("l1", {"proximal": (0.0, 0.2)}),
        ("self_pairs", {"self_pairs": (("base", "link1"),)}),
        ("bodies", {"bodies": (RobotBody(Body("x", (Piece(box(1, 1, 1)),)), 7),)}),
        ("bodies", {"bodies": (RobotBody(Body("x", (Piece(box(1, 1, 1)),)), QUILL),)}),
    ],
)
def test_what_is_no_five_bar_is_refused(field: str, change: dict[str, object]) -> None:
    wide = np.full(4, 4.0)
    kept: dict[str, object] = {
        "name": "x",
        "separation": 0.085,
        "proximal": (0.2, 0.2),
        "distal": (0.26, 0.26),
        "axes": 4,
        "limits": Limits(-wide, wide, wide, wide, wide),
    }
    with pytest.raises(InputError, match=field):
        FiveBar(**{**kept, **change})  # type: ignore[arg-type]


def test_what_does_not_exist_is_a_fault() -> None:
    robot, q = five_bar(), np.zeros((1, 4))
    with pytest.raises(FaultError):
        robot.inverse(at_rest(0.3, 0), 4)
    with pytest.raises(FaultError):
        robot.link_motion(7, q, q, q, q)
