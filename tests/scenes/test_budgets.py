"""What a request costs: memory and answers do not grow with its seconds; its sizes are looked at first."""

from __future__ import annotations

import copy
import json
import tracemalloc
import warnings
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from assur.planner.errors import InputError
from assur.planner.model.deadline import OutOfTimeError
from assur.planner.model.options import LEAST_ACCELERATION_TIME_S
from assur.scenes import bounds
from assur.scenes.requests import cell_of, check_document, plan_document, validate, view_document
from assur.scenes.schema.normal import normal
from assur.scenes.schema.request import RequestDocument
from assur.scenes.schema.sizes import check_sizes
from tests.refused import refused_at

LONG_S = 9e4
"""Long, but a plan that ends so much later than it begins ends before 100,000 s, the greatest time of a claim."""
MIB = 2**20
ARM: dict[str, Any] = {
    "schema": "assur/1",
    "robot": {
        "model": "mitsubishi-rh-6frh5520",
        "tool": {
            "tcp_mm": [0, 0, -60],
            "mass_kg": 0.3,
            "bodies": [
                {"name": "cup", "shape": {"cylinder": {"radius_mm": 15, "height_mm": 60}}, "at_mm": [0, 0, -30]}
            ],
        },
    },
    "start": {"joints": {"j1_deg": 0, "j2_deg": 60, "j3_mm": 250, "j4_deg": 0}},
    "bodies": [{"name": "post", "pose": {"at_mm": [-300, 300, 100]}, "shape": {"box": {"size_mm": [40, 40, 200]}}}],
    "task": [{"move": {"to": {"at_mm": [350, 100, 250], "yaw_deg": 0}}}],
    "options": {"budget_s": 30, "max_candidates": 16},
}


def with_task(*steps: dict[str, Any], **changes: Any) -> dict[str, Any]:
    return {**copy.deepcopy(ARM), "task": list(steps), **changes}


def following(seconds: float) -> dict[str, Any]:
    at = {"frame": "table", "at_mm": [0, 0, 150], "yaw_deg": 0}
    frames = {"table": {"fixed": {"at_mm": [350, 100, 0]}}}
    return with_task({"follow": {"to": at, "duration_s": seconds}}, frames=frames)


def window(seconds: float) -> dict[str, Any]:
    at = {"at_mm": [350, 100, 250], "yaw_deg": 0}
    return with_task({"move": {"to": at, "window_s": [seconds - 1, seconds]}})


def staying(seconds: float) -> dict[str, Any]:
    return with_task(*ARM["task"], options={**ARM["options"], "stay_safe_s": seconds})


@pytest.mark.slow
@pytest.mark.parametrize("request_of", [following, window, staying])
def test_long_standstill_costs_no_more_memory_than_a_short_one(request_of: Any) -> None:
    plan_document(request_of(2.0))
    tracemalloc.start()
    answer = plan_document(request_of(LONG_S))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert answer["status"] == "planned", answer
    assert peak < 100 * MIB
    assert len(json.dumps(answer["certificate"])) < 100_000
    assert check_document(request_of(LONG_S), answer)["ok"]
    view = view_document(request_of(LONG_S), answer)
    assert len(json.dumps(view)) < 4 * MIB


def test_a_forged_row_over_a_long_standstill_is_refused() -> None:
    request = staying(LONG_S)
    answer = plan_document(request)
    certificate = answer["certificate"]
    last = max(range(certificate["rows"]), key=lambda k: certificate["t1_s"][k] - certificate["t0_s"][k])
    assert certificate["t1_s"][last] - certificate["t0_s"][last] > 0.9 * LONG_S
    certificate["normal"][last] = [-x for x in certificate["normal"][last]]
    verdict = check_document(request, answer)
    assert not verdict["ok"]
    answer = plan_document(request)
    answer["certificate"]["t1_s"][last] -= 1.0  # the last second is not covered any more
    assert not check_document(request, answer)["ok"]


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"frames": {f"f{i}": {"fixe": 0} for i in range(44_000)}}, "frames"),
        ({"bodies": [{}] * 349_401}, "bodies"),
        ({"task": [[[[[]]]]] * 26_200}, "task"),
        ({"execution": {"lag": {f"j{i}_rad": 0 for i in range(58_839)}}}, "execution.lag"),
        ({"options": {f"o{i}": 0 for i in range(50_000)}}, "options"),
    ],
)
def test_sizes_are_refused_before_a_model_reads_them(
    change: dict[str, Any], field: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def never(*_: Any) -> None:
        raise AssertionError("a model read it")

    monkeypatch.setattr("assur.scenes.schema.read.normal", never)
    with refused_at(field, "at most"):
        validate({**ARM, **change})


def test_limits_of_more_joints_than_an_arm_has_are_refused() -> None:
    limits = {f"j{i}_rad": [0, 1] for i in range(58_839)}
    with refused_at("robot.limits", "at most 16 joints"):
        validate({**ARM, "robot": {**ARM["robot"], "limits": limits}})


class OwnDict(dict[str, Any]):
    """A mapping that is no plain one."""


@pytest.mark.parametrize(
    ("change", "is_normal"),
    [
        ({}, True),
        ({"frames": {"f": {"fixed": {"at_m": [0, 0, 0]}}}}, True),
        ({"frames": {"f": {"fixed": {"at_mm": [0, 0, 0]}}}}, False),
        ({"frames": {"f": {"fixed": {"at_m": (0, 0, 0)}}}}, False),
        ({"frames": {"f": {"fixed": {"at_m": [0, None, 0]}}}}, False),
        ({"frames": {"f": {"fixed": {"at_m": [0, np.float64(0), 0]}}}}, False),
        ({"frames": {"f": OwnDict(fixed={"at_m": [0, 0, 0]})}}, False),
        ({"frames": {"f": {"fixed": {"at_m": [0, 0, 0], "yaw_rad": np.float64(0)}}}}, False),
        ({"start": {"joints": {"j1_deg": 0}}}, False),
        ({"unknown": {"deep": [[{"at_mm": 1}]]}}, False),
        ({"unknown": {"deep": [[{"at_m": 1}]]}}, True),
        ({"carry": None}, False),
    ],
)
def test_a_document_counts_as_one_in_si_only_if_all_of_it_is(change: dict[str, Any], is_normal: bool) -> None:
    in_si = normal(ARM)
    assert check_sizes(RequestDocument, {**in_si, **change}) is is_normal


def test_a_document_that_holds_itself_counts_as_no_plain_one() -> None:
    loop: dict[str, Any] = {}
    loop["loop"] = [loop]
    assert not check_sizes(RequestDocument, {**normal(ARM), "unknown": loop})
    with pytest.raises(InputError, match="nesting up to"):
        validate({**normal(ARM), "unknown": loop})


@pytest.mark.parametrize("late", [1, 17, 33])
def test_the_clock_is_read_before_each_body(late: int, monkeypatch: pytest.MonkeyPatch) -> None:
    calls = 0

    def raise_if_late() -> None:
        nonlocal calls
        calls += 1
        if calls == late:
            raise OutOfTimeError

    monkeypatch.setattr("assur.scenes.reading.cell.raise_if_late", raise_if_late)
    bodies = [{**ARM["bodies"][0], "name": f"late-{late}-{k}"} for k in range(33)]
    with pytest.raises(OutOfTimeError):
        cell_of({**ARM, "bodies": bodies})
    cell_of({**ARM, "bodies": bodies})
    assert calls == late + 33


def test_what_is_small_enough_is_left_to_the_model() -> None:
    check_sizes(RequestDocument, ARM)
    with pytest.raises(InputError) as refused:
        validate({**ARM, "frames": {"f": {"fixe": 0}}})
    assert "exactly one of" in refused.value.allowed


POSITIVE = [
    ("robot", "limits", "velocity"),
    ("robot", "limits", "acceleration"),
    ("robot", "limits", "jerk"),
    ("carry", "acceleration_m_s2"),
    ("options", "acceleration_time_s"),
    ("options", "budget_s"),
]


def put(path: tuple[str, ...], value: float) -> dict[str, Any]:
    request = copy.deepcopy(ARM)
    here = request
    for key in path[:-1]:
        here = here.setdefault(key, {})
    here[path[-1]] = value
    if path[-1] == "acceleration_time_s":
        here["timing"] = "parabolic_blend"
    return request


@pytest.mark.parametrize("path", POSITIVE)
@pytest.mark.parametrize("value", [5e-324, 1e-310, 1e-12, 0.0])
def test_positive_numbers_have_floors(path: tuple[str, ...], value: float) -> None:
    with refused_at(".".join(path), "at least"):
        validate(put(path, value))


@pytest.mark.parametrize("path", POSITIVE[:4])
@pytest.mark.parametrize("value", [1e-6, 1.000001e-6, 1.0])
def test_every_legal_number_is_planned_or_refused_without_a_warning(path: tuple[str, ...], value: float) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        answer = plan_document(put(path, value))
    assert answer["status"] in ("planned", "not_planned")


def test_the_least_acceleration_time_is_that_of_the_planner() -> None:
    assert bounds.SHORTEST_RAMP_S == LEAST_ACCELERATION_TIME_S


def test_an_acceleration_time_that_no_controller_has_is_refused() -> None:
    with pytest.raises(InputError) as refused:
        validate(put(("options", "acceleration_time_s"), 1e5))
    assert "at most 100" in refused.value.allowed


def test_a_trace_so_slow_that_it_could_not_be_looked_at_is_refused() -> None:
    trace = {
        "start": {"at_mm": [350, 0, 200], "yaw_deg": 0},
        "path": [{"line": {"to_mm": [350, 120, 200]}}],
        "speed_mm_s": 0.1,
    }
    with refused_at("task[0].trace.speed_mm_s", "at least 0.2 mm/s"):
        plan_document(with_task({"trace": trace}))


DIAL: dict[str, Any] = {"turntable": {"at_mm": [400, 0, 0], "rate_deg_s": 20}}


def with_many_yaws() -> dict[str, Any]:
    part = {"name": "part", "pose": {"frame": "dial", "at_mm": [60, 0, 10]}, "yaw_symmetry": 360}
    part["shape"] = {"box": {"size_mm": [20, 20, 20]}}
    pick = {"part": "part", "grasp_mm": [0, 0, 10], "approach": {"mm": 40}, "dwell_ms": 100, "depart": {"mm": 40}}
    return with_task({"pick": pick}, frames={"dial": DIAL}, bodies=[part])


def with_a_follow_that_moves() -> dict[str, Any]:
    at = {"frame": "dial", "at_mm": [0, 0, 150], "yaw_free": True}
    return with_task({"follow": {"to": at, "duration_s": LONG_S}}, frames={"dial": DIAL})


@pytest.mark.parametrize("request_of", [with_many_yaws, with_a_follow_that_moves])
def test_what_is_looked_at_before_a_candidate_is_tried_ends_with_the_budget(
    request_of: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A clock that goes on by a millisecond at each look: so many looks fit into the budget, whatever else is slow."""
    looks = 0

    def later() -> float:
        nonlocal looks
        looks += 1
        return 1e-3 * looks

    monkeypatch.setattr("assur.planner.model.deadline.time", SimpleNamespace(perf_counter=later))
    request = request_of()
    request["options"] = {"budget_s": 0.05}
    answer = plan_document(request, started=0.0)
    assert answer["status"] == "not_planned"
    assert answer["cut_by_clock"]
    assert looks < 60
