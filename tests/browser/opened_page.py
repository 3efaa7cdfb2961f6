"""A page that is open in Chromium."""

from __future__ import annotations

import time
from typing import Any

from playwright.sync_api import Page

PATIENCE_S = 240.0
"""How long a page may take, s: a guard against a hang."""


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
