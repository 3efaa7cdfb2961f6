"""The text of a scenario over HTTP: the request that it means, or its faults, each with its line."""

from __future__ import annotations

import base64
from typing import Any

import httpx
import numpy as np
import pytest

from assur.api.web.service import scenario_request
from assur.scenes.requests import BUDGETS
from assur.scenes.scenarios import shipped_scenarios
from tests.api.running import PATIENT

TEXT = """\
about: an arm between two poses
request:
  schema: assur/1
  robot: {model: mitsubishi-rh-6frh5520, tool: {tcp_mm: [0, 0, 0]}}
  start: {joints: {j1_deg: 0, j2_deg: 60, j3_mm: 250, j4_deg: 0}}
  task:
    - move:
        to: {at_mm: [400, 0, 250], yaw_deg: 0}
"""


def parsed(client: httpx.Client, text: object) -> httpx.Response:
    return client.post("/v1/scenes/parse", json={"text": text})


@pytest.mark.parametrize("name", sorted(shipped_scenarios()))
def test_the_text_of_a_shipped_scenario_means_its_request(client: httpx.Client, name: str) -> None:
    text = client.get(f"/v1/scenes/{name}/text")
    assert text.headers["content-type"].startswith("application/yaml")
    response = parsed(client, text.text)
    assert response.status_code == 200, response.text
    told = response.json()
    assert told["status"] == "parsed"
    assert told["about"] == shipped_scenarios()[name]
    assert told["request"] == scenario_request(name)
    # what the service offers to be posted has budgets that it gives
    offered = client.get(f"/v1/scenes/{name}").json()
    for budget in BUDGETS:
        stated = told["request"]["options"].pop(budget, None)
        assert offered["options"].pop(budget, None) == (None if stated is None else min(stated, PATIENT.max_budget_s))
    assert offered == told["request"]


def test_what_was_parsed_can_be_planned(client: httpx.Client) -> None:
    request = parsed(client, TEXT).json()["request"]
    request["options"] = {"stop": "first", "max_candidates": 50}
    assert client.post("/v1/plans", json=request).json()["status"] == "planned"


@pytest.mark.parametrize(
    ("old", "new", "field", "line"),
    [
        ("j2_deg: 60", "j2_deg: sixty", "request.start.joints.j2_deg", 5),
        ("j2_deg: 60", "j2_deg: 600", "request.start.joints.j2_deg", 5),
        ("mitsubishi-rh-6frh5520", "mitsubishi-rh-6frh", "request.robot.model", 4),
        ("[400, 0, 250]", "[400, 0]", "request.task[0].move.to.at_mm", 8),
        ("yaw_deg: 0}", "yaw_deg: 0, frame: belt}", "request.task[0].move.to.frame", 8),
        ("  task:", "  tasks:", "request.tasks", 6),
        ("about: an arm between two poses\n", "", "about", 1),
        ("    - move:", "    - move: [", None, 9),
        ("robot: {", "robot: {file: /etc/passwd, ", "request.robot.file", 4),
        ("robot: {model: mitsubishi-rh-6frh5520", "robot: {file: ../../../etc/passwd", "request.robot.file", 4),
    ],
)
def test_a_fault_is_told_with_its_line(client: httpx.Client, old: str, new: str, field: str | None, line: int) -> None:
    assert old in TEXT
    response = parsed(client, TEXT.replace(old, new))
    assert response.status_code == 422, response.text
    first, *_ = response.json()["errors"]
    assert first["line"] == line
    if field is not None:
        assert first["field"] == field
    assert "root:" not in response.text


def test_further_faults_have_their_lines(client: httpx.Client) -> None:
    text = TEXT.replace("j2_deg: 60", "j2_deg: sixty").replace("yaw_deg: 0}", "yaw_deg: none}")
    errors: list[dict[str, Any]] = parsed(client, text).json()["errors"]
    assert [error["line"] for error in errors] == [5, 8]


def test_a_text_with_a_lone_surrogate_is_refused(client: httpx.Client) -> None:
    body, headers = b'{"text": "\\ud800"}', {"Content-Type": "application/json"}
    assert client.post("/v1/scenes/parse", content=body, headers=headers).status_code == 400


@pytest.mark.parametrize(
    "text", ["", "a: &x [*x, *x]", "!!python/object:os.system {}", "\x00", "[" * 5000, "x" * 10**6]
)
def test_a_text_that_is_no_scenario_is_refused(client: httpx.Client, text: str) -> None:
    response = parsed(client, text)
    assert response.status_code in (413, 422), response.text
    assert len(response.content) < 4000


def test_the_text_of_a_scenario_that_is_not_shipped_is_not_found(client: httpx.Client) -> None:
    for name in ("nothing", "..%2fdemo", "__init__"):
        assert client.get(f"/v1/scenes/{name}/text").status_code == 404


def test_a_drawing_shows_the_arm_at_its_start(client: httpx.Client) -> None:
    told = client.post("/v1/scenes/parse", json={"text": TEXT, "draw": True}).json()
    view, places = told.pop("view"), told.pop("places")
    assert [each["kind"] for each in places] == ["robot", "tool", "step"]
    assert told == parsed(client, TEXT).json()
    assert (view["status"], view["refusal"], view["moves"], view["curves"]) == ("not_planned", None, False, None)
    at = client.post("/v1/ik", json={"request": told["request"], "joints": told["request"]["start"]["joints"]}).json()
    tool = np.frombuffer(base64.b64decode(view["tool"]["path_m"]["float32"]), "<f4")[:3]
    assert np.abs(tool - at["tool"]["world"]["at_m"]).max() < 1e-6


def test_values_and_moves_are_written_into_the_texts(client: httpx.Client) -> None:
    text = TEXT.replace(
        "  task:", "  bodies: [{name: post, shape: {sphere: {radius_mm: 9}}, pose: {at_mm: [1, 2, 3]}}]\n  task:"
    )
    move = {"kind": "body", "name": "post", "by_mm": [300, 0.2]}
    question = {"text": text, "set": {"task.0.move.to.yaw_deg": 30}, "move": move, "draw": True}
    told = client.post("/v1/scenes/parse", json=question).json()
    assert told["text"] == text.replace("yaw_deg: 0", "yaw_deg: 30").replace("[1, 2, 3]", "[301, 2, 3]")
    assert "cell" not in told
    again = client.post("/v1/scenes/parse", json={"text": told["text"], "draw": True}).json()
    assert {key: value for key, value in told.items() if key != "text"} == again
