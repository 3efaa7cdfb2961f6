"""The report that a command writes, and a browser that shows it."""

from __future__ import annotations

import tempfile
import webbrowser
from pathlib import Path
from typing import Any

from assur.api.cli.inputs import Target
from assur.api.version import version
from assur.scenes import requests


def made(given: Target, answer: dict[str, Any]) -> tuple[bytes, bool]:
    """The report of an answer that was read or made, and whether the checker has nothing against it."""
    verdict = requests.verdict_on(given.cell, answer)
    return page(given, answer, verdict), verdict is None or bool(verdict["ok"])


def page(given: Target, answer: dict[str, Any], verdict: dict[str, Any] | None) -> bytes:
    """The report of an answer to what was given."""
    text = requests.report_page(
        given.cell, answer, title=given.title, about=given.about, verdict=verdict, version=version()
    )
    return text.encode()


def show(path: Path) -> str:
    """Opens a report in the browser of this machine; says where it is, and that there is none."""
    opened = webbrowser.open(path.resolve().as_uri())
    return f"the report is {path}" if opened else f"no browser was found here; open {path} in one"


def kept(name: str, page: bytes) -> Path:
    """The file of a report that is only shown, in a folder of its own among the temporary files."""
    path = Path(tempfile.mkdtemp(prefix="assur-")) / f"{name}.html"
    path.write_bytes(page)
    return path
