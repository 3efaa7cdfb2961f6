"""What `answer.show()` gives a notebook, in a real Chromium: the viewer plays in its frame and reaches nothing."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Browser

from assur.api.python.answer import Shown
from tests.browser.conftest import SIZE, report
from tests.browser.opened_page import PATIENCE_S, Opened

pytestmark = pytest.mark.slow


def test_the_viewer_plays_in_the_frame_of_a_notebook(browser: Browser, tmp_path: Path) -> None:
    path = tmp_path / "notebook.html"
    frame = Shown(report("transfer"), 500)._repr_html_()
    path.write_text(f"<!doctype html><meta charset=utf-8><title>n</title>{frame}", encoding="utf-8")
    page = browser.new_page(viewport={"width": SIZE["width"], "height": SIZE["height"]})
    page.set_default_timeout(1e3 * PATIENCE_S)
    opened = Opened(page)
    page.goto(path.as_uri())
    player = page.frame_locator("iframe")
    player.locator("html[data-ready=yes]").wait_for()
    box = page.locator("iframe").bounding_box()
    assert box is not None
    assert box["height"] == 500
    inside = page.frames[-1]
    inside.evaluate("window.assur.seek(0.3)")
    assert player.locator("#now").inner_text() == "0.300"
    # an origin of its own: it cannot reach the notebook, nor the notebook it
    assert inside.evaluate("self.origin") == "null"
    assert page.evaluate("document.querySelector('iframe').contentDocument") is None
    assert opened.said == []
    assert [address for address in opened.asked if not address.startswith(("file://", "about:", "data:"))] == []
    page.close()
