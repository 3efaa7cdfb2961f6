"""The cell is drawn while one writes, before any plan, in one player that keeps its camera."""

from __future__ import annotations

import json
from typing import Any

import httpx
import pytest
from playwright.sync_api import Request

from tests.browser.studio_page import Studio

pytestmark = pytest.mark.slow

DRAWN = "document.querySelector('#drawing iframe').contentWindow.assur"
COUNTED = f"""(() => {{
    const player = {DRAWN};
    window.drawings = 0;
    const take = player.take;
    player.take = function (...all) {{ window.drawings += 1; return take.apply(this, all); }};
}})()"""
PLACE = f"{DRAWN}.view.bodies.find((body) => body.name === 'dial-post').seats[0].at_m"

WRITTEN = """(texts) => {
    const area = document.getElementById('text');
    for (const each of texts) {
        area.value = each;
        area.dispatchEvent(new InputEvent('input', { inputType: 'insertText' }));
    }
}"""


@pytest.fixture
def sent(studio: Studio) -> list[Any]:
    """What is sent to be parsed, in order, once the first drawing is there; drawings are counted."""
    drawn(studio)
    studio.ask(COUNTED)
    bodies = list[Any]()

    def listen(request: Request) -> None:
        if request.url.endswith("v1/scenes/parse"):
            bodies.append(json.loads(request.post_data or ""))

    studio.page.on("request", listen)
    return bodies


def drawn(studio: Studio) -> None:
    studio.page.wait_for_selector("#drawing:not([hidden])")
    studio.until(f"{DRAWN} && {DRAWN}.view !== null")


def test_the_cell_is_drawn_before_any_plan(studio: Studio, service: httpx.Client) -> None:
    drawn(studio)
    asked = {"text": service.get("/v1/scenes/demo/text").text, "draw": True}
    view = service.post("/v1/scenes/parse", json=asked).json()["view"]
    assert studio.ask(f"{DRAWN}.view") == view
    assert not view["moves"]
    assert view["refusal"] is None
    assert studio.page.locator("#answers figure").count() == 0
    stats = studio.ask(f"{DRAWN}.renderer.stats")
    assert stats["triangles"] > 0
    assert studio.said == []


def test_a_change_makes_one_parse_and_one_drawing_and_the_camera_stays(studio: Studio, sent: list[Any]) -> None:
    page, found = studio.page, studio.text
    studio.ask(f"{DRAWN}.look('side')")
    seen, before = studio.ask(f"{DRAWN}.camera.state"), studio.ask(PLACE)
    place = found.index("at_mm: [", found.index("name: dial-post")) + len("at_mm: [")
    page.evaluate("(at) => document.getElementById('text').setSelectionRange(at, at + 1)", place)
    page.focus("#text")
    page.keyboard.insert_text("12")
    studio.until(f"{PLACE}[0] !== {before[0]}")
    page.wait_for_timeout(300)  # nothing else follows
    assert len(sent) == 1
    assert sent[0] == {"text": studio.text, "draw": True}
    assert studio.ask("window.drawings") == 1
    assert studio.ask(f"{DRAWN}.camera.state") == seen
    assert page.locator("#drawing iframe").count() == 1


def test_while_a_text_is_wrong_the_last_good_drawing_stays(studio: Studio, sent: list[Any]) -> None:
    view = studio.ask(f"{DRAWN}.view")
    studio.write("schema: assur/1", "schema: assur/7")
    studio.until("document.getElementById('undrawn').textContent !== ''")
    studio.page.wait_for_selector("#faults p")
    assert studio.ask(f"{DRAWN}.view") == view
    assert studio.page.locator("#undrawn").inner_text() == "The text has changed since, and has a fault."
    studio.write("schema: assur/7", "schema: assur/1")
    studio.until("document.getElementById('undrawn').textContent === ''")
    assert studio.ask("window.drawings") == 1
    assert len(sent) == 2


def test_an_answer_to_the_text_takes_the_place_of_its_drawing(studio: Studio) -> None:
    drawn(studio)
    studio.planned()
    assert not studio.page.locator("#drawing").is_visible()
    studio.write("max_candidates: 300", "max_candidates: 301")
    studio.page.wait_for_selector("#drawing:not([hidden])")
    assert studio.page.locator("#answers .stale").is_visible()


def test_another_text_is_seen_as_a_whole(studio: Studio) -> None:
    drawn(studio)
    studio.ask(f"{DRAWN}.look('side')")
    studio.choose("two-robots")
    studio.until(f"{DRAWN}.view.bodies.some((body) => body.kind === 'neighbour')")
    assert studio.ask(f"{DRAWN}.camera.flat") is False


def test_drawings_leave_nothing_behind(studio: Studio) -> None:
    drawn(studio)
    view = studio.ask(f"{DRAWN}.view")
    held = f"{DRAWN}.renderer.held.length"
    charts = "document.querySelector('#drawing iframe').contentDocument.querySelectorAll('#legend span').length"
    before = studio.ask(held), studio.ask(charts)
    for _ in range(3):
        studio.page.evaluate(f"(view) => {DRAWN}.take(view, true)", view)
    assert (studio.ask(held), studio.ask(charts)) == before


def test_the_newest_of_texts_that_wait_is_drawn(studio: Studio, sent: list[Any]) -> None:
    texts = [studio.text.replace("max_candidates: 300", f"max_candidates: {k}") for k in range(40, 46)]
    studio.page.evaluate(WRITTEN, texts)
    studio.until("window.drawings === 1")
    studio.page.wait_for_timeout(300)
    assert [each["text"] for each in sent] == [texts[-1]]
    assert studio.ask("window.drawings") == 1
