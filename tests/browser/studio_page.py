"""The studio as it is used: what is typed, chosen, planned, opened, dropped and saved in a page."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import httpx
from playwright.sync_api import FilePayload, Page

from tests.browser.opened_page import PATIENCE_S, Opened

IDLE = "!document.getElementById('plan').disabled"
DROP = """([target, files]) => {
    const held = new DataTransfer();
    for (const [name, content] of files) held.items.add(new File([Uint8Array.from(content)], name));
    const event = (type) => new DragEvent(type, { dataTransfer: held, bubbles: true, cancelable: true });
    const place = target === null ? document.body : document.querySelector(target).contentDocument.body;
    place.dispatchEvent(event("dragover"));
    return !place.dispatchEvent(event("drop"));
}"""


class Studio(Opened):
    """A page with the studio."""

    def __init__(self, page: Page, service: httpx.Client, query: str = "") -> None:
        super().__init__(page)
        page.set_default_timeout(1e3 * PATIENCE_S)
        self.address = f"{str(service.base_url).rstrip('/')}/studio"
        page.goto(self.address + query)
        self.ready()

    def ready(self) -> None:
        self.page.wait_for_selector("html[data-ready=yes]")

    def reload(self) -> None:
        self.page.reload()
        self.ready()

    @property
    def text(self) -> str:
        return str(self.page.input_value("#text"))

    @property
    def faults(self) -> str:
        return str(self.page.locator("#faults").inner_text())

    @property
    def note(self) -> str:
        return str(self.page.locator("#note").inner_text())

    def write(self, old: str, new: str) -> None:
        """Changes the text in the editor."""
        assert old in self.text
        self.page.fill("#text", self.text.replace(old, new))

    def type(self, text: str) -> None:
        """Types at the end of the text, with the keys."""
        self.page.focus("#text")
        self.page.keyboard.press("Control+End")
        self.page.keyboard.type(text)

    def choose(self, name: str) -> None:
        """Chooses a text of the list: a shipped scenario, or one's own by its value."""
        before = self.text
        self.page.select_option("#scenario", name)
        if not name.startswith("text:"):
            self.until(f"new URLSearchParams(location.search).get('scenario') === '{name}'")
        else:
            self.until(f"document.getElementById('text').value !== {before!r}")

    def own(self) -> list[tuple[str, str]]:
        """Value and name of each text of one's own in the list; the name without its time."""
        found = self.ask("[...document.querySelectorAll('#own option')].map((each) => [each.value, each.textContent])")
        return [(value, name.rsplit(" (", 1)[0]) for value, name in found]

    def undo(self) -> None:
        self.page.focus("#text")
        self.page.keyboard.press("Control+z")

    def planned(self) -> None:
        """Plans and waits until the answer is there."""
        self.page.click("#plan")
        self.until(IDLE)
        assert self.faults == ""
        assert self.page.locator("#answers figcaption").count() > 0

    def player(self, number: int = 0) -> Any:
        """The frame of a player, once it has drawn."""
        frame = self.page.frame_locator("#answers iframe").nth(number)
        frame.locator("html[data-ready=yes]").wait_for()
        return frame

    def saved(self, what: str) -> tuple[str, bytes]:
        """The name and the content of the file that Save writes."""
        with self.page.expect_download() as caught:
            self.page.select_option("#save", what)
        path = caught.value.path()
        self.until("!document.getElementById('save').disabled")
        return caught.value.suggested_filename, Path(path).read_bytes()

    def opened(self, name: str, content: str | bytes) -> None:
        """Opens a file with the button, and waits until it was taken or refused."""
        data = content.encode() if isinstance(content, str) else content
        with self.page.expect_file_chooser() as caught:
            self.page.click("#open")
        self.until(IDLE)
        caught.value.set_files([FilePayload(name=name, mimeType="", buffer=data)])
        self.until("document.getElementById('file').value === ''")

    def dropped(self, *files: tuple[str, bytes], target: str | None = None) -> bool:
        """Drops files on the page, or on the page in the frame `target`. Whether the page takes them."""
        taken: bool = self.page.evaluate(DROP, [target, [[name, list(content)] for name, content in files]])
        self.page.wait_for_timeout(100)
        return taken

    def pasted(self, content: str, *, whole: bool = True) -> None:
        """Pastes over the whole text, or where the caret is."""
        self.page.evaluate("(text) => navigator.clipboard.writeText(text)", content)
        self.page.focus("#text")
        if whole:
            self.page.keyboard.press("Control+a")
        self.page.keyboard.press("Control+v")
