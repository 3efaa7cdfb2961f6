"""Parabolic blends from request to plan: what is planned holds, the rest is refused at its field or by its number.

The tool point keeps the limit of its acceleration with a held part, on both sides of every jump.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from assur.planner.checked import check
from assur.planner.checker import Code as Finding
from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import box, cylinder
from assur.planner.laws import conveyor, swing, turntable
from assur.planner.model.link_frames import link_law
from assur.planner.model.outcome import Course, NotPlanned, Outcome, Planned, Route
from assur.planner.model.refusal import AccelerationTime, Carrying, Reason
from assur.planner.model.scene import (
    Arch,
    Follow,
    Holding,
    Options,
    Pick,
    Place,
    Scene,
    Start,
    Step,
    Target,
    Window,
    WorldBody,
)
from assur.planner.pipeline import plan
from assur.planner.robots.facts import Code
from assur.planner.robots.scara import LINK1
from assur.planner.search.tuning import MOST_OPTIONS
from assur.planner.trajectory import Trajectory
from tests.planner.cells import CUP, PART, Around, amount_of, arm, at, cell, frame, go, solid, stands, unit_of
from tests.planner.trajectory.splines import bernstein

DIAL = frame("dial", turntable(Pose(0.32, 0.12), 0.8))
BELT = frame("belt", conveyor(Pose(-0.3, 0.35), 0.2))
GATE = frame("gate", swing(Pose(0.5, 0.0, 0.1), 1.2, 1.1))


def blend(scene: Scene, **changes: Any) -> Scene:
    asked: dict[str, Any] = {"timing": "parabolic_blend", "seed": 1, "budget_s": 60.0, "max_candidates": 150}
    return replace(scene, options=replace(scene.options, **{**asked, **changes}))


def wall() -> Around:
    """Across the direct way, lower than the lift goes."""
    return stands("wall", box(0.3, 0.02, 0.16), 0.45, 0.0, 0.08)


def among() -> Scene:
    """Past two vias, over and around a wall, while a bar swings by; two stops."""
    task: tuple[Step, ...] = (
        go(0.35, -0.3, 0.15, name="a", via=True),
        go(0.45, -0.1, 0.18, name="b", via=True),
        go(0.35, 0.25, 0.1, name="c"),
        go(0.2, 0.35, 0.12, name="d", via=True),
        go(0.35, 0.1, 0.15, name="e"),
    )
    bar = stands("bar", box(0.2, 0.03, 0.03), 0.2, 0.0, 0.0, frame="gate")
    bodies = (stands("block", box(0.08, 0.08, 0.12), 0.45, 0.1, 0.06), bar)
    return blend(cell(*task, bodies=bodies, frames=(GATE,), tool=CUP), stay_safe_s=0.2, clearance=_clear(0.003))


def _clear(travel: float) -> Any:
    return replace(Options().clearance, travel_m=travel)


CELLS = {
    "one move": lambda: blend(cell(go(0.35, -0.2))),
    "where it is already": lambda: blend(cell(go(0.3, 0.0, 0.1, yaw=0.4), go(0.3, 0.0, 0.1, yaw=0.4, name="again"))),
    "via": lambda: blend(cell(go(0.4, 0.0, 0.15, via=True), go(0.3, -0.3, name="b"))),
    "three axes": lambda: blend(
        cell(go(0.4, 0.0, 0.15, via=True), go(0.3, -0.3, name="b"), q=(0.3, 1.2, 0.2), robot=arm(axes=3))
    ),
    "given time": lambda: blend(cell(go(0.4, 0.0, 0.15, via=True), go(0.3, -0.3, name="b")), acceleration_time_s=0.25),
    "dial": lambda: blend(cell(go(0.1, 0.0, 0.1, 0.0, "dial", match="position"), frames=(DIAL,))),
    "via on a belt, stop on a dial": lambda: blend(
        cell(
            go(0.3, 0.0, 0.15, 0.0, "belt", match="position", via=True, name="v"),
            go(0.1, 0.0, 0.1, 0.0, "dial", match="position", name="w"),
            frames=(BELT, DIAL),
        ),
        acceleration_time_s=0.4,
    ),
    "window": lambda: blend(cell(go(0.35, -0.2, window=Window(time=(2.0, 3.0))))),
    "window of a via": lambda: blend(
        cell(go(0.4, 0.0, 0.15, via=True, window=Window(time=(1.5, 1.6))), go(0.3, -0.3, name="b"))
    ),
    "window on a belt": lambda: blend(
        cell(go(0.3, 0.0, 0.15, 0.0, "belt", match="position", window=Window(along=(0.5, 0.7))), frames=(BELT,))
    ),
    "not yet in reach": lambda: blend(
        cell(
            go(0.0, 0.0, 0.15, 0.0, "late", match="position"),
            frames=(frame("late", conveyor(Pose(0.35, -1.0, 0.0, np.pi / 2), 0.4)),),
        )
    ),
    "a via not yet in reach": lambda: blend(
        cell(
            go(0.0, 0.0, 0.15, 0.0, "late", match="position", via=True, name="v"),
            go(0.3, 0.2, 0.1, name="w"),
            frames=(frame("late", conveyor(Pose(0.35, -1.0, 0.0, np.pi / 2), 0.4)),),
        )
    ),
    "over a wall": lambda: blend(cell(go(0.4, -0.3), go(0.4, 0.3, name="b"), bodies=(wall(),))),
    "late on the clock": lambda: blend(
        cell(go(0.4, 0.0, 0.15, via=True), go(0.3, -0.3, name="b"), time=54321.123), acceleration_time_s=0.25
    ),
    "among": among,
}


@cache
def answer(name: str) -> tuple[Scene, Outcome]:
    scene = CELLS[name]()
    return scene, plan(scene)


def planned(name: str) -> tuple[Scene, Planned]:
    scene, outcome = answer(name)
    assert isinstance(outcome, Planned), outcome.sentence
    return scene, outcome


def test_a_point_that_is_not_yet_in_reach_is_waited_for_and_met_as_soon_as_it_is() -> None:
    _, outcome = planned("not yet in reach")
    assert [leg.route for leg in outcome.plan.legs] == [Route(Course.FOR_POINT), Route(Course.ROUNDED, after_wait=True)]
    scene = CELLS["not yet in reach"]()
    robot, law = scene.robot, scene.frames["late"].law
    target = Pose(0.0, 0.0, 0.15)
    end = outcome.plan.trajectory.end

    def reached(t: float) -> bool:
        codes = (robot.inverse(law.motion(np.array([t])).at(target).at_rest(), mode, 0) for mode in (0, 1))
        return any(found.code[0] == Code.ASSEMBLED and robot.within(found.q).all() for found in codes)

    assert reached(end)
    # meeting times are looked at every 16 ms at most
    assert not any(reached(t) for t in np.arange(0.0, end - 0.017, 0.01))


@pytest.mark.parametrize("name", sorted(CELLS))
def test_what_is_planned_is_checked_and_says_that_its_jerk_is_unbounded(name: str) -> None:
    scene, outcome = planned(name)
    assert check(scene, outcome.plan).ok
    assert outcome.plan.trajectory.jumps
    assert outcome.margins.jerk == "unbounded"
    assert "jerk" not in outcome.margins.binds
    for peak in outcome.margins.peaks:
        assert peak.jerk is peak.jerk_ratio is None
        assert peak.velocity_ratio <= 1 + 1e-9
        assert peak.acceleration_ratio <= 1 + 1e-9
    assert "jerk" not in outcome.plan.certificate.covers
    assert outcome.lower_bound_s is not None
    assert outcome.lower_bound_s <= outcome.plan.trajectory.duration + 1e-9


def test_an_acceleration_time_that_is_given_is_that_of_every_blend() -> None:
    scene, outcome = planned("given time")
    path = outcome.plan.trajectory
    pull = np.abs(bernstein(path, 2)).max((1, 2)) > 1e-6
    assert path.steps[pull].tolist() == pytest.approx([0.25] * int(pull.sum()))
    assert pull.sum() == 3
    assert scene.options.acceleration_time_s == 0.25


def test_windows_are_waited_for_and_kept() -> None:
    for name, low, high in (("window", 2.0, 3.0), ("window of a via", 1.5, 1.6)):
        _, outcome = planned(name)
        assert low - 1e-9 <= outcome.plan.arrivals[0].time <= high + 1e-9
        assert outcome.plan.legs[0].kind == "WAIT"
    _, outcome = planned("window on a belt")
    assert outcome.plan.arrivals[0].along_m is not None
    assert 0.5 - 1e-6 <= outcome.plan.arrivals[0].along_m <= 0.7 + 1e-6


def test_a_wall_across_the_way_is_blended_over() -> None:
    _, outcome = planned("over a wall")
    assert any("wall" in line.refusal.bodies for line in outcome.census.lines)
    assert any(leg.route is not None and leg.route.vias for leg in outcome.plan.legs)


def test_the_same_request_gives_the_same_plan() -> None:
    scene, first = planned("among")
    again = plan(scene)
    assert isinstance(again, Planned)
    assert again.plan.certificate.digest == first.plan.certificate.digest
    assert again.census == first.census


@settings(max_examples=30)
@given(st.integers(0, 10**6))
def test_random_chains_are_planned_and_checked_and_nothing_is_shorter_than_its_bound(seed: int) -> None:
    rng = np.random.default_rng(seed)
    steps = []
    for k in range(int(rng.integers(1, 5))):
        r, angle = rng.uniform(0.2, 0.55), rng.uniform(-1.2, 1.2)
        via = bool(rng.random() < 0.5)
        place = r * math.cos(angle), r * math.sin(angle), rng.uniform(0.06, 0.24), rng.uniform(-2, 2)
        steps.append(go(*place, name=f"s{k}", via=via))
    steps.append(go(0.35, 0.1, 0.1, name="last"))
    elbow = str(rng.choice(["keep", "auto"]))
    given_time = None if rng.random() < 0.5 else float(rng.uniform(0.3, 0.5))
    scene = blend(cell(*steps), elbow=elbow, acceleration_time_s=given_time, stop="first")
    outcome = plan(scene)
    if isinstance(outcome, NotPlanned):
        assert outcome.reason in (Reason.JOINT_LIMIT, Reason.MOTION_LIMIT, Reason.OUT_OF_REACH), outcome.sentence
        return
    assert check(scene, outcome.plan).ok
    assert outcome.lower_bound_s is not None
    assert 0 < outcome.lower_bound_s <= outcome.plan.trajectory.duration


def test_the_bound_is_one_of_velocity_and_acceleration_alone() -> None:
    """A bound that counts on a limit of jerk would lie above the plan."""
    scene, outcome = planned("one move")
    limited = plan(replace(scene, options=replace(scene.options, timing="jerk_limited")))
    assert isinstance(limited, Planned)
    assert limited.lower_bound_s is not None
    assert outcome.lower_bound_s is not None
    assert outcome.plan.trajectory.duration < limited.lower_bound_s
    assert outcome.lower_bound_s <= outcome.plan.trajectory.duration
    assert outcome.lower_bound_s >= 0.99 * outcome.plan.trajectory.duration


def test_an_acceleration_time_that_is_too_short_is_refused_with_joint_limit_and_what_would_do() -> None:
    scene = blend(cell(go(0.4, 0.0, 0.15, via=True, name="v"), go(0.3, -0.3, name="b")), acceleration_time_s=0.05)
    outcome = plan(scene)
    assert isinstance(outcome, NotPlanned)
    assert outcome.reason is Reason.MOTION_LIMIT
    assert not outcome.proved
    refusal = outcome.refusal
    assert refusal is not None
    joint = next(i for i, j in enumerate(scene.robot.joints) if j.name == refusal.joint)
    limit = float(scene.robot.limits.acceleration[joint])
    assert unit_of(refusal) == "rad/s²"
    assert amount_of(refusal) > 0
    assert isinstance(refusal.facts, AccelerationTime)
    assert (refusal.facts.given_s, refusal.facts.limit) == (0.05, limit)
    assert refusal.facts.needed == pytest.approx(limit + amount_of(refusal))
    assert f"with an acceleration time of 50 ms {refusal.joint} would need" in outcome.sentence
    assert {line.refusal.stage for line in outcome.census.lines if line.refusal.step >= 0} <= {"timing", "inverse"}
    assert outcome.census.candidates <= MOST_OPTIONS  # the direct ways, and none with more poses
    least = refusal.facts.enough_s
    assert least is not None
    assert isinstance(plan(replace(scene, options=replace(scene.options, acceleration_time_s=least))), Planned)
    sooner = replace(scene.options, acceleration_time_s=least - 2e-4)
    assert isinstance(plan(replace(scene, options=sooner)), NotPlanned)


def test_free_poses_go_round_bodies_and_a_leg_counts_its_own() -> None:
    """No body, no free pose; a wall is gone over with two free poses a leg, six in all, and a leg tells of two."""
    task = (go(0.4, -0.3), go(0.4, 0.3, name="b"), go(0.35, 0.3, name="c"))
    open_cell = plan(blend(cell(*task), stop="budget", max_candidates=80))
    assert isinstance(open_cell, Planned)
    assert {leg.route for leg in open_cell.plan.legs if leg.kind == "MOVE"} == {Route(Course.ROUNDED)}
    vias = (go(0.4, -0.3, via=True), go(0.4, 0.3, name="b", via=True), go(0.35, 0.3, name="c"))
    walled = plan(blend(cell(*vias, bodies=(wall(),)), max_candidates=400))
    assert isinstance(walled, Planned)
    routes = [leg.route for leg in walled.plan.legs if leg.kind == "MOVE"]
    assert routes == [Route(Course.ROUNDED, 2)] * 3  # up and over on the way to each


def test_what_would_have_helped_is_to_leave_the_acceleration_time_to_the_planner() -> None:
    scene = blend(cell(go(0.35, -0.2)), acceleration_time_s=0.02, explain_budget_s=60.0)
    outcome = plan(scene)
    assert isinstance(outcome, NotPlanned)
    assert outcome.relaxation is not None
    assert outcome.relaxation.what == "acceleration time"


def test_a_via_inside_a_body_is_no_proof_that_there_is_no_plan() -> None:
    """It is missed, after all; a stop there is one."""
    post = stands("post", cylinder(0.03, 0.25), 0.42, 0.05, 0.125)
    via = blend(cell(go(0.42, 0.05, via=True, name="v"), go(0.3, -0.3, name="b"), bodies=(post,)), max_candidates=40)
    outcome = plan(via)
    assert not (isinstance(outcome, NotPlanned) and outcome.proved)
    stop = plan(blend(cell(go(0.42, 0.05, name="v"), go(0.3, -0.3, name="b"), bodies=(post,)), max_candidates=40))
    assert isinstance(stop, NotPlanned)
    assert stop.proved


def test_what_cannot_be_reached_or_comes_too_late_is_refused_with_its_reason() -> None:
    far = plan(blend(cell(go(0.4, 0.0, via=True, name="v"), go(0.9, 0.0, name="far"))))
    assert isinstance(far, NotPlanned)
    assert far.reason is Reason.OUT_OF_REACH
    assert "far" in far.sentence
    late = plan(blend(cell(go(0.35, -0.2, window=Window(time=(0.0, 0.05)))), max_candidates=20))
    assert isinstance(late, NotPlanned)
    assert late.reason is Reason.WINDOW_MISSED
    assert late.census.candidates <= MOST_OPTIONS  # in a cell where nothing moves, nothing else would come sooner
    end = plan(blend(cell(go(0.35, -0.2)), max_candidates=20, latest_end_s=0.1))
    assert isinstance(end, NotPlanned)
    assert end.reason is Reason.WINDOW_MISSED
    assert "too late for latest_end_s" in end.sentence


def test_a_point_that_flees_faster_than_the_arm_is_not_met() -> None:
    away = frame("away", conveyor(Pose(0.3, -0.2, 0.0, math.pi / 2), 60.0))
    outcome = plan(blend(cell(go(0.0, 0.0, 0.1, 0.0, "away", match="position"), frames=(away,)), max_candidates=20))
    assert isinstance(outcome, NotPlanned)


def refused(*task: Step, **changes: Any) -> InputError:
    options = changes.pop("options", {})
    with pytest.raises(InputError) as caught:
        plan(blend(cell(*task, **changes), **options))
    return caught.value


GOAL = go(0.35, -0.2)
PART_THERE = Around(solid("part", PART), "world", Pose(0.25, 0.30, 0.05))


@pytest.mark.parametrize(
    ("task", "more", "field", "words"),
    [
        ((Follow("f", at(0.3, 0.0), 0.1),), {}, "task[0].follow", "moves only"),
        ((GOAL, Pick("p", "part", Pose(), 0.0, 0.0, 0.0)), {"bodies": (PART_THERE,)}, "task[1].pick", "moves only"),
        (
            (
                Pick("p", "part", Pose(), 0.0, 0.0, 0.0),
                Place("q", "part", Target("world", Pose(0.3, 0.0)), 0.0, 0.0, 0.0),
            ),
            {"bodies": (PART_THERE,)},
            "task[0].pick",
            "moves only",
        ),
        ((go(0.35, -0.2, leg="cartesian"),), {}, "task[0].move.leg", "joint"),
        ((go(0.35, -0.2, arch=Arch(0.2)),), {}, "task[0].move.arch", "no arch"),
        ((go(0.1, 0.0, 0.1, 0.0, "dial"),), {"frames": (DIAL,)}, "task[0].move.match", "position"),
        ((go(0.1, 0.0, frame="dial", via=True), GOAL), {"frames": (DIAL,)}, "task[0].move.match", "dial moves"),
        ((GOAL, go(0.3, 0.1, name="v", via=True)), {}, "task[1].move.via", "false"),
        ((GOAL,), {"qd": (0.1, 0.0, 0.0, 0.0)}, "start.velocity", "at rest"),
        ((GOAL,), {"options": {"end": "moving"}}, "options.end", "rest"),
        ((GOAL,), {"options": {"acceleration_time_s": 1e-3}}, "options.acceleration_time", "2 ms"),
        ((GOAL,), {"options": {"acceleration_time_s": math.nan}}, "options.acceleration_time", "2 ms"),
        (
            (GOAL,),
            {"options": {"timing": "jerk_limited", "acceleration_time_s": 0.2}},
            "options.acceleration_time",
            "none",
        ),
    ],
)
def test_what_does_not_go_with_blends_is_refused_by_its_field(
    task: tuple[Step, ...], more: dict[str, Any], field: str, words: str
) -> None:
    error = refused(*task, **more)
    assert error.field == field
    assert words in error.allowed


def test_a_start_that_accelerates_is_in_motion() -> None:
    scene = cell(GOAL)
    start = Start(0.0, scene.start.q, np.zeros(4), np.array([1.0, 0.0, 0.0, 0.0]))
    with pytest.raises(InputError, match="at rest"):
        blend(replace(scene, start=start))


def test_an_arm_that_runs_such_a_plan_is_no_frame() -> None:
    scene, outcome = planned("one move")
    with pytest.raises(InputError) as caught:
        link_law(scene.robot, outcome.plan.trajectory, LINK1)
    assert caught.value.field == "neighbour.trajectory"


LID = WorldBody(solid("lid", box(0.04, 0.04, 0.02)))


def holding(carry: float | None, given: float | None = None, **options: Any) -> Scene:
    """A lid is carried past a via to a stop."""
    task = (go(0.4, 0.0, 0.15, name="over", via=True), go(0.3, -0.25, 0.12, name="there"))
    scene = cell(*task, bodies=(LID,), tool=CUP, carry=carry)
    scene = replace(scene, start=replace(scene.start, holding=Holding("lid", Pose(z=0.01))))
    return blend(scene, max_candidates=40, acceleration_time_s=given, **options)


def peak(scene: Scene, path: Trajectory) -> float:
    """The largest acceleration of the tool point, m/s², by differences of positions within each piece."""
    largest, h = 0.0, 1e-5
    for one, other in zip(path.edges[:-1], path.edges[1:], strict=True):
        if other - one < 4 * h:
            continue
        t = np.linspace(one + h, other - h, 400)
        p = [scene.robot.forward(path.evaluate(t + k * h))[0] for k in (-1, 0, 1)]
        largest = max(largest, float(np.linalg.norm(p[0] - 2 * p[1] + p[2], axis=-1).max()) / h**2)
    return largest


@pytest.mark.parametrize("given", [None, 0.15, 0.3])
@pytest.mark.parametrize("limit", [20.0, 3.0])
def test_the_limit_is_kept_by_a_slower_motion(given: float | None, limit: float) -> None:
    free = plan(holding(None, given))
    scene = holding(limit, given)
    found = plan(scene)
    assert isinstance(free, Planned)
    assert isinstance(found, Planned), found.sentence
    told = found.margins.tool_acceleration
    assert peak(scene, found.plan.trajectory) == pytest.approx(told, rel=5e-3)
    assert told <= limit
    if peak(scene, free.plan.trajectory) > limit:
        assert found.plan.trajectory.duration > free.plan.trajectory.duration
        assert told > 0.7 * limit  # no slower than it has to be
        # the checker, too, refuses the motion that pulls harder
        fast = check(scene, free.plan)
        assert {finding.code for finding in fast.findings} == {Finding.RATE}


def test_where_no_slower_motion_is_in_time_the_limit_is_told() -> None:
    scene = holding(1.0, latest_end_s=0.8)
    assert isinstance(plan(replace(scene, carry_acceleration=None)), Planned)
    found = plan(scene)
    assert isinstance(found, NotPlanned)
    lines = [line.refusal for line in found.census.lines if line.refusal.reason is Reason.CARRY_LIMIT]
    assert lines
    assert isinstance(lines[0].facts, Carrying)
    assert lines[0].facts.limit == 1.0
    assert not any(line.refusal.stage == "checker" for line in found.census.lines)
