"""What a problem means to the scenes is what it means to the recheck, which was written by reading the README."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from assur.planner.model.scene import Move, Scene
from assur.planner.robots.scara import Scara
from assur.scenes.requests import scene_of
from benchmarks.problem_set import Problem, ProblemSet, read_problem_set
from benchmarks.recheck.arm import placed_bodies, tool
from benchmarks.recheck.surroundings import goal_at, placed_obstacles
from benchmarks.translation import LATEST_END_S, Terms, request, unrelated_problem

FOLDER = Path(__file__).parents[2] / "benchmarks" / "problems"
SETS = {path.stem: read_problem_set(path) for path in sorted(FOLDER.glob("*.json"))}
SAME_M = 1e-12


def _scene(problems: ProblemSet, problem: Problem, terms: Terms | None = None) -> Scene:
    return scene_of(request(problem, problems.limits, terms or Terms()))


def _samples(problems: ProblemSet) -> list[Problem]:
    return [*problems.problems[::7], unrelated_problem(5, moving_goal=True)]


def _turn(angle: object) -> np.ndarray:
    return np.abs(np.remainder(np.asarray(angle) + np.pi, 2 * np.pi) - np.pi)


@pytest.mark.parametrize("problems", SETS.values(), ids=SETS)
def test_every_obstacle_is_where_the_recheck_sees_it_at_every_time(problems: ProblemSet) -> None:
    t = np.linspace(0.0, LATEST_END_S, 23)
    for problem in _samples(problems):
        scene = _scene(problems, problem)
        obstacles = placed_obstacles(problem, t)
        assert len(scene.bodies) == len(obstacles)
        for body, seen in zip(scene.bodies, obstacles, strict=True):
            (piece,) = body.body.pieces
            motion = scene.frames[body.frame].law.motion(t).at(body.pose)
            assert not piece.position.any()
            assert np.abs(motion.p - seen.centre).max() <= SAME_M
            assert _turn(motion.yaw - seen.yaw).max() <= SAME_M
            # The solid of the recheck and the planner's shape reach equally far along the axes.
            shape, solid = piece.shape, seen.solid
            half = np.abs(piece.rotation @ np.array(shape.half)) + shape.ball  # type: ignore[union-attr]
            wide = np.array([solid.half_x, solid.half_y, solid.half_z]) + solid.ball
            np.testing.assert_allclose(half, wide, atol=1e-15)
            assert shape.disc == solid.round_m  # type: ignore[union-attr]


@pytest.mark.parametrize("problems", SETS.values(), ids=SETS)
def test_the_arm_is_where_the_recheck_sees_it(problems: ProblemSet) -> None:
    robot = _scene(problems, problems.problems[0]).robot
    assert isinstance(robot, Scara)
    q = np.random.default_rng(1).uniform(problems.limits["qmin"], problems.limits["qmax"], (50, 4))
    position, yaw = robot.forward(q)
    seen = tool(q, np.zeros_like(q))
    assert np.abs(position - seen.position).max() <= SAME_M
    assert _turn(yaw - seen.yaw).max() <= SAME_M
    origin, rotation = robot.placements(q)
    assert len(robot.bodies) == 3
    for carried, body in zip(robot.bodies, placed_bodies(q), strict=True):
        (piece,) = carried.body.pieces
        centre = origin[:, carried.link] + rotation[:, carried.link] @ piece.position
        assert np.abs(centre - body.centre).max() <= SAME_M
        along = (rotation[:, carried.link] @ piece.rotation)[:, :2, 0]
        if body.solid.half_x > 0:
            assert np.allclose(along, np.stack([np.cos(body.yaw), np.sin(body.yaw)], axis=-1), atol=1e-12)


@pytest.mark.parametrize("problems", SETS.values(), ids=SETS)
def test_limits_start_and_goal_are_those_of_the_file(problems: ProblemSet) -> None:
    for problem in _samples(problems):
        scene = _scene(problems, problem)
        limits = scene.robot.limits
        for mine, name in (
            (limits.lower, "qmin"),
            (limits.upper, "qmax"),
            (limits.velocity, "vmax"),
            (limits.acceleration, "amax"),
            (limits.jerk, "jmax"),
        ):
            assert mine.tolist() == list(problems.limits[name])
        assert scene.start.q.tolist() == problem["start"]
        assert not scene.start.moving
        (step,) = scene.task
        assert isinstance(step, Move)
        for t in (0.0, 1.7):
            motion = scene.frames[step.target.frame].law.motion(np.array(t)).at(step.target.pose)
            position, yaw, velocity = goal_at(problem, t)
            assert np.abs(motion.p - position).max() <= SAME_M
            assert np.abs(motion.v - velocity).max() <= SAME_M
            assert _turn(motion.yaw - yaw) <= SAME_M


def test_the_manners_of_the_benchmark_are_asked_for() -> None:
    problems = SETS["moving_goal"]
    options = _scene(problems, problems.problems[0], Terms(0.7, "budget", "velocity", 3)).options
    assert (options.budget_s, options.stop, options.seed, options.end) == (0.7, "budget", 3, "moving")
    assert (options.clearance.travel_m, options.clearance.near_m, options.singularity_margin) == (0.0, 0.0, 0.0)
    assert (options.elbow, options.stay_safe_s, options.latest_end_s) == ("auto", 0.0, LATEST_END_S)
    (step,) = _scene(problems, problems.problems[0]).task
    assert isinstance(step, Move)
    assert step.match == "position"
    assert _scene(problems, problems.problems[0]).options.end == "rest"


def test_a_problem_of_another_kind_is_refused_by_name() -> None:
    problem = unrelated_problem(1, moving_goal=False)
    problem["obstacles"][0] = {"type": "cone", "pos": [0.0, 0.0, 0.0], "yaw": 0.0}
    with pytest.raises(ValueError, match="obstacle-0: unknown type 'cone'"):
        request(problem, SETS["static"].limits, Terms())


def test_the_catalogue_knows_the_same_robot() -> None:
    problems = SETS["static"]
    document = request(problems.problems[0], problems.limits, Terms())
    inline = scene_of(document).robot
    named = scene_of({**document, "robot": {"model": "benchmark-scara", "tool": {"tcp_m": [0.0, 0.0, 0.0]}}}).robot
    assert isinstance(inline, Scara)
    assert isinstance(named, Scara)
    assert (named.l1, named.l2, named.joints) == (inline.l1, inline.l2, inline.joints)
    assert inline.self_pairs == ()  # without a tool and a part none of them can meet
    assert set(named.self_pairs) == {("link1", "quill"), ("link1", "flange"), ("link2", "flange")}
    for name in ("lower", "upper", "velocity", "acceleration", "jerk"):
        assert np.allclose(getattr(named.limits, name), getattr(inline.limits, name), rtol=1e-15, atol=0.0)
    for one, other in zip(named.bodies, inline.bodies, strict=True):
        assert one.link == other.link
        for mine, yours in zip(one.body.pieces, other.body.pieces, strict=True):
            assert mine.shape == yours.shape
            assert np.allclose(mine.position, yours.position, rtol=0.0, atol=1e-15)
            assert np.array_equal(mine.rotation, yours.rotation)
