"""The studio in a real Chromium, against a real service: it plans, shows a refusal, and tells a fault at its line."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Browser, Page

from assur.api.web.settings import Settings
from tests.api.running import running
from tests.browser.conftest import PATIENCE_S, SIZE, Opened


@pytest.fixture(scope="module")
def service() -> Iterator[httpx.Client]:
    with running(Settings(workers=1, queue=8, grace_s=30.0)) as made:
        yield made


@pytest.fixture
def studio(browser: Browser, service: httpx.Client) -> Iterator[Opened]:
    page = browser.new_page(viewport={"width": SIZE["width"], "height": SIZE["height"]})
    page.set_default_timeout(1e3 * PATIENCE_S)
    opened = Opened(page)
    page.goto(str(service.base_url.join("/studio")))
    page.wait_for_selector("html[data-ready=yes]")
    yield opened
    page.close()


def write(page: Page, old: str, new: str) -> None:
    """Changes the text in the editor."""
    text = page.input_value("#text")
    assert old in text
    page.fill("#text", text.replace(old, new))


IDLE = "!document.getElementById('plan').disabled"
OTHER = "!document.getElementById('text').value.includes('dial')"
"""Whether the text is no longer that of the demo."""


def plan(studio: Opened) -> None:
    """Plans and waits until the answer is there."""
    studio.page.click("#plan")
    studio.until(IDLE)
    assert studio.page.locator("#faults").inner_text() == ""
    assert studio.page.locator("#save").is_enabled()


def test_the_demo_is_planned_and_played(studio: Opened, service: httpx.Client) -> None:
    page = studio.page
    assert page.input_value("#text") == service.get("/v1/scenes/demo/text").text
    plan(studio)
    player = page.frame_locator("iframe")
    player.locator("html[data-ready=yes]").wait_for()
    assert page.locator("figcaption").inner_text().startswith("demo 1")
    assert "planned, 1.4" in page.locator("figcaption").inner_text()
    assert player.locator("#now").inner_text() == "0.000"
    page.frames[-1].evaluate("window.assur.seek(0.9)")
    assert player.locator("#now").inner_text() == "0.900"
    assert page.locator("#faults").inner_text() == ""
    assert studio.said == []
    host = str(service.base_url)
    assert {address for address in studio.asked if not address.startswith((host, "data:", "about:"))} == set()


def test_two_plans_are_compared_with_one_clock(studio: Opened) -> None:
    page = studio.page
    page.select_option("#scenario", "transfer")
    studio.until(OTHER)
    plan(studio)
    page.click("#keep")
    plan(studio)
    assert page.locator("iframe").count() == 2
    for k in range(2):
        page.frame_locator("iframe").nth(k).locator("html[data-ready=yes]").wait_for()
    first, second = page.frames[-2:]
    page.wait_for_timeout(500)  # both clocks have been looked at
    first.evaluate("window.assur.seek(0.25)")
    studio.until("[...document.querySelectorAll('iframe')].every((frame) => frame.contentWindow.assur.t === 0.25)")
    second.evaluate("window.assur.seek(0.5)")
    studio.until("[...document.querySelectorAll('iframe')].every((frame) => frame.contentWindow.assur.t === 0.5)")


def test_a_refusal_is_shown_with_its_reason(studio: Opened) -> None:
    page = studio.page
    page.select_option("#scenario", "bead-beyond-reach")
    studio.until(OTHER)
    plan(studio)
    player = page.frame_locator("iframe")
    player.locator("html[data-ready=yes]").wait_for()
    told = player.locator("#refusal").inner_text()
    assert "reach" in told
    assert "reach" in page.locator("figcaption").inner_text()


def test_a_fault_of_the_text_is_told_at_its_line(studio: Opened) -> None:
    page = studio.page
    write(page, "mitsubishi-rh-6frh5520", "mitsubishi-rh-6")
    page.click("#plan")
    page.wait_for_selector("#faults p")
    line = page.input_value("#text").split("mitsubishi-rh-6")[0].count("\n") + 1
    assert page.locator("#faults button").inner_text() == f"line {line}"
    assert page.locator("#lines .fault").inner_text() == str(line)
    assert "did you mean" in page.locator("#faults").inner_text()
    page.click("#faults button")
    marked = "(({ value, selectionStart, selectionEnd }) => value.slice(selectionStart, selectionEnd))"
    assert "mitsubishi-rh-6" in page.evaluate(f"{marked}(document.getElementById('text'))")
    write(page, "mitsubishi-rh-6", "mitsubishi-rh-6frh5520")
    assert page.locator("#faults").inner_text() == ""
    assert page.locator("iframe").count() == 0


def test_faults_are_told_while_one_writes(studio: Opened) -> None:
    page = studio.page
    write(page, "schema: assur/1", "schema: assur/7")
    page.wait_for_selector("#faults p")
    assert "assur/1" in page.locator("#faults").inner_text()
    write(page, "schema: assur/7", "schema: assur/1")
    assert page.locator("#faults").inner_text() == ""


def test_a_text_of_ones_own_is_kept_while_scenarios_are_looked_at(studio: Opened) -> None:
    page = studio.page
    write(page, "max_candidates: 300", "max_candidates: 30")
    assert page.locator("#scenario").input_value() == ""
    page.select_option("#scenario", "shut-gate")
    studio.until(OTHER)
    page.select_option("#scenario", "")
    assert "max_candidates: 30" in page.input_value("#text")
    assert "dial" in page.input_value("#text")


def test_an_answer_to_another_text_is_marked(studio: Opened) -> None:
    page = studio.page
    write(page, "max_candidates: 300", "max_candidates: 30")
    plan(studio)
    assert page.locator("figcaption strong").inner_text() == "demo, changed 1"
    assert not page.locator(".stale").is_visible()
    write(page, "max_candidates: 30", "max_candidates: 31")
    assert page.locator(".stale").is_visible()
    write(page, "max_candidates: 31", "max_candidates: 30")
    assert not page.locator(".stale").is_visible()


def test_a_plan_is_called_off(studio: Opened, service: httpx.Client) -> None:
    page = studio.page
    write(page, "max_candidates: 300", "max_candidates: 100000")
    page.click("#plan")
    page.wait_for_selector("#numbers dd")
    page.click("#cancel")
    studio.until(IDLE)
    assert page.locator("iframe").count() == 0
    assert page.locator("#faults").inner_text() == ""
    assert page.locator("#note").inner_text().startswith("Cancelled after ")
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


def test_everything_that_save_offers_is_a_file(studio: Opened, service: httpx.Client, tmp_path: Path) -> None:
    page = studio.page
    page.select_option("#scenario", "transfer")
    studio.until(OTHER)
    plan(studio)
    offered = page.evaluate("[...document.querySelectorAll('#save option')].map((option) => option.value)")
    described = service.get("/openapi.json").json()["components"]["schemas"]["ExportQuestion"]
    formats = described["properties"]["format"]["enum"]
    assert offered[0] == ""
    assert offered[1:6] == ["report", "plan", "answer", "request", "text"]
    assert offered[6:] == [f"export:{form}" for form in formats]
    assert {"csv", "ros2", "ros2-json", "spel", "melfa"} <= set(formats)
    saved = dict[str, bytes]()
    for what in offered[1:]:
        with page.expect_download() as caught:
            page.select_option("#save", what)
        part, ending = FILES[what]
        number = page.locator("figcaption strong").inner_text().split()[-1]
        assert caught.value.suggested_filename == f"transfer-{number}{part}.{ending}"
        path = tmp_path / f"{len(saved)}.{ending}"
        caught.value.save_as(path)
        saved[what] = path.read_bytes()
        assert saved[what], what
        studio.until("!document.getElementById('save').disabled")
    assert len(set(saved.values())) == len(saved)
    assert service.post("/v1/plans/check", json=json.loads(saved["plan"])).json()["ok"] is True
    assert saved["export:csv"].startswith(b"#")
    assert json.loads(saved["export:ros2-json"])["joint_names"] == ["j1", "j2", "j3", "j4"]
    assert page.locator("#faults").inner_text() == ""
    assert studio.said == []


def test_what_a_format_cannot_hold_is_told_and_a_refusal_has_no_exports(studio: Opened) -> None:
    page = studio.page
    page.select_option("#scenario", "parabolic-blend")
    studio.until(OTHER)
    plan(studio)
    assert page.evaluate("document.getElementById('formats').disabled") is False
    page.select_option("#save", "export:ros2")
    page.wait_for_selector("#faults p")
    assert "csv" in page.locator("#faults").inner_text()
    page.select_option("#scenario", "bead-beyond-reach")
    studio.until("document.getElementById('text').value.includes('bead')")
    plan(studio)
    assert page.evaluate("document.getElementById('formats').disabled") is True
    assert page.evaluate("document.getElementById('save').disabled") is False
