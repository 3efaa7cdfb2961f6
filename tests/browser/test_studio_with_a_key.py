"""The studio of a service with keys has a form for the key, keeps it for the tab, and refuses a wrong one."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import BrowserContext, expect

from assur.api import keys
from assur.api.web.settings import Settings
from tests.api.running import running
from tests.browser.studio_page import Studio

pytestmark = pytest.mark.slow

KEY = keys.new_key()


@pytest.fixture(scope="module")
def locked(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    """A service that knows one key."""
    file = Path(tmp_path_factory.mktemp("keys")) / "keys.json"
    entry: dict[str, object] = {"name": "line-3", "sha256": keys.digest(KEY)}
    keys.write(file, keys.with_key(keys.KeysDocument(), entry))
    with running(Settings(workers=1, grace_s=30.0, keys_file=str(file))) as service:
        yield service


class Locked(Studio):
    """The studio before a key was entered: its form is open."""

    def ready(self) -> None:
        self.page.wait_for_selector("#key-dialog[open]")

    def enter(self, key: str) -> None:
        self.page.fill("#key", key)
        self.page.keyboard.press("Enter")


@pytest.fixture
def studio(context: BrowserContext, locked: httpx.Client) -> Locked:
    return Locked(context.new_page(), locked)


def test_the_form_asks_until_the_key_is_known_and_the_tab_keeps_it(studio: Locked) -> None:
    page = studio.page
    said = page.locator("#key-message")
    assert said.inner_text() == "The service needs a key."
    assert page.get_attribute("#key", "type") == "password"
    assert page.evaluate("document.activeElement.id") == "key"
    for unfit in ("", "   ", "two words", "schl\u00fcssel"):
        studio.enter(unfit)
        assert "letters, digits and signs of ASCII" in said.inner_text()
    studio.enter("wrong")
    expect(said).to_have_text("The service does not know this key.")
    assert page.input_value("#key") == ""
    studio.enter(f"  {KEY} ")
    page.wait_for_selector("html[data-ready=yes]")
    assert not page.locator("#key-dialog").is_visible()
    assert "dial" in studio.text
    studio.planned()
    page.reload()
    page.wait_for_selector("html[data-ready=yes]")
    assert not page.locator("#key-dialog").is_visible()
    assert page.locator("#shipped option").count() > 20
    assert KEY not in page.content()


@pytest.mark.parametrize("leave", ["Escape", "button"])
def test_the_page_works_without_a_key_and_the_form_opens_again(studio: Locked, leave: str) -> None:
    page = studio.page
    if leave == "Escape":
        page.keyboard.press("Escape")
    else:
        page.click("#key-later")
    page.wait_for_selector("html[data-ready=yes]")
    assert "needs a key" in studio.faults
    studio.type("about: mine")
    assert studio.saved("text") == ("mine.yaml", b"about: mine")
    studio.until("document.getElementById('faults').innerText.includes('needs a key')")
    assert not page.locator("#key-dialog").is_visible()  # nobody pressed anything: it stays closed
    studio.opened("cell.yaml", "about: opened")
    assert studio.text == "about: opened"
    page.click("#plan")
    studio.ready()
    page.keyboard.press("Escape")
    studio.until("!document.getElementById('plan').disabled")
    assert "Press Key" in studio.faults
    page.click("#enter")
    studio.ready()
    studio.enter(KEY)
    studio.until("document.querySelectorAll('#shipped option').length > 20")
    assert studio.text == "about: opened"
    studio.choose("transfer")
    studio.planned()


def test_a_text_is_there_before_the_key_is(studio: Locked) -> None:
    page = studio.page
    page.keyboard.press("Escape")
    studio.type("about: mine")
    page.reload()
    studio.ready()
    assert studio.text == "about: mine"
    studio.enter(KEY)
    page.wait_for_selector("html[data-ready=yes]")
    assert studio.text == "about: mine"
