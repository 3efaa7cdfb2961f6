"""A real Chromium with the reports of all shipped scenarios. `make test-browser` runs these tests and no others."""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, sync_playwright

from assur.scenes.report.report import report_of
from assur.scenes.scenarios import shipped
from tests.scenes.cells.second_kinematics import answer
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
PATIENCE_S = 240.0
"""How long a page may take, s: a guard against a hang."""
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


class Opened:
    """A report that is open: the `page`, and what it said and asked for."""

    def __init__(self, page: Page) -> None:
        self.page, self.said, self.asked = page, list[str](), list[str]()
        page.on("console", lambda message: self.said.append(f"{message.type}: {message.text}"))
        page.on("pageerror", lambda error: self.said.append(f"error: {error}"))
        page.on("request", lambda request: self.asked.append(request.url))

    def ask(self, expression: str) -> Any:
        """The value of an expression of JavaScript."""
        return self.page.evaluate(expression)

    def until(self, condition: str) -> None:
        """Waits until an expression is true. The page's policy forbids what playwright has for this."""
        end = time.monotonic() + PATIENCE_S
        while not self.ask(condition):
            assert time.monotonic() < end, condition
            self.page.wait_for_timeout(20)

    def shot(self) -> bytes:
        """The canvas as a PNG, nothing over it."""
        for part in ("#labels", ".views", ".shows", "#legend"):
            self.ask(f"document.querySelector('{part}').style.display = 'none'")
        shot: bytes = self.page.locator("#stage").screenshot()
        return shot


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
