"""The recheck accepts a right answer and refuses each wrong one: a guard is tried against what it must refuse."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.judge.problems import recheck
from benchmarks.problem_set import ProblemSet, read_problem_set
from benchmarks.recheck import recheck_lines
from benchmarks.translation import Match
from tests.benchmarks.hand_made import along, answer, joints_at, problem_set, with_more_knots

PROBLEMS = Path(__file__).parents[2] / "benchmarks" / "problems"
START = [-0.6, 0.9, 0.15, 0.3]
GOAL = {"pos": [0.4, 0.2, 0.1], "yaw": 1.0}
SLOWLY_S = 1.0
"""Long enough for every limit on the way from START to GOAL."""
STATIC: Match = "position"


def as_bytes(document: Any) -> bytes:
    """A line of a file."""
    return json.dumps(document).encode()


def _problem(*obstacles: dict[str, Any], goal: dict[str, Any] | None = None) -> dict[str, Any]:
    return {"id": "hand-made", "start": START, "goal": goal or GOAL, "obstacles": list(obstacles)}


def _straight(duration: float = SLOWLY_S, shift: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> dict[str, Any]:
    position = (np.array(GOAL["pos"]) + shift).tolist()
    return along([np.array(START), joints_at(position, 1.0, 1.0)], [duration])


def _kinds(problem: dict[str, Any], line: dict[str, Any], match: Match = STATIC) -> set[str]:
    return {finding.kind for finding in recheck(problem_set(problem), problem, line, match)}


def test_a_right_answer_has_no_findings_however_many_knots_it_has() -> None:
    assert _kinds(_problem(), _straight()) == set()
    assert _kinds(_problem(), with_more_knots(_straight(), 9)) == set()


def test_shipped_problems_that_the_straight_motion_solves_are_accepted_with_that_motion() -> None:
    problems = read_problem_set(PROBLEMS / "static.json")
    solved = 0
    for problem in [p for p in problems.problems if p["direct"]][:8]:
        goal = problem["goal"]
        verdicts = []
        for sign in (1.0, -1.0):
            line = along([np.array(problem["start"]), joints_at(goal["pos"], goal["yaw"], sign)], [2.0])
            verdicts.append({finding.kind for finding in recheck(problems, problem, line, STATIC)})
        solved += set() in verdicts
        assert all(kinds <= {"collision", "position"} for kinds in verdicts), problem["id"]
    assert solved >= 6  # the others need the wrist the other way round


@pytest.mark.parametrize(
    "obstacle",
    [
        {"type": "box", "size": [0.02, 0.02, 0.6], "pos": [0.5, 0.0, 0.3], "yaw": 0.4},
        {"type": "cylinder", "radius": 0.01, "height": 0.6, "pos": [0.5, 0.0, 0.3], "yaw": 0.0},
        {"type": "cylinder", "radius": 0.01, "height": 0.2, "pos": [0.5, 0.0, 0.1], "yaw": 0.0},
        {
            "type": "box",
            "size": [0.02, 0.02, 0.6],
            "pos": [0.5, -0.5, 0.3],
            "yaw": 0.0,
            "motion": {"kind": "linear", "v": [0.0, 1.0, 0.0]},
        },
        {
            "type": "capsule",
            "radius": 0.01,
            "length": 0.3,
            "motion": {"kind": "swing", "pivot": [0.6, 0.2, 0.36], "phase": -3.0, "omega": 1.5},
        },
    ],
    ids=["box", "pillar", "post under the links", "box that moves", "arm that swings"],
)
def test_a_straight_line_through_an_obstacle_is_refused(obstacle: dict[str, Any]) -> None:
    assert _kinds(_problem(obstacle), _straight()) == {"collision"}


def test_an_obstacle_that_is_gone_when_the_arm_comes_is_no_collision() -> None:
    passing = {"type": "box", "size": [0.02, 0.02, 0.6], "pos": [0.5, 0.0, 0.3], "yaw": 0.0}
    passing["motion"] = {"kind": "linear", "v": [5.0, 0.0, 0.0]}
    assert _kinds(_problem(passing), _straight()) == set()


def test_a_body_that_the_arm_just_reaches_is_hit_and_one_that_it_just_misses_is_not() -> None:
    # Link 2 ends 0.275/2 + 0.355/2 m beyond the elbow, on the line at q1 + q2; here the arm stands still.
    q1, q12 = START[0], START[0] + START[1]
    elbow = 0.325 * np.array([np.cos(q1), np.sin(q1)])
    outwards = np.array([np.cos(q12), np.sin(q12)])
    here = {"pos": [*(elbow + 0.275 * outwards).tolist(), START[2]], "yaw": q12 + START[3]}
    still = along([np.array(START), np.array(START)], [0.1])
    for gap, kinds in ((-1e-5, {"collision"}), (1e-5, set())):
        centre = elbow + (0.275 / 2 + 0.355 / 2 + 0.02 + gap) * outwards
        post = {"type": "box", "size": [0.04, 0.04, 0.02], "pos": [*centre.tolist(), 0.36], "yaw": q12}
        assert _kinds(_problem(post, goal=here), still) == kinds


@pytest.mark.parametrize(
    ("shift", "kinds"),
    [((0.0, 0.0, 0.0), set()), ((1.5e-6, 0.0, 0.0), set()), ((3e-6, 0.0, 0.0), {"goal"}), ((0.0, 0.0, 3e-6), {"goal"})],
)
def test_a_goal_missed_by_three_micrometres_is_refused(shift: tuple[float, float, float], kinds: set[str]) -> None:
    assert _kinds(_problem(), _straight(shift=shift)) == kinds


@pytest.mark.parametrize(("turn", "kinds"), [(1e-6, set()), (3e-6, {"goal"}), (2 * np.pi, set()), (np.pi, {"goal"})])
def test_a_yaw_missed_by_three_microradians_is_refused_and_full_turns_are_not(turn: float, kinds: set[str]) -> None:
    line = _straight(duration=2.0)
    line["trajectory"]["position"][-1][3] += turn
    assert _kinds(_problem(), line) == kinds


def test_a_velocity_limit_broken_between_all_knots_and_samples_is_refused() -> None:
    problem = _problem()
    problems = problem_set(problem)
    line = _straight()
    peak = 1.875 * np.abs(np.diff(np.array(line["trajectory"]["position"]), axis=0))[0, 0]
    for ratio, kinds in ((1 + 0.5e-6, set()), (1 + 2e-6, {"velocity"})):
        limits = {**problems.limits, "vmax": (peak / ratio, *problems.limits["vmax"][1:])}
        found = recheck(ProblemSet("x", limits, (problem,)), problem, line, STATIC)
        assert {finding.kind for finding in found} == kinds


@pytest.mark.parametrize(
    ("limit", "factor", "kind"), [("amax", 10 / np.sqrt(3), "acceleration"), ("jmax", 60.0, "jerk")]
)
def test_the_limits_of_acceleration_and_jerk_hold_to_their_tolerance(limit: str, factor: float, kind: str) -> None:
    problem = _problem()
    problems = problem_set(problem)
    line = _straight()
    peak = factor * np.abs(np.diff(np.array(line["trajectory"]["position"]), axis=0))[0, 1]
    tolerance = 1e-4 if kind == "jerk" else 1e-6
    for ratio, kinds in ((1 + 0.5 * tolerance, set()), (1 + 2 * tolerance, {kind})):
        first, _, *others = problems.limits[limit]
        limits = {**problems.limits, limit: (first, peak / ratio, *others)}
        found = recheck(ProblemSet("x", limits, (problem,)), problem, line, STATIC)
        assert {finding.kind for finding in found} == kinds


def test_a_joint_that_swings_out_of_its_range_between_two_knots_is_refused() -> None:
    line = _straight()
    for index, velocity in ((0, -0.6), (-1, 0.0)):
        line["trajectory"]["velocity"][index][2] = velocity
    assert "position" in _kinds(_problem(), line)


def test_a_motion_that_does_not_begin_in_the_start_state_is_refused() -> None:
    for column, amount in (("position", 1e-9), ("velocity", 1e-12), ("acceleration", 1e-12)):
        line = _straight()
        line["trajectory"][column][0][1] += amount
        assert _kinds(_problem(), line) == {"start"}
    late = _straight()
    late["trajectory"]["time_s"] = [0.001, SLOWLY_S]
    assert _kinds(_problem(), late) == {"start"}


def test_a_motion_that_ends_after_five_seconds_is_refused() -> None:
    assert _kinds(_problem(), _straight(duration=5.0)) == set()
    assert _kinds(_problem(), _straight(duration=5.001)) == {"end"}


def test_an_end_that_is_not_at_rest_is_refused() -> None:
    for column, amount in (("velocity", 2e-5), ("acceleration", 2e-5)):
        line = _straight()
        line["trajectory"][column][-1][0] = amount
        assert _kinds(_problem(), line) == {"goal velocity"}


def _moving(velocity_error: float = 0.0) -> tuple[dict[str, Any], dict[str, Any]]:
    """A goal that moves along x, met at 1 s with its velocity: q̇ from central differences of the inverse."""
    goal = {"pos": [0.3, 0.2, 0.1], "yaw": 1.0, "v": [0.1, 0.0]}
    step = 1e-5
    q, before, after = (joints_at([0.4 + dx, 0.2, 0.1], 1.0, 1.0) for dx in (0.0, -step, step))
    rate = (after - before) / (2 * step) * (0.1 + velocity_error)
    line = answer([0.0, 1.0], [START, q.tolist()], [[0.0] * 4, rate.tolist()], [[0.0] * 4] * 2)
    return _problem(goal=goal), line


def test_a_moving_goal_met_with_its_velocity_is_accepted_where_that_was_asked_and_only_there() -> None:
    problem, line = _moving()
    assert _kinds(problem, line, "velocity") == set()
    assert _kinds(problem, line, "position") == {"goal velocity"}
    assert _kinds(problem, _straight(), "position") == set()
    assert _kinds(problem, _straight(), "velocity") == {"goal velocity"}


def test_a_velocity_off_by_eight_micrometres_a_second_is_refused() -> None:
    assert _kinds(*_moving(3e-6), "velocity") == set()
    assert _kinds(*_moving(8e-6), "velocity") == {"goal velocity"}


def test_a_moving_goal_met_too_late_is_refused() -> None:
    problem, line = _moving()
    line["trajectory"]["time_s"][-1] = line["duration_s"] = 1.001
    assert "goal" in _kinds(problem, line, "velocity")


@pytest.mark.parametrize(
    "spoil",
    [
        lambda line: line["trajectory"].pop("velocity"),
        lambda line: line["trajectory"]["position"][0].pop(),
        lambda line: line["trajectory"].update(time_s=[0.0, 0.0]),
        lambda line: line["trajectory"].update(time_s=[0.0, float("inf")]),
        lambda line: line["trajectory"]["position"][1].__setitem__(0, float("nan")),
        lambda line: line.update(trajectory=None),
        lambda line: line.update(duration_s=None),
        lambda line: line.update(duration_s=0.9),
    ],
)
def test_an_answer_of_the_wrong_form_is_refused(spoil: Any) -> None:
    line = _straight()
    spoil(line)
    assert _kinds(_problem(), line) == {"form"}


def test_an_answer_that_the_checker_refused_or_never_saw_is_refused() -> None:
    for verdict in (False, None):
        assert _kinds(_problem(), {**_straight(), "checked": verdict}) == {"checker"}
    assert _kinds(_problem(), {**_straight(), "status": "error"}) == {"status"}


def test_a_file_needs_one_line_for_every_problem_and_no_more() -> None:
    problem = _problem()
    problems = problem_set(problem)
    line = as_bytes(_straight())

    def kinds(*lines: bytes) -> list[str]:
        return [finding.text for finding in recheck_lines(problems, list(lines))[0]]

    assert kinds(line) == []
    assert kinds() == ["has no line"]
    assert kinds(line, line) == ["answered twice"]
    assert kinds(line, as_bytes({**_straight(), "id": "other"})) == ["not a problem of this set"]
    assert len(kinds(line, b"{")) == 1
    assert kinds(as_bytes({"id": "hand-made", "status": "not_planned", "trajectory": None})) == []


def test_a_file_that_is_no_problem_set_is_refused(tmp_path: Path) -> None:
    good = {**problem_set(_problem()).limits, "problems": [_problem()]}
    wrong: list[dict[str, Any]] = []
    for key in good:
        spoilt = copy.deepcopy(good)
        del spoilt[key]
        wrong.append(spoilt)
    wrong.append({**good, "problems": [_problem(), _problem()]})
    path = tmp_path / "set.json"
    path.write_bytes(as_bytes(good))
    assert read_problem_set(path).problems[0]["id"] == "hand-made"
    for document in wrong:
        path.write_bytes(as_bytes(document))
        with pytest.raises((ValueError, KeyError)):
            read_problem_set(path)
