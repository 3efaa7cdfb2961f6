"""What a problem means to the planner and to the judge is what its README says, whose formulas are written out here."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from assur.planner.model.scene import Move, Scene
from assur.planner.robots.scara import Scara
from assur.scenes.requests import scene_of
from benchmarks.judge.cell import Cell
from benchmarks.problem_set import Problem, ProblemSet, read_problem_set
from benchmarks.translation import LATEST_END_S, Document, Terms, request, unrelated_problem

FOLDER = Path(__file__).parents[2] / "benchmarks" / "problems"
SETS = {path.stem: read_problem_set(path) for path in sorted(FOLDER.glob("*.json"))}
SAME_M = 1e-12


def _scene(problems: ProblemSet, problem: Problem, terms: Terms | None = None) -> Scene:
    return scene_of(request(problem, problems.limits, terms or Terms()))


def _samples(problems: ProblemSet) -> list[Problem]:
    return [*problems.problems[::7], unrelated_problem(5, moving_goal=True)]


def _turn(angle: object) -> np.ndarray:
    return np.abs(np.remainder(np.asarray(angle) + np.pi, 2 * np.pi) - np.pi)


def by_the_readme(obstacle: Document, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, list[float], float]:
    """Centre (N, 3) and yaw (N,) of an obstacle, how far it reaches along its axes, and the radius that rounds it."""
    if obstacle["type"] == "capsule":
        motion, length, radius = obstacle["motion"], obstacle["length"], obstacle["radius"]
        yaw = motion["phase"] + motion["omega"] * t
        outwards = np.stack([np.cos(yaw), np.sin(yaw), 0.0 * t], axis=-1)
        return motion["pivot"] + length / 2.0 * outwards, yaw, [length / 2.0 + radius, radius, radius], 0.0
    motion = obstacle.get("motion", {"kind": "linear", "v": [0.0, 0.0, 0.0]})
    assert motion["kind"] == "linear"
    centre = np.array(obstacle["pos"]) + np.array(motion["v"]) * t[:, None]
    yaw = np.full(len(t), obstacle["yaw"])
    if obstacle["type"] == "box":
        return centre, yaw, [size / 2.0 for size in obstacle["size"]], 0.0
    return centre, yaw, [0.0, 0.0, obstacle["height"] / 2.0], obstacle["radius"]


@pytest.mark.parametrize("problems", SETS.values(), ids=SETS)
def test_every_obstacle_is_where_the_readme_has_it_at_every_time(problems: ProblemSet) -> None:
    """To the planner and to the judge, whose shapes reach as far along the axes."""
    t = np.linspace(0.0, LATEST_END_S, 23)
    for problem in _samples(problems):
        scene, cell = _scene(problems, problem), Cell.of(request(problem, problems.limits, Terms()))
        assert len(scene.bodies) == len(cell.seats) == len(problem["obstacles"])
        for body, (name, (frame, pose)), obstacle in zip(
            scene.bodies, cell.seats.items(), problem["obstacles"], strict=True
        ):
            centre, yaw, wide, disc = by_the_readme(obstacle, t)
            (piece,) = body.body.pieces
            motion = scene.frames[body.frame].law.motion(t).at(body.pose)
            assert not piece.position.any()
            judged = cell.frames[frame].at(t).then(pose)
            for found in (motion, judged):
                assert np.abs(found.p - centre).max() <= SAME_M
                assert _turn(found.yaw - yaw).max() <= SAME_M
            shape, solid = piece.shape, cell.solids[name]
            half = np.abs(piece.rotation @ np.array(shape.half)) + shape.ball  # type: ignore[union-attr]
            np.testing.assert_allclose(half, wide, atol=1e-15)
            np.testing.assert_allclose([solid.half_x + solid.ball, solid.half_y + solid.ball, solid.height], wide)
            assert shape.disc == solid.round_m == disc  # type: ignore[union-attr]


@pytest.mark.parametrize("problems", SETS.values(), ids=SETS)
def test_the_arm_is_where_the_readme_has_it(problems: ProblemSet) -> None:
    """To the planner and to the judge: the tool, and the three bodies with their sizes."""
    document = request(problems.problems[0], problems.limits, Terms())
    robot, arm = scene_of(document).robot, Cell.of(document).arm
    assert isinstance(robot, Scara)
    q = np.random.default_rng(1).uniform(problems.limits["qmin"], problems.limits["qmax"], (50, 4))
    first, both, level = q[:, 0], q[:, 0] + q[:, 1], np.ones(len(q))
    elbow = 0.325 * np.stack([np.cos(first), np.sin(first), 0.0 * level], axis=-1)
    tool = elbow + 0.275 * np.stack([np.cos(both), np.sin(both), 0.0 * level], axis=-1)
    up = np.array([0.0, 0.0, 1.0])
    (position, yaw), seen = robot.forward(q), arm.tool(q)
    for p, turned in ((position, yaw), (seen.p, seen.yaw)):
        assert np.abs(p - tool - q[:, 2:3] * up).max() <= SAME_M
        assert _turn(turned - both - q[:, 3]).max() <= SAME_M
    by_readme = (
        ("link 1", elbow / 2.0 + 0.30 * up, first, (0.405 / 2, 0.08 / 2, 0.06 / 2), 0.0),
        ("link 2", (elbow + tool) / 2.0 + 0.36 * up, both, (0.355 / 2, 0.08 / 2, 0.06 / 2), 0.0),
        ("quill", tool + (q[:, 2:3] + 0.31 / 2.0) * up, None, (0.0, 0.0, 0.31 / 2), 0.012),
    )
    origin, rotation = robot.placements(q)
    links = arm.links(q)
    for carried, body, (_, centre, turn, half, disc) in zip(robot.bodies, arm.bodies, by_readme, strict=True):
        (piece,) = carried.body.pieces
        assert np.abs(origin[:, carried.link] + rotation[:, carried.link] @ piece.position - centre).max() <= SAME_M
        judged = links[body.link].then(body.pose)
        assert np.abs(judged.p - centre).max() <= SAME_M
        assert (body.solid.half_x, body.solid.half_y, body.solid.half_z, body.solid.round_m) == (*half, disc)
        if turn is not None:
            along = (rotation[:, carried.link] @ piece.rotation)[:, :2, 0]
            assert np.allclose(along, np.stack([np.cos(turn), np.sin(turn)], axis=-1), atol=1e-12)
            assert _turn(judged.yaw - turn).max() <= SAME_M


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
            velocity = np.array([*problem["goal"].get("v", [0.0, 0.0]), 0.0])
            assert np.abs(motion.p - np.array(problem["goal"]["pos"]) - velocity * t).max() <= SAME_M
            assert np.abs(motion.v - velocity).max() <= SAME_M
            assert _turn(motion.yaw - problem["goal"]["yaw"]) <= SAME_M


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


@pytest.mark.parametrize(
    ("obstacle", "why"),
    [
        ({"type": "cone", "pos": [0, 0, 0], "yaw": 0}, "type 'cone'"),
        ({"type": "box", "size": [1, 1, 1], "motion": {"kind": "jump"}}, "motion 'jump'"),
    ],
)
def test_a_problem_of_another_kind_is_refused_by_name(obstacle: Document, why: str) -> None:
    problem = unrelated_problem(1, moving_goal=False)
    problem["obstacles"][0] = obstacle
    with pytest.raises(ValueError, match=f"obstacle-0: unknown {why}"):
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
