"""The judge of plans as they are planned, and of refusals: what is forged is found, and what is right is not."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from benchmarks.judge.faults import beyond
from benchmarks.judge.motion import Motion
from benchmarks.judge.nearest import dips, nearest_of
from benchmarks.judge.poses import Document
from benchmarks.judge.product import as_si, planned
from benchmarks.judge.promises import broken_promises
from benchmarks.judge.refusals import JUDGES, contradiction
from benchmarks.judge.traces_kept import arc, line, on_path
from benchmarks.random_requests.kinds import random_cell

# right by other means


def test_paths_are_lines_and_arcs() -> None:
    begin, corner = np.array([0.0, 0.0, 0.0]), np.array([1.0, 0.0, 0.0])
    quarter = arc(corner, np.array([1.0 + np.sin(0.6), 1.0 - np.cos(0.6), 0.0]), np.array([2.0, 1.0, 0.0]))
    assert quarter.length == pytest.approx(np.pi / 2.0)
    parts = [line(begin, corner), quarter]
    found = on_path(parts, np.array([0.5, 1.0 + np.pi / 4.0, 1.0 + np.pi / 2.0]))
    half = np.sqrt(0.5)
    np.testing.assert_allclose(found, [[0.5, 0, 0], [1 + half, 1 - half, 0], [2, 1, 0]], atol=1e-12)


def test_what_is_no_number_is_a_fault() -> None:
    assert beyond("a", "b", 1.0, 1.0) == []
    assert [each.kind for each in beyond("a", "b", float("nan"), 1.0)] == ["a"]


# what is planted is found


def a_plan(kind: str, steps: int = 9) -> tuple[Document, Document]:
    """The first planned cell of a kind, of no more steps, in SI, which keeps what it promises."""
    for seed in range(40):
        request = random_cell(kind, seed)
        if len(request["task"]) > steps:
            continue
        answer, _ = planned(request)
        if answer is not None and answer["status"] == "planned":
            request = as_si(request)
            assert broken_promises(request, answer) == []
            return request, answer
    raise AssertionError(f"no plan of kind {kind}")


def kinds(request: Document, answer: Document) -> set[str]:
    return {each.kind for each in broken_promises(request, answer)}


@pytest.fixture(scope="module")
def transfer() -> tuple[Document, Document]:
    return a_plan("belt to table")


Change = Callable[[Document, Document], object]


def stated(*path: Any, value: Any) -> Change:
    """Another value there in the answer."""

    def change(_: Document, answer: Document) -> None:
        inner: Any = answer
        for key in path[:-1]:
            inner = inner[key]
        inner[path[-1]] = value(inner[path[-1]]) if callable(value) else value

    return change


def knot(column: str, row: int, by: float) -> Change:
    """A knot's value of the first joint is another."""
    return stated("trajectory", column, row, 0, value=lambda v: v + by)


def limits(request: Document, _: Document) -> None:
    request["robot"].setdefault("limits", {}).update({"velocity": 0.2, "acceleration": 0.2, "jerk": 0.2})


def pick(**more: Any) -> Change:
    return lambda request, _: request["task"][0]["pick"].update(more)


def farther(request: Document, _: Document) -> None:
    request["task"][0]["pick"]["approach"]["m"] += 0.05


def raised(request: Document, _: Document) -> None:
    """What stands is 2 mm higher: the part and its plate, too."""
    for body in request["bodies"]:
        body["pose"]["at_m"][2] += 2e-3


def later(_: Document, answer: Document) -> None:
    """A knot in the middle is later."""
    time = answer["trajectory"]["time_s"]
    time[len(time) // 2] += 2e-4


NEAREST, PEAK = ("margins", "nearest"), ("margins", "peaks", 0, "velocity")
FORGED: dict[str, tuple[Change, set[str]]] = {
    "nearest, more": (stated(*NEAREST, "gap_m", value=lambda v: v + 7e-5), {"nearest"}),
    "nearest, less": (stated(*NEAREST, "gap_m", value=lambda v: v - 7e-5), {"nearest"}),
    "nearest, none": (stated(*NEAREST, value=None), {"nearest"}),
    "nearest, when": (stated(*NEAREST, "time_s", value=lambda v: v + 0.2), {"nearest"}),
    "lower bound": (stated("lower_bound_s", value=1e3), {"lower bound"}),
    "duration": (stated("duration_s", value=lambda v: v - 1e-6), {"duration"}),
    "contacts": (stated("contacts", value=[]), {"contacts"}),
    "peak": (stated(*PEAK, value=lambda v: 0.99 * v), {"peak"}),
    "arrival": (stated("arrivals", 0, "at_m", 0, value=lambda v: v + 1e-4), {"arrival"}),
    "along": (stated("arrivals", 0, "along_m", value=12.0), {"along"}),
    "grip": (stated("arrivals", 0, "grip_m", value=lambda v: v + 7e-5), {"hands"}),
    "speed": (stated("margins", "tool", "speed_m_s", value=lambda v: 0.5 * v), {"tool"}),
    "other limits": (limits, {"velocity", "acceleration", "jerk"}),
    "other clearance": (lambda r, _: r["options"].update(clearance_m={"travel": 0.5, "near": 0.5}), {"clearance"}),
    "other window": (pick(window_s=[0.0, 0.1]), {"window"}),
    "other approach": (farther, {"straight part"}),
    "other arch": (pick(arch={"top_m": 5.0}), {"arch"}),
    "other dwell": (pick(dwell_s=1.0), {"dwell"}),
    "other pull": (lambda r, _: r.update(carry={"acceleration_m_s2": 0.01}), {"carry"}),
    "other end": (lambda r, _: r["options"].update(latest_end_s=0.1), {"latest end"}),
    "other yaws": (lambda r, _: r["robot"]["limits"].update(forbidden_yaw_rad=[[-3.1, 3.1]]), {"forbidden yaw"}),
    "bodies moved": (raised, {"straight part", "contact", "nearest", "arrival", "tracking"}),
    "knot, where": (knot("position", 40, 1e-3), {"acceleration", "jerk", "peak"}),
    "knot, when": (later, {"acceleration", "jerk", "peak"}),
    "start": (knot("position", 0, 1e-4), {"start", "jerk", "peak"}),
    "end": (knot("velocity", -1, 0.01), {"end", "jerk", "peak", "tracking"}),
}


@pytest.mark.parametrize("name", list(FORGED))
def test_a_forged_answer_is_refused(name: str, transfer: tuple[Document, Document]) -> None:
    """An answer that says another thing, one to another request, and one with another trajectory."""
    request, answer = copy.deepcopy(transfer)
    request["robot"].setdefault("limits", {})
    change, expected = FORGED[name]
    change(request, answer)
    assert kinds(request, answer) == expected


@pytest.mark.parametrize("kind", ["traces, SCARA", "traces, tilting"])
def test_a_trace_at_another_speed_is_found(kind: str) -> None:
    request, answer = a_plan(kind, steps=1)
    request["task"][0]["trace"]["speed_m_s"] *= 1.02
    assert "trace" in kinds(request, answer)


def test_a_way_that_is_not_straight_is_found() -> None:
    for seed in range(40):
        request = random_cell("points, elbow arm", seed)
        answer, _ = planned(request)
        steps = [next(iter(step.values())) for step in request["task"]]
        if answer is None or answer["status"] != "planned" or not any(s.get("leg") for s in steps):
            continue
        # the legs of the plan go from pose to pose in the space of the joints
        bent = copy.deepcopy(answer)
        free = [leg for leg in bent["legs"] if leg["route"] and leg["route"]["course"] == "direct"]
        if free and not answer["arrivals"][free[0]["step"]]["missed_by"]:
            free[0]["route"]["course"] = "straight"
            request = as_si(request)
            next(iter(request["task"][free[0]["step"]].values()))["leg"] = "cartesian"
            assert "straight leg" in kinds(request, bent)
            return
    raise AssertionError("no straight leg was planned")


def test_the_smallest_gap_is_found_between_two_instants() -> None:
    """A thin bar passes the arm within less than a step; the gap is known by hand."""
    request: Document = {
        "schema": "assur/1",
        "robot": {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_m": [0.0, 0.0, 0.0]}},
        "start": {"joints": {"j1_rad": 0.0, "j2_rad": 1.0, "j3_m": 0.3, "j4_rad": 0.0}},
        "frames": {"passing": {"linear": {"at_m": [-5.0, 0.5, 0.1], "velocity_m_s": [20.0, 0.0, 0.0], "at_s": 0.0}}},
        "bodies": [
            {"name": "bar", "shape": {"sphere": {"radius_m": 0.01}}, "pose": {"frame": "passing", "at_m": [0, 0, 0]}}
        ],
        "task": [{"move": {"to": {"at_m": [0.3, -0.2, 0.2], "yaw_rad": 0.0}}}],
        "options": {"stop": "first", "budget_s": 60, "max_candidates": 10, "stay_safe_s": 1.0},
    }
    answer, _ = planned(request)
    assert answer is not None
    motion = Motion(as_si(request), answer)
    best = min(
        (n for n in nearest_of(motion, 1.0) if {n.pair.first, n.pair.second} == {"base-column", "bar"}),
        key=lambda n: n.gap_m,
    )
    column = next(b for b in motion.arm.bodies if b.name == "base-column")
    assert best.gap_m == pytest.approx(0.5 - 0.01 - column.solid.radius, abs=2e-5)
    assert best.time_s == pytest.approx(0.25, abs=1e-3)


# refusals that claim a proof


def wanted(**changes: Any) -> Document:
    request: Document = {
        "schema": "assur/1",
        "robot": {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_m": [0.0, 0.0, 0.0]}},
        "start": {"at_s": 0.0, "joints": {"j1_rad": -0.23, "j2_rad": 1.6, "j3_m": 0.3, "j4_rad": 0.0}},
        "task": [{"move": {"to": {"at_m": [0.35, 0.05, 0.2], "yaw_rad": 0.0}}}],
        "options": {"stop": "first", "budget_s": 60, "max_candidates": 2},
    }
    return {**request, **changes}


def forged(reason: str, **more: Any) -> Document:
    """A refusal that claims a proof."""
    refusal: Document = {
        "stage": "control point", "reason": reason, "step": 0, "bodies": [], "joint": None, "frame": None,
        "amount": 1.0, "facts": {"kind": "any"},
    }  # fmt: skip
    return {"status": "not_planned", "proved": True, "refusal": {**refusal, **more}}


BELT = {"conveyor": {"at_m": [0.0, 0.35, 0.05], "speed_m_s": 0.05, "changes": [
    {"at_s": 70, "speed_m_s": -0.25, "acceleration_m_s2": 1.0, "jerk_m_s3": 100.0}]}}  # fmt: skip
FOLLOW = {"follow": {"to": {"frame": "belt", "at_m": [0.5, 0, 0.08], "yaw_free": True}, "duration_s": 0.2,
                     "window_m": [-0.3, 0.3]}}  # fmt: skip
YAWS = {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_m": [0.0, 0.0, 0.0]},
        "limits": {"forbidden_yaw_rad": [[0.1, 0.5]]}}  # fmt: skip
BLOCK = {"name": "block", "shape": {"box": {"size_m": [0.1, 0.1, 0.1]}}, "pose": {"at_m": [0.0, 1.5, 0.05]}}
LOAD = {"kind": "overload", "of": "max_load", "part": None}
FALSE_PROOFS = {
    "reach": (wanted(), forged("OUT_OF_REACH")),
    "range": (wanted(), forged("JOINT_LIMIT")),
    "singular": (wanted(), forged("NEAR_SINGULARITY")),
    "a belt that comes back": (wanted(frames={"belt": BELT}, task=[FOLLOW]), forged("WINDOW_MISSED")),
    "a law that nothing needs": (
        wanted(frames={"cart": {"linear": {"at_m": [5, 5, 0], "velocity_m_s": [0.1, 0, 0]}, "valid_s": [-20, -10]}}),
        forged("LAW_ENDS", stage="start", frame="cart"),
    ),
    "yaw": (wanted(robot=YAWS), forged("FORBIDDEN_YAW")),
    "load": (wanted(), forged("LOAD_LIMIT", facts=LOAD)),
    "start": (wanted(bodies=[BLOCK]), forged("START_IN_COLLISION", stage="start", bodies=["link-1", "block"])),
    "collision": (wanted(bodies=[BLOCK]), forged("CONTROL_POINT_IN_COLLISION", bodies=["link-1", "block"])),
}


@pytest.mark.parametrize("name", list(FALSE_PROOFS))
def test_a_false_proof_is_contradicted(name: str) -> None:
    request, answer = FALSE_PROOFS[name]
    assert [each.kind for each in contradiction(as_si(request), answer) or []] == ["proof"]


IN_THE_WAY = {**BLOCK, "pose": {"at_m": [0.35, 0.05, 0.19]}}
TRUE_PROOFS = {
    "reach": wanted(task=[{"move": {"to": {"at_m": [0.7, 0.05, 0.2]}}}]),
    "range": wanted(task=[{"move": {"to": {"at_m": [0.35, 0.05, 0.34]}}}]),
    "window": wanted(
        frames={"belt": BELT},
        task=[{"follow": {"to": FOLLOW["follow"]["to"], "duration_s": 0.2, "window_s": [0.0, 0.1]}}],
    ),
    "yaw": wanted(robot=YAWS, task=[{"move": {"to": {"at_m": [0.35, 0.05, 0.2], "yaw_rad": 0.3}}}]),
    "load": wanted(robot={**wanted()["robot"], "tool": {"tcp_m": [0.0, 0.0, 0.0], "mass_kg": 7.0}}),
    "collision": wanted(bodies=[IN_THE_WAY]),
}


@pytest.mark.parametrize("name", list(TRUE_PROOFS))
def test_a_true_proof_is_not_contradicted(name: str) -> None:
    answer, _ = planned(TRUE_PROOFS[name])
    assert answer is not None
    assert answer["proved"]
    assert contradiction(as_si(TRUE_PROOFS[name]), answer) == []


def test_a_reason_that_is_not_judged_is_not_right_either() -> None:
    assert "MOTION_LIMIT" not in JUDGES
    assert contradiction(as_si(wanted()), forged("MOTION_LIMIT")) is None


def test_a_second_dip_between_two_instants_is_searched() -> None:
    # of a part that passes a swinging bar: 19.50 mm are between the third and the fourth, and the search beside the
    # second finds 19.62 mm
    gaps, slack = np.array([0.0257, 0.01967, 0.01973, 0.02041, 0.0297, 0.0401]), np.full(6, 0.05)
    assert dips(gaps, slack, 0.01962) == [1, 3, 2]
    assert dips(gaps, slack, 0.015) == [1]
    assert dips(gaps, slack, 0.007) == []
