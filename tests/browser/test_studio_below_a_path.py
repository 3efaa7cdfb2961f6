"""The studio of a service that a proxy has below a path."""

from __future__ import annotations

import pytest
from playwright.sync_api import Browser

from assur.api.web.settings import Settings
from tests.api.running import running
from tests.browser.opened_page import Opened

pytestmark = pytest.mark.slow


def test_the_studio_plans_and_asks_for_nothing_outside_of_its_path(browser: Browser) -> None:
    with running(Settings(workers=1, grace_s=30.0), below="/cells/7") as service:
        page = browser.new_page()
        studio = Opened(page)
        page.goto(f"{service.base_url}studio")
        page.wait_for_selector("html[data-ready=yes]")
        page.click("#plan")
        studio.until("!document.getElementById('plan').disabled")
        assert "planned, 1.4" in page.locator("#answers figcaption").inner_text()
        assert studio.said == []
        asked = [address for address in studio.asked if not address.startswith(("data:", "about:"))]
        assert asked
        assert [address for address in asked if not address.startswith(str(service.base_url))] == []
        page.close()
        assert service.get("scenes").status_code == 404  # within the path, and not a page of the proxy
