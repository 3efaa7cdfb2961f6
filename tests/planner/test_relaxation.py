"""Relaxations: the first change of the list that works is named, and works when it is applied."""

from __future__ import annotations

import math
import re
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from assur.api.cli.console_report import CHANGED
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import box, cylinder
from assur.planner.laws import conveyor, fixed, turntable
from assur.planner.laws.law import PoseUncertainty
from assur.planner.model.outcome import NotPlanned, Planned
from assur.planner.model.path import LineTo, Path
from assur.planner.model.refusal import Bodies, Enclosed, Reason, Refusal, Separation, Stage, law_ends
from assur.planner.model.scene import (
    Clearance,
    ClearanceException,
    Execution,
    Follow,
    Pick,
    Place,
    Scene,
    Step,
    Target,
    Trace,
    Window,
)
from assur.planner.pipeline import plan
from assur.planner.relaxation.changes import LAST_M, changes, contact_tolerances
from assur.planner.relaxation.kinds import worth_trying
from assur.planner.relaxation.trying import _attempt, _narrowed, relax
from assur.planner.search.beam import Search, SearchResult
from tests.docs.pages import ROOT
from tests.planner.cells import CUP, Around, arm, at, belt_and_dial, cell, frame, go, solid, stands, table_to_table
from tests.planner.five_axis_cells import aim, five_axis_cell, goes

FAST = frame("belt", conveyor(Pose(-0.3, 0.35), 0.5))
EXPLAIN: dict[str, Any] = {"explain_budget_s": 60.0, "max_candidates": 40, "budget_s": 60.0}


def follow(duration: float, window: tuple[float, float]) -> Scene:
    return cell(Follow("f", at(0.0, 0.0, 0.1, 0.0, "belt"), duration, Window(along=window)), frames=(FAST,), **EXPLAIN)


def behind_the_base(**more: Any) -> Scene:
    return cell(go(-0.35, -0.2), q=(-2.0, 1.2, 0.2, 0.0), **{**EXPLAIN, **more})


def high(approach: float, depart: float) -> Scene:
    """The lift leaves 130 mm above the part."""
    pick = Pick("pick", "part", Pose(z=0.01), approach, 0.05, depart)
    scene = table_to_table(**EXPLAIN)
    return replace(scene, task=(pick, *scene.task[1:]))


def post_beside(**more: Any) -> Scene:
    """A post 4 mm beside the quill at the point, where 6 mm are asked."""
    post = stands("post", cylinder(0.03, 0.2), 0.35 + 0.042 + 0.004, -0.2, 0.12)
    return cell(go(0.35, -0.2), bodies=(post,), **{"clearance": Clearance(0.006, 0.0), **EXPLAIN, **more})


def table(**more: Any) -> Scene:
    """A part on a table, to be put on another one."""
    return table_to_table(**{**EXPLAIN, **more})


def two_places(by: float) -> Scene:
    """A part that is put down twice on the other table, so much, m, too low."""
    again = Pick("again", "part", Pose(z=0.01), 0.03, 0.05, 0.04)
    beside = Place("beside", "part", Target("world", Pose(0.31, -0.29, 0.05, -0.4)), 0.03, 0.05, 0.03)
    return lowered(lowered(table_to_table(again, beside, **EXPLAIN), 1, by), 3, by)


def with_pick(scene: Scene, **changed: Any) -> Scene:
    """The scene with a pick, its first step, of which something is changed."""
    pick = scene.task[0]
    assert isinstance(pick, Pick)
    return replace(scene, task=(replace(pick, **changed), *scene.task[1:]))


def lowered(scene: Scene, step: int, by: float) -> Scene:
    """The scene with the point of a step lower by so much, m."""
    what: Step = scene.task[step]
    if isinstance(what, Pick):
        what = replace(what, grasp=replace(what.grasp, z=what.grasp.z - by))
    elif isinstance(what, Place):
        what = replace(what, to=replace(what.to, pose=replace(what.to.pose, z=what.to.pose.z - by)))
    return replace(scene, task=(*scene.task[:step], what, *scene.task[step + 1 :]))


def soft_place(scene: Scene) -> Scene:
    """The scene with a pick that allows its contacts 1 mm, so that the place is what is refused."""
    return with_pick(scene, contact_tolerance_m=1e-3)


def short_approach() -> Scene:
    """The cup must be 60 mm from the table in travel, and is 50 mm above it where the approach begins."""
    rule = ClearanceException(frozenset(("cup",)), frozenset(("left-table",)), 0.06, 0.0)
    return with_pick(table(clearance=Clearance(0.004, 0.0005, (rule,))), depart_m=0.05)


def two_posts() -> Scene:
    """A post on either side of the quill, each too near."""
    posts = (stands(name, cylinder(0.03, 0.2), 0.35 + side * 0.046, -0.2, 0.12) for name, side in (("a", 1), ("b", -1)))
    return cell(go(0.35, -0.2), bodies=tuple(posts), clearance=Clearance(0.006, 0.0), **EXPLAIN)


def round_a_wall() -> Scene:
    """A wall that no lift goes over; it cannot be left out, for the pick names it."""
    scene = table(max_candidates=2, seed=0, clearance=Clearance())
    wall = stands("wall", box(0.32, 0.02, 1.0), 0.53, 0.0, 0.5)
    return with_pick(replace(scene, bodies=(*scene.bodies, wall)), contact_with=("left-table", "wall"))


def beside_the_start() -> Scene:
    """A post 4 mm beside the quill where the arm starts, where 6 mm are required."""
    (x, y, _), _ = arm().forward(np.array((0.3, 1.2, 0.2, 0.0)))
    post = stands("post", cylinder(0.03, 0.2), float(x) + 0.046, float(y), 0.12)
    return cell(go(0.35, -0.2), bodies=(post,), clearance=Clearance(0.006, 0.0), **EXPLAIN)


def corner(blend: float, speed: float, **more: Any) -> Scene:
    """A trace round a corner."""
    path = Path((0.0, 0.0, 0.05), (LineTo((0.05, 0.0, 0.05)), LineTo((0.05, 0.05, 0.05))), blend)
    step = Trace("bead", Target("plate", Pose(z=0.05)), path, speed, 0.03, 0.03)
    plate = frame("plate", fixed(Pose(0.3, 0.1, 0.06)))
    options = {**EXPLAIN, "max_candidates": 24, "singularity_margin": 0.0, **more}
    return cell(step, frames=(plate,), tool=CUP, **options)


def fast_pick() -> Scene:
    """A part on a belt that is quicker than the arm."""
    scene = belt_and_dial(**EXPLAIN)
    belt = replace(scene.frames["belt"], law=conveyor(Pose(0.0, 0.4, 0.05), 1.5))
    return with_pick(replace(scene, frames={**scene.frames, "belt": belt}), window=Window(along=(-0.3, 0.25)))


def fast_dial() -> Scene:
    dial = frame("dial", turntable(Pose(0.35, 0.0), 20.0))
    return cell(go(0.15, 0.0, frame="dial"), frames=(dial,), **EXPLAIN)


def law_that_ends() -> Scene:
    ends = frame("belt", conveyor(Pose(0.1, 0.3, 0.1), 0.1, valid=(0.0, 1.2)))
    return cell(Follow("f", at(0.0, 0.0, 0.1, 0.0, "belt"), 1.5), frames=(ends,), **EXPLAIN)


def out_at_a_pitch() -> Scene:
    """A point that a hand which points down does not reach."""
    return five_axis_cell(goes(aim(0.46, 0.0, 0.25, pitch=-math.pi / 2)), explain_budget_s=60.0)


def into_a_table() -> Scene:
    """A cup that would be 5 mm deep in a table."""
    return cell(
        go(0.35, -0.2, 0.095), bodies=(stands("table", box(0.2, 0.2, 0.04), 0.35, -0.2, 0.08),), tool=CUP, **EXPLAIN
    )


def loose(scene: Scene, by: float) -> Scene:
    """The scene with a part that may lie so much higher or lower, m."""
    bodies = (replace(each, uncertainty=PoseUncertainty(vertical_m=by)) if each.name == "part" else each
              for each in scene.bodies)  # fmt: skip
    return replace(scene, bodies=tuple(bodies))


LAGS = Execution(lag=(0.0, 0.0, 2e-4, 0.0))
"""The lift may be 0.2 mm from where it is planned."""
CASES: dict[str, tuple[Callable[[], Scene], str, str]] = {
    "a window too short": (lambda: follow(0.1, (0.2, 0.22)), "window", "to 250 mm, 30 mm farther"),
    "an elbow kept": (lambda: next(s for s in (_elbow("left"), _elbow("right")) if refused(s)), "elbow", "auto"),
    "a clearance too large": (post_beside, "pair clearance", "quill and post: travel 3.9 mm, near 0 mm"),
    "a latest end too soon": (lambda: cell(go(0.35, -0.2), latest_end_s=0.15, **EXPLAIN), "latest end", "0.409 s, 259"),
    "an approach above the lift": (lambda: high(approach=0.3, depart=0.04), "heights", "approach 60 mm"),
    "a depart above the lift": (lambda: high(approach=0.04, depart=0.24), "heights", "depart 120 mm"),
    "both above the lift": (lambda: high(approach=0.24, depart=0.24), "heights", "approach 120 mm, depart 120 mm"),
    "a body in the way": (
        lambda: cell(
            go(0.3, -0.4),
            bodies=(stands("wall", box(2.0, 0.02, 1.0), 1.1, -0.1, 0.3),),
            q=(1.2, 0.4, 0.2, 0.0),
            elbow="auto",
            singularity_margin=0.0,
            **EXPLAIN,
        ),
        "without",
        "wall",
    ),
    "an acceleration time too short": (
        lambda: cell(go(0.35, -0.2), timing="parabolic_blend", acceleration_time_s=0.02, **EXPLAIN),
        "acceleration time",
        "left to the planner",
    ),
    "too few candidates": (round_a_wall, "budget", "8 candidates in 60 s"),
    "a pitch that does not reach": (out_at_a_pitch, "pitch", "free"),
    "a dial too fast to be met": (fast_dial, "match", "position"),
    "a process speed too high": (lambda: corner(1e-3, 0.3), "process speed", "60 mm/s"),
    "a corner too sharp, and no time": (lambda: corner(1e-3, 0.15, latest_end_s=1.85), "blend", "2 mm"),
    "a law that ends too soon": (law_that_ends, "dwell", "900 ms"),
    "a belt too fast": (fast_pick, "belt speed", "750 mm/s"),
    "two bodies too near": (two_posts, "clearance", "travel 3 mm, near 0 mm"),
    "a start too near a body": (beside_the_start, "pair clearance", "quill and post: travel 3.9 mm, near 0 mm"),
    "an approach too short": (short_approach, "straight part", "approach 40.1 mm"),
    "a place too low": (lambda: lowered(table(), 1, 0.01), "point height", "10 mm higher"),
    "a grasp too low": (lambda: lowered(table(), 0, 0.003), "point height", "3 mm higher"),
    "a place too low on a dial": (lambda: lowered(belt_and_dial(**EXPLAIN), 1, 0.004), "point height", "4 mm higher"),
    "two places too low": (lambda: two_places(0.005), "place heights", "5 mm higher, all 2 places of this height"),
    "a move too low": (into_a_table, "point height", "5.1 mm higher"),
    "a lift that lags": (lambda: table(execution=LAGS), "contact tolerance", "0.6 mm at each pick and place"),
    "a lift that lags at a place": (
        lambda: soft_place(table(execution=LAGS)),
        "contact tolerance",
        "0.7 mm at each pick and place",
    ),
    "a part that lies higher or lower": (
        lambda: loose(table(), 3e-4),
        "contact tolerance",
        "0.3 mm at each pick and place",
    ),
    "a margin too large": (
        lambda: cell(Follow("f", at(0.599, 0.0), 0.1), singularity_margin=0.2, **EXPLAIN),
        "singularity margin",
        "0",
    ),
}


def _elbow(mode: str) -> Scene:
    return behind_the_base(elbow=mode)


def refused(scene: Scene) -> bool:
    return isinstance(plan(replace(scene, options=replace(scene.options, explain_budget_s=0.0))), NotPlanned)


def applied(scene: Scene, what: str, value: str, step: int, blocker: str | None, refusal: Refusal | None) -> Scene:
    """The scene with the change of that name; of a window and of the latest end, with the number that is told."""
    if what == "latest end":
        return replace(scene, options=replace(scene.options, latest_end_s=float(value.split(maxsplit=1)[0])))
    if what == "window":
        along = scene.task[step].window.along
        assert along is not None
        wider = Window(along=(along[0], float(value.removeprefix("to ").split()[0]) / 1e3))
        return replace(scene, task=(replace(scene.task[step], window=wider), *scene.task[1:]))
    for name, text, changed in changes(scene, step, blocker, refusal):
        if name == what and text == value:
            return changed
    raise AssertionError(f"{what} {value} is no change")


@pytest.mark.parametrize("name", sorted(CASES))
def test_the_first_change_that_works_is_named_and_works_when_applied(name: str) -> None:
    make, what, value = CASES[name]
    scene = make()
    outcome = plan(scene)
    assert isinstance(outcome, NotPlanned)
    assert outcome.relaxation is not None, (outcome.sentence, outcome.tried)
    assert outcome.relaxation.what == what
    assert outcome.relaxation.value.startswith(value)
    assert outcome.refusal is not None
    blocker, step = value if what == "without" else None, outcome.refusal.step
    again = applied(scene, what, outcome.relaxation.value, step, blocker, outcome.refusal)
    relaxed = plan(replace(again, options=replace(again.options, stop="first")))
    assert isinstance(relaxed, Planned)
    assert relaxed.plan.trajectory.duration == pytest.approx(outcome.relaxation.duration_s, abs=0.5)
    assert f"{what}: {outcome.relaxation.value}" in outcome.tried


def test_each_kind_of_change_is_the_one_that_helps_somewhere_and_is_on_the_page() -> None:
    """The kinds that are tried, those that the page lists, and those for which there are words are the same."""
    page = (ROOT / "docs" / "api.md").read_text(encoding="utf-8")
    table_ = page.split("### What would have helped")[1].split("### ")[0]
    rows = (row.split("|")[1] for row in table_.splitlines() if row.startswith("| `"))
    told = {kind for row in rows for kind in re.findall(r"`([a-z ]+)`", row)} - {"what"}
    assert {what for _, what, _ in CASES.values()} == told == CHANGED.keys()


@pytest.mark.parametrize(
    ("scene", "smaller"),
    [
        (post_beside(clearance=Clearance(0.00402, 0.0)), True),
        (post_beside(clearance=Clearance(0.00398, 0.0)), False),
        (follow(0.1, (0.2, 0.249)), True),
        (follow(0.1, (0.2, 0.25)), False),
    ],
)
def test_what_is_told_to_be_enough_is_little_more_than_is_needed(scene: Scene, smaller: bool) -> None:
    """The post is 4 mm from the quill; the belt moves 50 mm in the time of the follow."""
    assert refused(scene) is smaller


def test_the_strongest_change_of_a_kind_is_tried_first_and_rules_out_the_others() -> None:
    outcome = plan(post_beside())
    assert isinstance(outcome, NotPlanned)
    assert outcome.tried == (
        "pair clearance: quill and post: travel 0 mm, near 0 mm",
        "pair clearance: quill and post: travel 3.9 mm, near 0 mm",
    )
    outcome = plan(replace(high(0.24, 0.24), start=replace(high(0.24, 0.24).start, time=0.0)))
    assert isinstance(outcome, NotPlanned)
    # no clearance, no body: the joint's range alone is in the way
    assert {text.split(":")[0] for text in outcome.tried} == {"heights"}
    assert outcome.tried[0] == "heights: approach 48 mm, depart 48 mm"
    assert outcome.tried[-1] == "heights: approach 120 mm, depart 120 mm"


def test_the_clearance_of_a_pair_is_that_of_the_exception_that_names_it() -> None:
    """6 mm for the post alone: less for the quill and the post is proposed, and the rule of all stays as it is."""
    rule = ClearanceException(frozenset(("post",)), frozenset(), 0.006, 0.0)
    scene = post_beside(clearance=Clearance(0.001, 0.001, (rule,)))
    outcome = plan(scene)
    assert isinstance(outcome, NotPlanned)
    assert outcome.relaxation is not None
    told = (outcome.relaxation.what, outcome.relaxation.value)
    assert told == ("pair clearance", "quill and post: travel 3.9 mm, near 0 mm")
    changed = applied(scene, *told, 0, None, outcome.refusal).options.clearance
    first, own = changed.exceptions
    assert (changed.travel_m, changed.near_m, first) == (0.001, 0.001, rule)
    assert (set(own.first), set(own.second), own.near_m) == ({"quill"}, {"post"}, 0.0)
    assert own.travel_m == pytest.approx(0.0039, abs=1e-12)


def test_what_the_refusal_is_about_comes_first() -> None:
    scene = belt_and_dial(elbow="keep", clearance=Clearance(0.004, 0.001), latest_end_s=9.0)
    firsts = {
        Reason.BODY_COLLISION: "clearance",
        Reason.WINDOW_MISSED: "latest end",
        Reason.JOINT_LIMIT: "elbow",
        Reason.NEAR_SINGULARITY: "singularity margin",
    }
    for reason, first in firsts.items():
        listed = [
            each[0]
            for each in changes(
                scene, 0, "belt-bed", Refusal(stage=Stage.TIMING, reason=reason, step=0, facts=Enclosed())
            )
        ]
        assert listed[0] == first
        assert sorted(listed) == sorted(what for what, _, _ in changes(scene, 0, "belt-bed"))


@pytest.mark.parametrize(("gap_m", "proposed"), [(-0.0019, True), (-0.0021, False)])
def test_no_contact_is_proposed_that_is_deeper_than_a_gripper_gives_way(gap_m: float, proposed: bool) -> None:
    facts = Separation(touching=True, gap_m=gap_m, required_m=-1e-4, rule="contact", clearance_m=-1e-4)
    found = list(contact_tolerances(table(), 0, replace(facts, required_m=0.0)))
    assert bool(found) is proposed


def test_a_search_that_could_only_repeat_what_failed_is_not_tried() -> None:
    """Half of two seconds is no more than the budget that was spent already."""
    scene = post_beside(max_candidates=None, budget_s=1.0)
    tried: list[str] = []
    (budget,) = (each for each in changes(scene, 0, None) if each[0] == "budget")
    assert _attempt(budget, time.perf_counter() + 2.0, tried, Search, None) is None
    assert tried == []


def test_changes_come_in_the_order_of_a_shop_and_never_touch_the_robot() -> None:
    scene = belt_and_dial(elbow="keep", clearance=Clearance(0.004, 0.001), singularity_margin=0.1)
    scene = replace(scene, task=(replace(scene.task[0], window=Window(along=(0.0, 0.2))), *scene.task[1:]))
    order = [
        "window",
        "budget",
        "elbow",
        "heights",
        "dwell",
        "belt speed",
        "clearance",
        "singularity margin",
        "without",
    ]
    seen = [what for what, _, _ in changes(scene, 0, "belt-bed")]
    assert list(dict.fromkeys(seen)) == order
    for _, _, changed in changes(scene, 0, "belt-bed"):
        assert changed.robot is scene.robot
        assert changed.start is scene.start
        assert changed.execution == scene.execution
        assert all(changed.frames[name].uncertainty == frame_.uncertainty for name, frame_ in scene.frames.items())


def test_every_change_is_a_smaller_demand() -> None:
    scene = belt_and_dial(elbow="keep", clearance=Clearance(0.004, 0.001), singularity_margin=0.1)
    for what, _, changed in changes(scene, 0, None):
        step, before = changed.task[0], scene.task[0]
        assert isinstance(step, Pick)
        assert isinstance(before, Pick)
        assert step.approach_m <= before.approach_m
        assert step.depart_m <= before.depart_m
        assert (step.approach_m, step.depart_m) != (before.approach_m, before.depart_m) or what != "heights"
        options, old = changed.options, scene.options
        assert options.clearance.travel_m <= old.clearance.travel_m
        assert options.clearance.near_m <= old.clearance.near_m
        assert options.singularity_margin <= old.singularity_margin
        assert options.budget_s >= old.budget_s
        assert options.max_candidates is not None
        assert old.max_candidates is not None
        assert options.max_candidates >= old.max_candidates
        if what == "dwell":
            assert isinstance(changed.task[0], Pick)
            assert 0 < changed.task[0].dwell_s < 0.08
        if what == "belt speed":
            law = changed.frames["belt"].law
            assert 0 < law.numbers.speed < 0.25


def test_a_part_and_what_the_task_names_are_never_left_out() -> None:
    scene = table_to_table()
    assert "without" not in [what for what, _, _ in changes(scene, 0, "part")]
    assert isinstance(scene.task[0], Pick)
    named = replace(scene.task[0], contact_with=("left-table",))
    asked = replace(scene, task=(named, *scene.task[1:]))
    assert "without" not in [what for what, _, _ in changes(asked, 0, "left-table")]
    assert "without" in [what for what, _, _ in changes(scene, 0, "left-table")]


def test_only_a_running_belt_can_be_slowed_down() -> None:
    assert "belt speed" not in [what for what, _, _ in changes(table_to_table(), 0, None)]
    placed = replace(belt_and_dial(), options=replace(belt_and_dial().options, elbow="auto"))
    assert "belt speed" not in [what for what, _, _ in changes(placed, 1, None)]


def test_nothing_is_tried_without_a_budget_for_it_or_where_nothing_could_help() -> None:
    silent = plan(post_beside(explain_budget_s=0.0))
    assert isinstance(silent, NotPlanned)
    assert silent.tried == ()
    assert silent.relaxation is None
    for reason in Reason:
        hopeless = reason in (Reason.START_IN_COLLISION, Reason.LAW_ENDS, Reason.LOAD_LIMIT, Reason.FORBIDDEN_YAW)
        assert worth_trying(Refusal(stage=Stage.TIMING, reason=reason, step=0, facts=Enclosed())) is not hopeless
    for tracked in (None, 0.8):
        ends = law_ends(Stage.WINDOW, 0, "belt", (0.0, 0.5), 0.8, tracked=tracked)
        assert worth_trying(ends) is (tracked is not None)


def test_of_a_law_that_ends_too_soon_only_what_needs_less_of_it_is_tried() -> None:
    late = plan(law_that_ends())
    assert isinstance(late, NotPlanned)
    assert (late.reason, late.proved) == (Reason.LAW_ENDS, True)
    assert not {tried.split(":")[0] for tried in late.tried} - {"dwell", "window", "latest end"}


def test_a_spent_budget_is_said() -> None:
    found, tried, spent = relax(post_beside(), 0, None, time.perf_counter() - 1.0, search=Search)
    assert found is None
    assert tried == ()
    assert spent


def test_a_place_can_be_told_to_dwell_less() -> None:
    scene = belt_and_dial()
    shorter = [changed.task[1] for what, _, changed in changes(scene, 1, None) if what == "dwell"]
    assert all(isinstance(step, Place) and step.dwell_s < 0.06 for step in shorter)
    assert shorter


def test_where_nothing_works_everything_that_was_tried_is_listed() -> None:
    fence = tuple(
        Around(solid(name, box(2.0, 0.02, 1.0)), "world", Pose(1.1, y, 0.3)) for name, y in (("a", -0.1), ("b", -0.15))
    )
    scene = cell(go(0.3, -0.4), bodies=fence, q=(1.2, 0.4, 0.2, 0.0), tool=CUP, **{**EXPLAIN, "max_candidates": 12})
    outcome = plan(scene)
    assert isinstance(outcome, NotPlanned)
    assert outcome.relaxation is None
    assert [text.split(":")[0] for text in outcome.tried] == [
        "without",
        "budget",
        "match",
        "singularity margin",
    ]


def test_the_target_of_a_place_names_its_own_belt() -> None:
    onto = Place("put", "part", Target("belt", Pose(0.1, 0.0, 0.01)), 0.02, 0.05, 0.02)
    scene = belt_and_dial()
    scene = replace(scene, task=(scene.task[0], onto))
    assert "belt speed" in [what for what, _, _ in changes(scene, 1, None)]


@pytest.mark.parametrize("gone_after_s", [None, 9.0])
def test_nothing_is_put_on_a_part_that_somebody_takes_away(gone_after_s: float | None) -> None:
    """Where it is still there, it helps to wait, not to put the next part on it."""
    scene = two_places(0.0)
    pick, first, again, second = scene.task
    assert isinstance(pick, Pick)
    assert isinstance(first, Place)
    there = replace(scene.bodies[0], body=replace(scene.index["part"].body, name="other"), pose=Pose(1.0, 1.0, 1.0))
    task = (replace(pick, part="other"), replace(first, part="other", gone_after_s=gone_after_s), again, second)
    made = replace(scene, bodies=(*scene.bodies, there), task=task)
    facts = Separation(touching=False, rule="contact", gap_m=-0.02, required_m=0.0)
    about = Bodies(("part", "other"))
    why = Reason.CONTROL_POINT_IN_COLLISION
    refusal = Refusal(stage=Stage.CONTROL_POINT, reason=why, step=3, subject=about, facts=facts)
    kinds = {kind for kind, _, _ in changes(made, 3, "other", refusal)}
    assert ("point height" in kinds) is (gone_after_s is None)
    assert ("place heights" in kinds) is (gone_after_s is None)


def test_a_window_is_changed_for_all_picks_that_have_it_and_for_no_other_step() -> None:
    own, other = Window(along=(0.0, 0.2)), Window(along=(0.0, 0.3))
    scene = with_pick(belt_and_dial(), window=own)
    pick, place = scene.task
    follows = Follow("f", at(0.0, 0.0, 0.1, 0.0, "belt"), 0.1, own)
    scene = replace(scene, task=(pick, place, replace(pick, window=other), place, follows, pick))
    for step, same in ((0, [0, 5]), (5, [0, 5]), (2, [2]), (4, [4])):
        every = ", all 2 picks of this window" if len(same) == 2 else ""
        windows = [(value, changed) for what, value, changed in changes(scene, step, None) if what == "window"]
        assert [value for value, _ in windows] == [f"without its end{every}", f"removed{every}", "all 4 removed"]
        assert {each.window for each in windows.pop()[1].task} == {Window()}
        for _, changed in windows:
            wider = [i for i, each in enumerate(changed.task) if each is not scene.task[i]]
            assert wider == same
            assert len({changed.task[i].window for i in same}) == 1


def test_a_window_that_the_search_needs_wider_than_its_plan_is_proposed_as_a_multiple() -> None:
    """The plan without an end uses 30 mm more than the window has: so much is tried, then twice and four times as much,
    as where another approach of the same point takes longer."""
    scene = follow(0.1, (0.2, 0.22))
    change = next(each for each in changes(scene, 0, None) if each[0] == "window")
    made = plan(change[2])
    assert isinstance(made, Planned)
    found = [each.task[0].window.along for _, _, each in _narrowed(scene, change, made.plan)]
    assert found == [pytest.approx((0.2, end)) for end in (0.25, 0.28, 0.34)]


class SpentAtAnEnd(Search):
    """A search whose time is spent where the window of the first step has an end that counts."""

    def run(self) -> SearchResult:
        along = self.scene.task[0].window.along
        if along is None or along[1] == LAST_M:
            return super().run()
        self.found.cut_by_clock = True
        return self.found


def test_no_end_is_proposed_that_is_as_good_as_none() -> None:
    """Where the time ends before an end was found that suffices, the window is removed: that was tried."""
    scene = follow(0.1, (0.2, 0.22))
    found, tried, _ = relax(scene, 0, None, time.perf_counter() + 60.0, search=SpentAtAnEnd)
    assert found is not None
    assert (found.what, found.value, found.scene.task[0].window) == ("window", "removed", Window())
    assert tried == ("window: removed", "window: without its end")
