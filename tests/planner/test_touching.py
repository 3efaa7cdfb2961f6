"""How far a tool is from the part that it takes, and a part from what it is put down on: measured, told, and refused
where a step asks for less."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from assur.planner.checked import check
from assur.planner.checker.verdict import Code
from assur.planner.collision.proof import Prover
from assur.planner.collision.touching import TOUCH_M, apart, grip, nearest_support
from assur.planner.errors import InputError
from assur.planner.feasibility.hits import never_touching
from assur.planner.feasibility.input_warnings import OFF_M, unusual_supports
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import box, cylinder, sphere
from assur.planner.laws import conveyor
from assur.planner.model.attachments import AT_START, at_start
from assur.planner.model.input_warning import WarningKind
from assur.planner.model.outcome import NotPlanned, Planned
from assur.planner.model.phases import yaw_offsets
from assur.planner.model.refusal import NotTouching, Reason, Stage
from assur.planner.model.scene import Pick, Place, Scene, Tool
from assur.planner.pipeline import plan
from assur.planner.report.notes import warned
from assur.planner.report.refusal_words import because
from tests.planner.cells import BARE, frame, solid, table_to_table
from tests.planner.checker.hand_made import sealed
from tests.planner.test_input_warnings import gripped, placed

FINGER = Tool(Pose(z=-0.06), (solid("finger", box(0.01, 0.01, 0.06), 0.06, 0.0, -0.03),))
"""One finger 60 mm beside the axis, so that the turn of the tool counts."""


def asking(scene: Scene, grip_m: float = math.inf, support_m: float = math.inf) -> Scene:
    """The same pick and place, which ask for so much."""
    pick, place = scene.task
    assert isinstance(pick, Pick)
    assert isinstance(place, Place)
    place = replace(place, contact_with=("right-table",), support_within_m=support_m)
    return replace(scene, task=(replace(pick, grip_within_m=grip_m), place))


def told(scene: Scene) -> Planned:
    outcome = plan(scene)
    assert isinstance(outcome, Planned)
    return outcome


def refusal(scene: Scene) -> NotPlanned:
    outcome = plan(scene)
    assert isinstance(outcome, NotPlanned)
    return outcome


def lopsided(offset: float) -> Scene:
    """A part of 60 x 30 x 20 mm, 15 mm beside its own origin, that any half turn may grip, and a finger on one side
    of the tool."""
    scene = table_to_table(fold=2, tool=FINGER)
    lies = solid("part", box(0.06, 0.03, 0.02), 0.015)
    bodies = tuple(replace(each, body=lies) if each.name == "part" else each for each in scene.bodies)
    scene = replace(scene, bodies=bodies)
    pick = scene.task[0]
    assert isinstance(pick, Pick)
    return replace(scene, task=(replace(pick, grasp=Pose(offset, 0.0, 0.02)),))


@pytest.mark.parametrize("up", [0.0, 0.0004, 0.012, 0.05])
def test_a_grip_above_the_part_is_as_far_as_the_cup_is_above_it(up: float) -> None:
    pick, place = told(gripped(0.0, up)).plan.arrivals
    assert pick.grip_m == pytest.approx(up, abs=1e-9)
    assert (pick.support_m, place.grip_m) == (None, None)
    assert place.support_m == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("by", [0.0, 0.003, 0.1])
def test_a_support_is_as_far_as_the_part_is_above_it(by: float) -> None:
    _, place = told(placed(by, contact_with=("right-table",))).plan.arrivals
    assert place.support_m == pytest.approx(by, abs=1e-9)


def test_of_several_supports_the_nearest_counts_and_of_none_there_is_no_distance() -> None:
    _, place = told(placed(0.02, contact_with=("left-table", "right-table"))).plan.arrivals
    assert place.support_m == pytest.approx(0.02, abs=1e-9)
    assert [arrival.support_m for arrival in told(placed(0.02)).plan.arrivals] == [None, None]
    assert [arrival.support_m for arrival in told(placed(0.02, contact_with=())).plan.arrivals] == [None, None]
    bare = table_to_table(tool=BARE)
    pick = bare.task[0]
    assert isinstance(pick, Pick)
    assert grip(Prover(bare), pick, at_start(bare), 0.0) is None


def test_bodies_that_overlap_are_at_no_distance() -> None:
    """The cup is 5 mm inside the part."""
    scene = gripped(0.0, -0.005)
    pick = scene.task[0]
    assert isinstance(pick, Pick)
    found = grip(Prover(scene), pick, at_start(scene), 0.0)
    assert found is not None
    assert found.distance_m == 0.0
    assert found.bodies == ("cup", "part")


def test_a_distance_is_that_of_the_nearest_points_of_round_and_of_flat_bodies() -> None:
    """Against distances that are known in closed form: box to ball at an edge, cylinder to cylinder beside it."""
    rng = np.random.default_rng(5)
    for _ in range(20):
        x, z = rng.uniform(0.06, 0.3, 2).tolist()
        ball = table_to_table(shape=sphere(0.02), tool=Tool(Pose(), (solid("cube", box(0.04, 0.04, 0.04)),)))
        pick = ball.task[0]
        assert isinstance(pick, Pick)
        found = grip(Prover(ball), replace(pick, grasp=Pose(x, 0.0, z)), at_start(ball), 0.0)
        assert found is not None
        assert found.distance_m == pytest.approx(math.hypot(x - 0.02, z - 0.02) - 0.02, abs=1e-8)
        rod = table_to_table(shape=cylinder(0.01, 0.1), tool=Tool(Pose(), (solid("rod", cylinder(0.03, 0.1)),)))
        pick = rod.task[0]
        assert isinstance(pick, Pick)
        found = grip(Prover(rod), replace(pick, grasp=Pose(x, z, 0.0)), at_start(rod), 0.0)
        assert found is not None
        assert found.distance_m == pytest.approx(math.hypot(x, z) - 0.04, abs=1e-6)


def test_the_turn_in_which_a_part_is_gripped_counts() -> None:
    """The finger is beside the part's far end in one turn, and beside its near end in the other."""
    scene = lopsided(-0.02)
    pick = scene.task[0]
    assert isinstance(pick, Pick)
    turns = yaw_offsets(scene, pick)
    assert turns is not None
    found = [grip(Prover(scene), pick, at_start(scene), turn) for turn in turns]
    distances = sorted(each.distance_m for each in found if each is not None)
    assert distances[1] - distances[0] > 0.005
    between = replace(scene, task=(replace(pick, grip_within_m=sum(distances) / 2),))
    (arrival,) = told(between).plan.arrivals
    assert arrival.grip_m == pytest.approx(distances[0])
    near = replace(pick, grip_within_m=distances[0] / 2)
    refused = refusal(replace(scene, task=(near,)))
    assert refused.proved
    assert isinstance(refused.refusal.facts if refused.refusal else None, NotTouching)


@pytest.mark.parametrize("more", [TOUCH_M / 2, 0.001, 1.0])
def test_what_is_near_enough_is_planned(more: float) -> None:
    scene = asking(gripped(0.0, 0.01), 0.01 + more, 0.0 + more)
    planned = told(scene)
    assert check(scene, planned.plan).ok
    assert planned.plan.arrivals[0].grip_m == pytest.approx(0.01)


def test_bodies_that_touch_are_near_enough_for_a_distance_of_nothing() -> None:
    scene = asking(table_to_table(), 0.0, 0.0)
    assert [(a.grip_m, a.support_m) for a in told(scene).plan.arrivals] == [(pytest.approx(0.0), None), (None, 0.0)]


@pytest.mark.parametrize(
    ("scene", "of", "step", "bodies", "words"),
    [
        (
            asking(gripped(0.0, 0.01), 0.009),
            "grip",
            0,
            ("cup", "part"),
            "the tool would be too far from part when it takes it: cup, its nearest body, is 10 mm away, and at most "
            "9 mm is allowed",
        ),
        (
            asking(placed(0.1), support_m=0.002),
            "support",
            1,
            ("part", "right-table"),
            "part would be too far from what it is put down on: right-table, the nearest, is 100 mm away, and at most "
            "2 mm is allowed",
        ),
    ],
    ids=["grip", "support"],
)
def test_what_is_too_far_is_refused_before_any_search(
    scene: Scene, of: str, step: int, bodies: tuple[str, str], words: str
) -> None:
    outcome = refusal(replace(scene, options=replace(scene.options, explain_budget_s=1.0)))
    assert (outcome.reason, outcome.proved, outcome.census.candidates) == (Reason.TOLERANCE, True, 0)
    found = outcome.refusal
    assert found is not None
    assert (found.stage, found.step, found.bodies) == (Stage.CONTROL_POINT, step, bodies)
    assert isinstance(found.facts, NotTouching)
    assert found.facts.of == of
    assert found.amount is not None
    assert found.amount.value == pytest.approx(found.facts.distance_m - found.facts.allowed_m)
    assert because(scene, found) == words
    assert (outcome.relaxation, outcome.tried) == (None, ())


def test_a_support_that_moves_against_the_place_is_measured_when_the_part_is_put_down() -> None:
    """A part put down on the table while a plate beside it travels on a belt: only a search knows when."""
    scene = asking(table_to_table(), support_m=0.001)
    belt = frame("belt", conveyor(Pose(0.35, -0.8, 0.1, math.pi / 2), 0.05))
    bodies = tuple(replace(b, frame="belt", pose=Pose()) if b.name == "right-table" else b for b in scene.bodies)
    moving = replace(scene, frames={**scene.frames, "belt": belt}, bodies=bodies)
    assert never_touching(moving, Prover(moving)) is None
    options = replace(moving.options, max_candidates=40, budget_s=60.0, stop="first")
    outcome = refusal(replace(moving, options=options))
    assert (outcome.reason, outcome.proved) == (Reason.TOLERANCE, False)
    assert outcome.refusal is not None
    assert outcome.refusal.stage is Stage.TRACKING
    free = replace(moving, task=asking(moving).task, options=options)
    planned = told(free)
    place, law = planned.plan.arrivals[1], belt.law
    away = float(law.motion(np.array(place.until)).p[1])
    assert place.support_m is not None
    assert place.support_m > 0.2
    step = free.task[1]
    assert isinstance(step, Place)
    found = nearest_support(Prover(free), step, at_start(free).after(free, free.task[0]), place.until)
    assert found is not None
    assert place.support_m == found.distance_m
    assert -0.8 < away < -0.6
    assert check(free, planned.plan).ok
    assert [(w.kind, w.amount_m) for w in planned.warnings] == [(WarningKind.SUPPORT_OFF_PART, place.support_m)]


def test_a_part_with_any_turn_is_refused_by_the_search_and_not_as_a_proof() -> None:
    scene = table_to_table(fold=0, max_candidates=50, budget_s=60.0)
    pick, place = scene.task
    assert isinstance(pick, Pick)
    high = replace(pick, grasp=replace(pick.grasp, z=0.05), grip_within_m=0.01)
    outcome = refusal(replace(scene, task=(high, place)))
    assert (outcome.reason, outcome.proved) == (Reason.TOLERANCE, False)


@pytest.mark.parametrize(
    ("scene", "field"),
    [
        (lambda: asking(table_to_table(tool=BARE), grip_m=0.001), "task[0].pick.grip_within_m"),
        (lambda: placed(0.0, support_within_m=0.001), "support_within_m"),
        (lambda: placed(0.0, support_within_m=0.001, contact_with=()), "support_within_m"),
    ],
    ids=["no tool", "no contact_with", "an empty contact_with"],
)
def test_what_cannot_be_measured_cannot_be_asked_for(scene: Any, field: str) -> None:
    with pytest.raises(InputError) as error:
        scene()
    assert error.value.field == field


@pytest.mark.parametrize("by", [OFF_M + 0.0005, 0.1])
def test_a_named_support_that_the_part_does_not_touch_is_told(by: float) -> None:
    scene = placed(by, contact_with=("right-table",))
    (warning,) = unusual_supports(scene, Prover(scene), ())
    assert (warning.kind, warning.bodies, warning.step) == (
        WarningKind.SUPPORT_OFF_PART,
        ("part", "right-table"),
        "place",
    )
    assert warning.amount_m == pytest.approx(by)
    words = f"part should touch right-table in step place, as contact_with says, but is {1e3 * by:.3g} mm away from it"
    assert warned(warning) == words


def test_every_named_support_is_told_of_picks_as_well_and_what_touches_is_not() -> None:
    scene = placed(0.0, contact_with=("left-table", "right-table"))
    pick, place = scene.task
    assert isinstance(pick, Pick)
    both = replace(scene, task=(replace(pick, contact_with=("right-table", "left-table")), place))
    found = unusual_supports(both, Prover(both), ())
    assert [(each.step, each.bodies[1]) for each in found] == [("pick", "right-table"), ("place", "left-table")]
    away = math.hypot(0.3, 0.1)  # no farther than the part's place is from the table's centre
    assert all(0.1 < each.amount_m < 1.0 and each.amount_m > away - 0.3 for each in found)
    near = placed(OFF_M - 0.0005, contact_with=("right-table",))
    assert unusual_supports(near, Prover(near), ()) == ()


def test_where_a_body_is_not_known_nothing_is_measured() -> None:
    scene = table_to_table()
    belt = frame("belt", conveyor(Pose(0.35, -0.3, 0.1), 0.05, valid=(5.0, 6.0)))
    bodies = tuple(replace(b, frame="belt", pose=Pose()) if b.name == "right-table" else b for b in scene.bodies)
    later = replace(scene, frames={**scene.frames, "belt": belt}, bodies=bodies)
    assert math.isnan(apart(Prover(later), AT_START, 0.0, "part", "right-table"))
    assert apart(Prover(later), AT_START, 5.5, "part", "right-table") > 0.0


def test_a_plan_that_is_farther_than_a_step_allows_is_refused_whatever_it_says() -> None:
    """The plan of a request that asks for nothing, as an answer to one that does."""
    free = asking(gripped(0.0, 0.02))
    made = told(free).plan
    silent = tuple(replace(arrival, grip_m=None, support_m=None) for arrival in made.arrivals)
    for arrivals in (made.arrivals, silent):
        for allowed, codes in ((0.019, [Code.NEAREST]), (0.021, [])):
            scene = asking(free, allowed)
            findings = check(scene, sealed(scene, replace(made, arrivals=arrivals))).findings
            assert [each.code for each in findings] == codes
    high = asking(placed(0.01))
    made = told(high).plan
    for allowed, codes in ((0.009, [Code.NEAREST]), (0.011, [])):
        scene = asking(high, support_m=allowed)
        assert [each.code for each in check(scene, sealed(scene, made)).findings] == codes
