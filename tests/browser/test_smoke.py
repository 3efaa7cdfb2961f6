"""What the gate runs in a browser: a report loads; the studio plans, refuses, keeps a text and saves what is seen."""

from __future__ import annotations

from typing import Any

from tests.browser.studio_page import Studio


def test_a_report_loads_without_a_message_and_draws(opened: Any) -> None:
    shown = opened("transfer")
    assert shown.said == []
    assert len(shown.asked) == 1
    assert shown.ask("assur.renderer.stats.triangles") > 0
    assert shown.ask("document.querySelectorAll('.chart').length") == 6


def test_the_studio_plans_refuses_keeps_and_saves(studio: Studio) -> None:
    page = studio.page
    studio.planned()
    assert "planned, 1.4" in page.locator("#answers figcaption").inner_text()
    assert studio.player().locator("#now").inner_text() == "0.000"
    studio.choose("bead-beyond-reach")
    studio.planned()
    assert "reach" in studio.player().locator("#refusal").inner_text()
    assert studio.said == []
    studio.type("\nnot: [yet")
    written = studio.text
    assert studio.saved("text")[1].decode() == written
    studio.reload()
    assert studio.text == written


def test_a_button_applies_the_change_that_helps(studio: Studio) -> None:
    studio.choose("fast-belt-long-follow")
    text = studio.text
    studio.planned()
    studio.page.locator("#answers .proposal button").click()
    studio.until("document.querySelector('#answers figcaption').textContent.includes(': planned,')")
    assert studio.text == text.replace("duration_ms: 500", "duration_ms: 300")
    assert studio.said == []
