"""The simulation of plans with what is not known realised: right by other means, and finding what was planted; and a
short form of ``make soak``."""

from __future__ import annotations

import copy
import json
from itertools import combinations_with_replacement
from pathlib import Path
from typing import Any

import fcl
import numpy as np
import pytest

from assur.scenes import ik, load
from assur.scenes.requests import plan_document, scene_of, shipped
from benchmarks.checker_refusals import keep
from benchmarks.oracle.product import as_si
from benchmarks.soak.arms import Arm, robot_file
from benchmarks.soak.campaign import ELBOW, Tally, campaign, counted, faults_of
from benchmarks.soak.laws import frames_of
from benchmarks.soak.poses import Document, Poses
from benchmarks.soak.random_cells import KINDS, random_cell
from benchmarks.soak.simulation import Outcome, simulated
from benchmarks.soak.solids import gaps, solid_of
from tests.scenes.cells.answers import planned
from tests.scenes.cells.test_uncertain_cells import (
    beside_a_neighbour,
    between_walls,
    corrected,
    fingers,
    set_down,
)

MODELS = ("mitsubishi-rh-6frh5520", "fanuc-sr-3ia", "olier-scara", "lab-scara", "oviedo-scara", "mitsubishi-rp-5ah")
SHAPES: dict[str, Document] = {
    "box": {"box": {"size_m": [0.1, 0.06, 0.04]}},
    "flat box": {"box": {"size_m": [0.02, 0.2, 0.01]}},
    "cylinder": {"cylinder": {"radius_m": 0.04, "height_m": 0.07}},
    "sphere": {"sphere": {"radius_m": 0.05}},
    "capsule": {"capsule": {"radius_m": 0.02, "length_m": 0.08}},
    "bar": {"capsule": {"radius_m": 0.02, "length_m": 0.1, "axis": "y"}},
    "rail": {"cylinder": {"radius_m": 0.03, "height_m": 0.12, "axis": "x"}},
    "mesh": {"mesh": {"asset": "bracket", "unit": "mm"}},
}


# the simulation against other means


def judge(shape: Document) -> tuple[Any, np.ndarray]:
    """The shape as fcl has it, and its attitude in the body's frame."""
    ((kind, given),) = shape.items()
    upright = np.eye(3)
    lying = {"x": np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]]), "y": np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])}
    attitude = lying.get(given.get("axis", "z"), upright)
    if kind == "box":
        return fcl.Box(*given["size_m"]), upright
    if kind == "sphere":
        return fcl.Sphere(given["radius_m"]), upright
    if kind == "cylinder":
        return fcl.Cylinder(given["radius_m"], given["height_m"]), attitude
    if kind == "capsule":
        return fcl.Capsule(given["radius_m"], given["length_m"]), attitude
    triangles = solid_of(shape).triangles
    assert triangles is not None
    model = fcl.BVHModel()
    model.beginModel(len(triangles), 3 * len(triangles))
    model.addSubModel(triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3))
    model.endModel()
    return model, upright


def collides(one: Document, at: Poses, other: Document, beside: Poses) -> bool:
    objects = []
    for shape, pose in ((one, at), (other, beside)):
        geometry, attitude = judge(shape)
        c, s = np.cos(pose.yaw), np.sin(pose.yaw)
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        objects.append(fcl.CollisionObject(geometry, fcl.Transform(turn @ attitude, pose.p)))
    return bool(fcl.collide(*objects, fcl.CollisionRequest(), fcl.CollisionResult()))


@pytest.mark.parametrize(("first", "second"), list(combinations_with_replacement(SHAPES, 2))[:-1])
def test_the_sign_of_a_gap_is_what_fcl_says(first: str, second: str) -> None:
    """But for two meshes, which the simulation does not look at against each other."""
    rng = np.random.default_rng(1)
    n = {0: 100, 1: 15, 2: 4}[len({"rail", "mesh"} & {first, second})]
    at = Poses(rng.uniform(-0.05, 0.05, (n, 3)), rng.uniform(-3, 3, n))
    beside = Poses(rng.uniform(-0.05, 0.05, (n, 3)), rng.uniform(-3, 3, n))
    one, other = SHAPES[first], SHAPES[second]
    found = gaps(solid_of(one), at, solid_of(other), beside, 0.0)
    told = np.array([collides(one, at[i], other, beside[i]) for i in range(n)])
    clear = np.abs(found) > 1e-6
    assert 0 < told.sum() < n
    assert ((found < 0.0) == told)[clear].all()


@pytest.mark.parametrize("model", MODELS)
def test_the_arms_are_where_the_planner_has_them(model: str) -> None:
    tool = {"tcp_m": [0.0, 0.0, -0.05] if "oviedo" in model else [0.03, 0.01, -0.05]}
    robot = {"model": model, "tool": tool, "base": {"at_m": [0.1, -0.2, 0.3], "yaw_rad": 0.7}}
    arm, rng = Arm.of(robot), np.random.default_rng(3)
    low, high = (0.3, 0.7) if arm.family == "five_bar" else (0.57, 0.9)  # a SCARA that is not stretched
    seen = 0
    for _ in range(20):
        q = arm.lower + rng.uniform(low, high, len(arm.lower)) * (arm.upper - arm.lower)
        links = arm.links(q)
        units = ["m" if high < 3.0 and low > -3.0 and high - low < 0.5 else "rad" for low, high in _ranges(arm)]
        joints = {f"{name}_{unit}": float(x) for name, unit, x in zip(arm.names, units, q, strict=True)}
        if not np.isfinite(links["flange"].p).all():
            continue  # the couplers of a five-bar do not meet
        world = ik(robot=robot, joints=joints)["tool"]["world"]
        seen += 1
        point = arm.tool_point(links)
        np.testing.assert_allclose(point.p, world["at_m"], atol=1e-9)
        if world.get("yaw_rad") is not None:
            assert abs((float(point.yaw) - world["yaw_rad"] + np.pi) % (2 * np.pi) - np.pi) < 1e-9
        if arm.family == "scara":
            shift = np.array([0.002, -0.001, 0.0])
            moved = arm.tool_point(arm.links(arm.corrected(q, shift)))
            np.testing.assert_allclose(moved.p - point.p, shift, atol=1e-9)
            if len(arm.names) > 3:
                assert float(moved.yaw) == pytest.approx(float(point.yaw), abs=1e-9)
    assert seen > 10


def _ranges(arm: Arm) -> list[tuple[float, float]]:
    return list(zip(arm.lower.tolist(), arm.upper.tolist(), strict=True))


def test_frames_move_as_the_planner_has_them() -> None:
    seen = set()
    for kind in KINDS:
        for seed in range(6):
            request = random_cell(kind, seed)
            scene, t = scene_of(request), np.linspace(1.0, 7.0, 61)
            for name, frame in frames_of(request).items():
                motion = scene.frames[name].law.motion(t)
                found = frame.at(t)
                known = np.isfinite(motion.yaw)
                np.testing.assert_allclose(found.p[known], motion.p[known], atol=1e-9)
                np.testing.assert_allclose(found.yaw[known], motion.yaw[known], atol=1e-9)
                seen.add(scene.frames[name].law.kind)
    laws = {"fixed", "conveyor", "linear", "turntable", "indexer", "oscillation", "swing", "keyframes", "link"}
    assert seen == laws


# what is planted is found


def run(asked: Document, real: Document, **changes: object) -> Outcome:
    """Plans what is asked, and runs the plan in the cell as it is."""
    answer = planned(asked)
    return simulated(as_si(real), answer, 20, np.random.default_rng(0))[0]


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


def test_a_correction_moves_the_elbow_of_a_stretched_arm_by_more_than_the_tool() -> None:
    arm = Arm.of({"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_m": [0.0, 0.0, -0.1]}})
    q = np.array([0.2, 0.3, 0.3, 0.0])
    before = arm.links(q)
    inwards = -0.006 * before["flange"].p * (1.0, 1.0, 0.0) / np.hypot(*before["flange"].p[:2])
    after = arm.links(arm.corrected(q, inwards))
    np.testing.assert_allclose(after["flange"].p - before["flange"].p, inwards, atol=1e-12)
    moved = float(np.linalg.norm(after["link2"].p - before["link2"].p))
    assert 0.006 * 1.5 < moved < 0.02


def test_a_gate_strikes_a_part_that_was_put_down() -> None:
    strikes, without = set_down(69, stay_safe_s=2), set_down(69, stay_safe_s=2)
    without["bodies"] = [body for body in without["bodies"] if body["name"] != "bar"]
    assert bodies(run(without, strikes), "collision") >= {"part", "bar"}


def test_a_neighbour_that_was_not_told_of_is_met() -> None:
    real = beside_a_neighbour(0)
    asked = {key: value for key, value in real.items() if key != "neighbours"}
    assert {name for name in bodies(run(asked, real), "collision") if name.startswith("other/")}


def test_joints_that_lag_are_seen() -> None:
    asked = between_walls({}, {"start_tolerance_ms": 0}, held_within={})
    real = between_walls({}, {"lag": {"j1_deg": 0.5, "j3_mm": 1}}, held_within={})
    outcome = run(asked, real)
    assert kinds(outcome) >= {"contact", "error"}


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


# the plans


def test_kinds_and_seeds_make_the_same_request_again() -> None:
    for kind in KINDS:
        assert json.dumps(random_cell(kind, 7)) == json.dumps(random_cell(kind, 7))
        assert json.dumps(random_cell(kind, 7)) != json.dumps(random_cell(kind, 8))


def test_twenty_plans_keep_what_they_promise(tmp_path: Path) -> None:
    *_, found = campaign(20, seed=4, out=tmp_path)
    total = Tally()
    for tally in found.values():
        total.merged(tally)
    assert (total.evaluated, total.runs) == (20, 400)
    assert not list(tmp_path.iterdir()), [file.read_text() for file in tmp_path.glob("*.faults.json")]
    assert (total.clean, total.collisions) == (True, 0)
    assert total.deepest_m <= total.deepest_allowed_m
    assert len(total.ratios) >= 20
    assert min(total.ratios) >= 1.0 - 1e-6
    assert total.median is not None
    assert total.median <= 1.3


def test_a_cell_whose_arm_cannot_stand_with_its_elbow_there_is_counted_as_refused(tmp_path: Path) -> None:
    kind, seed, tally = "table to table", 211, Tally()  # a right elbow, with which j1 would be beyond its range
    request = random_cell(kind, seed)
    assert not counted(tally, kind, seed, request, tmp_path)
    assert (tally.evaluated, tally.runs, dict(tally.refused)) == (0, 0, {ELBOW: 1})
    assert not list(tmp_path.iterdir())
    assert tally.clean  # no plan was run, so none broke a promise
    request["start"]["elbow"] = "left"  # the other side is within the ranges
    assert counted(tally, kind, seed, request, tmp_path, 8) or set(tally.refused) > {ELBOW}


def test_any_other_fault_of_a_cell_is_raised() -> None:
    kind, seed, tally = "table to table", 211, Tally()
    request = random_cell(kind, seed)
    request["robot"]["model"] = "no-robot"
    with pytest.raises(ValueError, match=r"robot\.model"):
        counted(tally, kind, seed, request)


def test_a_case_that_fails_is_written_as_a_scenario(tmp_path: Path) -> None:
    kind = "belt to table"
    seed, request, answer = next(
        (seed, request, answer)
        for seed in range(20)
        for request in [random_cell(kind, seed)]
        for answer in [plan_document(request)]
        if answer["status"] == "planned"
    )
    worse = copy.deepcopy(request)
    worse["frames"]["source"].setdefault("uncertainty", {})["position_m"] = 0.05
    outcome, real = simulated(worse, answer, 20, np.random.default_rng(0))
    assert "error" in kinds(outcome)
    file = keep(tmp_path, f"{kind}-{seed}", worse, {"faults": faults_of(outcome, real)})
    assert load(file) == json.loads(json.dumps(worse))
    told = json.loads((tmp_path / f"{file.stem}.faults.json").read_text())
    first = told["faults"][0]
    assert abs(first["realised"]["frames"]["source"]["along"]) <= 1.0
    assert shipped("demo").request["schema"] == "assur/1"
