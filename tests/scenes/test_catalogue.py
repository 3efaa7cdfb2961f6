"""The catalogue: the numbers of their sources, a status for each, and arms that do not stand in their own way."""

from __future__ import annotations

import json
import math
import random
from pathlib import Path
from typing import Any

import fcl
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import Piece, Primitive
from assur.planner.robots.five_bar import FiveBar
from assur.planner.robots.robot import Robot
from assur.planner.robots.scara import Scara
from assur.planner.robots.tilting import ElbowArm, PolarArm
from assur.scenes.catalogue import FOLDER, arm_named, load_robot, models, robots, shipped_robot
from assur.scenes.conventions import Conventions, JointConvention, as_maker, converted, converted_rates, rates_as_maker
from assur.scenes.requests import plan_document
from assur.scenes.schema.stated import SURE

LISTED = {robot["model"]: robot for robot in robots()}
RAD = math.pi / 180

AUTHORITIES: dict[str, dict[str, Any]] = {
    # l1, l2 (m); ranges, velocities, accelerations in SI, as the makers give them
    "mitsubishi-rh-6frh5520": {
        "lengths": (0.325, 0.225),
        "range": [(-170 * RAD, 170 * RAD), (-145 * RAD, 145 * RAD), (0.133, 0.333), (-2 * math.pi, 2 * math.pi)],
        "velocity": [400 * RAD, 670 * RAD, 2.4, 2500 * RAD],
        "acceleration": [125.64, 210.42, 43.02, 785.34],
    },
    "mitsubishi-rh-6crh6020": {
        "lengths": (0.325, 0.275),
        "range": [(-132 * RAD, 132 * RAD), (-150 * RAD, 150 * RAD), (-0.051, 0.149), (-2 * math.pi, 2 * math.pi)],
        "velocity": [420 * RAD, 720 * RAD, 1.1, 2500 * RAD],
        "acceleration": [131.94, 226.08, 19.8, 785.34],
    },
    "fanuc-sr-3ia": {
        "lengths": (0.2, 0.2),
        "range": [(-142 * RAD, 142 * RAD), (-145 * RAD, 145 * RAD), (-0.2, 0.0), (-4 * math.pi, 4 * math.pi)],
        "velocity": [720 * RAD, 780 * RAD, 1.8, 3000 * RAD],
    },
    "oviedo-scara": {"lengths": (0.08, 0.05)},
    "fiuba-scara": {"lengths": (0.2, 0.2)},
    "mitsubishi-rp-5ah": {"lengths": (0.2, 0.26)},
    "benchmark-scara": {"lengths": (0.325, 0.275)},
    "olier-scara": {"lengths": (0.25, 0.2)},
    "lab-scara": {"lengths": (0.22, 0.2)},
    "elbow-arm": {"lengths": (0.25, 0.232)},
    "polar-arm": {"lengths": (0.0, 0.0)},
    "mitsubishi-rv-m1": {"lengths": (0.25, 0.16), "velocity": [x * RAD for x in (120, 72, 109, 100, 163)]},
}
SCARAS = [model for model in models() if shipped_robot(model).family == "scara"]


@pytest.mark.parametrize("model", sorted(AUTHORITIES))
def test_an_arm_has_the_numbers_of_its_source(model: str) -> None:
    arm, known = arm_named(model), AUTHORITIES[model]
    robot = _robot(model)
    if isinstance(robot, FiveBar):
        assert (robot.proximal, robot.distal) == tuple((length, length) for length in known["lengths"])
    elif not isinstance(robot, PolarArm):
        assert isinstance(robot, Scara | ElbowArm)
        assert (robot.l1, robot.l2) == known["lengths"]
    if "range" in known:
        np.testing.assert_allclose(np.array(known["range"]).T, [arm.limits.lower, arm.limits.upper], rtol=1e-15, atol=0)
    for name in ("velocity", "acceleration"):
        if name in known:
            np.testing.assert_allclose(getattr(arm.limits, name), known[name], rtol=1e-15)
    if model != "benchmark-scara":
        np.testing.assert_allclose(arm.limits.jerk, arm.limits.acceleration / 0.02, rtol=1e-12)


def test_the_benchmark_robot_is_that_of_the_problems_to_the_bit() -> None:
    problems = json.loads((Path("benchmarks") / "problems" / "static.json").read_text())
    limits = arm_named("benchmark-scara").limits
    for name, key in (
        ("lower", "qmin"),
        ("upper", "qmax"),
        ("velocity", "vmax"),
        ("acceleration", "amax"),
        ("jerk", "jmax"),
    ):
        assert getattr(limits, name).tolist() == problems[key]


def test_every_robot_that_is_named_is_there_and_nothing_else() -> None:
    assert set(models()) == set(LISTED) == set(AUTHORITIES)
    with pytest.raises(InputError, match="benchmark-scara"):
        shipped_robot("unimate")


@pytest.mark.parametrize("model", models())
def test_a_shipped_robot_is_a_file_as_a_user_writes_one(model: str) -> None:
    own = load_robot(FOLDER / f"{model}.yaml")
    assert own.document == shipped_robot(model).document
    assert own.listed() == LISTED[model]
    assert own.document[own.family]["name"] == model


OF_ARM = ("separation", "proximal", "distal", "l1", "l2", "l3", "height", "rated_load", "max_load", "max_inertia")


@pytest.mark.parametrize("model", models())
def test_every_number_has_a_source_and_a_status_and_is_an_assumption_unless_it_is_sure(model: str) -> None:
    listed, assumptions = LISTED[model], list(shipped_robot(model).assumptions)
    numbers = [(model, listed[name]) for name in OF_ARM if name in listed]
    for joint in listed["joints"]:
        for name in ("lower", "upper", "velocity", "acceleration", "jerk", "zero"):
            if name in joint:
                numbers.append((f"{model}: {joint['name']} ", joint[name]))
    numbers.append((f"{model}: solids", {**listed["solids"], "value": listed["solids"]["each"][0]["size"][0]}))
    for of, number in numbers:
        assert number["source"]
        value = number["value"][0] if isinstance(number["value"], list) else number["value"]
        told = [
            line
            for line in assumptions
            if line.startswith(of) and f"{value:g} " in line and f"{number['status']}: {number['source']}" in line
        ]
        assert bool(told) == (number["status"] not in SURE), (of, number)
    unsure = [number for _, number in numbers if number["status"] not in SURE]
    assert len(assumptions) == len(unsure)
    assert json.loads(json.dumps(listed, allow_nan=False))["assumptions"] == assumptions


def test_statuses_of_the_real_robots_are_as_their_sources_are() -> None:
    for model in ("mitsubishi-rh-6frh5520", "mitsubishi-rh-6crh6020"):
        for joint in LISTED[model]["joints"]:
            assert {joint[name]["status"] for name in ("lower", "upper", "velocity")} == {"vendor"}
            assert joint["acceleration"]["status"] == "vendor_config"
            assert joint["jerk"]["status"] == "estimated"
    for joint in LISTED["fanuc-sr-3ia"]["joints"]:
        assert {joint[name]["status"] for name in ("lower", "upper", "velocity")} == {"third_party"}
        assert {joint[name]["status"] for name in ("acceleration", "jerk")} == {"estimated"}


def test_the_placeholder_accelerations_are_what_is_said_of_them() -> None:
    for model in ("mitsubishi-rh-6frh5520", "mitsubishi-rh-6crh6020"):
        limits = arm_named(model).limits
        np.testing.assert_allclose(limits.acceleration / limits.velocity, 18.0, rtol=0.005)


SIGNS = st.sampled_from([1, -1])
VALUES = st.floats(-1e3, 1e3)


@given(st.lists(st.tuples(SIGNS, VALUES), min_size=1, max_size=4), st.randoms(use_true_random=False))
def test_converting_to_the_maker_and_back_is_exact(joints: list[tuple[Any, float]], dice: random.Random) -> None:
    order: list[int | None] = [*range(len(joints))]
    dice.shuffle(order)
    for own in (order, [None] * len(joints)):
        conventions = Conventions(
            JointConvention(f"j{i}", "revolute", sign, place)
            for i, ((sign, _), place) in enumerate(zip(joints, own, strict=True))
        )
        values = np.array([value for _, value in joints]) + 0.0
        assert as_maker(converted(values, conventions), conventions).tobytes() == values.tobytes()
        assert converted(as_maker(values, conventions), conventions).tobytes() == values.tobytes()


@given(st.lists(st.tuples(SIGNS, VALUES, st.floats(-7, 7)), min_size=1, max_size=4))
def test_a_joint_with_a_zero_is_converted_there_and_back_but_for_a_rounding_and_its_rates_exactly(
    joints: list[tuple[Any, float, float]],
) -> None:
    conventions = Conventions(
        JointConvention(f"j{i}", "revolute", sign, None, zero) for i, (sign, _, zero) in enumerate(joints)
    )
    values = np.array([value for _, value, _ in joints]) + 0.0
    there = converted(values, conventions)
    assert there.tolist() == [sign * value + zero for sign, value, zero in joints]
    off = np.abs(as_maker(there, conventions) - values)
    assert (off <= 4e-16 * (np.abs(values) + 7)).all()
    # rounded once, and never again: the knots that are written are those that are read
    once = converted(as_maker(values, conventions), conventions)
    assert converted(as_maker(once, conventions), conventions).tobytes() == once.tobytes()
    assert rates_as_maker(converted_rates(values, conventions), conventions).tobytes() == values.tobytes()


def _robot(model: str) -> Robot:
    arm = arm_named(model)
    return arm.robot(Pose(), arm.limits)


def test_the_five_bar_says_which_of_its_lengths_is_disputed() -> None:
    arm, listed = arm_named("mitsubishi-rp-5ah"), LISTED["mitsubishi-rp-5ah"]
    robot = arm.robot(Pose(), arm.limits)
    assert isinstance(robot, FiveBar)
    assert (robot.separation, listed["separation"]["status"]) == (0.085, "third_party")
    assert (listed["family"], listed["proximal"]["status"]) == ("five_bar", "third_party")
    assert listed["distal"]["status"] == "disputed"
    assert "160" in listed["distal"]["source"]
    for joint in listed["joints"]:
        assert {joint[name]["status"] for name in ("lower", "upper", "velocity", "acceleration", "jerk")} == {
            "estimated"
        }


def test_the_five_bars_couplers_lie_apart_and_the_shaft_runs_through_both() -> None:
    arm = arm_named("mitsubishi-rp-5ah")
    robot = arm.robot(Pose(), arm.limits)
    height = {
        robot.links[item.link]: (
            item.body.pieces[0].position[2] - _half_height(item.body.pieces[0]),
            item.body.pieces[0].position[2] + _half_height(item.body.pieces[0]),
        )
        for item in robot.bodies
    }
    assert height["base"][1] < height["proximal-left"][0]
    assert height["proximal-right"][1] + 0.01 < height["distal-left"][0]
    assert height["distal-left"][1] + 0.01 < height["distal-right"][0]
    for z in (arm.limits.lower[2], arm.limits.upper[2]):
        assert z + height["quill"][0] < height["distal-left"][0]
        assert z + height["quill"][1] > height["distal-right"][1]
    asked = {frozenset(pair) for pair in robot.self_pairs}
    joined = {("proximal-left", "distal-left"), ("proximal-right", "distal-right"), ("distal-left", "quill")}
    assert not asked & {frozenset(pair) for pair in joined}


def _half_height(piece: Piece) -> float:
    assert isinstance(piece.shape, Primitive)
    return float(piece.shape.half[2])


def _scara(model: str) -> Scara:
    robot = _robot(model)
    assert isinstance(robot, Scara)
    return robot


def _objects(robot: Robot, q: Any) -> list[tuple[str, Any]]:
    """The robot's solids as FCL objects, where its link frames are."""
    position, rotation = robot.placements(np.asarray(q, dtype=np.float64))
    found = []
    for body in robot.bodies:
        for piece in body.body.pieces:
            turn = rotation[body.link]
            pose = fcl.Transform(turn @ piece.rotation, position[body.link] + turn @ piece.position)
            found.append((robot.links[body.link], fcl.CollisionObject(_shape(piece), pose)))
    return found


def _shape(piece: Piece) -> Any:
    assert isinstance(piece.shape, Primitive)
    x, y, z = (2 * h for h in piece.shape.half)
    return fcl.Box(x, y, z) if piece.shape.kind == "box" else fcl.Cylinder(piece.shape.disc, z)


def _meet(one: Any, other: Any) -> bool:
    return bool(fcl.collide(one, other, fcl.CollisionRequest(), fcl.CollisionResult()))


def _met(robot: Robot, q: Any) -> set[tuple[str, str]]:
    """The pairs of links of which the request asks, and that meet."""
    objects = _objects(robot, q)
    every = ((a, b, one, other) for a, one in objects for b, other in objects)
    return {(a, b) for a, b, one, other in every if (a, b) in robot.self_pairs and _meet(one, other)}


@pytest.mark.parametrize("model", [*SCARAS, "polar-arm"])
def test_an_arm_without_tool_never_meets_itself_within_its_limits(model: str) -> None:
    robot = _robot(model)
    rng = np.random.default_rng(11)
    lower, upper = robot.limits.lower, robot.limits.upper
    corners = [np.where([(k >> i) & 1 for i in range(len(lower))], lower, upper) for k in range(2 ** len(lower))]
    for q in [*corners, *rng.uniform(lower, upper, (150, len(lower)))]:
        assert _met(robot, q) == set(), q.tolist()


def test_the_elbow_arm_can_meet_itself_so_its_pairs_are_asked() -> None:
    robot = _robot("elbow-arm")
    assert _met(robot, np.radians([0.0, -30.0, -140.0]))
    assert not _met(robot, np.radians([0.0, 60.0, -90.0]))


@pytest.mark.parametrize("model", SCARAS)
def test_the_quill_slides_through_link_2_everywhere_so_that_pair_is_left_out(model: str) -> None:
    robot = _scara(model)
    assert ("link2", "quill") not in robot.self_pairs
    for z in (robot.limits.lower[2], robot.limits.upper[2]):
        q = np.zeros(len(robot.joints))
        q[1], q[2] = 0.7, z
        objects = dict(_objects(robot, q))
        assert _meet(objects["link2"], objects["quill"])


@pytest.mark.parametrize("model", SCARAS)
def test_a_tool_can_collide_with_column_and_links_so_pairs_with_the_flange_are_named(model: str) -> None:
    robot = _robot(model)
    solid = {robot.links[item.link] for item in robot.bodies} - {"quill"}
    assert {first for first, second in robot.self_pairs if second == "flange"} >= solid


def test_a_tool_that_reaches_into_a_link_of_the_benchmarks_robot_is_refused() -> None:
    mast = {"name": "mast", "shape": {"box": {"size_mm": [20, 20, 400]}}, "at_mm": [0, 0, 200]}
    request = {
        "schema": "assur/1",
        "robot": {"model": "benchmark-scara", "tool": {"tcp_mm": [0, 0, 0], "bodies": [mast]}},
        "start": {"joints": {"q1_deg": 0, "q2_deg": 40, "z_mm": 100, "q4_deg": 0}},
        "task": [{"move": {"to": {"at_mm": [400, 100, 150]}}}],
        "options": {"max_candidates": 10},
    }
    answer = plan_document(request)
    assert (answer["status"], answer["reason"], answer["proved"]) == ("not_planned", "START_IN_COLLISION", True)
    assert "link-2" in answer["sentence"]
    assert "mast" in answer["sentence"]
