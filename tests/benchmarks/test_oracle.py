"""The oracle: right by other means, finding what was planted, and a short form of ``make soak``."""

from __future__ import annotations

import copy
import json
from itertools import combinations_with_replacement
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from assur.scenes import ik
from benchmarks.oracle import plans, refusals
from benchmarks.oracle.contradicted import JUDGES, contradiction
from benchmarks.oracle.faults import Violation, beyond
from benchmarks.oracle.impossible import KINDS as IMPOSSIBLE
from benchmarks.oracle.impossible import random_request
from benchmarks.oracle.inverse import solutions
from benchmarks.oracle.kinds import KINDS, OWN, TILTING, random_cell
from benchmarks.oracle.motion import Motion
from benchmarks.oracle.nearest import nearest_of
from benchmarks.oracle.places import Places, about
from benchmarks.oracle.product import as_si, planned
from benchmarks.oracle.promises import broken_promises
from benchmarks.oracle.running import CAMPAIGNS, RunningCampaign, run
from benchmarks.oracle.traces_kept import arc, line, on_path
from benchmarks.soak.arms import Arm
from benchmarks.soak.drafts import FIVE_BAR, SCARAS, THREE_AXES
from benchmarks.soak.poses import Document, Poses
from benchmarks.soak.solids import Gap, gaps, shape_of, solid_of
from tests.benchmarks.test_soak import SHAPES

MODELS = (*SCARAS, THREE_AXES, FIVE_BAR, *TILTING)


# right by other means


@pytest.mark.parametrize(("first", "second"), list(combinations_with_replacement(SHAPES, 2))[:-1])
def test_the_simulations_own_gaps_are_those_of_coal(first: str, second: str) -> None:
    """Apart to 2 µm; of overlaps the depth, where neither is a mesh and `coal` is right: of some deep ones it says
    more. What is inside a mesh it does not see."""
    rng, one, other = np.random.default_rng(5), SHAPES[first], SHAPES[second]
    n = 3 if {"mesh", "rail"} & {first, second} else 40
    at = Poses(rng.uniform(-0.1, 0.1, (n, 3)), rng.uniform(-3, 3, n))
    beside = Poses(rng.uniform(-0.1, 0.1, (n, 3)), rng.uniform(-3, 3, n))
    own = gaps(solid_of(one), at, solid_of(other), beside, np.inf)
    a, b = shape_of(solid_of(one)), shape_of(solid_of(other))
    by_coal = Gap(a, b).among(Places.upright(at), Places.upright(beside), np.arange(n))
    apart = by_coal > 1e-6
    assert apart.any() or n < 40
    np.testing.assert_allclose(own[apart], by_coal[apart], atol=2e-6)
    if not (a.mesh or b.mesh) and "rail" not in (first, second):  # of a lying cylinder the depth is only bounded
        assert (by_coal[~apart] <= own[~apart] + 5e-6).all()
        shallow = ~apart & (own > -0.02)
        np.testing.assert_allclose(own[shallow], by_coal[shallow], atol=5e-6)


def test_a_place_that_is_not_finite_is_refused() -> None:
    gap, here = Gap(shape_of(solid_of(SHAPES["box"])), shape_of(solid_of(SHAPES["sphere"]))), Places.at(np.zeros(3))
    assert gap.at(here, Places.at([1.0, 0.0, 0.0])) == pytest.approx(0.9, abs=1e-6)
    with pytest.raises(ValueError, match="not finite"):
        gap.at(here, Places.at([np.nan, 0.0, 0.0]))


@pytest.mark.parametrize("model", MODELS)
def test_the_arms_and_their_inverse_are_where_the_planner_has_them(model: str) -> None:
    """The flange against the product's own forward kinematics, and every solution of the inverse against the flange."""
    robot = {"model": model, "tool": {"tcp_m": [0.0, 0.0, 0.0]}, "base": {"at_m": [0.02, -0.03, 0.04], "yaw_rad": 2.2}}
    arm, rng, seen = Arm.of(robot), np.random.default_rng(3), 0
    for _ in range(40):
        q = arm.lower + rng.uniform(0.1, 0.9, len(arm.lower)) * (arm.upper - arm.lower)
        links = arm.places(q[None])
        if not np.isfinite(links["flange"].p).all():
            continue  # the couplers of a five-bar do not meet
        slides = arm.upper - arm.lower < 0.5
        joints = {f"{n}_{'m' if s else 'rad'}": float(x) for n, s, x in zip(arm.names, slides, q, strict=True)}
        tool = ik(robot=robot, joints=joints)["tool"]["world"]
        np.testing.assert_allclose(links["flange"].p[0], tool["at_m"], atol=1e-9)
        pitch = roll = None
        if "link4" in links:
            m = links["link1"].inverse().then(links["flange"]).r
            pitch, roll = np.arctan2(m[:, 2, 0], m[:, 0, 0]), np.arctan2(-m[:, 1, 2], m[:, 1, 1])
            assert float(np.cos(pitch[0] - tool["pitch_rad"])) == pytest.approx(1.0, abs=1e-12)
            assert float(np.cos(roll[0] - tool["roll_rad"])) == pytest.approx(1.0, abs=1e-12)
        yaw = None if arm.tilts else links["flange"].yaw
        found = solutions(arm, links["flange"].p, yaw, pitch, roll)
        assert min(float(np.abs(each.q[0] - q).max() % (2.0 * np.pi)) for each in found) < 1e-6 or len(q) == 4
        for each in found:
            if each.short[0] == 0.0 and each.margin[0] > 0.0:
                np.testing.assert_allclose(arm.places(each.q)["flange"].p, links["flange"].p, atol=1e-9)
        seen += 1
    assert seen > 10


def test_out_of_reach_is_told_by_how_much() -> None:
    arm = Arm.of({"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_m": [0, 0, 0]}})
    p = np.array([[0.55 + 1e-4, 0.0, 0.2], [0.5, 0.0, 0.333 + 2e-3]])
    found = solutions(arm, p, np.zeros(2))
    assert min(each.missing[0] for each in found) == pytest.approx(1e-4, abs=1e-12)
    assert min(each.missing[1] for each in found) == pytest.approx(2e-3, abs=1e-12)


def test_paths_are_lines_and_arcs() -> None:
    begin, corner = np.array([0.0, 0.0, 0.0]), np.array([1.0, 0.0, 0.0])
    quarter = arc(corner, np.array([1.0 + np.sin(0.6), 1.0 - np.cos(0.6), 0.0]), np.array([2.0, 1.0, 0.0]))
    assert quarter.length == pytest.approx(np.pi / 2.0)
    parts = [line(begin, corner), quarter]
    found = on_path(parts, np.array([0.5, 1.0 + np.pi / 4.0, 1.0 + np.pi / 2.0]))
    half = np.sqrt(0.5)
    np.testing.assert_allclose(found, [[0.5, 0, 0], [1 + half, 1 - half, 0], [2, 1, 0]], atol=1e-12)


def test_turns_are_right_handed() -> None:
    np.testing.assert_allclose(about(2, np.pi / 2.0) @ [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(about(0, np.pi / 2.0) @ [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], atol=1e-15)
    np.testing.assert_allclose(about(1, np.pi / 2.0) @ [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], atol=1e-15)


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


def planted(answer: Document, *path: Any, value: Any) -> Document:
    """The answer with another value there."""
    found = copy.deepcopy(answer)
    inner = found
    for key in path[:-1]:
        inner = inner[key]
    inner[path[-1]] = value(inner[path[-1]]) if callable(value) else value
    return found


def test_lies_of_an_answer_are_found(transfer: tuple[Document, Document]) -> None:
    request, answer = transfer
    nearest = ("margins", "nearest")
    assert kinds(request, planted(answer, *nearest, "gap_m", value=lambda v: v + 7e-5)) == {"nearest"}
    assert kinds(request, planted(answer, *nearest, "gap_m", value=lambda v: v - 7e-5)) == {"nearest"}
    assert kinds(request, planted(answer, *nearest, value=None)) == {"nearest"}
    assert kinds(request, planted(answer, "lower_bound_s", value=answer["duration_s"] + 1e-3)) == {"lower bound"}
    assert kinds(request, planted(answer, "contacts", value=[])) == {"contacts"}
    peak = ("margins", "peaks", 0, "velocity")
    assert kinds(request, planted(answer, *peak, value=lambda v: 0.99 * v)) == {"peak"}
    at = ("arrivals", 0, "at_m", 0)
    assert kinds(request, planted(answer, *at, value=lambda v: v + 1e-4)) == {"arrival"}
    assert kinds(request, planted(answer, "arrivals", 0, "along_m", value=12.0)) == {"along"}
    assert kinds(request, planted(answer, "arrivals", 0, "grip_m", value=lambda v: v + 7e-5)) == {"hands"}
    speed = ("margins", "tool", "speed_m_s")
    assert kinds(request, planted(answer, *speed, value=lambda v: 0.5 * v)) == {"tool"}


def test_a_plan_for_another_request_is_found(transfer: tuple[Document, Document]) -> None:
    request, answer = transfer
    other = copy.deepcopy(request)
    other["robot"].setdefault("limits", {}).update({"velocity": 0.2, "acceleration": 0.2, "jerk": 0.2})
    assert kinds(other, answer) >= {"velocity", "acceleration", "jerk"}
    other = copy.deepcopy(request)
    other["options"]["clearance_m"] = {"travel": 0.5, "near": 0.5}
    assert "clearance" in kinds(other, answer)
    other = copy.deepcopy(request)
    other["task"][0]["pick"]["window_s"] = [0.0, 0.1]
    assert kinds(other, answer) == {"window"}
    other = copy.deepcopy(request)
    other["task"][0]["pick"]["approach"]["m"] += 0.05
    assert kinds(other, answer) == {"straight part"}
    other = copy.deepcopy(request)
    other["task"][0]["pick"]["arch"] = {"top_m": 5.0}
    assert kinds(other, answer) == {"arch"}
    other = copy.deepcopy(request)
    other["carry"] = {"acceleration_m_s2": 0.01}
    assert kinds(other, answer) == {"carry"}


def test_a_trajectory_that_is_changed_is_found(transfer: tuple[Document, Document]) -> None:
    request, answer = transfer
    knots = answer["trajectory"]["position"]
    spoilt = planted(answer, "trajectory", "position", len(knots) // 2, 0, value=lambda v: v + 1e-3)
    assert kinds(request, spoilt) & {"tracking", "acceleration", "jerk"}
    started = planted(answer, "trajectory", "position", 0, 0, value=lambda v: v + 1e-4)
    assert "start" in kinds(request, started)
    ended = planted(answer, "trajectory", "velocity", len(knots) - 1, 0, value=0.01)
    assert "end" in kinds(request, ended)


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


def asked(**changes: Any) -> Document:
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
    "reach": (asked(), forged("OUT_OF_REACH")),
    "range": (asked(), forged("JOINT_LIMIT")),
    "singular": (asked(), forged("NEAR_SINGULARITY")),
    "a belt that comes back": (asked(frames={"belt": BELT}, task=[FOLLOW]), forged("WINDOW_MISSED")),
    "a law that nothing needs": (
        asked(frames={"cart": {"linear": {"at_m": [5, 5, 0], "velocity_m_s": [0.1, 0, 0]}, "valid_s": [-20, -10]}}),
        forged("LAW_ENDS", stage="start", frame="cart"),
    ),
    "yaw": (asked(robot=YAWS), forged("FORBIDDEN_YAW")),
    "load": (asked(), forged("LOAD_LIMIT", facts=LOAD)),
    "start": (asked(bodies=[BLOCK]), forged("START_IN_COLLISION", stage="start", bodies=["link-1", "block"])),
    "collision": (asked(bodies=[BLOCK]), forged("CONTROL_POINT_IN_COLLISION", bodies=["link-1", "block"])),
}


@pytest.mark.parametrize("name", list(FALSE_PROOFS))
def test_a_false_proof_is_contradicted(name: str) -> None:
    request, answer = FALSE_PROOFS[name]
    assert [each.kind for each in contradiction(as_si(request), answer) or []] == ["proof"]


IN_THE_WAY = {**BLOCK, "pose": {"at_m": [0.35, 0.05, 0.19]}}
TRUE_PROOFS = {
    "reach": asked(task=[{"move": {"to": {"at_m": [0.7, 0.05, 0.2]}}}]),
    "range": asked(task=[{"move": {"to": {"at_m": [0.35, 0.05, 0.34]}}}]),
    "window": asked(
        frames={"belt": BELT},
        task=[{"follow": {"to": FOLLOW["follow"]["to"], "duration_s": 0.2, "window_s": [0.0, 0.1]}}],
    ),
    "yaw": asked(robot=YAWS, task=[{"move": {"to": {"at_m": [0.35, 0.05, 0.2], "yaw_rad": 0.3}}}]),
    "load": asked(robot={**asked()["robot"], "tool": {"tcp_m": [0.0, 0.0, 0.0], "mass_kg": 7.0}}),
    "collision": asked(bodies=[IN_THE_WAY]),
}


@pytest.mark.parametrize("name", list(TRUE_PROOFS))
def test_a_true_proof_is_not_contradicted(name: str) -> None:
    answer, _ = planned(TRUE_PROOFS[name])
    assert answer is not None
    assert answer["proved"]
    assert contradiction(as_si(TRUE_PROOFS[name]), answer) == []


def test_a_reason_that_is_not_judged_is_not_right_either() -> None:
    assert "MOTION_LIMIT" not in JUDGES
    assert contradiction(as_si(asked()), forged("MOTION_LIMIT")) is None


# the campaigns


def test_kinds_and_seeds_make_the_same_request_again() -> None:
    for kind in OWN:
        assert json.dumps(random_cell(kind, 7)) == json.dumps(random_cell(kind, 7))
        assert json.dumps(random_cell(kind, 7)) != json.dumps(random_cell(kind, 8))
    for kind in IMPOSSIBLE:
        assert json.dumps(random_request(kind, 7)) == json.dumps(random_request(kind, 7))
        assert json.dumps(random_request(kind, 7)) != json.dumps(random_request(kind, 8))


def test_sixty_plans_keep_what_they_promise(tmp_path: Path) -> None:
    *_, found = plans.campaign(60, seed=4, out=tmp_path)
    assert sum(tally.evaluated for tally in found.values()) == 60
    assert sum(tally.by_checker for tally in found.values()) == 60
    assert all(tally.clean for tally in found.values()), [f.read_text() for f in tmp_path.glob("*.faults.json")]
    assert set(found) == set(KINDS)


def test_proved_refusals_are_contradicted_by_nothing(tmp_path: Path) -> None:
    *_, found = refusals.campaign(300, seed=4, out=tmp_path)
    assert sum(tally.evaluated for tally in found.values()) == 300
    assert all(tally.evaluated for tally in found.values())
    assert all(tally.clean for tally in found.values()), [f.read_text() for f in tmp_path.glob("*.faults.json")]


def test_a_case_that_fails_is_written_as_a_request(tmp_path: Path, transfer: tuple[Document, Document]) -> None:
    request, answer = transfer
    file = plans.written(tmp_path, "belt to table", 3, request, answer, [Violation("arrival", "x", 1.0, 0.5, 2.0)], [])
    assert json.loads(file.read_text()) == json.loads(json.dumps(request))
    faults = json.loads((tmp_path / f"{file.stem}.faults.json").read_text())
    assert (faults["kind"], faults["seed"], faults["faults"][0]["amount"]) == ("belt to table", 3, 1.0)


def test_campaigns_run_in_turn_until_each_has_its_count() -> None:
    going = [RunningCampaign(name, 1) for name in CAMPAIGNS]
    calls: list[int] = []
    run(going, None, count=2, after_each=lambda: calls.append(1))
    assert [each.done for each in going] == [2, 2, 2]
    assert all(each.over for each in going)
    assert len(calls) >= 6


def test_a_campaign_without_time_looks_at_nothing() -> None:
    going = [RunningCampaign("plans", 1)]
    run(going, None, seconds=-1.0)
    assert going[0].done == 0
