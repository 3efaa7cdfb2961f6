"""`from scenes import load, plan, check`: a request as a plain document, its answer, the checker's word."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from assur.planner.errors import InputError
from assur.scenes import check, load, plan
from assur.scenes.requests import shipped
from tests.refused import refused_at

SCENARIO = """\
about: A tray in a file beside the scenario.
request:
  schema: assur/1
  robot: {model: fanuc-sr-3ia, tool: {tcp_mm: [0, 0, 0]}}
  start: {joints: {j1_deg: 0, j2_deg: 60, j3_mm: 20, j4_deg: 0}}
  bodies:
    - {name: tray, shape: {mesh: {file: tray.stl, unit: mm}}, pose: {at_mm: [0, -300, 20]}}
  task:
    - move: {to: {at_mm: [200, 200, 200]}}
  options: {stop: first, budget_s: 60}
expect: {status: planned}
"""


def test_a_shipped_scenario_is_loaded_planned_and_checked() -> None:
    request = load("standard-cycle")
    request["options"] |= {"stop": "first", "budget_s": 60}
    answer = plan(request)
    assert answer["status"] == "planned"
    assert check(request, answer) == {**check(request, answer), "ok": True, "findings": []}


def test_the_document_is_its_own_each_time() -> None:
    request = load("demo")
    request["task"].clear()
    assert load("demo") == shipped("demo").request


def test_without_its_certificate_an_answer_is_not_checked() -> None:
    request = load("standard-cycle")
    request["options"] |= {"stop": "first", "budget_s": 60}
    answer = plan(request, certificate="digest")
    assert set(answer["certificate"]) == {"digest", "rows", "covers"}
    with pytest.raises(InputError, match="certificate"):
        check(request, answer)


def test_a_scenario_file_is_loaded_with_the_meshes_below_its_folder(tmp_path: Path) -> None:
    (tmp_path / "cell.yaml").write_text(SCENARIO)
    (tmp_path / "tray.stl").write_bytes((Path(__file__).parents[2] / "scenes/assets/tray.stl").read_bytes())
    request = load(tmp_path / "cell.yaml")
    assert set(request["bodies"][0]["shape"]["mesh"]) == {"data", "format", "unit"}
    assert load(str(tmp_path / "cell.yaml")) == request
    (tmp_path / "request.json").write_text(json.dumps(request))
    assert load(tmp_path / "request.json") == request
    assert plan(request, certificate="digest")["status"] == "planned"


def test_a_mesh_outside_of_the_folder_is_refused_with_its_line(tmp_path: Path) -> None:
    (tmp_path / "cell.yaml").write_text(SCENARIO.replace("tray.stl", "../tray.stl"))
    with refused_at("request.bodies[0].shape.mesh.file", line=7):
        load(tmp_path / "cell.yaml")


def test_a_name_that_is_no_scenario_is_refused() -> None:
    with pytest.raises(InputError, match="one of"):
        load("nowhere")


@pytest.mark.parametrize("name", ["nowhere.yaml", "nowhere.json"])
def test_a_file_that_is_not_there_is_said_to_be_missing(name: str, tmp_path: Path) -> None:
    for given in (tmp_path / name, name, tmp_path, "a\0b", "x" * 5000):
        with refused_at("name", match=r"a file that is there, or a shipped scenario, one of .*demo", value=str(given)):
            load(given)
    with pytest.raises(InputError, match=r"did you mean demo\?"):
        load("demo.yaml")
