"""Requests, plan files and other documents that are pasted or opened in the studio."""

from __future__ import annotations

import copy
import json
from typing import Any

import httpx
import pytest

from assur.scenes.text.yaml_text import parse_yaml
from tests.browser.studio_page import Studio
from tests.scenes.cells.answers import answer
from tests.scenes.view.shown import cell

pytestmark = pytest.mark.slow


def request() -> dict[str, Any]:
    held = copy.deepcopy(cell("transfer").document)
    assert isinstance(held, dict)
    return held


def plan_file(**more: Any) -> dict[str, Any]:
    return {"schema": "assur-plan/1", "title": "line 3", "request": request(), "plan": answer("transfer"), **more}


def parsed(text: str) -> Any:
    """The request in the text of the editor."""
    return parse_yaml(text.encode())[0]["request"]


STRANGE = {
    "schema": "assur/1",
    "robot": {
        "model": "x",
        "words": ["yes", "no", "on", "1e3", "~", "a: b", "#", "", '\u00fc "q" \\ \n', "1:30"],
    },
    "frames": {"y": {}, "off": [], "a b": None, "__proto__": {"true": True}},
    "task": [[[1.5, -2e-7, 1e21, 0]], {"long" * 20: "value " * 30, "deep": [{"er": ["x" * 90, 1]}, {}]}],
}
"""What YAML may read as something else."""


@pytest.mark.parametrize("way", ["pasted", "opened", "dropped"])
def test_a_request_in_json_becomes_a_scenario(studio: Studio, way: str) -> None:
    content = json.dumps(request())
    if way == "pasted":
        studio.pasted(content)
    elif way == "opened":
        studio.opened("cell.json", content)
    else:
        studio.dropped(("cell.json", content.encode()))
    studio.until("document.getElementById('text').value.startsWith('about: \"Opened from')")
    assert parsed(studio.text) == request()
    assert studio.saved("text") == (
        "Opened-from-the-clipboard.yaml" if way == "pasted" else "cell.yaml",
        studio.text.encode(),
    )
    studio.planned()
    studio.undo()
    assert "dial" in studio.text  # of the demo, which was there before


def test_every_value_of_a_request_is_the_same_in_its_scenario(studio: Studio) -> None:
    studio.pasted(json.dumps(STRANGE))
    studio.until("document.getElementById('text').value.startsWith('about: \"Opened from')")
    assert parsed(studio.text) == STRANGE
    assert max(map(len, studio.text.splitlines())) < 300
    assert len(studio.text.splitlines()) > 8


def test_a_plan_file_shows_its_plan_and_its_request_and_is_not_planned(studio: Studio, service: httpx.Client) -> None:
    held = plan_file(about="Two trays.")
    studio.opened("cell-plan.json", json.dumps(held))
    studio.player()
    assert studio.page.locator("#answers figcaption strong").inner_text() == "line 3"
    assert f"planned, {held['plan']['duration_s']:.3f} s" in studio.page.locator("#answers figcaption").inner_text()
    assert not studio.page.locator("#answers .stale").is_visible()
    assert parsed(studio.text) == request()
    assert studio.text.startswith('about: "Two trays."\n')
    assert not any("v1/jobs" in address for address in studio.asked)
    name, content = studio.saved("plan")
    assert name == "line-3-plan.json"
    assert json.loads(content) == held
    assert service.post("/v1/plans/check", content=content, headers={"Content-Type": "application/json"}).json()["ok"]
    assert studio.saved("text")[0] == "cell-plan.yaml"


def test_what_the_studio_saved_it_takes_again(studio: Studio) -> None:
    studio.choose("transfer")
    studio.planned()
    content = studio.saved("plan")[1].decode()
    studio.choose("demo")
    studio.pasted(content)
    studio.until("document.querySelector('#answers figcaption span').textContent.startsWith('answer 2: planned')")
    assert parsed(studio.text) == json.loads(content)["request"]


def test_a_plan_file_that_is_not_right_is_refused_and_the_text_stays(studio: Studio) -> None:
    before = studio.text
    other = plan_file()
    other["request"]["options"] = {"seed": 77}
    for held, said in (
        (other, "plan.request_digest"),
        (plan_file(extra=1), "an object with the fields"),
        (plan_file(schema="assur-plan/9"), "assur-plan/1"),
        ({"schema": "assur-plan/1", "request": request()}, "without its plan"),
        ({"schema": "assur-plan/1", "plan": {}}, "without its request"),
    ):
        studio.opened("plan.json", json.dumps(held))
        studio.until(f"document.getElementById('faults').innerText.includes({json.dumps(said)})")
        assert studio.text == before
        assert studio.page.locator("#answers iframe").count() == 0


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (json.dumps(answer("transfer")), "an answer without its request"),
        ('{"schema": "assur/1", "robot": {"model": "a", "model": "b"}, "task": []}', "has a key twice"),
        ('{"schema": "assur/1", "options": {"seed": 9007199254740993}}', "9007199254740993"),
        ('{"schema": "assur-view/1"}', '"assur-view/1"'),
        ('{"points": [], "joint_names": ["j1"]}', "JSON with the keys points, joint_names"),
        ("[1, 2, 3]", "a list of 3"),
        ("{}", "JSON with no key"),
        ('<?xml version="1.0"?>\n<robot name="x"/>', "URDF"),
        ("<!DOCTYPE html><html></html>", "a web page"),
    ],
)
def test_a_document_that_is_not_taken_is_named(studio: Studio, content: str, said: str) -> None:
    before = studio.text
    studio.pasted(content)
    studio.page.wait_for_selector("#faults p")
    assert said in studio.faults
    assert "The studio takes a scenario, a cell and a task (YAML or JSON), a request" in studio.faults
    assert studio.text == before


def test_json_that_is_a_value_of_a_scenario_is_pasted_as_it_is(studio: Studio) -> None:
    studio.page.fill("#text", "about: mine\nrequest: ")
    studio.page.keyboard.press("Control+End")
    content = json.dumps(request())
    studio.pasted(content, whole=False)
    assert studio.text == f"about: mine\nrequest: {content}"
    studio.planned()


def test_a_scenario_in_json_is_left_as_it_is_and_planned(studio: Studio) -> None:
    content = json.dumps({"about": "in JSON", "request": request()})
    studio.pasted(content)
    assert studio.text == content
    studio.planned()
    assert studio.page.locator("#answers figcaption strong").inner_text() == "in JSON"


def test_a_request_that_was_written_by_hand_is_taken_by_plan(studio: Studio) -> None:
    studio.page.fill("#text", json.dumps(request()))
    studio.until("document.getElementById('note').textContent === 'This is a request in JSON. Plan takes it.'")
    studio.planned()
    assert parsed(studio.text) == request()
