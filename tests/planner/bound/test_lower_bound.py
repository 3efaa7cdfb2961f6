"""No plan of any budget beats the lower bound."""

from __future__ import annotations

import math
import tracemalloc
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from assur.planner.bound.duration import least_duration
from assur.planner.frames.motion import Pose
from assur.planner.laws import conveyor, keyframes, turntable
from assur.planner.model.attachments import AT_START
from assur.planner.model.outcome import Planned
from assur.planner.model.scene import Follow, Pick, Place, Scene, Target, Tool, Window
from assur.planner.pipeline import plan
from assur.planner.robots.facts import Limits
from assur.planner.timing import RawProfile, Solver
from assur.planner.timing.solver import JERK_RESERVE, RATE_RESERVE
from assur.scenes.requests import scene_of
from tests.planner.cells import CRANKED, PART, arm, at, belt_and_dial, cell, frame, go, limits, stands, table_to_table
from tests.planner.timing.least import rest_to_rest_time

DIAL = frame("dial", turntable(Pose(0.32, 0.12), 0.8))
BELT = frame("belt", conveyor(Pose(-0.3, 0.35), 0.3))


def planned(scene: Scene, seed: int = 1, most: int = 60) -> Planned:
    options = replace(scene.options, seed=seed, max_candidates=most, stop="budget")
    outcome = plan(replace(scene, options=options))
    assert isinstance(outcome, Planned), outcome.sentence
    return outcome


CELLS: dict[str, Callable[[], Scene]] = {
    "one move": lambda: cell(go(0.35, -0.2)),
    "two moves": lambda: cell(go(0.35, -0.2), go(0.2, 0.4, name="b")),
    "via": lambda: cell(go(0.4, 0.0, 0.15, via=True), go(0.3, -0.3, name="b")),
    "dial": lambda: cell(go(0.1, 0.0, 0.1, 0.0, "dial"), frames=(DIAL,)),
    "dial, position": lambda: cell(go(0.1, 0.0, 0.1, 0.0, "dial", match="position"), frames=(DIAL,)),
    "follow": lambda: cell(Follow("f", at(0.0, 0.0, 0.1, 0.0, "belt"), 0.3), go(0.3, 0.0, name="b"), frames=(BELT,)),
    "window": lambda: cell(go(0.35, -0.2, window=Window(time=(2.0, 3.0)))),
    "start in motion": lambda: cell(go(0.35, -0.2), qd=(1.0, -1.0, 0.1, 2.0)),
    "table": lambda: table_to_table(go(0.3, 0.0, 0.15)),
    "table, cranked, symmetric": lambda: table_to_table(go(0.3, 0.0, 0.15), tool=CRANKED, fold=2),
    "belt": belt_and_dial,
}


def bounded(scene: Scene) -> float:
    """The bound of a cell in which there is one."""
    found = least_duration(scene)
    assert found is not None
    return found


def with_reserve(scene: Scene) -> Scene:
    """The same cell with the limits that a planner uses, who leaves a reserve."""
    own = scene.robot.limits
    rates = (1 - RATE_RESERVE) * own.velocity, (1 - RATE_RESERVE) * own.acceleration, (1 - JERK_RESERVE) * own.jerk
    return replace(scene, robot=replace(scene.robot, limits=Limits(own.lower, own.upper, *rates)))


REACHED = {
    "one move": 0.995,
    "two moves": 0.995,
    "via": 0.85,
    "dial": 0.85,
    "dial, position": 0.9,
    "follow": 0.9,
    "window": 0.99999,
    "start in motion": 0.995,
    "table": 0.95,
    "table, cranked, symmetric": 0.95,
    "belt": 0.8,
}
"""Which share of the best plan that was found the bound reaches at least. A planner leaves some 1 % of the limits."""


@pytest.mark.parametrize("name", sorted(CELLS))
def test_no_plan_is_shorter_than_the_bound(name: str) -> None:
    best = math.inf
    for seed in (1, 2):
        outcome = planned(CELLS[name](), seed)
        best = min(best, outcome.plan.trajectory.duration)
        assert outcome.lower_bound_s == bounded(CELLS[name]())
        assert 0 < outcome.lower_bound_s <= outcome.plan.trajectory.duration
    assert bounded(CELLS[name]()) >= REACHED[name] * best


def test_a_dwell_is_in_the_bound_whatever_the_yaw() -> None:
    free = replace(at(0.3, 0.1, 0.1, 0.0), yaw_free=True)
    scene = cell(Follow("f", free, 0.7), go(0.35, -0.2, name="b"))
    assert 0.7 < bounded(scene) <= planned(scene).plan.trajectory.duration


@settings(max_examples=25)
@given(st.floats(-0.35, 0.35), st.floats(0.15, 0.45), st.floats(-3, 3), st.sampled_from(["keep", "auto"]))
def test_a_direct_move_alone_reaches_the_bound_of_the_limits_that_a_planner_uses(
    y: float, x: float, yaw: float, elbow: str
) -> None:
    if not 0.2 < math.hypot(x, y) < 0.55:
        return
    scene = cell(go(x, y, 0.15, yaw), elbow=elbow, stop="budget", max_candidates=20)
    outcome = plan(scene)
    if isinstance(outcome, Planned):
        assert bounded(scene) <= outcome.plan.trajectory.duration
        assert bounded(with_reserve(scene)) == pytest.approx(outcome.plan.trajectory.duration, rel=1e-4)


def test_the_bound_of_a_single_joint_is_its_fastest_motion() -> None:
    q = (0.3, 1.2, 0.1, 0.0)
    p, yaw = arm().forward(cell(go(0.3, 0.0), q=q).start.q)
    scene = cell(go(float(p[0]), float(p[1]), 0.2, float(yaw)), q=q, elbow="keep")
    known = limits()
    alone = float(rest_to_rest_time(0.1, known.velocity[2], known.acceleration[2], known.jerk[2]))
    assert alone * (1.0 - 1.5e-6) < bounded(scene) < alone


def test_dwells_and_waiting_for_a_window_count() -> None:
    way = bounded(cell(go(0.35, -0.2)))
    assert bounded(cell(Follow("f", at(0.35, -0.2), 0.7))) == pytest.approx(way + 0.7, rel=1e-5)
    assert bounded(cell(go(0.35, -0.2, window=Window(time=(2.0, 3.0))))) == pytest.approx(2.0, rel=1e-5)


def test_a_turn_of_a_symmetric_part_that_needs_no_way_at_all_is_not_ruled_out() -> None:
    """Taken from the far side, this part is put down where the flange is already: no way is known to be needed."""
    crank = Tool(Pose(0.08, 0.0, -0.06))
    there = Pose(0.35, 0.1, 0.05, 0.0)
    # flange at p + c when taken turned by 180°; at q + R(90°) c when put down: the same place
    to = Pose(0.35 + 0.08, 0.1 - 0.08, 0.05, math.pi / 2)
    part = stands("part", PART, there.x, there.y, there.z, there.yaw, yaw_symmetry=2)
    task = (
        Pick("pick", "part", Pose(z=0.01), 0.03, 0.05, 0.04),
        Place("place", "part", Target("world", to), 0.03, 0.05, 0.03),
    )
    scene = cell(*task, bodies=(part,), tool=crank, robot=arm(bare=True))
    flange = [AT_START.flange(scene, task[0], turn)[1] for turn in (0.0, math.pi)]
    down = [AT_START.after(scene, task[0], turn).flange(scene, task[1])[1] for turn in (0.0, math.pi)]
    assert math.dist(flange[1].position, down[1].position) < 1e-9
    assert min(math.dist(flange[k].position, down[0].position) for k in (0, 1)) > 0.1
    # the way between the two places is up and down again alone
    alone = replace(scene, bodies=(replace(part, yaw_symmetry=1),), task=task)
    there_and_back = bounded(scene) - 0.1 - bounded(replace(scene, task=(go(0.35, 0.1, name="way"),)))
    assert bounded(alone) > bounded(scene) + 0.005
    assert there_and_back < bounded(alone)


def test_a_point_that_comes_by_between_two_times_of_the_grid_is_not_ruled_out() -> None:
    """A point on a dial that turns once in 0.67 s: by the times of the grid it could be met in 0.42 s at best."""
    point = {"frame": "dial", "at_m": [0.2346856663440896, 0, 0.1], "yaw_rad": -2.533972274576709}
    turns = {"at_m": [0.16300351802068605, -0.0722987809525622, 0.1], "rate_rad_s": 9.395546073848386}
    request = {
        "schema": "assur/1",
        "robot": {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_m": [0, 0, -0.1]}},
        "start": {"joints": {"j1_rad": 0.44628044686742996, "j2_rad": 1.9642789552860553, "j3_m": 0.3, "j4_rad": 0.0}},
        "bodies": [],
        "frames": {"dial": {"turntable": turns, "valid_s": [-1, 30]}},
        "task": [{"move": {"to": point, "match": "position"}}],
        "options": {"stop": "first", "budget_s": 60, "max_candidates": 30, "elbow": "keep"},
    }
    cell_of = scene_of(request)
    outcome = plan(cell_of)
    assert isinstance(outcome, Planned)
    assert 0.8 * outcome.plan.trajectory.duration < bounded(cell_of) <= outcome.plan.trajectory.duration < 0.3


def test_the_arm_need_not_stop_at_the_approach_height() -> None:
    """It moves down at 1.5 m/s already: to stop 35 mm above the part takes longer than to go there."""
    q = (0.3, 1.2, 0.2, 0.0)
    p, yaw = arm().forward(cell(go(0.3, 0.0), q=q).start.q)
    part = stands("part", PART, float(p[0]), float(p[1]), float(p[2]) - 0.045 - 0.02, float(yaw))
    pick = Pick("pick", "part", Pose(z=0.02), 0.035, 0.0, 0.0)
    scene = cell(pick, bodies=(part,), q=q, qd=(0.0, 0.0, -1.5, 0.0), robot=arm(bare=True), elbow="keep")
    known, lift = limits(), (p[2], -1.5, 0.0)
    kept = (1 - RATE_RESERVE, 1 - RATE_RESERVE, 1 - JERK_RESERVE)  # of what a solver is given it uses so much
    whole = (known.velocity, known.acceleration, known.jerk)
    rates = ([float(rate[2]) / share] for rate, share in zip(whole, kept, strict=True))
    quickest = Solver(*rates).raw_profile(tuple([x] for x in lift), ([p[2] - 0.045], [0.0], [0.0]))  # type: ignore[arg-type]
    assert isinstance(quickest, RawProfile)
    assert bounded(scene) == pytest.approx(quickest.duration, rel=2e-6)
    assert bounded(scene) < quickest.duration


def test_while_the_lift_goes_down_the_other_joints_are_with_the_part_as_it_comes() -> None:
    # the part comes 90 mm nearer while the lift goes down: where it is at the end is not where the arm must be first
    request = {
        "schema": "assur/1",
        "robot": {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_m": [0.0, 0.0, -0.1]}},
        "start": {"joints": {"j1_rad": -0.23, "j2_rad": 1.87, "j3_m": 0.3, "j4_rad": 0.0}},
        "frames": {"belt": {"linear": {"at_m": [0.2, 0.2, 0.05], "velocity_m_s": [0.0, 0.45, 0.0]}}},
        "bodies": [
            {
                "name": "part",
                "shape": {"box": {"size_m": [0.03, 0.03, 0.03]}},
                "pose": {"frame": "belt", "at_m": [0.0, 0.0, 0.015]},
            }
        ],
        "task": [
            {
                "pick": {
                    "part": "part",
                    "grasp_m": [0.0, 0.0, 0.015],
                    "approach": {"m": 0.1, "stop": True},
                    "depart": {"m": 0.02, "stop": True},
                    "dwell_s": 0.02,
                    "window_s": [0.05, 5.0],
                }
            }
        ],
        "options": {"budget_s": 60},
    }
    scene = scene_of(request)
    found = planned(scene).plan.trajectory
    lasts = found.end - found.start
    assert 0.9 * lasts < bounded(scene) <= lasts


def test_what_an_arm_does_after_it_cannot_go_along_with_its_point_any_more_is_not_known() -> None:
    # the point is at one side, then out of reach, then at the other side: who waits there has no way to the goal
    times = (0.0, 1.6, 1.7, 1.8, 1.9, 2.1, 2.3, 2.4, 2.5, 2.6, 9.0)
    law = keyframes(times, [*[Pose(0.45, -0.25)] * 5, Pose(0.9, 0.0), *[Pose(0.45, 0.25)] * 5])
    own = limits()
    slow = replace(own, velocity=np.array([0.5, *own.velocity[1:]]))
    first, goal = go(0.0, 0.0, 0.1, 0.0, "shuttle"), go(0.44, 0.25, 0.12, name="b")
    more: dict[str, Any] = {"frames": (frame("shuttle", law),), "robot": replace(arm(), limits=slow), "elbow": "keep"}
    there = replace(first, window=Window(time=(2.3, 9.0)))
    found = planned(cell(there, goal, q=(-0.49, 1.083, 0.2, 0.0), **more), most=20).plan.trajectory
    assert bounded(cell(first, goal, q=(-0.49, 1.083, 0.2, 0.0), **more)) <= found.duration


def test_the_way_along_a_path_counts_once() -> None:
    # the arm goes to the last point of the path while it traces it, and not afterwards
    request = {
        "schema": "assur/1",
        "robot": {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_m": [0.0, 0.0, -0.1]}},
        "start": {"joints": {"j1_rad": -0.23, "j2_rad": 1.87, "j3_m": 0.3, "j4_rad": 0.0}},
        "task": [
            {
                "trace": {
                    "start": {"at_m": [0.25, 0.25, 0.12], "yaw_rad": 0.0},
                    "path": [{"line": {"to_m": [0.25, -0.25, 0.12]}}],
                    "speed_m_s": 0.05,
                }
            }
        ],
        "options": {"budget_s": 60},
    }
    scene = scene_of(request)
    found = planned(scene).plan.trajectory
    lasts = found.end - found.start
    assert 0.5 / 0.05 < bounded(scene) <= lasts


def test_behind_a_point_of_which_nothing_is_known_the_limits_of_an_empty_gripper_count() -> None:
    # the part may be taken with any yaw, and the tool is beside the flange's axis: where the flange is, is not known
    request: dict[str, Any] = {
        "schema": "assur/1",
        "robot": {
            "model": "mitsubishi-rh-6frh5520",
            "tool": {"tcp_mm": [30, 0, -60]},
            "limits": {"acceleration_by_load": [{"mass_kg": 0.1, "share": 1.0}, {"mass_kg": 4.0, "share": 0.05}]},
        },
        "start": {"joints": {"j1_deg": -100, "j2_deg": 90, "j3_mm": 250, "j4_deg": 0}},
        "bodies": [
            {
                "name": "p",
                "shape": {"box": {"size_mm": [20, 20, 20]}},
                "pose": {"at_mm": [200, 320, 110]},
                "mass_kg": 4.0,
                "yaw_symmetry": 0,
            }
        ],
        "task": [
            {
                "pick": {
                    "part": "p",
                    "grasp_mm": [0, 0, 10],
                    "approach": {"mm": 5},
                    "dwell_ms": 20,
                    "depart": {"mm": 5},
                }
            },
            {"move": {"to": {"at_mm": [198, 321, 130], "yaw_deg": 140}}},
        ],
        "options": {"budget_s": 60, "elbow": "keep"},
    }
    for task, start in (
        (request["task"], request["start"]),
        (request["task"][:1], {"joints": {"j1_deg": -20, "j2_deg": 90, "j3_mm": 250, "j4_deg": 0},
                               "velocity": {"j1_deg_s": 300, "j2_deg_s": 0, "j3_mm_s": 0, "j4_deg_s": 1500}}),
    ):  # fmt: skip
        scene = scene_of({**request, "task": task, "start": start})
        found = planned(scene).plan.trajectory
        assert bounded(scene) <= found.end - found.start


def test_positions_of_joints_that_turn_often_are_counted_before_they_are_made() -> None:
    # 15 turns of five joints each: 760,000 positions in each of four modes, of which no more than 64 are looked at
    scene = scene_of(
        {
            "schema": "assur/1",
            "robot": {"model": "mitsubishi-rv-m1", "tool": {"tcp_m": [0.0, 0.0, 0.0]}},
            "start": {"tool": {"at_m": [0.3, 0.1, 0.3], "pitch_rad": -1.0, "roll_rad": 0.0}},
            "task": [{"move": {"to": {"at_m": [0.3, 0.05, 0.3], "pitch_rad": -1.0, "roll_rad": 0.2}}}],
            "options": {"elbow": "auto"},
        }
    )
    own, most = scene.robot.limits, np.full(5, 50.0)
    limits_of_many = Limits(-most, most, own.velocity, own.acceleration, own.jerk)
    many = replace(scene, robot=replace(scene.robot, limits=limits_of_many))
    assert bounded(scene) > 0.0
    tracemalloc.start()
    try:
        assert least_duration(many) is None
        assert tracemalloc.get_traced_memory()[1] < 5_000_000
    finally:
        tracemalloc.stop()
