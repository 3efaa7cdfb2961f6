"""A real Chromium with the reports of all shipped scenarios. `make test-browser` runs these tests and no others."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import httpx
import pytest
from playwright.sync_api import Browser, BrowserContext, Page, sync_playwright

from assur.api.web.settings import Settings
from assur.scenes.report.report import report_of
from assur.scenes.scenarios import shipped
from tests.api.running import running
from tests.browser.opened_page import Opened
from tests.browser.studio_page import Studio
from tests.scenes.cells.answers import answer
from tests.scenes.view.shown import cell

FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--no-first-run",
)
"""So that WebGL is computed on any machine, and the browser itself asks for nothing."""
SIZE = {"width": 1400, "height": 860}


@cache
def report(name: str) -> str:
    """The report of the answer to a shipped scenario."""
    verdict = {"ok": True, "findings": []} if answer(name)["status"] == "planned" else None
    return report_of(cell(name), answer(name), title=name, about=shipped(name).about, verdict=verdict, version="0")


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    program = os.environ.get("CHROMIUM") or shutil.which("chromium")
    with sync_playwright() as driver:
        started = driver.chromium.launch(executable_path=program, args=list(FLAGS))
        yield started
        started.close()


@pytest.fixture
def opened(browser: Browser, tmp_path: Path) -> Iterator[Any]:
    """Opens the report of a scenario from a file, in light or dark, and waits until it has drawn."""
    pages = list[Page]()

    def open_report(name: str, text: str | None = None, size: dict[str, int] = SIZE, scheme: Any = "light") -> Opened:
        path = tmp_path / f"{name}.html"
        path.write_text(report(name) if text is None else text, encoding="utf-8")
        page = browser.new_page(viewport={"width": size["width"], "height": size["height"]}, color_scheme=scheme)
        pages.append(page)
        found = Opened(page)
        page.goto(path.as_uri())
        found.until("document.documentElement.dataset.ready === 'yes'")
        return found

    yield open_report
    for page in pages:
        page.close()


@pytest.fixture(scope="session")
def service() -> Iterator[httpx.Client]:
    with running(Settings(workers=1, queue=8, grace_s=30.0)) as made:
        yield made


@pytest.fixture
def context(browser: Browser) -> Iterator[BrowserContext]:
    """Tabs with one storage, which is empty at first, and with the clipboard."""
    made = browser.new_context(
        viewport={"width": SIZE["width"], "height": SIZE["height"]}, permissions=["clipboard-read", "clipboard-write"]
    )
    yield made
    made.close()


@pytest.fixture
def studio(context: BrowserContext, service: httpx.Client) -> Studio:
    """The studio in a first tab."""
    return Studio(context.new_page(), service)
