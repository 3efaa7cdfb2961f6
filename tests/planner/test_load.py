"""What is carried: too much is refused, and what the joints have left with a load is kept in every phase."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from assur.planner.checked import check
from assur.planner.checker import Code
from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import box
from assur.planner.legs.limits import parts, used
from assur.planner.model.load import Carried, LoadLimits, Tool
from assur.planner.model.outcome import NotPlanned, Planned
from assur.planner.model.phases import phases
from assur.planner.model.refusal import Overload, Reason, Stage
from assur.planner.model.scene import Holding, Move, Place, Scene, Target
from assur.planner.pipeline import plan
from assur.planner.report.margins import carried
from assur.planner.report.sentence import sentence
from assur.planner.robots.facts import lowered
from assur.planner.timing.solver import JERK_RESERVE, RATE_RESERVE
from assur.planner.trajectory import Trajectory
from tests.planner.cells import CUP, arm, cell, go, stands, table_to_table

HEAVY = LoadLimits(rated_kg=2.0, max_kg=5.0)


def heavy(part_kg: float | None, known: LoadLimits = HEAVY, tool_kg: float | None = 1.0, **more: Any) -> Scene:
    """From table to table, with a part of this mass, and home with an empty gripper."""
    scene = table_to_table(go(0.42, 0.0, 0.15, name="home"), tool=replace(CUP, mass_kg=tool_kg), **more)
    bodies = tuple(replace(body, mass_kg=part_kg) if body.name == "part" else body for body in scene.bodies)
    return replace(scene, bodies=bodies, load_limits=known)


def made(scene: Scene) -> Planned:
    found = plan(scene)
    assert isinstance(found, Planned), found
    return found


def loads(scene: Scene, found: Planned) -> tuple[Carried, ...]:
    """What the flange carries in a plan."""
    return carried(scene, phases(scene, found.plan.legs, found.plan.arrivals))


def refused(scene: Scene) -> tuple[NotPlanned, Overload]:
    found = plan(scene)
    assert isinstance(found, NotPlanned)
    assert (found.reason, found.proved, found.census.candidates) == (Reason.LOAD_LIMIT, True, 0)
    assert found.refusal is not None
    assert isinstance(found.refusal.facts, Overload)
    return found, found.refusal.facts


def test_the_share_is_rated_load_over_load_or_that_of_the_table() -> None:
    assert [HEAVY.share(mass) for mass in (0.0, 2.0, 2.5, 4.0, 5.0)] == [1.0, 1.0, 0.8, 0.5, 0.4]
    assert [LoadLimits(max_kg=5.0).share(mass) for mass in (0.0, 5.0)] == [1.0, 1.0]
    table = LoadLimits(2.0, 5.0, shares=((1.0, 0.9), (3.0, 0.7), (4.0, 0.2)))
    # lighter than the first row: as the first row; between two rows on the line between them
    assert [table.share(mass) for mass in (0.0, 1.0, 3.0, 4.0)] == [0.9, 0.9, 0.7, 0.2]
    assert [table.share(mass) for mass in (2.0, 3.5)] == pytest.approx([0.8, 0.45], rel=1e-15)


def test_the_greatest_mass_is_the_maximum_load_or_where_the_table_ends() -> None:
    assert LoadLimits().most_kg is None
    assert LoadLimits(rated_kg=2.0).most_kg == 2.0
    assert LoadLimits(2.0, 5.0).most_kg == 5.0
    assert LoadLimits(2.0, 5.0, shares=((3.0, 1.0), (4.0, 0.5))).most_kg == 4.0
    assert LoadLimits(2.0, 5.0, shares=((3.0, 1.0), (6.0, 0.5))).most_kg == 5.0
    assert LoadLimits(2.0, shares=((3.0, 1.0), (6.0, 0.5))).most_kg == 6.0


@pytest.mark.parametrize(
    ("numbers", "field"),
    [
        ({"rated_kg": 0.0}, "rated_kg"),
        ({"max_kg": math.nan}, "max_kg"),
        ({"max_kg": math.inf}, "max_kg"),
        ({"max_inertia_kgm2": -1.0}, "max_inertia_kgm2"),
        ({"rated_kg": 6.0, "max_kg": 5.0}, "rated_kg"),
        ({"shares": ((1.0, 0.0),)}, r"shares\[0\]"),
        ({"shares": ((1.0, 1.1),)}, r"shares\[0\]"),
        ({"shares": ((math.nan, 1.0),)}, r"shares\[0\]"),
        ({"shares": ((1.0, 0.5), (1.0, 0.4))}, r"shares\[1\]"),
        ({"shares": ((1.0, 0.5), (2.0, 0.6))}, r"shares\[1\]"),
    ],
)
def test_numbers_that_say_nothing_of_a_load_are_refused_at_their_field(numbers: dict[str, Any], field: str) -> None:
    with pytest.raises(InputError, match=f"load.{field}"):
        LoadLimits(**numbers)


def test_tool_and_part_add_up_from_the_pick_to_the_place() -> None:
    scene = heavy(3.0)
    assert [(load.step, load.part, load.mass_kg, load.share) for load in scene.loads] == [
        (-1, None, 1.0, 1.0),
        (0, "part", 4.0, 0.5),
    ]
    found = made(scene)
    pick, place = found.plan.arrivals[:2]
    assert [(load.part, load.mass_kg, load.share, load.t0, load.t1) for load in loads(scene, found)] == [
        (None, 1.0, 1.0, 0.0, pick.until),
        ("part", 4.0, 0.5, pick.until, place.until),
        (None, 1.0, 1.0, place.until, found.plan.trajectory.end),
    ]
    cup = 1.0 * 0.015**2 / 2
    inertia = [cup, cup + 3.0 * (0.06**2 + 0.04**2) / 12, cup]
    assert [load.inertia_kgm2 for load in loads(scene, found)] == pytest.approx(inertia, rel=1e-12)


def test_a_load_halves_acceleration_and_jerk_and_leaves_position_and_velocity() -> None:
    scene = heavy(3.0)
    whole, half = scene.limits_with(None), scene.limits_with("part")
    assert whole is scene.robot.limits
    for name, share in (("lower", 1.0), ("upper", 1.0), ("velocity", 1.0), ("acceleration", 0.5), ("jerk", 0.5)):
        assert (getattr(half, name) == share * getattr(whole, name)).all()
    assert lowered(whole, 0.5) is half  # one for all scenes with this arm and share


def peaks(scene: Scene, found: Planned) -> list[tuple[str | None, float]]:
    """The part in the gripper and the largest share of the arm's own acceleration limits, load by load."""
    limits, path = scene.robot.limits, found.plan.trajectory
    result = []
    for load in loads(scene, found):
        rows = (path.time >= load.t0) & (path.time <= load.t1)
        part = Trajectory(path.time[rows], path.q[rows], path.qd[rows], path.qdd[rows])
        rates = used(part, limits)
        assert rates.ok
        result.append((load.part, float(rates.ratios[1].max())))
    return result


@pytest.mark.parametrize("share", [0.5, 0.25])
def test_with_the_part_in_the_gripper_the_joints_use_their_share_and_without_it_all(share: float) -> None:
    scene = heavy(3.0, LoadLimits(max_kg=5.0, shares=((1.0, 1.0), (4.0, share))))
    found = made(scene)
    (before, first), (held, loaded), (after, last) = peaks(scene, found)
    assert (before, held, after) == (None, "part", None)
    assert 0.99 <= first <= 1.0 + 1e-9
    assert 0.99 * share <= loaded <= share * (1.0 + 1e-9)
    assert 0.99 <= last <= 1.0 + 1e-9
    # the answer's peaks are shares of what is left in each phase
    ratios = [(p.acceleration_ratio, p.jerk_ratio) for p in found.margins.peaks]
    assert 0.99 <= max(a for a, _ in ratios) <= 1.0 + 1e-9
    assert max(j for _, j in ratios if j is not None) <= 1.0 + 1e-6


def lowered_rates(acceleration: float, jerk: float) -> tuple[float, float]:
    """What the solver gets of limits."""
    return acceleration * (1 - RATE_RESERVE), jerk * (1 - JERK_RESERVE)


def test_a_plan_with_a_tool_above_the_rated_load_takes_as_long_as_its_share_says() -> None:
    def turn(mass: float) -> Planned:
        start = (0.0, 1.2, 0.2, 0.0)
        x, y, z = arm().forward(np.array([0.4, 1.2, 0.2, 0.0]))[0].tolist()
        goal = Move("turned", Target("world", Pose(x, y, z, 1.6)))
        scene = cell(goal, q=start, robot=arm(bare=True), tool=Tool(Pose(), (), mass))
        return made(replace(scene, load_limits=HEAVY))

    for mass, share in ((1.0, 1.0), (4.0, 0.5)):
        found = turn(mass)
        a, j = lowered_rates(share * 50.0, share * 1000.0)
        expected = a / j + math.sqrt((a / j) ** 2 + 4 * 0.4 / a)
        assert found.plan.trajectory.duration == pytest.approx(expected, rel=1e-9)
        # nothing is quicker: the bound is made of the limits with the load, too
        whole, sharp = share * 50.0, share * 1000.0
        least = whole / sharp + math.sqrt((whole / sharp) ** 2 + 4 * 0.4 / whole)
        assert found.lower_bound_s is not None
        assert found.lower_bound_s == pytest.approx(least, rel=2e-6)
        assert found.lower_bound_s <= found.plan.trajectory.duration


def holding(part_kg: float, known: LoadLimits = HEAVY, qdd: float = 0.0) -> Scene:
    """The part is in the gripper when the plan begins."""
    part = stands("part", box(0.06, 0.04, 0.02), mass_kg=part_kg)
    scene = cell(go(0.35, 0.25, 0.15), bodies=(part,), tool=replace(CUP, mass_kg=1.0), qdd=(qdd, 0.0, 0.0, 0.0))
    start = replace(scene.start, holding=Holding("part", Pose(z=0.01)))
    return replace(scene, start=start, load_limits=known)


def test_a_part_that_is_held_from_the_start_on_counts_from_the_start_on() -> None:
    scenes = holding(0.5), holding(4.0)
    light, loaded = map(made, scenes)
    of_light, of_loaded = map(loads, scenes, (light, loaded))
    assert [(load.part, load.share) for load in of_light] == [("part", 1.0)]
    assert [(load.part, load.share) for load in of_loaded] == [("part", 0.4)]
    assert loaded.plan.trajectory.duration >= 1.2 * light.plan.trajectory.duration
    assert light.lower_bound_s is not None
    assert loaded.lower_bound_s is not None
    assert light.lower_bound_s < loaded.lower_bound_s <= loaded.plan.trajectory.duration


def test_a_start_that_accelerates_harder_than_the_load_allows_is_refused() -> None:
    made(holding(0.5, qdd=30.0))
    found = plan(holding(4.0, qdd=30.0))
    assert isinstance(found, NotPlanned)
    assert (found.reason, found.proved) == (Reason.MOTION_LIMIT, True)
    assert found.refusal is not None
    assert found.refusal.stage is Stage.START
    assert found.refusal.amount is not None
    assert found.refusal.amount.value == pytest.approx(30.0 - 0.4 * 50.0, rel=1e-12)


def test_parts_of_a_motion_are_cut_where_the_load_changes_and_nowhere_else() -> None:
    scene = heavy(3.0)
    path, whole = made(scene).plan.trajectory, scene.limits_with(None)
    half = scene.limits_with("part")
    k = len(path.time) // 2
    middle, end = float(path.time[k]), path.end
    assert parts(path, ((middle, whole), (end, whole))) == [(path, whole)]
    (first, one), (second, other) = parts(path, ((middle, whole), (middle, whole), (end, half)))
    assert (one, other) == (whole, half)
    assert (first.start, first.end, second.start, second.end) == (path.start, middle, middle, end)
    assert len(parts(path, ((end, whole), (end, half)))) == 1


# too much


def test_more_than_the_maximum_load_is_refused_before_any_search_with_its_numbers() -> None:
    made(heavy(4.0))  # exactly the maximum
    found, facts = refused(heavy(4.2))
    assert facts == Overload(of="max_load", value=5.2, limit=5.0, tool=1.0, part="part", part_value=4.2)
    assert found.refusal is not None
    assert (found.refusal.step, found.refusal.bodies) == (0, ("part",))
    assert found.refusal.amount is not None
    assert found.refusal.amount.unit == "kg"
    assert found.refusal.amount.value == pytest.approx(0.2, rel=1e-12)
    assert found.sentence == (
        "pick: tool and part have 5.2 kg together (1 kg and 4.2 kg) from here on, but the maximum load of test is "
        "5 kg; a part of up to 4 kg, a lighter tool or a robot for this load would help."
    )
    assert found.tried == ()  # no change of the request that is tried makes it lighter


def test_masses_that_add_up_to_the_maximum_are_not_refused_for_rounding() -> None:
    assert 1.1 + 2.2 > 3.3
    made(heavy(2.2, LoadLimits(max_kg=3.3), 1.1))
    made(heavy(2.2, LoadLimits(max_kg=9.0, shares=((1.0, 1.0), (3.3, 0.5))), 1.1))


def test_a_tool_that_is_too_heavy_and_a_part_that_is_held_at_the_start_are_refused_at_the_start() -> None:
    found, facts = refused(heavy(0.1, tool_kg=5.5))
    assert (facts.part, facts.value, facts.tool) == (None, 5.5, 5.5)
    assert found.sentence.startswith("the tool has 5.5 kg, but the maximum load of test is 5 kg; a lighter tool or")
    found, facts = refused(holding(4.5))
    assert (facts.part, facts.value) == ("part", 5.5)
    assert "from the start on" in found.sentence
    assert found.refusal is not None
    assert found.refusal.stage is Stage.START


def test_what_the_table_does_not_cover_is_refused_and_so_is_what_only_the_rated_load_is_known_for() -> None:
    table = LoadLimits(max_kg=5.0, shares=((1.0, 1.0), (3.5, 0.5)))
    made(heavy(2.5, table))
    found, facts = refused(heavy(3.0, table))
    assert (facts.of, facts.limit) == ("table", 3.5)
    assert "acceleration_by_load ends at 3.5 kg" in found.sentence
    assert "a row for this mass would help" in found.sentence
    assert refused(heavy(4.5, LoadLimits(max_kg=5.0, shares=((1.0, 1.0), (9.0, 0.5)))))[1].of == "max_load"
    made(heavy(1.0, LoadLimits(rated_kg=2.0)))
    assert refused(heavy(1.5, LoadLimits(rated_kg=2.0)))[1].limit == 2.0


def test_where_nothing_is_known_nothing_is_scaled_or_refused_and_a_silent_mass_counts_as_nothing() -> None:
    scene = heavy(500.0, LoadLimits())
    assert [load.share for load in loads(scene, made(scene))] == [1.0, 1.0, 1.0]
    silent = heavy(None, HEAVY, None)
    assert [(load.mass_kg, load.inertia_kgm2, load.share) for load in silent.loads] == [(0.0, 0.0, 1.0)] * 2


def test_more_inertia_than_the_maximum_is_refused_with_its_numbers() -> None:
    cup, own = 1.0 * 0.015**2 / 2, 3.0 * (0.06**2 + 0.04**2) / 12
    enough = replace(HEAVY, max_inertia_kgm2=cup + own + 1e-9)
    made(heavy(3.0, enough))
    found, facts = refused(heavy(3.0, replace(HEAVY, max_inertia_kgm2=0.001)))
    assert (facts.of, facts.limit, facts.part) == ("max_inertia", 0.001, "part")
    assert (facts.value, facts.tool, facts.part_value) == pytest.approx((cup + own, cup, own), rel=1e-12)
    assert found.refusal is not None
    assert found.refusal.amount is not None
    assert found.refusal.amount.unit == "kg·m²"
    assert "kg·m² about theta4 together" in found.sentence
    three = heavy(3.0, replace(HEAVY, max_inertia_kgm2=1e-9))
    no_wrist = cell(go(0.3, 0.1), q=(0.3, 1.2, 0.2), robot=arm(axes=3), tool=three.tool)
    no_wrist = replace(no_wrist, load_limits=three.load_limits)
    assert [load.inertia_kgm2 for load in no_wrist.loads] == [None]
    made(no_wrist)


def test_a_sentence_of_an_overload_is_made_of_its_facts() -> None:
    scene = heavy(3.0)
    found, _ = refused(heavy(4.2))
    assert sentence(scene, found.refusal, None, found.census, cut=False) == found.sentence


# what the checker finds


def test_more_than_may_be_carried_is_found_whoever_planned_it() -> None:
    free = made(heavy(3.0, LoadLimits())).plan
    assert check(heavy(3.0, LoadLimits()), free).ok
    for known, said in (
        (LoadLimits(max_kg=3.9), "4 kg with part are too much"),
        (LoadLimits(max_kg=5.0, shares=((3.9, 1.0),)), "4 kg with part are too much"),
        (LoadLimits(rated_kg=3.9), "4 kg with part are too much"),
        (LoadLimits(max_inertia_kgm2=0.001), "kg·m² with part are too much"),
    ):
        findings = check(heavy(3.0, known), free).findings
        assert Code.LOAD in {finding.code for finding in findings}
        assert any(said in finding.what for finding in findings), known


def test_a_place_elsewhere_ends_the_load_elsewhere() -> None:
    """The load is what the steps say, not what the arm does: a plan with the place left out carries to its end."""
    scene = heavy(3.0)
    assert isinstance(scene.task[1], Place)
    only = replace(scene, task=(scene.task[0], scene.task[2]))
    found = made(only)
    assert [(load.part, load.share) for load in loads(only, found)] == [(None, 1.0), ("part", 0.5)]
    assert loads(only, found)[-1].t1 == found.plan.trajectory.end
