"""Scenarios 7 to 10: two robots at one nest, a carton, behind the base, a shut gate, a closed mesh, a crowded cell.

What an answer says is held against arithmetic done here: own forward kinematics, SciPy's quintic through the knots.
"""

from __future__ import annotations

import copy
import json
import math
import re
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.interpolate import BPoly

from assur.planner.collision.proof import Prover
from assur.planner.feasibility.necessary import points_impossible
from assur.planner.model.refusal import Reason
from assur.planner.search.candidates import Sampler
from assur.scenes.cells import two_robots
from assur.scenes.requests import check_document, plan_document, plan_scenario, scene_of
from assur.scenes.scenarios import shipped, unmet

Array = NDArray[np.float64]
Document = dict[str, Any]

NAMES = (
    "two-robots",
    "two-robots-neighbour",
    "two-robots-parked",
    "carton",
    "carton-high-rim",
    "behind-the-base",
    "behind-the-base-keep",
    "behind-the-base-straight",
    "shut-gate",
    "inside-a-mesh",
    "crowded",
)
PLANNED = ("two-robots", "two-robots-neighbour", "carton", "behind-the-base", "crowded")
L1, L2 = 0.325, 0.225
"""Links of the RH-6FRH5520, m; its J3 is the flange's height above the base."""
INSTANTS = 4001


@cache
def answer(name: str) -> Document:
    """The answer to a shipped scenario, planned once."""
    return plan_scenario(shipped(name))


def request(name: str) -> Document:
    """A scenario's request, to be changed."""
    return copy.deepcopy(shipped(name).request)


def without(document: Document, *names: str) -> Document:
    """The request without these bodies."""
    left = [body for body in document["bodies"] if body["name"] not in names]
    assert len(left) == len(document["bodies"]) - len(names)
    return {**document, "bodies": left}


class Motion:
    """A trajectory of an RH-6FRH5520 as it runs, standing still before and after its knots."""

    def __init__(
        self, trajectory: Document, *, base: tuple[float, float, float] = (0.0, 0.0, 0.0), tcp: float = -0.1
    ) -> None:
        knots = [np.array(trajectory[key]) for key in ("position", "velocity", "acceleration")]
        self.times = np.array(trajectory["time_s"])
        self.curve = BPoly.from_derivatives(self.times, np.stack(knots, axis=1))
        self.base, self.tcp = base, tcp

    def joints(self, t: Array, order: int = 0) -> Array:
        """Joints (T, 4), or a derivative of them, at times t (T,)."""
        clipped = np.clip(t, self.times[0], self.times[-1])
        return np.asarray(self.curve(clipped, nu=order))

    def elbow(self, t: Array) -> tuple[Array, Array]:
        """Elbow (T, 2) and direction of link 2 (T,) in the world."""
        q = self.joints(t)
        first = self.base[2] + q[:, 0]
        at = np.array(self.base[:2]) + L1 * np.stack([np.cos(first), np.sin(first)], axis=1)
        return at, first + q[:, 1]

    def tool(self, t: Array) -> Array:
        """Tool point (T, 3) in the world."""
        at, angle = self.elbow(t)
        flat = at + L2 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        return np.column_stack([flat, self.joints(t)[:, 2] + self.tcp])

    def link_2(self, t: Array) -> Array:
        """Corners (T, 4, 2) of the outline of link 2: 385 x 140 mm, its middle 112.5 mm beyond the elbow."""
        at, angle = self.elbow(t)
        along = np.stack([np.cos(angle), np.sin(angle)], axis=1)[:, None]
        across = np.stack([-np.sin(angle), np.cos(angle)], axis=1)[:, None]
        x, y = np.array([-0.08, 0.305, 0.305, -0.08])[:, None], np.array([-0.07, -0.07, 0.07, 0.07])[:, None]
        return np.asarray(at[:, None] + x * along + y * across)


def apart(one: Array, other: Array) -> Array:
    """By how much an edge normal of either rectangle (T, 4, 2) separates the two: a lower bound of their distance."""
    gaps = []
    for corners in (one, other):
        for k in (0, 1):
            edge = corners[:, k + 1] - corners[:, k]
            normal = np.stack([-edge[:, 1], edge[:, 0]], axis=1) / np.linalg.norm(edge, axis=1)[:, None]
            a, b = (np.einsum("tij,tj->ti", each, normal) for each in (one, other))
            gaps += [b.min(1) - a.max(1), a.min(1) - b.max(1)]
    return np.asarray(np.max(gaps, axis=0))


def leg(document: Document, kind: str, step: int) -> tuple[float, float]:
    """From when to when the plan has a leg of this kind for a step."""
    return next((x["from_s"], x["to_s"]) for x in document["legs"] if x["kind"] == kind and x["step"] == step)


def arrival(document: Document, name: str) -> Document:
    found: Document = next(x for x in document["arrivals"] if x["control_point"] == name)
    return found


def other(name: str) -> Motion:
    """The other robot as a scenario's file has it."""
    neighbour = shipped(name).request["neighbours"][0]
    return Motion(neighbour["trajectory"], base=(0.8, 0.0, math.pi))


@pytest.mark.parametrize("name", NAMES)
def test_the_cell_comes_out_as_its_file_expects(name: str) -> None:
    scenario = shipped(name)
    assert unmet(scenario.expect, answer(name)) == []
    assert not answer(name)["cut_by_clock"]


@pytest.mark.parametrize("name", PLANNED)
def test_the_checker_accepts_the_plan_as_it_is_written_out(name: str) -> None:
    written = json.loads(json.dumps(answer(name)))
    assert check_document(shipped(name).request, written)["findings"] == []


# Two robots, one nest


def test_the_part_is_placed_only_after_the_other_robot_has_left_the_nest() -> None:
    plan, its = answer("two-robots"), other("two-robots")
    t = np.linspace(0.0, float(its.times[-1]), INSTANTS)
    at_nest = t[np.linalg.norm(its.tool(t) - [0.4, 0.0, 0.05], axis=1) < 1e-5]
    assert at_nest[-1] - at_nest[0] > 0.499
    assert arrival(plan, "place-2")["time_s"] > at_nest[-1]
    alone = {key: value for key, value in request("two-robots").items() if key != "neighbours"}
    undisturbed = plan_document(alone, certificate="digest")
    # the nest is the other's until then; without it our robot would have been there while it still was
    assert arrival(undisturbed, "place-2")["time_s"] < at_nest[-1]
    assert arrival(plan, "place-2")["time_s"] > arrival(undisturbed, "place-2")["time_s"] + 0.3


def test_the_two_arms_never_come_within_the_clearance_of_each_other() -> None:
    ours, its = Motion(answer("two-robots")["trajectory"]), other("two-robots")
    t = np.linspace(0.0, max(ours.times[-1], its.times[-1]), INSTANTS)
    assert apart(ours.link_2(t), its.link_2(t)).min() > 0.0
    shafts = np.linalg.norm(ours.tool(t)[:, :2] - its.tool(t)[:, :2], axis=1)
    assert shafts.min() > 2 * 0.0125 + 0.002  # two radii and the clearance that is asked near the nest


def test_the_direct_way_would_have_hit_the_other_robot() -> None:
    alone = {key: value for key, value in request("two-robots").items() if key != "neighbours"}
    ours, its = Motion(plan_document(alone)["trajectory"]), other("two-robots")
    t = np.linspace(0.0, float(ours.times[-1]), INSTANTS)
    assert apart(ours.link_2(t), its.link_2(t)).min() < 0.0


def test_a_robot_that_is_parked_in_the_nest_is_all_that_keeps_the_part_out() -> None:
    refused, its = answer("two-robots-parked"), other("two-robots-parked")
    end = its.times[-1:]
    assert np.allclose(its.tool(end), [[0.4, 0.0, 0.05]], atol=1e-6, rtol=0)
    assert not its.joints(end, 1).any()
    at_the_nest = [line for line in refused["census"]["lines"] if line["step"] == 1]
    assert sum(line["count"] for line in at_the_nest) > 0
    hit = [line for line in at_the_nest if line["reason"] == "BODY_COLLISION"]
    assert all(any(name.startswith("other/") for name in line["bodies"]) for line in hit)
    assert refused["refusal"]["step"] == 1
    gone = request("two-robots-parked")
    del gone["neighbours"]
    assert plan_document(gone, certificate="digest")["status"] == "planned"


@pytest.mark.parametrize("name", ["two-robots.yaml", "two-robots-parked.yaml"])
def test_the_other_robots_knots_are_what_the_script_writes_and_keep_its_limits(name: str) -> None:
    path = two_robots.CELLS / name
    text = path.read_text(encoding="utf-8").split(two_robots.BEGIN)[1].split(two_robots.END)[0]
    scenario = shipped(path.stem)
    trajectory = scenario.request["neighbours"][0]["trajectory"]
    assert two_robots.knots(trajectory) == text
    its, asked = Motion(trajectory, base=(0.8, 0.0, math.pi)), two_robots.neighbour_request(two_robots.STEPS[name])
    joints = asked["start"]["joints"]
    start = [*(math.radians(joints[f"{j}_deg"]) for j in ("j1", "j2")), joints["j3_mm"] / 1e3, 0.0]
    assert np.allclose(its.joints(its.times[:1]), [start], atol=1e-12, rtol=0)
    t = np.linspace(0.0, float(its.times[-1]), INSTANTS)
    speed = 0.6 * np.array([math.radians(400), math.radians(670), 2.4, math.radians(2500)])
    acceleration = 0.6 * np.array([125.64, 210.42, 43.02, 785.34])
    assert (np.abs(its.joints(t, 1)) <= speed * (1 + 1e-9)).all()
    assert (np.abs(its.joints(t, 2)) <= acceleration * (1 + 1e-9)).all()
    for point in asked["task"]:
        ((_, step),) = point.items()
        target = np.array(step["to"]["at_mm"]) / 1e3
        assert np.linalg.norm(its.tool(np.sort(np.concatenate([t, its.times]))) - target, axis=1).min() < 1e-5


# A carton


def test_the_part_goes_straight_down_into_the_carton_5_mm_from_two_walls() -> None:
    plan = answer("carton")
    ours = Motion(plan["trajectory"], tcp=-0.12)
    t = np.linspace(leg(plan, "APPROACH", 1)[0], leg(plan, "DEPART", 1)[1], INSTANTS)
    tool = ours.tool(t)
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
    wider = request("carton")
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
    lower = request("carton-high-rim")
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
    ours = Motion(answer("behind-the-base")["trajectory"])
    t = np.linspace(0.0, float(ours.times[-1]), INSTANTS)
    j1, j2 = ours.joints(t)[:, 0], ours.joints(t)[:, 1]
    assert j2[0] == pytest.approx(-math.pi / 2)
    assert j2[-1] > 0.3
    assert (np.diff(np.sign(j2)) != 0).sum() in (1, 2)  # 2: a sample falls on 0
    assert np.abs(j2).max() < math.radians(91)
    assert np.abs(j1).max() < math.radians(170)
    assert np.allclose(ours.tool(t[-1:]), [[-0.5282, 0.1123, 0.12]], atol=1e-6, rtol=0)
    assert np.linalg.norm(ours.tool(t)[:, :2], axis=1).max() > L1 + L2 - 1e-4


def test_the_straight_line_is_refused_with_the_millimetres_to_the_stretched_arm() -> None:
    refused = answer("behind-the-base-straight")
    start = Motion(answer("behind-the-base")["trajectory"]).tool(np.zeros(1))[0, :2]
    s = np.linspace(0.0, 1.0, INSTANTS)[:, None]
    radius = np.linalg.norm((1 - s) * start + s * np.array([-0.5282, 0.1123]), axis=1)
    missing = 1e3 * float(np.minimum(L1 + L2 - radius, radius - (L1 - L2)).min())
    found = re.search(r"(\d+\.\d+) mm", refused["sentence"])
    assert found is not None
    assert float(found[1]) == pytest.approx(missing, abs=0.06)
    assert refused["refusal"]["unit"] == "m"
    assert 1e3 * refused["refusal"]["amount"] == pytest.approx(missing, abs=0.06)


def test_a_straight_line_that_needs_no_elbow_change_is_planned() -> None:
    front = request("behind-the-base-straight")
    front["task"][0]["move"]["to"]["at_mm"] = [-100, 400, 120]
    planned = plan_document(front)
    assert planned["status"] == "planned"
    ours = Motion(planned["trajectory"])
    tool = ours.tool(np.linspace(0.0, float(ours.times[-1]), INSTANTS))
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
    open_machine = without(request("shut-gate"), "gate")
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
    refused = plan_document(request("inside-a-mesh"), certificate="digest")
    assert refused["proved"] is True
    assert batches == [refused["census"]["candidates"]]
    assert refused["refusal"]["bodies"] == ["cup", "housing"]
    scene = scene_of(request("inside-a-mesh"))
    never = points_impossible(scene, Prover(scene))
    assert never is not None
    assert (never.reason, never.bodies) == (Reason.CONTROL_POINT_IN_COLLISION, ("cup", "housing"))
    opened = scene_of(without(request("inside-a-mesh"), "housing"))
    assert points_impossible(opened, Prover(opened)) is None
    free = plan_document(without(request("inside-a-mesh"), "housing"), certificate="digest")
    assert free["status"] == "planned"


def test_a_part_cannot_be_lifted_through_the_roof_of_a_hollow_housing_even_by_a_tool_without_a_body() -> None:
    ghost = request("inside-a-mesh")
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
