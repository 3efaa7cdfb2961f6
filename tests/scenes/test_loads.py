"""What an arm may carry, from documents to the answer: read, replaced by a request, told, and verified."""

from __future__ import annotations

import copy
import json
from typing import Any

import pytest

from assur.api.cli.console_report import planned
from assur.planner.model.load import LoadLimits
from assur.scenes.catalogue import shipped_robot
from assur.scenes.requests import cell_of, check_document, request_digest, scene_of
from assur.scenes.robot_facts import assumptions
from assur.scenes.scenarios import shipped
from tests.refused import refused_at
from tests.scenes.bad_requests import GOOD_REQUEST, share
from tests.scenes.cells.answers import answer
from tests.scenes.reading.test_robots import inline

ROWS = [share(3, 1.0), share(6, 0.5)]
CASTING = "heavy-casting"


def stated(value: Any) -> dict[str, Any]:
    return {"value": value, "status": "third_party", "source": "a manual"}


def changed(arm: dict[str, Any], **limits: Any) -> dict[str, Any]:
    """A request with a written-out SCARA of which more is known, and with these limits."""
    document = inline()
    document["robot"]["scara"].update(arm)
    document["robot"]["limits"] = limits
    return document


def loads_of(document: dict[str, Any]) -> LoadLimits:
    return scene_of(document).load_limits


def test_an_arm_says_what_it_may_carry_plainly_or_with_a_source() -> None:
    plain = {"rated_load_kg": 3, "max_load_kg": 6, "max_inertia_kgm2": 0.12, "acceleration_by_load": ROWS}
    expected = LoadLimits(3.0, 6.0, 0.12, ((3.0, 1.0), (6.0, 0.5)))
    assert loads_of(changed(plain)) == expected
    assert loads_of(changed({key: stated(value) for key, value in plain.items()})) == expected
    assert loads_of(changed({})) == LoadLimits()


def test_a_table_of_a_request_is_in_place_of_the_arms_law_and_of_its_table() -> None:
    arm = {"rated_load_kg": 6, "max_load_kg": 6}
    table = [share(4, 0.9), share(5, 0.8)]
    replaced = LoadLimits(6.0, 6.0, None, ((4.0, 0.9), (5.0, 0.8)))
    assert loads_of(changed(arm, acceleration_by_load=table)) == replaced
    assert loads_of(changed({**arm, "acceleration_by_load": ROWS}, acceleration_by_load=table)) == replaced
    with_table, without = changed(arm, acceleration_by_load=table), changed(arm)
    assert request_digest(with_table) != request_digest(without)
    # scales of the limits and the share multiply
    document = changed(arm, acceleration_by_load=[share(0, 0.5)], acceleration=0.5)
    document["robot"]["tool"]["mass_kg"] = 0.0
    scene, whole = scene_of(document), scene_of(changed({}))
    assert (scene.limits_with(None).acceleration == 0.25 * whole.robot.limits.acceleration).all()
    assert (scene.limits_with(None).jerk == 0.5 * whole.robot.limits.jerk).all()


@pytest.mark.parametrize("model", ["elbow-arm", "polar-arm", "mitsubishi-rv-m1"])
def test_an_arm_that_does_not_turn_its_load_about_the_vertical_has_no_maximum_inertia(model: str) -> None:
    ((key, arm),) = shipped_robot(model).document.items()
    robot = {key: {**arm, "max_inertia_kgm2": stated(0.1)}, "tool": {"tcp_mm": [0, 0, 0]}}
    document = {**GOOD_REQUEST, "robot": robot}
    with refused_at(f"robot.{key}.max_inertia_kgm2.value", match="no maximum inertia"):
        scene_of(document)


def test_three_axes_have_no_maximum_inertia_either() -> None:
    document = inline(axes=3)
    document["robot"]["scara"]["max_inertia_kgm2"] = 0.1
    with refused_at("robot.scara.max_inertia_kgm2", match="no fourth joint"):
        scene_of(document)


@pytest.mark.parametrize("number", [float("nan"), float("inf"), 1e9, "2", True, None])
def test_a_mass_that_is_no_mass_is_refused_at_its_field(number: object) -> None:
    for path in (("robot", "tool"), ("bodies", 1)):
        document: Any = copy.deepcopy(GOOD_REQUEST)
        at = document
        for key in path:
            at = at[key]
        at["mass_kg"] = number
        with refused_at("robot.tool.mass_kg" if path[0] == "robot" else "bodies[1].mass_kg"):
            scene_of(document)


def told(document: dict[str, Any]) -> list[str]:
    """The assumptions of the loads."""
    words = ("not known", "rated load of", "not stated", "counts at the tool point")
    return [line for line in scene_of(document).assumptions if any(each in line for each in words)]


def test_what_is_not_known_of_the_loads_is_an_assumption() -> None:
    known = {"rated_load_kg": 3, "max_load_kg": 6, "max_inertia_kgm2": 0.12}
    rated = "rated load (accelerations are not scaled with the load)"
    maximum, inertia = "maximum load (no mass is refused)", "maximum inertia about C (none is refused)"

    def request(*known_of: str, mass: float | None = 1.0) -> dict[str, Any]:
        document = changed({key: known[key] for key in known_of})
        document["robot"]["tool"].pop("mass_kg", None)
        if mass is not None:
            document["robot"]["tool"]["mass_kg"] = mass
        return document

    name = "inline-scara: not known"
    assert told(request(mass=None)) == [f"{name} are {rated}, {maximum}, {inertia}"]
    assert told(request("max_load_kg")) == [f"{name} are {rated}, {inertia}"]
    assert told(request("rated_load_kg")) == [f"{name} is the {inertia}"]
    assert told(request("rated_load_kg", "max_load_kg", mass=3.0)) == [f"{name} is the {inertia}"]
    above = told(request("rated_load_kg", "max_load_kg", mass=4.0))
    assert len(above) == 2
    assert above[1].startswith("inline-scara: above the rated load of 3 kg accelerations and jerks have the share")
    assert told(request("rated_load_kg", "max_load_kg", "max_inertia_kgm2", mass=None)) == [
        "mass_kg is not stated of the tool: it counts as 0 kg"
    ]
    bare = request("rated_load_kg", "max_load_kg", "max_inertia_kgm2")
    bare["robot"]["tool"] = {"tcp_mm": [0, 0, 0], "mass_kg": 1.0}
    assert told(bare) == ["the tool has a mass and no bodies: for its inertia the mass counts at the tool point"]
    bare["robot"]["tool"]["inertia_kgm2"] = 0.01
    assert told(bare) == []


def test_parts_whose_mass_is_not_stated_are_named_if_they_are_carried() -> None:
    document = copy.deepcopy(GOOD_REQUEST)
    assert not any("not stated" in line for line in scene_of(document).assumptions)
    del document["bodies"][1]["mass_kg"]
    silent = [line for line in scene_of(document).assumptions if "not stated" in line]
    assert silent == ["mass_kg is not stated of part: it counts as 0 kg"]
    del document["robot"]["tool"]["mass_kg"]
    assert "mass_kg is not stated of the tool, part: it counts as 0 kg" in scene_of(document).assumptions


def test_a_table_in_a_robots_file_is_an_assumption_if_it_is_not_the_makers_word() -> None:
    arm = {**shipped_robot("mitsubishi-rh-6frh5520").document["scara"], "acceleration_by_load": stated(ROWS)}
    lines = [line for line in assumptions("scara", arm) if "by load" in line]
    assert lines == ["mitsubishi-rh-6frh5520: acceleration by load 3, 1, 6, 0.5 kg, 1, third_party: a manual"]


def test_the_answer_says_what_was_applied() -> None:
    found = answer(CASTING)
    load = found["load"]
    assert {key: load[key] for key in load if key != "carried"} == {
        "rated_kg": None,
        "max_kg": 6.0,
        "max_inertia_kgm2": None,
        "law": "table",
    }
    pick, place = found["arrivals"][:2]
    end = found["start_s"] + found["duration_s"]
    tool, both, again = load["carried"]
    magnet = 1.2 * 0.03**2 / 2
    casting = 3.6 * ((0.12**2 + 0.08**2) / 12 + 0.01**2)  # gripped 10 mm beside its middle
    assert (tool["part"], tool["mass_kg"], tool["acceleration_share"]) == (None, 1.2, 1.0)
    assert both["part"] == "casting"
    assert both["mass_kg"] == pytest.approx(4.8, rel=1e-15)
    assert both["acceleration_share"] == pytest.approx(1.0 - 0.5 * 1.8 / 3, rel=1e-12)
    assert both["inertia_kgm2"] == pytest.approx(magnet + casting, rel=1e-12)
    assert tool["inertia_kgm2"] == again["inertia_kgm2"] == pytest.approx(magnet, rel=1e-12)
    assert [tool["from_s"], tool["to_s"], both["from_s"], both["to_s"], again["from_s"]] == [
        found["start_s"], pick["until_s"], pick["until_s"], place["until_s"], place["until_s"],
    ]  # fmt: skip
    assert again["to_s"] == pytest.approx(end, abs=1e-12)


def test_the_console_tells_each_load_once() -> None:
    lines = [line for line in planned(answer(CASTING)) if isinstance(line, str) and line.startswith("load ")]
    assert lines == [
        "load                tool 1.2 kg, 0.00054 kg·m²; with casting 4.8 kg, 0.00714 kg·m², acceleration and jerk 70 %"
    ]


def test_a_plan_is_refused_for_a_request_whose_table_leaves_less() -> None:
    request, found = copy.deepcopy(shipped(CASTING).request), answer(CASTING)
    cell = cell_of(request)
    request["robot"]["limits"]["acceleration_by_load"][1]["share"] = 0.4
    assert cell_of(request).scene.loads[1].share == pytest.approx(1.0 - 0.6 * 1.8 / 3, rel=1e-12)
    assert cell.scene.loads[1].share == pytest.approx(0.7, rel=1e-12)
    findings = check_document(request, json.loads(json.dumps(found)))["findings"]
    span = next(finding for finding in findings if finding["code"] == "LOAD")
    assert span["what"].startswith("share of casting is 0.64")
    of_limit = [finding for finding in findings if finding["code"] == "LIMIT"]
    assert of_limit
    t0, t1 = (float(word.removesuffix(" s")) for word in span["where"].split(" to "))
    assert all(t0 <= float(finding["where"].removesuffix(" s")) <= t1 for finding in of_limit)
