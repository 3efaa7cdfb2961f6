"""The leading refusal, and the sentences that are made of facts."""

from __future__ import annotations

import math
import re
from dataclasses import MISSING, fields, replace
from enum import StrEnum
from itertools import product
from typing import Any, get_args, get_type_hints

import pytest

from assur.planner.geometry.shapes import cylinder
from assur.planner.laws.law import PoseUncertainty
from assur.planner.model.outcome import Census, CensusLine, Course, NotPlanned, Route
from assur.planner.model.refusal import (
    AccelerationTime,
    BeyondRange,
    Bodies,
    Carrying,
    Corrected,
    Enclosed,
    Facts,
    ForbiddenYaw,
    FrameName,
    Inaccurate,
    JointName,
    LawEnds,
    MotionLimit,
    NotTouching,
    Obstacle,
    OutOfReach,
    Overload,
    Overshoot,
    Quantity,
    Reason,
    Refusal,
    Refuted,
    Separation,
    Singular,
    Spot,
    Stage,
)
from assur.planner.model.scene import Clearance, ClearanceException, Follow, Window
from assur.planner.model.window_missed import Miss, WindowMissed
from assur.planner.pipeline import plan
from assur.planner.report.notes import note
from assur.planner.report.refusal_table import KINDS, PARTS, SENTENCES
from assur.planner.report.refusal_words import because, words_of
from assur.planner.report.sentence import sentence
from assur.planner.search.cause import most_frequent
from tests.planner.cells import at, cell, go, stands

SCENE = cell(go(0.35, 0.2, name="drop"), go(0.3, 0.0, name="home"))
NONE = Census(0, 0)
APART = Separation(touching=False, gap_m=0.001, required_m=0.013)
HIT = Separation(touching=True, gap_m=-0.001, required_m=0.011)
DEEP = "cup would hit gate: they would overlap by up to 1 mm, and the required distance is 11 mm"


def refusal(stage: Stage = Stage.SCREENING, reason: Reason = Reason.BODY_COLLISION, **more: Any) -> Refusal:
    facts: dict[str, Any] = {"step": 0, "subject": Bodies(("cup", "gate")), "interval": (1.0, 2.0), "facts": HIT}
    return Refusal(stage=stage, reason=reason, **{**facts, "amount": Quantity(0.012, "m"), **more})


def line(count: int, *arguments: Any, **more: Any) -> CensusLine:
    return CensusLine(refusal(*arguments, **more), count, 0.03)


def test_the_most_frequent_refusal_of_the_step_that_was_never_passed_leads() -> None:
    post = Bodies(("cup", "post"))
    census = Census(40, 40, (line(30, step=0), line(6, step=1), line(4, step=1, subject=post)))
    first, second = most_frequent(census, 0), most_frequent(census, 1)
    assert first is not None
    assert first.count == 30
    assert second is not None
    assert second.count == 6


def test_a_mode_that_is_not_reached_leads_only_where_nothing_else_was_tried() -> None:
    once = line(1, Stage.INVERSE, Reason.OUT_OF_REACH, subject=None, facts=OutOfReach(mode="left"))
    assert most_frequent(Census(20, 20, (line(20), once)), 0) == line(20)
    assert most_frequent(Census(0, 0, (once,)), 0) == once
    assert most_frequent(NONE, 0) is None


def said(refused: Refusal | CensusLine | None, census: Census = NONE, *, cut: bool = False) -> str:
    counted = refused if isinstance(refused, CensusLine) else None
    alone = refused.refusal if isinstance(refused, CensusLine) else refused
    return sentence(SCENE, alone, counted, census, cut=cut)


def test_a_sentence_names_the_step_the_bodies_the_count_and_the_time() -> None:
    found = said(line(30), Census(40, 40, (line(30),)))
    assert found.startswith(f"drop: {DEEP} (30 of 40 candidates, ")
    assert found.endswith(", between 1.00 s and 2.00 s).")
    before = said(line(30), Census(20, 12, (line(30),)))  # most of them were refused before there was a candidate
    assert "(30 times, also before there was a candidate, " in before
    at_once = said(line(30, interval=(1.0, 1.001)), Census(40, 40, (line(30),)))
    assert "at 1.00 s" in at_once
    assert "the budget of" in said(line(30), Census(40, 40, (line(30),)), cut=True)
    also = line(20, subject=Bodies(("cup", "post")))
    assert "; likewise cup with post (30 of" in said(line(30), Census(60, 50, (line(30), also)))


@pytest.mark.parametrize(
    ("facts", "told"),
    [
        (("travel", 0.005), "gap 1 mm, required 13 mm (clearance in travel 5 mm, uncertainty 8 mm)"),
        (("near", 0.013), "gap 1 mm, required 13 mm (clearance near a point 13 mm)"),
        (("exception", 0.002), "gap 1 mm, required 13 mm (clearance of the exception 2 mm, uncertainty 11 mm)"),
        ((None, None), "gap 1 mm, required 13 mm"),
    ],
)
def test_a_required_distance_is_told_with_what_it_is_made_of(facts: Any, told: str) -> None:
    apart = replace(APART, rule=facts[0], clearance_m=facts[1])
    assert because(SCENE, refusal(facts=apart)) == f"cup would come too close to gate: {told}"


def test_bodies_that_only_touch_have_no_gap_and_do_not_overlap() -> None:
    touching = replace(APART, touching=True, gap_m=-1e-12)
    assert because(SCENE, refusal(facts=touching)) == "cup would hit gate: gap 0 mm, required 13 mm"


@pytest.mark.parametrize(
    ("gap", "required", "said"),
    [
        (0.0099996, 0.01, "gap 9.9996 mm, required 10 mm"),
        (0.00999999996, 0.01, "gap 9.99999996 mm, required 10 mm"),
        (0.0093300, 0.0093333, "gap 9.33 mm, required 9.333 mm"),
        (0.0, 2e-7, "gap 0 mm, required less than 0.001 mm"),
        (1e-7, 2e-7, "gap 0.0001 mm, required 0.0002 mm"),
        (0.00687, 0.01, "gap 6.87 mm, required 10 mm"),
        (1.2345671, 1.2345679, "gap 1234.567 mm, required 1234.568 mm"),
        (-0.003, 0.003, "they would overlap by up to 3 mm, and the required distance is 3 mm"),
        (0.009999999999999988, 0.01, "gap 10 mm, required 10 mm, which differ by rounding only"),
        (-1e-17, 0.0, "gap 0 mm, required 0 mm, which differ by rounding only"),
    ],
)
def test_a_gap_that_is_less_than_required_is_shown_to_be_less(gap: float, required: float, said: str) -> None:
    near = replace(APART, gap_m=gap, required_m=required)
    assert because(SCENE, refusal(facts=near)) == f"cup would come too close to gate: {said}"


def test_an_allowed_contact_that_is_too_deep_is_told_with_what_is_allowed() -> None:
    deep = Separation(touching=True, gap_m=-0.003, required_m=-1e-4, rule="contact", clearance_m=-1e-4)
    assert (
        because(SCENE, refusal(facts=deep))
        == "cup would be pressed 3 mm into gate, but only 0.1 mm is allowed: a contact_tolerance_mm of the step allows "
        "more"
    )
    unsure = replace(deep, required_m=0.0019)
    more = "but only 0.1 mm is allowed: a contact_tolerance_mm of the step allows more"
    said = f"cup would be pressed 5 mm into gate (uncertainty 2 mm), {more}"
    assert because(SCENE, refusal(facts=unsure)) == said


COMPUTED = {"allowed", "behind", "carried", "late", "other", "pressed", "resting"}
"""Words that none of the refusals in `CASES` has; other tests have them."""
RULES = {
    "near": ((0.0, 0.006), "near"),
    "travel": ((0.006, 0.0), "travel"),
    "exception": ((0.0, 0.0), "exception"),
}


@pytest.mark.parametrize("name", sorted(RULES))
@pytest.mark.parametrize("off", [0.0, 0.002])
def test_the_rule_that_bound_is_that_of_the_phase_and_the_rest_is_what_is_not_known(name: str, off: float) -> None:
    """A post 4 mm beside the quill at a point that is followed, where 6 mm are asked, and it may be `off` nearer."""
    (travel, near), rule = RULES[name]
    post = stands("post", cylinder(0.03, 0.2), 0.35 + 0.042 + 0.004, -0.2, 0.12)
    post = replace(post, uncertainty=PoseUncertainty(off))
    exceptions = (ClearanceException(frozenset(("post",)), frozenset(), 0.006, 0.006),) if name == "exception" else ()
    step = go(0.35, -0.2) if name == "travel" else Follow("f", at(0.35, -0.2), 0.05)
    asked = Clearance(travel, near, exceptions)
    scene = cell(step, bodies=(post,), clearance=asked, max_candidates=30, budget_s=60.0)
    outcome = plan(scene)
    assert isinstance(outcome, NotPlanned)
    told = [line.refusal.facts for line in outcome.census.lines] + [outcome.refusal and outcome.refusal.facts]
    found = [each for each in told if isinstance(each, Separation)]
    assert found
    assert (rule, 0.006) in {(each.rule, each.clearance_m) for each in found}
    for each in found:
        assert each.clearance_m == (0.006 if each.rule == rule else 0.0)
        # what is found at rest, before any candidate, is where all is where it is planned
        assert any(each.required_m == pytest.approx(each.clearance_m + known, abs=1e-9) for known in (0.0, off))
    assert "clearance" in outcome.sentence


def test_what_no_candidate_refused_is_not_counted() -> None:
    late = WindowMissed(miss=Miss.CLOSED_ON_ARRIVAL)
    found = line(1, Stage.WINDOW, Reason.WINDOW_MISSED, subject=None, amount=Quantity(0.034, "s"), facts=late)
    assert said(found) == "drop: the arm comes at least 34 ms after the window has closed."


def test_a_step_without_a_window_misses_the_latest_end() -> None:
    late = Refusal(
        stage=Stage.TIMING,
        reason=Reason.WINDOW_MISSED,
        step=0,
        amount=Quantity(0.037, "s"),
        facts=WindowMissed(miss=Miss.NO_MEETING_LEFT),
    )
    scenes = {
        "latest_end_s": cell(go(0.35, 0.2, name="drop"), latest_end_s=1.0),
        "the window": cell(go(0.35, 0.2, name="drop", window=Window(time=(0.0, 0.1))), latest_end_s=1.0),
    }
    for name, scene in scenes.items():
        told = sentence(scene, late, None, NONE, cut=False)
        assert told == f"drop: the arm comes at least 37 ms too late for {name}."
    always = cell(go(0.35, 0.2, name="drop"))
    told = sentence(always, late, None, NONE, cut=False)
    assert told == "drop: the arm comes at least 37 ms too late to meet the point while it can be met."


def of(reason: Reason, facts: Facts, amount: Quantity | None = None, **more: Any) -> Refusal:
    subject: Any = {"bodies": Bodies(("cup", "gate")), "joint": JointName("j1"), "frame": FrameName("belt")}
    about = {Reason.JOINT_LIMIT: "joint", Reason.MOTION_LIMIT: "joint", Reason.LAW_ENDS: "frame"}
    return Refusal(
        **{"stage": Stage.INVERSE, "step": 1, "subject": subject[about.get(reason, "bodies")], **more},
        reason=reason,
        amount=amount,
        facts=facts,
    )


MARGINS: dict[str, Any] = {"margin": 0.03, "required": 0.1}
PLACE: Spot = {"path_m": 0.062, "path_part": "path", "path_at_m": (0.3, 0.0, 0.05)}
RANGE = ForbiddenYaw(first_rad=math.radians(-0.5), last_rad=math.radians(20), yaw_rad=math.radians(10))
CASES: list[tuple[Refusal, str]] = [
    (of(Reason.OUT_OF_REACH, OutOfReach(mode="left")), "the point is out of reach (mode left)"),
    (
        of(Reason.OUT_OF_REACH, OutOfReach(mode="left"), Quantity(0.0437, "m")),
        "the point stays at least 43.7 mm out of reach at all times at which it may be met (mode left)",
    ),
    (
        of(Reason.OUT_OF_REACH, OutOfReach(every_pitch=True), Quantity(0.0315, "m")),
        "the point is 31.5 mm out of reach at every pitch of the tool",
    ),
    (
        of(Reason.OUT_OF_REACH, OutOfReach(heights_m=(0.32, 0.3)), Quantity(0.02, "m")),
        "the point is 20 mm out of reach: the flange would have to be at a height of 320 mm, but it stays at 300 mm",
    ),
    (
        of(Reason.OUT_OF_REACH, OutOfReach(from_axis_m=0.7, pitch_rad=-math.pi / 2), Quantity(0.1, "m")),
        "the point is 100 mm out of reach: the flange would be 700 mm from the arm's axis, "
        "with the tool at a pitch of -90 deg",
    ),
    (of(Reason.OUT_OF_REACH, OutOfReach(), stage=Stage.STRAIGHT), "the straight line leaves the workspace"),
    (of(Reason.OUT_OF_REACH, OutOfReach(), stage=Stage.TRACKING), "the point leaves the workspace while it is tracked"),
    (of(Reason.OUT_OF_REACH, OutOfReach(), stage=Stage.TIMING), "out of reach when the arm could be there"),
    (of(Reason.OUT_OF_REACH, OutOfReach(modes=("left", "right"))), "cannot change from mode left to right"),
    (
        of(Reason.JOINT_LIMIT, BeyondRange(), Quantity(0.04, "m")),
        "j1 would have to go 40 mm beyond its limit",
    ),
    (
        of(Reason.JOINT_LIMIT, BeyondRange(mode="right", above_m=0.03), Quantity(math.radians(3), "rad")),
        "30 mm above the point, j1 would have to go 3 deg beyond its limit (mode right)",
    ),
    (
        of(Reason.JOINT_LIMIT, BeyondRange(arch_top_m=0.4), Quantity(0.07, "m")),
        "for an arch up to 400 mm (the lift allows 330 mm), j1 would have to go 70 mm beyond its limit",
    ),
    (of(Reason.JOINT_LIMIT, BeyondRange(), Quantity(0.1, "m"), stage=Stage.START), "j1 starts 100 mm beyond its limit"),
    (
        of(
            Reason.JOINT_LIMIT,
            BeyondRange(value=math.radians(130), limit=math.radians(120)),
            Quantity(math.radians(10), "rad"),
        ),
        "j1 would have to go to 130 deg, 10 deg beyond the end of its range at 120 deg",
    ),
    (
        of(
            Reason.JOINT_LIMIT,
            BeyondRange(value=math.radians(130), limit=math.radians(120), **PLACE),
            Quantity(math.radians(10), "rad"),
        ),
        "62 mm along the path, at [300.0, 0.0, 50.0] mm in world, j1 leaves its range; from there on it would have to "
        "go up to 130 deg, 10 deg beyond the end of its range at 120 deg",
    ),
    (of(Reason.JOINT_LIMIT, BeyondRange(), subject=None), "a joint would have to go beyond its limit"),
    (
        of(Reason.FORBIDDEN_YAW, RANGE, Quantity(0.1, "rad"), stage=Stage.START),
        "the yaw of the tool at the start is 10 deg, in the forbidden range from -0.5 deg to 20 deg, 5.73 deg beyond",
    ),
    (
        of(Reason.FORBIDDEN_YAW, replace(RANGE, lag_rad=math.radians(2), mode="left"), Quantity(0.1, "rad")),
        "in the forbidden range from -0.5 deg to 20 deg (2 deg wider at both ends, for joints that lag), 5.73 deg",
    ),
    (
        of(Reason.FORBIDDEN_YAW, replace(RANGE, on_the_way=True), Quantity(0.1, "rad"), stage=Stage.INVERSE),
        "to a yaw of 10 deg the tool would have to turn through the forbidden range from -0.5 deg to 20 deg",
    ),
    (
        of(Reason.FORBIDDEN_YAW, replace(RANGE, on_the_way=True), Quantity(0.1, "rad"), stage=Stage.LIMITS),
        "on its way the tool would turn into the forbidden range of yaw from -0.5 deg to 20 deg, by 5.73 deg",
    ),
    (
        of(Reason.NEAR_SINGULARITY, Singular(**MARGINS)),
        "the arm would be too close to a singular position (singularity margin 0.03, required 0.1)",
    ),
    (
        of(Reason.NEAR_SINGULARITY, Singular(**MARGINS, **PLACE)),
        "62 mm along the path, at [300.0, 0.0, 50.0] mm in world, the arm comes too close to a singular position; from "
        "there on the singularity margin is 0.03 at the least, required 0.1",
    ),
    (of(Reason.NEAR_SINGULARITY, Singular()), "the arm would be too close to a singular position"),
    (
        of(Reason.NEAR_SINGULARITY, Singular(mode="left", positions=("stretched", "aligned"))),
        "the arm would be stretched or the tool would be over the base axis (mode left)",
    ),
    (
        of(Reason.NEAR_SINGULARITY, Singular(distance_m=0.01, positions=("folded",), **MARGINS)),
        "the straight line comes within 10 mm of a singular position (folded; singularity margin 0.03, required 0.1)",
    ),
    (
        of(Reason.NEAR_SINGULARITY, Singular(distance_m=0.01, modes=("left", "right"))),
        "a straight leg cannot change from mode left to right: its line comes no closer than 10 mm to a singular",
    ),
    (
        of(Reason.NEAR_PARALLEL_SINGULARITY, Singular(**MARGINS)),
        "too close to a position in which its motors do not hold the tool (parallel margin 0.03, required 0.1)",
    ),
    (of(Reason.NEAR_PARALLEL_SINGULARITY, Singular(margin=-0.1, required=0.1)), "would cross a position"),
    (of(Reason.NEAR_PARALLEL_SINGULARITY, Singular(required=0.1)), "would cross a position"),
    (
        of(Reason.SELF_COLLISION, HIT),
        f"the arm would hit itself: {DEEP}",
    ),
    (
        of(Reason.BODY_COLLISION, HIT),
        DEEP,
    ),
    (of(Reason.BODY_COLLISION, APART), "cup would come too close to gate: gap 1 mm, required 13 mm"),
    (
        of(Reason.START_IN_COLLISION, APART),
        "the arm collides at the start: cup would come too close to gate: gap 1 mm, required 13 mm",
    ),
    (of(Reason.START_IN_COLLISION, Enclosed()), "the arm collides at the start: cup is inside gate"),
    (
        of(Reason.CONTROL_POINT_IN_COLLISION, HIT),
        f"the control point cannot be met without a collision: {DEEP}",
    ),
    (
        of(Reason.CONTROL_POINT_IN_COLLISION, replace(APART, end="approach", straight_m=0.02, least_m=0.0321)),
        "approach is too short: 20 mm above the point cup would come too close to gate: gap 1 mm, required 13 mm; it "
        "must be at least 32.1 mm",
    ),
    (of(Reason.NOT_CERTIFIED, APART), "cup and gate could not be proved to stay apart"),
    (
        of(Reason.NOT_CERTIFIED, Refuted(code="LIMIT", what="too fast", where="1.2 s"), subject=None),
        "the checker refuses the plan: LIMIT, too fast, 1.2 s",
    ),
    (
        of(Reason.MOTION_LIMIT, MotionLimit(obstacle=Obstacle.RATE, rate="acceleration"), Quantity(0.5, "m/s²")),
        "j1 would have to exceed its limit of acceleration by 500 mm/s²",
    ),
    (
        of(
            Reason.MOTION_LIMIT,
            MotionLimit(obstacle=Obstacle.FRAME_TOO_FAST, rate="velocity", frame="dial", mode="left"),
            Quantity(0.05, "1"),
        ),
        "to move with dial, j1 would have to exceed its limit of velocity by 5 % (mode left)",
    ),
    (
        of(
            Reason.MOTION_LIMIT,
            MotionLimit(obstacle=Obstacle.RATE, rate="velocity"),
            Quantity(1.0, "rad/s"),
            stage=Stage.START,
        ),
        "the velocity of j1 at the start exceeds its limit by 57.3 deg/s",
    ),
    (
        of(
            Reason.MOTION_LIMIT,
            Overshoot(rate="velocity", value=8.24, limit=7.0, after_s=0.05),
            Quantity(1.24, "rad/s"),
            stage=Stage.START,
        ),
        "j1 accelerates at the start, and however fast the acceleration falls, the velocity reaches 472 deg/s 50 ms "
        "after the start, 71 deg/s too much; its limit is 401 deg/s",
    ),
    (
        of(
            Reason.MOTION_LIMIT,
            AccelerationTime(given_s=0.05, needed=20.0, limit=10.0, enough_s=0.08),
            Quantity(10.0, "m/s²"),
        ),
        "with an acceleration time of 50 ms j1 would need 20,000 mm/s², but it has 10,000 mm/s²; 80 ms would be enough",
    ),
    (
        of(Reason.CARRY_LIMIT, Carrying(acceleration=12.5, limit=10.0)),
        "the part would be accelerated with 12.5 m/s², but only 10 m/s² are allowed",
    ),
    (
        of(
            Reason.LOAD_LIMIT,
            Overload(of="max_load", value=6.4, limit=6.0, tool=1.2, part="part", part_value=5.2),
            Quantity(0.4, "kg"),
            stage=Stage.CONTROL_POINT,
        ),
        "tool and part have 6.4 kg together (1.2 kg and 5.2 kg) from here on, but the maximum load of test is 6 kg; "
        "a part of up to 4.8 kg, a lighter tool or a robot for this load would help",
    ),
    (
        of(
            Reason.LOAD_LIMIT,
            Overload(of="table", value=6.4, limit=6.0, tool=6.4),
            Quantity(0.4, "kg"),
            stage=Stage.START,
        ),
        "the tool has 6.4 kg, but acceleration_by_load ends at 6 kg; a lighter tool or a row for this mass would help",
    ),
    (
        of(
            Reason.LOAD_LIMIT,
            Overload(of="max_inertia", value=0.2, limit=0.12, tool=0.15, part="part", part_value=0.05),
            Quantity(0.08, "kg·m²"),
            stage=Stage.START,
        ),
        "tool and part have 0.2 kg·m² about theta4 together (0.15 kg·m² and 0.05 kg·m²) from the start on, but the "
        "maximum of test is 0.12 kg·m²; a tool that is lighter or nearer to the axis or a robot for this load would "
        "help",
    ),
    (
        of(
            Reason.TOLERANCE,
            Inaccurate(position_m=0.0142, yaw_rad=0.0, allowed_m=0.005, allowed_rad=None, cause="frame", most=0.012),
            Quantity(0.0092, "m"),
        ),
        "the tool may be 14.2 mm off, but only 5 mm are allowed; most of it, 12 mm, is due to: frame",
    ),
    (
        of(
            Reason.TOLERANCE,
            Inaccurate(position_m=0.001, yaw_rad=0.2, allowed_m=0.005, allowed_rad=0.1, cause="lag", most=0.15),
            Quantity(0.1, "rad"),
        ),
        "the tool may be 11.5 deg off, but only 5.73 deg are allowed; most of it, 8.59 deg, is due to: lag",
    ),
    (
        of(Reason.TOLERANCE, NotTouching(of="support", distance_m=0.02, allowed_m=0.005)),
        "cup would be too far from what it is put down on: gate, the nearest, is 20 mm away, and at most 5 mm is "
        "allowed",
    ),
    (
        of(Reason.JOINT_LIMIT, Corrected(shift_m=0.006, joint="j2")),
        "the belt correction may shift the tool by 6 mm, which would bring j2 beyond its range",
    ),
    (
        of(Reason.NEAR_SINGULARITY, Corrected(shift_m=0.006)),
        "the belt correction may shift the tool by 6 mm, which would bring the arm to a singular position",
    ),
    (
        of(
            Reason.WINDOW_MISSED,
            WindowMissed(miss=Miss.TOO_SHORT, open_s=0.2, needed_s=0.5, belt_m=0.15),
            Quantity(0.3, "s"),
        ),
        "the point must be tracked for 500 ms, but its window is open for only 200 ms (300 ms short, 150 mm of belt)",
    ),
    (
        of(Reason.LAW_ENDS, LawEnds(known_s=(0.0, 2.0), needed_s=2.5), Quantity(0.5, "s")),
        "the motion of belt is known from 0 s to 2 s, but it is needed at 2.5 s",
    ),
    (
        of(Reason.LAW_ENDS, LawEnds(known_s=(None, 2.0), needed_s=2.5, tracked_s=0.8), Quantity(0.5, "s")),
        "the motion of belt is known to 2 s, but it is needed until 2.5 s: the point must be tracked for 800 ms, "
        "from 1.7 s on",
    ),
    (
        of(Reason.LAW_ENDS, LawEnds(known_s=(0.0, 2.0), needed_s=2.5, tracked_s=0.0, on_arrival=True)),
        "the motion of belt is known from 0 s to 2 s, but the point cannot be met before 2.5 s; the arm cannot be "
        "there sooner",
    ),
    (of(Reason.LAW_ENDS, LawEnds(needed_s=2.5), subject=None), "the motion of a frame is not known at 2.5 s"),
]
CASES += [
    (of(Reason.MOTION_LIMIT, MotionLimit(obstacle=obstacle), subject=None), "")
    for obstacle in Obstacle
    if obstacle not in (Obstacle.RATE, Obstacle.FRAME_TOO_FAST)
]
CASES += [
    (of(Reason.WINDOW_MISSED, WindowMissed(miss=miss, searched_s=60.0), Quantity(0.034, "s"), subject=None), "")
    for miss in Miss
    if miss is not Miss.TOO_SHORT
]
"""Refusals, and what is said of them."""


@pytest.mark.parametrize(("refused", "words"), CASES, ids=lambda x: str(getattr(x, "reason", "")))
def test_every_fact_has_its_sentence(refused: Refusal, words: str) -> None:
    found = said(refused)
    assert found.startswith("" if refused.stage is Stage.START else "home: ")
    assert found.endswith(".")
    assert words in found
    assert "nan" not in found
    assert "None" not in found


def test_every_reason_and_every_kind_of_facts_is_tried_above() -> None:
    """One without a sentence would be a fault in the middle of an answer."""
    assert {refused.reason for refused, _ in CASES} == set(Reason) - {Reason.TIMED_OUT, Reason.COUNT_SPENT}
    assert {type(refused.facts) for refused, _ in CASES} == set(get_args(Facts))
    words = [because(SCENE, refused) for refused, _ in CASES]
    assert all(words)
    assert len({said(refused) for refused, _ in CASES}) == len(CASES)


def test_the_table_has_each_kind_of_facts_and_no_other() -> None:
    assert list(KINDS) == list(SENTENCES)
    assert set(KINDS) == set(get_args(Facts))
    for refused, _ in CASES:
        kind = KINDS[type(refused.facts)]
        assert refused.reason in kind.reasons
        assert refused.amount is None or refused.amount.unit in kind.units


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_a_refusal_with_as_few_facts_as_there_may_be_has_a_sentence(kind: type) -> None:
    """At every stage, for every reason, and with every code: none may be left without a sentence."""
    few: dict[Any, Any] = {str: "x", float: 1.0, bool: False}
    hints = get_type_hints(kind)
    given = {}
    for each in fields(kind):
        if each.default is MISSING:
            hint = hints[each.name]
            options = [None] if type(None) in get_args(hint) else list(get_args(hint))
            given[each.name] = options or (list(hint) if issubclass(hint, StrEnum) else [few[hint]])
    for stage, reason, *own in product(Stage, KINDS[kind].reasons, *given.values()):
        bare = of(reason, kind(**dict(zip(given, own, strict=True))), stage=stage)
        assert len(because(SCENE, bare)) > 8
        assert "{" not in because(SCENE, bare)


def test_no_template_has_a_word_that_nothing_gives_or_a_bracket_that_is_not_closed() -> None:
    known = set(PARTS) | {each.name for kind in KINDS for each in fields(kind)}
    for refused, _ in CASES:
        known |= words_of(SCENE, refused).keys()
    for rows in (*SENTENCES.values(), *PARTS.values()):
        for row in rows:
            template = row if isinstance(row, str) else row[0]
            assert set(re.findall(r"{(\w+)}", template)) <= known | COMPUTED, template
            bare = re.sub(r"{\w+}", "", template)
            while "[" in bare:
                bare, count = re.subn(r"\[[^][]*\]", "", bare)
                assert count, template
            assert not set(bare) & set("[]{}"), template


@pytest.mark.parametrize("least", [0.0321, 1e300, 1.7e308])
def test_a_number_without_bounds_has_its_words(least: float) -> None:
    """Numbers of an answer that is read are any that are finite."""
    end = replace(APART, gap_m=-least, end="depart", straight_m=least, least_m=least)
    found = because(SCENE, of(Reason.CONTROL_POINT_IN_COLLISION, end, Quantity(least, "m")))
    assert found.startswith("depart is too short: ")


def test_a_name_with_brackets_is_no_template() -> None:
    odd = Bodies(("cup[{gate}]", "{short}"))
    found = because(SCENE, refusal(subject=odd, facts=replace(APART, rule="near", clearance_m=0.013)))
    assert found.startswith("cup[{gate}] would come too close to {short}: gap 1 mm")


def test_each_note_of_a_leg_is_another_one() -> None:
    routes = [Route(course) for course in Course]
    routes += [Route(Course.DIRECT, 1), Route(Course.DIRECT, 2), Route(Course.ROUNDED, 2)]
    routes += [Route(Course.DIRECT, after_wait=True), Route(Course.DIRECT, later=True)]
    assert len({note(route) for route in routes}) == len(routes)
    assert note(Route(Course.DIRECT, 2, after_wait=True, later=True)) == "2 via points after a wait later"
    assert note(None) == ""


def test_a_quantity_is_a_number_or_nothing() -> None:
    assert Quantity.of(math.nan, "m") is None
    assert Quantity.of(math.inf, "s") is None
    assert Quantity.of(0.5, "s") == Quantity(0.5, "s")


def test_a_refusal_is_about_one_kind_of_thing() -> None:
    kinds = {subject: refusal(subject=subject) for subject in (Bodies(("x",)), JointName("x"), FrameName("x"), None)}
    told = {(found.bodies, found.joint, found.frame) for found in kinds.values()}
    assert told == {(("x",), None, None), ((), "x", None), ((), None, "x"), ((), None, None)}


def test_with_nothing_tried_the_sentence_says_so() -> None:
    budget = replace(SCENE, options=replace(SCENE.options, budget_s=0.2))
    assert sentence(budget, None, None, NONE, cut=False) == "No plan was found in 0.2 s; nothing was tried."
    assert "among 70 candidates" in said(None, Census(70, 60))


def test_facts_of_a_kind_say_which_kind_they_are() -> None:
    kinds = [next(field.default for field in fields(kind) if field.name == "kind") for kind in get_args(Facts)]
    assert len(set(kinds)) == len(kinds)
