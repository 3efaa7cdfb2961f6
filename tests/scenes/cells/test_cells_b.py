"""Two robots at one nest, a carton, behind the base, a shut gate, a closed mesh, a crowded cell.

What an answer says is held against arithmetic done here and in `tests.scenes.cells.second_kinematics`.
"""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
import pytest

from assur.planner.collision.proof import Prover
from assur.planner.feasibility.necessary import points_impossible
from assur.planner.model.refusal import Reason
from assur.planner.search.candidates import Sampler
from assur.scenes.cells import two_robots
from assur.scenes.requests import plan_document, scene_of
from assur.scenes.scenarios import shipped
from tests.scenes.cells.second_kinematics import (
    ACCELERATION,
    L1,
    L2,
    VELOCITY,
    Document,
    Motion,
    answer,
    apart,
    arrival,
    changed,
    leg,
)

INSTANTS = 4001


def without(document: Document, *names: str) -> Document:
    """The request without these bodies."""
    left = [body for body in document["bodies"] if body["name"] not in names]
    assert len(left) == len(document["bodies"]) - len(names)
    return {**document, "bodies": left}


def other(name: str) -> Motion:
    """The other robot as a scenario's file has it."""
    neighbour = shipped(name).request["neighbours"][0]
    return Motion(neighbour, base=(0.8, 0.0, math.pi))


# Two robots, one nest


def test_the_part_is_placed_only_after_the_other_robot_has_left_the_nest() -> None:
    plan, its = answer("two-robots"), other("two-robots")
    t = np.linspace(0.0, float(its.times[-1]), INSTANTS)
    at_nest = t[np.linalg.norm(its.point(t) - [0.4, 0.0, 0.05], axis=1) < 1e-5]
    assert at_nest[-1] - at_nest[0] > 0.499
    assert arrival(plan, "place-2")["time_s"] > at_nest[-1]
    alone = {key: value for key, value in changed("two-robots").items() if key != "neighbours"}
    undisturbed = plan_document(alone, certificate="digest")
    # the nest is the other's until then; without it our robot would have been there while it still was
    assert arrival(undisturbed, "place-2")["time_s"] < at_nest[-1]
    assert arrival(plan, "place-2")["time_s"] > arrival(undisturbed, "place-2")["time_s"] + 0.3


def test_the_two_arms_never_come_within_the_clearance_of_each_other() -> None:
    ours, its = Motion(answer("two-robots")), other("two-robots")
    t = np.linspace(0.0, max(ours.times[-1], its.times[-1]), INSTANTS)
    assert apart(ours.link_2(t), its.link_2(t)).min() > 0.0
    shafts = np.linalg.norm(ours.point(t)[:, :2] - its.point(t)[:, :2], axis=1)
    assert shafts.min() > 2 * 0.0125 + 0.002  # two radii and the clearance that is asked near the nest


def test_the_direct_way_would_have_hit_the_other_robot() -> None:
    alone = {key: value for key, value in changed("two-robots").items() if key != "neighbours"}
    ours, its = Motion(plan_document(alone)), other("two-robots")
    t = np.linspace(0.0, float(ours.times[-1]), INSTANTS)
    assert apart(ours.link_2(t), its.link_2(t)).min() < 0.0


def test_a_robot_that_is_parked_in_the_nest_is_all_that_keeps_the_part_out() -> None:
    refused, its = answer("two-robots-parked"), other("two-robots-parked")
    end = its.times[-1:]
    assert np.allclose(its.point(end), [[0.4, 0.0, 0.05]], atol=1e-6, rtol=0)
    assert not its.joints(end, 1).any()
    at_the_nest = [line for line in refused["census"]["lines"] if line["step"] == 1]
    assert sum(line["count"] for line in at_the_nest) > 0
    hit = [line for line in at_the_nest if line["reason"] == "BODY_COLLISION"]
    assert all(any(name.startswith("other/") for name in line["bodies"]) for line in hit)
    assert refused["refusal"]["step"] == 1
    gone = changed("two-robots-parked")
    del gone["neighbours"]
    assert plan_document(gone, certificate="digest")["status"] == "planned"


@pytest.mark.parametrize("name", ["two-robots.yaml", "two-robots-parked.yaml"])
def test_the_other_robots_knots_are_what_the_script_writes_and_keep_its_limits(name: str) -> None:
    path = two_robots.CELLS / name
    text = path.read_text(encoding="utf-8").split(two_robots.BEGIN)[1].split(two_robots.END)[0]
    scenario = shipped(path.stem)
    trajectory = scenario.request["neighbours"][0]["trajectory"]
    assert two_robots.knots(trajectory) == text
    its, asked = (
        Motion({"trajectory": trajectory}, base=(0.8, 0.0, math.pi)),
        two_robots.neighbour_request(two_robots.STEPS[name]),
    )
    joints = asked["start"]["joints"]
    start = [*(math.radians(joints[f"{j}_deg"]) for j in ("j1", "j2")), joints["j3_mm"] / 1e3, 0.0]
    assert np.allclose(its.joints(its.times[:1]), [start], atol=1e-12, rtol=0)
    t = np.linspace(0.0, float(its.times[-1]), INSTANTS)
    speed, acceleration = 0.6 * VELOCITY, 0.6 * ACCELERATION
    assert (np.abs(its.joints(t, 1)) <= speed * (1 + 1e-9)).all()
    assert (np.abs(its.joints(t, 2)) <= acceleration * (1 + 1e-9)).all()
    for point in asked["task"]:
        ((_, step),) = point.items()
        target = np.array(step["to"]["at_mm"]) / 1e3
        assert np.linalg.norm(its.point(np.sort(np.concatenate([t, its.times]))) - target, axis=1).min() < 1e-5


# A carton


def test_the_part_goes_straight_down_into_the_carton_5_mm_from_two_walls() -> None:
    plan = answer("carton")
    ours = Motion(plan, tcp=-0.12)
    t = np.linspace(leg(plan, "APPROACH", 1)[0], leg(plan, "DEPART", 1)[1], INSTANTS)
    tool = ours.point(t)
    assert np.abs(tool[:, :2] - [0.485, 0.17]).max() < 1e-5
    yaw = ours.joints(t)[:, [0, 1, 3]].sum(1)
    assert np.abs(np.sin(yaw)).max() < 1e-5  # along the walls: 0 or 180 degrees, for the part looks the same turned
    assert tool[[0, -1], 2] == pytest.approx([0.195, 0.195], abs=1e-6)
    assert tool[:, 2].min() == pytest.approx(0.035, abs=1e-6)
    nearest = plan["margins"]["nearest"]
    assert nearest["gap_m"] == pytest.approx(0.005, abs=1e-6)
    assert "soap" in nearest["bodies"]
    assert {"wall-far", "wall-left"} & set(nearest["bodies"])


def test_a_clearance_of_more_than_5_mm_cannot_be_kept_in_the_carton() -> None:
    wider = changed("carton")
    wider["options"]["clearance_mm"]["near"] = 5.1
    refused = plan_document(wider, certificate="digest")
    assert refused["status"] == "not_planned"
    assert refused["refusal"]["step"] == 1
    assert refused["refusal"]["bodies"][0] == "soap"
    assert refused["refusal"]["bodies"][1] in ("wall-far", "wall-left")
    assert refused["refusal"]["amount"] == pytest.approx(1e-4, abs=1e-6)


def test_a_higher_rim_is_refused_for_the_12_mm_that_j3_lacks_and_not_for_a_wall() -> None:
    refused = answer("carton-high-rim")
    refusal = refused["refusal"]
    assert (refusal["bodies"], refusal["joint"]) == ([], "j3")
    assert refusal["unit"] == "m"
    assert refusal["amount"] == pytest.approx(0.225 + 0.12 - 0.333, abs=1e-9)
    assert "j3" in refused["sentence"]
    assert "wall" not in refused["sentence"]
    placing = [line for line in refused["census"]["lines"] if line["step"] == 1]
    assert placing
    assert all(line["joint"] == "j3" for line in placing)


def test_the_higher_rim_is_no_hindrance_where_j3_has_12_mm_left() -> None:
    lower = changed("carton-high-rim")
    lower["frames"]["carton"]["fixed"]["at_mm"][2] -= 13
    assert plan_document(lower, certificate="digest")["status"] == "planned"


# Behind the base


def test_with_the_elbow_kept_j1_lacks_what_trigonometry_says() -> None:
    radius, angle = math.hypot(0.5282, 0.1123), math.atan2(0.1123, -0.5282)
    inner = math.acos((L1**2 + radius**2 - L2**2) / (2 * L1 * radius))
    assert angle + inner > math.radians(170) > angle - inner  # J2 negative, J2 positive
    refused = answer("behind-the-base-keep")
    assert refused["refusal"]["joint"] == "j1"
    assert refused["refusal"]["amount"] == pytest.approx(angle + inner - math.radians(170), abs=1e-9)
    assert refused["census"]["candidates"] == 0
    assert refused["relaxation"]["what"] == "elbow"
    assert refused["relaxation"]["value"] == "auto"
    assert refused["relaxation"]["duration_s"] > 0


def test_with_a_free_elbow_the_arm_is_stretched_once_and_never_folded() -> None:
    ours = Motion(answer("behind-the-base"))
    t = np.linspace(0.0, float(ours.times[-1]), INSTANTS)
    j1, j2 = ours.joints(t)[:, 0], ours.joints(t)[:, 1]
    assert j2[0] == pytest.approx(-math.pi / 2)
    assert j2[-1] > 0.3
    assert (np.diff(np.sign(j2)) != 0).sum() in (1, 2)  # 2: a sample falls on 0
    assert np.abs(j2).max() < math.radians(91)
    assert np.abs(j1).max() < math.radians(170)
    assert np.allclose(ours.point(t[-1:]), [[-0.5282, 0.1123, 0.12]], atol=1e-6, rtol=0)
    assert np.linalg.norm(ours.point(t)[:, :2], axis=1).max() > L1 + L2 - 1e-4


def test_the_straight_line_is_refused_with_the_millimetres_to_the_stretched_arm() -> None:
    refused = answer("behind-the-base-straight")
    start = Motion(answer("behind-the-base")).point(np.zeros(1))[0, :2]
    s = np.linspace(0.0, 1.0, INSTANTS)[:, None]
    radius = np.linalg.norm((1 - s) * start + s * np.array([-0.5282, 0.1123]), axis=1)
    missing = 1e3 * float(np.minimum(L1 + L2 - radius, radius - (L1 - L2)).min())
    found = re.search(r"(\d+\.\d+) mm", refused["sentence"])
    assert found is not None
    assert float(found[1]) == pytest.approx(missing, abs=0.06)
    assert refused["refusal"]["unit"] == "m"
    assert 1e3 * refused["refusal"]["amount"] == pytest.approx(missing, abs=0.06)


def test_a_straight_line_that_needs_no_elbow_change_is_planned() -> None:
    front = changed("behind-the-base-straight")
    front["task"][0]["move"]["to"]["at_mm"] = [-100, 400, 120]
    planned = plan_document(front)
    assert planned["status"] == "planned"
    ours = Motion(planned)
    tool = ours.point(np.linspace(0.0, float(ours.times[-1]), INSTANTS))
    way = tool[-1] - tool[0]
    off = tool - tool[0] - ((tool - tool[0]) @ way / (way @ way))[:, None] * way
    assert np.linalg.norm(off, axis=1).max() < 1e-5


# A gate that never opens


def test_the_shut_gate_is_named_with_the_interval_in_which_it_was_in_the_way() -> None:
    refused = answer("shut-gate")
    assert re.search(r"gate.*between \d+\.\d\d s and \d+\.\d\d s", refused["sentence"])
    assert "gate" in refused["refusal"]["bodies"]
    first, last = refused["refusal"]["interval_s"]
    assert 0.0 < first < last
    # trembling by two degrees, it was asked over more than one of its periods
    assert last - first > 0.5 * 1.6


def test_the_gate_is_all_that_bars_the_way() -> None:
    assert answer("shut-gate")["relaxation"]["what"] == "without"
    assert answer("shut-gate")["relaxation"]["value"] == "gate"
    open_machine = without(changed("shut-gate"), "gate")
    assert plan_document(open_machine, certificate="digest")["status"] == "planned"


# A part inside a closed mesh


def test_what_is_inside_a_closed_mesh_is_refused_with_proof_after_one_batch_of_candidates(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Not before any: where a first batch goes through, as nearly always, the question of what can never be met need
    not be paid for (a thirtieth of a second in the crowded cell). So one batch is the strongest that is true, and it is
    only the price: the proof itself looks at no candidate."""
    batches: list[int] = []
    draw = Sampler.batch

    def counted(self: Sampler, before: float) -> list[Any]:
        found = draw(self, before)
        batches.append(len(found))
        return found

    monkeypatch.setattr(Sampler, "batch", counted)
    refused = plan_document(changed("inside-a-mesh"), certificate="digest")
    assert refused["proved"] is True
    assert batches == [refused["census"]["candidates"]]
    assert refused["refusal"]["bodies"] == ["cup", "housing"]
    scene = scene_of(changed("inside-a-mesh"))
    never = points_impossible(scene, Prover(scene))
    assert never is not None
    assert (never.reason, never.bodies) == (Reason.CONTROL_POINT_IN_COLLISION, ("cup", "housing"))
    opened = scene_of(without(changed("inside-a-mesh"), "housing"))
    assert points_impossible(opened, Prover(opened)) is None
    free = plan_document(without(changed("inside-a-mesh"), "housing"), certificate="digest")
    assert free["status"] == "planned"


def test_a_part_cannot_be_lifted_through_the_roof_of_a_hollow_housing_even_by_a_tool_without_a_body() -> None:
    ghost = changed("inside-a-mesh")
    del ghost["robot"]["tool"]["bodies"]  # the shaft ends 22 mm above the housing
    ghost["options"]["max_candidates"] = 40
    refused = plan_document(ghost, certificate="digest")
    assert refused["status"] == "not_planned"
    assert {"nut", "housing"} <= {name for line in refused["census"]["lines"] for name in line["bodies"]}


# A crowded cell


def test_the_crowded_cell_has_100_bodies_and_the_proof_covers_each_of_them() -> None:
    bodies = shipped("crowded").request["bodies"]
    assert len(bodies) == 100
    meshes = [body for body in bodies if "mesh" in body["shape"]]
    assert len(meshes) >= 50
    assert {body["shape"]["mesh"]["asset"] for body in meshes} == {"tray", "bracket", "flange", "housing"}
    certificate = answer("crowded")["certificate"]
    names = certificate["names"]
    asked = {names[i] for key in ("first", "second") for i in certificate[key] if i >= 0}
    behind = {names[i] for i, k in zip(certificate["first"], certificate["second"], strict=True) if k < 0}
    # what is not named stands still beyond a plane that every body of the arm stays behind
    assert {body["name"] for body in bodies if body["pose"].get("frame", "world") != "world"} <= asked
    assert {"base-column", "link-1", "link-2", "shaft", "stem", "cup"} <= behind


def test_the_smallest_clearance_of_the_crowded_cell_is_that_to_the_next_bracket() -> None:
    nearest = answer("crowded")["margins"]["nearest"]
    assert 0.0015 <= nearest["gap_m"] <= 0.004 + 1e-6  # as asked near the parts; brackets lie 4 mm apart
