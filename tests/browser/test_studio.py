"""The studio in a real Chromium, against a real service: it plans, shows a refusal, and tells a fault at its line."""

from __future__ import annotations

import json

import httpx
import pytest

from tests.browser.studio_page import IDLE, Studio

pytestmark = pytest.mark.slow


def test_the_demo_is_planned_and_played(studio: Studio, service: httpx.Client) -> None:
    page = studio.page
    assert page.input_value("#text") == service.get("/v1/scenes/demo/text").text
    studio.planned()
    player = page.frame_locator("#answers iframe")
    player.locator("html[data-ready=yes]").wait_for()
    assert page.locator("#answers figcaption strong").inner_text() == "demo"
    assert "answer 1: planned, 1.4" in page.locator("#answers figcaption").inner_text()
    assert player.locator("#now").inner_text() == "0.000"
    page.frames[-1].evaluate("window.assur.seek(0.9)")
    assert player.locator("#now").inner_text() == "0.900"
    assert studio.faults == ""
    assert studio.said == []
    host = str(service.base_url)
    assert {address for address in studio.asked if not address.startswith((host, "data:", "about:"))} == set()


PLAYERS = "[...document.querySelectorAll('#answers iframe')].map((frame) => frame.contentWindow.assur)"
EVERY = f"{PLAYERS}.every((player) => {{}})"
VIEWS = f"{PLAYERS}.map((player) => player.camera.state)"
ONE_VIEW = f"new Set({VIEWS}.map((state) => JSON.stringify(state))).size === 1"


def test_two_plans_are_compared_with_one_clock_and_one_camera(studio: Studio) -> None:
    page = studio.page
    studio.choose("transfer")
    studio.planned()
    studio.player()
    page.frames[-1].evaluate("window.assur.look('top')")
    top = studio.ask(VIEWS)[0]
    page.click("#keep")
    assert page.locator("#note").inner_text() == "This answer is kept. Press Plan: the next answer is shown next to it."
    studio.choose("demo")  # another cell, of another size
    studio.planned()
    assert page.locator("#answers iframe").count() == 2
    for k in range(2):
        studio.player(k)
    studio.until(ONE_VIEW)
    assert studio.ask(VIEWS) == [top, top]
    first, second = page.frames[-2:]
    first.evaluate("window.assur.seek(0.25)")
    studio.until(EVERY.format("player.t === 0.25"))
    second.evaluate("window.assur.seek(0.5)")
    studio.until(EVERY.format("player.t === 0.5"))
    stage = page.frame_locator("#answers iframe").nth(1).locator("#stage")
    stage.focus()
    page.keyboard.press("ArrowUp")
    page.keyboard.press("+")
    studio.until(f"JSON.stringify({VIEWS}[0]) !== {json.dumps(json.dumps(top, separators=(',', ':')))}")
    studio.until(ONE_VIEW)
    assert studio.ask(VIEWS)[1]["distance"] < top["distance"]
    page.set_viewport_size({"width": 1000, "height": 700})  # a picture of another shape is not fitted anew
    studio.until(ONE_VIEW)
    page.uncheck("#together")
    first.evaluate("window.assur.seek(0.1), window.assur.look('front')")
    page.wait_for_timeout(300)
    assert studio.ask("document.querySelectorAll('#answers iframe')[1].contentWindow.assur.t") == 0.5
    assert not studio.ask(ONE_VIEW)


def test_a_table_shows_what_differs_between_two_answers(studio: Studio) -> None:
    page, table = studio.page, studio.page.locator("#differences")
    studio.choose("demo")
    studio.planned()
    studio.player()
    page.click("#keep")
    assert not table.is_visible()
    old = next(line for line in studio.text.splitlines() if "limits:" in line)
    studio.write(old, old.replace("0.6", "0.3"))
    studio.planned()
    studio.player(1)
    cells = [[cell.inner_text() for cell in row.locator("th, td").all()] for row in table.locator("tr").all()]
    rows = {what: (first, second) for what, first, second in cells}
    assert rows["text"] == (old, old.replace("0.6", "0.3"))
    assert rows["result"] == ("planned", "planned")
    first_s, second_s = (float(text.removesuffix(" s")) for text in rows["duration"])
    assert first_s < second_s
    assert all(" mm, " in text for text in rows["smallest clearance"])
    assert all(" of j" in text for text in rows["what binds"])
    assert table.locator(".same th").all_inner_texts() == [what for what, (a, b) in rows.items() if a == b]
    page.locator("#answers figcaption button").first.click()
    assert not table.is_visible()


def test_changed_lines_are_those_that_one_text_has_alone(studio: Studio) -> None:
    lines = "const { changedLines } = await import('./studio/differences.js'); return changedLines(%s, %s)"

    def changed(first: str, second: str) -> list[list[str]]:
        found: list[list[str]] = studio.ask(f"(async () => {{ {lines % (json.dumps(first), json.dumps(second))} }})()")
        return found

    assert changed("a\nb\nc\nd", "a\nx\nc\ny\nd") == [["b"], ["x", "y"]]
    assert changed("a", "a") == [[], []]
    both = [json.dumps(["task", cell]) for cell in ("one\ntwo", "one\nthree")]
    assert changed(*both) == [["two"], ["three"]]
    assert changed("x\n" * 3000, "y\n" * 3000) == [["x"] * 3000, ["y"] * 3000]


def test_a_refusal_is_shown_with_its_reason(studio: Studio) -> None:
    page = studio.page
    studio.choose("bead-beyond-reach")
    studio.planned()
    player = page.frame_locator("#answers iframe")
    player.locator("html[data-ready=yes]").wait_for()
    told = player.locator("#refusal").inner_text()
    assert "reach" in told
    assert "reach" in page.locator("#answers figcaption").inner_text()


def test_a_fault_of_the_text_is_told_at_its_line(studio: Studio) -> None:
    page = studio.page
    studio.write("mitsubishi-rh-6frh5520", "mitsubishi-rh-6")
    page.click("#plan")
    page.wait_for_selector("#faults p")
    line = page.input_value("#text").split("mitsubishi-rh-6")[0].count("\n") + 1
    assert page.locator("#faults button").inner_text() == f"line {line}"
    assert page.locator("#lines .fault").inner_text() == str(line)
    assert "did you mean" in studio.faults
    page.click("#faults button")
    marked = "(({ value, selectionStart, selectionEnd }) => value.slice(selectionStart, selectionEnd))"
    assert "mitsubishi-rh-6" in page.evaluate(f"{marked}(document.getElementById('text'))")
    studio.write("mitsubishi-rh-6", "mitsubishi-rh-6frh5520")
    assert studio.faults == ""
    assert page.locator("#answers iframe").count() == 0


def test_faults_are_told_while_one_writes(studio: Studio) -> None:
    page = studio.page
    studio.write("schema: assur/1", "schema: assur/7")
    page.wait_for_selector("#faults p")
    assert "assur/1" in studio.faults
    studio.write("schema: assur/7", "schema: assur/1")
    assert studio.faults == ""


def test_an_answer_to_another_text_is_marked(studio: Studio) -> None:
    page = studio.page
    studio.write("max_candidates: 300", "max_candidates: 30")
    studio.planned()
    assert page.locator("#answers figcaption strong").inner_text() == "The demo"
    assert not page.locator("#answers .stale").is_visible()
    studio.write("max_candidates: 30", "max_candidates: 31")
    assert page.locator("#answers .stale").is_visible()
    studio.write("max_candidates: 31", "max_candidates: 30")
    assert not page.locator("#answers .stale").is_visible()


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("about: Three cups on a tray\nrequest: 1\n", "Three cups on a tray"),
        ('about: "quoted: not the end"\n', "quoted"),
        ("about: >-  # folded\n  Two belts.\n  One arm.\n", "Two belts"),
        ('{"about": "in JSON", "request": {}}', "in JSON"),
        ("request: {}\n", "own text"),
        ("about: " + "long " * 20, "long long long long long long long long long"),
    ],
)
def test_a_text_is_called_what_the_cell_calls_itself(studio: Studio, text: str, name: str) -> None:
    studio.page.fill("#text", text)
    assert [each for _, each in studio.own()] == [name]
    assert studio.saved("text") == (f"{name.replace(' ', '-')}.yaml", text.encode())


def test_a_plan_is_called_off(studio: Studio, service: httpx.Client) -> None:
    page = studio.page
    studio.write("max_candidates: 300", "max_candidates: 100000")
    page.click("#plan")
    page.wait_for_selector("#numbers dd")
    page.click("#cancel")
    studio.until(IDLE)
    assert page.locator("#answers iframe").count() == 0
    assert studio.faults == ""
    assert studio.note.startswith("Cancelled after ")
    assert service.get("/readyz").status_code == 200


FILES = {
    "report": ("", "html"),
    "plan": ("-plan", "json"),
    "answer": ("-answer", "json"),
    "request": ("-request", "json"),
    "text": ("", "yaml"),
    "export:csv": ("", "csv"),
    "export:glb": ("", "glb"),
    "export:ros2": ("-ros2", "yaml"),
    "export:ros2-json": ("-ros2-json", "json"),
    "export:spel": ("-spel", "prg"),
    "export:melfa": ("-melfa", "prg"),
}
"""What is saved, and how the name of the file ends."""


def test_everything_that_save_offers_is_a_file(studio: Studio, service: httpx.Client) -> None:
    page = studio.page
    studio.choose("transfer")
    studio.planned()
    offered = page.evaluate("[...document.querySelectorAll('#save option')].map((option) => option.value)")
    described = service.get("/openapi.json").json()["components"]["schemas"]["ExportQuestion"]
    formats = described["properties"]["format"]["enum"]
    assert offered[0] == ""
    assert offered[1:7] == ["text", "link", "report", "plan", "answer", "request"]
    assert offered[7:] == [f"export:{form}" for form in formats]
    assert {"csv", "ros2", "ros2-json", "spel", "melfa"} <= set(formats)
    saved = dict[str, bytes]()
    for what in (each for each in offered[1:] if each != "link"):
        name, saved[what] = studio.saved(what)
        part, ending = FILES[what]
        assert name == f"transfer{part}.{ending}"
        assert saved[what], what
    assert len(set(saved.values())) == len(saved)
    assert service.post("/v1/plans/check", json=json.loads(saved["plan"])).json()["ok"] is True
    assert saved["export:csv"].startswith(b"#")
    assert json.loads(saved["export:ros2-json"])["joint_names"] == ["j1", "j2", "j3", "j4"]
    assert studio.faults == ""
    assert studio.said == []


def test_what_a_format_cannot_hold_is_told_and_a_refusal_has_no_exports(studio: Studio) -> None:
    page = studio.page
    studio.choose("parabolic-blend")
    studio.planned()
    assert page.evaluate("document.getElementById('formats').disabled") is False
    page.select_option("#save", "export:ros2")
    page.wait_for_selector("#note.bad")
    assert "csv" in studio.note
    assert studio.faults == ""
    studio.choose("bead-beyond-reach")
    studio.planned()
    assert page.evaluate("document.getElementById('formats').disabled") is True
    assert page.evaluate("document.getElementById('of-answer').disabled") is False
