"""The simulation of plans with what is not known realised: it finds what was planted."""

from __future__ import annotations

import copy
from collections.abc import Callable

import numpy as np
import pytest

from assur.scenes.requests import plan_document
from benchmarks.judge.arms import robot_file
from benchmarks.judge.poses import Document
from benchmarks.judge.product import as_si
from benchmarks.judge.simulation import Outcome, simulated
from benchmarks.random_requests.random_cells import random_cell
from tests.benchmarks.test_judge_of_plans import Change
from tests.scenes.cells.answers import planned
from tests.scenes.cells.test_uncertain_cells import (
    beside_a_neighbour,
    between_walls,
    corrected,
    fingers,
    set_down,
)

# what is planted is found


def run(asked: Document, real: Document) -> Outcome:
    """Plans what is asked, and runs the plan in the cell as it is."""
    return simulated(as_si(real), planned(asked), 20, np.random.default_rng(0))[0]


def kinds(outcome: Outcome) -> set[str]:
    return {fault.kind for fault in outcome.faults}


def bodies(outcome: Outcome, kind: str) -> set[str]:
    return {name for fault in outcome.faults if fault.kind == kind for name in fault.about}


def test_a_part_that_is_held_off_is_carried_into_a_wall() -> None:
    off = {"speed_mm_s": 5}
    outcome = run(between_walls({}, {}, held_within={}), between_walls(off, {}))
    assert bodies(outcome, "collision") >= {"part", "wall-a"}
    assert outcome.collisions > 0
    # the error of the pick is 14 mm where none was told, and that of the place, too
    errors = {fault.about: fault.amount for fault in outcome.faults if fault.kind == "error"}
    assert errors["pick-1", "position_m"] == pytest.approx(0.014, abs=1e-3)
    assert errors["place-2", "position_m"] == pytest.approx(0.014, abs=1e-3)
    late = run(between_walls({}, {}, held_within={}), between_walls({}, {"start_tolerance_ms": 40}))
    assert bodies(late, "collision") >= {"part"}
    assert not run(between_walls({}, {}, held_within={}), between_walls({}, {}, held_within={})).faults


def test_fingers_are_driven_into_their_part() -> None:
    exactly = fingers({}, {})
    outcome = run(exactly, fingers({"speed_mm_s": 5}, {}))
    deep = min(fault.amount for fault in outcome.faults if fault.kind == "contact")
    assert deep == pytest.approx(-0.0135, abs=1e-3)
    assert bodies(outcome, "contact") == {"part", "finger-front", "finger-back"}
    assert outcome.deepest_m == pytest.approx(-deep)
    assert outcome.deepest_allowed_m == pytest.approx(1e-4)


def test_a_correction_does_not_move_the_base() -> None:
    near = {"pose": {"frame": "belt", "at_mm": [-526, -347, 250]}}
    outcome = run(corrected(near, {}), corrected(near, {"position_mm": 30}))
    assert bodies(outcome, "collision") >= {"base-column", "post"}


def test_a_gate_strikes_a_part_that_was_put_down() -> None:
    strikes, without = set_down(69, stay_safe_s=2), set_down(69, stay_safe_s=2)
    without["bodies"] = [body for body in without["bodies"] if body["name"] != "bar"]
    assert bodies(run(without, strikes), "collision") >= {"part", "bar"}


def test_a_neighbour_that_was_not_told_of_is_met() -> None:
    real = beside_a_neighbour(0)
    asked = {key: value for key, value in real.items() if key != "neighbours"}
    assert {name for name in bodies(run(asked, real), "collision") if name.startswith("other/")}


def test_a_corner_that_an_answer_names_is_the_worst_run() -> None:
    request = between_walls({"speed_mm_s": 5, "lateral_mm": 1}, {"start_tolerance_ms": 4}, held_within={})
    request["execution"]["lag"] = {"j1_deg": 0.02, "j3_mm": 0.05}
    request["task"][0]["pick"]["contact_tolerance_mm"] = request["task"][1]["place"]["contact_tolerance_mm"] = 0.1
    answer = planned(request)
    outcome, real = simulated(as_si(request), answer, 20, np.random.default_rng(0))
    assert outcome.faults == []
    assert set(real.corners) == {"", "pick-1", "place-2", "move-3"}
    for name, said, worst in outcome.errors:
        assert worst <= said <= 1.02 * worst, name


@pytest.mark.parametrize("model", ["fanuc-sr-3ia", "olier-scara"])
def test_corners_have_the_signs_of_the_makers_joints(model: str) -> None:
    """Joints that their maker counts the other way round lag the other way round, too."""
    assert any(joint.get("sign") == -1 for joint in robot_file(model)["scara"]["joints"])
    lift, wrist = ("j3", "j4") if model == "fanuc-sr-3ia" else ("d3", "theta4")
    tool = {"tcp_m": [0.08, 0, 0.05] if model == "olier-scara" else [0.08, 0, -0.05]}
    request: Document = {
        "schema": "assur/1",
        "robot": {"model": model, "tool": tool},
        "start": {"tool": {"at_m": [0.2, -0.2, 0.2], "yaw_rad": 0.0}, "elbow": "right"},
        "frames": {"nest": {"oscillation": {"at_m": [0.2, 0.2, 0.16], "direction": [0, 0, 1], "amplitude_m": 0.05,
                                            "period_s": 6}}},
        "task": [{"follow": {"to": {"frame": "nest", "at_m": [0, 0, 0], "yaw_rad": 1.0}, "duration_s": 0.1}}],
        "options": {"stop": "first", "budget_s": 60, "max_candidates": 40},
        "execution": {"lag": {f"{lift}_m": 5e-4, f"{wrist}_rad": 5e-3}, "start_tolerance_s": 0.02},
    }  # fmt: skip
    ((name, said, worst),) = simulated(request, planned(request), 20, np.random.default_rng(0))[0].errors
    assert name == "follow-1"
    assert worst <= said <= 1.02 * worst


@pytest.fixture(scope="module")
def transfer() -> tuple[Document, Document]:
    """A planned random cell, which keeps what it promises in all runs."""
    for seed in range(20):
        request = as_si(random_cell("jaws, belt to table", seed))
        answer = plan_document(request)
        if answer["status"] == "planned" and all(arrival.get("error") for arrival in answer["arrivals"]):
            assert not simulated(request, answer, 20, np.random.default_rng(0))[0].faults
            return request, dict(answer)
    raise AssertionError("no plan")


def frame(**unknown: float) -> Change:
    """More is not known of the belt."""

    def change(request: Document, _: Document) -> None:
        request["frames"]["source"].setdefault("uncertainty", {}).update(unknown)

    return change


def part(**unknown: float) -> Change:
    """More is not known of the part."""

    def change(request: Document, _: Document) -> None:
        (body,) = (body for body in request["bodies"] if body["name"] == "part")
        body.setdefault("uncertainty", {}).update(unknown)

    return change


def lags(request: Document, answer: Document) -> None:
    names = zip(answer["trajectory"]["joint_names"], answer["trajectory"]["joint_units"], strict=True)
    request["execution"]["lag"] = {f"{name}_{unit}": 2e-3 for name, unit in names}


def bodies_by(*by: float) -> Change:
    """All that stands is elsewhere, the planned parts of the cell among it."""

    def change(request: Document, _: Document) -> None:
        for body in request["bodies"]:
            body["pose"]["at_m"] = [x + d for x, d in zip(body["pose"]["at_m"], by, strict=True)]

    return change


def of_arrivals(value: Callable[[Document], object]) -> Change:
    return lambda _, answer: [value(arrival) for arrival in answer["arrivals"]]


def of_steps(value: Callable[[Document], object]) -> Change:
    return lambda request, _: [value(given) for step in request["task"] for given in step.values()]


def knot(column: str, by: float) -> Change:
    """A knot in the middle, of the first joint."""

    def change(_: Document, answer: Document) -> None:
        rows = answer["trajectory"][column]
        rows[len(rows) // 2][0] += by

    return change


FORGED: dict[str, tuple[Change, set[str]]] = {
    "belt, where": (frame(position_m=1e-2), {"error"}),
    "belt, how fast": (frame(speed_m_s=2e-2), {"error"}),
    "belt, aside": (frame(lateral_m=1e-2), {"error"}),
    "belt, how high": (frame(vertical_m=5e-3), {"clearance", "error"}),
    "belt, turned": (frame(yaw_rad=0.1), {"error"}),
    "part, where": (part(position_m=1e-2), {"error"}),
    "part, how high": (part(vertical_m=5e-3), {"clearance", "error"}),
    "part, turned": (part(yaw_rad=0.3), {"error"}),
    "late": (
        lambda request, _: request["execution"].update(start_tolerance_s=0.2),
        {"clearance", "collision", "contact", "error"},
    ),
    "lag": (lags, {"clearance", "error"}),
    "bodies aside": (bodies_by(0.03, 0.02, 0.0), {"clearance", "collision", "error"}),
    "bodies up": (bodies_by(0.0, 0.0, 2e-3), {"clearance", "error"}),
    "clearance": (
        lambda request, _: request["options"].update(clearance_m={"travel": 0.2, "near": 0.2}),
        {"clearance"},
    ),
    "no depth": (of_steps(lambda given: given.update(contact_tolerance_m=0.0)), {"contact"}),
    "no contact": (of_steps(lambda given: given.update(contact_with=[])), {"clearance", "collision"}),
    "longer tool": (
        lambda request, _: request["robot"]["tool"]["tcp_m"].__setitem__(2, 0.0),
        {"clearance", "collision", "contact", "error"},
    ),
    "smaller errors": (
        of_arrivals(lambda arrival: arrival["error"].update(position_m=1e-5, horizontal_m=1e-5)),
        {"error"},
    ),
    "no errors": (of_arrivals(lambda arrival: arrival.pop("error")), {"error"}),
    "met later": (of_arrivals(lambda arrival: arrival.update(until_s=arrival["until_s"] + 0.05)), {"error"}),
    "turned grasp": (
        of_arrivals(lambda arrival: arrival.update(yaw_offset_rad=arrival["yaw_offset_rad"] + 0.2)),
        {"error"},
    ),
    "knot, where": (knot("position", 9.0), {"range"}),
    "narrow range": (lambda request, _: request["robot"].setdefault("limits", {}).update(j1_rad=[9.0, 9.1]), {"range"}),
}


@pytest.mark.parametrize("name", list(FORGED))
def test_a_forged_cell_or_answer_is_refused(name: str, transfer: tuple[Document, Document]) -> None:
    request, answer = copy.deepcopy(transfer)
    change, expected = FORGED[name]
    change(request, answer)
    assert kinds(simulated(request, answer, 20, np.random.default_rng(0))[0]) == expected
