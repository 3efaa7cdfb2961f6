"""The pictures of docs/pictures, taken in a real Chromium: `make pictures`."""

from __future__ import annotations

import io
import os
import shutil
import tempfile
from pathlib import Path

from PIL import Image
from playwright.sync_api import Browser, sync_playwright

from tests.browser.conftest import FLAGS, SIZE, report

OUT = Path(__file__).parents[2] / "docs" / "pictures"
# Name of the scenario, time from the start in s, light or dark.
SHOWN = (
    ("demo", 0.93, "light"),
    ("crowded", 0.95, "light"),
    ("two-robots", 0.5, "light"),
    ("carton", 0.62, "dark"),
    ("five-bar", 0.3, "light"),
    ("packing", 3.2, "light"),
    ("shut-gate", None, "light"),
)
COLOURS = 255
"""Of a picture: flat surfaces need no more, and the file is a third."""


def picture(browser: Browser, page_file: Path, time: float | None, scheme: str) -> bytes:
    """A PNG of a report at a time; without one, at the time with which the page opens."""
    page = browser.new_page(
        viewport={"width": SIZE["width"], "height": SIZE["height"]},
        color_scheme="dark" if scheme == "dark" else "light",
    )
    page.goto(page_file.as_uri())
    page.wait_for_selector("html[data-ready=yes]")
    if time is not None:
        page.evaluate(f"window.assur.seek({time})")
    page.wait_for_timeout(500)  # the plots follow their sizes
    taken = Image.open(io.BytesIO(page.screenshot())).convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
    page.close()
    out = io.BytesIO()
    taken.save(out, "PNG", optimize=True)
    return out.getvalue()


def main() -> None:
    program = os.environ.get("CHROMIUM") or shutil.which("chromium")
    OUT.mkdir(exist_ok=True)
    with sync_playwright() as driver, tempfile.TemporaryDirectory() as folder:
        browser = driver.chromium.launch(executable_path=program, args=list(FLAGS))
        for name, time, scheme in SHOWN:
            page_file = Path(folder) / f"{name}.html"
            page_file.write_text(report(name), encoding="utf-8")
            (OUT / f"{name}.png").write_bytes(picture(browser, page_file, time, scheme))
        browser.close()


if __name__ == "__main__":
    main()
