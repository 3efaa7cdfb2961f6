"""The studio of a service that has keys asks for one, keeps it for the tab, and asks again where it is wrong."""

from __future__ import annotations

from pathlib import Path

from playwright.sync_api import Browser, Dialog

from assur.api import keys
from assur.api.web.settings import Settings
from tests.api.running import running
from tests.browser.conftest import PATIENCE_S


def test_the_studio_asks_for_a_key_until_it_has_one_that_is_known(browser: Browser, tmp_path: Path) -> None:
    key, file = keys.new_key(), tmp_path / "keys.json"
    entry: dict[str, object] = {"name": "line-3", "sha256": keys.digest(key)}
    keys.write(file, keys.with_key(keys.KeysDocument(), entry))
    asked: list[str] = []

    def told(dialog: Dialog) -> None:
        asked.append(dialog.message)
        dialog.accept("wrong" if len(asked) == 1 else key)

    with running(Settings(workers=1, grace_s=30.0, keys_file=str(file))) as service:
        page = browser.new_page()
        page.set_default_timeout(1e3 * PATIENCE_S)
        page.on("dialog", told)
        page.goto(str(service.base_url.join("/studio")))
        page.wait_for_selector("html[data-ready=yes]")
        assert asked == ["The service asks for a key:", "The service does not know this key. Its key:"]
        page.click("#plan")
        page.wait_for_selector("#plan:not([disabled])")
        assert page.locator("#faults").inner_text() == ""
        assert page.locator("#save").is_enabled()
        page.reload()
        page.wait_for_selector("html[data-ready=yes]")
        assert len(asked) == 2
        page.close()
