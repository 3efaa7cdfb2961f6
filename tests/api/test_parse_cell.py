"""The texts of a cell and of a task over HTTP: the request of both, or the cell alone as it is drawn."""

from __future__ import annotations

from typing import Any

import httpx
import pytest

from assur.scenes.requests import robots
from assur.scenes.tasks.joining import joined
from assur.scenes.text.yaml_text import parse_yaml
from tests.scenes.tasks.test_joining import CELL, TASK


def parsed(client: httpx.Client, **body: object) -> Any:
    return client.post("/v1/scenes/parse", json=body)


def test_a_cell_and_a_task_are_one_request(client: httpx.Client) -> None:
    told = parsed(client, text=TASK, cell=CELL).json()
    made = joined(parse_yaml(CELL.encode())[0], parse_yaml(TASK.encode())[0])
    assert told == {"status": "parsed", "about": "", "request": made.request}


def test_a_cell_alone_is_drawn_with_its_positions_and_has_no_request(client: httpx.Client) -> None:
    told = parsed(client, cell=CELL, draw=True).json()
    assert told.keys() == {"status", "about", "view", "places"}
    assert told["status"] == "cell"
    assert [point["name"] for point in told["view"]["control_points"]] == ["home"]
    assert {"table"} <= {body["name"] for body in told["view"]["bodies"]}


@pytest.mark.parametrize("robot", sorted(each["model"] for each in robots()))
def test_every_robot_of_the_catalogue_stands_in_a_cell(client: httpx.Client, robot: str) -> None:
    cell = f"schema: assur-cell/1\nrobot: {{model: {robot}, tool: {{tcp_mm: [0, 0, 0]}}}}\n"
    response = parsed(client, cell=cell, draw=True)
    assert response.status_code == 200, response.text
    assert response.json()["view"]["control_points"] == []


@pytest.mark.parametrize(
    ("body", "field", "line"),
    [
        (
            {"text": TASK, "cell": CELL.replace("at_mm: [350, 0, 150]", "at_mm: [350, 0]")},
            "cell: positions.home.at_mm",
            13,
        ),
        ({"text": TASK.replace("to: home", "to: hom"), "cell": CELL}, "steps[1].move.to", 11),
        ({"text": TASK, "cell": "schema: [\n"}, "cell: scenario", 2),
        ({"text": TASK, "cell": ""}, "cell: cell", 1),
        ({"text": CELL, "cell": CELL}, "schema", 2),
        ({"text": "", "cell": CELL}, "schema", 1),
        ({"cell": "a: 1"}, "cell: robot", 1),
        ({"cell": TASK}, "cell: schema", 2),
    ],
)
def test_a_fault_is_told_in_its_text_and_at_its_line(client: httpx.Client, body: Any, field: str, line: int) -> None:
    response = parsed(client, **body, draw=True)
    assert response.status_code == 422, response.text
    found = [(each["field"], each.get("line")) for each in response.json()["errors"]]
    assert (field, line) in found


def test_what_is_drawn_is_where_it_is_written(client: httpx.Client) -> None:
    emoji = f"# \U0001f600\n{TASK}"  # two units of UTF-16, which JavaScript counts
    told = parsed(client, text=emoji, cell=CELL, draw=True).json()
    texts = {"text": emoji.encode("utf-16-le"), "cell": CELL.encode("utf-16-le")}
    found = {
        (each["kind"], each["name"]): texts[each["written"]][2 * each["begin"] : 2 * each["end"]].decode("utf-16-le")
        for each in told["places"]
    }
    assert found["body", "table"] == CELL.split("bodies: [")[1].split("]\npositions")[0]
    assert found["body", "c"] == "{name: c, kind: bracket, slot: {box: 2}}"
    assert found["robot", ""] == "robot: {model: mitsubishi-rh-6frh5520, tool: {tcp_mm: [0, 0, -100]}}"
    assert found["tool", ""] == "tool: {tcp_mm: [0, 0, -100]}"
    assert found["step", "0"] == found["step", "1"] == "transfer: {parts: [a, b], to: box, window_mm: [-300, 250]}"
    assert found["step", "4"] == "move: {to: home}"
    alone = parsed(client, cell=CELL, draw=True).json()["places"]
    (home,) = [each for each in alone if each["kind"] == "step"]
    assert CELL[home["begin"] : home["end"]] == "home: {at_mm: [350, 0, 150]}"


def test_a_block_ends_with_its_last_value(client: httpx.Client) -> None:
    text = client.get("/v1/scenes/demo/text").text
    told = parsed(client, text=text, draw=True).json()
    found = {(each["kind"], each["name"]): text[each["begin"] : each["end"]] for each in told["places"]}
    assert found["body", "part"].startswith("name: part\n")
    assert found["body", "part"].endswith("yaw_symmetry: 2")
    assert found["body", "bar"].startswith("{name: bar,")
    assert found["step", "0"].startswith("pick:\n")
    assert found["step", "0"].endswith("depart: {mm: 40}")
