"""A figure of which one answer is not clean is refused, never printed as a time."""

from __future__ import annotations

import copy
import math
from typing import Any

import numpy as np
import pytest

from assur.experiments import dyad_race as race
from assur.planner.assur.rrr import RRR
from benchmarks.figures import Figure, figure, quantile, unclean
from benchmarks.judged import SETS, judged, problem_set
from benchmarks.peers.arm import along as straight
from benchmarks.problem_set import ProblemSet
from benchmarks.run_problems import answer
from benchmarks.sections import cells, dyad, legs, scaling, sets
from benchmarks.translation import Manners, request
from tests.benchmarks.hand_made import along, joints_at
from tests.benchmarks.made_up import line

Document = dict[str, Any]
STATIC = problem_set("static")
EASY = [problem for problem in STATIC.problems if problem["direct"]][:2]


@pytest.fixture(scope="module")
def honest() -> Document:
    """A line of an easy problem as the planner answers it."""
    made = answer(EASY[0], STATIC, Manners(budget_s=20.0))
    assert made["status"] == "planned"
    return made


def forged(honest: Document, what: str) -> Document:
    """An answer that looks better than it is."""
    made = copy.deepcopy(honest)
    knots = made["trajectory"]
    if what == "faster than the arm":
        knots["time_s"] = [t / 2 for t in knots["time_s"]]
        made["duration_s"] /= 2
    elif what == "somewhere else":
        for q in knots["position"]:
            q[0] += 1e-3
    elif what == "not accepted by the checker":
        made["checked"] = False
    elif what == "a shorter duration than it has":
        made["duration_s"] *= 0.9
    elif what == "NaN":
        knots["position"][1][0] = math.nan
    return made


def test_an_honest_answer_makes_figures(honest: Document) -> None:
    record = judged(STATIC, EASY[0], honest, "position")
    assert (record["findings"], record["answers"]) == ([], 1)
    figures = sets.set_figures("static", True, {"A": record})
    assert [one.refused for one in figures] == [None] * 4
    assert figures[2].value == pytest.approx(1e3 * honest["first_s"])


@pytest.mark.parametrize(
    "what",
    [
        "faster than the arm",
        "somewhere else",
        "not accepted by the checker",
        "a shorter duration than it has",
        "NaN",
    ],
)
def test_one_forged_answer_among_honest_ones_refuses_every_figure_of_its_set(honest: Document, what: str) -> None:
    good = judged(STATIC, EASY[0], honest, "position")
    bad = judged(STATIC, EASY[0], forged(honest, what), "position")
    assert bad["findings"]
    figures = sets.set_figures("static", True, {"A": good, "B": bad, "C": good})
    assert [one.value for one in figures] == [None] * 4
    for one in figures:
        assert one.refused is not None
        assert one.refused.startswith("1 not clean, first B: ")


def test_an_error_and_a_record_that_nobody_checked_refuse_figures() -> None:
    broken = answer({**EASY[0], "start": [9.0, 0.0, 0.1, 0.0]}, STATIC, Manners())
    record = judged(STATIC, EASY[0], broken, "position")
    assert record["findings"]
    unchecked = line()
    del unchecked["findings"]
    for bad in (record, unchecked):
        assert unclean({"A": line(), "B": bad}.items()) is not None
        assert figure("x", {"A": line(), "B": bad}, lambda _: 1.0).value is None


def test_nothing_measured_and_no_number_are_refused() -> None:
    assert figure("x", {}, lambda _: 1.0) == Figure("x", None, refused="nothing was measured")
    for nothing in (None, math.nan, math.inf):
        refused = figure("x", {"A": line()}, lambda _, nothing=nothing: nothing)  # type: ignore[misc]
        assert (refused.value, refused.refused) == (None, "no answer to measure")
    assert quantile([], 0.5) is None


def test_problems_that_are_not_solved_count_in_shares_and_not_in_times() -> None:
    records = {"A": line(0.02), "B": line(None), "C": line(0.3), "D": line(0.02)}
    fast, soon, median, _ = sets.set_figures("static", True, records)
    assert (fast.value, soon.value) == (50.0, 75.0)
    assert median.value == pytest.approx(20.0)
    assert soon.note == "not solved: B"


def test_every_set_is_measured_with_adaptivity_and_without_in_processes_of_their_own() -> None:
    items = sets.SECTION.items(sets.SECTION.parameters(False))
    assert len(items) == 2 * 100 * len(SETS)
    assert len({item.group for item in items}) == 2 * len(SETS)
    assert len({item.name for item in items}) == len(items)
    quick = sets.SECTION.items(sets.SECTION.parameters(True))
    assert {item.group for item in quick} == {item.group for item in items}
    assert {item.name for item in quick} < {item.name for item in items}


def test_a_dyad_that_comes_out_otherwise_is_not_timed_as_equal(monkeypatch: pytest.MonkeyPatch) -> None:
    given = race.dyads(50)
    assert dyad.unlike(given) == []
    mirrored = RRR(race.L1, race.L2)
    with monkeypatch.context() as patch:
        patch.setattr(race, "kernel", lambda given: mirrored.solve(-1, *_differences(given)))
        assert any(text.startswith("ours differs") for text in dyad.unlike(given))
    far = given.copy()
    far[6, 7] += 1.0
    assert dyad.unlike(far) == ["a dyad is not ASSEMBLED"]


def _differences(given: Any) -> Any:
    d = given[6:] - given[:6]
    return (d[0], d[1]), (d[2], d[3]), (d[4], d[5])


def test_a_leg_that_is_bent_or_misses_its_end_is_found() -> None:
    start, end = [0.35, -0.2, 0.1], [0.4, 0.25, 0.15]
    q = straight(start, end, (0.0, 0.0), 1.0, 200)
    assert legs.off_line(q, start, end, legs.STRAIGHT_M) == []
    assert any("misses an end" in text for text in legs.off_line(q[:-20], start, end, legs.STRAIGHT_M))
    joint = along([joints_at(start, 0.0, 1.0), joints_at(end, 0.0, 1.0)], [1.0])
    assert any("leaves the line" in text for text in legs.bent(joint, start, end))
    assert legs.off_line(q * math.nan, start, end, legs.STRAIGHT_M) != []


def test_legs_are_drawn_where_they_should_be_and_the_same_every_time() -> None:
    drawn = [legs.ends(i, legs.SEED, STATIC.limits) for i in range(40)]
    assert drawn == [legs.ends(i, legs.SEED, STATIC.limits) for i in range(40)]
    points = np.array(drawn).reshape(-1, 3)
    r = np.hypot(points[:, 0], points[:, 1])
    assert np.all((r >= 0.25) & (r <= 0.52))
    assert np.all(np.abs(np.arctan2(points[:, 1], points[:, 0])) <= 1.5)
    assert np.all((points[:, 2] >= 0.06) & (points[:, 2] <= 0.20))
    for start, end in drawn:
        q = straight(start, end, (0.0, 0.0), legs.SIGN, 100)
        assert np.all((q >= STATIC.limits["qmin"]) & (q <= STATIC.limits["qmax"]))


def test_a_smaller_cell_is_part_of_every_larger_one() -> None:
    small, large = cells.crowd(3, 10), cells.crowd(3, 200)
    assert large["obstacles"][:10] == small["obstacles"]
    assert (large["start"], large["goal"]) == (small["start"], small["goal"])
    r = np.array([np.hypot(*body["pos"][:2]) for body in large["obstacles"]])
    assert len(r) == 200
    density = [np.sum(r < radius) / (np.pi * radius**2) for radius in (1.0, 2.0, 2.5)]
    assert np.all(np.abs(np.array(density) / cells.DENSITY_M2 - 1) < 0.35)


@pytest.mark.parametrize("kind", cells.KINDS)
def test_control_points_of_a_tour_are_met_and_one_that_is_not_is_found(kind: cells.Kind) -> None:
    asked = cells.tour(kind, 0, 3, 4, STATIC.limits)
    assert scaling.timed(STATIC, *asked)[2] == []
    problem, document, met = asked
    elsewhere = [[x + 1e-5, y, z] for x, y, z in met]
    assert any("point 0 is missed" in text for text in scaling.timed(STATIC, problem, document, elsewhere)[2])
    assert scaling.timed(STATIC, problem, document, met[:-1])[2] == ["3 arrivals at 2 control points"]


def test_a_scaling_cell_without_a_plan_is_a_finding() -> None:
    problem = cells.crowd(0, 10)
    problem["obstacles"].append({"type": "box", "size": [0.5, 0.5, 0.5], "pos": problem["goal"]["pos"], "yaw": 0.0})
    one = ProblemSet("x", STATIC.limits, (problem,))
    document = request(problem, one.limits, Manners(budget_s=0.05))
    assert scaling.timed(one, problem, document, [problem["goal"]["pos"]])[2][0].startswith("not planned: ")
